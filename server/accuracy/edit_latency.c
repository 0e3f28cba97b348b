#include "server/accuracy/edit_latency.h"

#include <math.h>
#include <stdlib.h>

#include "server/accuracy/converged_frames.h"

#define FIRST_FRACTION   0.01
#define ARRIVED_FRACTION 0.95
#define MIN_CHANGE       1e-3 // of white; a smaller change would measure rounding

const char *const edit_kind_names[EDIT_KIND_COUNT] = {"color", "intensity"};

const char *const edit_stage_names[EDIT_STAGE_COUNT] = {"first", "arrived", "indirect", "settled"};

// Time and frames since an edit.
struct edit_moment {
    double ms;
    uint32_t frames;
};

struct edit_run {
    struct edit_moment stages[EDIT_STAGE_COUNT];
};

// One of the two states that edits switch between.
struct edit_state {
    struct scene_light light;
    struct scene_material material;
    float *settled; // linear RGB times exposure, not clipped
    float *direct;  // direct light alone of the same image
};

struct edit_bench {
    const struct edit_params *params;
    struct frame_params frame_params; // linear
    struct view *view;
    uint32_t light, material; // one of the two is SCENE_NONE
    float exposure;
    double change, indirect_change; // between the converged images
    struct edit_state states[2];
    float *frame;
};

static void take_pixels(const struct edit_bench *bench, const struct frame_pixels *pixels,
                        float *out_rgb)
{
    for (uint32_t y = 0; y < pixels->height; y++) {
        const float *row =
            (const float *)(pixels->planes[0] + (size_t)y * pixels->row_pitch_bytes[0]);
        for (uint32_t x = 0; x < pixels->width; x++, out_rgb += 3)
            for (uint32_t c = 0; c < 3; c++)
                out_rgb[c] = row[4 * x + c] * bench->exposure;
    }
}

static size_t float_count(const struct edit_bench *bench)
{
    return (size_t)bench->frame_params.width * bench->frame_params.height * 3;
}

// Mean absolute difference, clipped at what a display can show.
static double clipped_difference(const struct edit_bench *bench, const float *a, const float *b)
{
    double sum = 0.0;
    size_t count = float_count(bench);
    for (size_t i = 0; i < count; i++)
        sum += fabs((double)fminf(a[i], 1.0f) - (double)fminf(b[i], 1.0f));
    return sum / (double)count;
}

// Mean absolute difference of indirect light, without clipping.
static double indirect_difference(const struct edit_bench *bench, const float *a,
                                  const float *direct_a, const float *b, const float *direct_b)
{
    double sum = 0.0;
    size_t count = float_count(bench);
    for (size_t i = 0; i < count; i++)
        sum += fabs(((double)a[i] - direct_a[i]) - ((double)b[i] - direct_b[i]));
    return sum / (double)count;
}

static void apply_state(const struct edit_bench *bench, const struct edit_state *state)
{
    if (bench->light != SCENE_NONE)
        scene_set_light(bench->params->scene, bench->light, &state->light);
    else
        scene_set_material(bench->params->scene, bench->material, &state->material);
}

// On success the caller must release the pixels.
static bool draw_settled(struct edit_bench *bench, const struct frame_params *params,
                         struct frame_pixels *out_pixels, struct error *out_error)
{
    struct converged_frames render = {.renderer = bench->params->renderer,
                                      .view = bench->view,
                                      .params = params,
                                      .max_frames = MAX_CONVERGING_FRAMES};
    if (!frames_render_converged(&render, out_error))
        return false;
    *out_pixels = render.pixels;
    if (render.converged)
        return true;
    renderer_view_release(bench->params->renderer, bench->view);
    return error_set(out_error, "the image has not converged after %u frames", render.frame_count);
}

static bool draw_linear(struct edit_bench *bench, enum debug_view debug_view, float *out_rgb,
                        struct error *out_error)
{
    struct frame_params params = bench->frame_params;
    struct frame_pixels pixels;
    params.debug_view = debug_view;
    if (!draw_settled(bench, &params, &pixels, out_error))
        return false;
    take_pixels(bench, &pixels, out_rgb);
    renderer_view_release(bench->params->renderer, bench->view);
    return true;
}

// Linear images are not exposed, so a displayed one supplies the exposure.
static bool find_exposure(struct edit_bench *bench, struct error *out_error)
{
    struct frame_params params = bench->frame_params;
    struct frame_pixels pixels;
    struct frame_statistics statistics;
    params.output = FRAME_OUTPUT_RGBA8;
    if (!draw_settled(bench, &params, &pixels, out_error))
        return false;
    renderer_view_get_statistics(bench->params->renderer, bench->view, &statistics);
    renderer_view_release(bench->params->renderer, bench->view);
    bench->exposure = statistics.exposure;
    return true;
}

