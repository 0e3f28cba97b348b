#include "renderer/import/scene_load.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "renderer/import/importers.h"

#define BUILTIN_PREFIX "builtin:"

// One row per kind of file.
static const struct importer importers[] = {
    {".gltf", "glTF 2.0", scene_import_gltf, scene_import_gltf_memory},
    {".glb", "glTF 2.0", scene_import_gltf, scene_import_gltf_memory},
    {".obj", "Wavefront OBJ", scene_import_obj, scene_import_obj_memory},
};

#define IMPORTER_COUNT (sizeof(importers) / sizeof(importers[0]))

const struct importer *importer_at(uint32_t index)
{
    return index < IMPORTER_COUNT ? &importers[index] : NULL;
}

const char *scene_file_extension(uint32_t index)
{
    return index < IMPORTER_COUNT ? importers[index].extension : NULL;
}

const struct importer *importer_of(const char *path)
{
    const char *extension = strrchr(path, '.');
    for (size_t i = 0; i < IMPORTER_COUNT && extension && extension > path; i++)
        if (strcasecmp(extension, importers[i].extension) == 0)
            return &importers[i];
    return NULL;
}

// GLB is detected by its magic, whatever the file's name.
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
    if (has_glb_magic(path))
        return scene_import_gltf(path, out_error);
    const struct importer *importer = importer_of(path);
    if (importer)
        return importer->file(path, out_error);
    char kinds[256] = "";
    size_t length = 0;
    for (size_t i = 0; i < IMPORTER_COUNT && length < sizeof(kinds); i++)
        length += (size_t)snprintf(kinds + length, sizeof(kinds) - length, "%s (%s), ",
                                   importers[i].format, importers[i].extension);
    error_set(out_error,
              "scene '%.200s' is of no supported kind; supported are %sand the built-in scenes "
              "(builtin:NAME)",
              path, kinds);
    return NULL;
}

// Emissive textures (labels, gauges) do not count as light; uniform emission does.
static bool is_lit(const struct scene *scene)
{
    if (scene->light_count > 0) {
        return true;
    }
    for (uint32_t i = 0; i < scene->material_count; i++) {
        const struct scene_material *material = &scene->materials[i];
        const float *emissive = material->emissive;
        bool constant = material->textures[SCENE_TEXTURE_EMISSIVE].image == SCENE_NONE;
        if (constant && material->emissive_strength > 0.0f &&
            emissive[0] + emissive[1] + emissive[2] > 0.0f) {
            return true;
        }
    }
    return false;
}

// A file without any light would render black: add an overcast sky.
static void add_default_sky(struct scene *scene)
{
    scene->environment = (struct scene_environment){
        .type = SCENE_ENVIRONMENT_GRADIENT,
        .intensity = 1.0f,
        .color = {0.85f, 0.92f, 1.0f},
        .horizon_color = {0.8f, 0.8f, 0.8f},
        .ground_color = {0.3f, 0.28f, 0.26f},
    };
    scene_add_warning(scene, "the file holds no light: a default sky lights it (environment.type)");
}

// Lights a scene that was loaded. False, and no scene any more, on failure.
static bool light_scene(struct scene **scene, const char *environment, bool is_file,
                        struct error *out_error)
{
    if (!environment) {
        if (is_file && !is_lit(*scene)) {
            add_default_sky(*scene);
        }
        return true;
    }
    if (!scene_load_environment(environment, &(*scene)->environment, out_error)) {
        scene_destroy(scene);
        return false;
    }
    const char *warning = (*scene)->environment.image->warning;
    if (warning[0]) {
        scene_add_warning(*scene, "environment: %s", warning);
    }
    return true;
}

struct scene *scene_load(const char *source, struct error *out_error)
{
    return scene_load_in_environment(source, NULL, out_error);
}

struct scene *scene_load_in_environment(const char *source, const char *environment,
                                        struct error *out_error)
{
    struct scene *scene;
    bool is_file = false;
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
        is_file = true;
    }
    if (scene && !canonical) {
        scene_destroy(&scene);
        error_set(out_error, "out of memory");
    }
    if (!scene || !light_scene(&scene, environment, is_file, out_error)) {
        free(canonical);
        return NULL;
    }
    free(scene->source_path);
    scene->source_path = canonical;
    return scene;
}
