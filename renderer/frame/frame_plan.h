// What a frame does, decided in one place: a pure function of plain data, without GL, made from the
// rows of frame.def.
#ifndef VOXCAST_RENDERER_FRAME_FRAME_PLAN_H
#define VOXCAST_RENDERER_FRAME_FRAME_PLAN_H

#include <assert.h>
#include <stddef.h>

#include "renderer/frame/effects.h"
#include "renderer/frame/frame_params.h"
#include "renderer/gpu_scene/scene_facts.h"
#include "renderer/scene/scene.h"

enum pass_id {
#define PASS(id, ...) PASS_##id,
#include "renderer/frame/frame.def"
#undef PASS
    PASS_COUNT
};

enum plan_switch {
#define SWITCH(id, ...) SWITCH_##id,
#include "renderer/frame/frame.def"
#undef SWITCH
    SWITCH_COUNT
};

#define SWITCH_BIT(name) (1u << SWITCH_##name)

// Rays sample every light up to this number. With more lights, hits are lit from the voxels and
// soft shadows are left to cones.
#define FRAME_MAX_RAY_LIGHTS 16u

// What a frame has to do for its view's volume.
struct voxel_light_work {
    bool voxelize;
    bool relight;
    bool direct;            // inject direct light, too, not only the cache's bounce
    bool inject_bounce;     // voxels include the cache's bounce
    bool fresh_only;        // only cells that have not been lit yet
    uint32_t relight_first; // levels first to end - 1
    uint32_t relight_end;
    bool trace;
    bool smooth; // faces among their neighbours, once traced
};

// What the method draws with, as the frame finds it.
struct gi_state {
    uint64_t serial;     // tells volumes apart, or what else methods keep; 0 for none
    uint32_t report_tag; // comes back to the method with what the frame reads back
    uint32_t level_count;
    uint32_t cell_level_count; // levels with cells of their own; the rest are mips
    bool light_converged;
    uint32_t light_version; // counts changes of the radiance that cones see
    struct voxel_light_work work;
};

// Samples of pixels that accumulate while nothing moves.
struct accumulation_state {
    uint32_t samples;
    uint64_t key; // hash of everything that invalidates them, besides the surfaces
};

// What the view's newest frame was made from, and what it left. All zero before the first.
struct frame_history {
    bool drawn;          // false before the first frame, and after a failure
    bool surfaces_stale; // ids, depth and G-buffer are of an earlier frame
    struct frame_params params;
    struct scene_revisions revisions;
    uint64_t scene_number;
    float convergence;
    struct accumulation_state accumulation;
    uint64_t shown_light;           // light version of the volume in the last image
    uint32_t accumulate_only_count; // frames since the last image
};

// All that a plan depends on. What is zero is not known yet, or not there.
struct frame_inputs {
    const struct frame_params *params;
    const struct scene_revisions *revisions;
    uint64_t scene_number; // tells apart scenes that were set one after another
    const struct frame_history *history;
    uint32_t target_width; // of the view's present targets; 0 for none
    struct scene_facts scene;
    uint32_t gi_capabilities;  // of the method: enum gi_capability
    bool reference_shown;      // the method has made the image itself
    bool shadows_stale;        // a shadow map must be rendered
    bool transparent_in_view;  // transparent triangles are visible to the camera
    const struct gi_state *gi; // NULL where the method draws with nothing
};

struct accumulation_plan {
    enum gather_mode gather;        // what this frame shows: the cache, until light has converged
    uint32_t planes;                // of the accumulation, without the full-resolution shadow plane
    bool wants_ray_shadows;         // soft shadows are traced by rays once light has converged
    bool ray_shadows;               // and this frame shows them
    bool sample;                    // add one; else the accumulation is still valid as it is
    bool only;                      // adds samples or converges light, and keeps the last image
    uint32_t target;                // samples to accumulate
    uint32_t samples;               // including this frame's
    float specular_max_roughness;   // rougher surfaces take specular light from the cache,
    float specular_min_reflectance; // and so do those with a lower reflectance
};

