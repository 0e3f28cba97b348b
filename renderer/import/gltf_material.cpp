#include <cfloat>
#include <cstring>

#include "renderer/import/gltf_import.hpp"

#define GLTF_WRAP_CLAMP_TO_EDGE   33071
#define GLTF_WRAP_MIRRORED_REPEAT 33648
#define GLTF_FILTER_NEAREST       9728

#define GLTF_MAX_EMISSION 1e9 // cd/m^2, brighter than the sun's disc

using tinygltf::Value;

static double get_number(const Value &object, const char *name, double fallback)
{
    const Value &value = object.Get(name);
    return value.IsNumber() ? value.GetNumberAsDouble() : fallback;
}

static void get_numbers(const Value &object, const char *name, float *out, size_t count)
{
    const Value &value = object.Get(name);
    if (!value.IsArray() || value.ArrayLen() != count) {
        return;
    }
    for (size_t i = 0; i < count; i++) {
        out[i] = gltf_float(value.Get((int)i).GetNumberAsDouble(), 0);
    }
}

static enum scene_wrap wrap_of(int mode)
{
    switch (mode) {
    case GLTF_WRAP_CLAMP_TO_EDGE:
        return SCENE_WRAP_CLAMP_TO_EDGE;
    case GLTF_WRAP_MIRRORED_REPEAT:
        return SCENE_WRAP_MIRRORED_REPEAT;
    default:
        return SCENE_WRAP_REPEAT;
    }
}

static void read_transform(gltf_import &import, const Value &transform, scene_texture &texture,
                           int &uv_set)
{
    get_numbers(transform, "offset", texture.offset, 2);
    get_numbers(transform, "scale", texture.scale, 2);
    for (float *value :
         {&texture.offset[0], &texture.offset[1], &texture.scale[0], &texture.scale[1]}) {
        *value = gltf_clamped(import, *value, -1e6, 1e6, "texture transform value");
    }
    texture.rotation_rad =
        gltf_clamped(import, get_number(transform, "rotation", 0), -1e4, 1e4, "texture rotation");
    uv_set = (int)get_number(transform, "texCoord", uv_set);
}

static scene_texture make_texture(gltf_import &import, int index, int uv_set,
                                  const tinygltf::ExtensionMap &extensions)
{
    scene_texture texture = {};
    texture.image = SCENE_NONE;
    texture.scale[0] = 1;
    texture.scale[1] = 1;
    if (index < 0) {
        return texture;
    }
    const tinygltf::Texture &source = import.model.textures[(size_t)index];
    auto webp = source.extensions.find("EXT_texture_webp");
    int image = source.source;
    if (image < 0 && webp != source.extensions.end()) {
        image = webp->second.Get("source").GetNumberAsInt();
    }
    if (image >= 0) {
        texture.image = import.image_ids[(size_t)image];
    } else {
        import_warn_once(import, "textures[%d] has no image in a supported format", index);
    }
    if (source.sampler >= 0) {
        const tinygltf::Sampler &sampler = import.model.samplers[(size_t)source.sampler];
        texture.wrap_u = wrap_of(sampler.wrapS);
        texture.wrap_v = wrap_of(sampler.wrapT);
        texture.nearest = sampler.magFilter == GLTF_FILTER_NEAREST;
    }
    auto transform = extensions.find("KHR_texture_transform");
    if (transform != extensions.end() && transform->second.IsObject()) {
        read_transform(import, transform->second, texture, uv_set);
    }
    if (uv_set > 1) {
        import_warn_once(import, "TEXCOORD_%d is not supported: set 0 is used", uv_set);
        uv_set = 0;
    }
    texture.uv_set = (uint32_t)uv_set;
    return texture;
}

template <typename texture_info>
static scene_texture make_texture(gltf_import &import, const texture_info &info)
{
    return make_texture(import, info.index, info.texCoord, info.extensions);
}

// A texture named by an extension of the material.
static scene_texture make_texture(gltf_import &import, const Value &extension, const char *name)
{
    const Value &info = extension.Get(name);
    tinygltf::ExtensionMap extensions;
    if (info.IsObject() && info.Get("extensions").IsObject()) {
        const Value &transform = info.Get("extensions").Get("KHR_texture_transform");
        if (transform.IsObject()) {
            extensions["KHR_texture_transform"] = transform;
        }
    }
    return make_texture(import, info.IsObject() ? (int)get_number(info, "index", -1) : -1,
                        info.IsObject() ? (int)get_number(info, "texCoord", 0) : 0, extensions);
}

