#include "renderer/reference/path_brdf.h"

#include "renderer/scene/vector3.h"

// The renderer's: narrower lobes are taken as this wide.
#define MIN_ALPHA       1e-3
#define MIN_VIEW_COSINE 1e-4

struct axes {
    double x[3], y[3];
    const double *z;
};

static double largest_of(const double rgb[3])
{
    return fmax(rgb[0], fmax(rgb[1], rgb[2]));
}

static void normalize(double vector[3])
{
    double length = vector3_length(vector);
    for (int axis = 0; axis < 3; axis++)
        vector[axis] /= length > 0.0 ? length : 1.0;
}

// A basis without branches at the poles (Duff et al. 2017, "Building an Orthonormal Basis,
// Revisited").
static struct axes axes_about(const double n[3])
{
    double sign = copysign(1.0, n[2]);
    double a = -1.0 / (sign + n[2]), b = n[0] * n[1] * a;
    return (struct axes){.x = {1.0 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]},
                         .y = {b, sign + n[1] * n[1] * a, -n[1]},
                         .z = n};
}

static void to_world(const struct axes *axes, const double local[3], double out_world[3])
{
    for (int i = 0; i < 3; i++)
        out_world[i] = local[0] * axes->x[i] + local[1] * axes->y[i] + local[2] * axes->z[i];
}

static double schlick(double f0, double f90, double cosine)
{
    return f0 + (f90 - f0) * pow(fmin(fmax(1.0 - cosine, 0.0), 1.0), 5.0);
}

static bool is_matte(const struct path_surface *surface)
{
    return surface->metallic == 0.0 && surface->f90 == 0.0 && largest_of(surface->f0) == 0.0;
}

static double alpha_of(const struct path_surface *surface)
{
    return fmax(surface->roughness * surface->roughness, MIN_ALPHA);
}

static double view_cosine(const struct path_surface *surface)
{
    return fmax(vector3_dot(surface->normal, surface->view), MIN_VIEW_COSINE);
}

// Probability of following the GGX lobe: its share of what is reflected, roughly.
static double gloss_probability(const struct path_surface *surface)
{
    if (is_matte(surface))
        return 0.0;
    double specular = 0.0, diffuse = 0.0, cosine = view_cosine(surface);
    for (int c = 0; c < 3; c++) {
        double dielectric = schlick(surface->f0[c], surface->f90, cosine);
        specular += dielectric +
                    (schlick(surface->base_color[c], 1.0, cosine) - dielectric) * surface->metallic;
        diffuse += surface->base_color[c] * (1.0 - surface->metallic);
    }
    return diffuse > 0.0 ? fmin(fmax(specular / (specular + diffuse), 0.1), 0.9) : 1.0;
}

// Smith's function of one direction for GGX (Heitz 2014), by the cosine with the normal.
static double smith_lambda(double cosine, double alpha)
{
    double tangent_squared = (1.0 - cosine * cosine) / (cosine * cosine);
    return 0.5 * (sqrt(1.0 + alpha * alpha * tangent_squared) - 1.0);
}

static void add_gloss(const struct path_surface *surface, const double half[3], double n_l,
                      double v_h, struct path_reflection *reflection)
{
    double alpha = alpha_of(surface), a2 = alpha * alpha, n_v = view_cosine(surface);
    double n_h = fmin(fmax(vector3_dot(surface->normal, half), 0.0), 1.0);
    double d = n_h * n_h * (a2 - 1.0) + 1.0;
    double distribution = a2 / (M_PI * d * d);
    double lambda_v = smith_lambda(n_v, alpha), lambda_l = smith_lambda(n_l, alpha);
    // Height-correlated masking and shadowing over 4 n.l n.v, times n.l.
    double lobe = distribution / (1.0 + lambda_v + lambda_l) / (4.0 * n_v);
    for (int c = 0; c < 3; c++) {
        double dielectric = schlick(surface->f0[c], surface->f90, v_h);
        double metal = schlick(surface->base_color[c], 1.0, v_h);
        reflection->share[c] += lobe * (dielectric + (metal - dielectric) * surface->metallic);
    }
    // Visible normals only: their density over 4 v.h.
    reflection->density +=
        gloss_probability(surface) * distribution / (1.0 + lambda_v) / (4.0 * n_v);
}

