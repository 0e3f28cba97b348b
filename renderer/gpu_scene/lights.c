// Light tables and shadow views.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/gpu_scene/gpu_scene.h"
#include "renderer/scene/placement.h"
#include "renderer/scene/scene.h"

#define MAX_SPOT_SHADOW_FOV 2.9f // radians; a wider cone gets a cube

struct light_builder {
    struct gpu_scene *gpu_scene;
    struct shadow_view_block views[MAX_SHADOW_LAYERS];
    uint32_t layers;
    const struct light_block *owners[MAX_SHADOW_LAYERS]; // light whose layers begin here, or NULL
};

// Reversed, infinite Z: depth = near / distance.
static void perspective_from(const float origin[3], const float forward[3], const float up[3],
                             float fov_rad, float near_m, mat4 out_clip_from_world)
{
    mat4 view_from_world, clip_from_view;
    vec3 target;
    glm_vec3_add((float *)origin, (float *)forward, target);
    glm_lookat_rh((float *)origin, target, (float *)up, view_from_world);
    glm_mat4_zero(clip_from_view);
    float focal = 1.0f / tanf(0.5f * fov_rad);
    clip_from_view[0][0] = focal;
    clip_from_view[1][1] = focal;
    clip_from_view[2][3] = -1.0f;
    clip_from_view[3][2] = near_m;
    glm_mat4_mul(clip_from_view, view_from_world, out_clip_from_world);
}

float gpu_scene_shadow_near_m(const struct gpu_scene *gpu_scene)
{
    return fminf(gpu_scene->diagonal_m * SHADOW_NEAR_FRACTION, SHADOW_NEAR_MAX_M);
}

static void add_perspective_view(struct light_builder *builder, const float origin[3],
                                 const float forward[3], const float up[3], float fov_rad)
{
    struct shadow_view_block *view = &builder->views[builder->layers++];
    *view = (struct shadow_view_block){0};
    float near_m = gpu_scene_shadow_near_m(builder->gpu_scene);
    perspective_from(origin, forward, up, fov_rad, near_m, view->clip_from_world);
    view->texel_m = 2.0f * tanf(0.5f * fov_rad) / (float)SHADOW_MAP_EDGE;
    view->perspective = 1;
    view->depth_range_m = near_m;
}

static void add_cube_views(struct light_builder *builder, const float origin[3])
{
    // In the order of project_to_cube() in shaders/lib/shadow.glsl.
    static const float axes[6][2][3] = {
        {{1, 0, 0}, {0, 1, 0}},  {{-1, 0, 0}, {0, 1, 0}}, {{0, 1, 0}, {0, 0, 1}},
        {{0, -1, 0}, {0, 0, 1}}, {{0, 0, 1}, {0, 1, 0}},  {{0, 0, -1}, {0, 1, 0}},
    };
    float fov = 2.0f * atanf(SHADOW_FACE_MARGIN);
    for (int face = 0; face < 6; face++)
        add_perspective_view(builder, origin, axes[face][0], axes[face][1], fov);
}

void gpu_scene_directional_view(const struct gpu_scene *gpu_scene, const float axis[3],
                                const float box_min[3], const float box_max[3],
                                struct shadow_view_block *out_view)
{
    vec3 up = {0.0f, 1.0f, 0.0f};
    if (fabsf(axis[1]) > 0.9f)
        up[0] = 1.0f, up[1] = 0.0f;
    mat4 view_from_world;
    glm_lookat_rh((vec3){0, 0, 0}, (float *)axis, up, view_from_world);
    double low[3], high[3], scene_low[3], scene_high[3];
    placement_transform_box((const float *)view_from_world, box_min, box_max, low, high);
    placement_transform_box((const float *)view_from_world, gpu_scene->bounds_min,
                            gpu_scene->bounds_max, scene_low, scene_high);
    // A flat scene still needs some depth, or the smallest bias would exceed it.
    double pad = 0.01 * gpu_scene->diagonal_m;
    low[2] = scene_low[2] - pad;
    high[2] = scene_high[2] + pad;
    *out_view = (struct shadow_view_block){0};
    mat4 clip_from_view;
    glm_mat4_zero(clip_from_view);
    double size[3];
    for (int axis_number = 0; axis_number < 3; axis_number++)
        size[axis_number] = fmax(high[axis_number] - low[axis_number], 1e-6) * 1.01;
    clip_from_view[0][0] = (float)(2.0 / size[0]);
    clip_from_view[1][1] = (float)(2.0 / size[1]);
    clip_from_view[3][0] = (float)(-(high[0] + low[0]) / size[0]);
    clip_from_view[3][1] = (float)(-(high[1] + low[1]) / size[1]);
    // View z points to the sun: its maximum gets depth 1.
    clip_from_view[2][2] = (float)(1.0 / size[2]);
    clip_from_view[3][2] = (float)(0.5 - 0.5 * (high[2] + low[2]) / size[2]);
    clip_from_view[3][3] = 1.0f;
    glm_mat4_mul(clip_from_view, view_from_world, out_view->clip_from_world);
    out_view->texel_m = (float)(fmax(size[0], size[1]) / SHADOW_MAP_EDGE);
    out_view->depth_range_m = (float)size[2];
}

