// What glossy surfaces mirror: one cone a pixel, or for four alike, in the tiles that hold such
// surfaces.
#include <stdio.h>

#include "renderer/gi/gi.h"
#include "renderer/gi/volume.h"
#include "renderer/passes/pass.h"
#include "renderer/resident/resident.h"
#include "renderer/view.h"

// What rays meet is lit by each lamp up to so many; beyond, as the voxels are.
#define MOST_LIGHTS_OF_HITS 16u

static const char *indirect_specular_skip_reason(const struct frame *frame)
{
    if (!frame->volume || !frame_has(frame, EFFECT_INDIRECT_SPECULAR))
        return frame->view->last_plan.reasons[EFFECT_INDIRECT_SPECULAR];
    bool shown = frame->params->debug_view == DEBUG_VIEW_FINAL ||
                 frame->params->debug_view == DEBUG_VIEW_INDIRECT_SPECULAR;
    return shown ? NULL : "the debug view shows none";
}

// Effects that what a ray meets is shaded by. Lamps' sizes and tiles of the screen mean nothing
// there.
static const struct pass shading_of_hits = {
    .effects_used = (SURFACE_EFFECTS | DIRECT_LIGHT_EFFECTS | EFFECT_BIT(EFFECT_ALPHA_MASK) |
                     EFFECT_BIT(EFFECT_ENVIRONMENT_LIGHT) | EFFECT_BIT(EFFECT_CLIP_LEVELS)) &
                    ~(EFFECT_BIT(EFFECT_SOFT_SHADOWS) | EFFECT_BIT(EFFECT_LIGHT_TILES)),
};

static bool gather_by_rays(const struct frame *frame, struct error *out_error)
{
    char extra[128];
    snprintf(extra, sizeof(extra),
             "GATHER_STEP %u\nSOFT_SHADOWS 0\nLIGHT_TILES 0\nSHADOW_TAPS 1u\nLIT_HITS %d\n",
             gi_gather_step(frame), frame->resident->counts.lights <= MOST_LIGHTS_OF_HITS);
    const struct gpu_program *program =
        voxel_program(frame, &shading_of_hits, "gi/ray_gloss.comp", extra, out_error);
    if (!program)
        return false;
    gpu_dispatch_indirect(frame->gpu, program, frame->view->glossy_tiles, 0);
    gpu_barrier(frame->gpu);
    return true;
}

static bool indirect_specular_run(struct frame *frame, const struct pass *pass,
                                  struct error *out_error)
{
    struct view *view = frame->view;
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
    .use_count = 4,
    .uses = {{RESOURCE_GBUFFER, ACCESS_READ},
             {RESOURCE_DEPTH, ACCESS_READ},
             {RESOURCE_VOXEL_RADIANCE, ACCESS_READ},
             {RESOURCE_RADIANCE, ACCESS_READ_WRITE}},
    .skip_reason = indirect_specular_skip_reason,
    .run = indirect_specular_run,
};
