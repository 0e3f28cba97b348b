#include "renderer/renderer.h"

#include <assert.h>
#include <float.h>
#include <malloc.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "renderer/camera.h"
#include "renderer/finite_check.h"
#include "renderer/frame/frame_block.h"
#include "renderer/frame/settings_block.h"
#include "renderer/gi/gi.h"
#include "renderer/gpu/program.h"
#include "renderer/passes/pass.h"
#include "renderer/gpu_scene/gpu_scene.h"
#include "renderer/frame/view.h"
#include "voxcast_paths.h"

struct renderer {
    struct gpu *gpu;
    struct gpu_scene *gpu_scene; // NULL while no scene is set
    struct scene *scene;
    struct gi gi;
    uint32_t view_count;
    struct view *views[RENDERER_MAX_VIEWS]; // the first view_count are valid
    struct ray_scene *ray_scene;
    struct scene_revisions ray_revisions;
    const struct bvh *trimmed_bvh; // of the frame that memory was trimmed after
    uint64_t trimmed_programs;
    bool lost;                       // the GL context is lost
    bool (*admit_frame)(void *user); // NULL: always admitted
    void *user;
};

static const char *find_shader_dir(const struct renderer_params *params)
{
    if (params->shader_dir)
        return params->shader_dir;
    const char *from_environment = getenv("VOXCAST_SHADER_DIR");
    if (from_environment && *from_environment)
        return from_environment;
    if (access(VOXCAST_SOURCE_DIR "/shaders/shared/slots.h", R_OK) == 0)
        return VOXCAST_SOURCE_DIR "/shaders";
    return VOXCAST_INSTALL_SHARE_DIR "/shaders";
}

void renderer_prepare_process(char *const arguments[])
{
    gpu_prepare_process(arguments);
}

struct renderer *renderer_create(const struct renderer_params *params, struct error *out_error)
{
    struct renderer *renderer = calloc(1, sizeof(*renderer));
    if (!renderer) {
        error_set(out_error, "out of memory");
        return NULL;
    }
    assert(passes_check(all_passes, PASS_COUNT, NULL));
    renderer->admit_frame = params->admit_frame;
    renderer->user = params->user;
    renderer->gpu = gpu_create(params->gpu, find_shader_dir(params), out_error);
    if (!renderer->gpu) {
        free(renderer);
        return NULL;
    }
    if (!passes_prepare_gpu(renderer->gpu)) {
        error_set(out_error, "out of memory");
        gpu_destroy(&renderer->gpu);
        free(renderer);
        return NULL;
    }
    gpu_set_yield(renderer->gpu, params->yield, params->user);
    if (params->watch_shaders)
        gpu_programs_watch(renderer->gpu);
    gi_init(&renderer->gi, renderer->gpu);
    renderer->gi.trace_budget = params->trace_budget;
    return renderer;
}

void renderer_destroy(struct renderer **renderer_slot)
{
    struct renderer *renderer = *renderer_slot;
    *renderer_slot = NULL;
    if (!renderer)
        return;
    assert(renderer->view_count == 0);
    ray_scene_destroy(&renderer->ray_scene);
    gi_finish(&renderer->gi);
    gpu_scene_destroy(&renderer->gpu_scene);
    gpu_destroy(&renderer->gpu);
    free(renderer);
}

const struct renderer_info *renderer_get_info(const struct renderer *renderer)
{
    return gpu_get_info(renderer->gpu);
}

void renderer_inject_fault(struct renderer *renderer, enum renderer_fault fault, uint64_t number)
{
    gpu_inject_fault(renderer->gpu, fault, number);
}

uint64_t renderer_fault_left(const struct renderer *renderer, enum renderer_fault fault)
{
    return gpu_fault_left(renderer->gpu, fault);
}

bool renderer_is_lost(const struct renderer *renderer)
{
    return renderer->lost;
}

uint64_t renderer_gl_error_count(const struct renderer *renderer)
{
    return gpu_error_count(renderer->gpu);
}

