// Indirect diffuse light: from the irradiance cache, or by cones or rays at pixels.
#include "renderer/passes/pass.h"

enum { PROGRAM_RAYS, PROGRAM_FILTER, PROGRAM_CONES, PROGRAM_SHADE, PROGRAM_COUNT };

static bool add_sample(const struct frame *frame, const struct pass *pass, bool rays,
                       struct error *out_error)
{
    const struct gpu_program *program =
        pass_program(frame, pass, rays ? PROGRAM_RAYS : PROGRAM_CONES, out_error);
    if (!program)
        return false;
    pass_dispatch_pixels(frame, program, frame->plan->gather_step);
    gpu_barrier(frame->gpu);
    return !rays || filter_accumulation(frame, pass, PROGRAM_FILTER, out_error);
}

static bool indirect_diffuse_run(struct frame *frame, const struct pass *pass,
                                 struct error *out_error)
{
    const struct accumulation_plan *accumulation = &frame->plan->accumulation;
    bool cached = accumulation->gather == GATHER_CACHE;
    if (!cached && accumulation->sample &&
        !add_sample(frame, pass, accumulation->gather == GATHER_RAYS, out_error))
        return false;
    if (accumulation->only)
        return true;
    const struct gpu_program *program = pass_program(frame, pass, PROGRAM_SHADE, out_error);
    if (!program)
        return false;
    pass_dispatch_pixels(frame, program, cached ? 2 : 1);
    return true;
}

#define EFFECTS                                                                                    \
    (EFFECT_BIT(EFFECT_SPECULAR) | EFFECT_BIT(EFFECT_CLIP_LEVELS) |                                \
     EFFECT_BIT(EFFECT_AMBIENT_OCCLUSION) | EFFECT_BIT(EFFECT_ENVIRONMENT_LIGHT) |                 \
     EFFECT_BIT(EFFECT_INDIRECT_SPECULAR))
#define SWITCHES                                                                                   \
    (SWITCH_BIT(VOXEL_DIRECTIONS) | SWITCH_BIT(CACHED) | SWITCH_BIT(GATHER_STEP) |                 \
     SWITCH_BIT(FILTERED) | SWITCH_BIT(ALONE))

const struct pass indirect_diffuse_pass = {
    .reads = HIT_READS | RESOURCE(GBUFFER) | RESOURCE(DEPTH) | RESOURCE(VOXELS) |
             RESOURCE(IRRADIANCE) | RESOURCE(RADIANCE) | RESOURCE(ENVIRONMENT),
    .writes = RESOURCE(RADIANCE) | RESOURCE(ACCUMULATION),
    .program_count = PROGRAM_COUNT,
    .programs = {{"gi/ray_diffuse.comp", HIT_EFFECTS, HIT_SWITCHES, HIT_FIXED},
                 {"gi/accumulation_filter.comp", 0, SWITCH_BIT(GATHER_STEP), "SPECULAR_LOBE 0\n"},
                 {"gi/pixel_cones.comp", EFFECTS, SWITCHES, NULL},
                 {"gi/indirect_diffuse.comp", EFFECTS, SWITCHES, NULL}},
    .run = indirect_diffuse_run,
};