static void read_core(gltf_import &import, const tinygltf::Material &source,
                      scene_material &material)
{
    const tinygltf::PbrMetallicRoughness &pbr = source.pbrMetallicRoughness;
    for (size_t i = 0; i < 4; i++) {
        material.base_color[i] =
            gltf_clamped(import, pbr.baseColorFactor[i], 0, 1, "base colour factor");
    }
    material.metallic = gltf_clamped(import, pbr.metallicFactor, 0, 1, "metallic factor");
    material.roughness = gltf_clamped(import, pbr.roughnessFactor, 0, 1, "roughness factor");
    for (size_t i = 0; i < 3; i++) {
        material.emissive[i] =
            gltf_clamped(import, source.emissiveFactor[i], 0, 1, "emissive factor");
    }
    material.double_sided = source.doubleSided;
    material.alpha_cutoff = gltf_clamped(import, source.alphaCutoff, 0, FLT_MAX, "alpha cutoff");
    if (source.alphaMode == "MASK") {
        material.alpha_mode = SCENE_ALPHA_MASK;
    } else if (source.alphaMode == "BLEND") {
        material.alpha_mode = SCENE_ALPHA_BLEND;
    } else if (source.alphaMode != "OPAQUE" && !source.alphaMode.empty()) {
        import_fail("material '%s': alphaMode '%s' is unknown; allowed are OPAQUE, MASK, BLEND",
                    material.name, import_short_name(source.alphaMode, 40).c_str());
    }
    scene_texture *textures = material.textures;
    textures[SCENE_TEXTURE_BASE_COLOR] = make_texture(import, pbr.baseColorTexture);
    textures[SCENE_TEXTURE_METALLIC_ROUGHNESS] = make_texture(import, pbr.metallicRoughnessTexture);
    textures[SCENE_TEXTURE_NORMAL] = make_texture(import, source.normalTexture);
    textures[SCENE_TEXTURE_OCCLUSION] = make_texture(import, source.occlusionTexture);
    textures[SCENE_TEXTURE_EMISSIVE] = make_texture(import, source.emissiveTexture);
    material.normal_scale =
        gltf_clamped(import, source.normalTexture.scale, -1e3, 1e3, "normal texture scale");
    material.occlusion_strength =
        gltf_clamped(import, source.occlusionTexture.strength, 0, 1, "occlusion texture strength");
}

static void read_transmission(gltf_import &import, const tinygltf::ExtensionMap &extensions,
                              scene_material &material)
{
    auto transmission = extensions.find("KHR_materials_transmission");
    if (transmission != extensions.end()) {
        const Value &values = transmission->second;
        material.transmission = gltf_clamped(import, get_number(values, "transmissionFactor", 0), 0,
                                             1, "transmission factor");
        material.textures[SCENE_TEXTURE_TRANSMISSION] =
            make_texture(import, values, "transmissionTexture");
    }
    auto volume = extensions.find("KHR_materials_volume");
    if (volume != extensions.end()) {
        const Value &values = volume->second;
        material.thickness_m = gltf_clamped(import, get_number(values, "thicknessFactor", 0), 0,
                                            1e6, "thickness factor");
        material.attenuation_distance_m =
            gltf_clamped(import, get_number(values, "attenuationDistance", 0), 0, FLT_MAX,
                         "attenuation distance");
        get_numbers(values, "attenuationColor", material.attenuation_color, 3);
        for (float &channel : material.attenuation_color) {
            channel = gltf_clamped(import, channel, 0, 1, "attenuation colour");
        }
        if (values.Has("thicknessTexture")) {
            import_warn_once(import, "thickness textures are ignored: the factor holds everywhere");
        }
    }
}

static void read_extensions(gltf_import &import, const tinygltf::ExtensionMap &extensions,
                            scene_material &material)
{
    auto strength = extensions.find("KHR_materials_emissive_strength");
    if (strength != extensions.end()) {
        material.emissive_strength =
            gltf_clamped(import, get_number(strength->second, "emissiveStrength", 1), 0,
                         GLTF_MAX_EMISSION, "emissive strength");
    }
    auto ior = extensions.find("KHR_materials_ior");
    if (ior != extensions.end()) {
        double value = get_number(ior->second, "ior", 1.5);
        material.ior = value == 0 ? 0 : gltf_clamped(import, value, 1, 100, "ior");
    }
    auto specular = extensions.find("KHR_materials_specular");
    if (specular != extensions.end()) {
        const Value &values = specular->second;
        material.specular =
            gltf_clamped(import, get_number(values, "specularFactor", 1), 0, 1, "specular factor");
        get_numbers(values, "specularColorFactor", material.specular_color, 3);
        for (float &channel : material.specular_color) {
            channel = gltf_clamped(import, channel, 0, 1e3, "specular colour factor");
        }
        material.textures[SCENE_TEXTURE_SPECULAR] = make_texture(import, values, "specularTexture");
        material.textures[SCENE_TEXTURE_SPECULAR_COLOR] =
            make_texture(import, values, "specularColorTexture");
    }
    if (extensions.count("KHR_materials_unlit") > 0) {
        material.shading = SCENE_SHADING_UNLIT;
    }
    read_transmission(import, extensions, material);
}

void gltf_import_materials(gltf_import &import)
{
    for (const tinygltf::Material &source : import.model.materials) {
        scene_material material;
        scene_material_init(&material, import_short_name(source.name, 64).c_str());
        read_core(import, source, material);
        read_extensions(import, source.extensions, material);
        uint32_t id = scene_add_material(import.scene, &material);
        if (id == SCENE_NONE) {
            import_fail("more than %u materials, or out of memory", SCENE_MAX_MATERIALS);
        }
        import.material_ids.push_back(id);
    }
    if (import.model.materials.empty()) {
        scene_material material;
        scene_material_init(&material, "default");
        if (scene_add_material(import.scene, &material) == SCENE_NONE) {
            import_fail("out of memory");
        }
    }
}
