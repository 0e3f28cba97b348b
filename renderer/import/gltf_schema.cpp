#include <cmath>
#include <limits>

#include "renderer/import/gltf_import.hpp"

using nlohmann::json;

namespace
{

enum rule_kind {
    RULE_INDEX,     // index into the top-level array `target`
    RULE_INDICES,   // array of indices
    RULE_INDEX_MAP, // object of indices
    RULE_INTEGER,   // low .. high
    RULE_NUMBER,
    RULE_NUMBERS, // array of `high` numbers
    RULE_STRING,
    RULE_STRINGS,
    RULE_BOOLEAN,
    RULE_OBJECT, // checked by `rules`
    RULE_OBJECTS // array of such objects
};

// Rule for one property. A list of rules ends with a null name.
struct rule {
    const char *name;
    rule_kind kind;
    bool required;
    const char *target;
    const rule *rules;
    double low;
    double high;
};

constexpr double MAX_INTEGER = 2147483647.0;

constexpr rule index_rule(const char *name, const char *target, bool required = false)
{
    return {name, RULE_INDEX, required, target, nullptr, 0, 0};
}

constexpr rule integer_rule(const char *name, double low, double high, bool required = false)
{
    return {name, RULE_INTEGER, required, nullptr, nullptr, low, high};
}

constexpr rule number_rule(const char *name, bool required = false)
{
    return {name, RULE_NUMBER, required, nullptr, nullptr, 0, 0};
}

constexpr rule numbers_rule(const char *name, double count)
{
    return {name, RULE_NUMBERS, false, nullptr, nullptr, 0, count};
}

constexpr rule string_rule(const char *name, bool required = false)
{
    return {name, RULE_STRING, required, nullptr, nullptr, 0, 0};
}

constexpr rule boolean_rule(const char *name)
{
    return {name, RULE_BOOLEAN, false, nullptr, nullptr, 0, 0};
}

constexpr rule object_rule(const char *name, const rule *rules, bool required = false)
{
    return {name, RULE_OBJECT, required, nullptr, rules, 0, 0};
}

constexpr rule objects_rule(const char *name, const rule *rules, bool required = false)
{
    return {name, RULE_OBJECTS, required, nullptr, rules, 0, 0};
}

constexpr rule END_RULE = {};

// asset

const rule ASSET_RULES[] = {string_rule("version", true), string_rule("minVersion"),
                            string_rule("generator"), string_rule("copyright"), END_RULE};

// buffers, views, accessors

const rule BUFFER_RULES[] = {string_rule("uri"), string_rule("name"),
                             integer_rule("byteLength", 1, MAX_INTEGER, true), END_RULE};
const rule VIEW_RULES[] = {index_rule("buffer", "buffers", true),
                           integer_rule("byteOffset", 0, MAX_INTEGER),
                           integer_rule("byteLength", 1, MAX_INTEGER, true),
                           integer_rule("byteStride", 4, 252),
                           integer_rule("target", 0, MAX_INTEGER),
                           string_rule("name"),
                           END_RULE};
const rule SPARSE_INDICES_RULES[] = {index_rule("bufferView", "bufferViews", true),
                                     integer_rule("byteOffset", 0, MAX_INTEGER),
                                     integer_rule("componentType", 5121, 5125, true), END_RULE};
const rule SPARSE_VALUES_RULES[] = {index_rule("bufferView", "bufferViews", true),
                                    integer_rule("byteOffset", 0, MAX_INTEGER), END_RULE};
const rule SPARSE_RULES[] = {integer_rule("count", 1, MAX_INTEGER, true),
                             object_rule("indices", SPARSE_INDICES_RULES, true),
                             object_rule("values", SPARSE_VALUES_RULES, true), END_RULE};
const rule ACCESSOR_RULES[] = {index_rule("bufferView", "bufferViews"),
                               integer_rule("byteOffset", 0, MAX_INTEGER),
                               integer_rule("componentType", 5120, 5126, true),
                               integer_rule("count", 1, SCENE_MAX_INDICES, true),
                               string_rule("type", true),
                               boolean_rule("normalized"),
                               object_rule("sparse", SPARSE_RULES),
                               string_rule("name"),
                               END_RULE};

// images, samplers, textures

const rule IMAGE_RULES[] = {string_rule("uri"), string_rule("mimeType"), string_rule("name"),
                            index_rule("bufferView", "bufferViews"), END_RULE};
const rule SAMPLER_RULES[] = {integer_rule("magFilter", 0, MAX_INTEGER),
                              integer_rule("minFilter", 0, MAX_INTEGER),
                              integer_rule("wrapS", 0, MAX_INTEGER),
                              integer_rule("wrapT", 0, MAX_INTEGER),
                              string_rule("name"),
                              END_RULE};
const rule TEXTURE_SOURCE_RULES[] = {index_rule("source", "images", true), END_RULE};
const rule TEXTURE_EXTENSIONS[] = {object_rule("EXT_texture_webp", TEXTURE_SOURCE_RULES),
                                   object_rule("KHR_texture_basisu", TEXTURE_SOURCE_RULES),
                                   END_RULE};
const rule TEXTURE_RULES[] = {index_rule("sampler", "samplers"), index_rule("source", "images"),
                              string_rule("name"), object_rule("extensions", TEXTURE_EXTENSIONS),
                              END_RULE};
const rule TRANSFORM_RULES[] = {numbers_rule("offset", 2), numbers_rule("scale", 2),
                                number_rule("rotation"), integer_rule("texCoord", 0, MAX_INTEGER),
                                END_RULE};
const rule INFO_EXTENSIONS[] = {object_rule("KHR_texture_transform", TRANSFORM_RULES), END_RULE};
const rule TEXTURE_INFO_RULES[] = {index_rule("index", "textures", true),
                                   integer_rule("texCoord", 0, MAX_INTEGER),
                                   number_rule("scale"),
                                   number_rule("strength"),
                                   object_rule("extensions", INFO_EXTENSIONS),
                                   END_RULE};

// materials

const rule PBR_RULES[] = {numbers_rule("baseColorFactor", 4),
                          object_rule("baseColorTexture", TEXTURE_INFO_RULES),
                          number_rule("metallicFactor"),
                          number_rule("roughnessFactor"),
                          object_rule("metallicRoughnessTexture", TEXTURE_INFO_RULES),
                          END_RULE};
const rule STRENGTH_RULES[] = {number_rule("emissiveStrength"), END_RULE};
const rule IOR_RULES[] = {number_rule("ior"), END_RULE};
const rule TRANSMISSION_RULES[] = {number_rule("transmissionFactor"),
                                   object_rule("transmissionTexture", TEXTURE_INFO_RULES),
                                   END_RULE};
const rule VOLUME_RULES[] = {
    number_rule("thicknessFactor"), object_rule("thicknessTexture", TEXTURE_INFO_RULES),
    number_rule("attenuationDistance"), numbers_rule("attenuationColor", 3), END_RULE};
const rule SPECULAR_RULES[] = {number_rule("specularFactor"),
                               object_rule("specularTexture", TEXTURE_INFO_RULES),
                               numbers_rule("specularColorFactor", 3),
                               object_rule("specularColorTexture", TEXTURE_INFO_RULES), END_RULE};
const rule NO_RULES[] = {END_RULE};
const rule MATERIAL_EXTENSIONS[] = {object_rule("KHR_materials_emissive_strength", STRENGTH_RULES),
                                    object_rule("KHR_materials_ior", IOR_RULES),
                                    object_rule("KHR_materials_transmission", TRANSMISSION_RULES),
                                    object_rule("KHR_materials_volume", VOLUME_RULES),
                                    object_rule("KHR_materials_specular", SPECULAR_RULES),
                                    object_rule("KHR_materials_unlit", NO_RULES),
                                    END_RULE};
const rule MATERIAL_RULES[] = {object_rule("pbrMetallicRoughness", PBR_RULES),
                               object_rule("normalTexture", TEXTURE_INFO_RULES),
                               object_rule("occlusionTexture", TEXTURE_INFO_RULES),
                               object_rule("emissiveTexture", TEXTURE_INFO_RULES),
                               numbers_rule("emissiveFactor", 3),
                               string_rule("alphaMode"),
                               number_rule("alphaCutoff"),
                               boolean_rule("doubleSided"),
                               string_rule("name"),
                               object_rule("extensions", MATERIAL_EXTENSIONS),
                               END_RULE};

// meshes

const rule PRIMITIVE_RULES[] = {{"attributes", RULE_INDEX_MAP, true, "accessors", nullptr, 0, 0},
                                index_rule("indices", "accessors"),
                                index_rule("material", "materials"),
                                integer_rule("mode", 0, 6),
                                END_RULE};
const rule MESH_RULES[] = {objects_rule("primitives", PRIMITIVE_RULES, true), string_rule("name"),
                           END_RULE};

// cameras, lights, nodes, scenes

const rule PERSPECTIVE_RULES[] = {number_rule("yfov", true), number_rule("znear", true),
                                  number_rule("zfar"), number_rule("aspectRatio"), END_RULE};
const rule ORTHOGRAPHIC_RULES[] = {number_rule("xmag"), number_rule("ymag"), number_rule("znear"),
                                   number_rule("zfar"), END_RULE};
const rule CAMERA_RULES[] = {
    string_rule("type", true), object_rule("perspective", PERSPECTIVE_RULES),
    object_rule("orthographic", ORTHOGRAPHIC_RULES), string_rule("name"), END_RULE};
const rule SPOT_RULES[] = {number_rule("innerConeAngle"), number_rule("outerConeAngle"), END_RULE};
const rule LIGHT_RULES[] = {string_rule("type", true),
                            numbers_rule("color", 3),
                            number_rule("intensity"),
                            number_rule("range"),
                            object_rule("spot", SPOT_RULES),
                            string_rule("name"),
                            END_RULE};
const rule NODE_LIGHT_RULES[] = {index_rule("light", "lights", true), END_RULE};
const rule NODE_EXTENSIONS[] = {object_rule("KHR_lights_punctual", NODE_LIGHT_RULES), END_RULE};
const rule NODE_RULES[] = {{"children", RULE_INDICES, false, "nodes", nullptr, 0, 0},
                           index_rule("mesh", "meshes"),
                           index_rule("camera", "cameras"),
                           index_rule("skin", "skins"),
                           numbers_rule("matrix", 16),
                           numbers_rule("translation", 3),
                           numbers_rule("rotation", 4),
                           numbers_rule("scale", 3),
                           string_rule("name"),
                           object_rule("extensions", NODE_EXTENSIONS),
                           END_RULE};
const rule SCENE_RULES[] = {
    {"nodes", RULE_INDICES, false, "nodes", nullptr, 0, 0}, string_rule("name"), END_RULE};

// animations

const rule CHANNEL_TARGET_RULES[] = {index_rule("node", "nodes"), string_rule("path", true),
                                     END_RULE};
const rule CHANNEL_RULES[] = {integer_rule("sampler", 0, MAX_INTEGER, true),
                              object_rule("target", CHANNEL_TARGET_RULES, true), END_RULE};
const rule ANIMATION_SAMPLER_RULES[] = {index_rule("input", "accessors", true),
                                        index_rule("output", "accessors", true),
                                        string_rule("interpolation"), END_RULE};
const rule ANIMATION_RULES[] = {objects_rule("channels", CHANNEL_RULES, true),
                                objects_rule("samplers", ANIMATION_SAMPLER_RULES, true),
                                string_rule("name"), END_RULE};

const rule LIGHTS_RULES[] = {objects_rule("lights", LIGHT_RULES, true), END_RULE};
const rule ROOT_EXTENSIONS[] = {object_rule("KHR_lights_punctual", LIGHTS_RULES), END_RULE};

const rule ROOT_RULES[] = {object_rule("asset", ASSET_RULES, true),
                           objects_rule("buffers", BUFFER_RULES),
                           objects_rule("bufferViews", VIEW_RULES),
                           objects_rule("accessors", ACCESSOR_RULES),
                           objects_rule("images", IMAGE_RULES),
                           objects_rule("samplers", SAMPLER_RULES),
                           objects_rule("textures", TEXTURE_RULES),
                           objects_rule("materials", MATERIAL_RULES),
                           objects_rule("meshes", MESH_RULES),
                           objects_rule("cameras", CAMERA_RULES),
                           objects_rule("skins", NO_RULES),
                           objects_rule("nodes", NODE_RULES),
                           objects_rule("scenes", SCENE_RULES),
                           objects_rule("animations", ANIMATION_RULES),
                           index_rule("scene", "scenes"),
                           {"extensionsUsed", RULE_STRINGS, false, nullptr, nullptr, 0, 0},
                           {"extensionsRequired", RULE_STRINGS, false, nullptr, nullptr, 0, 0},
                           object_rule("extensions", ROOT_EXTENSIONS),
                           END_RULE};

class json_checker
{
  public:
    explicit json_checker(json &document) : root(document)
    {
    }

