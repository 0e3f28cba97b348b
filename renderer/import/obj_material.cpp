#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>
#include <sstream>

#include "renderer/import/obj_import.hpp"

extern "C" {
#include "renderer/image/image_batch.h"
}

#define OBJ_MAX_LIBRARY_BYTES (64u << 20)
#define OBJ_MAX_EMISSION      1e9f // cd/m^2
#define OBJ_MASK_CUTOFF       0.5f

// Images of all materials by file name; holds a reference to each.
struct obj_pictures {
    std::map<std::string, struct image *> by_name;
    std::map<std::string, uint32_t> ids; // the scene's, by operation and files
    obj_pictures() = default;
    obj_pictures(const obj_pictures &) = delete;
    obj_pictures &operator=(const obj_pictures &) = delete;
    ~obj_pictures()
    {
        for (auto &entry : by_name) {
            if (entry.second) {
                image_release(&entry.second);
            }
        }
    }
};

static float clamp_value(obj_import &import, float value, float low, float high, float fallback)
{
    if (value >= low && value <= high) {
        return value;
    }
    import.scene->rejects.parameters++;
    return std::isnan(value) ? fallback : std::clamp(value, low, high);
}

static bool read_library(obj_import &import, const std::string &name,
                         std::map<std::string, int> &indices,
                         std::vector<tinyobj::material_t> &materials)
{
    struct error error;
    uint8_t *bytes = nullptr;
    size_t size = 0;
    std::unique_ptr<char, decltype(&free)> path(
        import.folder.empty() ? nullptr
                              : asset_path_resolve(import.folder.c_str(), name.c_str(), &error),
        free);
    if (!path ||
        !asset_read_file(path.get(), OBJ_MAX_LIBRARY_BYTES, &bytes, &size, nullptr, &error)) {
        return false;
    }
    std::unique_ptr<uint8_t, decltype(&free)> owned(bytes, free);
    std::istringstream text(obj_normalize_materials((const char *)bytes, size));
    std::string warning, message;
    tinyobj::LoadMtl(&indices, &materials, &text, &warning, &message);
    scene_add_source_file(import.scene, path.get());
    return true;
}

static std::string texture_name(const std::string &encoded)
{
    return obj_decode_name(encoded);
}

static void load_pictures(obj_import &import, const std::vector<tinyobj::material_t> &materials,
                          obj_pictures &pictures)
{
    for (const tinyobj::material_t &material : materials) {
        for (const std::string *name :
             {&material.diffuse_texname, &material.alpha_texname, &material.bump_texname,
              &material.normal_texname, &material.roughness_texname, &material.metallic_texname,
              &material.emissive_texname}) {
            if (!name->empty() && pictures.by_name.size() < SCENE_MAX_IMAGES) {
                pictures.by_name[texture_name(*name)] = nullptr;
            }
        }
    }
    std::vector<image_request> requests;
    std::vector<std::string> names;
    std::vector<std::unique_ptr<char, decltype(&free)>> paths;
    for (auto &entry : pictures.by_name) {
        struct error error = {};
        char *path = nullptr;
        if (!import.folder.empty()) {
            path = asset_path_resolve(import.folder.c_str(), entry.first.c_str(), &error);
        }
        if (!path) {
            import.scene->missing_image_count++;
            import_warn_once(import, "an image is left out: %s", error.message);
            continue;
        }
        paths.emplace_back(path, free);
        image_request request = {};
        request.key.path = path;
        requests.push_back(request);
        names.push_back(entry.first);
    }
    image_batch_load(requests.data(), (uint32_t)requests.size());
    for (size_t i = 0; i < requests.size(); i++) {
        pictures.by_name[names[i]] = requests[i].image;
        scene_add_source_file(import.scene, requests[i].key.path);
        if (!requests[i].image) {
            import.scene->missing_image_count++;
            import_warn_once(import, "an image is left out: '%s': %s",
                             import_short_name(names[i], 100).c_str(), requests[i].error.message);
        }
    }
}

