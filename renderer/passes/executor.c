#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "renderer/frame/settings_block.h"
#include "renderer/frame/view.h"
#include "renderer/gpu/buffer.h"
#include "renderer/gpu/program.h"
#include "renderer/gpu/timer.h"
#include "renderer/log.h"
#include "renderer/passes/pass.h"
#include "shared/work_groups.h"

const struct pass *const all_passes[PASS_COUNT] = {
#define PASS(id, name, ...) [PASS_##id] = &name##_pass,
#include "renderer/frame/frame.def"
#undef PASS
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
                             pass_name((enum pass_id)i),
                             resource_rows[__builtin_ctz(missing)].name);
        written |= passes[i]->writes;
    }
    return true;
}

uint64_t pass_view_bytes(const struct pass *pass, const struct view *view)
{
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < RESOURCE_COUNT; i++) {
        const uint64_t uses = ((pass->reads >> i) & 1u) + ((pass->writes >> i) & 1u);
        if (i == RESOURCE_IDS || i == RESOURCE_DEPTH) // R32UI and 32-bit float
            bytes += uses * view->width * view->height * 4;
        else if (view->buffers[i])
            bytes += uses * gpu_buffer_size_bytes(view->buffers[i]);
    }
    return bytes;
}

bool passes_prepare_gpu(struct gpu *gpu)
{
    char defines[RESOURCE_DEFINES_BYTES + SETTINGS_DEFINE_BYTES];
    resources_write_defines(defines);
    settings_block_write_define(defines + strlen(defines));
    return gpu_set_shader_defines(gpu, defines);
}

// Slots of the resources whose bits are set.
static struct gpu_program_bindings slots_of(uint32_t resources)
{
    struct gpu_program_bindings slots = {0};
    for (uint32_t i = 0; i < RESOURCE_COUNT; i++)
        if (resources & (1u << i)) {
            slots.storage |= resource_rows[i].storage;
            slots.units |= resource_rows[i].units;
            slots.images |= resource_rows[i].images;
        }
    return slots;
}

const char *pass_find_undeclared(const struct pass *pass, const struct gpu_program *program)
{
    const struct gpu_program_bindings bound = *gpu_program_get_bindings(program);
    const struct gpu_program_bindings declared = slots_of(pass->reads | pass->writes);
    for (uint32_t i = 0; i < RESOURCE_COUNT; i++) {
        const struct resource_row *row = &resource_rows[i];
        if ((bound.storage & ~declared.storage & row->storage) ||
            (bound.units & ~declared.units & row->units) ||
            (bound.images & ~declared.images & row->images))
            return row->name;
    }
    return NULL;
}

// The view's own buffers that a pass declares.
static void bind_buffers(const struct frame *frame, const struct pass *pass)
{
    uint32_t declared = pass->reads | pass->writes;
    for (uint32_t i = 0; i < RESOURCE_COUNT; i++)
        if ((declared & (1u << i)) && resource_rows[i].bytes) {
            const struct resource_row *row = &resource_rows[i];
            const struct gpu_buffer *buffer = frame->view->buffers[i];
            gpu_bind_storage(frame->gpu, (uint32_t)__builtin_ctz(row->storage), buffer);
            gpu_bind_texels(frame->gpu, (uint32_t)__builtin_ctzll(row->units), buffer, row->texel);
        }
}

bool passes_execute(struct frame *frame, struct error *out_error)
{
    struct view *view = frame->view;
    gpu_timer_begin_frame(view->timer);
    for (uint32_t i = 0; i < PASS_COUNT; i++) {
        const struct pass *pass = all_passes[i];
        if (!frame_plan_runs(frame->plan, (enum pass_id)i))
            continue;
        gpu_push_group(frame->gpu, pass_name((enum pass_id)i));
        gpu_timer_begin(view->timer, i);
        bind_buffers(frame, pass);
        bool done = pass->run(frame, pass, out_error);
        gpu_barrier(frame->gpu);
        gpu_timer_end(view->timer, i);
        gpu_pop_group(frame->gpu);
        if (!done)
            return false;
    }
    return true;
}