static bool light_is_lit(const struct scene *scene, const struct scene_light *light)
{
    return light->enabled && !light->removed && light->intensity > 0.0f &&
           isfinite(light->intensity) &&
           (light->color[0] > 0.0f || light->color[1] > 0.0f || light->color[2] > 0.0f) &&
           scene->nodes[light->node].world_visible;
}

static void fill_light_block(struct light_block *block, const struct gpu_scene *gpu_scene,
                             uint32_t id)
{
    const struct scene *scene = gpu_scene->scene;
    const struct scene_light *light = &scene->lights[id];
    *block = (struct light_block){0};
    scene_get_light_placement(scene, id, block->position, block->direction);
    gpu_scene_from_world(gpu_scene, block->position, block->position);
    static const uint32_t types[] = {
        [SCENE_LIGHT_DIRECTIONAL] = LIGHT_DIRECTIONAL,
        [SCENE_LIGHT_POINT] = LIGHT_POINT,
        [SCENE_LIGHT_SPOT] = LIGHT_SPOT,
    };
    block->type = types[light->type];
    block->range_m = light->type == SCENE_LIGHT_DIRECTIONAL ? 0.0f : light->range_m;
    for (int c = 0; c < 3; c++)
        block->intensity[c] = light->color[c] * light->intensity;
    block->radius_m = light->radius_m;
    float inner = cosf(light->inner_cone_rad), outer = cosf(light->outer_cone_rad);
    block->cone_scale = 1.0f / fmaxf(0.001f, inner - outer);
    block->cone_offset = -outer * block->cone_scale;
    block->cos_outer_cone = outer;
    block->shadow.first_view = NO_SHADOW;
    block->shadow.light_id = id;
}

// Whether two lights can share a shadow map: same type, position and direction.
static bool has_same_shadow(const struct light_block *a, const struct light_block *b)
{
    bool turned = memcmp(a->direction, b->direction, sizeof(vec3)) != 0 ||
                  a->cos_outer_cone != b->cos_outer_cone;
    bool moved = memcmp(a->position, b->position, sizeof(vec3)) != 0;
    return a->type == b->type && (!moved || a->type == LIGHT_DIRECTIONAL) &&
           (!turned || a->type == LIGHT_POINT);
}

static bool reuse_shadow(const struct light_builder *builder, struct light_block *block)
{
    for (uint32_t i = 0; i < builder->layers; i++) {
        const struct light_block *owner = builder->owners[i];
        if (!owner || !has_same_shadow(owner, block))
            continue;
        uint32_t id = block->shadow.light_id;
        block->shadow = owner->shadow;
        block->shadow.light_id = id;
        return true;
    }
    return false;
}

static void add_light_shadow(struct light_builder *builder, struct light_block *block,
                             const struct scene_light *light)
{
    struct gpu_scene *gpu_scene = builder->gpu_scene;
    if (!light->casts_shadow || !gpu_scene->drawable || !isfinite(gpu_scene->bounds_min[0]))
        return;
    float fov = 2.0f * light->outer_cone_rad * SHADOW_FACE_MARGIN + 0.02f;
    bool spot = light->type == SCENE_LIGHT_SPOT && fov < MAX_SPOT_SHADOW_FOV;
    bool directional = light->type == SCENE_LIGHT_DIRECTIONAL;
    uint32_t needed = directional || spot ? 1 : 6;
    if (reuse_shadow(builder, block))
        return;
    if (builder->layers + needed > MAX_SHADOW_LAYERS) {
        gpu_scene->counts.unshadowed++;
        return;
    }
    builder->owners[builder->layers] = block;
    block->shadow.first_view = builder->layers;
    block->shadow.view_count = needed;
    gpu_scene->counts.single_view_shadows += needed == 1;
    gpu_scene->counts.point_shadows += needed == 6;
    if (directional) {
        gpu_scene_directional_view(gpu_scene, block->direction, gpu_scene->bounds_min,
                                   gpu_scene->bounds_max, &builder->views[builder->layers++]);
        if (gpu_scene->directional_light == NO_SHADOW) {
            gpu_scene->directional_light = block->shadow.light_id;
            gpu_scene->sun_shadow_view = block->shadow.first_view;
            memcpy(gpu_scene->directional_axis, block->direction, sizeof(vec3));
            block->shadow.has_cascades = 1;
        }
    } else if (spot) {
        vec3 up = {0.0f, 1.0f, 0.0f};
        if (fabsf(block->direction[1]) > 0.9f)
            up[0] = 1.0f, up[1] = 0.0f;
        add_perspective_view(builder, block->position, block->direction, up, fov);
    } else {
        add_cube_views(builder, block->position);
    }
}

