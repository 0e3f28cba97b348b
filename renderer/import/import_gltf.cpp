#include <algorithm>
#include <cfloat>
#include <cmath>

#include "renderer/import/gltf_import.hpp"

extern "C" {
#include "renderer/import/importers.h"
#include "renderer/import/scene_load.h"
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
    import_warn_once(import, "%s %g is outside %g to %g: taken as %g", what, value, low, high,
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
                import_warn_once(import, "morph targets are ignored: meshes keep their base shape");
            }
        }
    }
    for (nlohmann::json &node : root["nodes"]) {
        node.erase("weights");
        if (node.erase("skin") > 0) {
            import_warn_once(import, "skins are ignored: meshes keep the pose they are stored in");
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

struct scene *scene_import_gltf_memory(const void *bytes, size_t size, const char *base_folder,
                                       struct error *out_error)
{
    gltf_import import;
    import_work work = [&import](const uint8_t *data, size_t count) {
        import_document(import, data, count);
    };
    return import_from_memory(import, "glTF", bytes, size, base_folder, work, out_error);
}

struct scene *scene_import_gltf(const char *path, struct error *out_error)
{
    gltf_import import;
    import_work work = [&import](const uint8_t *data, size_t count) {
        import_document(import, data, count);
    };
    return import_from_file(import, "glTF", path, work, out_error);
}
