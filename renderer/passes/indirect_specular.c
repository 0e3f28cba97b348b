// Indirect specular light in the tiles that need it: one cone per pixel, or per four similar
// pixels.
#include "renderer/frame/view.h"
#include "renderer/passes/pass.h"

enum { PROGRAM_TILES, PROGRAM_RAYS, PROGRAM_FILTER, PROGRAM_SHADE, PROGRAM_COUNT };

// Lists the tiles to trace. Cones and rays have different limits of roughness and reflectance.
static bool list_tiles(const struct frame *frame, const struct pass *pass, struct error *out_error)
{
    const struct gpu_program *list = pass_program(frame, pass, PROGRAM_TILES, out_error);
    if (!list)
        return false;
    static const uint32_t no_groups[4] = {0, 1, 1, 0};
    gpu_buffer_write(frame->view->buffers[RESOURCE_GLOSSY_TILES], 0, sizeof(no_groups), no_groups);
    pass_dispatch_tiles(frame, list, 1);
    gpu_barrier(frame->gpu);
    return true;
}

static bool add_sample(const struct frame *frame, const struct pass *pass, struct error *out_error)
{
    const struct gpu_program *program = pass_program(frame, pass, PROGRAM_RAYS, out_error);
    if (!program)
        return false;
    gpu_dispatch_indirect(frame->gpu, program, frame->view->buffers[RESOURCE_GLOSSY_TILES], 0);
    gpu_barrier(frame->gpu);
    return filter_accumulation(frame, pass, PROGRAM_FILTER, out_error);
}

static bool add_specular_lobe(const struct frame *frame, const struct pass *pass,
                              struct error *out_error)
{
    const struct gpu_program *trace = pass_program(frame, pass, PROGRAM_SHADE, out_error);
    if (!trace)
        return false;
    if (frame->params->debug_view == DEBUG_VIEW_INDIRECT_SPECULAR)
        gpu_buffer_clear(frame->view->buffers[RESOURCE_RADIANCE]);
    gpu_dispatch_indirect(frame->gpu, trace, frame->view->buffers[RESOURCE_GLOSSY_TILES], 0);
    return true;
}

static bool indirect_specular_run(struct frame *frame, const struct pass *pass,
                                  struct error *out_error)
{
    const struct accumulation_plan *accumulation = &frame->plan->accumulation;
    bool sample_due = accumulation->gather == GATHER_RAYS && accumulation->sample;
    bool tiles_known = accumulation->only && accumulation->samples != 1; // from the first sample on
    bool done =
        (accumulation->only && !sample_due) || tiles_known || list_tiles(frame, pass, out_error);
    done = done && (!sample_due || add_sample(frame, pass, out_error));
    return done && (accumulation->only || add_specular_lobe(frame, pass, out_error));
}

#define EFFECTS  (EFFECT_BIT(EFFECT_SPECULAR) | EFFECT_BIT(EFFECT_ENVIRONMENT_LIGHT))
#define SWITCHES SWITCH_BIT(VOXEL_DIRECTIONS)

const struct pass indirect_specular_pass = {
    .reads = HIT_READS | RESOURCE(GBUFFER) | RESOURCE(DEPTH) | RESOURCE(VOXEL_RADIANCE) |
             RESOURCE(RADIANCE) | RESOURCE(ENVIRONMENT),
    .writes = RESOURCE(RADIANCE) | RESOURCE(ACCUMULATION) | RESOURCE(GLOSSY_TILES),
    .program_count = PROGRAM_COUNT,
    .programs = {{"gi/specular_tiles.comp", EFFECTS, SWITCHES, NULL},
                 {"gi/ray_specular.comp", HIT_EFFECTS, HIT_SWITCHES, HIT_FIXED},
                 {"gi/accumulation_filter.comp", 0, SWITCH_BIT(GATHER_STEP), "SPECULAR_LOBE 1\n"},
                 {"gi/indirect_specular.comp", EFFECTS,
                  SWITCHES | SWITCH_BIT(SHARED) | SWITCH_BIT(RAYS) | SWITCH_BIT(GATHER_STEP),
                  NULL}},
    .run = indirect_specular_run,
};
