// Places vertices. In: position (local, metres), instance id, texture coordinates. Out: clip space.
#include "lib/frame.glsl"

layout(location = 0) in vec3 position_local;
layout(location = 1) in uint instance;
layout(location = 2) in vec4 uv;

layout(std430, binding = BIND_INSTANCES) readonly buffer instance_storage
{
    instance_block instances[];
};

layout(location = 0) flat out uint fragment_instance;
#if ALPHA_MASK
layout(location = 1) out vec4 fragment_uv;
layout(location = 2) out float fragment_alpha;
layout(std430, binding = BIND_VERTICES) readonly buffer vertex_storage
{
    float vertices[];
};
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
    vec4 position_world = instances[instance].world_from_local * vec4(position_local, 1.0);
#if SHADOW_VIEW
    gl_Position = shadow_views[shadow_view].clip_from_world * position_world;
#else
    gl_Position = frame.clip_from_world * position_world;
#endif
    fragment_instance = instance;
#if ALPHA_MASK
    fragment_uv = uv;
    fragment_alpha = vertices[uint(gl_VertexID) * VERTEX_WORDS + 17u];
#endif
}
