// What the files of the render thread share. Everything here runs on the render thread.
#ifndef VOXCAST_SERVER_RENDER_RENDER_INTERNAL_H
#define VOXCAST_SERVER_RENDER_RENDER_INTERNAL_H

#include <pthread.h>
#include <stdatomic.h>

#include <cjson/cJSON.h>

#include "server/document/document.h"
#include "server/document/edit.h"
#include "server/document/edit_log.h"
#include "server/render/environment_loader.h"
#include "server/render/file_watch.h"
#include "server/render/quality_controller.h"
#include "server/render/render_thread.h"
#include "server/render/scene_loader.h"

// What a configuration puts in place of the shared settings, while view_options.rung names it.
struct configuration_override {
    enum quality quality;
    double scale; // of the image's size
    struct render_settings settings;
};

// One client that has said hello; its place in the array is its slot of the frame stream.
struct render_client {
    uint32_t client_id; // 0: none
    char name[PROTOCOL_MAX_NAME_BYTES + 1];
    struct view *view;
    struct view_options options;
    struct configuration_override configuration; // if options.rung is not ""
    uint64_t camera_revision;
    uint64_t edit_id;
    uint64_t frame_count;
    bool dirty;                // something may have changed since the newest drawn frame
    uint64_t dirty_since_us;   // 0 when not dirty
    uint64_t pending_until_us; // a reference has nothing new to show before
    struct quality_controller quality;
    enum quality drawn_row;     // of the newest frame
    enum quality drawn_wanted;  // that was wanted when it was drawn
    bool drawn_moving;          // whether things moved then
    bool drawn_to_refine;       // not to show a change
    float convergence;          // of the newest collected frame, as its header tells
    bool drawing;               // drawn, not collected
    struct frame_header header; // of the frame being drawn
    uint64_t drawn_at_us;
    double frames_per_second;
    uint64_t collected_at_us;
    bool statistics_due;
    uint64_t statistics_at_us;
    struct edit_history history;
};

struct render_thread {
    struct render_thread_params params;
    pthread_t thread;
    atomic_bool stop;
    pthread_mutex_t status_mutex;
    struct render_status status;

    struct renderer *renderer;
    struct scene *scene;   // NULL until the first is ready
    char scene_label[256]; // its source as clients know it
    struct render_settings settings;
    struct animation_state *animations;
    uint64_t animated_at_us;
    uint64_t epoch, revision;
    struct edit_log log;

    struct scene_loader *loader;
    struct file_watch *watch;        // of the scene's files
    struct file_watch *shader_watch; // wakes the thread, so that an idle daemon reloads too
    char *load_source;               // of the load under way
    char load_label[256];
    struct rpc_id load_id;   // who asked; "" for nobody
    uint32_t load_client_id; // 0: start or hot reload
    bool reload_wanted;
    bool client_chose_scene; // then the environment of the start counts no more

    struct environment_loader *environment_loader;
    struct command *environment_command; // whose load is under way; NULL for a hot reload; owned
    uint64_t environment_epoch;          // of the document that it is for
    struct file_watch *environment_watch;
    uint64_t environment_watched; // serial of the image whose file is watched, or 0
    bool environment_reload_wanted;

    uint32_t next_client;
    uint64_t refined_at_us; // newest frame that only made an image better
    uint64_t refine_us;     // how long one took
    struct render_client clients[FRAME_STREAM_MAX_CLIENTS];
};

struct document render_document(struct render_thread *thread, struct render_client *client);

// Replies and notifications.
void render_reply(struct render_thread *thread, const struct command *command, cJSON *result);
void render_reply_error(struct render_thread *thread, const struct command *command,
                        const struct rpc_error *error);
void render_notice(struct render_thread *thread, uint32_t client_id, const char *level,
                   const char *message);
cJSON *render_author(const struct render_client *client); // null without a client

// render_commands.c
void render_run_command(struct render_thread *thread, struct command *command);

// Counts an edit that was applied, tells it to all clients and has images drawn. Takes over
// `edit`. `client` is NULL for what nobody did.
void render_publish_edit(struct render_thread *thread, struct render_client *client,
                         const struct command *command, cJSON *edit);

// render_environment.c
void render_run_environment_load(struct render_thread *thread, const struct command *command);
void render_poll_environment(struct render_thread *thread);

// render_scenes.c
void render_start_load(struct render_thread *thread, const char *source, const char *label,
                       const struct command *command);
void render_poll_scenes(struct render_thread *thread);
void render_run_scene_list(struct render_thread *thread, const struct command *command);
void render_run_scene_load(struct render_thread *thread, const struct command *command);

// Sets a client's camera to the scene's first, or to see all of it.
void render_reset_camera(const struct scene *scene, struct view_camera *camera);

// render_views.c
struct render_client *render_find_client(struct render_thread *thread, uint32_t client_id);
struct render_client *render_add_client(struct render_thread *thread, uint32_t client_id);
void render_remove_gone_clients(struct render_thread *thread, bool all);
// What clients have of a renderer that ends, and of the next one. False when memory ends.
void render_drop_views(struct render_thread *thread);
bool render_renew_views(struct render_thread *thread);

// Something may look different to one client, or to all with NULL: frames are drawn until the
// renderer says that nothing has changed. Moving does the same and lowers the quality for a while.
void render_mark_dirty(struct render_thread *thread, struct render_client *client);
void render_mark_moving(struct render_thread *thread, struct render_client *client);

// Draws for the client whose turn it is, if any wants a frame. Images that only get better wait
// for those that have changed.
bool render_draw_next(struct render_thread *thread);

// When render_draw_next() may have something to draw that it has not now, though nothing came in.
uint64_t render_next_draw_us(struct render_thread *thread);

// Hands finished frames to the JPEG workers. With `wait`, waits for one if any is under way. True
// if there was one.
bool render_collect(struct render_thread *thread, bool wait);

// The shared settings as views are drawn with them: what "auto" voxels are must not change with the
// quality, or they would be made anew whenever the camera starts and stops.
struct render_settings render_resolve_settings(const struct render_thread *thread);

// From when on no client will wait for a frame, or soon do so because things move, if nothing comes
// in: now or earlier, later, or QUALITY_NEVER while one waits.
uint64_t render_idle_from_us(struct render_thread *thread);

// render_accuracy.c
void render_run_accuracy_start(struct render_thread *thread, struct render_client *client,
                               const struct command *command);
void render_run_accuracy_cancel(struct render_thread *thread, const struct command *command);

// Gets what the configuration that a view.configure names puts in place, if it names one. False
// with an error that lists the configurations there are.
bool render_find_configuration(struct render_thread *thread, const struct command *command,
                               struct configuration_override *out_configuration,
                               struct rpc_error *out_error);

// Back to the shared settings.
void render_clear_configuration(struct render_thread *thread, struct render_client *client);

// render_statistics.c
void render_send_statistics(struct render_thread *thread, uint32_t slot);

#endif
