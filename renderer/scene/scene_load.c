#include "renderer/scene/scene_load.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#define BUILTIN_PREFIX "builtin:"

static bool has_extension(const char *path, const char *extension)
{
    size_t length = strlen(path);
    size_t extension_length = strlen(extension);
    return length > extension_length &&
           strcasecmp(path + length - extension_length, extension) == 0;
}

// A GLB is known by its magic, whatever its name.
static bool has_glb_magic(const char *path)
{
    char magic[4] = {0};
    FILE *file = fopen(path, "rb");
    if (!file) {
        return false;
    }
    size_t count = fread(magic, 1, sizeof(magic), file);
    fclose(file);
    return count == sizeof(magic) && memcmp(magic, "glTF", sizeof(magic)) == 0;
}

static struct scene *import_file(const char *path, struct error *out_error)
{
    struct stat status;
    if (stat(path, &status) != 0 || !S_ISREG(status.st_mode)) {
        error_set(out_error, "scene '%.200s' is not a regular file", path);
        return NULL;
    }
    if (has_extension(path, ".gltf") || has_extension(path, ".glb") || has_glb_magic(path)) {
        return scene_import_gltf(path, out_error);
    }
    if (has_extension(path, ".obj")) {
        return scene_import_obj(path, out_error);
    }
    error_set(out_error,
              "scene '%.200s' is of no supported kind; supported are glTF 2.0 (.gltf, .glb), "
              "Wavefront OBJ (.obj) and the built-in scenes (builtin:NAME)",
              path);
    return NULL;
}

struct scene *scene_load(const char *source, struct error *out_error)
{
    struct scene *scene;
    char *canonical = NULL;
    if (strncmp(source, BUILTIN_PREFIX, strlen(BUILTIN_PREFIX)) == 0) {
        canonical = strdup(source);
        scene = scene_create_builtin(source + strlen(BUILTIN_PREFIX), out_error);
    } else {
        canonical = realpath(source, NULL);
        if (!canonical) {
            error_set(out_error, "scene '%.200s': %s", source, strerror(errno));
            return NULL;
        }
        scene = import_file(canonical, out_error);
    }
    if (scene && !canonical) {
        scene_destroy(&scene);
        error_set(out_error, "out of memory");
    }
    if (!scene) {
        free(canonical);
        return NULL;
    }
    free(scene->source_path);
    scene->source_path = canonical;
    return scene;
}
