// What the parts of the OBJ importer share.
#ifndef VOXCAST_RENDERER_IMPORT_OBJ_IMPORT_HPP
#define VOXCAST_RENDERER_IMPORT_OBJ_IMPORT_HPP

#include <map>
#include <string>
#include <tiny_obj_loader.h>
#include <vector>

#include "renderer/import/import_failure.hpp"

extern "C" {
#include "renderer/image/file_access.h"
#include "renderer/scene/scene.h"
}

struct obj_import {
    struct scene *scene = nullptr;
    std::string folder;                           // canonical; empty to read no other files
    std::map<std::string, uint32_t> material_ids; // in the scene, by name
    std::map<std::string, uint32_t> warned;
};

// Adds a warning once for each text.
void obj_warn_once(obj_import &import, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

// obj_text.cpp: brings OBJ and MTL text into the form that tinyobjloader reads rightly.

// The OBJ text with continued lines joined and only the statements that are imported: smoothing
// groups become group statements with a name of OBJ_SMOOTHING_PREFIX and the number. The rest of
// each mtllib line goes to `out_libraries`. Fails for face indices of ten digits and more.
std::string obj_normalize_text(const char *bytes, size_t size,
                               std::vector<std::string> &out_libraries);

#define OBJ_SMOOTHING_PREFIX '\x01'

// The MTL text with texture options reduced to -bm and spaces in file names encoded, and with
// OBJ_PBR_KEY set where a material has metallic-roughness keys.
std::string obj_normalize_materials(const char *bytes, size_t size);

#define OBJ_PBR_KEY "voxcast_pbr"

// A file name as obj_normalize_materials() left it, to the name in the file with forward slashes.
std::string obj_decode_name(const std::string &encoded);

// obj_material.cpp

// Reads the material libraries, whole lines or lists of names, and adds a default material.
void obj_import_materials(obj_import &import, const std::vector<std::string> &libraries);

// obj_picture.cpp: pictures that OBJ materials need and files do not have. Each result is a new
// picture with one reference; NULL when out of memory.

// The base colour with the mask's value as alpha, of the larger size of the two. `color` may be
// NULL: white.
struct image *obj_merge_mask(const struct image *color, const struct image *mask);

// Roughness in G and metallic in B, as glTF has it; either may be NULL: 1.
struct image *obj_merge_metallic_roughness(const struct image *metallic,
                                           const struct image *roughness);

// A tangent-space normal map of heights 0..1, `multiplier` times deeper.
struct image *obj_make_normal_map(const struct image *heights, float multiplier);

// Whether a picture given as a height map is a normal map already: bluish throughout.
bool obj_is_normal_map(const struct image *image);

// obj_polygon.cpp

// Cuts a simple polygon, convex or not, into triangles: appends triples of corner numbers. Time is
// linear for convex polygons, and at worst quadratic. Polygons that are not simple get some
// triangles, size - 2 of them in any case.
void obj_triangulate(const std::vector<const float *> &corners, std::vector<uint32_t> &out);

#endif
