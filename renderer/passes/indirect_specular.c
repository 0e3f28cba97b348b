// What glossy surfaces mirror: one cone a pixel, or for four alike, in the tiles that hold such
// surfaces.
#include <stdio.h>

#include "renderer/gi/gi.h"
#include "renderer/gi/volume.h"
#include "renderer/passes/pass.h"
#include "renderer/view.h"

static const char *indirect_specular_skip_reason(const struct frame *frame)
{
    if (!frame->volume || !frame_has(frame, EFFECT_INDIRECT_SPECULAR))
        return frame->view->last_plan.reasons[EFFECT_INDIRECT_SPECULAR];
    bool shown = frame->params->debug_view == DEBUG_VIEW_FINAL ||
                 frame->params->debug_view == DEBUG_VIEW_INDIRECT_SPECULAR;
    return shown ? NULL : "the debug view shows none";
}

static bool gather_by_rays(const struct frame *frame, struct error *out_error)
{
    const struct gpu_program *program = hit_program(frame, "gi/ray_gloss.comp", out_error);
    if (!program)
        return false;
    gpu_bind_storage(frame->gpu, BIND_TILES, frame->view->glossy_tiles);
    gpu_dispatch_indirect(frame->gpu, program, frame->view->glossy_tiles, 0);
    gpu_barrier(frame->gpu);
    return filter_gathered(frame, true, out_error);
}

static bool indirect_specular_run(struct frame *frame, const struct pass *pass,
                                  struct error *out_error)
{
    struct view *view = frame->view;
    if (frame->quiet) // the tiles are those of before
        return !frame->gather_now || gather_by_rays(frame, out_error);
    const struct gpu_program *list =
        voxel_program(frame, pass, "gi/glossy_tiles.comp", "", out_error);
    bool rays = frame->gather == GATHER_RAYS;
    char extra[48];
    snprintf(extra, sizeof(extra), "SHARED %d\nRAYS %d\nGATHER_STEP %u\n",
             frame->params->quality <= QUALITY_INTERACTIVE && !rays, rays, gi_gather_step(frame));
    const struct gpu_program *trace =
        list ? voxel_program(frame, pass, "gi/indirect_specular.comp", extra, out_error) : NULL;
    if (!trace)
        return false;
    if (frame->params->debug_view == DEBUG_VIEW_INDIRECT_SPECULAR)
        gpu_buffer_clear(view->radiance);
    static const uint32_t no_groups[4] = {0, 1, 1, 0};
    gpu_buffer_write(view->glossy_tiles, 0, sizeof(no_groups), no_groups);
    gpu_bind_storage(frame->gpu, BIND_TILES, view->glossy_tiles);
    pass_dispatch_pixels(frame, list);
    gpu_barrier(frame->gpu);
    if (rays && frame->gather_now && !gather_by_rays(frame, out_error))
        return false;
    gpu_dispatch_indirect(frame->gpu, trace, view->glossy_tiles, 0);
    gpu_bind_storage(frame->gpu, BIND_TILES, view->transparent_tiles);
    return true;
}

const struct pass indirect_specular_pass = {
    .name = "indirect_specular",
    .effects_used = EFFECT_BIT(EFFECT_SPECULAR) | EFFECT_BIT(EFFECT_ENVIRONMENT_LIGHT),
    .gathers = true,
    .use_count = 4,
    .uses = {{RESOURCE_GBUFFER, ACCESS_READ},
             {RESOURCE_DEPTH, ACCESS_READ},
             {RESOURCE_VOXEL_RADIANCE, ACCESS_READ},
             {RESOURCE_RADIANCE, ACCESS_READ_WRITE}},
    .skip_reason = indirect_specular_skip_reason,
    .run = indirect_specular_run,
};
