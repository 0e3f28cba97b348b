#include "renderer/path_tracer/snapshot.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/path_tracer/environment.h"
#include "renderer/path_tracer/lights.h"

// Nearer to 1, refraction is below float precision.
#define MIN_REFRACTING_IOR 1.001f
#define MIN_DIAGONAL_M     1e-6

static void move_to_origin(struct snapshot *snapshot)
{
    double low[3] = {0}, high[3] = {0}, squared = 0.0;
    scene_bounds(snapshot->scene, low, high);
    for (int axis = 0; axis < 3; axis++) {
        bool finite = isfinite(low[axis]) && isfinite(high[axis]);
        snapshot->origin[axis] = finite ? 0.5 * (low[axis] + high[axis]) : 0.0;
        squared += finite ? (high[axis] - low[axis]) * (high[axis] - low[axis]) : 0.0;
    }
    snapshot->diagonal_m = (float)fmax(sqrt(squared), MIN_DIAGONAL_M);
    for (uint32_t i = 0; i < snapshot->scene->node_count; i++)
        for (int axis = 0; axis < 3; axis++) {
            float *value = &snapshot->scene->nodes[i].world_from_local[12 + axis];
            *value = (float)(*value - snapshot->origin[axis]);
        }
}

static void instance_init(struct instance *instance, const float matrix[16])
{
    for (size_t column = 0; column < 4; column++)
        instance->columns[column] = load3(matrix + 4 * column);
    for (int axis = 0; axis < 3; axis++)
        instance->normal_columns[axis] =
            cross3(instance->columns[(axis + 1) % 3], instance->columns[(axis + 2) % 3]);
    instance->stretch = length3(instance->columns[0]) + length3(instance->columns[1]) +
                        length3(instance->columns[2]);
    instance->mirrored = dot3(instance->normal_columns[0], instance->columns[0]) < 0.0f;
    for (int axis = 0; axis < 3 && instance->mirrored; axis++)
        instance->normal_columns[axis] = -instance->normal_columns[axis];
}

// Reflectance at normal incidence; in glTF IOR 0 means "reflects everything".
static float f0_from_ior(float ior)
{
    float ratio = ior > 0.0f ? (ior - 1.0f) / (ior + 1.0f) : 1.0f;
    return ratio * ratio;
}

static void fill_transmission(struct material *material, const struct scene_material *source)
{
    bool dielectric = source->shading != SCENE_SHADING_UNLIT;
    material->transmission = dielectric ? clamp01(source->transmission) : 0.0f;
    material->transmits = material->transmission > 0.0f;
    material->refracts = material->transmits && source->thickness_m > 0.0f;
    material->lets_through = material->blends || (material->transmits && !material->refracts);
    material->ior = fmaxf(source->ior, MIN_REFRACTING_IOR);
    // KHR_materials_volume: Beer's law; the attenuation colour is the transmittance over the
    // distance.
    for (int c = 0; c < 3; c++)
        material->absorption[c] =
            source->attenuation_distance_m > 0.0f
                ? -logf(fmaxf(source->attenuation_color[c], 1e-6f)) / source->attenuation_distance_m
                : 0.0f;
}

static void fill_textures(struct material *material, const struct scene *scene)
{
    const struct scene_material *source = material->source;
    for (uint32_t slot = 0; slot < SCENE_TEXTURE_SLOT_COUNT; slot++) {
        if (source->textures[slot].image >= scene->image_count)
            continue;
        bool is_color = slot == SCENE_TEXTURE_BASE_COLOR || slot == SCENE_TEXTURE_EMISSIVE ||
                        slot == SCENE_TEXTURE_SPECULAR_COLOR;
        texture_init(&material->textures[slot], scene, &source->textures[slot], is_color);
        material->texture_mask |= 1u << slot;
    }
}

