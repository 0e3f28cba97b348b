// The view's radiance in cd/m^2; fp32 covers 1 cd seen from 1 km and a light at 1 cm.
#include "lib/frame.glsl"

layout(std430, binding = BIND_RADIANCE) writeonly buffer radiance_storage
{
    vec4 radiance[];
};

layout(binding = UNIT_RADIANCE) uniform samplerBuffer radiance_texels;

// What earlier passes have written.
vec3 former_radiance(uint index)
{
    return texelFetch(radiance_texels, int(index)).rgb;
}
