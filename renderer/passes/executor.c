#include <stdio.h>

#include "renderer/gi/voxel/volume.h"
#include "renderer/gpu/program.h"
#include "renderer/gpu/timer.h"
#include "renderer/log.h"
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

bool passes_check(const struct pass *const *passes, uint32_t count, struct error *out_error)
{
    uint32_t written = 0;
    for (uint32_t i = 0; i < RESOURCE_COUNT; i++)
        if (resource_rows[i].scope == SCOPE_SCENE || resource_rows[i].history)
            written |= 1u << i;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t missing = passes[i]->reads & ~written;
        if (missing)
            return error_set(out_error, "pass %s reads %s before any pass writes it",
                             passes[i]->name, resource_rows[__builtin_ctz(missing)].name);
        written |= passes[i]->writes;
    }
    return true;
}

void pass_check_bindings(const struct frame *frame, const struct pass *pass,
                         const struct gpu_program *program)
{
    struct gpu_program_bindings bound;
    if (!gpu_program_take_bindings(program, &bound))
        return;
    for (uint32_t i = 0; i < RESOURCE_COUNT; i++) {
        const struct resource_row *row = &resource_rows[i];
        bool used = (bound.storage & row->storage) || (bound.units & row->units) ||
                    (bound.images & row->images);
        if (!used || ((pass->reads | pass->writes) & (1u << i)))
            continue;
        log_write(LOG_ERROR, "pass_undeclared pass=%s resource=%s", pass->name, row->name);
        gpu_count_error(frame->gpu);
    }
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
    const struct gpu_program *program = gpu_program_get(frame->gpu, shader, defines, out_error);
    if (program && pass->name)
        pass_check_bindings(frame, pass, program);
    return program;
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
