// Block structs of C and GLSL alike.
#ifndef VOXCAST_SHADERS_SHARED_BLOCKS_H
#define VOXCAST_SHADERS_SHARED_BLOCKS_H

#include "shared/bindings.h"
#include "shared/types.h"

// One frame of one view; std140.
struct frame_block {
    mat4 clip_from_world;
    vec4 eye;         // world; w: distance of the near plane
    vec4 forward;     // unit
    vec4 ray_corner;  // direction through the top left corner of pixel (0, 0), forward part 1
    vec4 ray_dx;      // added per pixel to the right
    vec4 ray_dy;      // added per pixel downwards
    uvec4 size;       // rendered width, height; light tiles across, down
    uvec4 shown;      // shown width, height; row pitches of Y and of Cb, Cr in bytes
    uvec4 lights;     // lights, area lights, words of a tile's light mask, cascades
    uvec4 options;    // debug view | its voxel level << 8 | its voxel face << 16, shadow view of
                      // the sun, shadow taps, tone map
    vec4 display;     // exposure scale (0: automatic), gamma (0: sRGB), exposure bias, 1 if all
                      // materials are to be Blinn-Phong
    vec4 environment; // intensity, rotation about +Y, diagonal of the scene in m, square
                      // of the least distance of lamps
    vec4 textures;    // most samples of an anisotropic look-up, near plane of lamps' shadow views,
                      // 1 if samplers read one level only and want dithering, roughness beyond
                      // which no surface has a reflection of its own
    vec4
        tree; // world: where places in the tree of triangles count from; w: least offset of rays, m
    // From (u, v, depth) in the sun's view of the scene to each cascade, smallest first.
    vec4 cascade_scales[MAX_CASCADES]; // w: layer of the shadow map
    vec4 cascade_offsets[MAX_CASCADES];
};

// A placed primitive: one draw.
struct instance_block {
    mat4 world_from_local;
    uvec4 info; // first index, material, first visibility id, flags
};

struct material_block {
    vec4 base_color;
    vec4 emission;          // cd/m^2; w: alpha cut-off
    vec4 surface;           // metallic, roughness, normal scale, occlusion strength
    vec4 dielectric;        // F0 from IOR, specular weight, transmission, thickness in metres
    vec4 specular_color;    // w: attenuation distance in metres, 0 none
    vec4 attenuation_color; // w: index of refraction
    vec4 means;             // metallic and roughness with the mean of their texture; unused, unused
    uvec4 info;             // flags, first texture, mask of texture slots in use, unused
};

struct texture_block {
    vec4 uv_row_u; // u' = dot(row.xyz, (u, v, 1))
    vec4 uv_row_v;
    uvec4 info; // packed as TEXTURE_* of bindings.h say; unused, unused, unused
};

struct light_block {
    vec4 position;  // world; w: type
    vec4 direction; // unit, the way that light travels; w: range in metres, 0 unlimited
    vec4 radiance;  // colour times intensity: cd or lux; w: source radius in metres
    vec4 cone;      // scale and offset of the cosine (KHR_lights_punctual), cosine of outer, unused
    uvec4 shadow;   // first shadow view or NO_SHADOW, count, light id, 1 if view cascades apply
};

// A planar emitter of up to four corners, counter-clockwise as seen from its lit side.
struct area_light_block {
    vec4 corners[4]; // world; w of the first: 1 if both sides emit
    vec4 radiance;   // cd/m^2; w: area in m^2
    vec4 center;     // w: 1 if voxels hold its light better, where there are any
    vec4 normal;     // unit
    uvec4 shadow;    // as light_block
};

struct shadow_view_block {
    mat4 clip_from_world;
    vec4 texel; // world size of a texel at distance 1 (perspective) or anywhere (directional);
                // w: 1 for perspective
    vec4 depth; // directional: world metres per unit of depth; perspective: near plane
};

#ifdef __STDC__
#define BLOCK_VECTORS(block, count)                                                                \
    static_assert(sizeof(struct block) == (count) * sizeof(vec4), #block " has no padding")
BLOCK_VECTORS(frame_block, 17 + 2 * MAX_CASCADES);
BLOCK_VECTORS(instance_block, 5);
BLOCK_VECTORS(material_block, 8);
BLOCK_VECTORS(texture_block, 3);
BLOCK_VECTORS(light_block, 5);
BLOCK_VECTORS(area_light_block, 8);
BLOCK_VECTORS(shadow_view_block, 6);
#endif

#endif
