// Materials and their textures as in glTF 2.0 and its KHR_materials_* extensions. COLOR_CLASSES,
// DATA_CLASSES: number of texture arrays (one per size) of sRGB and of linear images;
// TEXTURE_TRANSFORMS: whether any texture has a transform; SECOND_UV_SET: whether any texture uses
// the second set of texture coordinates.
#include "lib/material_table.glsl"
#include "shared/texture_block.h"

// From the frame's quality, unless the shader overrides it.
#ifndef TEXTURE_ANISOTROPY
#define TEXTURE_ANISOTROPY frame.texture_max_anisotropy
#endif

#define TEXTURED (COLOR_CLASSES + DATA_CLASSES > 0)

#if TEXTURED
#if COLOR_CLASSES > 0
layout(binding = UNIT_COLOR_CLASSES) uniform sampler2DArray color_classes[COLOR_CLASSES];
#endif
#if DATA_CLASSES > 0
layout(binding = UNIT_DATA_CLASSES) uniform sampler2DArray data_classes[DATA_CLASSES];
#endif

// Texture coordinates of both sets and their differentials to the right and down.
#if SECOND_UV_SET
#define UV_VECTOR vec4
#else
#define UV_VECTOR vec2
#endif
struct texture_point {
    UV_VECTOR uv;
    UV_VECTOR dx;
    UV_VECTOR dy;
    float level_dither; // added to the mip level
};

const float MAX_FOOTPRINT_TEXELS = 1e7;

float wrap_coordinate(float u, uint mode, float edge)
{
    if (mode == 0u)
        return u; // the sampler repeats
    if (mode == 2u)
        u = abs(mod(u + 1.0, 2.0) - 1.0);
    float half_texel = 0.5 / edge;
    return clamp(u, half_texel, 1.0 - half_texel);
}

// A software renderer executes both sides of every branch, so colour and data textures have
// separate functions: each loops over the classes of its own colour space only.
#if COLOR_CLASSES > 0
vec4 sample_color_class(uint class_number, vec3 at, float lod)
{
#if COLOR_CLASSES > 1
    if (class_number == 1u)
        return textureLod(color_classes[1], at, lod);
#endif
#if COLOR_CLASSES > 2
    if (class_number == 2u)
        return textureLod(color_classes[2], at, lod);
#endif
#if COLOR_CLASSES > 3
    if (class_number == 3u)
        return textureLod(color_classes[3], at, lod);
#endif
#if COLOR_CLASSES > 4
    if (class_number == 4u)
        return textureLod(color_classes[4], at, lod);
#endif
    return textureLod(color_classes[0], at, lod);
}
#endif

#if DATA_CLASSES > 0
vec4 sample_data_class(uint class_number, vec3 at, float lod)
{
#if DATA_CLASSES > 1
    if (class_number == 1u)
        return textureLod(data_classes[1], at, lod);
#endif
#if DATA_CLASSES > 2
    if (class_number == 2u)
        return textureLod(data_classes[2], at, lod);
#endif
#if DATA_CLASSES > 3
    if (class_number == 3u)
        return textureLod(data_classes[3], at, lod);
#endif
#if DATA_CLASSES > 4
    if (class_number == 4u)
        return textureLod(data_classes[4], at, lod);
#endif
    return textureLod(data_classes[0], at, lod);
}
#endif

// Where samplers read one level only, dithers the level, so that levels blend on average as they
// would trilinearly. Interleaved gradient noise (Jimenez 2014, "Next Generation Post Processing in
// Call of Duty: Advanced Warfare").
float dither_level(vec2 pixel)
{
    float noise = fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715))));
    return frame.texture_dither_levels * (noise - 0.5);
}

// Sampling footprint: position in the texture, longer axis, level and number of samples along the
// axis.
struct footprint {
    uint class_number;
    vec3 at; // z: layer
    vec2 axis;
    float lod;
    float samples;
};