bool path_brdf_evaluate(const struct path_surface *surface, const double direction[3],
                        struct path_reflection *out_reflection)
{
    *out_reflection = (struct path_reflection){0};
    double n_l = vector3_dot(surface->normal, direction);
    if (!(n_l > 0.0) || vector3_dot(surface->geometric_normal, direction) <= 0.0)
        return false;
    double half[3], reflected[3];
    for (int axis = 0; axis < 3; axis++)
        half[axis] = direction[axis] + surface->view[axis];
    normalize(half);
    double v_h = fmin(fmax(vector3_dot(surface->view, half), 0.0), 1.0);
    for (int c = 0; c < 3; c++)
        reflected[c] = schlick(surface->f0[c], surface->f90, v_h);
    double kept = 1.0 - largest_of(reflected);
    for (int c = 0; c < 3; c++)
        out_reflection->share[c] =
            surface->base_color[c] * (1.0 - surface->metallic) * kept * n_l / M_PI;
    out_reflection->density = (1.0 - gloss_probability(surface)) * n_l / M_PI;
    if (!is_matte(surface))
        add_gloss(surface, half, n_l, v_h, out_reflection);
    return true;
}

// A normal of the microsurface as the viewer sees it (Heitz 2018, "Sampling the GGX Distribution of
// Visible Normals").
static void sample_half(const struct path_surface *surface, const struct axes *axes,
                        const double u[2], double out_half[3])
{
    double alpha = alpha_of(surface);
    double view[3] = {alpha * vector3_dot(surface->view, axes->x),
                      alpha * vector3_dot(surface->view, axes->y), view_cosine(surface)};
    normalize(view);
    struct axes about = axes_about(view);
    double radius = sqrt(u[0]), angle = 2.0 * M_PI * u[1], side = 0.5 * (1.0 + view[2]);
    // The basis is not aligned with the horizon as Heitz's is: align it.
    double flat = sqrt(view[0] * view[0] + view[1] * view[1]);
    if (flat > 0.0) {
        const double across[3] = {-view[1] / flat, view[0] / flat, 0.0};
        for (int axis = 0; axis < 3; axis++)
            about.x[axis] = across[axis];
        vector3_cross(about.y, view, across);
    }
    double a = radius * cos(angle), b = radius * sin(angle);
    b = (1.0 - side) * sqrt(1.0 - a * a) + side * b;
    const double local[3] = {a, b, sqrt(fmax(1.0 - a * a - b * b, 0.0))};
    double stretched[3];
    to_world(&about, local, stretched);
    stretched[0] *= alpha;
    stretched[1] *= alpha;
    stretched[2] = fmax(stretched[2], 0.0);
    normalize(stretched);
    to_world(axes, stretched, out_half);
}

bool path_brdf_sample(const struct path_surface *surface, const double u[3],
                      double out_direction[3], struct path_reflection *out_reflection)
{
    struct axes axes = axes_about(surface->normal);
    if (u[0] < gloss_probability(surface)) {
        double half[3];
        sample_half(surface, &axes, u + 1, half);
        double v_h = vector3_dot(surface->view, half);
        for (int axis = 0; axis < 3; axis++)
            out_direction[axis] = 2.0 * v_h * half[axis] - surface->view[axis];
        normalize(out_direction);
    } else {
        double radius = sqrt(u[1]), angle = 2.0 * M_PI * u[2];
        const double local[3] = {radius * cos(angle), radius * sin(angle), sqrt(1.0 - u[1])};
        to_world(&axes, local, out_direction);
    }
    return path_brdf_evaluate(surface, out_direction, out_reflection) &&
           out_reflection->density > 0.0;
}
