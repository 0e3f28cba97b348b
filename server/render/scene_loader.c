#include "server/render/scene_loader.h"

#include <dirent.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#define MAX_LIST_DEPTH 4

struct scene_loader {
    void (*done)(void *user);
    void *user;
    bool busy; // used by the thread that starts loads and takes results
    pthread_t thread;
    char *source;
    char *environment;    // NULL for the scene's own
    atomic_bool finished; // once true, the taker may read the fields below
    struct scene *scene;
    struct error error;
};

struct scene_loader *scene_loader_create(void (*done)(void *user), void *user)
{
    struct scene_loader *loader = calloc(1, sizeof(*loader));
    if (loader) {
        loader->done = done;
        loader->user = user;
    }
    return loader;
}

void scene_loader_destroy(struct scene_loader **loader)
{
    if (!*loader)
        return;
    if ((*loader)->busy) {
        pthread_join((*loader)->thread, NULL);
        scene_destroy(&(*loader)->scene);
        free((*loader)->source);
        free((*loader)->environment);
    }
    free(*loader);
    *loader = NULL;
}

static void *load(void *user)
{
    struct scene_loader *loader = user;
    loader->scene = scene_load_in_environment(loader->source, loader->environment, &loader->error);
    atomic_store(&loader->finished, true);
    loader->done(loader->user);
    return NULL;
}

bool scene_loader_start(struct scene_loader *loader, const char *source, const char *environment)
{
    if (loader->busy)
        return false;
    loader->source = strdup(source);
    loader->environment = environment ? strdup(environment) : NULL;
    loader->scene = NULL;
    loader->error.message[0] = '\0';
    atomic_store(&loader->finished, false);
    loader->busy = loader->source && (loader->environment || !environment) &&
                   pthread_create(&loader->thread, NULL, load, loader) == 0;
    if (!loader->busy) {
        free(loader->source);
        free(loader->environment);
    }
    return loader->busy;
}

bool scene_loader_is_busy(const struct scene_loader *loader)
{
    return loader->busy;
}

bool scene_loader_take(struct scene_loader *loader, struct scene **out_scene,
                       struct error *out_error)
{
    if (!loader->busy || !atomic_load(&loader->finished))
        return false;
    pthread_join(loader->thread, NULL);
    free(loader->source);
    free(loader->environment);
    loader->busy = false;
    *out_scene = loader->scene;
    *out_error = loader->error;
    loader->scene = NULL;
    return true;
}

// Extensions that are wanted come from functions of an index, NULL past the last.

static const char *environment_extension(uint32_t index)
{
    static const char *const extensions[] = {".hdr", ".exr"};
    return index < 2 ? extensions[index] : NULL;
}

static bool ends_with_one(const char *name, const char *(*extension)(uint32_t))
{
    size_t length = strlen(name);
    const char *end;
    for (uint32_t i = 0; (end = extension(i)); i++) {
        size_t tail = strlen(end);
        if (length > tail && strcasecmp(name + length - tail, end) == 0)
            return true;
    }
    return false;
}

struct listing {
    const char *(*extension)(uint32_t);
    char **sources;
    uint32_t count, capacity;
};

static void list_folder(struct listing *listing, const char *folder, const char *prefix, int depth)
{
    struct dirent **entries = NULL;
    int count = scandir(folder, &entries, NULL, alphasort);
    for (int i = 0; i < count; i++) {
        char *path = NULL, *source = NULL;
        struct stat status;
        if (entries[i]->d_name[0] != '.' && listing->count < listing->capacity &&
            asprintf(&path, "%s/%s", folder, entries[i]->d_name) > 0 &&
            asprintf(&source, "%s%s", prefix, entries[i]->d_name) > 0 &&
            lstat(path, &status) == 0) {
            if (S_ISREG(status.st_mode) && ends_with_one(source, listing->extension)) {
                listing->sources[listing->count++] = source;
                source = NULL;
            } else if (S_ISDIR(status.st_mode) && depth < MAX_LIST_DEPTH) {
                char *below = NULL;
                if (asprintf(&below, "%s/", source) > 0)
                    list_folder(listing, path, below, depth + 1);
                free(below);
            }
        }
        free(path);
        free(source);
        free(entries[i]);
    }
    free(entries);
}

static uint32_t list_files(const char *folder, const char *(*extension)(uint32_t),
                           char **out_sources, uint32_t capacity)
{
    struct listing listing = {.extension = extension, .sources = out_sources, .capacity = capacity};
    if (folder)
        list_folder(&listing, folder, "", 0);
    return listing.count;
}

uint32_t scene_loader_list(const char *folder, char **out_sources, uint32_t capacity)
{
    return list_files(folder, scene_file_extension, out_sources, capacity);
}

uint32_t scene_loader_list_environments(const char *folder, char **out_names, uint32_t capacity)
{
    return list_files(folder, environment_extension, out_names, capacity);
}

static bool is_builtin(const char *source)
{
    if (strncmp(source, "builtin:", 8) != 0)
        return false;
    for (uint32_t i = 0; scene_builtin_name(i); i++) {
        if (strcmp(scene_builtin_name(i), source + 8) == 0)
            return true;
    }
    return false;
}

// `what` names the kind of thing in the message.
static char *resolve(const char *folder, const char *(*extension)(uint32_t), const char *source,
                     const char *what, struct error *out_error)
{
    char *joined = NULL, *path = NULL, *root = NULL;
    if (folder && source[0] != '/' && ends_with_one(source, extension) &&
        asprintf(&joined, "%s/%s", folder, source) > 0) {
        root = realpath(folder, NULL);
        path = realpath(joined, NULL);
    }
    size_t length = root ? strlen(root) : 0;
    bool below = root && path && strncmp(path, root, length) == 0 &&
                 (path[length] == '/' || strcmp(root, "/") == 0);
    if (!below) {
        free(path);
        path = NULL;
        error_set(out_error, "\"%.200s\" is not one of the %s that scene.list names", source, what);
    }
    free(root);
    free(joined);
    return path;
}

char *scene_loader_resolve(const char *folder, const char *source, struct error *out_error)
{
    if (is_builtin(source))
        return strdup(source);
    return resolve(folder, scene_file_extension, source, "scenes", out_error);
}

char *scene_loader_resolve_environment(const char *folder, const char *name,
                                       struct error *out_error)
{
    return resolve(folder, environment_extension, name, "environments", out_error);
}
