// Renders shadow maps of lights whose view or casters have changed, and the sun's cascades when the
// camera has left their margin.
#include <math.h>
#include <string.h>

#include "renderer/passes/pass.h"
#include "renderer/frame/view.h"

// Each cascade is this much smaller than the next; the last is the map of the whole scene.
#define CASCADE_RATIO 4.0f
// A cascade is rendered again once the camera is this far from its centre, in half-edges.
#define CASCADE_MARGIN 0.25f
// Slope-scaled bias (glPolygonOffset) away from the light, reversed Z.
#define BIAS_SLOPE    -2.5f
#define BIAS_CONSTANT -2.0f

static void fit_cascade(struct frame *frame, uint32_t i)
{
    struct view *view = frame->view;
    const struct gpu_scene *gpu_scene = frame->gpu_scene;
    // Smallest first: with n cascades, cascade i spans the scene / ratio^(n - i).
    float half =
        0.5f * gpu_scene->diagonal_m * powf(CASCADE_RATIO, -(float)(view->cascade_count - i));
    float step = half * CASCADE_MARGIN;
    vec3 center;
    for (int axis = 0; axis < 3; axis++)
        center[axis] = step * roundf(frame->camera.eye[axis] / step);
    float moved = 0.0f;
    for (int axis = 0; axis < 3; axis++)
        moved = fmaxf(moved, fabsf(frame->camera.eye[axis] - view->cascade_center[i][axis]));
    if (view->cascade_fitted[i] && moved <= 2.0f * step)
        return;
    memcpy(view->cascade_center[i], center, sizeof(center));
    vec3 low, high;
    for (int axis = 0; axis < 3; axis++)
        low[axis] = center[axis] - half;
    for (int axis = 0; axis < 3; axis++)
        high[axis] = center[axis] + half;
    gpu_scene_directional_view(gpu_scene, gpu_scene->directional_axis, low, high,
                               &view->cascades[i]);
    view->cascade_fitted[i] = true;
    view->cascade_stale[i] = true;
}

bool shadow_map_is_stale(const struct frame *frame)
{
    for (uint32_t i = 0; i < frame->gpu_scene->counts.shadow_layers; i++)
        if (frame->gpu_scene->shadow_stale[i])
            return true;
    for (uint32_t i = 0; i < frame->view->cascade_count; i++)
        if (frame->view->cascade_stale[i])
            return true;
    return false;
}

void shadow_map_fit_cascades(struct frame *frame)
{
    struct view *view = frame->view;
    struct gpu_scene *gpu_scene = frame->gpu_scene;
    uint64_t epoch = shadow_map_epoch(gpu_scene->shadow_map);
    bool lost = epoch != gpu_scene->shadow_epoch_seen;
    if (lost)
        memset(gpu_scene->shadow_stale, true, sizeof(gpu_scene->shadow_stale));
    gpu_scene->shadow_epoch_seen = epoch;
    // Depth was lost, for example because another view took cascades: render it again in place.
    if (view->shadow_epoch_seen != epoch)
        memset(view->cascade_stale, true, sizeof(view->cascade_stale));
    if (view->shadow_revision_seen != gpu_scene->shadow_revision)
        memset(view->cascade_fitted, false, sizeof(view->cascade_fitted));
    view->shadow_revision_seen = gpu_scene->shadow_revision;
    view->shadow_epoch_seen = epoch;
    for (uint32_t i = 0; i < view->cascade_count; i++)
        fit_cascade(frame, i);
    gpu_buffer_write(view->shadow_views, 0, sizeof(gpu_scene->shadow_views),
                     gpu_scene->shadow_views);
    gpu_buffer_write(view->shadow_views, sizeof(gpu_scene->shadow_views), sizeof(view->cascades),
                     view->cascades);
}

