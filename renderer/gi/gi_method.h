// The seam of global illumination: what a method is to the renderer. A method is a folder below
// renderer/gi/, its shaders, and one row of gi_methods.
#ifndef VOXCAST_RENDERER_GI_GI_METHOD_H
#define VOXCAST_RENDERER_GI_GI_METHOD_H

#include "renderer/error.h"
#include "renderer/settings.h"

struct frame;
struct gi;

// What a method says before a frame is uploaded and planned.
enum gi_readiness {
    GI_READY,     // draw
    GI_UNCHANGED, // the image is final: nothing to draw
    GI_PENDING,   // work goes on elsewhere: ask again in a while
};

// Hooks in the order in which a frame calls them; NULL does nothing. Render thread only.
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

    // Gives up what it keeps for a view that another method draws now.
    void (*leave)(struct gi *gi, struct frame *frame);
};

extern const struct gi_method_hooks gi_none, gi_voxels_clipmap, gi_voxels_grid, gi_path_traced;

// By the settings' method.
extern const struct gi_method_hooks *const gi_methods[GI_METHOD_COUNT];

#endif
