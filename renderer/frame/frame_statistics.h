// What a frame did and what it cost: plain data.
#ifndef VOXCAST_RENDERER_FRAME_FRAME_STATISTICS_H
#define VOXCAST_RENDERER_FRAME_FRAME_STATISTICS_H

#include <stdbool.h>
#include <stdint.h>

#define RENDERER_MAX_PASSES     32u
#define RENDERER_MAX_EFFECTS    32u
#define FRAME_MAX_MEMORY_GROUPS 16u

struct pass_statistics {
    const char *name;
    bool ran;            // in the newest frame
    double time_ms;      // of the newest frame whose timers have arrived
    const char *reason;  // why it was skipped; "" when it ran
    uint64_t view_bytes; // that it reads and writes of the view's resources, each once as a whole
};

struct effect_statistics {
    const char *name;
    bool on;
    char reason[96]; // text, e.g. "no transparent material in the scene"
};

struct memory_statistics {
    char name[32]; // e.g. "textures", "geometry", "shadow_maps", "view_targets"
    uint64_t bytes;
};

// Values that were invalid or exceeded a capacity, and were clamped or left out.
struct reject_statistics {
    const char *name; // e.g. "triangles_left_out"
    uint64_t count;
};

struct frame_statistics {
    uint32_t pass_count;
    struct pass_statistics passes[RENDERER_MAX_PASSES];
    uint32_t effect_count;
    struct effect_statistics effects[RENDERER_MAX_EFFECTS];
    uint32_t memory_count;
    struct memory_statistics memory[FRAME_MAX_MEMORY_GROUPS];
    uint32_t reject_count;
    struct reject_statistics rejects[8];
    double frame_time_ms; // of the newest collected frame
    float exposure;       // scale in use
    uint32_t render_width, render_height;
};

#endif
