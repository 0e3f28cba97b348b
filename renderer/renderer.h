// The renderer: a headless GL context that draws views of one scene at a time.
//
// Runs on the render thread: every function here, unless it says otherwise, is called from the
// thread that called renderer_create(). Higher layers include this header and the plain-data
// headers it includes, nothing else of the renderer.
#ifndef VOXCAST_RENDERER_RENDERER_H
#define VOXCAST_RENDERER_RENDERER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "renderer/error.h"
#include "renderer/finite_report.h"
#include "renderer/frame/frame_params.h"
#include "renderer/frame/frame_pixels.h"
#include "renderer/frame/frame_statistics.h"
#include "renderer/gpu/gpu_info.h"
#include "renderer/import/scene_load.h"
#include "renderer/log.h"
#include "renderer/path_tracer/reference.h"
#include "renderer/scene/ray_scene.h"
#include "renderer/scene/scene.h"
#include "renderer/settings.h"

struct renderer;
struct view;

struct renderer_params {
    const char *gpu;        // "auto" (or NULL), "software", or a device index such as "0"
    const char *shader_dir; // NULL: VOXCAST_SHADER_DIR, the installed folder, or the source tree
    bool watch_shaders;     // reload shaders when their files change
    // Entries of the irradiance cache that a frame traces; 0: as many as measured times allow, so
    // that pictures that have not converged depend on the machine.
    uint32_t trace_budget;
    // Both may wait until others have drawn, and that time is no part of any that is measured;
    // NULL: nobody is asked.
    bool (*admit_frame)(void *user); // before each frame; false refuses it
    void (*yield)(void *user);       // before each piece of work of a CPU driver, within frames
    void *user;
};

// NULL with a message that names what is missing and what to install.
struct renderer *renderer_create(const struct renderer_params *params, struct error *out_error);
void renderer_destroy(struct renderer **renderer);
const struct renderer_info *renderer_get_info(const struct renderer *renderer);

// Makes the `number`th such event from now on fail, once; 0: none.
void renderer_inject_fault(struct renderer *renderer, enum renderer_fault fault, uint64_t number);

// Events until then; 0 if it has happened or none is to.
uint64_t renderer_fault_left(const struct renderer *renderer, enum renderer_fault fault);

// Whether the driver has lost the GL context, as when a GPU has been reset: every frame fails, and
// only another renderer can draw. Known once a frame has failed.
bool renderer_is_lost(const struct renderer *renderer);

// Errors that GL reported through its debug callback since creation; tests want 0.
uint64_t renderer_gl_error_count(const struct renderer *renderer);

// Shows `scene` from now on; uploads it. The scene stays the caller's, must outlive its use here,
// and is edited by the caller between calls: its revisions tell what to upload again. On failure
// the former scene stays. NULL shows nothing.
bool renderer_set_scene(struct renderer *renderer, struct scene *scene, struct error *out_error);

// One camera's pictures and history. At most RENDERER_MAX_VIEWS; NULL beyond or out of memory.
struct view *renderer_view_create(struct renderer *renderer);
void renderer_view_destroy(struct renderer *renderer, struct view **view);

enum render_result {
    RENDER_DRAWN,     // pixels will come by renderer_view_collect()
    RENDER_UNCHANGED, // nothing has changed and the picture has converged: nothing ran
    RENDER_PENDING,   // nothing ran, since a reference is being traced: ask again in a while
    RENDER_BUSY,      // all RENDERER_FRAMES_IN_RING frames wait to be collected
    RENDER_FAILED,
};

// Draws one frame and starts its readback; does not wait for the GPU. Indirect light converges over
// several frames: draw again with the same parameters until RENDER_UNCHANGED is returned.
enum render_result renderer_view_draw(struct renderer *renderer, struct view *view,
                                      const struct frame_params *params, struct error *out_error);

// What renderer_params.admit_frame says now; true without it.
bool renderer_admit_frame(const struct renderer *renderer);

// Makes the next renderer_view_draw() draw everything anew even if nothing has changed.
void renderer_view_invalidate(struct view *view);

// The oldest finished frame, or false if none is ready (with `wait`: if none is under way). The
// pixels stay valid until renderer_view_release() with the same view; collect one at a time.
bool renderer_view_collect(struct renderer *renderer, struct view *view, bool wait,
                           struct frame_pixels *out_pixels);
void renderer_view_release(struct renderer *renderer, struct view *view);

void renderer_view_get_statistics(const struct renderer *renderer, const struct view *view,
                                  struct frame_statistics *out_statistics);

// Looks for values that are not finite in every floating-point resource that the view's newest
// frame wrote, and in what it read of the scene. For tests: waits for the GPU; frames that nobody
// asks about pay nothing. False with a message when a shader fails or memory ends.
bool renderer_check_finite(struct renderer *renderer, const struct view *view,
                           struct finite_report *out_report, struct error *out_error);

// Casts a ray through the centre of pixel (x, y) of a view of the given camera and size. False if
// it hits nothing. The first call after a geometry change builds the BVH.
bool renderer_pick(struct renderer *renderer, const struct view_camera *camera, uint32_t width,
                   uint32_t height, float x, float y, struct ray_hit *out_hit);

// Folder that the shaders are read from: watch its files to know when to poll.
const char *renderer_get_shader_dir(const struct renderer *renderer);

// Reloads changed shaders if watching; cheap. Returns how many programs were rebuilt; when one
// fails, the last good one stays, the message is logged and put into `out_error`.
uint32_t renderer_poll_shaders(struct renderer *renderer, struct error *out_error);

#endif