bool renderer_set_scene(struct renderer *renderer, struct scene *scene, struct error *out_error)
{
    struct gpu_scene *gpu_scene = NULL;
    if (scene) {
        gpu_scene = gpu_scene_create(renderer->gpu, scene, out_error);
        if (!gpu_scene)
            return false;
    }
    for (uint32_t i = 0; i < renderer->view_count; i++) {
        view_release_cascades(renderer->views[i]);
        live_reference_finish(&renderer->views[i]->reference);
    }
    ray_scene_destroy(&renderer->ray_scene);
    gi_set_scene(&renderer->gi, scene);
    gpu_scene_destroy(&renderer->gpu_scene);
    renderer->gpu_scene = gpu_scene;
    renderer->scene = scene;
    malloc_trim(0);
    return true;
}

struct view *renderer_view_create(struct renderer *renderer)
{
    if (renderer->view_count == RENDERER_MAX_VIEWS)
        return NULL;
    struct view *view = view_create(renderer->gpu);
    if (view)
        renderer->views[renderer->view_count++] = view;
    return view;
}

void renderer_view_destroy(struct renderer *renderer, struct view **view)
{
    for (uint32_t i = 0; i < renderer->view_count; i++)
        if (renderer->views[i] == *view) {
            renderer->views[i] = renderer->views[--renderer->view_count];
            break;
        }
    view_destroy(view);
    gi_release_unused(&renderer->gi, renderer->views, renderer->view_count);
}

// Finds what the plan depends on and only the GPU's scene and the method know, and makes it.
static bool plan_frame(struct renderer *renderer, struct frame *frame, struct error *out_error)
{
    struct view *view = frame->view;
    struct frame_inputs *inputs = &frame->inputs;
    inputs->scene = gpu_scene_get_facts(frame->gpu_scene);
    frame_plan_make(&view->plan, inputs); // effects, for what comes next
    if (!gi_begin_frame(&renderer->gi, frame, out_error))
        return false;
    gi_release_unused(&renderer->gi, renderer->views, renderer->view_count);
    inputs->gi = frame->gi.serial ? &frame->gi : NULL;
    if (!view_reserve(view, frame->gpu_scene, view->plan.quality.shadow_cascades))
        return error_set(out_error, "shadow maps and draws do not fit into GPU memory");
    shadow_map_fit_cascades(frame);
    inputs->shadows_stale = shadow_map_is_stale(frame);
    if (view->plan.surfaces_changed) {
        mat4 clip_from_world;
        frame_clip_from_world(frame, clip_from_world);
        draw_list_fill(&view->draws, frame->gpu_scene, clip_from_world, frame->camera.eye);
    }
    inputs->transparent_in_view = draw_list_has(&view->draws, DRAW_TRANSPARENT);
    inputs->target_width = view->width;
    frame_plan_make(&view->plan, inputs);
    return true;
}

static bool draw_frame(struct renderer *renderer, struct frame *frame, struct error *out_error)
{
    struct view *view = frame->view;
    if (!plan_frame(renderer, frame, out_error))
        return false;
    if (!view_prepare(view, &frame->inputs, frame->plan))
        return error_set(out_error, "a view of %u x %u pixels does not fit into GPU memory",
                         frame->params->width, frame->params->height);
    if (frame->plan->needs_bvh && !gpu_scene_need_bvh(frame->gpu_scene))
        return error_set(out_error, "a BVH of the scene's triangles does not fit into memory");
    struct frame_block block;
    frame_block_fill(frame, &block);
    shadow_map_relate_cascades(frame, &block);
    gpu_buffer_write(view->frame_block, 0, sizeof(block), &block);
    uint32_t words[SETTINGS_WORD_COUNT];
    settings_block_fill(&frame->params->settings, words);
    gpu_buffer_write(view->settings_block, 0, sizeof(words), words);
    gpu_scene_bind(frame->gpu_scene);
    view_bind(view);
    gi_bind_frame(frame);
    return passes_execute(frame, out_error);
}

// Gives back to the system what loading a scene, compiling shaders and building a BVH have left,
// after the frames that have.
static void trim_memory(struct renderer *renderer)
{
    const struct bvh *bvh = renderer->gpu_scene->bvh;
    uint64_t programs = gpu_programs_built(renderer->gpu);
    if (bvh == renderer->trimmed_bvh && programs == renderer->trimmed_programs)
        return;
    malloc_trim(0);
    renderer->trimmed_bvh = bvh;
    renderer->trimmed_programs = programs;
}

