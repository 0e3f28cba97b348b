// Headless GL renderer: draws views of one scene at a time.
//
// STEP BY STEP
//
//     struct error error;
//     struct renderer *renderer = renderer_create(&(struct renderer_params){0}, &error);
//     struct scene *scene = scene_load("builtin:cornell", &error); // or a .gltf, .glb, .obj file
//     renderer_set_scene(renderer, scene, &error); // uploads it
//     struct view *view = renderer_view_create(renderer);
//
//     struct frame_params params = {.width = 1280, .height = 720, .quality = QUALITY_FINAL};
//     render_settings_init(&params.settings);
//     params.camera.fov_y_rad = scene->cameras[0].fov_y_rad;
//     scene_get_camera_placement(scene, 0, params.camera.eye, params.camera.target,
//                                params.camera.up);
//     struct frame_pixels pixels;
//     while (renderer_view_draw(renderer, view, &params, &error) == RENDER_DRAWN && // converges
//            renderer_view_collect(renderer, view, true, &pixels)) { // waits
//         use(pixels.planes[0], pixels.row_pitch_bytes[0]); // valid until the release
//         renderer_view_release(renderer, view);
//     } // ends with RENDER_UNCHANGED; edit the scene or params and draw again
//
//     renderer_view_destroy(renderer, &view);
//     renderer_set_scene(renderer, NULL, NULL);
//     scene_destroy(&scene);
//     renderer_destroy(&renderer);
//
// Threads: unless it says otherwise, call every function here on the render thread, the one that
// called renderer_create(). Higher layers include this header and the plain-data headers that it
// includes, nothing else of the renderer.
#ifndef VOXCAST_RENDERER_RENDERER_H
#define VOXCAST_RENDERER_RENDERER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "renderer/cache/scene_cache.h"
#include "renderer/error.h"
#include "renderer/finite_report.h"
#include "renderer/frame/frame_params.h"
#include "renderer/frame/frame_pixels.h"
#include "renderer/frame/frame_statistics.h"
#include "renderer/gpu/gpu_info.h"
#include "renderer/import/scene_load.h"
#include "renderer/log.h"
#include "renderer/path_tracer/reference.h"
#include "renderer/process_memory.h"
#include "renderer/scene/ray_scene.h"
#include "renderer/scene/scene.h"
#include "renderer/settings.h"

struct renderer;
struct view;

struct renderer_params {
    const char *gpu;        // "auto" (or NULL), "software", or a device index such as "0"
    const char *shader_dir; // NULL: VOXCAST_SHADER_DIR, the installed folder, or the source tree
    bool watch_shaders;     // reload shaders when their files change
    // Cache entries that a frame traces. 0: as many as the measured times allow, which makes
    // unconverged images depend on the machine.
    uint32_t trace_budget;
    // Both may block to let other work go first; measured times exclude that. NULL: never called.
    bool (*admit_frame)(void *user); // before each frame; false refuses it
    void (*yield)(void *user);       // within frames, before each piece of work on a CPU driver
    void *user;
};

// For programs: call first in main(), with its arguments: the program may start once more. A
// renderer on a CPU then uses its processors and memory better; without it everything works, too.
void renderer_prepare_process(char *const arguments[]);

// On failure returns NULL; the message names what is missing and what to install.
struct renderer *renderer_create(const struct renderer_params *params, struct error *out_error);
void renderer_destroy(struct renderer **renderer);
const struct renderer_info *renderer_get_info(const struct renderer *renderer);

// Makes the `number`th event of this kind from now on fail, once; 0: none.
void renderer_inject_fault(struct renderer *renderer, enum renderer_fault fault, uint64_t number);

// Events left until the injected fault; 0 if it has happened or none is set.
uint64_t renderer_fault_left(const struct renderer *renderer, enum renderer_fault fault);

// Whether the driver has lost the GL context, for example after a GPU reset. Then every frame fails
// and only a new renderer can draw. Known once a frame has failed.
bool renderer_is_lost(const struct renderer *renderer);

// Errors that GL has reported through its debug callback since creation; tests expect 0.
uint64_t renderer_gl_error_count(const struct renderer *renderer);

// Uploads `scene` and shows it from now on; NULL shows nothing. The caller keeps ownership, keeps
// it alive while it is shown, and may edit it between calls: its revisions tell what to upload
// again. On failure the former scene stays.
bool renderer_set_scene(struct renderer *renderer, struct scene *scene, struct error *out_error);

// One camera's images and history. At most RENDERER_MAX_VIEWS; NULL beyond that or out of memory.
struct view *renderer_view_create(struct renderer *renderer);
void renderer_view_destroy(struct renderer *renderer, struct view **view);

enum render_result {
    RENDER_DRAWN,     // collect the pixels with renderer_view_collect()
    RENDER_UNCHANGED, // nothing ran: nothing has changed and the image has converged
    RENDER_PENDING,   // nothing ran: the reference is being traced; ask again later
    RENDER_BUSY,      // nothing ran: all RENDERER_FRAMES_IN_RING frames wait to be collected
    RENDER_FAILED,
};

// Draws one frame and starts its readback; does not wait for the GPU. Indirect light and
// accumulation converge over several frames: repeat with the same parameters until
// RENDER_UNCHANGED.
enum render_result renderer_view_draw(struct renderer *renderer, struct view *view,
                                      const struct frame_params *params, struct error *out_error);

// Calls renderer_params.admit_frame; true without it.
bool renderer_admit_frame(const struct renderer *renderer);

// Makes the next renderer_view_draw() redraw everything even if nothing has changed.
void renderer_view_invalidate(struct view *view);

// Takes the oldest finished frame. False if none is ready; with `wait`, if none is in flight. The
// pixels stay valid until renderer_view_release() of the same view; collect one frame at a time.
bool renderer_view_collect(struct renderer *renderer, struct view *view, bool wait,
                           struct frame_pixels *out_pixels);
void renderer_view_release(struct renderer *renderer, struct view *view);

void renderer_view_get_statistics(const struct renderer *renderer, const struct view *view,
                                  struct frame_statistics *out_statistics);

// Looks for NaN and infinity in every floating-point resource that the view's newest frame wrote
// and in the scene data that it read. For tests: waits for the GPU; costs nothing unless called.
// False with a message when a shader fails or memory runs out.
bool renderer_check_finite(struct renderer *renderer, const struct view *view,
                           struct finite_report *out_report, struct error *out_error);

// Casts a ray through (x, y), in pixels, of a view with this camera and size. False on a miss. The
// first call after a geometry change builds the BVH.
bool renderer_pick(struct renderer *renderer, const struct view_camera *camera, uint32_t width,
                   uint32_t height, float x, float y, struct ray_hit *out_hit);

// Shader folder: watch its files to know when to poll.
const char *renderer_get_shader_dir(const struct renderer *renderer);

// Reloads changed shaders if watching; cheap. Returns how many programs were rebuilt. If one fails,
// the last good one stays and the message is logged and put into `out_error`.
uint32_t renderer_poll_shaders(struct renderer *renderer, struct error *out_error);

#endif