static void add_area_light_shadow(struct light_builder *builder, struct area_light_block *light)
{
    light->shadow.first_view = NO_SHADOW;
    if (builder->layers + 6 > MAX_SHADOW_LAYERS) {
        builder->gpu_scene->counts.unshadowed++;
        return;
    }
    light->shadow.first_view = builder->layers;
    light->shadow.view_count = 6;
    builder->gpu_scene->counts.point_shadows++;
    // In front of the emitter, so that it does not shadow itself.
    vec3 origin;
    float lift = 1e-3f * sqrtf(light->area_m2);
    glm_vec3_scale(light->normal, lift, origin);
    glm_vec3_add(origin, light->center, light->center);
    add_cube_views(builder, light->center);
}

// Keeps rendered layers whose view has not changed; if any caster has changed, all are stale.
static bool keep_shadow_map(struct gpu_scene *gpu_scene, const struct light_builder *builder)
{
    uint32_t layers = builder->layers;
    if (!gpu_scene->shadow_map)
        gpu_scene->shadow_map = shadow_map_create(gpu_scene->gpu, SHADOW_MAP_EDGE);
    if (!gpu_scene->shadow_map)
        return false;
    shadow_map_reserve_lights(gpu_scene->shadow_map, layers);
    for (uint32_t i = 0; i < layers; i++)
        if (memcmp(&gpu_scene->shadow_views[i], &builder->views[i], sizeof(builder->views[i])) != 0)
            gpu_scene->shadow_stale[i] = true;
    memcpy(gpu_scene->shadow_views, builder->views, layers * sizeof(builder->views[0]));
    gpu_scene->counts.shadow_layers = layers;
    if (gpu_scene->casters_changed)
        memset(gpu_scene->shadow_stale, true, sizeof(gpu_scene->shadow_stale));
    bool changed = gpu_scene->casters_changed;
    for (uint32_t i = 0; i < layers; i++)
        changed = changed || gpu_scene->shadow_stale[i];
    gpu_scene->casters_changed = false;
    if (changed)
        gpu_scene->shadow_revision++;
    return true;
}

bool gpu_scene_upload_lights(struct gpu_scene *gpu_scene)
{
    const struct scene *scene = gpu_scene->scene;
    struct light_builder *builder = calloc(1, sizeof(*builder));
    size_t count = scene->light_count ? scene->light_count : 1;
    struct light_block *lights = calloc(count, sizeof(*lights));
    struct area_light_block area_lights[MAX_AREA_LIGHTS];
    bool done = builder && lights;
    if (done) {
        builder->gpu_scene = gpu_scene;
        struct gpu_scene_counts *counts = &gpu_scene->counts;
        counts->lights = 0;
        counts->ranged_lights = 0;
        counts->unshadowed = 0;
        counts->single_view_shadows = 0;
        counts->point_shadows = 0;
        gpu_scene->directional_light = NO_SHADOW;
        counts->area_lights = gpu_scene_find_area_lights(gpu_scene, area_lights);
        // Shadow layers go to directional lights first, then to area lights, then to the rest in
        // order.
        for (int round = 0; round < 2; round++) {
            for (uint32_t i = 0; i < scene->light_count; i++) {
                const struct scene_light *light = &scene->lights[i];
                bool directional = light->type == SCENE_LIGHT_DIRECTIONAL;
                if (!light_is_lit(scene, light) || directional != (round == 0))
                    continue;
                struct light_block *block = &lights[counts->lights++];
                fill_light_block(block, gpu_scene, i);
                add_light_shadow(builder, block, light);
                counts->ranged_lights += block->range_m > 0.0f;
            }
            for (uint32_t i = 0; round == 0 && i < counts->area_lights; i++)
                add_area_light_shadow(builder, &area_lights[i]);
        }
        done =
            scene_tables_write(&gpu_scene->tables, TABLE_LIGHTS, lights, count * sizeof(*lights)) &&
            scene_tables_write(&gpu_scene->tables, TABLE_AREA_LIGHTS, area_lights,
                               gpu_scene->counts.area_lights * sizeof(*area_lights)) &&
            keep_shadow_map(gpu_scene, builder);
    }
    free(builder);
    free(lights);
    return done;
}
