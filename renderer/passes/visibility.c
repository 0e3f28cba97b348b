// Rasterises ids and depth of opaque and alpha-masked triangles.
#include "renderer/frame/frame_block.h"
#include "renderer/frame/view.h"
#include "renderer/passes/pass.h"

enum { PROGRAM_OPAQUE, PROGRAM_MASKED, PROGRAM_COUNT };

static bool draw(struct frame *frame, const struct pass *pass, const struct draw_list *draws,
                 bool clear, struct error *out_error)
{
    static const enum draw_kind kinds[] = {DRAW_OPAQUE, DRAW_MASKED};
    gpu_begin_raster(frame->gpu, &(struct gpu_raster_params){
                                     .framebuffer = frame->view->framebuffer,
                                     .width = frame->plan->width,
                                     .height = frame->plan->height,
                                     .clear = clear,
                                     .depth_test = GPU_DEPTH_GREATER_WRITE,
                                 });
    for (uint32_t i = 0; i < PROGRAM_COUNT; i++) {
        if (!frame->gpu_scene->drawable || !draw_list_has(draws, kinds[i]))
            continue;
        const struct gpu_program *program = pass_program(frame, pass, i, out_error);
        if (!program)
            return false;
        draw_list_draw(draws, frame->gpu_scene, program, kinds[i], true);
    }
    gpu_end_raster(frame->gpu);
    return true;
}

// What the last frame showed, and then what that does not hide.
static bool draw_twice(struct frame *frame, const struct pass *pass, uint32_t triangles,
                       struct error *out_error)
{
    struct view *view = frame->view;
    struct occlusion *occlusion = &view->occlusion;
    const float *eye = frame->camera.eye;
    mat4 clip_from_world;
    frame_clip_from_world(frame, clip_from_world);
    if (!occlusion_list_seen(occlusion, frame->gpu_scene, clip_from_world, eye))
        return error_set(out_error, "out of memory");
    uint32_t drawn = draw_list_opaque_triangles(&occlusion->list);
    if (!draw(frame, pass, &occlusion->list, true, out_error))
        return false;
    if (!occlusion_list_rest(occlusion, frame->gpu_scene, clip_from_world, eye, view->depth,
                             frame->plan->width, frame->plan->height))
        return error_set(out_error, "out of memory");
    drawn += draw_list_opaque_triangles(&occlusion->list);
    occlusion_judge(occlusion, drawn, triangles);
    return draw(frame, pass, &occlusion->list, false, out_error);
}

static bool visibility_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    struct view *view = frame->view;
    struct occlusion *occlusion = &view->occlusion;
    uint32_t triangles = draw_list_opaque_triangles(&view->draws);
    if (!occlusion_pays(occlusion, frame->gpu_scene, triangles))
        return draw(frame, pass, &view->draws, true, out_error);
    bool done = occlusion_has_seen(occlusion, frame->gpu_scene)
                    ? draw_twice(frame, pass, triangles, out_error)
                    : draw(frame, pass, &view->draws, true, out_error);
    if (!done || occlusion->frames_until > 0)
        return done;
    return occlusion_note_seen(occlusion, frame->gpu_scene, view->ids, frame->plan->width,
                               frame->plan->height) ||
           error_set(out_error, "out of memory");
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
