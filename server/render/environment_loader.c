#include "server/render/environment_loader.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

struct environment_loader {
    void (*done)(void *user);
    void *user;
    bool busy; // used by the thread that starts loads and takes results
    pthread_t thread;
    char *path;
    atomic_bool finished; // once true, the taker may read the fields below
    struct environment_image *image;
    struct error error;
};

struct environment_loader *environment_loader_create(void (*done)(void *user), void *user)
{
    struct environment_loader *loader = calloc(1, sizeof(*loader));
    if (loader) {
        loader->done = done;
        loader->user = user;
    }
    return loader;
}

void environment_loader_destroy(struct environment_loader **loader)
{
    if (!*loader)
        return;
    if ((*loader)->busy) {
        pthread_join((*loader)->thread, NULL);
        environment_image_release(&(*loader)->image);
        free((*loader)->path);
    }
    free(*loader);
    *loader = NULL;
}

static void *load(void *user)
{
    struct environment_loader *loader = user;
    loader->image = environment_image_load(loader->path, &loader->error);
    atomic_store(&loader->finished, true);
    loader->done(loader->user);
    return NULL;
}

bool environment_loader_start(struct environment_loader *loader, const char *path)
{
    if (loader->busy)
        return false;
    loader->path = strdup(path);
    loader->image = NULL;
    loader->error.message[0] = '\0';
    atomic_store(&loader->finished, false);
    loader->busy = loader->path && pthread_create(&loader->thread, NULL, load, loader) == 0;
    if (!loader->busy)
        free(loader->path);
    return loader->busy;
}

bool environment_loader_is_busy(const struct environment_loader *loader)
{
    return loader->busy;
}

bool environment_loader_take(struct environment_loader *loader,
                             struct environment_image **out_image, struct error *out_error)
{
    if (!loader->busy || !atomic_load(&loader->finished))
        return false;
    pthread_join(loader->thread, NULL);
    free(loader->path);
    loader->busy = false;
    *out_image = loader->image;
    *out_error = loader->error;
    loader->image = NULL;
    return true;
}
