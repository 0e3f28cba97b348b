// What passes read and write on the GPU, made from the rows of frame.def.
#ifndef VOXCAST_RENDERER_FRAME_RESOURCE_H
#define VOXCAST_RENDERER_FRAME_RESOURCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "renderer/gpu/gpu.h"

enum resource {
#define RESOURCE_ROW(id, ...) RESOURCE_##id,
#define VIEW_BUFFER(id, ...)  RESOURCE_##id,
#include "renderer/frame/frame.def"
#undef RESOURCE_ROW
#undef VIEW_BUFFER
    RESOURCE_COUNT
};

#define RESOURCE(name) (1u << RESOURCE_##name)

enum resource_scope {
    SCOPE_SCENE,  // uploaded before the passes run
    SCOPE_VOLUME, // of voxels: kept over frames
    SCOPE_VIEW,
};

// Which words of a buffer must be finite floats. Bit 31 stands for all words from 31 on.
struct resource_floats {
    uint32_t record_words; // 0: none of the buffer
    uint32_t floats;
    uint32_t low_halves;
    uint32_t high_halves;
};

struct frame_inputs;
struct frame_plan;

struct resource_row {
    const char *name;
    enum resource_scope scope;
    bool history;     // what earlier frames wrote is read
    uint32_t storage; // bits of the storage bindings
    uint64_t units;   // bits of the texture units
    uint32_t images;  // bits of the image units

    // Of a storage buffer of the view; NULL for all else.
    const char *label;    // of the GL object
    enum gpu_texel texel; // as shaders read it, where there is a texture unit for it
    size_t (*bytes)(const struct frame_inputs *in, const struct frame_plan *plan); // 0: not needed
    struct resource_floats (*floats)(const struct frame_inputs *in);
};

extern const struct resource_row resource_rows[RESOURCE_COUNT];

#define RESOURCE_DEFINES_BYTES 2048u

// Where shaders find the view's buffers: lines of BIND_id and UNIT_id, which stand before all
// shaders (gpu_set_shader_defines()).
void resources_write_defines(char out_defines[RESOURCE_DEFINES_BYTES]);

#endif
