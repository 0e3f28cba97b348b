#include "renderer/gpu_scene/gpu_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/gpu_scene/bvh.h"
#include "renderer/scene/scene.h"

// The scene's position, rounded to multiples of a power of two about as large as the scene.
static void choose_origin(struct gpu_scene *gpu_scene)
{
    double low[3], high[3], extent = 0.0;
    if (!scene_bounds(gpu_scene->scene, low, high))
        return;
    for (int axis = 0; axis < 3; axis++)
        extent = fmax(extent, high[axis] - low[axis]);
    if (!(extent > 0.0) || !isfinite(extent))
        return;
    double step = exp2(ceil(log2(extent)) + 1.0);
    for (int axis = 0; axis < 3; axis++)
        gpu_scene->origin[axis] = step * round(0.5 * (low[axis] + high[axis]) / step);
}

void gpu_scene_from_world(const struct gpu_scene *gpu_scene, const float world[3],
                          float out_position[3])
{
    for (int axis = 0; axis < 3; axis++)
        out_position[axis] = (float)((double)world[axis] - gpu_scene->origin[axis]);
}

struct gpu_scene *gpu_scene_create(struct gpu *gpu, const struct scene *scene,
                                   struct error *out_error)
{
    struct gpu_scene *gpu_scene = calloc(1, sizeof(*gpu_scene));
    if (!gpu_scene) {
        error_set(out_error, "out of memory");
        return NULL;
    }
    gpu_scene->gpu = gpu;
    gpu_scene->tables.gpu = gpu;
    gpu_scene->scene = scene;
    choose_origin(gpu_scene);
    if (!gpu_scene_upload_geometry(gpu_scene) || !gpu_scene_upload_textures(gpu_scene) ||
        !gpu_scene_upload_materials(gpu_scene) || !gpu_scene_upload_instances(gpu_scene) ||
        !gpu_scene_upload_lights(gpu_scene) || !gpu_scene_upload_environment(gpu_scene)) {
        error_set(out_error, "scene \"%s\" does not fit into GPU memory", scene->name);
        gpu_scene_destroy(&gpu_scene);
        return NULL;
    }
    gpu_scene_count_materials(gpu_scene);
    gpu_scene->seen = scene->revisions;
    return gpu_scene;
}

void gpu_scene_destroy(struct gpu_scene **gpu_scene_slot)
{
    struct gpu_scene *gpu_scene = *gpu_scene_slot;
    *gpu_scene_slot = NULL;
    if (!gpu_scene)
        return;
    gpu_geometry_destroy(&gpu_scene->geometry);
    gpu_buffer_destroy(&gpu_scene->vertices);
    gpu_buffer_destroy(&gpu_scene->indices);
    gpu_buffer_destroy(&gpu_scene->raster_vertices);
    gpu_buffer_destroy(&gpu_scene->raster_indices);
    scene_tables_finish(&gpu_scene->tables);
    for (int space = 0; space < 2; space++) {
        for (uint32_t i = 0; i < MAX_CLASSES_PER_SPACE; i++)
            gpu_texture_destroy(&gpu_scene->texture_spaces[space].classes[i]);
        free(gpu_scene->texture_spaces[space].image_slots);
    }
    bvh_destroy(&gpu_scene->bvh);
    shadow_map_destroy(&gpu_scene->shadow_map);
    gpu_texture_destroy(&gpu_scene->environment_levels);
    gpu_texture_destroy(&gpu_scene->environment_background);
    free(gpu_scene->instances);
    free(gpu_scene->clusters);
    free(gpu_scene->boxes);
    free(gpu_scene);
}

bool gpu_scene_update(struct gpu_scene *gpu_scene, struct error *out_error)
{
    const struct scene_revisions *now = &gpu_scene->scene->revisions;
    struct scene_revisions *seen = &gpu_scene->seen;
    bool geometry = now->geometry != seen->geometry;
    bool materials = now->materials != seen->materials;
    bool transforms = now->transforms != seen->transforms;
    bool lights = now->lights != seen->lights;
    bool done = true;
    if (geometry)
        done = done && gpu_scene_upload_geometry(gpu_scene) && gpu_scene_upload_textures(gpu_scene);
    if (geometry || materials)
        done = done && gpu_scene_upload_materials(gpu_scene);
    if (geometry || materials || transforms)
        done = done && gpu_scene_upload_instances(gpu_scene);
    if (geometry || materials || transforms || lights)
        done = done && gpu_scene_upload_lights(gpu_scene);
    if (now->environment != seen->environment)
        done = done && gpu_scene_upload_environment(gpu_scene);
    gpu_scene_count_materials(gpu_scene);
    if (!done)
        return error_set(out_error, "scene \"%s\" does not fit into GPU memory after an edit",
                         gpu_scene->scene->name);
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

void gpu_scene_count_materials(struct gpu_scene *gpu_scene)
{
    const struct scene *scene = gpu_scene->scene;
    struct gpu_scene_counts *counts = &gpu_scene->counts;
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
        const struct gpu_scene_instance *instance = &gpu_scene->instances[i];
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

struct scene_facts gpu_scene_get_facts(const struct gpu_scene *gpu_scene)
{
    const struct scene_environment *environment = &gpu_scene->scene->environment;
    const struct texture_space *spaces = gpu_scene->texture_spaces;
    return (struct scene_facts){
        .counts = gpu_scene->counts,
        .environment = environment->type != SCENE_ENVIRONMENT_NONE && environment->intensity > 0.0f,
        .cascaded_shadow = gpu_scene->directional_light != NO_SHADOW,
        .color_classes = spaces[TEXTURE_SPACE_COLOR].class_count,
        .data_classes = spaces[TEXTURE_SPACE_DATA].class_count,
        .texture_transforms = gpu_scene->texture_transforms,
        .second_uv_set = gpu_scene->second_uv_set,
    };
}

void gpu_scene_bind(const struct gpu_scene *gpu_scene)
{
    struct gpu *gpu = gpu_scene->gpu;
    gpu_bind_texels(gpu, UNIT_SCENE_TABLES, gpu_scene->tables.buffer, GPU_TEXEL_UINT4);
    gpu_bind_texels(gpu, UNIT_VERTICES, gpu_scene->vertices, GPU_TEXEL_UINT4);
    gpu_bind_texels(gpu, UNIT_TRIANGLES, gpu_scene->indices, GPU_TEXEL_UINT3);
    gpu_bind_texture(gpu, UNIT_SHADOW_MAP, shadow_map_texture(gpu_scene->shadow_map));
    gpu_bind_texture(gpu, UNIT_ENVIRONMENT, gpu_scene->environment_levels);
    gpu_bind_texture(gpu, UNIT_BACKGROUND, gpu_scene->environment_background);
    if (gpu_scene->bvh) {
        gpu_bind_texels(gpu, UNIT_BVH_NODES, gpu_scene->bvh->nodes, GPU_TEXEL_UINT4);
        gpu_bind_texels(gpu, UNIT_BVH_TRIANGLES, gpu_scene->bvh->triangles, GPU_TEXEL_UINT4);
    }
    static const uint32_t units[2] = {UNIT_COLOR_CLASSES, UNIT_DATA_CLASSES};
    for (int space = 0; space < 2; space++)
        for (uint32_t i = 0; i < gpu_scene->texture_spaces[space].class_count; i++)
            gpu_bind_texture(gpu, units[space] + i, gpu_scene->texture_spaces[space].classes[i]);
}
