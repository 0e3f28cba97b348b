// Rasterises ids and depth of opaque and alpha-masked triangles.
#include "renderer/frame/view.h"
#include "renderer/passes/pass.h"

enum { PROGRAM_OPAQUE, PROGRAM_MASKED, PROGRAM_COUNT };

static bool visibility_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    struct view *view = frame->view;
    static const enum draw_kind kinds[] = {DRAW_OPAQUE, DRAW_MASKED};
    gpu_begin_raster(frame->gpu, &(struct gpu_raster_params){
                                     .framebuffer = view->framebuffer,
                                     .width = frame->plan->width,
                                     .height = frame->plan->height,
                                     .clear = true,
                                     .depth_test = GPU_DEPTH_GREATER_WRITE,
                                 });
    for (uint32_t i = 0; i < PROGRAM_COUNT; i++) {
        if (!frame->gpu_scene->drawable || !draw_list_has(&view->draws, kinds[i]))
            continue;
        const struct gpu_program *program = pass_program(frame, pass, i, out_error);
        if (!program)
            return false;
        draw_list_draw(&view->draws, frame->gpu_scene, program, kinds[i], true);
    }
    gpu_end_raster(frame->gpu);
    return true;
}

const struct pass visibility_pass = {
    .reads = RESOURCE(SCENE_TABLES) | RESOURCE(TEXTURES) | RESOURCE(GEOMETRY),
    .writes = RESOURCE(IDS) | RESOURCE(DEPTH),
    .program_count = PROGRAM_COUNT,
    .programs = {{"visibility/visibility", 0, TEXTURE_SWITCHES,
                  "ALPHA_MASK 0\nSHADOW_VIEW 0\nLIST 0\n"},
                 {"visibility/visibility", 0, TEXTURE_SWITCHES,
                  "ALPHA_MASK 1\nSHADOW_VIEW 0\nLIST 0\n"}},
    .run = visibility_run,
};
