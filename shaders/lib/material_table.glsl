// Materials as the scene's tables hold them.
#include "lib/scene_tables.glsl"
#include "shared/material_block.h"

material_block load_material(uint number)
{
    uint at = frame.first_material + 8u * number;
    vec4 emission = table_floats(at + 1u);
    vec4 surface = table_floats(at + 2u);
    vec4 dielectric = table_floats(at + 3u);
    vec4 specular = table_floats(at + 4u);
    vec4 attenuation = table_floats(at + 5u);
    vec4 means = table_floats(at + 6u);
    uvec4 words = table_words(at + 7u);
    material_block m;
    m.base_color = table_floats(at);
    m.emission = emission.rgb;
    m.alpha_cutoff = emission.a;
    m.metallic = surface.x;
    m.roughness = surface.y;
    m.normal_scale = surface.z;
    m.occlusion_strength = surface.w;
    m.f0 = dielectric.x;
    m.specular = dielectric.y;
    m.transmission = dielectric.z;
    m.thickness_m = dielectric.w;
    m.specular_color = specular.rgb;
    m.attenuation_distance_m = specular.a;
    m.attenuation_color = attenuation.rgb;
    m.ior = attenuation.a;
    m.mean_metallic = means.x;
    m.mean_roughness = means.y;
    m.flags = words.x;
    m.first_texture = words.y;
    m.texture_mask = words.z;
    return m;
}
