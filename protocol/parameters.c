#include "protocol/parameters.h"

#include <stdio.h>
#include <string.h>

#include <cjson/cJSON.h>

const char *const parameter_group_names[GROUP_COUNT] = {
    "light", "material", "node", "environment", "settings", "animation", "view", "camera",
};

const char *const parameter_type_names[PARAMETER_TYPE_COUNT] = {
    "float", "int", "bool", "enum", "string", "vec3", "color", "color_alpha", "quaternion",
};

#define NAMES(...) ((const char *const[]){__VA_ARGS__, NULL})

#define FLOAT_(group, name, low, high, step, unit, fallback, doc)                                  \
    {                                                                                              \
        group, name, PARAMETER_FLOAT, PARAMETER_LIVE, low, high, step, unit, fallback, NULL, doc   \
    }
#define INT_(group, name, low, high, unit, fallback, doc)                                          \
    {                                                                                              \
        group, name, PARAMETER_INT, 0, low, high, 1, unit, fallback, NULL, doc                     \
    }
#define BOOL_(group, name, flags, fallback, doc)                                                   \
    {                                                                                              \
        group, name, PARAMETER_BOOL, flags, 0, 0, 0, "", fallback, NULL, doc                       \
    }
#define ENUM_(group, name, flags, fallback, names, doc)                                            \
    {                                                                                              \
        group, name, PARAMETER_ENUM, flags, 0, 0, 0, "", fallback, names, doc                      \
    }
#define STRING_(group, name, doc)                                                                  \
    {                                                                                              \
        group, name, PARAMETER_STRING, 0, 0, 0, 0, "", "\"\"", NULL, doc                           \
    }
#define VEC3_(group, name, flags, limit, step, unit, fallback, doc)                                \
    {                                                                                              \
        group, name, PARAMETER_VEC3, PARAMETER_LIVE | flags, -(limit), limit, step, unit,          \
            fallback, NULL, doc                                                                    \
    }
#define COLOR_(group, name, fallback, doc)                                                         \
    {                                                                                              \
        group, name, PARAMETER_COLOR, PARAMETER_LIVE, 0, 1, 0.01, "", fallback, NULL, doc          \
    }

#define MAX_POSITION_M   1e7
#define QUARTER_TURN_RAD 1.5708 // a quarter turn, rounded up so that the float nearest to it passes
#define FULL_TURN_RAD    6.2832
#define MAX_EMITTED      1e7
#define MAX_SIZE_M       1e6

// As render_settings_init() has it.
#define GI_METHOD_DEFAULT "\"clipmap\""

