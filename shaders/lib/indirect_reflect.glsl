// Reflects indirect irradiance. The occlusion map applies only here: it stands for detail that
// neither shadow maps nor voxels resolve.
#include "lib/environment.glsl"
#include "lib/specular_classify.glsl"

// `light`: irradiance / pi / the volume's scale, and ambient visibility. Returns radiance in
// cd/m^2.
vec3 reflect_irradiance(surface s, vec4 light)
{
    vec3 reflectance = s.base_color;
#if SPECULAR
    float n_v = clamp(dot(s.normal, s.view), 0.0, 1.0);
    vec2 scale_bias = environment_brdf(s.roughness, n_v);
    reflectance = s.base_color * ((1.0 - s.metallic) * mean_diffuse_fraction(s, n_v));
#if INDIRECT_SPECULAR
    vec3 f0 = mix(s.f0, s.base_color, s.metallic);
    float f90 = mix(s.f90, 1.0, s.metallic);
    if (!needs_specular_trace(s))
        reflectance += f0 * scale_bias.x + f90 * scale_bias.y;
#endif
#endif
#if FILTERED
    float open = 1.0; // rays trace occlusion themselves
#else
    float open = s.occlusion;
#endif
#if AMBIENT_OCCLUSION
    open *= light.a;
#endif
    return reflectance * light.rgb * (open * voxels.radiance_scale * settings.indirect_intensity);
}
