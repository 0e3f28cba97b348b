#include "renderer/path_tracer/bsdf.h"

// As the renderer: lobes are at least this wide.
#define MIN_ALPHA       1e-3f
#define MIN_VIEW_COSINE 1e-4f
#define MAX_EXPONENT    16384.0f
// Minimum probability of sampling a lobe that reflects anything.
#define MIN_PROBABILITY 0.1f
#define PI              ((float)M_PI)

// Smith's lambda of one direction for GGX (Heitz 2014), from the cosine with the normal.
static float smith_lambda(float cosine, float alpha)
{
    float c2 = cosine * cosine;
    return 0.5f * (sqrtf(1.0f + alpha * alpha * (1.0f - c2) / c2) - 1.0f);
}

// Blinn-Phong exponent of a lobe about as wide.
static float exponent_of(float alpha)
{
    return min1(max1(2.0f / (alpha * alpha) - 2.0f, 1.0f), MAX_EXPONENT);
}

// Fresnel of the dielectric layer. Inside a body the refracted angle applies; total internal
// reflection where there is none.
static float3 dielectric_fresnel(const struct bsdf *bsdf, float v_h)
{
    if (bsdf->bends && bsdf->eta > 1.0f) {
        float sine2 = bsdf->eta * bsdf->eta * (1.0f - v_h * v_h);
        if (sine2 >= 1.0f)
            return splat3(1.0f);
        v_h = sqrtf(1.0f - sine2);
    }
    return schlick(bsdf->f0, splat3(bsdf->f90), v_h);
}

static float3 specular_fresnel(const struct bsdf *bsdf, float3 dielectric, float v_h)
{
    if (bsdf->metallic == 0.0f)
        return dielectric;
    float3 metal = schlick(bsdf->base_color, splat3(1.0f), v_h);
    return dielectric + (metal - dielectric) * bsdf->metallic;
}

// Lobe probabilities about proportional to what each scatters.
static void choose_probabilities(struct bsdf *bsdf, enum bsdf_lobes lobes)
{
    float3 dielectric = dielectric_fresnel(bsdf, bsdf->n_v);
    float3 through = splat3(1.0f) - dielectric;
    float specular = max1(max3(specular_fresnel(bsdf, dielectric, bsdf->n_v)), 1e-6f);
    float diffuse = max3(bsdf->diffuse) * (1.0f - max3(dielectric));
    float transmit = max3(bsdf->tint) * max3(through);
    diffuse = max3(bsdf->diffuse) > 0.0f ? max1(diffuse, 1e-6f) : 0.0f;
    transmit = max3(bsdf->tint) > 0.0f ? max1(transmit, 1e-6f) : 0.0f;
    if (lobes == BSDF_TRANSMISSION)
        specular = diffuse = 0.0f;
    float sum = specular + diffuse + transmit;
    if (!(sum > 0.0f))
        return;
    float minimum = MIN_PROBABILITY * sum;
    specular = specular > 0.0f ? max1(specular, minimum) : 0.0f;
    diffuse = diffuse > 0.0f ? max1(diffuse, minimum) : 0.0f;
    transmit = transmit > 0.0f ? max1(transmit, minimum) : 0.0f;
    float scale = 1.0f / (specular + diffuse + transmit);
    bsdf->p_specular = specular * scale;
    bsdf->p_diffuse = diffuse * scale;
    bsdf->p_transmit = transmit * scale;
}

