// Faults of the machine: memory ends, shaders do not compile, the GL context is lost. Counts how
// often a fault did not lead to a failure with a reason, or left the renderer unable to draw what
// it drew before.
#include <string.h>

#include "renderer/metrics/picture.h"
#include "server/tool/stability/stage.h"

// Enough consecutive faults for any scene.
#define MAX_FAULTS 600u
#define MAX_TRIES  64u

struct faults {
    struct stability_run *run;
    struct renderer *renderer;
    struct stage stage;
    struct frame_params params;
    struct picture expected;
    uint32_t broken;
};

static void note(struct faults *faults, bool good, const char *what, uint32_t number)
{
    faults->broken += !good;
    stability_measure(faults->run, faults->broken, "%s, fault %u", what, number);
}

// The room drawn without faults, and a renderer that has drawn nothing yet.
static bool faults_open(struct faults *faults, struct stability_run *run)
{
    *faults = (struct faults){.run = run, .params = stability_params(run)};
    struct stage drawn;
    if (!stage_create(run, &(struct stage_params){0}, &drawn))
        return false;
    faults->params.camera = drawn.camera;
    bool done = stability_draw(run, drawn.scene, &faults->params, &faults->expected);
    scene_destroy(&drawn.scene);
    if (!done)
        return false;
    stability_renew(run);
    faults->renderer = stability_renderer(run);
    return faults->renderer && stage_create(run, &(struct stage_params){0}, &faults->stage);
}

static void faults_close(struct faults *faults)
{
    picture_finish(&faults->expected);
    scene_destroy(&faults->stage.scene);
    stability_renew(faults->run);
}

// Draws a frame and discards it. False, with the reason, if that fails.
static bool draw_frame(struct faults *faults, struct view *view, struct error *out_error)
{
    struct frame_pixels pixels;
    enum render_result result =
        renderer_view_draw(faults->renderer, view, &faults->params, out_error);
    if (result == RENDER_UNCHANGED)
        return true;
    if (result != RENDER_DRAWN)
        return false;
    faults->run->frames++;
    bool collected = renderer_view_collect(faults->renderer, view, true, &pixels);
    if (collected)
        renderer_view_release(faults->renderer, view);
    else
        error_set(out_error, "the image could not be read back");
    return collected;
}

// The image is the same as before the faults.
static void check_reference(struct faults *faults, uint32_t number)
{
    struct picture picture;
    if (!stability_draw(faults->run, faults->stage.scene, &faults->params, &picture))
        return;
    note(faults, stability_count_changed(&picture, &faults->expected) == 0, "another image",
         number);
    picture_finish(&picture);
}

// Shows the scene in a new view and draws some frames, while one allocation fails. True if that
// allocation was reached.
static bool fail_allocation(struct faults *faults, uint32_t number)
{
    struct error error = {""};
    renderer_inject_fault(faults->renderer, RENDERER_FAULT_ALLOCATION, number);
    bool shown = renderer_set_scene(faults->renderer, faults->stage.scene, &error);
    struct view *view = shown ? renderer_view_create(faults->renderer) : NULL;
    bool drawn = view != NULL;
    for (int i = 0; i < 3 && drawn; i++)
        drawn = draw_frame(faults, view, &error);
    bool reached = renderer_fault_left(faults->renderer, RENDERER_FAULT_ALLOCATION) == 0;
    renderer_inject_fault(faults->renderer, RENDERER_FAULT_ALLOCATION, 0);
    note(faults, drawn || (shown && !view) || error.message[0], "no reason", number);
    note(faults, drawn || reached, "failed without a fault", number);
    // With memory again, the same view goes on.
    if (!shown)
        shown = renderer_set_scene(faults->renderer, faults->stage.scene, &error);
    if (shown && !view)
        view = renderer_view_create(faults->renderer);
    note(faults, view && draw_frame(faults, view, &error), "does not go on", number);
    if (view)
        renderer_view_destroy(faults->renderer, &view);
    renderer_set_scene(faults->renderer, NULL, &error);
    return reached;
}

static void run_memory(struct stability_run *run)
{
    struct faults faults;
    uint32_t number = 1;
    if (faults_open(&faults, run)) {
        while (number < MAX_FAULTS && fail_allocation(&faults, number))
            number++;
        note(&faults, number > 10 && number < MAX_FAULTS, "how many allocations there are", number);
        note(&faults, renderer_gl_error_count(faults.renderer) == 0, "GL errors", number);
        check_reference(&faults, number);
    }
    faults_close(&faults);
}

// One program is compiled and the next one fails, until all are there.
static void run_programs(struct stability_run *run)
{
    struct faults faults;
    struct error error = {""};
    uint32_t failures = 0;
    if (faults_open(&faults, run) &&
        renderer_set_scene(faults.renderer, faults.stage.scene, &error)) {
        struct view *view = renderer_view_create(faults.renderer);
        bool drawn = false;
        for (; view && !drawn && failures < MAX_TRIES; failures += !drawn) {
            error = (struct error){""};
            renderer_inject_fault(faults.renderer, RENDERER_FAULT_PROGRAM, failures ? 2 : 1);
            drawn = draw_frame(&faults, view, &error);
            note(&faults, drawn || strstr(error.message, "does not compile"), "no reason",
                 failures);
        }
        renderer_inject_fault(faults.renderer, RENDERER_FAULT_PROGRAM, 0);
        note(&faults, drawn && failures >= 3, "shaders", failures);
        renderer_view_destroy(faults.renderer, &view);
        renderer_set_scene(faults.renderer, NULL, &error);
        check_reference(&faults, failures);
    }
    faults_close(&faults);
}

static void run_context(struct stability_run *run)
{
    struct faults faults;
    struct error error = {""};
    if (faults_open(&faults, run) &&
        renderer_set_scene(faults.renderer, faults.stage.scene, &error)) {
        struct view *view = renderer_view_create(faults.renderer);
        renderer_inject_fault(faults.renderer, RENDERER_FAULT_CONTEXT, 2);
        note(&faults, draw_frame(&faults, view, &error), "the frame before", 0);
        for (uint32_t i = 0; i < 3; i++) {
            error = (struct error){""};
            note(&faults,
                 !draw_frame(&faults, view, &error) && strstr(error.message, "lost") != NULL,
                 "no reason", i);
            note(&faults, renderer_is_lost(faults.renderer), "not known", i);
        }
        renderer_view_destroy(faults.renderer, &view);
        renderer_set_scene(faults.renderer, NULL, &error);
        stability_renew(run);
        faults.renderer = stability_renderer(run);
        check_reference(&faults, 0);
    }
    faults_close(&faults);
}

static const struct stability_case cases[] = {
    {.name = "memory-ends",
     .invariant = "whichever allocation of the GPU fails while a scene is shown and drawn, there "
                  "is a reason, and with memory again the same view goes on to the same image",
     .methods = STABILITY_DRAWN,
     .unit = "broken",
     .run = run_memory},
    {.name = "shaders-fail",
     .invariant = "whichever shader does not compile, there is a reason, and once it does the "
                  "same view goes on to the same image",
     .methods = STABILITY_DRAWN,
     .unit = "broken",
     .run = run_programs},
    {.name = "context-lost",
     .invariant = "when the context is lost every frame fails with a reason, and another renderer "
                  "draws the same image",
     .methods = STABILITY_DRAWN,
     .unit = "broken",
     .run = run_context},
};

const struct stability_table stability_faults = {
    .name = "faults",
    .title = "Faults of the machine",
    .cases = cases,
    .count = sizeof(cases) / sizeof(cases[0]),
};
