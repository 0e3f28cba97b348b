// Shades blended and transmissive layers per pixel in depth order.
#include <stdio.h>
#include <string.h>

#include "renderer/passes/pass.h"
#include "renderer/frame/view.h"

static const char *transparency_skip_reason(const struct frame *frame)
{
    if (!(frame->plan.bits & EFFECT_BIT(EFFECT_TRANSPARENCY)))
        return "no transparent material in the scene";
    if (frame->params->debug_view != DEBUG_VIEW_FINAL &&
        frame->params->debug_view != DEBUG_VIEW_TILE_CLASSES)
        return "debug views show opaque surfaces";
    return draw_list_has(&frame->view->draws, DRAW_TRANSPARENT) ? NULL : "none of it is in view";
}

static bool transparency_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    struct view *view = frame->view;
    const struct gpu_program *list = pass_program(
        frame, pass, "visibility/visibility", "ALPHA_MASK 0\nSHADOW_VIEW 0\nLIST 1\n", out_error);
    const struct gpu_program *tiles =
        list ? pass_program(frame, pass, "light/transparent_tiles.comp", "", out_error) : NULL;
    char extra[32];
    snprintf(extra, sizeof(extra), "CONE_SHADOWS %d\n", frame_has_cone_shadows(frame));
    const struct gpu_program *shade =
        !tiles ? NULL
        : frame_has_cones(frame)
            ? voxel_program(frame, pass, "light/transparency.comp", extra, out_error)
            : pass_program(frame, pass, "light/transparency.comp", "", out_error);
    if (!shade)
        return false;
    gpu_buffer_clear(view->fragments);
    uint32_t counts[4] = {0, frame->width * frame->height * BLENDED_PER_PIXEL, 0, 0};
    gpu_buffer_write(view->fragments, 0, sizeof(counts), counts);
    gpu_begin_raster(frame->gpu, &(struct gpu_raster_params){
                                     .framebuffer = view->list_framebuffer,
                                     .width = frame->width,
                                     .height = frame->height,
                                     .depth_test = GPU_DEPTH_GREATER_READ,
                                 });
    draw_list_draw(&view->draws, frame->gpu_scene, list, DRAW_TRANSPARENT, true);
    gpu_end_raster(frame->gpu);
    gpu_barrier(frame->gpu);
    if (frame->params->debug_view == DEBUG_VIEW_TILE_CLASSES)
        return true; // shows where layers are, not how they look
    static const uint32_t no_groups[4] = {0, 1, 1, 0};
    gpu_buffer_write(view->transparent_tiles, 0, sizeof(no_groups), no_groups);
    uint32_t tile_count = ((frame->width + GROUP_EDGE - 1) / GROUP_EDGE) *
                          ((frame->height + GROUP_EDGE - 1) / GROUP_EDGE);
    gpu_dispatch(frame->gpu, tiles, (tile_count + LINEAR_GROUP - 1) / LINEAR_GROUP, 1, 1);
    gpu_barrier(frame->gpu);
    gpu_dispatch_indirect(frame->gpu, shade, view->transparent_tiles, 0);
    return true;
}

const struct pass transparency_pass = {
    .name = "transparency",
    .effects_used = SURFACE_EFFECTS | DIRECT_LIGHT_EFFECTS | EFFECT_BIT(EFFECT_ENVIRONMENT) |
                    EFFECT_BIT(EFFECT_ENVIRONMENT_LIGHT) | EFFECT_BIT(EFFECT_REFRACTION) |
                    EFFECT_BIT(EFFECT_AMBIENT_OCCLUSION) | EFFECT_BIT(EFFECT_CLIP_LEVELS),
    .reads = RESOURCE(DEPTH) | RESOURCE(SHADOW_MAP) | RESOURCE(VOXEL_RADIANCE) |
             RESOURCE(IRRADIANCE) | RESOURCE(LIGHT_MASKS) | RESOURCE(RADIANCE) |
             RESOURCE(ENVIRONMENT) | RESOURCE(GEOMETRY) | RESOURCE(LIGHTS) | RESOURCE(MATERIALS) |
             RESOURCE(VOXELS),
    .writes = RESOURCE(FRAGMENTS) | RESOURCE(RADIANCE) | RESOURCE(TILES),
    .skip_reason = transparency_skip_reason,
    .run = transparency_run,
};
