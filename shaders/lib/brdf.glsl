// BRDFs. Cook-Torrance with GGX as glTF 2.0, appendix B: Trowbridge-Reitz distribution,
// height-correlated Smith visibility (Heitz 2014), Schlick Fresnel. Blinn-Phong normalised by (n +
// 8) / 8 pi (Akenine-Moeller et al., Real-Time Rendering). SPECULAR 0: every material is matte, so
// only base colour / pi is compiled.
#include "lib/surface.glsl"

// Below this a point light's highlight is narrower than any pixel; keeps D finite.
const float MIN_ALPHA = 1e-3;

float alpha_of(surface s)
{
    return max(s.roughness * s.roughness, MIN_ALPHA);
}

float distribution_ggx(float n_h, float alpha)
{
    float a2 = alpha * alpha;
    float d = n_h * n_h * (a2 - 1.0) + 1.0;
    return a2 / (PI * d * d);
}

float visibility_smith(float n_l, float n_v, float alpha)
{
    float a2 = alpha * alpha;
    float l = n_v * sqrt(n_l * n_l * (1.0 - a2) + a2);
    float v = n_l * sqrt(n_v * n_v * (1.0 - a2) + a2);
    return 0.5 / max(l + v, 1e-7);
}

vec3 fresnel_schlick(vec3 f0, vec3 f90, float v_h)
{
    float m = clamp(1.0 - v_h, 0.0, 1.0);
    float m2 = m * m;
    return f0 + (f90 - f0) * (m2 * m2 * m);
}

// Fraction that the dielectric layer transmits to the diffuse base.
vec3 diffuse_reflectance(surface s, float v_h)
{
#if !SPECULAR
    return s.base_color;
#endif
    vec3 reflected = fresnel_schlick(s.f0, vec3(s.f90), v_h);
    float kept = 1.0 - max(reflected.r, max(reflected.g, reflected.b));
    return s.base_color * ((1.0 - s.metallic) * kept);
}

// The same for uniform light: the mean over the cosine-weighted hemisphere, in which Schlick's (1 -
// v.h)^5 is far smaller than for the mirror direction at grazing view. Polynomial fit of the
// integral, error at most 1e-5.
float mean_diffuse_fraction(surface s, float n_v)
{
    float rise = 0.02821 + n_v * (-0.07998 + n_v * (0.08657 + n_v * (-0.04368 + n_v * 0.00897)));
    vec3 reflected = mix(s.f0, vec3(s.f90), rise);
    return 1.0 - max(reflected.r, max(reflected.g, reflected.b));
}

// Mean specular albedo under uniform light: scale of F0 and of F90. Fit of the integral of
// single-scattering GGX over both hemispheres, error at most 0.004.
vec2 mean_specular_albedo(float roughness)
{
    float r = clamp(roughness, 0.0, 1.0);
    return vec2(0.95256 + r * (-0.05103 + r * (0.73159 + r * (-2.73923 + r * 1.51419))),
                0.04703 + r * (0.04186 + r * (-0.41643 + r * (0.55171 - r * 0.22164))));
}

vec3 specular_fresnel(surface s, float v_h)
{
    return mix(fresnel_schlick(s.f0, vec3(s.f90), v_h),
               fresnel_schlick(s.base_color, vec3(1.0), v_h), s.metallic);
}

// Specular BRDF times the cosine for light from direction `l` (unit, towards the light).
vec3 specular_brdf_cosine(surface s, vec3 l, float alpha)
{
    vec3 h = safe_normalize(l + s.view, s.normal);
    float n_l = dot(s.normal, l);
    float n_v = max(dot(s.normal, s.view), 1e-4);
    float n_h = clamp(dot(s.normal, h), 0.0, 1.0);
    float v_h = clamp(dot(s.view, h), 0.0, 1.0);
    if (n_l <= 0.0)
        return vec3(0.0);
#if BLINN_PHONG
    if (s.shading == SHADE_BLINN_PHONG || frame.all_blinn_phong != 0u) {
        float exponent = clamp(2.0 / (alpha * alpha) - 2.0, 1.0, 16384.0);
        return specular_fresnel(s, v_h) *
               ((exponent + 8.0) / (8.0 * PI) * pow(n_h, exponent) * n_l);
    }
#endif
    return specular_fresnel(s, v_h) *
           (distribution_ggx(n_h, alpha) * visibility_smith(n_l, n_v, alpha) * n_l);
}

// BRDF times the cosine, per steradian.
vec3 brdf_cosine(surface s, vec3 l)
{
    float n_l = dot(s.normal, l);
    if (n_l <= 0.0)
        return vec3(0.0);
#if SPECULAR
    vec3 h = safe_normalize(l + s.view, s.normal);
    float v_h = clamp(dot(s.view, h), 0.0, 1.0);
    return diffuse_reflectance(s, v_h) * (n_l / PI) + specular_brdf_cosine(s, l, alpha_of(s));
#else
    return s.base_color * (n_l / PI);
#endif
}