// Converged images of both states; the second state stays applied.
static bool draw_states(struct edit_bench *bench, struct error *out_error)
{
    if (!find_exposure(bench, out_error))
        return false;
    for (int i = 0; i < 2; i++) {
        struct edit_state *state = &bench->states[i];
        apply_state(bench, state);
        if (!draw_linear(bench, DEBUG_VIEW_FINAL, state->settled, out_error) ||
            !draw_linear(bench, DEBUG_VIEW_DIRECT, state->direct, out_error))
            return false;
    }
    const struct edit_state *a = &bench->states[0], *b = &bench->states[1];
    bench->change = clipped_difference(bench, a->settled, b->settled);
    bench->indirect_change =
        indirect_difference(bench, a->settled, a->direct, b->settled, b->direct);
    if (bench->change < MIN_CHANGE)
        return error_set(out_error,
                         "the edit changes the image by %.2g of white: too little to "
                         "measure; choose another light or view",
                         bench->change);
    return draw_linear(bench, DEBUG_VIEW_FINAL, bench->frame, out_error);
}

// Evaluates one frame: a stage's time is set when its fraction of the change is first reached, and
// reset when it is lost again.
static void judge_frame(const struct edit_bench *bench, const struct edit_state *to,
                        const struct edit_moment *now, struct edit_run *run)
{
    double left = clipped_difference(bench, bench->frame, to->settled) / bench->change;
    if (1.0 - left >= FIRST_FRACTION && run->stages[EDIT_FIRST].frames == 0)
        run->stages[EDIT_FIRST] = *now;
    if (1.0 - left < ARRIVED_FRACTION)
        run->stages[EDIT_ARRIVED] = (struct edit_moment){0};
    else if (run->stages[EDIT_ARRIVED].frames == 0)
        run->stages[EDIT_ARRIVED] = *now;
    double indirect_left =
        indirect_difference(bench, bench->frame, to->direct, to->settled, to->direct);
    if (indirect_left > (1.0 - ARRIVED_FRACTION) * bench->indirect_change)
        run->stages[EDIT_INDIRECT] = (struct edit_moment){0};
    else if (run->stages[EDIT_INDIRECT].frames == 0)
        run->stages[EDIT_INDIRECT] = *now;
}

// Makes one edit and draws until nothing changes. The time for comparing is left out.
static bool measure_edit(struct edit_bench *bench, const struct edit_state *to,
                         struct edit_run *out_run, struct error *out_error)
{
    struct edit_moment now = {0};
    struct renderer *renderer = bench->params->renderer;
    *out_run = (struct edit_run){0};
    apply_state(bench, to);
    while (now.frames < MAX_CONVERGING_FRAMES) {
        struct frame_pixels pixels;
        enum render_result result =
            renderer_view_draw(renderer, bench->view, &bench->frame_params, out_error);
        if (result == RENDER_UNCHANGED)
            break;
        if (result != RENDER_DRAWN)
            return false;
        if (!renderer_view_collect(renderer, bench->view, true, &pixels))
            return error_set(out_error, "the GPU did not finish the frame");
        now.ms += pixels.frame_time_ms;
        now.frames++;
        take_pixels(bench, &pixels, bench->frame);
        renderer_view_release(renderer, bench->view);
        judge_frame(bench, to, &now, out_run);
    }
    out_run->stages[EDIT_SETTLED] = now;
    if (out_run->stages[EDIT_ARRIVED].frames == 0 || out_run->stages[EDIT_INDIRECT].frames == 0)
        return error_set(out_error, "the image converged short of what it was when it was drawn "
                                    "with this light before");
    return true;
}

static bool light_shines(const struct scene_light *light)
{
    return light->enabled && !light->removed && light->intensity > 0.0f &&
           light->color[0] + light->color[1] + light->color[2] > 0.0f;
}

static bool material_shines(const struct scene_material *material)
{
    return material->emissive_strength > 0.0f &&
           material->emissive[0] + material->emissive[1] + material->emissive[2] > 0.0f;
}

