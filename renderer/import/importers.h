// The importers of scene files. A new one has two functions here and a row in scene_load.c.
#ifndef VOXCAST_RENDERER_IMPORT_IMPORTERS_H
#define VOXCAST_RENDERER_IMPORT_IMPORTERS_H

#include <stddef.h>

#include "renderer/error.h"
#include "renderer/scene/scene.h"

struct importer {
    const char *extension; // ".gltf"
    const char *format;    // for people
    struct scene *(*file)(const char *path, struct error *out_error);

    // The same on `size` bytes, for scenes without a file and for fuzzing. `base_folder` is the
    // canonical folder of the files that they may name; NULL refuses all files.
    struct scene *(*memory)(const void *bytes, size_t size, const char *base_folder,
                            struct error *out_error);
};

// `index` counts from 0; NULL past the last.
const struct importer *importer_at(uint32_t index);

// By the extension, upper or lower case; NULL for none.
const struct importer *importer_of(const char *path);

struct scene *scene_import_gltf(const char *path, struct error *out_error);
struct scene *scene_import_gltf_memory(const void *bytes, size_t size, const char *base_folder,
                                       struct error *out_error);
struct scene *scene_import_obj(const char *path, struct error *out_error);
struct scene *scene_import_obj_memory(const void *bytes, size_t size, const char *base_folder,
                                      struct error *out_error);

#endif
