#include <stdio.h>

#include "renderer/gi/volume.h"
#include "renderer/gpu/program.h"
#include "renderer/gpu/timer.h"
#include "renderer/passes/pass.h"
#include "renderer/gpu_scene/gpu_scene.h"
#include "renderer/frame/view.h"

const struct pass *const all_passes[PASS_COUNT] = {
    &visibility_pass,       &gbuffer_pass,           &shadow_map_pass,       &voxelize_pass,
    &voxel_relight_pass,    &voxel_filter_pass,      &irradiance_cache_pass, &light_tiles_pass,
    &environment_pass,      &ray_shadows_pass,       &direct_light_pass,     &emission_pass,
    &indirect_diffuse_pass, &indirect_specular_pass, &transparency_pass,     &reference_pass,
    &debug_view_pass,       &exposure_pass,          &tonemap_pass,          &readback_pass,
};

static const char *const resource_names[RESOURCE_COUNT] = {
    "ids",        "depth",       "gbuffer",  "shadow_map", "voxels",   "voxel_radiance",
    "irradiance", "light_masks", "radiance", "fragments",  "exposure", "output",
};

bool passes_check(const struct pass *const *passes, uint32_t count, struct error *out_error)
{
    uint32_t written = 0;
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t j = 0; j < passes[i]->use_count; j++) {
            const struct resource_use *use = &passes[i]->uses[j];
            if ((use->access & ACCESS_READ) && !(written & (1u << use->resource)))
                return error_set(out_error, "pass %s reads %s before any pass writes it",
                                 passes[i]->name, resource_names[use->resource]);
        }
        for (uint32_t j = 0; j < passes[i]->use_count; j++)
            if (passes[i]->uses[j].access & ACCESS_WRITE)
                written |= 1u << passes[i]->uses[j].resource;
    }
    return true;
}

bool passes_execute(struct frame *frame, struct error *out_error)
{
    struct view *view = frame->view;
    gpu_timer_begin_frame(view->timer);
    for (uint32_t i = 0; i < PASS_COUNT; i++) {
        const struct pass *pass = all_passes[i];
        const char *reason = frame->reference_picture && !pass->shows_reference
                                 ? "the reference's picture is shown"
                             : frame->accumulate_only && !pass->runs_while_accumulating
                                 ? "light settles; the picture is that of before"
                             : pass->skip_reason ? pass->skip_reason(frame)
                                                 : NULL;
        view->pass_skip_reasons[i] = reason;
        if (reason)
            continue;
        gpu_push_group(frame->gpu, pass->name);
        gpu_timer_begin(view->timer, i);
        bool done = pass->run(frame, pass, out_error);
        gpu_barrier(frame->gpu);
        gpu_timer_end(view->timer, i);
        gpu_pop_group(frame->gpu);
        if (!done)
            return false;
    }
    return true;
}

const struct gpu_program *pass_program(const struct frame *frame, const struct pass *pass,
                                       const char *shader, const char *extra,
                                       struct error *out_error)
{
    char defines[1024];
    effects_write_defines(frame->plan.bits, pass->effects_used, frame->gpu_scene, defines,
                          sizeof(defines));
    size_t used = 0;
    while (defines[used])
        used++;
    snprintf(defines + used, sizeof(defines) - used, "%s", extra);
    return gpu_program_get(frame->gpu, shader, defines, out_error);
}

const struct gpu_program *voxel_program(const struct frame *frame, const struct pass *pass,
                                        const char *shader, const char *extra,
                                        struct error *out_error)
{
    char defines[256];
    bool isotropic = frame->volume->params.directions == VOXEL_ISOTROPIC;
    snprintf(defines, sizeof(defines), "VOXEL_DIRECTIONS %d\n%s", isotropic ? 1 : VOXEL_FACES,
             extra);
    return pass_program(frame, pass, shader, defines, out_error);
}

void pass_dispatch_pixels(const struct frame *frame, const struct gpu_program *program)
{
    gpu_dispatch(frame->gpu, program, (frame->width + GROUP_EDGE - 1) / GROUP_EDGE,
                 (frame->height + GROUP_EDGE - 1) / GROUP_EDGE, 1);
}
