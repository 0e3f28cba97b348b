// A material, in C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_MATERIAL_BLOCK_H
#define VOXCAST_SHADERS_SHARED_MATERIAL_BLOCK_H

#include "shared/shading_model.h"
#include "shared/types.h"

// Flags of a material.
#define MATERIAL_SHADING_MASK 3u
#define MATERIAL_ALPHA_MASK   8u
#define MATERIAL_ALPHA_BLEND  16u
#define MATERIAL_DOUBLE_SIDED 32u
#define MATERIAL_IOR_ONE      64u // IOR 1: no dielectric reflection at any angle

#define TEXTURE_SLOTS              8
#define TEXTURE_BASE_COLOR         0u
#define TEXTURE_METALLIC_ROUGHNESS 1u
#define TEXTURE_NORMAL             2u
#define TEXTURE_OCCLUSION          3u
#define TEXTURE_EMISSIVE           4u
#define TEXTURE_TRANSMISSION       5u
#define TEXTURE_SPECULAR           6u
#define TEXTURE_SPECULAR_COLOR     7u

#define COLOR_TEXTURE_SLOTS 0x91u // base colour, emissive, specular colour

struct material_block {
    vec4 base_color;
    vec3 emission; // cd/m^2
    float alpha_cutoff;
    float metallic;
    float roughness;
    float normal_scale;
    float occlusion_strength;
    float f0; // reflectance at normal incidence, from the IOR
    float specular;
    float transmission;
    float thickness_m;
    vec3 specular_color;
    float attenuation_distance_m; // 0: none
    vec3 attenuation_color;
    float ior;
    float mean_metallic; // including its texture's mean
    float mean_roughness;
    float unused_0;
    float unused_1;
    uint flags;
    uint first_texture;
    uint texture_mask; // a bit per slot in use
    uint unused_2;
};

#ifdef __STDC__
BLOCK_SIZE(material_block, 8);
#endif

#endif
