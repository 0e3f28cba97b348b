#include "renderer/import/import_job.hpp"

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <new>

void import_warn_once(import_job &job, const char *format, ...)
{
    char text[ERROR_MESSAGE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof(text), format, arguments);
    va_end(arguments);
    if (job.warned.size() < SCENE_MAX_WARNINGS && job.warned[text]++ == 0) {
        scene_add_warning(job.scene, "%s", text);
    }
}

// Moves the scene out of `job`.
static struct scene *import_guarded(import_job &job, const char *kind, const char *label,
                                    const uint8_t *bytes, size_t size, const import_work &work,
                                    struct error *out_error)
{
    const char *cause = "out of memory";
    std::string message;
    try {
        std::string name = label;
        size_t slash = name.rfind('/');
        name = name.substr(slash == std::string::npos ? 0 : slash + 1);
        job.scene = scene_create(import_short_name(name, sizeof(job.scene->name)).c_str());
        if (job.scene) {
            work(bytes, size);
            return job.scene;
        }
    } catch (const std::bad_alloc &) {
        cause = "out of memory";
    } catch (const std::exception &failure) {
        message = failure.what();
        cause = message.c_str();
    } catch (...) {
        cause = "unknown failure";
    }
    scene_destroy(&job.scene);
    error_set(out_error, "%s '%.160s': %s", kind, label, cause);
    return nullptr;
}

struct scene *import_from_memory(import_job &job, const char *kind, const void *bytes, size_t size,
                                 const char *base_folder, const import_work &work,
                                 struct error *out_error)
{
    job.folder = base_folder ? base_folder : "";
    return import_guarded(job, kind, "memory", (const uint8_t *)bytes, size, work, out_error);
}

struct scene *import_from_file(import_job &job, const char *kind, const char *path,
                               const import_work &work, struct error *out_error)
{
    std::unique_ptr<char, decltype(&free)> canonical(realpath(path, nullptr), free);
    if (!canonical) {
        error_set(out_error, "%s '%.200s': no such file, or not readable", kind, path);
        return nullptr;
    }
    std::unique_ptr<char, decltype(&free)> folder(asset_path_folder(canonical.get()), free);
    uint8_t *bytes = nullptr;
    size_t size = 0;
    if (!folder ||
        !asset_read_file(canonical.get(), FILE_MAX_BYTES, &bytes, &size, &job.stamp, out_error)) {
        return nullptr;
    }
    std::unique_ptr<uint8_t, decltype(&free)> owned_bytes(bytes, free);
    job.path = canonical.get();
    job.folder = folder.get();
    struct scene *scene = import_guarded(job, kind, canonical.get(), bytes, size, work, out_error);
    if (scene && !scene_add_source_file(scene, canonical.get())) {
        scene_destroy(&scene);
        error_set(out_error, "out of memory");
    }
    return scene;
}