void bsdf_init(struct bsdf *bsdf, const struct surface *surface, float eta, enum bsdf_lobes lobes)
{
    const struct material *material = surface->material;
    *bsdf = (struct bsdf){
        .normal = surface->normal,
        .geometric_normal = surface->geometric_normal,
        .view = surface->view,
        .n_v = dot3(surface->normal, surface->view),
        .alpha = max1(surface->roughness * surface->roughness, MIN_ALPHA),
        .base_color = surface->base_color,
        .f0 = surface->f0,
        .f90 = surface->f90,
        .metallic = surface->metallic,
        .eta = eta,
        .bends = material->refracts,
    };
    if (bsdf->n_v < MIN_VIEW_COSINE) {
        // Mapped normals can face away from the viewer: evaluates the lobe for the nearest valid
        // view.
        bsdf->view = normalize3(bsdf->view + bsdf->normal * (MIN_VIEW_COSINE - bsdf->n_v));
        bsdf->n_v = MIN_VIEW_COSINE;
    }
    bsdf->diffuse =
        surface->base_color * ((1.0f - surface->metallic) * (1.0f - surface->transmission));
    if (material->refracts)
        // A body tints once: where light enters, or would have entered.
        bsdf->tint =
            (surface->is_front ? surface->base_color : splat3(1.0f)) * surface->transmission;
    bool has_specular = surface->metallic > 0.0f || surface->f90 > 0.0f ||
                        max3(surface->f0) > 0.0f || material->refracts;
    if (material->blinn_phong)
        bsdf->exponent = exponent_of(bsdf->alpha);
    if (!has_specular) {
        bsdf->p_diffuse = lobes == BSDF_ALL && max3(bsdf->diffuse) > 0.0f ? 1.0f : 0.0f;
        return;
    }
    bsdf->lambda_v = smith_lambda(bsdf->n_v, bsdf->alpha);
    choose_probabilities(bsdf, lobes);
}

void bsdf_widen(struct bsdf *bsdf, float alpha)
{
    bsdf->alpha = max1(bsdf->alpha, alpha);
    bsdf->lambda_v = smith_lambda(bsdf->n_v, bsdf->alpha);
    if (bsdf->exponent > 0.0f)
        bsdf->exponent = exponent_of(bsdf->alpha);
}

// Trowbridge-Reitz, from the sine, for the precision of narrow lobes.
static float distribution(const struct bsdf *bsdf, float3 half, float n_h)
{
    float3 across = cross3(bsdf->normal, half);
    float a2 = bsdf->alpha * bsdf->alpha;
    float d = a2 * n_h * n_h + dot3(across, across);
    return a2 / (PI * d * d);
}

static void add_specular_lobe(const struct bsdf *bsdf, float3 half, float v_h, float n_l,
                              struct scattering *scattering, float3 dielectric)
{
    float n_h = clamp01(dot3(bsdf->normal, half));
    float3 fresnel = specular_fresnel(bsdf, dielectric, v_h);
    if (bsdf->exponent > 0.0f) {
        // Normalised as in Akenine-Moeller et al., Real-Time Rendering.
        float power = powf(n_h, bsdf->exponent);
        scattering->fraction += fresnel * ((bsdf->exponent + 8.0f) / (8.0f * PI) * power * n_l);
        scattering->density += bsdf->p_specular * (bsdf->exponent + 1.0f) / (2.0f * PI) * power /
                               (4.0f * max1(v_h, 1e-6f));
        return;
    }
    float d = distribution(bsdf, half, n_h) / (4.0f * bsdf->n_v);
    float lambda_l = smith_lambda(n_l, bsdf->alpha);
    // Height-correlated masking and shadowing (Heitz 2014); sampled by visible normals.
    scattering->fraction += fresnel * (d / (1.0f + bsdf->lambda_v + lambda_l));
    scattering->density += bsdf->p_specular * d / (1.0f + bsdf->lambda_v);
}

static bool evaluate_transmission(const struct bsdf *bsdf, float3 direction, float n_l,
                                  struct scattering *out_scattering)
{
    if (bsdf->p_transmit == 0.0f || n_l >= 0.0f)
        return false;
    float3 half = normalize3(-(bsdf->view * bsdf->eta + direction));
    if (dot3(half, bsdf->normal) < 0.0f)
        half = -half;
    float v_h = dot3(bsdf->view, half), l_h = dot3(direction, half);
    if (!(v_h > 0.0f && l_h < 0.0f))
        return false;
    float n_h = clamp01(dot3(bsdf->normal, half));
    float bend = bsdf->eta * v_h + l_h;
    // Density of the visible normal, times the Jacobian from normals to directions.
    float visible = distribution(bsdf, half, n_h) / (1.0f + bsdf->lambda_v) * v_h / bsdf->n_v *
                    -l_h / max1(bend * bend, 1e-20f);
    float3 kept = splat3(1.0f) - dielectric_fresnel(bsdf, v_h);
    float masking = 1.0f / (1.0f + smith_lambda(-n_l, bsdf->alpha));
    out_scattering->fraction = bsdf->tint * kept * (visible * masking);
    out_scattering->density = bsdf->p_transmit * visible;
    return true;
}

