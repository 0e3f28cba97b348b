// Loads one environment image at a time on a thread of its own.
#ifndef VOXCAST_SERVER_RENDER_ENVIRONMENT_LOADER_H
#define VOXCAST_SERVER_RENDER_ENVIRONMENT_LOADER_H

#include "renderer/renderer.h"

struct environment_loader;

// The loading thread calls `done` when a result can be taken.
struct environment_loader *environment_loader_create(void (*done)(void *user), void *user);

// Waits for a load under way, and frees its result.
void environment_loader_destroy(struct environment_loader **loader);

// Starts to load. False if a load is under way or the thread cannot start. Call it on the thread
// that takes the result.
bool environment_loader_start(struct environment_loader *loader, const char *path);

bool environment_loader_is_busy(const struct environment_loader *loader); // until it is taken

// True when a load has ended: `out_image` is a reference that the caller owns, or NULL with the
// reason.
bool environment_loader_take(struct environment_loader *loader,
                             struct environment_image **out_image, struct error *out_error);

#endif
