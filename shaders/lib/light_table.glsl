// Punctual and area lights as the scene's tables hold them.
#include "lib/scene_tables.glsl"
#include "shared/area_light_block.h"
#include "shared/light_block.h"

light_shadow unpack_shadow(uvec4 words)
{
    return light_shadow(words.x, words.y, words.z, words.w);
}

light_block load_light(uint number)
{
    uint at = frame.first_light + 5u * number;
    uvec4 position = table_words(at);
    vec4 direction = table_floats(at + 1u);
    vec4 intensity = table_floats(at + 2u);
    vec4 spot = table_floats(at + 3u);
    light_block light;
    light.position = uintBitsToFloat(position.xyz);
    light.type = position.w;
    light.direction = direction.xyz;
    light.range_m = direction.w;
    light.intensity = intensity.rgb;
    light.radius_m = intensity.w;
    light.cone_scale = spot.x;
    light.cone_offset = spot.y;
    light.cos_outer_cone = spot.z;
    light.shadow = unpack_shadow(table_words(at + 4u));
    return light;
}

area_light_block load_area_light(uint number)
{
    uint at = frame.first_area_light + 8u * number;
    vec4 radiance = table_floats(at + 4u);
    uvec4 center = table_words(at + 5u);
    uvec4 normal = table_words(at + 6u);
    area_light_block light;
    for (uint i = 0u; i < 4u; i++)
        light.corners[i] = table_floats(at + i);
    light.radiance = radiance.rgb;
    light.area_m2 = radiance.a;
    light.center = uintBitsToFloat(center.xyz);
    light.in_voxels = center.w;
    light.normal = uintBitsToFloat(normal.xyz);
    light.two_sided = normal.w;
    light.shadow = unpack_shadow(table_words(at + 7u));
    return light;
}
