// The importers for bytes in memory: for scenes without a file, and for fuzzing.
#ifndef VOXCAST_RENDERER_IMPORT_IMPORT_MEMORY_H
#define VOXCAST_RENDERER_IMPORT_IMPORT_MEMORY_H

#include <stddef.h>

#include "renderer/error.h"
#include "renderer/scene/scene.h"

// As scene_import_gltf() and scene_import_obj(), on `size` bytes. `base_folder` is the canonical
// folder of the files that they may name; NULL refuses all files.
struct scene *scene_import_gltf_memory(const void *bytes, size_t size, const char *base_folder,
                                       struct error *out_error);
struct scene *scene_import_obj_memory(const void *bytes, size_t size, const char *base_folder,
                                      struct error *out_error);

#endif