    // Recursion is bounded by the nesting of the rules, not of the file.
    void check_object(json &object, const rule *rules, const std::string &location)
    {
        if (!object.is_object()) {
            import_fail("%s must be an object", location.c_str());
        }
        object.erase("extras");
        auto extensions = object.find("extensions");
        if (extensions != object.end() && !extensions->is_object()) {
            import_fail("%s.extensions must be an object", location.c_str());
        }
        for (; rules->name; rules++) {
            auto found = object.find(rules->name);
            if (found != object.end()) {
                check_value(*found, *rules, location);
            } else if (rules->required) {
                import_fail("%s.%s is missing", location.c_str(), rules->name);
            }
        }
    }

  private:
    json &root;

    [[noreturn]] static void fail(const std::string &location, const rule &rule, const char *wanted)
    {
        import_fail("%s.%s must be %s", location.c_str(), rule.name, wanted);
    }

    size_t count_of(const char *target)
    {
        if (std::string(target) == "lights") {
            json::json_pointer at("/extensions/KHR_lights_punctual/lights");
            return root.contains(at) && root[at].is_array() ? root[at].size() : 0;
        }
        auto found = root.find(target);
        return found != root.end() && found->is_array() ? found->size() : 0;
    }

    // Accepts an integer written as 1 or 1.0.
    void check_integer(json &value, double low, double high, const std::string &location,
                       const rule &rule)
    {
        double number = value.is_number() ? value.get<double>() : NAN;
        if (!(number == std::floor(number))) {
            fail(location, rule, "an integer");
        }
        if (number < low || number > high) {
            import_fail("%s.%s is %.17g; allowed are %.0f to %.0f", location.c_str(), rule.name,
                        number, low, high);
        }
        if (value.is_number_float()) {
            value = (int64_t)number;
        }
    }

