#include "renderer/gi/voxel/light_schedule.h"

#include <math.h>
#include <string.h>

// CPU time that a frame may spend on cache cones: little while the camera moves.
#define MOVING_TRACE_MS 10.0
#define REST_TRACE_MS   120.0
#define FIRST_ENTRY_MS  0.006
#define MIN_BUDGET      256.0
#define MIN_REST_BUDGET 6000.0
#define MAX_BUDGET      1e6
#define GPU_BUDGET      131072u
// Converged when the residual, estimated as a geometric series, is below this fraction of the
// brightest voxel face.
#define CONVERGED_RESIDUAL 0.008f
#define MAX_GENERATIONS    48u
// Request pattern: over so many frames every pixel has requested faces once. The cache is complete
// when all of them found nothing to trace.
#define REQUEST_PATTERN 16u
// Smoothing visits all faces, so while the camera moves it runs only every few frames.
#define MOVING_SMOOTH_FRAMES 4u

static void start_generation(struct voxel_volume *volume)
{
    struct voxel_light_state *light = &volume->light;
    light->generation = light->generation % 65535u + 1;
    light->start_pending = false;
    light->relight = true;
    light->unrequested_frames = 0;
    // Change and peak are accumulated over a generation.
    gpu_buffer_fill(volume->counters, COUNTER_CACHE_CHANGE * 4, 4, 0);
    gpu_buffer_fill(volume->counters, COUNTER_CACHE_PEAK * 4, 4, 0);
}

// Generations for the wanted bounces. Pixels that gather add the last bounce themselves.
static uint32_t generations_needed(const struct voxel_light_params *params)
{
    if (params->bounces == 0)
        return MAX_GENERATIONS;
    return params->cache_shown ? params->bounces : params->bounces - 1;
}

static double entry_budget(const struct voxel_volume *volume,
                           const struct voxel_light_params *params)
{
    if (params->trace_budget > 0)
        return params->trace_budget;
    if (!params->software)
        return GPU_BUDGET;
    double entry_ms = volume->light.entry_ms > 0.0 ? volume->light.entry_ms : FIRST_ENTRY_MS;
    double budget = (params->camera_moved ? MOVING_TRACE_MS : REST_TRACE_MS) / entry_ms;
    // The measured time includes fixed costs per frame, so a floor keeps it from shrinking budgets
    // without end.
    return fmin(fmax(budget, params->camera_moved ? MIN_BUDGET : MIN_REST_BUDGET), MAX_BUDGET);
}

static void plan_relight(struct voxel_volume *volume, const struct voxel_light_params *params,
                         struct voxel_light_work *work)
{
    struct voxel_light_state *light = &volume->light;
    work->relight = light->relight;
    work->direct = light->relight_direct;
    work->fresh_only = light->filling && light->relight_direct;
    work->relight_end = volume->cell_level_count;
    if (!light->relight)
        return;
    // New voxels are black and cannot wait for their level's turn.
    bool one = params->levels_per_frame == LEVELS_PER_FRAME_ONE && volume->cell_level_count > 1 &&
               !work->voxelize;
    if (one) {
        work->relight_first = light->next_level % volume->cell_level_count;
        work->relight_end = work->relight_first + 1;
        light->next_level = work->relight_end % volume->cell_level_count;
        light->relight = light->next_level != 0;
        light->relight_direct = light->relight_direct && light->relight;
    } else {
        light->next_level = 0;
        light->relight = false;
        light->relight_direct = false;
    }
}

