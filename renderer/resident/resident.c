#include "renderer/resident/resident.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/resident/triangle_tree.h"

// Where the scene lies, rounded to multiples of a power of two about as large as it is.
static void choose_origin(struct resident *resident)
{
    double low[3], high[3], extent = 0.0;
    if (!scene_bounds(resident->scene, low, high))
        return;
    for (int axis = 0; axis < 3; axis++)
        extent = fmax(extent, high[axis] - low[axis]);
    if (!(extent > 0.0) || !isfinite(extent))
        return;
    double step = exp2(ceil(log2(extent)) + 1.0);
    for (int axis = 0; axis < 3; axis++)
        resident->origin[axis] = step * round(0.5 * (low[axis] + high[axis]) / step);
}

void resident_place(const struct resident *resident, const float world[3], float out_place[3])
{
    for (int axis = 0; axis < 3; axis++)
        out_place[axis] = (float)((double)world[axis] - resident->origin[axis]);
}

struct resident *resident_create(struct gpu *gpu, const struct scene *scene,
                                 struct error *out_error)
{
    struct resident *resident = calloc(1, sizeof(*resident));
    if (!resident) {
        error_set(out_error, "out of memory");
        return NULL;
    }
    resident->gpu = gpu;
    resident->scene = scene;
    choose_origin(resident);
    if (!resident_upload_geometry(resident) || !resident_upload_textures(resident) ||
        !resident_upload_materials(resident) || !resident_upload_instances(resident) ||
        !resident_upload_lights(resident) || !resident_upload_environment(resident)) {
        error_set(out_error, "scene \"%s\" does not fit into GPU memory", scene->name);
        resident_destroy(&resident);
        return NULL;
    }
    resident_count_materials(resident);
    resident->seen = scene->revisions;
    return resident;
}

void resident_destroy(struct resident **resident_slot)
{
    struct resident *resident = *resident_slot;
    *resident_slot = NULL;
    if (!resident)
        return;
    gpu_geometry_destroy(&resident->geometry);
    gpu_buffer_destroy(&resident->vertices);
    gpu_buffer_destroy(&resident->indices);
    gpu_buffer_destroy(&resident->raster_vertices);
    gpu_buffer_destroy(&resident->raster_indices);
    gpu_buffer_destroy(&resident->instance_blocks);
    gpu_buffer_destroy(&resident->id_blocks);
    gpu_buffer_destroy(&resident->materials);
    gpu_buffer_destroy(&resident->texture_blocks);
    gpu_buffer_destroy(&resident->lights);
    gpu_buffer_destroy(&resident->area_lights);
    gpu_buffer_destroy(&resident->environment);
    for (int space = 0; space < 2; space++) {
        for (uint32_t i = 0; i < MAX_CLASSES_PER_SPACE; i++)
            gpu_texture_destroy(&resident->texture_spaces[space].classes[i]);
        free(resident->texture_spaces[space].places);
    }
    triangle_tree_destroy(&resident->tree);
    shadow_map_destroy(&resident->shadow_map);
    gpu_texture_destroy(&resident->environment_levels);
    gpu_texture_destroy(&resident->environment_background);
    free(resident->instances);
    free(resident->clusters);
    free(resident);
}

bool resident_update(struct resident *resident, struct error *out_error)
{
    const struct scene_revisions *now = &resident->scene->revisions;
    struct scene_revisions *seen = &resident->seen;
    bool geometry = now->geometry != seen->geometry;
    bool materials = now->materials != seen->materials;
    bool transforms = now->transforms != seen->transforms;
    bool lights = now->lights != seen->lights;
    bool done = true;
    if (geometry)
        done = done && resident_upload_geometry(resident) && resident_upload_textures(resident);
    if (geometry || materials)
        done = done && resident_upload_materials(resident);
    if (geometry || materials || transforms)
        done = done && resident_upload_instances(resident);
    if (geometry || materials || transforms || lights)
        done = done && resident_upload_lights(resident);
    if (now->environment != seen->environment)
        done = done && resident_upload_environment(resident);
    resident_count_materials(resident);
    if (!done)
        return error_set(out_error, "scene \"%s\" does not fit into GPU memory after an edit",
                         resident->scene->name);
    *seen = *now;
    return true;
}

static bool light_has_size(const struct scene_light *light)
{
    return !light->removed && light->enabled && light->casts_shadow && light->radius_m > 0.0f &&
           light->intensity > 0.0f;
}

