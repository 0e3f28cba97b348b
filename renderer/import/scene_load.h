// Reads scene files: glTF 2.0 (.gltf, .glb) and Wavefront OBJ (.obj), and the built-in scenes.
#ifndef VOXCAST_RENDERER_IMPORT_SCENE_LOAD_H
#define VOXCAST_RENDERER_IMPORT_SCENE_LOAD_H

#include "renderer/error.h"
#include "renderer/scene/scene.h"

// `source` is a file path, or "builtin:NAME" with a name of scene_builtin_name(). The file's kind
// is told by its content and extension. Files that a scene names must lie in the scene file's
// folder or below. Returns a scene with world transforms computed, which the caller owns; or NULL
// with a message that says what is wrong, where, and the allowed range. Thread-safe; blocks on
// disk.
struct scene *scene_load(const char *source, struct error *out_error);

// The importers that scene_load() chooses from.
struct scene *scene_import_gltf(const char *path, struct error *out_error);
struct scene *scene_import_obj(const char *path, struct error *out_error);

// Built-in scenes, made by code. index counts from 0; NULL past the last.
const char *scene_builtin_name(uint32_t index);
const char *scene_builtin_description(uint32_t index);
struct scene *scene_create_builtin(const char *name, struct error *out_error);

// The same in the environment of an equirectangular image (.hdr or .exr), instead of the scene's
// own; NULL for the scene's own.
struct scene *scene_load_in_environment(const char *source, const char *environment,
                                        struct error *out_error);

// Reads an equirectangular image, Radiance (.hdr) or OpenEXR (.exr), into environment->image and
// sets the type. On failure `environment` is untouched.
bool scene_load_environment(const char *path, struct scene_environment *environment,
                            struct error *out_error);

#endif
