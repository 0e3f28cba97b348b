// Shared by the passes that trace rays: programs that shade hits, and the filter.
#include <stdio.h>

#include "renderer/gpu/program.h"
#include "renderer/passes/pass.h"
#include "renderer/gpu_scene/gpu_scene.h"

// Effects that shade hits. Light tiles are in screen space and do not apply to hits.
static const struct pass shading_of_hits = {
    .effects_used = (SURFACE_EFFECTS | DIRECT_LIGHT_EFFECTS | EFFECT_BIT(EFFECT_ALPHA_MASK) |
                     EFFECT_BIT(EFFECT_ENVIRONMENT_LIGHT) | EFFECT_BIT(EFFECT_CLIP_LEVELS) |
                     EFFECT_BIT(EFFECT_MULTI_BOUNCE)) &
                    ~EFFECT_BIT(EFFECT_LIGHT_TILES),
};

const struct gpu_program *hit_program(const struct frame *frame, const struct pass *pass,
                                      const char *shader, struct error *out_error)
{
    char extra[128];
    snprintf(extra, sizeof(extra), "GATHER_STEP %u\nLIGHT_TILES 0\nSHADOW_TAPS 1u\nLIT_HITS %d\n",
             frame_gather_step(frame), frame->gpu_scene->counts.lights <= FRAME_MAX_RAY_LIGHTS);
    const struct gpu_program *program =
        voxel_program(frame, &shading_of_hits, shader, extra, out_error);
    if (program)
        pass_check_bindings(frame, pass, program);
    return program;
}

bool filter_accumulation(const struct frame *frame, const struct pass *pass, bool specular,
                         struct error *out_error)
{
    if (frame->accumulate_only)
        return true;
    char extra[48];
    uint32_t step = frame_gather_step(frame), pixels = step * GROUP_EDGE;
    snprintf(extra, sizeof(extra), "GATHER_STEP %u\nSPECULAR_LOBE %d\n", step, specular);
    const struct gpu_program *program =
        gpu_program_get(frame->gpu, "gi/accumulation_filter.comp", extra, out_error);
    if (!program)
        return false;
    pass_check_bindings(frame, pass, program);
    gpu_dispatch(frame->gpu, program, (frame->width + pixels - 1) / pixels,
                 (frame->height + pixels - 1) / pixels, 1);
    gpu_barrier(frame->gpu);
    return true;
}