static void material_init(struct material *material, const struct scene *scene,
                          const struct scene_material *source, bool all_blinn_phong)
{
    *material = (struct material){
        .source = source,
        .specular_color = load3(source->specular_color),
        .emission = load3(source->emissive) * source->emissive_strength,
        .metallic = source->metallic,
        .roughness = source->roughness,
        .normal_scale = source->normal_scale,
        .f0 = f0_from_ior(source->ior),
        .f90 = source->ior == 1.0f ? 0.0f : 1.0f,
        .specular = source->specular,
        .unlit = source->shading == SCENE_SHADING_UNLIT,
        .blinn_phong = source->shading == SCENE_SHADING_BLINN_PHONG || all_blinn_phong,
        .double_sided = source->double_sided,
        .masked = source->alpha_mode == SCENE_ALPHA_MASK,
        .blends = source->alpha_mode == SCENE_ALPHA_BLEND,
    };
    memcpy(&material->base_color, source->base_color, sizeof(material->base_color));
    fill_transmission(material, source);
    fill_textures(material, scene);
    float3 emitted = material->unlit ? splat3(0.0f) : material->emission;
    if (material->texture_mask & 1u << SCENE_TEXTURE_EMISSIVE && max3(emitted) > 0.0f)
        emitted *= texture_mean(&material->textures[SCENE_TEXTURE_EMISSIVE]);
    material->emitted_luminance = luminance3(emitted);
    material->emits = material->emitted_luminance > 0.0f && isfinite(material->emitted_luminance);
}

static bool fill_tables(struct snapshot *snapshot, bool in_background)
{
    struct scene *scene = snapshot->scene;
    bool *lets_through = calloc(scene->material_count + 1, sizeof(bool));
    snapshot->instances = aligned_alloc(16, (scene->node_count + 1) * sizeof(struct instance));
    snapshot->materials = aligned_alloc(16, (scene->material_count + 1) * sizeof(struct material));
    bool done = lets_through && snapshot->instances && snapshot->materials;
    for (uint32_t i = 0; done && i < scene->node_count; i++)
        instance_init(&snapshot->instances[i], scene->nodes[i].world_from_local);
    for (uint32_t i = 0; done && i < scene->material_count; i++) {
        material_init(&snapshot->materials[i], scene, &scene->materials[i],
                      snapshot->all_blinn_phong);
        lets_through[i] = snapshot->materials[i].lets_through;
        snapshot->has_bodies = snapshot->has_bodies || snapshot->materials[i].refracts;
    }
    if (done)
        snapshot->rays = ray_scene_create_for_light(&(struct ray_scene_params){
            .scene = scene, .lets_light_pass = lets_through, .calling_thread_only = in_background});
    free(lets_through);
    return done && snapshot->rays;
}

struct snapshot *snapshot_copy(const struct scene *scene, bool all_blinn_phong,
                               struct error *out_error)
{
    struct snapshot *snapshot = calloc(1, sizeof(*snapshot));
    if (snapshot) {
        snapshot->references = 1;
        snapshot->all_blinn_phong = all_blinn_phong;
        snapshot->scene = scene_copy(scene);
    }
    if (snapshot && snapshot->scene)
        return snapshot;
    error_set(out_error, "out of memory for a copy of scene \"%s\"", scene->name);
    if (snapshot)
        snapshot_release(&snapshot);
    return NULL;
}

bool snapshot_build(struct snapshot *snapshot, bool in_background, struct error *out_error)
{
    assert(!snapshot->rays);
    move_to_origin(snapshot);
    // Textures are looked up in images from now on.
    if (pinned_images_take(&snapshot->images, snapshot->scene, false) &&
        fill_tables(snapshot, in_background)) {
        snapshot->lights = lights_create(snapshot);
        snapshot->environment = environment_create(&snapshot->scene->environment);
    }
    return (snapshot->lights && snapshot->environment) ||
           error_set(out_error, "out of memory for tracing scene \"%s\"", snapshot->scene->name);
}

struct snapshot *snapshot_create(const struct scene *scene, bool all_blinn_phong,
                                 struct error *out_error)
{
    struct snapshot *snapshot = snapshot_copy(scene, all_blinn_phong, out_error);
    if (snapshot && !snapshot_build(snapshot, false, out_error))
        snapshot_release(&snapshot);
    return snapshot;
}

struct snapshot *snapshot_retain(struct snapshot *snapshot)
{
    __atomic_fetch_add(&snapshot->references, 1, __ATOMIC_RELAXED);
    return snapshot;
}

void snapshot_release(struct snapshot **snapshot_slot)
{
    struct snapshot *snapshot = *snapshot_slot;
    *snapshot_slot = NULL;
    if (!snapshot || __atomic_fetch_sub(&snapshot->references, 1, __ATOMIC_ACQ_REL) != 1)
        return;
    ray_scene_destroy(&snapshot->rays);
    lights_destroy(&snapshot->lights);
    environment_destroy(&snapshot->environment);
    pinned_images_release(&snapshot->images);
    if (snapshot->scene)
        scene_destroy(&snapshot->scene);
    free(snapshot->instances);
    free(snapshot->materials);
    free(snapshot);
}
