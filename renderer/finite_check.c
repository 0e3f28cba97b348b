#include "renderer/finite_check.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "renderer/gi/gi_method.h"
#include "renderer/gpu/program.h"
#include "renderer/passes/pass.h"
#include "renderer/gpu_scene/gpu_scene.h"
#include "renderer/frame/view.h"
#include "shared/finite_check.h"

#define MAX_GROUPS  4096u
#define EVERY_WORD  0xffffffffu
#define NOT_WRITTEN RESOURCE_COUNT // written by no pass: part of the scene

// TEXTURE of the shader.
enum texture_kind {
    TEXTURE_NONE = CHECK_BUFFER,
    TEXTURE_PLAIN = CHECK_TEXTURE_2D,
    TEXTURE_ARRAY = CHECK_TEXTURE_ARRAY,
    TEXTURE_VOLUME = CHECK_TEXTURE_3D,
};

struct checked {
    const char *name;
    enum resource resource;
    const struct gpu_buffer *buffer; // NULL with `texture`
    size_t first_word, word_count;   // of the buffer; 0: to its end
    struct resource_floats floats;
    const struct gpu_texture *texture;
    enum texture_kind kind;
};

struct checked_list {
    uint32_t count;
    struct checked items[FINITE_MAX_RESOURCES];
};

// Uniforms and result of the shader.
struct check_block {
    struct finite_check_shape shape;
    struct finite_check_masks masks;
    struct finite_check_result results[FINITE_MAX_RESOURCES];
};

static struct checked *add(struct checked_list *list, const char *name, enum resource resource)
{
    assert(list->count < FINITE_MAX_RESOURCES);
    struct checked *item = &list->items[list->count++];
    *item = (struct checked){.name = name, .resource = resource};
    return item;
}

static void add_buffer(struct checked_list *list, const char *name, enum resource resource,
                       const struct gpu_buffer *buffer)
{
    if (!buffer)
        return;
    struct checked *item = add(list, name, resource);
    item->buffer = buffer;
    item->floats = (struct resource_floats){.record_words = 1, .floats = EVERY_WORD};
}

static void add_texture(struct checked_list *list, const char *name, enum resource resource,
                        const struct gpu_texture *texture, enum texture_kind kind)
{
    if (!texture)
        return;
    struct checked *item = add(list, name, resource);
    item->texture = texture;
    item->kind = kind;
}

// Records of a table, with a mask of their words that are floats.
static void add_table(struct checked_list *list, const char *name,
                      const struct scene_tables *tables, enum scene_table table, uint32_t words,
                      uint32_t floats)
{
    if (tables->size_bytes[table] == 0)
        return;
    struct checked *item = add(list, name, NOT_WRITTEN);
    item->buffer = tables->buffer;
    item->first_word = (size_t)tables->first[table] * 4;
    item->word_count = tables->size_bytes[table] / sizeof(uint32_t);
    item->floats = (struct resource_floats){.record_words = words, .floats = floats};
}

static void add_view(struct checked_list *list, const struct view *view)
{
    const struct frame_inputs inputs = {.params = &view->history.params};
    add_texture(list, "depth", RESOURCE_DEPTH, view->depth, TEXTURE_PLAIN);
    for (int i = 0; i < RESOURCE_COUNT; i++) {
        if (!view->buffers[i])
            continue;
        struct resource_floats floats = resource_rows[i].floats(&inputs);
        if (floats.record_words == 0)
            continue;
        struct checked *item = add(list, resource_rows[i].name, (enum resource)i);
        item->buffer = view->buffers[i];
        item->floats = floats;
    }
    add_buffer(list, "shadow_views", NOT_WRITTEN, view->shadow_views);
}

static void add_gi(struct checked_list *list, const struct gi_findings *gi)
{
    for (uint32_t i = 0; i < gi->resource_count; i++) {
        const struct gi_resource *found = &gi->resources[i];
        if (!found->buffer && !found->volume)
            continue;
        struct checked *item = add(list, found->name, found->resource);
        item->buffer = found->buffer;
        item->floats = found->floats;
        item->texture = found->volume;
        item->kind = found->volume ? TEXTURE_VOLUME : TEXTURE_NONE;
    }
}

