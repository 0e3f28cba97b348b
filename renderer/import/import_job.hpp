// What importers have in common: where the scene comes from, its warnings, and a guard around their
// work.
#ifndef VOXCAST_RENDERER_IMPORT_IMPORT_JOB_HPP
#define VOXCAST_RENDERER_IMPORT_IMPORT_JOB_HPP

#include <functional>
#include <map>
#include <string>

#include "renderer/import/import_failure.hpp"

extern "C" {
#include "renderer/image/file_access.h"
#include "renderer/scene/scene.h"
}

struct import_job {
    struct scene *scene = nullptr;
    std::string path;   // canonical; empty when the file came from memory
    std::string folder; // canonical; empty to read no other files
    struct asset_stamp stamp = {};
    std::map<std::string, uint32_t> warned; // occurrences by text
};

// Fills job.scene, which is empty but for its name; throws where it cannot.
typedef std::function<void(const uint8_t *bytes, size_t size)> import_work;

// Adds a warning once per text, however often it occurs.
void import_warn_once(import_job &job, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

// Does the work on a file, or on `size` bytes with `base_folder` as in importers.h. Lets no
// exception escape: returns the scene, which is the caller's, or NULL with an error that names
// `kind` and the file.
struct scene *import_from_file(import_job &job, const char *kind, const char *path,
                               const import_work &work, struct error *out_error);
struct scene *import_from_memory(import_job &job, const char *kind, const void *bytes, size_t size,
                                 const char *base_folder, const import_work &work,
                                 struct error *out_error);

#endif
