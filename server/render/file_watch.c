#include "server/render/file_watch.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/inotify.h>
#include <unistd.h>

#include "renderer/log.h"

#define SETTLE_MS 200

struct watched_file {
    int folder; // watch descriptor
    char *name;
};

struct file_watch {
    void (*changed)(void *user);
    void *user;
    int inotify_fd;
    int stop_fd;
    pthread_t thread;
    atomic_bool has_changed;
    pthread_mutex_t mutex; // protects the fields below
    uint32_t folder_count;
    int folders[FILE_WATCH_MAX_FOLDERS];
    uint32_t file_count;
    struct watched_file *files;
};

static bool is_watched(struct file_watch *watch, const struct inotify_event *event)
{
    bool watched = false;
    pthread_mutex_lock(&watch->mutex);
    for (uint32_t i = 0; i < watch->file_count && !watched && event->len > 0; i++)
        watched =
            watch->files[i].folder == event->wd && strcmp(watch->files[i].name, event->name) == 0;
    pthread_mutex_unlock(&watch->mutex);
    return watched;
}

// Whether one of the pending events is about a watched file.
static bool read_events(struct file_watch *watch)
{
    _Alignas(struct inotify_event) char buffer[8192];
    bool watched = false;
    ssize_t length = read(watch->inotify_fd, buffer, sizeof(buffer));
    for (char *at = buffer; length > 0 && at < buffer + length;) {
        const struct inotify_event *event = (const struct inotify_event *)at;
        watched = is_watched(watch, event) || watched;
        at += sizeof(*event) + event->len;
    }
    return watched;
}

static void *run(void *user)
{
    struct file_watch *watch = user;
    bool pending = false;
    for (;;) {
        struct pollfd fds[2] = {{watch->stop_fd, POLLIN, 0}, {watch->inotify_fd, POLLIN, 0}};
        int count = poll(fds, 2, pending ? SETTLE_MS : -1);
        if (count < 0 && errno == EINTR)
            continue;
        if (count < 0 || fds[0].revents)
            return NULL;
        if (fds[1].revents) {
            pending = read_events(watch) || pending;
        } else if (pending) {
            pending = false;
            atomic_store(&watch->has_changed, true);
            watch->changed(watch->user);
        }
    }
}

struct file_watch *file_watch_create(void (*changed)(void *user), void *user)
{
    struct file_watch *watch = calloc(1, sizeof(*watch));
    if (!watch)
        return NULL;
    watch->changed = changed;
    watch->user = user;
    watch->inotify_fd = inotify_init1(IN_CLOEXEC | IN_NONBLOCK);
    watch->stop_fd = eventfd(0, EFD_CLOEXEC);
    pthread_mutex_init(&watch->mutex, NULL);
    if (watch->inotify_fd >= 0 && watch->stop_fd >= 0 &&
        pthread_create(&watch->thread, NULL, run, watch) == 0)
        return watch;
    log_write(LOG_WARN, "file_watch_unavailable reason=\"%s\"", strerror(errno));
    close(watch->inotify_fd);
    close(watch->stop_fd);
    pthread_mutex_destroy(&watch->mutex);
    free(watch);
    return NULL;
}

// The mutex must be held.
static void clear(struct file_watch *watch)
{
    for (uint32_t i = 0; i < watch->folder_count; i++)
        inotify_rm_watch(watch->inotify_fd, watch->folders[i]);
    for (uint32_t i = 0; i < watch->file_count; i++)
        free(watch->files[i].name);
    free(watch->files);
    watch->files = NULL;
    watch->file_count = 0;
    watch->folder_count = 0;
}

void file_watch_destroy(struct file_watch **watch)
{
    struct file_watch *w = *watch;
    if (!w)
        return;
    uint64_t one = 1;
    if (write(w->stop_fd, &one, sizeof(one)) == (ssize_t)sizeof(one))
        pthread_join(w->thread, NULL);
    clear(w);
    close(w->inotify_fd);
    close(w->stop_fd);
    pthread_mutex_destroy(&w->mutex);
    free(w);
    *watch = NULL;
}

// The watch descriptor of a folder, or -1. Folders are watched, since editors replace files.
static int watch_folder(struct file_watch *watch, const char *folder)
{
    int descriptor = inotify_add_watch(watch->inotify_fd, folder, IN_CLOSE_WRITE | IN_MOVED_TO);
    for (uint32_t i = 0; i < watch->folder_count; i++) {
        if (watch->folders[i] == descriptor)
            return descriptor;
    }
    if (descriptor >= 0 && watch->folder_count == FILE_WATCH_MAX_FOLDERS) {
        inotify_rm_watch(watch->inotify_fd, descriptor);
        return -1;
    }
    if (descriptor >= 0)
        watch->folders[watch->folder_count++] = descriptor;
    return descriptor;
}

void file_watch_set_files(struct file_watch *watch, char *const *paths, uint32_t count)
{
    pthread_mutex_lock(&watch->mutex);
    clear(watch);
    watch->files = calloc(count > 0 ? count : 1, sizeof(*watch->files));
    for (uint32_t i = 0; i < count && watch->files; i++) {
        char *folder = strdup(paths[i]);
        char *slash = folder ? strrchr(folder, '/') : NULL;
        if (slash) {
            char *name = strdup(slash + 1);
            *slash = '\0';
            int descriptor = name ? watch_folder(watch, folder[0] ? folder : "/") : -1;
            if (descriptor >= 0)
                watch->files[watch->file_count++] = (struct watched_file){descriptor, name};
            else
                free(name);
        }
        free(folder);
    }
    pthread_mutex_unlock(&watch->mutex);
}

bool file_watch_take_changed(struct file_watch *watch)
{
    return atomic_exchange(&watch->has_changed, false);
}