static struct image *find_picture(const obj_pictures &pictures, const std::string &name)
{
    auto found = name.empty() ? pictures.by_name.end() : pictures.by_name.find(texture_name(name));
    return found == pictures.by_name.end() ? nullptr : found->second;
}

// Assigns a slot the image that `make` returns, made and added once per `key`. `make` returns a
// reference for us, or NULL when out of memory.
template <typename make_function>
static void set_texture(obj_import &import, obj_pictures &pictures, scene_texture &slot,
                        const std::string &key, make_function make)
{
    auto found = pictures.ids.find(key);
    if (found == pictures.ids.end()) {
        struct image *image = make();
        if (!image) {
            throw std::bad_alloc();
        }
        uint32_t id = scene_add_image(import.scene, image);
        image_release(&image);
        if (id == SCENE_NONE) {
            import_fail("more than %u images, or out of memory", SCENE_MAX_IMAGES);
        }
        found = pictures.ids.emplace(key, id).first;
    }
    slot.image = found->second;
}

static void set_base_color(obj_import &import, obj_pictures &pictures,
                           const tinyobj::material_t &source, scene_material &material)
{
    struct image *color = find_picture(pictures, source.diffuse_texname);
    struct image *mask = find_picture(pictures, source.alpha_texname);
    scene_texture &slot = material.textures[SCENE_TEXTURE_BASE_COLOR];
    if (mask) {
        set_texture(import, pictures, slot,
                    "mask:" + source.diffuse_texname + "\n" + source.alpha_texname,
                    [&] { return obj_merge_mask(color, mask); });
        material.alpha_mode = SCENE_ALPHA_MASK;
        material.alpha_cutoff = OBJ_MASK_CUTOFF;
    } else if (color) {
        set_texture(import, pictures, slot, "file:" + texture_name(source.diffuse_texname),
                    [&] { return image_retain(color); });
    }
}

static void set_surface_maps(obj_import &import, obj_pictures &pictures,
                             const tinyobj::material_t &source, scene_material &material)
{
    struct image *roughness = find_picture(pictures, source.roughness_texname);
    struct image *metallic = find_picture(pictures, source.metallic_texname);
    if (roughness || metallic) {
        set_texture(import, pictures, material.textures[SCENE_TEXTURE_METALLIC_ROUGHNESS],
                    "surface:" + source.metallic_texname + "\n" + source.roughness_texname,
                    [&] { return obj_merge_metallic_roughness(metallic, roughness); });
        material.roughness = roughness ? 1 : material.roughness;
        material.metallic = metallic ? 1 : material.metallic;
    }
    struct image *normals = find_picture(pictures, source.normal_texname);
    struct image *heights = find_picture(pictures, source.bump_texname);
    scene_texture &slot = material.textures[SCENE_TEXTURE_NORMAL];
    if (!normals && heights && obj_is_normal_map(heights)) {
        normals = heights;
    }
    if (normals) {
        const std::string &name = normals == heights ? source.bump_texname : source.normal_texname;
        set_texture(import, pictures, slot, "file:" + texture_name(name),
                    [&] { return image_retain(normals); });
    } else if (heights) {
        float multiplier = clamp_value(import, source.bump_texopt.bump_multiplier, -100, 100, 1);
        set_texture(import, pictures, slot,
                    "bump:" + std::to_string(multiplier) + texture_name(source.bump_texname),
                    [&] { return obj_make_normal_map(heights, multiplier); });
    }
}

