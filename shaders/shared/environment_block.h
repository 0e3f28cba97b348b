// The environment, unrotated and at intensity 1, in C and GLSL; std430.
#ifndef VOXCAST_SHADERS_SHARED_ENVIRONMENT_BLOCK_H
#define VOXCAST_SHADERS_SHARED_ENVIRONMENT_BLOCK_H

#include "shared/types.h"

#define ENVIRONMENT_BRDF_EDGE 16 // table nodes in roughness and in sqrt(n.v)

#define ENVIRONMENT_SH_COEFFICIENTS 9

struct environment_block {
    // Spherical harmonics of the irradiance divided by pi (Ramamoorthi and Hanrahan 2001), bands
    // 0 to 2; the fourth component is unused.
    vec4 irradiance_sh[ENVIRONMENT_SH_COEFFICIENTS];
    uint equirectangular; // 1: an equirectangular texture
    float level_count;    // of the texture prefiltered by roughness
    uint unused_1;
    uint unused_2;
    vec3 zenith; // constant or gradient colours; unused with a texture
    float unused_3;
    vec3 horizon;
    float unused_4;
    vec3 ground;
    float unused_5;
    // Directional albedo of the GGX lobe as scale and bias of F0: a row per roughness; xy at a node
    // of sqrt(n.v), zw at the next.
    vec4 brdf_nodes[ENVIRONMENT_BRDF_EDGE * ENVIRONMENT_BRDF_EDGE];
};

#ifdef __STDC__
BLOCK_SIZE(environment_block, 13 + ENVIRONMENT_BRDF_EDGE * ENVIRONMENT_BRDF_EDGE);
#endif

#endif