// Chooses what to edit.
static bool choose_target(struct edit_bench *bench, struct error *out_error)
{
    const struct scene *scene = bench->params->scene;
    const struct edit_params *params = bench->params;
    bench->light = params->light;
    bench->material = params->material;
    if (bench->light != SCENE_NONE && bench->material != SCENE_NONE)
        return error_set(out_error, "--light and --material exclude each other");
    for (uint32_t i = 0; i < scene->light_count; i++)
        if (bench->light == SCENE_NONE && params->material == SCENE_NONE &&
            light_shines(&scene->lights[i]))
            bench->light = i;
    for (uint32_t i = 0; i < scene->material_count; i++)
        if (bench->light == SCENE_NONE && bench->material == SCENE_NONE &&
            material_shines(&scene->materials[i]))
            bench->material = i;
    if (bench->light == SCENE_NONE && bench->material == SCENE_NONE)
        return error_set(out_error, "nothing in the scene shines: neither light nor material");
    if (bench->light != SCENE_NONE &&
        (bench->light >= scene->light_count || !light_shines(&scene->lights[bench->light])))
        return error_set(out_error, "light %u is not there or does not shine; the scene has %u",
                         bench->light, scene->light_count);
    if (bench->material != SCENE_NONE && (bench->material >= scene->material_count ||
                                          !material_shines(&scene->materials[bench->material])))
        return error_set(out_error, "material %u is not there or emits nothing; the scene has %u",
                         bench->material, scene->material_count);
    return true;
}

// The document as it is, and edited.
static void make_states(struct edit_bench *bench)
{
    static const float color_factors[3] = {0.2f, 0.6f, 1.0f};
    const struct scene *scene = bench->params->scene;
    for (int i = 0; i < 2; i++) {
        struct edit_state *state = &bench->states[i];
        float *color, *intensity;
        if (bench->light != SCENE_NONE) {
            state->light = scene->lights[bench->light];
            color = state->light.color;
            intensity = &state->light.intensity;
        } else {
            state->material = scene->materials[bench->material];
            color = state->material.emissive;
            intensity = &state->material.emissive_strength;
        }
        if (i == 1 && bench->params->kind == EDIT_INTENSITY)
            *intensity *= 0.25f;
        for (int c = 0; c < 3 && i == 1 && bench->params->kind == EDIT_COLOR; c++)
            color[c] *= color_factors[c];
    }
}

static bool allocate(struct edit_bench *bench)
{
    size_t bytes = float_count(bench) * sizeof(float);
    bool done = true;
    for (int i = 0; i < 2; i++) {
        bench->states[i].settled = malloc(bytes);
        bench->states[i].direct = malloc(bytes);
        done = done && bench->states[i].settled && bench->states[i].direct;
    }
    bench->frame = malloc(bytes);
    bench->view =
        bench->params->view ? bench->params->view : renderer_view_create(bench->params->renderer);
    return done && bench->frame && bench->view;
}

static void release(struct edit_bench *bench)
{
    apply_state(bench, &bench->states[0]);
    if (bench->view && !bench->params->view)
        renderer_view_destroy(bench->params->renderer, &bench->view);
    for (int i = 0; i < 2; i++) {
        free(bench->states[i].settled);
        free(bench->states[i].direct);
    }
    free(bench->frame);
}

static bool take_run(struct edit_result *result, const struct edit_run *run)
{
    bool done = true;
    for (int i = 0; i < EDIT_STAGE_COUNT; i++)
        done = done && samples_add(&result->ms[i], run->stages[i].ms) &&
               samples_add(&result->frames[i], run->stages[i].frames);
    return done;
}

bool edit_measure(const struct edit_params *params, struct edit_result *out_result,
                  struct error *out_error)
{
    struct edit_bench bench = {.params = params, .frame_params = *params->frame};
    struct edit_run run;
    *out_result = (struct edit_result){0};
    bench.frame_params.output = FRAME_OUTPUT_LINEAR;
    if (!choose_target(&bench, out_error))
        return false;
    make_states(&bench);
    bool done = allocate(&bench) || error_set(out_error, "out of memory");
    done = done && draw_states(&bench, out_error);
    // The second state is applied, so the first edit leads back.
    for (uint32_t i = 0; i < params->repetitions && done; i++)
        done = measure_edit(&bench, &bench.states[i % 2], &run, out_error) &&
               (take_run(out_result, &run) || error_set(out_error, "out of memory"));
    out_result->light = bench.light;
    out_result->material = bench.material;
    out_result->change = bench.change;
    release(&bench);
    return done;
}

void edit_result_finish(struct edit_result *result)
{
    for (int i = 0; i < EDIT_STAGE_COUNT; i++) {
        samples_finish(&result->ms[i]);
        samples_finish(&result->frames[i]);
    }
}