static bool params_are_valid(const struct frame_params *params, struct error *out_error)
{
    if (params->width < VIEW_MIN_EDGE || params->width > VIEW_MAX_WIDTH ||
        params->height < VIEW_MIN_EDGE || params->height > VIEW_MAX_HEIGHT)
        return error_set(out_error, "size is %ux%u; allowed: 1x1 to %ux%u", params->width,
                         params->height, VIEW_MAX_WIDTH, VIEW_MAX_HEIGHT);
    const struct view_camera *camera = &params->camera;
    for (int axis = 0; axis < 3; axis++)
        if (!isfinite(camera->eye[axis]) || !isfinite(camera->target[axis]) ||
            !isfinite(camera->up[axis]))
            return error_set(out_error, "the camera's placement is not finite");
    return isfinite(camera->fov_y_rad) || error_set(out_error, "the field of view is not finite");
}

bool renderer_admit_frame(const struct renderer *renderer)
{
    return !renderer->admit_frame || renderer->admit_frame(renderer->user);
}

// Records what the host needs to collect the frame once the GPU has finished it.
static void queue_readback(const struct frame *frame, double started_ms)
{
    struct view *view = frame->view;
    const struct frame_params *params = frame->params;
    struct ring_frame *slot = &view->ring[view->ring_next];
    slot->fence = gpu_fence_create(frame->gpu);
    slot->started_ms = started_ms;
    bool fixed = params->settings.exposure_mode == EXPOSURE_FIXED;
    slot->exposure_bias = exp2f(params->settings.exposure_ev);
    slot->fixed_exposure = fixed ? slot->exposure_bias : 0.0f;
    slot->result = (struct frame_pixels){
        .user_id = params->user_id,
        .width = params->width,
        .height = params->height,
        .output = params->output,
        .convergence = gi_convergence(frame),
    };
    if (frame->reference_picture) {
        const struct live_reference *live = &view->reference;
        slot->result.reference_samples = live->shown_samples;
        slot->result.reference_noise =
            isfinite(live->progress.noise) ? (float)live->progress.noise : 0.0f;
    }
    slot->gi_method = view->gi_method;
    slot->gi_serial = frame->gi.serial;
    slot->gi_report_tag = frame->gi.report_tag;
    view->ring_next = (view->ring_next + 1) % RENDERER_FRAMES_IN_RING;
    view->ring_count++;
}

enum render_result renderer_view_draw(struct renderer *renderer, struct view *view,
                                      const struct frame_params *params, struct error *out_error)
{
    if (!renderer_admit_frame(renderer)) {
        error_set(out_error, "no more frames are wanted");
        return RENDER_FAILED;
    }
    renderer->lost = gpu_is_lost(renderer->gpu);
    if (renderer->lost) {
        error_set(out_error, "the driver has lost the GL context");
        return RENDER_FAILED;
    }
    double started_ms = gpu_clock_ms(renderer->gpu);
    if (!params_are_valid(params, out_error))
        return RENDER_FAILED;
    if (!renderer->gpu_scene) {
        error_set(out_error, "no scene is shown");
        return RENDER_FAILED;
    }
    if (view->ring_count == RENDERER_FRAMES_IN_RING)
        return RENDER_BUSY;
    struct gpu_scene *gpu_scene = renderer->gpu_scene;
    const struct scene_revisions revisions = renderer->scene->revisions;
    const struct frame_inputs inputs = {.params = params,
                                        .revisions = &revisions,
                                        .scene_number = renderer->gi.scene_number,
                                        .history = &view->history};
    bool same = frame_plan_changes(&inputs) == INVALIDATES_NOTHING;
    if (same && view->history.convergence >= 1.0f)
        return RENDER_UNCHANGED;

    struct frame frame = {
        .gpu = renderer->gpu,
        .gpu_scene = gpu_scene,
        .view = view,
        .params = params,
        .camera = params->camera,
        .inputs = inputs,
        .plan = &view->plan,
    };
    gpu_scene_from_world(gpu_scene, params->camera.eye, frame.camera.eye);
    gpu_scene_from_world(gpu_scene, params->camera.target, frame.camera.target);
    enum gi_readiness readiness = gi_prepare_frame(&renderer->gi, &frame, same);
    if (readiness != GI_READY)
        return readiness == GI_PENDING ? RENDER_PENDING : RENDER_UNCHANGED;
    if (!gpu_scene_update(gpu_scene, out_error))
        return RENDER_FAILED;
    if (!draw_frame(renderer, &frame, out_error)) {
        view->history.drawn = false;
        return RENDER_FAILED;
    }
    queue_readback(&frame, started_ms);
    view->history = (struct frame_history){
        .drawn = true,
        .surfaces_stale = frame.reference_picture != NULL,
        .params = *params,
        .revisions = revisions,
        .scene_number = renderer->gi.scene_number,
        .convergence = gi_convergence(&frame),
        .accumulation = view->plan.accumulation_after,
        .shown_light = view->plan.shown_light_after,
        .accumulate_only_count = view->plan.accumulate_only_count_after,
    };
    trim_memory(renderer);
    return RENDER_DRAWN;
}