static void set_emission(obj_import &import, obj_pictures &pictures,
                         const tinyobj::material_t &source, scene_material &material)
{
    struct image *picture = find_picture(pictures, source.emissive_texname);
    float largest = 0;
    for (int channel = 0; channel < 3; channel++) {
        material.emissive[channel] =
            clamp_value(import, source.emission[channel], 0, OBJ_MAX_EMISSION, 0);
        largest = std::max(largest, material.emissive[channel]);
    }
    if (picture) {
        set_texture(import, pictures, material.textures[SCENE_TEXTURE_EMISSIVE],
                    "file:" + texture_name(source.emissive_texname),
                    [&] { return image_retain(picture); });
    }
    for (int channel = 0; channel < 3; channel++) {
        if (picture && largest <= 0) {
            material.emissive[channel] = 1;
        } else if (largest > 1) {
            material.emissive[channel] /= largest;
        }
    }
    material.emissive_strength = std::max(largest, 1.0f);
}

static void add_material(obj_import &import, obj_pictures &pictures,
                         const tinyobj::material_t &source)
{
    scene_material material;
    scene_material_init(&material, import_short_name(source.name, 64).c_str());
    material.double_sided = true; // OBJ does not define sidedness, and viewers show both sides
    for (int channel = 0; channel < 3; channel++) {
        material.base_color[channel] = clamp_value(import, source.diffuse[channel], 0, 1, 0);
    }
    material.base_color[3] = clamp_value(import, source.dissolve, 0, 1, 1);
    if (material.base_color[3] < 1) {
        material.alpha_mode = SCENE_ALPHA_BLEND;
    }
    if (source.unknown_parameter.count(OBJ_PBR_KEY) > 0) {
        material.roughness = clamp_value(import, source.roughness, 0, 1, 1);
        material.metallic = clamp_value(import, source.metallic, 0, 1, 0);
    } else {
        // Roughness of a GGX lobe as wide as Phong's of exponent Ns.
        float exponent = clamp_value(import, source.shininess, 0, 1e6f, 0);
        material.roughness = std::sqrt(2 / (exponent + 2));
        material.metallic = 0;
    }
    if (source.ior > 1 && source.ior < 100) {
        material.ior = source.ior;
    }
    set_base_color(import, pictures, source, material);
    set_surface_maps(import, pictures, source, material);
    set_emission(import, pictures, source, material);
    uint32_t id = scene_add_material(import.scene, &material);
    if (id == SCENE_NONE) {
        import_fail("more than %u materials, or out of memory", SCENE_MAX_MATERIALS);
    }
    import.material_ids.emplace(source.name, id);
}

// A line may be one name with spaces, or several names.
static void read_libraries(obj_import &import, const std::vector<std::string> &libraries,
                           std::vector<tinyobj::material_t> &materials)
{
    std::map<std::string, int> indices;
    std::map<std::string, bool> tried;
    for (const std::string &line : libraries) {
        if (!tried.emplace(line, true).second) {
            continue;
        }
        if (read_library(import, obj_decode_name(line), indices, materials)) {
            continue;
        }
        std::istringstream names(line);
        bool found = false;
        for (std::string name; line.find(' ') != std::string::npos && names >> name;) {
            bool is_new = tried.emplace(name, true).second;
            found = (is_new && read_library(import, obj_decode_name(name), indices, materials)) ||
                    found;
        }
        if (!found) {
            import_warn_once(import,
                             "material library '%s' is missing or not in the scene's folder",
                             import_short_name(line, 100).c_str());
        }
    }
}

void obj_import_materials(obj_import &import, const std::vector<std::string> &libraries)
{
    scene_material fallback;
    scene_material_init(&fallback, "default");
    fallback.metallic = 0;
    fallback.double_sided = true;
    if (scene_add_material(import.scene, &fallback) == SCENE_NONE) {
        throw std::bad_alloc();
    }
    std::vector<tinyobj::material_t> materials;
    read_libraries(import, libraries, materials);
    obj_pictures pictures;
    load_pictures(import, materials, pictures);
    for (const tinyobj::material_t &material : materials) {
        if (!material.name.empty() && import.material_ids.count(material.name) == 0) {
            add_material(import, pictures, material);
        }
    }
}