    void check_index(json &value, const std::string &location, const rule &rule)
    {
        size_t count = count_of(rule.target);
        if (count == 0 && value.is_number()) {
            import_fail("%s.%s names an entry of %s, of which the file has none", location.c_str(),
                        rule.name, rule.target);
        }
        check_integer(value, 0, (double)count - 1, location, rule);
    }

    static void check_number(json &value, const std::string &location, const rule &rule)
    {
        if (!value.is_number() || !std::isfinite(value.get<double>())) {
            fail(location, rule, "a finite number");
        }
    }

    static void check_array(const json &value, const std::string &location, const rule &rule)
    {
        if (!value.is_array()) {
            fail(location, rule, "an array");
        }
    }

    void check_numbers(json &value, const std::string &location, const rule &rule)
    {
        check_array(value, location, rule);
        if (value.size() != (size_t)rule.high) {
            import_fail("%s.%s has %zu numbers; it must have %.0f", location.c_str(), rule.name,
                        value.size(), rule.high);
        }
        for (json &number : value) {
            check_number(number, location, rule);
        }
    }

    void check_objects(json &value, const std::string &location, const rule &rule)
    {
        check_array(value, location, rule);
        std::string name = (location == "root" ? "" : location + ".") + rule.name + "[";
        for (size_t i = 0; i < value.size(); i++) {
            check_object(value[i], rule.rules, name + std::to_string(i) + "]");
        }
    }

