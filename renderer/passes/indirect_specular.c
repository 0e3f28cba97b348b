// Indirect specular light in the tiles that need it: one cone per pixel, or per four similar
// pixels.
#include <stdio.h>

#include "renderer/gi/voxel/volume.h"
#include "renderer/passes/pass.h"
#include "renderer/frame/view.h"

static const char *indirect_specular_skip_reason(const struct frame *frame)
{
    if (!frame_has_cones(frame) || !frame_has(frame, EFFECT_INDIRECT_SPECULAR))
        return frame->view->last_plan.reasons[EFFECT_INDIRECT_SPECULAR];
    bool shown = frame->params->debug_view == DEBUG_VIEW_FINAL ||
                 frame->params->debug_view == DEBUG_VIEW_INDIRECT_SPECULAR;
    return shown ? NULL : "the debug view shows none";
}

// Lists the tiles to trace. Cones and rays have different limits of roughness and reflectance.
static bool list_tiles(const struct frame *frame, const struct pass *pass, struct error *out_error)
{
    const struct gpu_program *list =
        voxel_program(frame, pass, "gi/specular_tiles.comp", "", out_error);
    if (!list)
        return false;
    static const uint32_t no_groups[4] = {0, 1, 1, 0};
    gpu_buffer_write(frame->view->glossy_tiles, 0, sizeof(no_groups), no_groups);
    pass_dispatch_pixels(frame, list);
    gpu_barrier(frame->gpu);
    return true;
}

static bool trace_pixel_rays(const struct frame *frame, const struct pass *pass,
                             struct error *out_error)
{
    const struct gpu_program *program = hit_program(frame, pass, "gi/ray_specular.comp", out_error);
    if (!program)
        return false;
    gpu_dispatch_indirect(frame->gpu, program, frame->view->glossy_tiles, 0);
    gpu_barrier(frame->gpu);
    return filter_accumulation(frame, pass, true, out_error);
}

static bool add_specular_lobe(const struct frame *frame, const struct pass *pass,
                              struct error *out_error)
{
    bool rays = frame->gather == GATHER_RAYS;
    char extra[48];
    snprintf(extra, sizeof(extra), "SHARED %d\nRAYS %d\nGATHER_STEP %u\n",
             frame->params->quality <= QUALITY_INTERACTIVE && !rays, rays,
             frame_gather_step(frame));
    const struct gpu_program *trace =
        voxel_program(frame, pass, "gi/indirect_specular.comp", extra, out_error);
    if (!trace)
        return false;
    if (frame->params->debug_view == DEBUG_VIEW_INDIRECT_SPECULAR)
        gpu_buffer_clear(frame->view->radiance);
    gpu_dispatch_indirect(frame->gpu, trace, frame->view->glossy_tiles, 0);
    return true;
}

static bool indirect_specular_run(struct frame *frame, const struct pass *pass,
                                  struct error *out_error)
{
    struct view *view = frame->view;
    bool samples_due = frame->gather == GATHER_RAYS && frame->accumulate;
    bool tiles_known =
        frame->accumulate_only && frame->accumulated_samples != 1; // from the first sample on
    gpu_bind_storage(frame->gpu, BIND_TILES, view->glossy_tiles);
    bool done = (frame->accumulate_only && !samples_due) || tiles_known ||
                list_tiles(frame, pass, out_error);
    done = done && (!samples_due || trace_pixel_rays(frame, pass, out_error));
    done = done && (frame->accumulate_only || add_specular_lobe(frame, pass, out_error));
    gpu_bind_storage(frame->gpu, BIND_TILES, view->transparent_tiles);
    return done;
}

const struct pass indirect_specular_pass = {
    .name = "indirect_specular",
    .effects_used = EFFECT_BIT(EFFECT_SPECULAR) | EFFECT_BIT(EFFECT_ENVIRONMENT_LIGHT),
    .runs_while_accumulating = true,
    .reads = HIT_READS | RESOURCE(GBUFFER) | RESOURCE(DEPTH) | RESOURCE(VOXEL_RADIANCE) |
             RESOURCE(RADIANCE) | RESOURCE(ENVIRONMENT),
    .writes = RESOURCE(RADIANCE) | RESOURCE(ACCUMULATION) | RESOURCE(TILES),
    .skip_reason = indirect_specular_skip_reason,
    .run = indirect_specular_run,
};