static const struct parameter parameters[] = {
    STRING_(GROUP_LIGHT, "name", "Name shown to people."),
    ENUM_(GROUP_LIGHT, "type", 0, "\"point\"", NAMES("directional", "point", "spot"),
          "Kind of light; decides the unit of intensity."),
    BOOL_(GROUP_LIGHT, "enabled", 0, "true", "Off: as if the light were not there."),
    BOOL_(GROUP_LIGHT, "casts_shadow", 0, "true", "Whether surfaces block this light."),
    COLOR_(GROUP_LIGHT, "color", "[1,1,1]", "Linear colour, times intensity."),
    FLOAT_(GROUP_LIGHT, "intensity", 0, MAX_EMITTED, 0.1, "cd, or lux if directional", "1",
           "Luminous intensity (point, spot) or illuminance (directional)."),
    FLOAT_(GROUP_LIGHT, "range_m", 0, MAX_SIZE_M, 0.1, "m", "0",
           "Distance at which the light has faded to nothing; 0 is unlimited."),
    FLOAT_(GROUP_LIGHT, "inner_cone_rad", 0, QUARTER_TURN_RAD, 0.01, "rad", "0",
           "Spot: half angle of full intensity; counts as outer_cone_rad where it is larger."),
    FLOAT_(GROUP_LIGHT, "outer_cone_rad", 0, QUARTER_TURN_RAD, 0.01, "rad", "0.785398",
           "Spot: half angle at which the light ends."),
    FLOAT_(GROUP_LIGHT, "radius_m", 0, 1000, 0.01, "m", "0",
           "Radius of a spherical source; 0 is a mathematical point."),
    VEC3_(GROUP_LIGHT, "position", 0, MAX_POSITION_M, 0.1, "m", "[0,0,0]", "World position."),
    VEC3_(GROUP_LIGHT, "direction", PARAMETER_NONZERO, 1.0, 0.01, "", "[0,-1,0]",
          "World direction in which the light shines; any length but zero."),

    STRING_(GROUP_MATERIAL, "name", "Name shown to people."),
    ENUM_(GROUP_MATERIAL, "shading", 0, "\"pbr\"", NAMES("pbr", "blinn_phong", "unlit"),
          "Shading model of the material."),
    ENUM_(GROUP_MATERIAL, "alpha_mode", 0, "\"opaque\"", NAMES("opaque", "mask", "blend"),
          "What alpha means: nothing, a cut-out, or coverage."),
    FLOAT_(GROUP_MATERIAL, "alpha_cutoff", 0, 1, 0.01, "", "0.5",
           "Mask: alpha below this is a hole."),
    BOOL_(GROUP_MATERIAL, "double_sided", 0, "false", "Whether back faces are seen."),
    {GROUP_MATERIAL, "base_color", PARAMETER_COLOR_ALPHA, PARAMETER_LIVE, 0, 1, 0.01, "",
     "[1,1,1,1]", NULL, "Linear base colour and alpha, times the texture."},
    FLOAT_(GROUP_MATERIAL, "metallic", 0, 1, 0.01, "", "1", "0 dielectric, 1 metal."),
    FLOAT_(GROUP_MATERIAL, "roughness", 0, 1, 0.01, "", "1", "Perceptual roughness."),
    FLOAT_(GROUP_MATERIAL, "normal_scale", -10, 10, 0.01, "", "1", "Strength of the normal map."),
    FLOAT_(GROUP_MATERIAL, "occlusion_strength", 0, 1, 0.01, "", "1",
           "Strength of the occlusion map."),
    COLOR_(GROUP_MATERIAL, "emissive", "[0,0,0]", "Linear colour of emitted light."),
    FLOAT_(GROUP_MATERIAL, "emissive_strength", 0, MAX_EMITTED, 0.1, "cd/m2", "1",
           "Luminance that emissive is multiplied by."),
    FLOAT_(GROUP_MATERIAL, "ior", 1, 5, 0.01, "", "1.5",
           "Index of refraction; 1 has no dielectric reflection."),
    FLOAT_(GROUP_MATERIAL, "specular", 0, 1, 0.01, "", "1", "Strength of dielectric reflection."),
    COLOR_(GROUP_MATERIAL, "specular_color", "[1,1,1]",
           "Colour of dielectric reflection; Blinn-Phong: specular reflectance."),
    FLOAT_(GROUP_MATERIAL, "transmission", 0, 1, 0.01, "", "0",
           "Share of light that passes through the surface."),
    FLOAT_(GROUP_MATERIAL, "thickness_m", 0, 1000, 0.01, "m", "0",
           "Thickness below the surface; 0 is a thin wall."),
    FLOAT_(GROUP_MATERIAL, "attenuation_distance_m", 0, MAX_SIZE_M, 0.01, "m", "0",
           "Distance after which light has attenuation_color; 0 is infinite."),
    COLOR_(GROUP_MATERIAL, "attenuation_color", "[1,1,1]",
           "Colour of white light after attenuation_distance_m."),

    STRING_(GROUP_NODE, "name", "Name shown to people."),
    VEC3_(GROUP_NODE, "translation", 0, MAX_POSITION_M, 0.1, "m", "[0,0,0]",
          "Relative to the parent."),
    {GROUP_NODE, "rotation", PARAMETER_QUATERNION, PARAMETER_LIVE | PARAMETER_NONZERO, -1, 1, 0.01,
     "", "[0,0,0,1]", NULL, "Relative to the parent: x, y, z, w."},
    VEC3_(GROUP_NODE, "scale", 0, 1e4, 0.01, "", "[1,1,1]", "Relative to the parent."),
    BOOL_(GROUP_NODE, "visible", 0, "true", "Off hides the node and all below it."),

    ENUM_(GROUP_ENVIRONMENT, "type", 0, "\"none\"",
          NAMES("none", "constant", "gradient", "equirect"),
          "What surrounds the scene; equirect needs a picture in the scene."),
    FLOAT_(GROUP_ENVIRONMENT, "intensity", 0, MAX_EMITTED, 0.1, "cd/m2", "1",
           "Luminance that the colours or the picture are multiplied by."),
    COLOR_(GROUP_ENVIRONMENT, "color", "[1,1,1]", "Constant: the colour. Gradient: the zenith."),
    COLOR_(GROUP_ENVIRONMENT, "horizon_color", "[1,1,1]", "Gradient: the horizon."),
    COLOR_(GROUP_ENVIRONMENT, "ground_color", "[0,0,0]", "Gradient: straight down."),
    FLOAT_(GROUP_ENVIRONMENT, "rotation_rad", -FULL_TURN_RAD, FULL_TURN_RAD, 0.01, "rad", "0",
           "Turns the surroundings about the vertical."),

    ENUM_(GROUP_SETTINGS, "gi_method", 0, GI_METHOD_DEFAULT,
          NAMES("none", "clipmap", "grid", "reference"),
          "How indirect light is found: not at all, by voxels around the camera, around the whole "
          "scene, or by tracing paths until the picture is right."),
    ENUM_(GROUP_SETTINGS, "voxel_resolution", 0, "\"auto\"", NAMES("auto", "64", "128", "256"),
          "Voxels along an edge of a cube; 256 is for the grid, clipmaps take 128."),
    ENUM_(GROUP_SETTINGS, "voxel_directions", 0, "\"anisotropic\"",
          NAMES("anisotropic", "isotropic"),
          "Whether a voxel holds light for six directions, or one for all."),
    INT_(GROUP_SETTINGS, "clip_levels", 0, 6, "", "0",
         "Nested cubes of the clipmap; 0 is as many as the scene needs."),
    ENUM_(GROUP_SETTINGS, "cone_set", 0, "\"auto\"", NAMES("auto", "5", "6", "9", "16", "32"),
          "Cones that gather light above a surface; auto is by quality."),
    FLOAT_(GROUP_SETTINGS, "cone_step", 0, 2, 0.05, "diameters", "0",
           "Length of a cone's steps, 0.25 or more; 0 is by quality."),
    ENUM_(GROUP_SETTINGS, "gather_mode", 0, "\"auto\"",
          NAMES("auto", "cache", "half", "pixel", "rays"),
          "Where cones start: at voxels, at every other pixel, at every pixel; or rays at pixels, "
          "which come in once the picture rests. Auto is by quality."),
    INT_(GROUP_SETTINGS, "bounces", 0, 16, "", "0", "Of indirect light; 0 is unlimited."),
    FLOAT_(GROUP_SETTINGS, "indirect_intensity", 0, 100, 0.05, "", "1",
           "Indirect light is multiplied by this; 1 is physical."),
    BOOL_(GROUP_SETTINGS, "ambient_occlusion", 0, "false",
          "Darkens corners beyond what is physical."),
    BOOL_(GROUP_SETTINGS, "soft_shadows", 0, "true",
          "Lights that have a size cast shadows with soft edges."),
    BOOL_(GROUP_SETTINGS, "indirect_specular", 0, "true", "Surfaces reflect what is around them."),
    BOOL_(GROUP_SETTINGS, "refraction", 0, "true", "Glass bends what is seen through it."),
    BOOL_(GROUP_SETTINGS, "environment_light", 0, "true",
          "What surrounds the scene adds to indirect light."),
    BOOL_(GROUP_SETTINGS, "voxelize_every_frame", 0, "false",
          "Grid: makes the voxels anew for each frame; slower, for comparison."),
    ENUM_(GROUP_SETTINGS, "levels_per_frame", 0, "\"all\"", NAMES("all", "one"),
          "Clipmap: how many cubes are lit anew in a frame."),
    ENUM_(GROUP_SETTINGS, "tonemap", PARAMETER_LIVE, "\"hable\"",
          NAMES("hable", "aces", "khronos_neutral", "none"), "Curve from radiance to the screen."),
    ENUM_(GROUP_SETTINGS, "exposure_mode", PARAMETER_LIVE, "\"automatic\"",
          NAMES("automatic", "fixed"), "Measured from the picture, or fixed."),
    FLOAT_(GROUP_SETTINGS, "exposure_ev", -16, 16, 0.1, "EV", "0",
           "Stops added; fixed: radiance is scaled by 2^exposure_ev."),
    FLOAT_(GROUP_SETTINGS, "gamma", 0, 4, 0.01, "", "0", "0 is the sRGB curve, else a power."),
    ENUM_(GROUP_SETTINGS, "shading_model", PARAMETER_LIVE, "\"ggx\"", NAMES("ggx", "blinn_phong"),
          "For materials that do not say Blinn-Phong themselves."),
    BOOL_(GROUP_SETTINGS, "shadows", 0, "true", "Off: no light is blocked."),
    BOOL_(GROUP_SETTINGS, "force_all_effects", 0, "false",
          "Run every effect, needed or not; must not change the picture."),

    BOOL_(GROUP_ANIMATION, "playing", 0, "false", "Whether time runs."),
    FLOAT_(GROUP_ANIMATION, "time_s", 0, 1e6, 0.01, "s", "0",
           "Time in the animation; held to its duration."),
    FLOAT_(GROUP_ANIMATION, "speed", -10, 10, 0.1, "", "1", "Seconds of animation per second."),
    BOOL_(GROUP_ANIMATION, "loop", 0, "true", "Start over at the end instead of stopping."),

    INT_(GROUP_VIEW, "width", 1, 4096, "px", "640", "Width of this client's picture."),
    INT_(GROUP_VIEW, "height", 1, 2160, "px", "360", "Height of this client's picture."),
    ENUM_(GROUP_VIEW, "quality", 0, "\"final\"", NAMES("draft", "interactive", "high", "final"),
          "Row of the quality table that a still picture gets."),
    BOOL_(GROUP_VIEW, "adaptive", 0, "true",
          "While things move, at most interactive quality; off: always the chosen one."),
    INT_(GROUP_VIEW, "target_frame_ms", 5, 10000, "ms", "100",
         "If moving frames take longer than this, they are drawn as draft."),
    ENUM_(GROUP_VIEW, "debug_view", 0, "\"final\"",
          NAMES("final", "direct", "albedo", "normal", "roughness", "metallic", "emission", "depth",
                "ids", "lights_per_tile", "shadow_cascades", "voxel_opacity", "voxel_albedo",
                "voxel_normal", "voxel_radiance", "voxel_irradiance", "indirect_diffuse",
                "indirect_specular", "ambient_occlusion", "cache_age", "tile_classes"),
          "Which picture to show. voxel_*: debug_level and debug_face, dimmed where another face "
          "stands in. cache_age: green up to date, yellow light to be gathered anew, red traced "
          "through old geometry, light blue light of another level, blue never traced. "
          "tile_classes: green matte, blue glossy, cyan transparent, yellow emissive, magenta "
          "several."),
    INT_(GROUP_VIEW, "debug_level", 0, 8, "", "0",
         "Which cube or mip level the voxel pictures show; 0 is the finest."),
    ENUM_(GROUP_VIEW, "debug_face", 0, "\"+x\"", NAMES("+x", "-x", "+y", "-y", "+z", "-z"),
          "Which direction of the voxels the voxel pictures show."),
    BOOL_(GROUP_VIEW, "paused", 0, "false", "No frames while true."),
    STRING_(GROUP_VIEW, "rung",
            "Rung of this client's newest measurement of accuracy to draw its pictures with, "
            "whatever the shared settings are; empty: with those."),

    VEC3_(GROUP_CAMERA, "eye", 0, MAX_POSITION_M, 0.1, "m", "[0,0,5]",
          "World position of the eye."),
    VEC3_(GROUP_CAMERA, "target", 0, MAX_POSITION_M, 0.1, "m", "[0,0,0]",
          "World point in the middle of the picture; not the eye."),
    VEC3_(GROUP_CAMERA, "up", PARAMETER_NONZERO, 1.0, 0.01, "", "[0,1,0]",
          "World direction towards the picture's top; any length but zero."),
    FLOAT_(GROUP_CAMERA, "fov_y_rad", 0.01, 3.0, 0.01, "rad", "0.785398",
           "Vertical field of view."),
};