struct frame_plan {
    uint32_t changes;        // since the history: enum invalidation
    bool surfaces_changed;   // by camera, size, geometry, transforms or materials
    bool visibility_changed; // likewise, or the rendered size is another
    bool unchanged;          // everything equals the frame before
    struct effect_plan effects;
    struct quality_level quality; // as the settings resolve it: nothing is "auto"
    enum cone_set cache_cone_set; // of the irradiance cache; likewise
    float cache_cone_step;
    uint32_t gather_step; // every how many-th pixel gathers, in x and in y
    uint32_t width;       // rendered size
    uint32_t height;
    uint32_t tiles_x; // of light culling
    uint32_t tiles_y;
    uint64_t light_key; // hash of everything that light in voxels depends on
    struct accumulation_plan accumulation;
    bool needs_bvh;
    const char *skip_reasons[PASS_COUNT]; // NULL: the pass runs. May point into `effects`.
    enum pass_id radiance_writer;         // the first pass that writes radiance
    uint32_t switches[SWITCH_COUNT];

    // History after the frame, once it has been drawn.
    struct accumulation_state accumulation_after;
    uint64_t shown_light_after;
    uint32_t accumulate_only_count_after;
};

// What has changed since the history: bits of enum invalidation; everything if there is none. Reads
// params, revisions, scene_number and history.
uint32_t frame_plan_changes(const struct frame_inputs *in);

// Decides everything. `plan` must stay where it is: it points into itself. Called twice a frame:
// first without `gi`, for what the method needs to find its volume (effects, quality, light_key and
// surfaces_changed are final then), and then with everything known.
void frame_plan_make(struct frame_plan *plan, const struct frame_inputs *in);

// --- What follows from the inputs, or from a plan, alone ---

// Whether there are filtered voxels that cones can be traced through.
bool frame_plan_has_cones(const struct frame_inputs *in);

// Whether pixels get direct light; other debug views show something else.
bool frame_plan_lights_pixels(const struct frame_inputs *in);

// Whether the image is radiance and goes through exposure and tone curve, rather than shown as is.
bool frame_plan_shows_light(const struct frame_inputs *in);

// Why the debug view has nothing to show, so that the image is plain grey; NULL if it has.
const char *frame_plan_blank_reason(const struct frame_inputs *in);

// Voxel level that a debug view shows, and whether it has cells. Those beyond are mips, which hold
// radiance and opacity only.
uint32_t frame_plan_debug_level(const struct frame_inputs *in);
bool frame_plan_debug_level_has_cells(const struct frame_inputs *in);

// Whether soft shadows are traced with cones towards the lights.
bool frame_plan_has_cone_shadows(const struct frame_inputs *in, const struct frame_plan *plan);

// Whether pixels read the cache instead of gathering the last bounce themselves.
bool frame_plan_shows_cache(const struct frame_inputs *in, const struct frame_plan *plan);

// Of passes below one whose rules are asked.
extern const char frame_plan_undecided[];

static inline bool frame_plan_runs(const struct frame_plan *plan, enum pass_id pass)
{
    assert(plan->skip_reasons[pass] != frame_plan_undecided); // rules may ask of passes above
    return plan->skip_reasons[pass] == NULL;
}

// Bytes of the output image, and offsets and row pitches of its planes.
size_t frame_plan_output_layout(const struct frame_params *params, size_t out_offsets[3],
                                uint32_t out_pitches[3]);
size_t frame_plan_output_bytes(const struct frame_inputs *in);
size_t frame_plan_accumulation_bytes(const struct frame_inputs *in, const struct frame_plan *plan);

const char *pass_name(enum pass_id pass);

// The define of a switch.
const char *plan_switch_define(enum plan_switch name);

#endif
