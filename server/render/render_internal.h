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

// What a measured configuration replaces in the shared settings, while view_options.rung names it.
struct configuration_override {
    enum quality quality;
    double scale; // of the image's size
    struct render_settings settings;
};

// One client that has said hello; its index in the array is its slot of the frame stream.
struct render_client {
    uint32_t client_id; // 0: none
    char name[PROTOCOL_MAX_NAME_BYTES + 1];
    struct view *view;
    struct view_options options;
    struct configuration_override configuration; // if options.rung is not ""
    uint64_t camera_revision;
    uint64_t edit_id;
    uint64_t frame_count;
    bool dirty;                // something may have changed since the last frame was drawn
    uint64_t dirty_since_us;   // 0 when not dirty
    uint64_t pending_until_us; // before this time a reference has nothing new to show
    struct quality_controller quality;
    enum quality drawn_row;     // of the newest frame
    enum quality drawn_wanted;  // the row that was wanted when it was drawn
    bool drawn_moving;          // whether anything moved then
    bool drawn_to_refine;       // drawn to converge, not to show a change
    float convergence;          // of the newest collected frame, as in its header
    bool drawing;               // drawn, but not collected yet
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
    char scene_label[256]; // its source, as clients know it
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
    struct rpc_id load_id;   // of the request; "" for none
    uint32_t load_client_id; // 0: initial load or hot reload
    bool reload_wanted;
    bool client_chose_scene; // then --environment no longer applies

    struct environment_loader *environment_loader;
    struct command *environment_command; // of the load under way; NULL for a hot reload; owned
    uint64_t environment_epoch;          // epoch of the document that the load is for
    struct file_watch *environment_watch;
    uint64_t environment_watched; // serial of the image whose file is watched, or 0
    bool environment_reload_wanted;

    uint32_t next_client;
    uint64_t refined_at_us; // when the newest frame was drawn that only converged
    uint64_t refine_us;     // how long such a frame took
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

// Counts an applied edit, reports it to all clients and marks views for drawing. Takes over `edit`.
// `client` is NULL if no client made the edit.
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

// Sets a client's camera to the scene's first one, or so that it sees all of the scene.
void render_reset_camera(const struct scene *scene, struct view_camera *camera);

// render_views.c
struct render_client *render_find_client(struct render_thread *thread, uint32_t client_id);
struct render_client *render_add_client(struct render_thread *thread, uint32_t client_id);
void render_remove_gone_clients(struct render_thread *thread, bool all);
// Frees what clients have of a renderer that ends; makes it anew with the next one. False when
// memory ends.
void render_drop_views(struct render_thread *thread);
bool render_renew_views(struct render_thread *thread);

// The image of one client, or of all with NULL, may have changed: frames are drawn until the
// renderer says that nothing has changed. Moving does the same and lowers the quality for a while.
void render_mark_dirty(struct render_thread *thread, struct render_client *client);
void render_mark_moving(struct render_thread *thread, struct render_client *client);

// Draws for the client whose turn it is, if any wants a frame. Views that only converge wait for
// those that have changed.
bool render_draw_next(struct render_thread *thread);

// The next time at which render_draw_next() may have work even if nothing comes in.
uint64_t render_next_draw_us(struct render_thread *thread);

// Hands finished frames to the workers that encode. With `wait`, waits for one if any is under way.
// True if there was one.
bool render_collect(struct render_thread *thread, bool wait);

// The shared settings as views are drawn with them. What "auto" voxels are must not change with the
// quality, or voxels would be rebuilt whenever the camera starts and stops.
struct render_settings render_resolve_settings(const struct render_thread *thread);

// The time from which no client will wait for a frame if nothing comes in, not even soon because
// something moves: now or earlier, later, or QUALITY_NEVER while one waits.
uint64_t render_idle_from_us(struct render_thread *thread);

// render_accuracy.c
void render_run_accuracy_start(struct render_thread *thread, struct render_client *client,
                               const struct command *command);
void render_run_accuracy_cancel(struct render_thread *thread, const struct command *command);

// Finds what the configuration that a view.configure names replaces, if it names one. False with an
// error that lists the configurations.
bool render_find_configuration(struct render_thread *thread, const struct command *command,
                               struct configuration_override *out_configuration,
                               struct rpc_error *out_error);

// Returns to the shared settings.
void render_clear_configuration(struct render_thread *thread, struct render_client *client);

// render_statistics.c
void render_send_statistics(struct render_thread *thread, uint32_t slot);

#endif
