// The view's radiance in cd/m^2; fp32 covers 1 cd seen from 1 km and a light at 1 cm.
#include "lib/frame.glsl"

layout(std430, binding = BIND_RADIANCE) buffer radiance_storage
{
    vec4 radiance[];
};
