// Whether a surface reflects sharply and strongly enough to need a specular trace; others use the
// cached irradiance. Both limits come from the quality level.
#include "lib/surface.glsl"
#include "lib/voxel.glsl"

bool needs_specular_trace(surface s)
{
    float f0 = mix(max(s.f0.r, max(s.f0.g, s.f0.b)), 1.0, s.metallic);
    return s.roughness < voxels.specular_max_roughness && (s.metallic > 0.0 || s.f90 > 0.0) &&
           f0 >= voxels.specular_min_reflectance;
}
