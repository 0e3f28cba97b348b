// The frame's uniforms and small functions for all passes.
#include "shared/frame_block.h"
#include "shared/slots.h"
#include "shared/work_groups.h"

layout(std140, binding = BIND_FRAME) uniform frame_uniforms
{
    frame_block frame;
};

// A member for each setting of protocol/parameters/settings.def; booleans are 0 or 1.
layout(std140, binding = BIND_SETTINGS) uniform settings_uniforms{SETTINGS_MEMBERS} settings;

const float PI = 3.14159265358979;

// Through the pixel's centre; the component along the camera's forward direction is 1.
vec3 ray_direction(vec2 pixel)
{
    return frame.ray_corner + (pixel.x + 0.5) * frame.ray_dx + (pixel.y + 0.5) * frame.ray_dy;
}

// Reversed, infinite Z: depth = near / distance along the forward direction.
float view_distance(float depth)
{
    return frame.near_m / depth;
}

float luminance(vec3 color)
{
    return dot(color, vec3(0.2126, 0.7152, 0.0722));
}

// Unit vector of any v, however long or short: squares of its components may leave the range of
// floats. Returns `fallback` if v is 0 or not finite.
vec3 safe_normalize(vec3 v, vec3 fallback)
{
    vec3 size = abs(v);
    float largest = max(size.x, max(size.y, size.z));
    vec3 scaled = v * (1.0 / largest);
    float squared = dot(scaled, scaled); // 1 to 3
    return largest > 1e-37 && squared <= 3.0001 ? scaled * inversesqrt(squared) : fallback;
}

// Octahedral unit vectors (Cigolle et al. 2014, "A Survey of Efficient Representations for
// Independent Unit Vectors").
vec2 octahedral_encode(vec3 n)
{
    vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    if (n.z < 0.0)
        p = (1.0 - abs(p.yx)) * vec2(p.x >= 0.0 ? 1.0 : -1.0, p.y >= 0.0 ? 1.0 : -1.0);
    return p;
}

vec3 octahedral_decode(vec2 p)
{
    vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
    if (n.z < 0.0)
        n.xy = (1.0 - abs(n.yx)) * vec2(n.x >= 0.0 ? 1.0 : -1.0, n.y >= 0.0 ? 1.0 : -1.0);
    return normalize(n);
}

// Orthonormal frame about n (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
mat3 frame_about(vec3 n)
{
    float turn = n.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (turn + n.z);
    float b = n.x * n.y * a;
    return mat3(vec3(1.0 + turn * n.x * n.x * a, turn * b, -turn * n.x),
                vec3(b, turn + n.y * n.y * a, -n.y), n);
}
