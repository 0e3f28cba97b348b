// Transforms vertices. In: position (local, metres), texture coordinates, the draw's record. Out:
// clip space.
#include "shared/slots.h"
#include "shared/vertex.h"

layout(location = 0) in vec3 position_local;
layout(location = 1) in vec4 uv;
layout(location = 2) in vec4 clip_row_x;
layout(location = 3) in vec4 clip_row_y;
layout(location = 4) in vec4 clip_row_z;
layout(location = 5) in vec4 clip_row_w;
layout(location = 6) in float alpha;
layout(location = 7) in uint triangle; // of the primitive, if this vertex is the first
layout(location = 8) in uvec2 numbers; // first visibility id, material

layout(location = 0) flat out uvec2 fragment_numbers; // visibility id, material
#if ALPHA_MASK
layout(location = 1) out vec4 fragment_uv;
layout(location = 2) out float fragment_alpha;
#endif

void main()
{
    vec4 local = vec4(position_local, 1.0);
    gl_Position = vec4(dot(clip_row_x, local), dot(clip_row_y, local), dot(clip_row_z, local),
                       dot(clip_row_w, local));
    fragment_numbers = uvec2(numbers.x + triangle, numbers.y);
#if ALPHA_MASK
    fragment_uv = uv;
    fragment_alpha = alpha;
#endif
}
