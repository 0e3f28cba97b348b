// Shared by the parts of the glTF importer. Inside it errors are thrown as import_failure; it
// returns them as error messages.
#ifndef VOXCAST_RENDERER_IMPORT_GLTF_IMPORT_HPP
#define VOXCAST_RENDERER_IMPORT_GLTF_IMPORT_HPP

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <tiny_gltf.h>
#include <vector>

#include "renderer/import/import_job.hpp"

// An accessor without data stands for zeros; accepts at most so many elements of them.
#define GLTF_MAX_ZERO_ELEMENTS (1u << 20)
#define GLTF_MAX_JSON_DEPTH    64u
// Many primitives may share triangle indices, but a small file must not fill memory: accepts this
// many, or this many per byte of its buffers.
#define GLTF_FREE_INDICES      (4u << 20)
#define GLTF_INDICES_PER_BYTE  8u
#define GLTF_FREE_SPARSE_BYTES (64u << 20) // the same for sparse accessors

struct gltf_buffer {
    const uint8_t *data;
    size_t size;
    std::vector<uint8_t> owned; // storage of `data`, unless that is the file's binary chunk
};

// Elements of an accessor, in place; sparse ones resolved.
struct gltf_elements {
    const uint8_t *data; // NULL stands for zeros
    size_t stride;
    uint32_t count;
    int component_type;
    uint32_t components;
    bool normalized;
};

struct gltf_import : import_job {
    nlohmann::json json; // checked by gltf_check_json(); buffers and images are read from it
    tinygltf::Model model;
    std::vector<gltf_buffer> buffers;
    uint64_t buffer_bytes = 0;
    std::vector<uint32_t> image_ids; // scene ids by index in the file; likewise below
    std::vector<uint32_t> material_ids;
    std::vector<uint32_t> mesh_ids;
    std::vector<bool> mesh_done;
    uint32_t default_material = SCENE_NONE;
    std::vector<uint32_t>
        vertex_numbers; // scratch of compact_vertices(): all SCENE_NONE between uses
    uint64_t index_total = 0;
    uint64_t animation_floats = 0;
    std::vector<uint32_t> node_ids;
    std::map<int, std::vector<uint8_t>> sparse; // resolved data by accessor
    uint64_t sparse_bytes = 0;
};

// gltf_file.cpp: containers, JSON, buffers and images.

// Splits a file into JSON and binary chunk, checks the JSON and reads the buffers.
void gltf_read_document(gltf_import &import, const uint8_t *bytes, size_t size);
void gltf_read_images(gltf_import &import);

// gltf_schema.cpp

// Checks types, ranges and references of everything that the importer reads; turns integers written
// as 1.0 into integers, and removes `extras`. Fails with the position and the allowed range.
void gltf_check_json(nlohmann::json &root);

// Fails on unsupported required extensions; warns about other unsupported ones.
void gltf_check_extensions(gltf_import &import);

// gltf_accessor.cpp

// Fails unless every accessor lies in its view and every view in its buffer.
void gltf_check_accessors(const gltf_import &import);
gltf_elements gltf_get_elements(gltf_import &import, int accessor);
uint32_t gltf_accessor_components(const tinygltf::Accessor &accessor);

// Reads the first `count` components of an element; leaves those that the accessor lacks unchanged.
void gltf_read_element(const gltf_elements &elements, uint32_t index, float *out, uint32_t count);
uint32_t gltf_read_index(const gltf_elements &elements, uint32_t index);

// gltf_material.cpp, gltf_mesh.cpp, gltf_node.cpp, gltf_animation.cpp

void gltf_import_materials(gltf_import &import);

// The scene's mesh for a mesh of the file, imported on first use; SCENE_NONE if it is empty.
uint32_t gltf_import_mesh(gltf_import &import, int mesh);
void gltf_import_nodes(gltf_import &import);
void gltf_import_animations(gltf_import &import);

// import_gltf.cpp

// The nearest finite float; `fallback` for NaN.
float gltf_float(double value, float fallback);

// As gltf_float(), clamped to low .. high, with a warning that names `what` if it was outside.
float gltf_clamped(gltf_import &import, double value, double low, double high, const char *what);

#endif