size_t parameter_count(void)
{
    return sizeof(parameters) / sizeof(parameters[0]);
}

const struct parameter *parameter_at(size_t index)
{
    return &parameters[index];
}

const struct parameter *parameter_find(enum parameter_group group, const char *name)
{
    for (size_t i = 0; i < parameter_count(); i++) {
        if (parameters[i].group == group && strcmp(parameters[i].name, name) == 0)
            return &parameters[i];
    }
    return NULL;
}

uint32_t parameter_component_count(enum parameter_type type)
{
    switch (type) {
    case PARAMETER_STRING:
        return 0;
    case PARAMETER_VEC3:
    case PARAMETER_COLOR:
        return 3;
    case PARAMETER_COLOR_ALPHA:
    case PARAMETER_QUATERNION:
        return 4;
    default:
        return 1;
    }
}

uint32_t parameter_value_count(const struct parameter *parameter)
{
    uint32_t count = 0;
    while (parameter->values && parameter->values[count])
        count++;
    return count;
}

static bool has_range(const struct parameter *parameter)
{
    return parameter->min < parameter->max;
}

static cJSON *parameter_to_json(const struct parameter *parameter)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddStringToObject(object, "group", parameter_group_names[parameter->group]);
    cJSON_AddStringToObject(object, "name", parameter->name);
    cJSON_AddStringToObject(object, "type", parameter_type_names[parameter->type]);
    if (has_range(parameter)) {
        cJSON_AddNumberToObject(object, "min", parameter->min);
        cJSON_AddNumberToObject(object, "max", parameter->max);
        cJSON_AddNumberToObject(object, "step", parameter->step);
    }
    cJSON_AddStringToObject(object, "unit", parameter->unit);
    cJSON_AddItemToObject(object, "default", cJSON_Parse(parameter->fallback));
    if (parameter->values)
        cJSON_AddItemToObject(
            object, "values",
            cJSON_CreateStringArray(parameter->values, (int)parameter_value_count(parameter)));
    cJSON_AddBoolToObject(object, "live", parameter->flags & PARAMETER_LIVE);
    cJSON_AddStringToObject(object, "doc", parameter->doc);
    return object;
}

cJSON *parameters_to_json(void)
{
    cJSON *array = cJSON_CreateArray();
    for (size_t i = 0; i < parameter_count(); i++)
        cJSON_AddItemToArray(array, parameter_to_json(&parameters[i]));
    return array;
}

static void write_range(const struct parameter *parameter, char *out, size_t size)
{
    size_t used = 0;
    out[0] = '\0';
    if (has_range(parameter))
        snprintf(out, size, "%g to %g", parameter->min, parameter->max);
    for (uint32_t i = 0; i < parameter_value_count(parameter) && used < size; i++)
        used +=
            (size_t)snprintf(out + used, size - used, "%s%s", i ? ", " : "", parameter->values[i]);
}

int parameter_write_markdown_row(const struct parameter *parameter, char *out, size_t size)
{
    char range[512];
    write_range(parameter, range, sizeof(range));
    return snprintf(out, size, "| %s | %s | %s | %s | %s | `%s` | %s | %s |",
                    parameter_group_names[parameter->group], parameter->name,
                    parameter_type_names[parameter->type], range, parameter->unit,
                    parameter->fallback, parameter->flags & PARAMETER_LIVE ? "live" : "",
                    parameter->doc);
}
