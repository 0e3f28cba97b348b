// Places vertices. In: position (local, metres), texture coordinates, the draw's record. Out: clip
// space.
#include "lib/frame.glsl"

layout(location = 0) in vec3 position_local;
layout(location = 1) in vec4 uv;
layout(location = 2) in vec4 world_row_x;
layout(location = 3) in vec4 world_row_y;
layout(location = 4) in vec4 world_row_z;
layout(location = 5) in uvec4 numbers; // first visibility id, material, instance, -
layout(location = 6) in float alpha;
layout(location = 7) in uint triangle; // of the primitive, if this vertex is its first

layout(location = 0) flat out uvec2 fragment_numbers; // visibility id, material
#if ALPHA_MASK
layout(location = 1) out vec4 fragment_uv;
layout(location = 2) out float fragment_alpha;
#endif

#if SHADOW_VIEW
layout(std430, binding = BIND_SHADOW_VIEWS) readonly buffer shadow_view_storage
{
    shadow_view_block shadow_views[];
};
layout(location = 0) uniform uint shadow_view;
#endif

void main()
{
    vec4 local = vec4(position_local, 1.0);
    vec4 position_world =
        vec4(dot(world_row_x, local), dot(world_row_y, local), dot(world_row_z, local), 1.0);
#if SHADOW_VIEW
    gl_Position = shadow_views[shadow_view].clip_from_world * position_world;
#else
    gl_Position = frame.clip_from_world * position_world;
#endif
    fragment_numbers = uvec2(numbers.x + triangle, numbers.y);
#if ALPHA_MASK
    fragment_uv = uv;
    fragment_alpha = alpha;
#endif
}
