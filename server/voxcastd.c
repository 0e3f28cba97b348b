// voxcastd: renders a scene and streams it to browsers.
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "protocol/limits.h"
#include "renderer/renderer.h"
#include "server/render/accuracy_service.h"
#include "server/network/network.h"
#include "server/options.h"
#include "server/render/render_thread.h"
#include "voxcast_paths.h"

// Told to stop, the program ends within this time, whatever a driver or a file is doing. Sanitizers
// need longer, to see what is left when all has ended.
#ifdef VOXCAST_SANITIZED
#define STOP_MS 60000
#else
#define STOP_MS 800
#endif

extern char **environ;

struct daemon {
    struct options options;
    char token[PROTOCOL_MAX_TOKEN_BYTES + 1];
    char viewer_token[PROTOCOL_MAX_TOKEN_BYTES + 1];
    struct mailbox *mailbox;
    struct outbox *outbox;
    struct frame_stream *stream;
    struct encode_workers *workers;
    struct accuracy_service *accuracy;
    struct render_thread *render;
    struct network *network;
};

static bool read_token(const char *path, char *out, struct error *error)
{
    char line[PROTOCOL_MAX_TOKEN_BYTES + 2] = "";
    if (!path[0])
        return true;
    FILE *file = fopen(path, "r");
    if (file && !fgets(line, sizeof(line), file))
        line[0] = '\0';
    if (file)
        fclose(file);
    line[strcspn(line, "\r\n")] = '\0';
    if (!line[0] || strlen(line) > PROTOCOL_MAX_TOKEN_BYTES)
        return error_set(error, "token file %.200s: want one line of 1 to %u bytes", path,
                         PROTOCOL_MAX_TOKEN_BYTES);
    strcpy(out, line);
    return true;
}

static bool check_scene_dir(const char *path, struct error *error)
{
    struct stat status;
    if (!path[0] || (stat(path, &status) == 0 && S_ISDIR(status.st_mode)))
        return true;
    return error_set(error, "scene-dir %.200s: want a folder", path);
}

static void choose_web_dir(struct options *options)
{
    static const char *const folders[] = {VOXCAST_SOURCE_DIR "/web_client",
                                          VOXCAST_INSTALL_SHARE_DIR "/web_client"};
    for (size_t i = 0; i < 2 && !options->web_dir[0]; i++) {
        if (access(folders[i], R_OK) == 0)
            snprintf(options->web_dir, sizeof(options->web_dir), "%s", folders[i]);
    }
}

static void wake_network(void *user)
{
    struct daemon *daemon = user;
    network_wake(daemon->network);
}

static void wake_render(void *user)
{
    struct daemon *daemon = user;
    mailbox_wake(daemon->mailbox);
}

// Called when the render thread cannot go on: ends the program as a signal would.
static void render_failed(void *user)
{
    (void)user;
    kill(getpid(), SIGTERM);
}

static bool create_parts(struct daemon *daemon, struct error *error)
{
    const struct options *options = &daemon->options;
    daemon->mailbox = mailbox_create();
    daemon->stream = frame_stream_create(&(struct frame_stream_params){
        .max_clients = options->max_clients,
        .wake_network = wake_network,
        .wake_render = wake_render,
        .user = daemon,
    });
    daemon->outbox = outbox_create(&(struct outbox_params){.wake = wake_network, .user = daemon});
    daemon->accuracy = accuracy_service_create(
        &(struct accuracy_service_params){.gpu = options->gpu, .outbox = daemon->outbox});
    if (!daemon->mailbox || !daemon->stream || !daemon->outbox || !daemon->accuracy)
        return error_set(error, "out of memory");
    daemon->network = network_create(
        &(struct network_params){
            .listen = options->listen,
            .port = options->port,
            .web_dir = options->web_dir,
            .allow_origin = options->allow_origin,
            .token = daemon->token,
            .viewer_token = daemon->viewer_token,
            .message_bytes = options->message_bytes,
            .queue_bytes = options->queue_bytes,
            .message_rate = options->message_rate,
            .mailbox = daemon->mailbox,
            .stream = daemon->stream,
            .accuracy = daemon->accuracy,
        },
        error);
    if (!daemon->network)
        return false;
    daemon->workers = encode_workers_create(&(struct encode_workers_params){
        .thread_count = options->jpeg_threads,
        .quality = (int)options->jpeg_quality,
        .stream = daemon->stream,
    });
    return daemon->workers || error_set(error, "cannot start the threads that encode");
}

