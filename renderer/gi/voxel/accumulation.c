// Final gather of a frame: pixels read the cache, or trace samples of their own that accumulate
// while nothing moves.
#include "renderer/frame/view.h"
#include "renderer/gi/voxel/accumulation.h"
#include "renderer/gi/voxel/light_hash.h"
#include "renderer/gi/voxel/volume.h"

// Frames in a row without a new image while the cache converges.
#define MAX_ACCUMULATE_ONLY_FRAMES 7u
// With fewer samples rays are noisier than the cache, which is shown instead.
#define SHOWN_RAYS 16u
// Samples that cone gathering accumulates.
#define CONE_PICTURES 4u
// Greater than any roughness.
#define ALL_ROUGHNESS 1.01f

// While the cache converges, skip shading for up to MAX_ACCUMULATE_ONLY_FRAMES frames.
static void converge_without_shading(struct frame *frame, const struct voxel_volume *volume)
{
    struct view *view = frame->view;
    bool shown = frame->unchanged && !frame->light_work.voxelize &&
                 view->shown_light == volume->light.version &&
                 view->accumulate_only_count < MAX_ACCUMULATE_ONLY_FRAMES;
    frame->accumulate_only = shown && frame_gather_mode(frame) == GATHER_RAYS;
    view->accumulate_only_count = frame->accumulate_only ? view->accumulate_only_count + 1 : 0;
    view->shown_light = volume->light.version;
}

static void show_cache(struct frame *frame)
{
    frame->gather = GATHER_CACHE;
    frame->accumulated_samples = 0;
    frame->view->accumulated_samples = 0;
}

// Keep the last image until SHOWN_RAYS samples are in. Not with a limited number of bounces: then
// the cache holds one bounce less than is shown and cannot replace the rays.
static bool keeps_last_image(const struct frame *frame, uint32_t count)
{
    uint32_t enough =
        frame->accumulation_target < SHOWN_RAYS ? frame->accumulation_target : SHOWN_RAYS;
    return frame->gather == GATHER_RAYS && count < enough && frame->params->settings.bounces == 0;
}

// Adds one sample, unless all are in. With rays, shows the accumulation whenever the sample count
// has doubled, and with the last sample.
static void accumulate_once(struct frame *frame, struct voxel_volume *volume)
{
    struct view *view = frame->view;
    frame->accumulate = view->accumulated_samples < frame->accumulation_target;
    view->accumulated_samples += frame->accumulate;
    frame->accumulated_samples = view->accumulated_samples;
    volume->uniforms.sample_count = (float)view->accumulated_samples;
    bool doubled = (view->accumulated_samples & (view->accumulated_samples - 1)) == 0;
    bool shown = view->accumulated_samples == frame->accumulation_target ||
                 (doubled && !keeps_last_image(frame, view->accumulated_samples));
    frame->accumulate_only =
        frame->gather == GATHER_RAYS && frame->accumulate && frame->unchanged && !shown;
}

bool gi_plan_accumulation(struct frame *frame, struct error *out_error)
{
    struct view *view = frame->view;
    struct voxel_volume *volume = frame->volume;
    // No accumulation in this mode: forget its samples.
    if (!volume || frame->gather == GATHER_CACHE)
        view->accumulated_samples = 0;
    if (!volume)
        return true;
    struct voxel_block *block = &volume->uniforms;
    frame->accumulation_target = 1;
    frame->accumulated_samples = 1;
    if (frame->gather == GATHER_RAYS)
        frame->accumulation_target = frame->quality->ray_pictures;
    else if (frame->gather != GATHER_CACHE)
        frame->accumulation_target = CONE_PICTURES;
    if (frame->gather != GATHER_CACHE) {
        uint64_t key = hash_march(volume->light.version, &block->pixel_march);
        key = hash_word(key, volume->lit_key);
        key = hash_word(key, view->volume_serial);
        key = hash_word(key, (uint64_t)frame->gather);
        // Planes of effects and views that were off hold nothing.
        key = hash_word(key, frame->plan.bits);
        key = hash_word(key, (uint64_t)frame->params->debug_view);
        key = hash_word(key,
                        render_settings_hash(&frame->params->settings, INVALIDATES_ACCUMULATION));
        if (frame->visibility_changed || frame->light_work.voxelize ||
            key != view->accumulation_key)
            view->accumulated_samples = 0;
        view->accumulation_key = key;
        if (!volume->light.converged) {
            show_cache(frame);
            converge_without_shading(frame, volume);
        } else if (!frame->unchanged && keeps_last_image(frame, view->accumulated_samples)) {
            show_cache(frame);
        } else {
            accumulate_once(frame, volume);
        }
    }
    // One ray serves any lobe: where rays gather, every specular lobe is traced.
    bool rays = frame->gather == GATHER_RAYS;
    block->specular_max_roughness = rays ? ALL_ROUGHNESS : frame->quality->specular_roughness;
    block->specular_min_reflectance = rays ? 0.0f : frame->quality->specular_reflectance;
    return !rays || !frame->accumulate || gpu_scene_need_tree(frame->gpu_scene) ||
           error_set(out_error, "a tree of the scene's triangles does not fit into memory");
}