void renderer_view_invalidate(struct view *view)
{
    view->history.drawn = false;
}

bool renderer_view_collect(struct renderer *renderer, struct view *view, bool wait,
                           struct frame_pixels *out_pixels)
{
    if (view->ring_count == 0)
        return false;
    assert(!view->collected);
    struct ring_frame *slot = &view->ring[view->ring_oldest];
    if (!gpu_fence_is_done(slot->fence, wait))
        return false;
    gpu_fence_destroy(&slot->fence);
    struct frame_params shape = {
        .width = slot->result.width, .height = slot->result.height, .output = slot->result.output};
    size_t offsets[3];
    size_t size_bytes = frame_plan_output_layout(&shape, offsets, slot->result.row_pitch_bytes);
    const uint8_t *bytes = gpu_buffer_mapping(slot->pixels);
    float found;
    memcpy(&found, bytes + size_bytes, sizeof(found));
    view->last_exposure =
        slot->fixed_exposure > 0.0f ? slot->fixed_exposure : found * slot->exposure_bias;
    gi_collect(&renderer->gi, view, slot, bytes + size_bytes + VIEW_EXPOSURE_BYTES);
    for (int i = 0; i < (shape.output == FRAME_OUTPUT_YCBCR ? 3 : 1); i++)
        slot->result.planes[i] = bytes + offsets[i];
    slot->result.frame_time_ms = gpu_clock_ms(renderer->gpu) - slot->started_ms;
    view->last_frame_ms = slot->result.frame_time_ms;
    view->collected = true;
    *out_pixels = slot->result;
    return true;
}

void renderer_view_release(struct renderer *renderer, struct view *view)
{
    (void)renderer;
    assert(view->collected);
    view->collected = false;
    view->ring_oldest = (view->ring_oldest + 1) % RENDERER_FRAMES_IN_RING;
    view->ring_count--;
}

_Static_assert((int)PASS_COUNT <= (int)RENDERER_MAX_PASSES, "statistics have room for so many");
_Static_assert((int)EFFECT_COUNT <= (int)RENDERER_MAX_EFFECTS, "statistics have room for so many");

static void list_memory(const struct gpu *gpu, struct frame_statistics *statistics)
{
    struct gpu_memory_group groups[FRAME_MAX_MEMORY_GROUPS];
    statistics->memory_count = gpu_memory_groups(gpu, groups, FRAME_MAX_MEMORY_GROUPS);
    for (uint32_t i = 0; i < statistics->memory_count; i++) {
        struct memory_statistics *memory = &statistics->memory[i];
        _Static_assert(sizeof(memory->name) == sizeof(groups[i].name), "they hold the same");
        memcpy(memory->name, groups[i].name, sizeof(memory->name));
        memory->bytes = groups[i].bytes;
    }
}

