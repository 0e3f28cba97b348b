#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdarg>
#include <cstdlib>
#include <memory>

#include "renderer/import/gltf_import.hpp"

extern "C" {
#include "renderer/import/import_memory.h"
#include "renderer/import/scene_load.h"
}

void gltf_warn_once(gltf_import &import, const char *format, ...)
{
    char text[ERROR_MESSAGE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof(text), format, arguments);
    va_end(arguments);
    if (import.warned.size() < SCENE_MAX_WARNINGS && import.warned[text]++ == 0) {
        scene_add_warning(import.scene, "%s", text);
    }
}

float gltf_float(double value, float fallback)
{
    if (std::isnan(value)) {
        return fallback;
    }
    return (float)std::clamp(value, -(double)FLT_MAX, (double)FLT_MAX);
}

float gltf_clamped(gltf_import &import, double value, double low, double high, const char *what)
{
    if (value >= low && value <= high) {
        return (float)value;
    }
    import.scene->rejects.parameters++;
    double clamped = std::isnan(value) ? low : std::clamp(value, low, high);
    gltf_warn_once(import, "%s %g is outside %g to %g: taken as %g", what, value, low, high,
                   clamped);
    return (float)clamped;
}

// Removes what is not imported, so that tinygltf sees only checked data.
static void strip_ignored(gltf_import &import, nlohmann::json &root)
{
    for (const char *part : {"buffers", "images", "skins"}) {
        root.erase(part);
    }
    for (nlohmann::json &accessor : root["accessors"]) {
        accessor.erase("min");
        accessor.erase("max");
    }
    for (nlohmann::json &mesh : root["meshes"]) {
        mesh.erase("weights");
        for (nlohmann::json &primitive : mesh["primitives"]) {
            if (primitive.erase("targets") > 0) {
                gltf_warn_once(import, "morph targets are ignored: meshes keep their base shape");
            }
        }
    }
    for (nlohmann::json &node : root["nodes"]) {
        node.erase("weights");
        if (node.erase("skin") > 0) {
            gltf_warn_once(import, "skins are ignored: meshes keep the pose they are stored in");
        }
    }
    for (nlohmann::json &animation : root["animations"]) {
        nlohmann::json kept = nlohmann::json::array();
        for (nlohmann::json &channel : animation["channels"]) {
            if (channel["target"].contains("node")) {
                kept.push_back(std::move(channel));
            }
        }
        animation["channels"] = std::move(kept);
    }
}

// Converts the checked JSON to tinygltf's structures. Without buffers and images tinygltf opens no
// file and decodes nothing.
static void map_to_model(gltf_import &import)
{
    nlohmann::json structure = std::move(import.json);
    import.json = nlohmann::json::object();
    for (const char *part : {"buffers", "bufferViews", "images"}) {
        import.json[part] = structure.value(part, nlohmann::json::array());
    }
    strip_ignored(import, structure);
    std::string text = structure.dump();
    structure = nullptr;
    tinygltf::TinyGLTF loader;
    std::string error, warning;
    if (!loader.LoadASCIIFromString(&import.model, &error, &warning, text.data(),
                                    (unsigned int)text.size(), "")) {
        import_fail("%s", import_short_name(error, 400).c_str());
    }
}

static void import_document(gltf_import &import, const uint8_t *bytes, size_t size)
{
    gltf_read_document(import, bytes, size);
    map_to_model(import);
    gltf_check_accessors(import);
    gltf_read_images(import);
    gltf_import_materials(import);
    gltf_import_nodes(import);
    gltf_import_animations(import);
    scene_update_world_transforms(import.scene);
}

// Moves the scene out of `import`; lets no exception escape.
static struct scene *import_guarded(gltf_import &import, const uint8_t *bytes, size_t size,
                                    const char *label, struct error *out_error)
{
    const char *cause = "out of memory";
    std::string message;
    try {
        std::string name = label;
        size_t slash = name.rfind('/');
        name = name.substr(slash == std::string::npos ? 0 : slash + 1);
        import.scene = scene_create(import_short_name(name, 128).c_str());
        if (import.scene) {
            import_document(import, bytes, size);
            return import.scene;
        }
    } catch (const std::bad_alloc &) {
        cause = "out of memory";
    } catch (const std::exception &failure) {
        message = failure.what();
        cause = message.c_str();
    } catch (...) {
        cause = "unknown failure";
    }
    scene_destroy(&import.scene);
    error_set(out_error, "glTF '%.160s': %s", label, cause);
    return nullptr;
}

struct scene *scene_import_gltf_memory(const void *bytes, size_t size, const char *base_folder,
                                       struct error *out_error)
{
    gltf_import import;
    import.folder = base_folder ? base_folder : "";
    return import_guarded(import, (const uint8_t *)bytes, size, "memory", out_error);
}

struct scene *scene_import_gltf(const char *path, struct error *out_error)
{
    gltf_import import;
    std::unique_ptr<char, decltype(&free)> canonical(realpath(path, nullptr), free);
    if (!canonical) {
        error_set(out_error, "glTF '%.200s': no such file, or not readable", path);
        return nullptr;
    }
    std::unique_ptr<char, decltype(&free)> folder(asset_path_folder(canonical.get()), free);
    uint8_t *bytes = nullptr;
    size_t size = 0;
    if (!folder || !asset_read_file(canonical.get(), FILE_MAX_BYTES, &bytes, &size, &import.stamp,
                                    out_error)) {
        return nullptr;
    }
    std::unique_ptr<uint8_t, decltype(&free)> owned_bytes(bytes, free);
    import.path = canonical.get();
    import.folder = folder.get();
    struct scene *scene = import_guarded(import, bytes, size, canonical.get(), out_error);
    if (scene && !scene_add_source_file(scene, canonical.get())) {
        scene_destroy(&scene);
        error_set(out_error, "out of memory");
    }
    return scene;
}