void shader_program_write_defines(const struct shader_program *program,
                                  const struct frame_plan *plan,
                                  char out_defines[PROGRAM_DEFINES_BYTES])
{
    size_t used = 0;
    out_defines[0] = '\0';
    for (int i = 0; i < EFFECT_COUNT; i++)
        if (program->effects & EFFECT_BIT(i))
            used += (size_t)snprintf(out_defines + used, PROGRAM_DEFINES_BYTES - used, "%s %d\n",
                                     effect_define((enum effect)i),
                                     (plan->effects.bits & EFFECT_BIT(i)) != 0);
    for (int i = 0; i < SWITCH_COUNT; i++)
        if (program->switches & (1u << i))
            used += (size_t)snprintf(out_defines + used, PROGRAM_DEFINES_BYTES - used, "%s %u\n",
                                     plan_switch_define((enum plan_switch)i), plan->switches[i]);
    used += (size_t)snprintf(out_defines + used, PROGRAM_DEFINES_BYTES - used, "%s",
                             program->fixed ? program->fixed : "");
    assert(used < PROGRAM_DEFINES_BYTES);
}

const struct gpu_program *pass_program(const struct frame *frame, const struct pass *pass,
                                       uint32_t number, struct error *out_error)
{
    assert(number < pass->program_count);
    const struct shader_program *shader = &pass->programs[number];
    char defines[PROGRAM_DEFINES_BYTES];
    shader_program_write_defines(shader, frame->plan, defines);
    const struct gpu_program *program =
        gpu_program_get(frame->gpu, shader->path, defines, out_error);
    const char *undeclared =
        program && gpu_program_take_new(program) ? pass_find_undeclared(pass, program) : NULL;
    if (undeclared) {
        log_write(LOG_ERROR, "pass_undeclared shader=%s resource=%s", shader->path, undeclared);
        gpu_count_error(frame->gpu);
    }
    return program;
}

bool pass_programs(const struct frame *frame, const struct pass *pass,
                   const struct gpu_program *out_programs[], struct error *out_error)
{
    for (uint32_t i = 0; i < pass->program_count; i++) {
        out_programs[i] = pass_program(frame, pass, i, out_error);
        if (!out_programs[i])
            return false;
    }
    return true;
}

bool pass_run_pixels(const struct frame *frame, const struct pass *pass, uint32_t number,
                     struct error *out_error)
{
    const struct gpu_program *program = pass_program(frame, pass, number, out_error);
    if (!program)
        return false;
    pass_dispatch_pixels(frame, program, 1);
    return true;
}

bool filter_accumulation(const struct frame *frame, const struct pass *pass, uint32_t number,
                         struct error *out_error)
{
    if (frame->plan->accumulation.only)
        return true;
    const struct gpu_program *program = pass_program(frame, pass, number, out_error);
    if (!program)
        return false;
    pass_dispatch_pixels(frame, program, frame->plan->gather_step);
    gpu_barrier(frame->gpu);
    return true;
}

// Groups that handle `width` x `height` pixels each.
static void dispatch_groups(const struct frame *frame, const struct gpu_program *program,
                            uint32_t width, uint32_t height)
{
    gpu_dispatch(frame->gpu, program, (frame->plan->width + width - 1) / width,
                 (frame->plan->height + height - 1) / height, 1);
}

void pass_dispatch_pixels(const struct frame *frame, const struct gpu_program *program,
                          uint32_t step)
{
    dispatch_groups(frame, program, step * PIXEL_GROUP_WIDTH, step * PIXEL_GROUP_HEIGHT);
}

void pass_dispatch_tiles(const struct frame *frame, const struct gpu_program *program,
                         uint32_t step)
{
    dispatch_groups(frame, program, step * GROUP_EDGE, step * GROUP_EDGE);
}
