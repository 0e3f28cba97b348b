// The material table and its textures.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/gpu_scene/gpu_scene.h"
#include "renderer/scene/scene.h"

static_assert(TEXTURE_SLOTS == SCENE_TEXTURE_SLOT_COUNT, "shaders and scene agree on slots");

// Reflectance at normal incidence; in glTF IOR 0 means "reflects everything".
static float f0_from_ior(float ior)
{
    if (ior <= 0.0f)
        return 1.0f;
    float ratio = (ior - 1.0f) / (ior + 1.0f);
    return ratio * ratio;
}

static uint32_t log2_of(uint32_t power_of_two)
{
    uint32_t log2 = 0;
    while ((1u << log2) < power_of_two)
        log2++;
    return log2;
}

static bool has_transform(const struct scene_texture *texture)
{
    return texture->offset[0] != 0.0f || texture->offset[1] != 0.0f || texture->scale[0] != 1.0f ||
           texture->scale[1] != 1.0f || texture->rotation_rad != 0.0f;
}

static void fill_texture_block(const struct texture_space *space, struct texture_block *block,
                               const struct scene_texture *texture)
{
    const struct image_slot *image_entry = &space->image_slots[texture->image];
    float c = cosf(texture->rotation_rad), s = sinf(texture->rotation_rad);
    // KHR_texture_transform: translation * rotation * scale, rotation counter-clockwise in a frame
    // whose v points down.
    *block = (struct texture_block){
        .uv_row_u = {c * texture->scale[0], s * texture->scale[1], texture->offset[0]},
        .uv_row_v = {-s * texture->scale[0], c * texture->scale[1], texture->offset[1]},
    };
    uint32_t edge_log2 = log2_of(gpu_texture_edge(space->classes[image_entry->class_number]));
    block->sampling =
        (texture->uv_set == 1 ? TEXTURE_UV_SET_1 : 0) | (texture->nearest ? TEXTURE_NEAREST : 0) |
        ((uint32_t)texture->wrap_u << TEXTURE_WRAP_U_BIT) |
        ((uint32_t)texture->wrap_v << TEXTURE_WRAP_V_BIT) | (edge_log2 << TEXTURE_EDGE_BIT) |
        (image_entry->class_number << TEXTURE_CLASS_BIT) |
        (image_entry->layer << TEXTURE_LAYER_BIT);
}

// glTF 2.0: green is roughness, blue metallic.
static void scale_means(struct material_block *block, const struct image_slot *map)
{
    block->mean_metallic *= map->mean[2];
    block->mean_roughness *= map->mean[1];
}

static void fill_material_block(struct material_block *block, const struct scene_material *material)
{
    memcpy(block->base_color, material->base_color, sizeof(block->base_color));
    for (int c = 0; c < 3; c++) {
        block->emission[c] = material->emissive[c] * material->emissive_strength;
        block->specular_color[c] = material->specular_color[c];
        block->attenuation_color[c] = material->attenuation_color[c];
    }
    block->alpha_cutoff = material->alpha_cutoff;
    block->ior = material->ior;
    block->metallic = material->metallic;
    block->roughness = material->roughness;
    block->normal_scale = material->normal_scale;
    block->occlusion_strength = material->occlusion_strength;
    block->f0 = f0_from_ior(material->ior);
    block->specular = material->specular;
    block->transmission = material->transmission;
    block->thickness_m = material->thickness_m;
    block->attenuation_distance_m = material->attenuation_distance_m;
    block->mean_metallic = material->metallic;
    block->mean_roughness = material->roughness;
    static const uint32_t shading[] = {
        [SCENE_SHADING_PBR] = SHADE_PBR,
        [SCENE_SHADING_BLINN_PHONG] = SHADE_BLINN_PHONG,
        [SCENE_SHADING_UNLIT] = SHADE_UNLIT,
    };
    block->flags = shading[material->shading] |
                   (material->alpha_mode == SCENE_ALPHA_BLEND ? MATERIAL_ALPHA_BLEND : 0) |
                   (material->alpha_mode == SCENE_ALPHA_MASK ? MATERIAL_ALPHA_MASK : 0) |
                   (material->double_sided ? MATERIAL_DOUBLE_SIDED : 0) |
                   (material->ior == 1.0f ? MATERIAL_IOR_ONE : 0);
}

bool gpu_scene_upload_materials(struct gpu_scene *gpu_scene)
{
    const struct scene *scene = gpu_scene->scene;
    size_t count = scene->material_count ? scene->material_count : 1;
    struct material_block *materials = calloc(count, sizeof(*materials));
    struct texture_block *textures = calloc(count * TEXTURE_SLOTS, sizeof(*textures));
    bool done = materials && textures;
    gpu_scene->texture_transforms = false;
    gpu_scene->second_uv_set = false;
    for (uint32_t i = 0; done && i < scene->material_count; i++) {
        const struct scene_material *material = &scene->materials[i];
        fill_material_block(&materials[i], material);
        materials[i].first_texture = i * TEXTURE_SLOTS;
        for (int slot = 0; slot < SCENE_TEXTURE_SLOT_COUNT; slot++) {
            if (material->textures[slot].image >= scene->image_count)
                continue;
            const struct scene_texture *texture = &material->textures[slot];
            materials[i].texture_mask |= 1u << slot;
            if (slot == SCENE_TEXTURE_METALLIC_ROUGHNESS)
                scale_means(
                    &materials[i],
                    &gpu_scene->texture_spaces[TEXTURE_SPACE_DATA].image_slots[texture->image]);
            gpu_scene->texture_transforms = gpu_scene->texture_transforms || has_transform(texture);
            gpu_scene->second_uv_set = gpu_scene->second_uv_set || texture->uv_set == 1;
            fill_texture_block(&gpu_scene->texture_spaces[gpu_scene_texture_space(slot)],
                               &textures[i * TEXTURE_SLOTS + (uint32_t)slot], texture);
        }
    }
    done = done &&
           scene_tables_write(&gpu_scene->tables, TABLE_MATERIALS, materials,
                              count * sizeof(*materials)) &&
           scene_tables_write(&gpu_scene->tables, TABLE_TEXTURES, textures,
                              count * TEXTURE_SLOTS * sizeof(*textures));
    free(materials);
    free(textures);
    return done;
}