// Anisotropic filtering: trilinear samples along the longer axis of the pixel's footprint, at the
// level that fits the shorter one (as EXT_texture_filter_anisotropic describes). Done here because
// the loops of software samplers grow without bound with the gradients.
void set_filter(inout footprint f, vec2 dx, vec2 dy, float level_dither, float edge)
{
    float length_x = length(dx) * edge;
    float length_y = length(dy) * edge;
    f.axis = length_x > length_y ? dx : dy;
    float major = max(max(length_x, length_y), 1e-6);
    // Gradients of triangles seen edge-on can have any value.
    if (!(major < MAX_FOOTPRINT_TEXELS)) {
        f.axis = vec2(0.0);
        f.lod = log2(edge);
        f.samples = 1.0;
        return;
    }
    float minor = max(min(length_x, length_y), major / TEXTURE_ANISOTROPY);
    f.lod = log2(minor) + level_dither;
    f.samples = clamp(ceil(major / max(minor, 1.0)), 1.0, TEXTURE_ANISOTROPY);
}

footprint find_footprint(uint texture_number, texture_point point)
{
    uint record = frame.first_texture + 3u * texture_number;
    uint bits = table_words(record + 2u).x;
    vec2 at = point.uv.xy;
    vec2 dx = point.dx.xy;
    vec2 dy = point.dy.xy;
#if SECOND_UV_SET
    bool second = (bits & TEXTURE_UV_SET_1) != 0u;
    at = second ? point.uv.zw : at;
    dx = second ? point.dx.zw : dx;
    dy = second ? point.dy.zw : dy;
#endif
#if TEXTURE_TRANSFORMS
    vec3 row_u = table_floats(record).xyz;
    vec3 row_v = table_floats(record + 1u).xyz;
    at = vec2(dot(row_u, vec3(at, 1.0)), dot(row_v, vec3(at, 1.0)));
    dx = vec2(dot(row_u.xy, dx), dot(row_v.xy, dx));
    dy = vec2(dot(row_u.xy, dy), dot(row_v.xy, dy));
#endif
    footprint f;
    float edge = float(1u << ((bits >> TEXTURE_EDGE_BIT) & 15u));
    f.class_number = (bits >> TEXTURE_CLASS_BIT) & 15u;
    set_filter(f, dx, dy, point.level_dither, edge);
    if ((bits & TEXTURE_NEAREST) != 0u && f.lod < 0.0)
        at = (floor(at * edge) + 0.5) / edge;
    at.x = wrap_coordinate(at.x, (bits >> TEXTURE_WRAP_U_BIT) & 3u, edge);
    at.y = wrap_coordinate(at.y, (bits >> TEXTURE_WRAP_V_BIT) & 3u, edge);
    // Large texture coordinates lose their fraction in the sampler's fixed point: keep them small.
    at -= floor(at * (1.0 / 64.0)) * 64.0;
    f.at = vec3(at, float(bits >> TEXTURE_LAYER_BIT));
    return f;
}

#if COLOR_CLASSES > 0
vec4 sample_color(uint texture_number, texture_point point)
{
    footprint f = find_footprint(texture_number, point);
    vec4 sum = vec4(0.0);
    float i = 0.5;
    do {
        sum += sample_color_class(f.class_number, f.at + vec3(f.axis * (i / f.samples - 0.5), 0.0),
                                  f.lod);
    } while ((i += 1.0) < f.samples);
    return sum / f.samples;
}
#endif

#if DATA_CLASSES > 0
vec4 sample_data(uint texture_number, texture_point point)
{
    footprint f = find_footprint(texture_number, point);
    vec4 sum = vec4(0.0);
    float i = 0.5;
    do {
        sum += sample_data_class(f.class_number, f.at + vec3(f.axis * (i / f.samples - 0.5), 0.0),
                                 f.lod);
    } while ((i += 1.0) < f.samples);
    return sum / f.samples;
}
#endif
#endif
