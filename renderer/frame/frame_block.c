#include "renderer/frame/frame_block.h"

#include <math.h>
#include <string.h>

#include "renderer/camera.h"
#include "renderer/frame/frame.h"
#include "renderer/gpu_scene/gpu_scene.h"
#include "renderer/gpu_scene/bvh.h"
#include "renderer/frame/view.h"

// Near plane relative to the scene's diagonal, and its maximum in m: near objects stay visible
// however large the scene is. Reversed Z keeps the precision anyway.
#define NEAR_FRACTION 1e-5f
#define NEAR_MAX_M    5e-5f

static float near_of(const struct frame *frame)
{
    return fminf(frame->gpu_scene->diagonal_m * NEAR_FRACTION, NEAR_MAX_M);
}

// Rays span the output's aspect, whatever the rendered size was rounded to.
static float aspect_of(const struct frame *frame)
{
    return (float)frame->params->width / (float)frame->params->height;
}

void frame_clip_from_world(const struct frame *frame, mat4 out_clip_from_world)
{
    struct camera_frame camera;
    camera_frame_init(&camera, &frame->camera);
    camera_clip_from_world(&camera, frame->camera.eye, aspect_of(frame), near_of(frame),
                           out_clip_from_world);
}

static void fill_camera(const struct frame *frame, struct frame_block *block)
{
    struct camera_frame camera;
    camera_frame_init(&camera, &frame->camera);
    block->near_m = near_of(frame);
    float aspect = aspect_of(frame);
    frame_clip_from_world(frame, block->clip_from_world);
    memcpy(block->eye, frame->camera.eye, sizeof(vec3));
    memcpy(block->forward, camera.forward, sizeof(vec3));
    for (int axis = 0; axis < 3; axis++) {
        float right = camera.right[axis] * camera.tan_half_fov * aspect;
        float up = camera.up[axis] * camera.tan_half_fov;
        block->ray_corner[axis] = camera.forward[axis] - right + up;
        block->ray_dx[axis] = 2.0f * right / (float)frame->plan->width;
        block->ray_dy[axis] = -2.0f * up / (float)frame->plan->height;
    }
}

static void fill_sizes(const struct frame *frame, struct frame_block *block)
{
    const struct frame_params *params = frame->params;
    size_t offsets[3];
    uint32_t pitches[3];
    frame_plan_output_layout(params, offsets, pitches);
    memcpy(block->render_size, (uvec2){frame->plan->width, frame->plan->height}, sizeof(uvec2));
    memcpy(block->tile_count, (uvec2){frame->plan->tiles_x, frame->plan->tiles_y}, sizeof(uvec2));
    memcpy(block->output_size, (uvec2){params->width, params->height}, sizeof(uvec2));
    block->luma_pitch_bytes = pitches[0];
    block->chroma_pitch_bytes = pitches[1];
}

static void fill_display(const struct frame *frame, struct frame_block *block)
{
    const struct frame_params *params = frame->params;
    const struct render_settings *settings = &params->settings;
    bool fixed = settings->exposure_mode == EXPOSURE_FIXED;
    block->debug_view = (uint32_t)params->debug_view;
    block->debug_level = frame_plan_debug_level(&frame->inputs);
    block->debug_face = (uint32_t)params->debug_face;
    block->exposure_scale = fixed ? exp2f(settings->exposure_ev) : 0.0f;
    block->exposure_bias = exp2f(settings->exposure_ev);
}

void frame_block_fill_tables(const struct scene_tables *tables, struct frame_block *block)
{
    block->first_instance = tables->first[TABLE_INSTANCES];
    block->first_id_block = tables->first[TABLE_ID_BLOCKS];
    block->first_material = tables->first[TABLE_MATERIALS];
    block->first_texture = tables->first[TABLE_TEXTURES];
    block->first_light = tables->first[TABLE_LIGHTS];
    block->first_area_light = tables->first[TABLE_AREA_LIGHTS];
    block->environment_texel = tables->first[TABLE_ENVIRONMENT];
}

void frame_block_fill(const struct frame *frame, struct frame_block *block)
{
    const struct gpu_scene *gpu_scene = frame->gpu_scene;
    const struct render_settings *settings = &frame->params->settings;
    const struct scene_environment *environment = &gpu_scene->scene->environment;
    *block = (struct frame_block){0};
    fill_camera(frame, block);
    fill_sizes(frame, block);
    fill_display(frame, block);
    block->scene_diagonal_m = gpu_scene->diagonal_m;
    block->light_count = gpu_scene->counts.lights;
    block->area_light_count = gpu_scene->counts.area_lights;
    block->light_mask_words = (gpu_scene->counts.lights + 31) / 32;
    float min_distance_m =
        fminf(LIGHT_MIN_DISTANCE_FRACTION * gpu_scene->diagonal_m, LIGHT_MIN_DISTANCE_M);
    block->light_min_distance2 = min_distance_m * min_distance_m;
    block->cascade_count = frame->view->cascade_count;
    block->shadow_tap_count = frame->plan->quality.shadow_taps;
    block->shadow_near_m = gpu_scene_shadow_near_m(gpu_scene);
    block->all_blinn_phong = settings->shading_model == SHADING_MODEL_BLINN_PHONG;
    block->specular_max_roughness = frame->plan->quality.specular_roughness;
    block->environment_intensity = environment->intensity;
    block->environment_rotation_rad = environment->rotation_rad;
    block->texture_max_anisotropy = frame->plan->quality.texture_anisotropy;
    block->texture_dither_levels = gpu_get_info(frame->gpu)->software ? 1.0f : 0.0f;
    frame_block_fill_tables(&gpu_scene->tables, block);
    if (gpu_scene->bvh)
        memcpy(block->bvh_origin, gpu_scene->bvh->center, sizeof(vec3));
    block->ray_min_offset_m = gpu_scene->diagonal_m * NEAR_FRACTION;
}
