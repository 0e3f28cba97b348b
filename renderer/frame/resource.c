#include "renderer/frame/resource.h"

#include "renderer/frame/frame_plan.h"
#include "shared/display.h"
#include "shared/slots.h"
#include "shared/vertex.h"
#include "shared/work_groups.h"

#define FLOATS(...) ((struct resource_floats){__VA_ARGS__})
#define RESOURCE_ROW(...)
#define VIEW_BUFFER(id, name, history, slot, unit, texel, size, check)                             \
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

const struct resource_row resource_rows[RESOURCE_COUNT] = {
#define RESOURCE_ROW(id, name, scope, history, storage, units, images)                             \
    [RESOURCE_##id] = {#name, SCOPE_##scope, history, storage, units, images, NULL, 0, NULL, NULL},
#define VIEW_BUFFER(id, name, history, slot, unit, texel, size, check)                             \
    [RESOURCE_##id] = {#name,                                                                      \
                       SCOPE_VIEW,                                                                 \
                       history,                                                                    \
                       1u << (slot),                                                               \
                       unit,                                                                       \
                       0,                                                                          \
                       "view_targets." #name,                                                      \
                       GPU_TEXEL_##texel,                                                          \
                       name##_bytes,                                                               \
                       name##_floats},
#include "renderer/frame/frame.def"
#undef RESOURCE_ROW
#undef VIEW_BUFFER
};
