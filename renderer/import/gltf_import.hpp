// What the parts of the glTF importer share. Failures travel as import_failure within the importer
// and leave it as an error message.
#ifndef VOXCAST_RENDERER_IMPORT_GLTF_IMPORT_HPP
#define VOXCAST_RENDERER_IMPORT_GLTF_IMPORT_HPP

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <tiny_gltf.h>
#include <vector>

#include "renderer/import/import_failure.hpp"

extern "C" {
#include "renderer/image/file_access.h"
#include "renderer/scene/scene.h"
}

// An accessor without data stands for zeros; so many elements of them are believed.
#define GLTF_MAX_ZERO_ELEMENTS (1u << 20)
#define GLTF_MAX_JSON_DEPTH    64u
// Triangle indices may be shared by many primitives, but not so that a small file fills the memory:
// this many, or this many for each byte of its buffers.
#define GLTF_FREE_INDICES      (4u << 20)
#define GLTF_INDICES_PER_BYTE  8u
#define GLTF_FREE_SPARSE_BYTES (64u << 20) // likewise for sparse accessors

struct gltf_buffer {
    const uint8_t *data;
    size_t size;
    std::vector<uint8_t> owned; // backs `data` unless that is the file's binary chunk
};

// Elements of an accessor in place, sparse ones resolved.
struct gltf_elements {
    const uint8_t *data; // NULL stands for zeros
    size_t stride;
    uint32_t count;
    int component_type;
    uint32_t components;
    bool normalized;
};

struct gltf_import {
    struct scene *scene = nullptr;
    std::string path;   // canonical; empty when the file came from memory
    std::string folder; // canonical; empty to read no other files
    struct asset_stamp stamp = {};
    nlohmann::json json; // checked by gltf_check_json(); buffers and images are read from here
    tinygltf::Model model;
    std::vector<gltf_buffer> buffers;
    uint64_t buffer_bytes = 0;
    std::vector<uint32_t> image_ids; // in the scene, by index in the file; likewise below
    std::vector<uint32_t> material_ids;
    std::vector<uint32_t> mesh_ids;
    std::vector<bool> mesh_done;
    uint32_t default_material = SCENE_NONE;
    std::vector<uint32_t> vertex_numbers; // scratch of compaction: SCENE_NONE between uses
    uint64_t index_total = 0;
    uint64_t animation_floats = 0;
    std::vector<uint32_t> node_ids;
    std::map<int, std::vector<uint8_t>> sparse; // resolved data by accessor
    uint64_t sparse_bytes = 0;
    std::map<std::string, uint32_t> warned; // occurrences by text
};

// gltf_file.cpp: containers, JSON, buffers and pictures.

// Splits a file into JSON and binary chunk, checks the JSON and reads the buffers.
void gltf_read_document(gltf_import &import, const uint8_t *bytes, size_t size);
void gltf_read_images(gltf_import &import);

// gltf_schema.cpp

// Types, ranges and references of everything the importer reads; integers written as 1.0 become
// integers, and `extras` are removed. Fails with the place and the allowed range.
void gltf_check_json(nlohmann::json &root);

// Fails on required extensions that are not supported; warns about the others.
void gltf_check_extensions(gltf_import &import);

// gltf_accessor.cpp

// Every accessor lies in its view and every view in its buffer.
void gltf_check_accessors(const gltf_import &import);
gltf_elements gltf_get_elements(gltf_import &import, int accessor);
uint32_t gltf_accessor_components(const tinygltf::Accessor &accessor);

// The first `count` components of one element; those that the accessor lacks are left alone.
void gltf_read_element(const gltf_elements &elements, uint32_t index, float *out, uint32_t count);
uint32_t gltf_read_index(const gltf_elements &elements, uint32_t index);

// gltf_material.cpp, gltf_mesh.cpp, gltf_node.cpp, gltf_animation.cpp

void gltf_import_materials(gltf_import &import);

// The scene's mesh for a mesh of the file, imported on first use; SCENE_NONE if nothing is in it.
uint32_t gltf_import_mesh(gltf_import &import, int mesh);
void gltf_import_nodes(gltf_import &import);
void gltf_import_animations(gltf_import &import);

// import_gltf.cpp

// Adds a warning once for each text, whatever the number of occurrences.
void gltf_warn_once(gltf_import &import, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

// The nearest finite float; `fallback` for NaN.
float gltf_float(double value, float fallback);

// As gltf_float(), limited to low .. high, with a warning that names `what` if it was beyond.
float gltf_clamped(gltf_import &import, double value, double low, double high, const char *what);

#endif
