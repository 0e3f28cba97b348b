// What results depend on: the scene as it is shown, the program, and the reference image.
#include <assert.h>
#include <cjson/cJSON.h>
#include <float.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "renderer/hash.h"
#include "server/accuracy/accuracy.h"

#define MAX_OPEN_FILES 16

// A file's name, size and time of change.
static uint64_t hash_file(uint64_t hash, const char *path, const struct stat *status)
{
    int64_t facts[3] = {status->st_size, status->st_mtim.tv_sec, status->st_mtim.tv_nsec};
    hash = hash_bytes(hash, path, strlen(path));
    return hash_bytes(hash, facts, sizeof(facts));
}

static uint64_t hash_path(uint64_t hash, const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 ? hash_file(hash, path, &status) : hash;
}

// nftw() passes no argument to its callback and visits files in no fixed order, so hashes are
// summed.
static uint64_t shader_hash;

static int add_shader(const char *path, const struct stat *status, int kind, struct FTW *walk)
{
    (void)walk;
    if (kind == FTW_F)
        shader_hash += hash_file(HASH_START, path, status);
    return 0;
}

static void add_hash(cJSON *object, const char *name, uint64_t hash)
{
    char text[32];
    snprintf(text, sizeof(text), "%016llx", (unsigned long long)hash);
    cJSON_AddStringToObject(object, name, text);
}

static void add_vector(cJSON *object, const char *name, const float vector[3])
{
    double values[3] = {(double)vector[0], (double)vector[1], (double)vector[2]};
    cJSON_AddItemToObject(object, name, cJSON_CreateDoubleArray(values, 3));
}

cJSON *accuracy_identity(const char *source, const char *const *sets, uint32_t set_count,
                         const struct shot *shot)
{
    const struct frame_params *params = &shot->params;
    uint64_t hash = HASH_START;
    for (uint32_t i = 0; i < shot->scene->source_file_count; i++)
        hash = hash_path(hash, shot->scene->source_files[i]);
    const struct environment_image *image = shot->scene->environment.image;
    if (image && image->path)
        hash = hash_path(hash, image->path);
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "version", VOXCAST_VERSION);
    cJSON_AddStringToObject(json, "source", source);
    add_hash(json, "files", hash);
    cJSON *list = cJSON_AddArrayToObject(json, "set");
    for (uint32_t i = 0; i < set_count; i++)
        cJSON_AddItemToArray(list, cJSON_CreateString(sets[i]));
    cJSON_AddNumberToObject(json, "width", params->width);
    cJSON_AddNumberToObject(json, "height", params->height);
    add_vector(json, "eye", params->camera.eye);
    add_vector(json, "target", params->camera.target);
    add_vector(json, "up", params->camera.up);
    cJSON_AddNumberToObject(json, "fov_y_rad", (double)params->camera.fov_y_rad);
    return json;
}

// As written in the source: 0.2, not 0.200000003.
static void add_float(cJSON *object, const char *name, float value)
{
    char text[32];
    snprintf(text, sizeof(text), "%.*g", FLT_DIG, (double)value);
    cJSON_AddNumberToObject(object, name, strtod(text, NULL));
}

static_assert(sizeof(struct quality_level) == 14 * sizeof(uint32_t),
              "a field that is new belongs into accuracy_quality_table(), too");