    void check_index_map(json &value, const std::string &location, const rule &rule)
    {
        if (!value.is_object()) {
            fail(location, rule, "an object");
        }
        for (json &index : value) {
            check_index(index, location, rule);
        }
    }

    void check_list(json &value, const std::string &location, const rule &rule)
    {
        check_array(value, location, rule);
        for (json &item : value) {
            if (rule.kind == RULE_INDICES) {
                check_index(item, location, rule);
            } else if (!item.is_string()) {
                fail(location, rule, "an array of strings");
            }
        }
    }

    void check_value(json &value, const rule &rule, const std::string &location)
    {
        switch (rule.kind) {
        case RULE_INDEX:
            return check_index(value, location, rule);
        case RULE_INDICES:
        case RULE_STRINGS:
            return check_list(value, location, rule);
        case RULE_INDEX_MAP:
            return check_index_map(value, location, rule);
        case RULE_INTEGER:
            return check_integer(value, rule.low, rule.high, location, rule);
        case RULE_NUMBER:
            return check_number(value, location, rule);
        case RULE_NUMBERS:
            return check_numbers(value, location, rule);
        case RULE_STRING:
            if (!value.is_string()) {
                fail(location, rule, "a string");
            }
            return;
        case RULE_BOOLEAN:
            if (!value.is_boolean()) {
                fail(location, rule, "true or false");
            }
            return;
        case RULE_OBJECT:
            return check_object(value, rule.rules, location + "." + rule.name);
        case RULE_OBJECTS:
            return check_objects(value, location, rule);
        }
    }
};

void check_words(const json &root)
{
    const json none = json::array();
    size_t index = 0;
    for (const json &accessor : root.value("accessors", none)) {
        const std::string type = accessor["type"];
        int component_type = accessor["componentType"];
        if (type != "SCALAR" && type != "VEC2" && type != "VEC3" && type != "VEC4" &&
            type != "MAT2" && type != "MAT3" && type != "MAT4") {
            import_fail("accessors[%zu].type '%.40s' is unknown", index, type.c_str());
        }
        if (component_type == 5124) {
            import_fail("accessors[%zu].componentType is 5124; allowed are 5120 to 5123, 5125 "
                        "and 5126",
                        index);
        }
        if (accessor.contains("sparse")) {
            int indices_type = accessor["sparse"]["indices"]["componentType"];
            if (indices_type != 5121 && indices_type != 5123 && indices_type != 5125) {
                import_fail("accessors[%zu].sparse.indices.componentType is %d; allowed are 5121, "
                            "5123 and 5125",
                            index, indices_type);
            }
        }
        index++;
    }
    const std::string version = root["asset"]["version"];
    const std::string minimum = root["asset"].value("minVersion", "2.0");
    if (version.compare(0, 2, "2.") != 0 || minimum != "2.0") {
        import_fail("glTF version %.20s (at least %.20s); supported is 2.0", version.c_str(),
                    minimum.c_str());
    }
}

void check_counts(const json &root)
{
    static const struct {
        const char *name;
        uint32_t limit;
    } LIMITS[] = {{"nodes", SCENE_MAX_NODES},         {"meshes", SCENE_MAX_MESHES},
                  {"materials", SCENE_MAX_MATERIALS}, {"images", SCENE_MAX_IMAGES},
                  {"cameras", SCENE_MAX_CAMERAS},     {"animations", SCENE_MAX_ANIMATIONS}};
    for (const auto &limit : LIMITS) {
        auto found = root.find(limit.name);
        if (found != root.end() && found->size() > limit.limit) {
            import_fail("%s has %zu entries; allowed are 0 to %u", limit.name, found->size(),
                        limit.limit);
        }
    }
}

} // namespace