// Both are orthographic along the same axes, so they differ by a scale and an offset.
void shadow_map_relate_cascades(const struct frame *frame, struct frame_block *block)
{
    const struct view *view = frame->view;
    uint32_t sun = frame->gpu_scene->sun_shadow_view;
    block->sun_shadow_view = sun;
    for (uint32_t i = 0; i < view->cascade_count; i++) {
        mat4 scene, cascade;
        memcpy(scene, frame->gpu_scene->shadow_views[sun].clip_from_world, sizeof(scene));
        memcpy(cascade, view->cascades[i].clip_from_world, sizeof(cascade));
        for (int row = 0; row < 3; row++) {
            // The rows are parallel: compare them where the scene's is largest.
            int column = 0;
            for (int c = 1; c < 3; c++)
                if (fabsf(scene[c][row]) > fabsf(scene[column][row]))
                    column = c;
            float scale = cascade[column][row] / scene[column][row];
            float offset = cascade[3][row] - scale * scene[3][row];
            // From clip space to uv: u = 0.5 + 0.5 x, v = 0.5 - 0.5 y; depth is z itself.
            block->cascades[i].scale[row] = scale;
            block->cascades[i].offset[row] =
                row == 2 ? offset : 0.5f - 0.5f * scale + (row == 0 ? 0.5f : -0.5f) * offset;
        }
        block->cascades[i].layer =
            (float)shadow_map_cascade_layer(frame->gpu_scene->shadow_map, view->cascade_numbers[i]);
    }
}

enum { PROGRAM_OPAQUE, PROGRAM_MASKED, PROGRAM_COUNT };

static bool draw_layer(struct frame *frame, const struct pass *pass,
                       const struct gpu_framebuffer *framebuffer, const mat4 clip_from_world,
                       struct error *out_error)
{
    static const enum draw_kind kinds[] = {DRAW_OPAQUE, DRAW_MASKED};
    struct draw_list *draws = &frame->view->shadow_draws;
    draw_list_fill(draws, frame->gpu_scene, clip_from_world, NULL);
    gpu_begin_raster(frame->gpu, &(struct gpu_raster_params){
                                     .framebuffer = framebuffer,
                                     .width = SHADOW_MAP_EDGE,
                                     .height = SHADOW_MAP_EDGE,
                                     .clear = true,
                                     .depth_test = GPU_DEPTH_GREATER_WRITE,
                                     .depth_bias_slope = BIAS_SLOPE,
                                     .depth_bias_constant = BIAS_CONSTANT,
                                 });
    for (uint32_t i = 0; i < PROGRAM_COUNT; i++) {
        if (!draw_list_has(draws, kinds[i]))
            continue;
        const struct gpu_program *program = pass_program(frame, pass, i, out_error);
        if (!program)
            return false;
        draw_list_draw(draws, frame->gpu_scene, program, kinds[i], false);
    }
    gpu_end_raster(frame->gpu);
    return true;
}

static bool shadow_map_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    struct gpu_scene *gpu_scene = frame->gpu_scene;
    struct view *view = frame->view;
    for (uint32_t i = 0; i < gpu_scene->counts.shadow_layers; i++) {
        if (!gpu_scene->shadow_stale[i])
            continue;
        if (!draw_layer(frame, pass, shadow_map_light_framebuffer(gpu_scene->shadow_map, i),
                        gpu_scene->shadow_views[i].clip_from_world, out_error))
            return false;
        gpu_scene->shadow_stale[i] = false;
    }
    for (uint32_t i = 0; i < view->cascade_count; i++) {
        if (!view->cascade_stale[i])
            continue;
        if (!draw_layer(
                frame, pass,
                shadow_map_cascade_framebuffer(gpu_scene->shadow_map, view->cascade_numbers[i]),
                view->cascades[i].clip_from_world, out_error))
            return false;
        view->cascade_stale[i] = false;
    }
    return true;
}

const struct pass shadow_map_pass = {
    .reads = RESOURCE(SCENE_TABLES) | RESOURCE(TEXTURES) | RESOURCE(GEOMETRY),
    .writes = RESOURCE(SHADOW_MAP),
    .program_count = PROGRAM_COUNT,
    .programs = {{"visibility/visibility", 0, TEXTURE_SWITCHES,
                  "ALPHA_MASK 0\nSHADOW_VIEW 1\nLIST 0\n"},
                 {"visibility/visibility", 0, TEXTURE_SWITCHES,
                  "ALPHA_MASK 1\nSHADOW_VIEW 1\nLIST 0\n"}},
    .run = shadow_map_run,
};