static bool material_is_emissive(const struct scene_material *material)
{
    return material->emissive_strength > 0.0f &&
           (material->emissive[0] > 0.0f || material->emissive[1] > 0.0f ||
            material->emissive[2] > 0.0f);
}

void resident_count_materials(struct resident *resident)
{
    const struct scene *scene = resident->scene;
    struct resident_counts *counts = &resident->counts;
    counts->textured_materials = 0;
    counts->masked_materials = 0;
    counts->transparent_materials = 0;
    counts->blinn_phong_materials = 0;
    counts->specular_materials = 0;
    counts->lit_materials = 0;
    counts->emissive_materials = 0;
    counts->reflective_materials = 0;
    counts->transmissive_materials = 0;
    counts->sized_lights = counts->area_lights - counts->large_area_lights;
    for (uint32_t i = 0; i < scene->light_count; i++)
        counts->sized_lights += light_has_size(&scene->lights[i]);
    bool *counted = calloc(scene->material_count ? scene->material_count : 1, sizeof(bool));
    if (!counted)
        return;
    for (uint32_t i = 0; i < counts->instances; i++) {
        const struct resident_instance *instance = &resident->instances[i];
        uint32_t id = scene->primitives[instance->primitive].material;
        if (!instance->visible || counted[id])
            continue;
        counted[id] = true;
        const struct scene_material *material = &scene->materials[id];
        bool textured = false;
        for (int slot = 0; slot < SCENE_TEXTURE_SLOT_COUNT; slot++)
            textured = textured || material->textures[slot].image != SCENE_NONE;
        counts->textured_materials += textured;
        counts->masked_materials += material->alpha_mode == SCENE_ALPHA_MASK;
        counts->transparent_materials +=
            material->alpha_mode == SCENE_ALPHA_BLEND || material->transmission > 0.0f;
        counts->blinn_phong_materials += material->shading == SCENE_SHADING_BLINN_PHONG;
        bool dielectric = material->ior != 1.0f && material->specular > 0.0f;
        counts->specular_materials += material->metallic > 0.0f || dielectric;
        bool lit = material->shading != SCENE_SHADING_UNLIT;
        bool colored = material->base_color[0] > 0.0f || material->base_color[1] > 0.0f ||
                       material->base_color[2] > 0.0f;
        counts->lit_materials += lit;
        counts->reflective_materials += lit && (colored || dielectric);
        counts->emissive_materials += lit && material_is_emissive(material);
        counts->transmissive_materials += lit && material->transmission > 0.0f;
    }
    free(counted);
}

void resident_bind(const struct resident *resident)
{
    struct gpu *gpu = resident->gpu;
    gpu_bind_storage(gpu, BIND_INSTANCES, resident->instance_blocks);
    gpu_bind_storage(gpu, BIND_ID_BLOCKS, resident->id_blocks);
    gpu_bind_storage(gpu, BIND_VERTICES, resident->vertices);
    gpu_bind_storage(gpu, BIND_INDICES, resident->indices);
    gpu_bind_storage(gpu, BIND_MATERIALS, resident->materials);
    gpu_bind_storage(gpu, BIND_TEXTURES, resident->texture_blocks);
    gpu_bind_storage(gpu, BIND_LIGHTS, resident->lights);
    gpu_bind_storage(gpu, BIND_AREA_LIGHTS, resident->area_lights);
    gpu_bind_storage(gpu, BIND_ENVIRONMENT, resident->environment);
    gpu_bind_texture(gpu, UNIT_SHADOW_MAP, shadow_map_texture(resident->shadow_map));
    gpu_bind_texture(gpu, UNIT_ENVIRONMENT, resident->environment_levels);
    gpu_bind_texture(gpu, UNIT_BACKGROUND, resident->environment_background);
    if (resident->tree) {
        gpu_bind_texture(gpu, UNIT_TREE_NODES, resident->tree->nodes);
        gpu_bind_texture(gpu, UNIT_TREE_TRIANGLES, resident->tree->triangles);
    }
    static const uint32_t units[2] = {UNIT_COLOR_CLASSES, UNIT_DATA_CLASSES};
    for (int space = 0; space < 2; space++)
        for (uint32_t i = 0; i < resident->texture_spaces[space].class_count; i++)
            gpu_bind_texture(gpu, units[space] + i, resident->texture_spaces[space].classes[i]);
}