void gltf_check_json(json &root)
{
    json_checker(root).check_object(root, ROOT_RULES, "root");
    check_words(root);
    check_counts(root);
}

static bool is_supported(const std::string &extension)
{
    static const char *const SUPPORTED[] = {
        "KHR_lights_punctual",    "KHR_materials_emissive_strength",
        "KHR_materials_ior",      "KHR_materials_transmission",
        "KHR_materials_volume",   "KHR_materials_unlit",
        "KHR_materials_specular", "KHR_texture_transform",
        "KHR_mesh_quantization",  "EXT_texture_webp"};
    for (const char *name : SUPPORTED) {
        if (extension == name) {
            return true;
        }
    }
    return false;
}

// Whether every texture that uses a required extension also has an image in a core format.
static bool has_fallback(const json &root, const std::string &extension)
{
    if (extension != "KHR_texture_basisu") {
        return false;
    }
    const json none = json::array();
    for (const json &texture : root.value("textures", none)) {
        if (!texture.contains("source") && texture.contains("extensions") &&
            texture["extensions"].contains(extension)) {
            return false;
        }
    }
    return true;
}

static void refuse_extension(const json &object, const char *extension)
{
    if (object.contains("extensions") && object["extensions"].contains(extension)) {
        import_fail("%s is not supported: export the scene without compression", extension);
    }
}

// Refuses compressed geometry even if the file does not require it: whether the plain data beside
// it is a copy or a stub is unknown.
static void check_compression(const json &root)
{
    const json none = json::array();
    for (const json &view : root.value("bufferViews", none)) {
        refuse_extension(view, "EXT_meshopt_compression");
    }
    for (const json &mesh : root.value("meshes", none)) {
        for (const json &primitive : mesh["primitives"]) {
            refuse_extension(primitive, "KHR_draco_mesh_compression");
        }
    }
}

void gltf_check_extensions(gltf_import &import)
{
    const json none = json::array();
    const json &root = import.json;
    for (const json &name : root.value("extensionsRequired", none)) {
        const std::string extension = name;
        if (!is_supported(extension) && !has_fallback(root, extension)) {
            import_fail("requires the extension %s, which is not supported",
                        import_short_name(extension, 80).c_str());
        }
    }
    check_compression(root);
    for (const json &name : root.value("extensionsUsed", none)) {
        const std::string extension = name;
        if (!is_supported(extension)) {
            import_warn_once(import, "extension %s is ignored",
                             import_short_name(extension, 80).c_str());
        }
    }
}
