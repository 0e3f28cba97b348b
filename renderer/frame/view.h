// One camera's targets on the GPU and the ring of frames on their way to host memory.
#ifndef VOXCAST_RENDERER_FRAME_VIEW_H
#define VOXCAST_RENDERER_FRAME_VIEW_H

#include "renderer/frame/draw_list.h"
#include "renderer/frame/effects.h"
#include "renderer/frame/frame_pixels.h"
#include "renderer/gpu/buffer.h"
#include "renderer/gpu/texture.h"
#include "renderer/gpu/timer.h"
#include "renderer/path_tracer/progressive.h"
#include "renderer/gpu_scene/gpu_scene.h"

// Behind the pixels in a ring buffer: the exposure that was found automatically.
#define VIEW_EXPOSURE_BYTES 16u
// Behind that: what the counters of the volume said (struct voxel_light_report).
#define VIEW_REPORT_BYTES 24u

struct ring_frame {
    struct gpu_buffer *pixels;
    struct gpu_fence *fence;
    struct frame_pixels result; // planes filled in at collection
    double started_ms;
    float fixed_exposure; // scale in use; 0 if it was found automatically
    float exposure_bias;
    uint64_t volume_serial;
    uint32_t generation; // of the cache that the frame traced; 0 for none
};

struct view {
    struct gpu *gpu;
    struct gpu_timer *timer;
    uint32_t width; // rendered; 0 before the first frame
    uint32_t height;

    struct gpu_buffer *frame_block;
    struct gpu_texture *ids;
    struct gpu_texture *depth;
    struct gpu_framebuffer *framebuffer;      // ids and depth
    struct gpu_framebuffer *list_framebuffer; // depth alone, for transparent lists
    struct gpu_buffer *gbuffer;
    struct gpu_buffer *radiance;
    struct gpu_buffer *light_masks;
    struct gpu_buffer *fragments;
    struct gpu_buffer *transparent_tiles;
    struct gpu_buffer *exposure;
    struct gpu_buffer *output;
    struct draw_list draws;
    struct draw_list shadow_draws;

    struct gpu_buffer *shadow_views; // the scene's and then this view's cascades
    uint64_t shadow_revision_seen;
    uint64_t shadow_epoch_seen;
    struct shadow_map *cascade_owner; // where the cascades below were taken from
    uint32_t cascade_count;
    uint32_t cascade_numbers[MAX_CASCADES];
    float cascade_center[MAX_CASCADES][3];
    bool cascade_fitted[MAX_CASCADES]; // the centre above is to be kept while it suits
    bool cascade_stale[MAX_CASCADES];  // to be drawn
    struct shadow_view_block cascades[MAX_CASCADES];

    struct ring_frame ring[RENDERER_FRAMES_IN_RING];
    uint32_t ring_next;   // where the next frame goes
    uint32_t ring_oldest; // the next to collect
    uint32_t ring_count;
    bool collected; // the oldest is with the caller

    uint64_t volume_serial; // of the volume that the newest frame was drawn with; 0 for none

    struct gpu_buffer
        *accumulation;            // irradiance that pixels have gathered, summed over still frames
    uint32_t accumulated_samples; // pictures in that sum
    uint64_t shown_light;         // version of the light in voxels that the newest picture shows
    uint32_t accumulate_only_count; // frames since then
    uint64_t accumulation_key; // of the light, of the cones that saw it, and of what was asked for
    struct gpu_buffer
        *glossy_tiles; // arguments and numbers of tiles that reflections are traced in

    struct live_reference reference;

    // What the newest drawn frame was made from.
    bool drawn;
    bool surfaces_stale; // ids, depth and G-buffer are of an earlier frame
    struct frame_params last_params;
    struct scene_revisions last_revisions;
    uint64_t last_scene;
    struct effect_plan last_plan;
    const char *pass_skip_reasons[RENDERER_MAX_PASSES];
    double last_frame_ms;
    float last_exposure;
    float last_convergence;
};

struct view *view_create(struct gpu *gpu);
void view_destroy(struct view **view);

struct frame;

// Makes the targets fit the frame's size, effects and gathering. False when GPU memory ends.
bool view_prepare(struct view *view, const struct frame *frame);

// Bytes of one output picture, and where its planes lie.
size_t view_output_layout(const struct frame_params *params, size_t out_offsets[3],
                          uint32_t out_pitches[3]);

// Gives the view's cascades back to the shadow map they came from; before that goes.
void view_release_cascades(struct view *view);

void view_bind(const struct view *view);

#endif
