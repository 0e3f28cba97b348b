// Loads one scene at a time on a thread of its own, while the old one stays shown.
#ifndef VOXCAST_SERVER_RENDER_SCENE_LOADER_H
#define VOXCAST_SERVER_RENDER_SCENE_LOADER_H

#include "renderer/renderer.h"

struct scene_loader;

// The loading thread calls `done` when a result can be taken.
struct scene_loader *scene_loader_create(void (*done)(void *user), void *user);

// Waits for a load under way, and frees its result.
void scene_loader_destroy(struct scene_loader **loader);

// Starts to load, with the environment of a file or, for NULL, with the scene's own. False if a
// load is under way or the thread cannot start. Call it on the thread that takes the result.
bool scene_loader_start(struct scene_loader *loader, const char *source, const char *environment);

bool scene_loader_is_busy(const struct scene_loader *loader); // until the result is taken

// True when a load has ended: `out_scene` is the caller's, or NULL with the reason.
bool scene_loader_take(struct scene_loader *loader, struct scene **out_scene,
                       struct error *out_error);

// Fills at most `capacity` sources that may be loaded: files below `folder` (NULL for none), named
// relative to it, sorted by name. The caller frees each. Returns their count.
uint32_t scene_loader_list(const char *folder, char **out_sources, uint32_t capacity);

// The same for environment images.
uint32_t scene_loader_list_environments(const char *folder, char **out_names, uint32_t capacity);

// The path of a source that a client may load ("builtin:NAME", or a file below `folder`). The
// caller frees it; NULL with a message.
char *scene_loader_resolve(const char *folder, const char *source, struct error *out_error);

// The path of an environment image below `folder`, likewise.
char *scene_loader_resolve_environment(const char *folder, const char *name,
                                       struct error *out_error);

#endif
