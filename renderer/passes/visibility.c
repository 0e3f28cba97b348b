// Rasterises ids and depth of opaque and alpha-masked triangles.
#include "renderer/passes/pass.h"
#include "renderer/frame/view.h"

static const char *visibility_skip_reason(const struct frame *frame)
{
    return frame->visibility_changed ? NULL : "camera and geometry unchanged";
}

static bool visibility_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    struct view *view = frame->view;
    gpu_begin_raster(frame->gpu, &(struct gpu_raster_params){
                                     .framebuffer = view->framebuffer,
                                     .width = frame->width,
                                     .height = frame->height,
                                     .clear = true,
                                     .depth_test = GPU_DEPTH_GREATER_WRITE,
                                 });
    static const struct {
        enum draw_kind kind;
        const char *defines;
    } kinds[] = {{DRAW_OPAQUE, "ALPHA_MASK 0\nSHADOW_VIEW 0\nLIST 0\n"},
                 {DRAW_MASKED, "ALPHA_MASK 1\nSHADOW_VIEW 0\nLIST 0\n"}};
    for (int i = 0; i < 2; i++) {
        if (!frame->gpu_scene->drawable || !draw_list_has(&view->draws, kinds[i].kind))
            continue;
        const struct gpu_program *program =
            pass_program(frame, pass, "visibility/visibility", kinds[i].defines, out_error);
        if (!program)
            return false;
        draw_list_draw(&view->draws, frame->gpu_scene, program, kinds[i].kind, true);
    }
    gpu_end_raster(frame->gpu);
    return true;
}

const struct pass visibility_pass = {
    .name = "visibility",
    .effects_used = EFFECT_BIT(EFFECT_TEXTURES),
    .reads = RESOURCE(MATERIALS) | RESOURCE(GEOMETRY),
    .writes = RESOURCE(IDS) | RESOURCE(DEPTH),
    .skip_reason = visibility_skip_reason,
    .run = visibility_run,
};
