// Shades blended and transmissive layers per pixel in depth order.
#include "renderer/frame/view.h"
#include "renderer/passes/pass.h"

enum { PROGRAM_LIST, PROGRAM_TILES, PROGRAM_SHADE, PROGRAM_COUNT };

static bool transparency_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    struct view *view = frame->view;
    uint32_t width = frame->plan->width, height = frame->plan->height;
    struct gpu_buffer *fragments = view->buffers[RESOURCE_FRAGMENTS];
    const struct gpu_program *programs[PROGRAM_COUNT];
    if (!pass_programs(frame, pass, programs, out_error))
        return false;
    gpu_buffer_clear(fragments);
    const uint32_t head[8] = {0, width * height * BLENDED_PER_PIXEL, 0, 0, 0, 1, 1, 0};
    gpu_buffer_write(fragments, 0, sizeof(head), head);
    gpu_begin_raster(frame->gpu, &(struct gpu_raster_params){
                                     .framebuffer = view->list_framebuffer,
                                     .width = width,
                                     .height = height,
                                     .depth_test = GPU_DEPTH_GREATER_READ,
                                 });
    draw_list_draw(&view->draws, frame->gpu_scene, programs[PROGRAM_LIST], DRAW_TRANSPARENT, true);
    gpu_end_raster(frame->gpu);
    gpu_barrier(frame->gpu);
    if (frame->params->debug_view == DEBUG_VIEW_TILE_CLASSES)
        return true; // shows where layers are, not how they look
    uint32_t tile_count =
        ((width + GROUP_EDGE - 1) / GROUP_EDGE) * ((height + GROUP_EDGE - 1) / GROUP_EDGE);
    gpu_dispatch(frame->gpu, programs[PROGRAM_TILES],
                 (tile_count + LINEAR_GROUP - 1) / LINEAR_GROUP, 1, 1);
    gpu_barrier(frame->gpu);
    gpu_dispatch_indirect(frame->gpu, programs[PROGRAM_SHADE], fragments, 4 * sizeof(uint32_t));
    return true;
}

#define EFFECTS                                                                                    \
    (DIRECT_LIGHT_EFFECTS | EFFECT_BIT(EFFECT_VERTEX_COLORS) | EFFECT_BIT(EFFECT_ENVIRONMENT) |    \
     EFFECT_BIT(EFFECT_ENVIRONMENT_LIGHT) | EFFECT_BIT(EFFECT_REFRACTION) |                        \
     EFFECT_BIT(EFFECT_AMBIENT_OCCLUSION) | EFFECT_BIT(EFFECT_CLIP_LEVELS))

const struct pass transparency_pass = {
    .reads = RESOURCE(DEPTH) | RESOURCE(SHADOW_MAP) | RESOURCE(VOXEL_RADIANCE) |
             RESOURCE(IRRADIANCE) | RESOURCE(LIGHT_MASKS) | RESOURCE(RADIANCE) |
             RESOURCE(ENVIRONMENT) | RESOURCE(GEOMETRY) | RESOURCE(SCENE_TABLES) |
             RESOURCE(SCENE_TABLES) | RESOURCE(TEXTURES) | RESOURCE(VOXELS),
    .writes = RESOURCE(FRAGMENTS) | RESOURCE(RADIANCE),
    .program_count = PROGRAM_COUNT,
    .programs = {{"visibility/visibility", 0, TEXTURE_SWITCHES,
                  "ALPHA_MASK 0\nSHADOW_VIEW 0\nLIST 1\n"},
                 {"light/transparent_tiles.comp", 0, 0, NULL},
                 {"light/transparency.comp", EFFECTS,
                  TEXTURE_SWITCHES | SWITCH_BIT(VOXEL_DIRECTIONS) | SWITCH_BIT(LAYER_CONE_SHADOWS),
                  NULL}},
    .run = transparency_run,
};
