// One frame of one view, for C and GLSL; std140.
#ifndef VOXCAST_SHADERS_SHARED_FRAME_BLOCK_H
#define VOXCAST_SHADERS_SHARED_FRAME_BLOCK_H

#include "shared/types.h"

#define MAX_CASCADES 3

// A light is never nearer to what it lights than this fraction of the scene's diagonal, nor than so
// many metres where that is less: its light would have no end.
#define LIGHT_MIN_DISTANCE_FRACTION 1e-4f
#define LIGHT_MIN_DISTANCE_M        1e-3f

// From (u, v, depth) in the sun's view of the whole scene to a cascade.
struct cascade_block {
    vec3 scale;
    float layer; // of the shadow map
    vec3 offset;
    float unused;
};

struct frame_block {
    mat4 clip_from_world;
    vec3 eye;               // world
    float near_m;           // distance of the near plane
    vec3 forward;           // unit
    float scene_diagonal_m; // of the scene's bounds
    vec3 ray_corner;        // direction through the top left corner of pixel (0, 0), forward part 1
    float ray_min_offset_m; // of rays from the surface they start at
    vec3 ray_dx;            // added per pixel to the right
    float light_min_distance2;    // square of the least distance of punctual lights, m^2
    vec3 ray_dy;                  // added per pixel downwards
    float shadow_near_m;          // near plane of the perspective shadow views
    vec3 bvh_origin;              // world: where positions in the BVH count from
    float specular_max_roughness; // rougher surfaces have no specular trace of their own
    uvec2 render_size;            // pixels that are drawn: width, height
    uvec2 tile_count;             // light tiles across and down
    uvec2 output_size;            // pixels that are shown: width, height
    uint luma_pitch_bytes;        // of rows of Y
    uint chroma_pitch_bytes;      // of rows of Cb and of Cr
    uint light_count;             // punctual
    uint area_light_count;
    uint light_mask_words; // of a tile
    uint cascade_count;
    uint debug_view;
    uint debug_level;     // of the voxels that it shows
    uint debug_face;      // likewise
    uint all_blinn_phong; // 1: every material is to be Blinn-Phong
    uint shadow_tap_count;
    uint sun_shadow_view; // of the whole scene
    uint tonemap;
    float gamma;          // 0: the sRGB curve
    float exposure_scale; // 0: automatic
    float exposure_bias;
    float environment_intensity;
    float environment_rotation_rad; // about +Y
    float texture_max_anisotropy;   // samples of a look-up at most
    float texture_dither_levels;    // 1 where samplers read one level only and want dithering
    float unused_0;
    float unused_1;
    BLOCK_STRUCT(cascade_block) cascades[MAX_CASCADES]; // of the view, smallest first
};

#ifdef __STDC__
BLOCK_SIZE(frame_block, 17 + 2 * MAX_CASCADES);
#endif

#endif
