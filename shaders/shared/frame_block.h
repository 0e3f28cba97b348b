// One frame of one view, in C and GLSL; std140.
#ifndef VOXCAST_SHADERS_SHARED_FRAME_BLOCK_H
#define VOXCAST_SHADERS_SHARED_FRAME_BLOCK_H

#include "shared/types.h"

#define MAX_CASCADES 3

// Minimum distance between a light and a lit point, as a fraction of the scene's diagonal and in
// metres; the smaller applies. Bounds the inverse square.
#define LIGHT_MIN_DISTANCE_FRACTION 1e-4f
#define LIGHT_MIN_DISTANCE_M        1e-3f

// Maps (u, v, depth) in the sun's view of the whole scene to a cascade.
struct cascade_block {
    vec3 scale;
    float layer; // of the shadow map
    vec3 offset;
    float unused;
};

struct frame_block {
    mat4 clip_from_world;
    vec3 eye;               // world
    float near_m;           // near plane's distance
    vec3 forward;           // unit
    float scene_diagonal_m; // of the scene's bounds
    vec3 ray_corner; // direction through the top left corner of pixel (0, 0); forward component 1
    float ray_min_offset_m;       // how far rays start off their surface
    vec3 ray_dx;                  // added per pixel to the right
    float light_min_distance2;    // squared minimum distance of punctual lights, m^2
    vec3 ray_dy;                  // added per pixel downwards
    float shadow_near_m;          // near plane of the perspective shadow views
    vec3 bvh_origin;              // world: origin of positions in the BVH
    float specular_max_roughness; // rougher surfaces get no specular trace
    uvec2 render_size;            // rendered: width, height
    uvec2 tile_count;             // light tiles: columns, rows
    uvec2 output_size;            // output: width, height
    uint luma_pitch_bytes;        // of rows of Y
    uint chroma_pitch_bytes;      // of rows of Cb and Cr
    uint light_count;             // punctual lights
    uint area_light_count;
    uint light_mask_words; // words per tile
    uint cascade_count;
    uint debug_view;
    uint debug_level;     // voxel level of the debug view
    uint debug_face;      // voxel face of the debug view
    uint all_blinn_phong; // 1: shade every material as Blinn-Phong
    uint shadow_tap_count;
    uint sun_shadow_view; // shadow view of the whole scene
    float exposure_scale; // 0: automatic
    float exposure_bias;
    float environment_intensity;
    float environment_rotation_rad; // about +Y
    float texture_max_anisotropy;   // maximum samples per look-up
    float texture_dither_levels;    // 1: samplers read one mip level, so dither it
    uint first_instance;            // texels of the scene's tables
    uint first_id_block;
    uint first_material;
    uint first_texture;
    uint first_light;
    uint first_area_light;
    uint environment_texel;
    uint unused_0;
    BLOCK_STRUCT(cascade_block) cascades[MAX_CASCADES]; // of the view, smallest first
};

#ifdef __STDC__
BLOCK_SIZE(frame_block, 18 + 2 * MAX_CASCADES);
#endif

#endif
