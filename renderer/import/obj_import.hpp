// Shared by the parts of the OBJ importer.
#ifndef VOXCAST_RENDERER_IMPORT_OBJ_IMPORT_HPP
#define VOXCAST_RENDERER_IMPORT_OBJ_IMPORT_HPP

#include <map>
#include <string>
#include <tiny_obj_loader.h>
#include <vector>

#include "renderer/import/import_job.hpp"

struct obj_import : import_job {
    std::map<std::string, uint32_t> material_ids; // the scene's, by name
};

// obj_text.cpp: converts OBJ and MTL text to what tinyobjloader reads correctly.

// The OBJ text with continued lines joined and only the imported statements: smoothing groups
// become group statements named OBJ_SMOOTHING_PREFIX and the number. The rest of each mtllib line
// goes to `out_libraries`. Fails for face indices of ten or more digits.
std::string obj_normalize_text(const char *bytes, size_t size,
                               std::vector<std::string> &out_libraries);

#define OBJ_SMOOTHING_PREFIX '\x01'

// The MTL text with texture options reduced to -bm and spaces in file names encoded, and with
// OBJ_PBR_KEY set in materials with metallic-roughness keys.
std::string obj_normalize_materials(const char *bytes, size_t size);

#define OBJ_PBR_KEY "voxcast_pbr"

// File name encoded by obj_normalize_materials() to the name in the file, with forward slashes.
std::string obj_decode_name(const std::string &encoded);

// obj_material.cpp

// Reads the material libraries, each a whole line or a list of names, and adds a default material.
void obj_import_materials(obj_import &import, const std::vector<std::string> &libraries);

// obj_picture.cpp: images that OBJ materials need but files lack. Each result is a new image with
// one reference; NULL when out of memory.

// The base colour with the mask as alpha, in the larger of both sizes. `color` may be NULL: white.
struct image *obj_merge_mask(struct image *color, struct image *mask);

// Roughness in G and metallic in B, as in glTF; either may be NULL: 1.
struct image *obj_merge_metallic_roughness(struct image *metallic, struct image *roughness);

// A tangent-space normal map of heights 0..1 times `multiplier`.
struct image *obj_make_normal_map(struct image *heights, float multiplier);

// Whether an image given as a height map is in fact a normal map: bluish throughout.
bool obj_is_normal_map(struct image *image);

// obj_polygon.cpp

// Triangulates a simple polygon, convex or not: appends triples of corner numbers. Linear time for
// convex polygons, at worst quadratic. Polygons that are not simple still get size - 2 triangles.
void obj_triangulate(const std::vector<const float *> &corners, std::vector<uint32_t> &out);

#endif