cJSON *accuracy_quality_table(void)
{
    cJSON *table = cJSON_CreateObject();
    for (int i = 0; i < QUALITY_COUNT; i++) {
        const struct quality_level *level = &quality_levels[i];
        cJSON *row = cJSON_AddObjectToObject(table, quality_names[i]);
        add_float(row, "resolution_scale", level->resolution_scale);
        add_float(row, "texture_anisotropy", level->texture_anisotropy);
        cJSON_AddNumberToObject(row, "shadow_taps", level->shadow_taps);
        cJSON_AddNumberToObject(row, "shadow_cascades", level->shadow_cascades);
        cJSON_AddStringToObject(row, "voxel_resolution",
                                voxel_resolution_names[level->voxel_resolution]);
        cJSON_AddStringToObject(row, "cone_set", cone_set_names[level->cone_set]);
        add_float(row, "cone_step", level->cone_step);
        cJSON_AddStringToObject(row, "gather_mode", gather_mode_names[level->gather_mode]);
        cJSON_AddNumberToObject(row, "ray_step", level->ray_step);
        cJSON_AddNumberToObject(row, "ray_pictures", level->ray_pictures);
        cJSON_AddBoolToObject(row, "cone_shadows", level->cone_shadows);
        add_float(row, "specular_roughness", level->specular_roughness);
        add_float(row, "specular_reflectance", level->specular_reflectance);
        cJSON_AddBoolToObject(row, "shared_specular_cones", level->shared_specular_cones);
    }
    return table;
}

// The reference image's own error, by every metric.
static cJSON *reference_error(const struct accuracy *accuracy, struct error *out_error)
{
    const struct picture *pictures = accuracy->reference_image.pictures;
    if (!pictures[REFERENCE_IMAGE_HALF].rgb)
        return cJSON_CreateNull();
    cJSON *json = cJSON_CreateObject();
    float *map = malloc(picture_pixel_count(&pictures[REFERENCE_IMAGE_ALL]) * sizeof(float));
    bool done = map ? accuracy_judge(accuracy, &pictures[REFERENCE_IMAGE_HALF],
                                     &pictures[REFERENCE_IMAGE_HALF_DIRECT], json, map, out_error)
                    : error_set(out_error, "out of memory");
    free(map);
    if (done)
        return json;
    cJSON_Delete(json);
    return NULL;
}

// All that results depend on besides the configuration.
cJSON *accuracy_setup(const struct accuracy *accuracy, const char *reference_path,
                      const cJSON *identity, struct error *out_error)
{
    const struct picture *reference_image =
        &accuracy->reference_image.pictures[REFERENCE_IMAGE_ALL];
    cJSON *own_error = reference_error(accuracy, out_error);
    if (!own_error)
        return NULL;
    cJSON *setup = cJSON_CreateObject();
    cJSON_AddItemToObject(setup, "scene", cJSON_Duplicate(identity, true));
    cJSON_AddStringToObject(setup, "gl_renderer",
                            renderer_get_info(accuracy->shot.renderer)->gl_renderer);
    add_hash(setup, "program", hash_path(HASH_START, "/proc/self/exe"));
    shader_hash = 0;
    nftw(renderer_get_shader_dir(accuracy->shot.renderer), add_shader, MAX_OPEN_FILES, FTW_PHYS);
    add_hash(setup, "shaders", shader_hash);
    cJSON_AddItemToObject(setup, "quality", accuracy_quality_table());
    cJSON_AddStringToObject(setup, "gi", gi_method_names[accuracy->shot.params.settings.gi_method]);
    cJSON_AddNumberToObject(setup, "frames", accuracy->frames);
    cJSON_AddNumberToObject(setup, "edits", accuracy->edits);
    cJSON_AddNumberToObject(setup, "exposure", (double)accuracy->display.exposure);
    cJSON_AddStringToObject(setup, "tonemap", tonemap_names[accuracy->display.tonemap]);
    cJSON *reference = cJSON_AddObjectToObject(setup, "reference");
    cJSON_AddStringToObject(reference, "source", reference_path ? reference_path : "traced");
    cJSON_AddNumberToObject(reference, "noise",
                            accuracy->reference_image.noise); // null if not known
    add_hash(reference, "pixels",
             hash_bytes(HASH_START, reference_image->rgb,
                        3 * sizeof(float) * picture_pixel_count(reference_image)));
    cJSON_AddItemToObject(reference, "error", own_error);
    cJSON_AddBoolToObject(reference, "direct",
                          accuracy->reference_image.pictures[REFERENCE_IMAGE_DIRECT].rgb != NULL);
    return setup;
}