static bool start_threads(struct daemon *daemon, struct error *error)
{
    const struct options *options = &daemon->options;
    daemon->render = render_thread_start(&(struct render_thread_params){
        .gpu = options->gpu,
        .scene_source = options->scene,
        .environment = options->environment[0] ? options->environment : NULL,
        .scene_dir = options->scene_dir[0] ? options->scene_dir : NULL,
        .message_bytes = options->message_bytes,
        .message_rate = options->message_rate,
        .max_clients = options->max_clients,
        .mailbox = daemon->mailbox,
        .outbox = daemon->outbox,
        .stream = daemon->stream,
        .workers = daemon->workers,
        .accuracy = daemon->accuracy,
        .failed = render_failed,
    });
    if (!daemon->render || !network_start(daemon->network, daemon->outbox, daemon->render))
        return error_set(error, "cannot start the threads");
    const char *address = options->listen;
    bool everywhere = strcmp(address, "0.0.0.0") == 0 || strcmp(address, "::") == 0;
    bool ipv6 = !everywhere && strchr(address, ':');
    printf("voxcastd: open http://%s%s%s:%u/\n", ipv6 ? "[" : "",
           everywhere ? "127.0.0.1" : address, ipv6 ? "]" : "", network_get_port(daemon->network));
    fflush(stdout);
    return true;
}

// Only main() takes SIGINT and SIGTERM.
static void list_signals(sigset_t *out_signals)
{
    sigemptyset(out_signals);
    sigaddset(out_signals, SIGTERM);
    sigaddset(out_signals, SIGINT);
}

// Compiling a shader, drawing a frame or reading a file may take many seconds and cannot be
// interrupted. Ending there loses nothing: clients have been told, and files are removed.
static void *end_in_time(void *exit_status)
{
    sigset_t signals;
    list_signals(&signals);
    const struct timespec limit = {STOP_MS / 1000, STOP_MS % 1000 * 1000000L};
    sigtimedwait(&signals, NULL, &limit); // or a second signal
    _exit((int)(intptr_t)exit_status);
}

// Stops the parts in an order that lets each finish what the others wait for. Returns the exit
// status.
static int stop(struct daemon *daemon, bool fine)
{
    if (daemon->render) {
        struct render_status status;
        render_thread_get_status(daemon->render, &status);
        fine = fine && !status.failed;
    }
    int exit_status = fine ? 0 : 1;
    pthread_t watchdog;
    if (pthread_create(&watchdog, NULL, end_in_time, (void *)(intptr_t)exit_status) == 0)
        pthread_detach(watchdog);
    log_write(LOG_INFO, "stopping");
    if (daemon->render)
        render_thread_stop(daemon->render);
    if (daemon->accuracy)
        accuracy_service_stop(daemon->accuracy);
    if (daemon->network)
        network_stop(daemon->network);
    if (daemon->outbox)
        outbox_close(daemon->outbox);
    render_thread_destroy(&daemon->render);
    encode_workers_destroy(&daemon->workers);
    network_destroy(&daemon->network);
    accuracy_service_destroy(&daemon->accuracy);
    outbox_destroy(&daemon->outbox);
    frame_stream_destroy(&daemon->stream);
    mailbox_destroy(&daemon->mailbox);
    return exit_status;
}

int main(int argument_count, char **arguments)
{
    static struct daemon daemon;
    struct error error = {""};
    renderer_prepare_process(arguments);
    enum options_result result =
        options_read(argument_count, arguments, environ, &daemon.options, &error);
    if (result == OPTIONS_HELP) {
        char help[8192];
        options_write_help(help, sizeof(help));
        fputs(help, stdout);
        return 0;
    }
    if (result == OPTIONS_VERSION) {
        puts("voxcastd " VOXCAST_VERSION);
        return 0;
    }
    // Before any thread starts: all inherit the mask, and sigwait() below gets the signals.
    sigset_t signals;
    list_signals(&signals);
    pthread_sigmask(SIG_BLOCK, &signals, NULL);
    signal(SIGPIPE, SIG_IGN);
    log_set_level(daemon.options.log_level);
    if (result == OPTIONS_RUN)
        scene_cache_open(daemon.options.scene_cache_mib);
    choose_web_dir(&daemon.options);
    bool fine = result == OPTIONS_RUN && check_scene_dir(daemon.options.scene_dir, &error) &&
                read_token(daemon.options.token_file, daemon.token, &error) &&
                read_token(daemon.options.viewer_token_file, daemon.viewer_token, &error) &&
                create_parts(&daemon, &error) && start_threads(&daemon, &error);
    if (fine) {
        int number = 0;
        sigwait(&signals, &number);
    } else {
        fprintf(stderr, "voxcastd: %s\n", error.message);
    }
    return stop(&daemon, fine);
}