static void add_scene(struct checked_list *list, const struct gpu_scene *gpu_scene)
{
    // The last vector of lights and of instances is integers.
    const struct scene_tables *tables = &gpu_scene->tables;
    add_table(list, "lights", tables, TABLE_LIGHTS, 20, 0xffff);
    add_table(list, "instances", tables, TABLE_INSTANCES, 20, 0xffff);
    add_table(list, "materials", tables, TABLE_MATERIALS, 32, 0x0fffffff);
    add_table(list, "environment", tables, TABLE_ENVIRONMENT, 1, EVERY_WORD);
    add_buffer(list, "vertices", NOT_WRITTEN, gpu_scene->vertices);
    list->items[list->count - 1].floats =
        (struct resource_floats){.record_words = VERTEX_WORDS, .floats = 0xf337};
    add_texture(list, "environment_levels", NOT_WRITTEN, gpu_scene->environment_levels,
                TEXTURE_ARRAY);
}

static bool is_written(const struct view *view, enum resource resource)
{
    if (resource == NOT_WRITTEN)
        return true;
    for (uint32_t i = 0; i < PASS_COUNT; i++)
        if (frame_plan_runs(&view->plan, (enum pass_id)i) &&
            (all_passes[i]->writes & (1u << resource)))
            return true;
    return false;
}

static bool dispatch(const struct finite_check *check, const struct checked *item,
                     struct gpu_buffer *block, uint32_t result, struct error *out_error)
{
    char defines[32];
    snprintf(defines, sizeof(defines), "TEXTURE %d\n", item->kind);
    const struct gpu_program *program =
        gpu_program_get(check->gpu, "debug/finite_check.comp", defines, out_error);
    if (!program)
        return false;
    uint32_t levels = item->texture ? gpu_texture_levels(item->texture) : 1;
    for (uint32_t level = 0; level < levels; level++) {
        size_t count = item->texture      ? gpu_texture_texel_count(item->texture, level)
                       : item->word_count ? item->word_count
                                          : gpu_buffer_size_bytes(item->buffer) / sizeof(uint32_t);
        size_t groups = (count + LINEAR_GROUP - 1) / LINEAR_GROUP;
        const uint32_t head[8] = {(uint32_t)count,
                                  item->floats.record_words,
                                  result,
                                  level,
                                  item->floats.floats,
                                  item->floats.low_halves,
                                  item->floats.high_halves,
                                  (uint32_t)item->first_word};
        gpu_buffer_write(block, 0, sizeof(head), head);
        gpu_bind_storage(check->gpu, BIND_CHECK, block);
        gpu_bind_storage(check->gpu, BIND_CHECKED, item->buffer);
        gpu_bind_texture(check->gpu, UNIT_CHECKED, item->texture);
        gpu_dispatch(check->gpu, program, groups < MAX_GROUPS ? (uint32_t)groups : MAX_GROUPS, 1,
                     1);
        gpu_barrier(check->gpu);
    }
    return true;
}

bool finite_check_run(const struct finite_check *check, struct finite_report *out_report,
                      struct error *out_error)
{
    struct checked_list list = {0};
    add_view(&list, check->view);
    add_gi(&list, check->gi);
    if (check->gpu_scene)
        add_scene(&list, check->gpu_scene);
    struct check_block found = {0};
    for (uint32_t i = 0; i < FINITE_MAX_RESOURCES; i++)
        found.results[i].first = UINT32_MAX;
    struct gpu_buffer *block =
        gpu_buffer_create(check->gpu, "finite_check", GPU_BUFFER_STATIC, sizeof(found), &found);
    if (!block)
        return error_set(out_error, "out of GPU memory");
    bool done = true;
    for (uint32_t i = 0; i < list.count && done; i++)
        if (is_written(check->view, list.items[i].resource))
            done = dispatch(check, &list.items[i], block, i, out_error);
    if (done)
        gpu_buffer_read(block, 0, sizeof(found), &found);
    gpu_buffer_destroy(&block);
    *out_report = (struct finite_report){.count = done ? list.count : 0};
    for (uint32_t i = 0; i < out_report->count; i++)
        out_report->resources[i] = (struct finite_resource){
            list.items[i].name, found.results[i].count, found.results[i].first};
    return done;
}