bool bsdf_evaluate(const struct bsdf *bsdf, float3 direction, struct scattering *out_scattering)
{
    *out_scattering = (struct scattering){0};
    float n_l = dot3(bsdf->normal, direction);
    if (dot3(bsdf->geometric_normal, direction) <= 0.0f)
        return evaluate_transmission(bsdf, direction, n_l, out_scattering);
    if (!(n_l > 0.0f) || bsdf->p_specular + bsdf->p_diffuse == 0.0f)
        return false;
    out_scattering->density = bsdf->p_diffuse * n_l / PI;
    out_scattering->fraction = bsdf->diffuse * (n_l / PI);
    if (bsdf->p_specular > 0.0f) {
        float3 half = normalize3(direction + bsdf->view);
        float v_h = clamp01(dot3(bsdf->view, half));
        float3 dielectric = dielectric_fresnel(bsdf, v_h);
        out_scattering->fraction *= 1.0f - max3(dielectric);
        add_specular_lobe(bsdf, half, v_h, n_l, out_scattering, dielectric);
    }
    return true;
}

// Samples a visible microfacet normal: mirror directions of a hemisphere are uniform in a cap
// (Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps").
static float3 sample_visible_normal(const struct bsdf *bsdf, float3 x, float3 y, const float u[2])
{
    float alpha = bsdf->alpha;
    float3 view =
        normalize3(make3(alpha * dot3(bsdf->view, x), alpha * dot3(bsdf->view, y), bsdf->n_v));
    float across, along;
    turn1(u[0], &across, &along);
    float z = 1.0f - u[1] * (1.0f + view[2]);
    float sine = sqrtf(clamp01(1.0f - z * z));
    float3 half = make3(sine * across, sine * along, z) + view;
    return normalize3(make3(half[0] * alpha, half[1] * alpha, max1(half[2], 1e-7f)));
}

static float3 sample_half(const struct bsdf *bsdf, const float u[2])
{
    float3 x, y, local;
    basis3(bsdf->normal, &x, &y);
    if (bsdf->exponent > 0.0f) {
        float cosine = powf(1.0f - u[1], 1.0f / (bsdf->exponent + 1.0f));
        float sine = sqrtf(clamp01(1.0f - cosine * cosine)), across, along;
        turn1(u[0], &across, &along);
        local = make3(sine * across, sine * along, cosine);
    } else {
        local = sample_visible_normal(bsdf, x, y, u);
    }
    return normalize3(x * local[0] + y * local[1] + bsdf->normal * local[2]);
}

bool bsdf_sample(const struct bsdf *bsdf, float choice, const float u[2], float3 *out_direction,
                 struct scattering *out_scattering)
{
    bool transmits = choice >= bsdf->p_diffuse + bsdf->p_specular;
    if (choice < bsdf->p_diffuse) {
        float3 x, y;
        basis3(bsdf->normal, &x, &y);
        float radius = sqrtf(u[0]), across, along;
        turn1(u[1], &across, &along);
        *out_direction =
            x * (radius * across) + y * (radius * along) + bsdf->normal * sqrtf(1.0f - u[0]);
    } else {
        float3 half = sample_half(bsdf, u);
        float v_h = dot3(bsdf->view, half);
        if (!(v_h > 0.0f))
            return false;
        if (!transmits) {
            *out_direction = normalize3(half * (2.0f * v_h) - bsdf->view);
        } else {
            float squared = 1.0f - bsdf->eta * bsdf->eta * (1.0f - v_h * v_h);
            if (squared < 0.0f)
                return false;
            *out_direction =
                normalize3(half * (bsdf->eta * v_h - sqrtf(squared)) - bsdf->view * bsdf->eta);
        }
    }
    // Microfacets of a rough surface scatter some light to the wrong side, where it is lost.
    if (transmits != (dot3(bsdf->geometric_normal, *out_direction) <= 0.0f))
        return false;
    return bsdf_evaluate(bsdf, *out_direction, out_scattering) && out_scattering->density > 0.0f;
}
