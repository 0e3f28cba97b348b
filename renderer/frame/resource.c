#include "renderer/frame/resource.h"

#include <stdio.h>

#include "renderer/frame/frame_plan.h"
#include "shared/display.h"
#include "shared/slots.h"
#include "shared/vertex.h"
#include "shared/work_groups.h"

#define FLOATS(...) ((struct resource_floats){__VA_ARGS__})
#define RESOURCE_ROW(...)
#define VIEW_BUFFER(id, name, history, texel, size, check)                                         \
    static size_t name##_bytes(const struct frame_inputs *in, const struct frame_plan *plan)       \
    {                                                                                              \
        size_t pixels = (size_t)plan->width * plan->height;                                        \
        size_t groups = (size_t)((plan->width + GROUP_EDGE - 1) / GROUP_EDGE) *                    \
                        ((plan->height + GROUP_EDGE - 1) / GROUP_EDGE);                            \
        (void)in, (void)pixels, (void)groups;                                                      \
        return size;                                                                               \
    }                                                                                              \
    static struct resource_floats name##_floats(const struct frame_inputs *in)                     \
    {                                                                                              \
        (void)in;                                                                                  \
        return check;                                                                              \
    }
#include "renderer/frame/frame.def"
#undef RESOURCE_ROW
#undef VIEW_BUFFER

// Numbers of the view's buffers, in the order of their rows.
enum view_buffer {
#define RESOURCE_ROW(...)
#define VIEW_BUFFER(id, ...) VIEW_##id,
#include "renderer/frame/frame.def"
#undef RESOURCE_ROW
#undef VIEW_BUFFER
    VIEW_BUFFER_COUNT
};

_Static_assert(BIND_VIEW_BUFFERS + VIEW_BUFFER_COUNT <= STORAGE_BINDINGS,
               "they are bits of a mask");
_Static_assert(UNIT_VIEW_BUFFERS + VIEW_BUFFER_COUNT <= TEXTURE_UNITS, "they are bits of a mask");
_Static_assert(RESOURCE_COUNT <= 32, "passes declare them as bits of a mask");

const struct resource_row resource_rows[RESOURCE_COUNT] = {
#define RESOURCE_ROW(id, name, scope, history, storage, units, images)                             \
    [RESOURCE_##id] = {#name, SCOPE_##scope, history, storage, units, images, NULL, 0, NULL, NULL},
#define VIEW_BUFFER(id, name, history, texel, size, check)                                         \
    [RESOURCE_##id] = {#name,                                                                      \
                       SCOPE_VIEW,                                                                 \
                       history,                                                                    \
                       1u << (BIND_VIEW_BUFFERS + VIEW_##id),                                      \
                       (uint64_t)1 << (UNIT_VIEW_BUFFERS + VIEW_##id),                             \
                       0,                                                                          \
                       "view_targets." #name,                                                      \
                       GPU_TEXEL_##texel,                                                          \
                       name##_bytes,                                                               \
                       name##_floats},
#include "renderer/frame/frame.def"
#undef RESOURCE_ROW
#undef VIEW_BUFFER
};

void resources_write_defines(char out_defines[RESOURCE_DEFINES_BYTES])
{
    static const struct {
        const char *name;
        int number;
    } buffers[] = {
#define RESOURCE_ROW(...)
#define VIEW_BUFFER(id, ...) {#id, VIEW_##id},
#include "renderer/frame/frame.def"
#undef RESOURCE_ROW
#undef VIEW_BUFFER
    };
    size_t used = 0;
    for (size_t i = 0; i < VIEW_BUFFER_COUNT && used < RESOURCE_DEFINES_BYTES; i++)
        used += (size_t)snprintf(out_defines + used, RESOURCE_DEFINES_BYTES - used,
                                 "BIND_%s %d\nUNIT_%s %d\n", buffers[i].name,
                                 BIND_VIEW_BUFFERS + buffers[i].number, buffers[i].name,
                                 UNIT_VIEW_BUFFERS + buffers[i].number);
}