void renderer_view_get_statistics(const struct renderer *renderer, const struct view *view,
                                  struct frame_statistics *out_statistics)
{
    struct frame_statistics *statistics = out_statistics;
    *statistics = (struct frame_statistics){.pass_count = PASS_COUNT,
                                            .effect_count = EFFECT_COUNT,
                                            .frame_time_ms = view->last_frame_ms,
                                            .exposure = view->last_exposure,
                                            .render_width = view->width,
                                            .render_height = view->height};
    gpu_timer_poll(view->timer);
    for (uint32_t i = 0; i < PASS_COUNT; i++) {
        bool ran = view->history.drawn && frame_plan_runs(&view->plan, (enum pass_id)i);
        statistics->passes[i] = (struct pass_statistics){
            .name = pass_name((enum pass_id)i),
            .ran = ran,
            .time_ms = ran ? gpu_timer_get_ms(view->timer, i) : 0.0,
            .reason = view->plan.skip_reasons[i] ? view->plan.skip_reasons[i] : "",
            .view_bytes = ran ? pass_view_bytes(all_passes[i], view) : 0,
        };
    }
    for (uint32_t i = 0; i < EFFECT_COUNT; i++) {
        struct effect_statistics *effect = &statistics->effects[i];
        effect->name = effect_name((enum effect)i);
        effect->on = (view->plan.effects.bits & EFFECT_BIT(i)) != 0;
        memcpy(effect->reason, view->plan.effects.reasons[i], sizeof(effect->reason));
    }
    list_memory(renderer->gpu, statistics);
    struct gi_findings gi;
    gi_inspect(&renderer->gi, view, &gi);
    const struct scene_rejects none = {0};
    const struct scene_rejects *rejects = renderer->scene ? &renderer->scene->rejects : &none;
    const struct reject_statistics found[] = {
        {"triangles_left_out", rejects->triangles},
        {"vertices_mended", rejects->vertices},
        {"parameters_clamped", rejects->parameters},
        {"voxel_values_cut", gi.values_cut},
        {"lights_without_shadow", renderer->gpu_scene ? renderer->gpu_scene->counts.unshadowed : 0},
    };
    statistics->reject_count = sizeof(found) / sizeof(found[0]);
    memcpy(statistics->rejects, found, sizeof(found));
}

bool renderer_check_finite(struct renderer *renderer, const struct view *view,
                           struct finite_report *out_report, struct error *out_error)
{
    struct gi_findings gi;
    gi_inspect(&renderer->gi, view, &gi);
    const struct finite_check check = {
        .gpu = renderer->gpu, .gpu_scene = renderer->gpu_scene, .view = view, .gi = &gi};
    return finite_check_run(&check, out_report, out_error);
}

bool renderer_pick(struct renderer *renderer, const struct view_camera *camera, uint32_t width,
                   uint32_t height, float x, float y, struct ray_hit *out_hit)
{
    if (!renderer->scene || width == 0 || height == 0)
        return false;
    const struct scene_revisions *now = &renderer->scene->revisions;
    const struct scene_revisions *seen = &renderer->ray_revisions;
    if (renderer->ray_scene && now->geometry != seen->geometry)
        ray_scene_destroy(&renderer->ray_scene);
    if (!renderer->ray_scene)
        renderer->ray_scene = ray_scene_create(renderer->scene);
    else if (now->transforms != seen->transforms)
        ray_scene_update_transforms(renderer->ray_scene);
    if (renderer->ray_scene && now->materials != seen->materials)
        ray_scene_update_materials(renderer->ray_scene);
    renderer->ray_revisions = *now;
    if (!renderer->ray_scene)
        return false;
    struct camera_frame frame;
    camera_frame_init(&frame, camera);
    float direction[3];
    camera_ray(&frame, width, height, x + 0.5f, y + 0.5f, direction);
    glm_vec3_normalize(direction); // makes the hit's distance metres
    return ray_scene_intersect(renderer->ray_scene, camera->eye, direction, FLT_MAX, out_hit);
}

const char *renderer_get_shader_dir(const struct renderer *renderer)
{
    return gpu_get_shader_dir(renderer->gpu);
}

uint32_t renderer_poll_shaders(struct renderer *renderer, struct error *out_error)
{
    return gpu_programs_reload_changed(renderer->gpu, out_error);
}
