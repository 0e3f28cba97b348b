// One camera's GPU targets, and the ring of frames in readback.
#ifndef VOXCAST_RENDERER_FRAME_VIEW_H
#define VOXCAST_RENDERER_FRAME_VIEW_H

#include "renderer/frame/draw_list.h"
#include "renderer/frame/frame_pixels.h"
#include "renderer/frame/frame_plan.h"
#include "renderer/frame/occlusion.h"
#include "renderer/frame/resource.h"
#include "renderer/gpu/buffer.h"
#include "renderer/gpu/texture.h"
#include "renderer/gpu/timer.h"
#include "renderer/path_tracer/progressive.h"
#include "renderer/gpu_scene/gpu_scene.h"

// Behind the pixels in a ring buffer: the automatic exposure.
#define VIEW_EXPOSURE_BYTES 16u
// Behind that: what the method wants to know of the frame (struct gi_report).
#define VIEW_REPORT_BYTES 24u

struct ring_frame {
    struct gpu_buffer *pixels;
    struct gpu_fence *fence;
    struct frame_pixels result; // planes are set at collection
    double started_ms;
    float fixed_exposure; // scale in use; 0: automatic
    float exposure_bias;
    enum gi_method gi_method; // that drew it
    uint64_t gi_serial;       // gi_state.serial and report_tag of the frame
    uint32_t gi_report_tag;
};

struct view {
    struct gpu *gpu;
    struct gpu_timer *timer;
    uint32_t width; // rendered size; 0 before the first frame
    uint32_t height;

    struct gpu_buffer *frame_block;
    struct gpu_buffer *settings_block;
    struct gpu_texture *ids;
    struct gpu_texture *depth;
    struct gpu_framebuffer *framebuffer;        // ids and depth
    struct gpu_framebuffer *list_framebuffer;   // depth alone, for transparent lists
    struct gpu_buffer *buffers[RESOURCE_COUNT]; // of the rows that are the view's own
    struct draw_list draws;
    struct occlusion occlusion;
    struct draw_list shadow_draws;

    struct gpu_buffer *shadow_views; // the scene's and then this view's cascades
    uint64_t shadow_revision_seen;
    uint64_t shadow_epoch_seen;
    struct shadow_map *cascade_owner; // where the cascades below were reserved
    uint32_t cascade_count;
    uint32_t cascade_numbers[MAX_CASCADES];
    float cascade_center[MAX_CASCADES][3];
    bool cascade_fitted[MAX_CASCADES]; // cascade_center is valid and kept while it fits
    bool cascade_stale[MAX_CASCADES];  // to be rendered
    struct shadow_view_block cascades[MAX_CASCADES];

    struct ring_frame ring[RENDERER_FRAMES_IN_RING];
    uint32_t ring_next;   // slot of the next frame
    uint32_t ring_oldest; // slot of the next to collect
    uint32_t ring_count;
    bool collected; // the caller holds the oldest

    enum gi_method gi_method; // of the newest frame
    uint64_t gi_serial;       // of what the method drew it with; 0 for nothing

    struct live_reference reference;

    struct frame_plan plan; // of the newest frame
    struct frame_history history;
    double last_frame_ms;
    float last_exposure;
};

struct view *view_create(struct gpu *gpu);
void view_destroy(struct view **view);

// Reserves the sun's cascades and space for draws. False when memory runs out.
bool view_reserve(struct view *view, struct gpu_scene *gpu_scene, uint32_t cascade_count);

// Fits the targets to the plan. False when GPU memory runs out.
bool view_prepare(struct view *view, const struct frame_inputs *in, const struct frame_plan *plan);

// Returns the view's cascades to the shadow map that they came from. Call before that is destroyed.
void view_release_cascades(struct view *view);

// Binds the uniforms and textures; the executor binds the buffers that a pass declares.
void view_bind(const struct view *view);

#endif