void voxel_light_begin(struct voxel_volume *volume, const struct voxel_light_params *params,
                       struct voxel_light_work *out_work)
{
    struct voxel_light_state *light = &volume->light;
    *out_work = (struct voxel_light_work){.voxelize = volume->region_count > 0};
    light->needed = generations_needed(params);
    light->unlimited = params->bounces == 0;
    bool more_asked = params->all_faces && !light->all_faces_requested;
    light->all_faces_requested = params->all_faces;
    volume->frame = volume->frame % 0x7fffffffu + 1;
    if (volume->lit_key != params->key || light->generation == 0) {
        light->relight_direct = true;
        volume->lit_key = params->key;
        light->bounce = 0;
        light->filling = false;
        light->change = 0.0f;
        light->residual = 1.0f;
        light->converged = false;
        light->start_pending = true;
        light->relight = true;
    }
    if (out_work->voxelize) {
        // Only a clip level has moved and light had converged: light and trace the new voxels
        // alone.
        if (light->converged && !light->relight)
            light->filling = true;
        light->relight = true;
        light->relight_direct = true;
        light->converged = false;
        light->unrequested_frames = 0;
    }
    if (more_asked || (!params->all_faces && params->camera_moved)) {
        light->converged = false;
        light->unrequested_frames = 0;
    }
    if (light->converged && !light->unlimited && light->bounce < light->needed) {
        light->converged = false; // a new view shows one more bounce of the cache
        light->start_pending = true;
    }
    if (light->bounce >= light->needed && light->needed == 0)
        light->converged = true; // pixels gather the only bounce: no cache needed
    if (!light->converged && light->start_pending && !(light->relight && light->next_level != 0))
        start_generation(volume);
    plan_relight(volume, params, out_work);
    out_work->trace = !light->converged && !(light->relight && light->next_level != 0);
    out_work->smooth = out_work->trace && (!params->camera_moved || light->smooth_due ||
                                           volume->frame % MOVING_SMOOTH_FRAMES == 0);
    light->unsmoothed = (light->unsmoothed || out_work->trace) && !out_work->smooth;
    light->smooth_due = light->smooth_due && !out_work->smooth;
    // With limited bounces the first generation after an edit must not see the former light.
    bool feeds = params->multi_bounce && (light->bounce > 0 || light->unlimited);
    volume->uniforms.cache_generation = light->generation;
    volume->uniforms.frame_number = volume->frame;
    volume->uniforms.trace_budget = (uint32_t)entry_budget(volume, params);
    volume->uniforms.all_faces = params->all_faces;
    volume->uniforms.peak_radiance = light->peak;
    out_work->inject_bounce = feeds;
}

void voxel_light_collect(struct voxel_volume *volume, uint32_t generation,
                         const struct voxel_light_report *report, double trace_ms)
{
    struct voxel_light_state *light = &volume->light;
    // Faces without a record stay dark: enlarge the pool and voxelize again.
    if (report->overflow & OVERFLOW_FACES)
        volume->faces_full = true;
    // Counted in look-ups; the budget counts marches.
    if (report->traced >= MIN_BUDGET * CACHE_MARCH_COST / 2 && trace_ms > 0.0)
        light->entry_ms = CACHE_MARCH_COST * trace_ms / report->traced;
    if (generation != light->generation || light->start_pending || light->converged ||
        volume->faces_full)
        return;
    light->unrequested_frames =
        report->left == 0 && report->traced == 0 ? light->unrequested_frames + 1 : 0;
    bool complete = light->all_faces_requested ? report->left == 0
                                               : light->unrequested_frames >= REQUEST_PATTERN;
    if (!complete)
        return;
    light->smooth_due = light->unsmoothed; // voxels take light from smoothed faces
    if (light->smooth_due)
        return;
    if (light->filling) {
        light->filling = false;
        light->converged = true;
        light->version++;
        light->relight = true;
        return;
    }
    float change, peak;
    memcpy(&change, &report->change_bits, sizeof(change));
    memcpy(&peak, &report->peak_bits, sizeof(peak));
    float ratio = light->change > 0.0f ? fminf(change / light->change, 0.95f) : 0.95f;
    light->change = change;
    light->residual = change * ratio / (1.0f - ratio);
    light->peak = peak;
    light->bounce++;
    light->converged = light->bounce >= light->needed ||
                       (light->unlimited && light->residual < CONVERGED_RESIDUAL);
    light->start_pending = !light->converged;
    light->converged_once = light->converged_once || light->converged;
    light->version++;
    // Cones of gathering pixels must see the last bounce, too.
    light->relight = true;
}

float voxel_light_convergence(const struct voxel_volume *volume)
{
    const struct voxel_light_state *light = &volume->light;
    if (light->converged)
        return 1.0f;
    if (light->bounce == 0)
        return 0.0f;
    float left = light->unlimited ? fminf(light->residual, 1.0f)
                                  : 1.0f - (float)light->bounce / (float)light->needed;
    return 0.99f * (1.0f - left);
}
