// Traced visibility of area and sphere lights at pixels. Without this pass, cones or the shadow map
// give it.
#include "renderer/passes/pass.h"
#include "renderer/frame/view.h"

static const char *ray_shadows_skip_reason(const struct frame *frame)
{
    if (!frame_has_cones(frame) || !frame_has(frame, EFFECT_SOFT_SHADOWS))
        return frame->view->last_plan.reasons[EFFECT_SOFT_SHADOWS];
    if (!frame_lights_pixels(frame))
        return "the debug view shows no light";
    if (!frame_traces_shadows(frame))
        return "rays do not gather yet, or lamps are too many for them";
    return frame->accumulate ? NULL : "rays are enough";
}

static bool ray_shadows_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    char extra[FRAME_VISIBILITY_DEFINES_LENGTH];
    frame_write_visibility_defines(frame, extra);
    const struct gpu_program *program =
        voxel_program(frame, pass, "gi/ray_shadows.comp", extra, out_error);
    if (!program)
        return false;
    uint32_t pixels = frame_gather_step(frame) * GROUP_EDGE;
    gpu_dispatch(frame->gpu, program, (frame->width + pixels - 1) / pixels,
                 (frame->height + pixels - 1) / pixels, 1);
    return true;
}

const struct pass ray_shadows_pass = {
    .name = "ray_shadows",
    .effects_used =
        (DIRECT_LIGHT_EFFECTS & ~EFFECT_BIT(EFFECT_LIGHT_TILES)) | EFFECT_BIT(EFFECT_ALPHA_MASK),
    .runs_while_accumulating = true,
    .reads = RESOURCE(BVH) | RESOURCE(LIGHTS) | RESOURCE(GBUFFER) | RESOURCE(DEPTH),
    .writes = RESOURCE(ACCUMULATION),
    .skip_reason = ray_shadows_skip_reason,
    .run = ray_shadows_run,
};
