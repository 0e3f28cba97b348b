// The seam of global illumination: what a method is to the renderer. A method is a folder below
// renderer/gi/, its shaders, and one row of GI_METHOD_ROWS.
#ifndef VOXCAST_RENDERER_GI_GI_METHOD_H
#define VOXCAST_RENDERER_GI_GI_METHOD_H

#include "renderer/error.h"
#include "renderer/frame/resource.h"
#include "renderer/settings.h"

// Its value in enums.def, and its hooks.
#define GI_METHOD_ROWS(ROW)                                                                        \
    ROW(NONE, gi_none)                                                                             \
    ROW(CLIPMAP, gi_voxels_clipmap)                                                                \
    ROW(GRID, gi_voxels_grid)                                                                      \
    ROW(REFERENCE, gi_path_traced)

// What a method may have checked for values that are not finite.
#define GI_MAX_RESOURCES 4u

struct frame;
struct gi;
struct gpu_buffer;
struct gpu_texture;
struct view;

// What a method says before a frame is uploaded and planned.
enum gi_readiness {
    GI_READY,     // draw
    GI_UNCHANGED, // the image is final: nothing to draw
    GI_PENDING,   // work goes on elsewhere: ask again in a while
};

// What a frame has read back, once the GPU is done with it.
struct gi_report {
    struct view *view;
    uint64_t serial;   // gi_state.serial of that frame
    uint32_t tag;      // gi_state.report_tag of that frame
    const void *bytes; // VIEW_REPORT_BYTES that passes/readback.c has copied
};

// What a method tells of what it keeps.
struct gi_findings {
    uint32_t values_cut; // values that were beyond the range of what stores them
    uint32_t resource_count;
    struct gi_resource {
        const char *name;
        enum resource resource;
        const struct gpu_buffer *buffer; // NULL with `volume`
        struct resource_floats floats;   // of the buffer
        const struct gpu_texture *volume;
    } resources[GI_MAX_RESOURCES];
};

// Hooks in the order in which a frame calls them; NULL does nothing. What a method keeps over
// frames is in gi->kept[its value]. Render thread only.
struct gi_method_hooks {
    uint32_t capabilities; // enum gi_capability

    // `same`: parameters and document are those of the frame before.
    enum gi_readiness (*prepare)(struct gi *gi, struct frame *frame, bool same);

    // Finds or creates what the method keeps, plans this frame's work on it, and tells the frame of
    // both (frame.gi), once the effects are planned. False with a message when memory runs out.
    bool (*begin)(struct gi *gi, struct frame *frame, struct error *out_error);

    // Binds what its passes read and write, once everything is planned.
    void (*bind)(const struct frame *frame);

    // 0 to 1: how far the frame that has been drawn has come. NULL: 1.
    float (*convergence)(const struct frame *frame);

    // Takes what a frame that began with a serial has read back. Later frames may have begun.
    void (*collect)(struct gi *gi, const struct gi_report *report);

    // Tells of what it keeps under a serial, if it still does. `out_findings` is empty before.
    void (*inspect)(const struct gi *gi, uint64_t serial, struct gi_findings *out_findings);

    // Gives up what it keeps for a view that another method draws now.
    void (*leave)(struct gi *gi, struct frame *frame);

    // Frees what no view's newest frame was drawn with: views[i]->gi_serial is its serial.
    void (*release_unused)(struct gi *gi, struct view *const *views, uint32_t view_count);

    // Frees everything: the scene is about to be replaced.
    void (*release)(struct gi *gi);
};

#define DECLARE_HOOKS(id, hooks) extern const struct gi_method_hooks hooks;
GI_METHOD_ROWS(DECLARE_HOOKS)
#undef DECLARE_HOOKS

// By the settings' method.
extern const struct gi_method_hooks *const gi_methods[GI_METHOD_COUNT];

#endif
