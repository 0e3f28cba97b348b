// The environment: spherical harmonics for diffuse light, images prefiltered by roughness for
// specular light, and the background.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/gpu_scene/gpu_scene.h"
#include "renderer/scene/scene.h"
#include "shared/environment_block.h"

#define LEVEL_COUNT     6u
#define LEVEL_EDGE      64u
#define LEVEL_SAMPLES   96u
#define SH_SAMPLE_ROWS  64u
#define MAX_RADIANCE    60000.0f // limit of RGBA16F texels, before intensity
#define BRDF_EDGE       ((uint32_t)ENVIRONMENT_BRDF_EDGE)
#define BRDF_SAMPLES    256u
#define BRDF_MIN_COSINE 1e-3f

static bool has_image(const struct scene_environment *environment)
{
    return environment->type == SCENE_ENVIRONMENT_EQUIRECT && environment->image;
}

// Radiance about a direction, of an unrotated environment of intensity 1. An image is averaged over
// the solid angle, so that no small and bright light falls between two samples.
static void sample_environment(const struct scene_environment *environment, const float d[3],
                               float solid_angle, float out_color[3])
{
    switch (environment->type) {
    case SCENE_ENVIRONMENT_EQUIRECT:
        if (environment->image)
            environment_image_sample(environment->image, d, solid_angle, out_color);
        else
            memset(out_color, 0, 3 * sizeof(float));
        return;
    case SCENE_ENVIRONMENT_GRADIENT:
        for (int c = 0; c < 3; c++) {
            float pole = d[1] >= 0.0f ? environment->color[c] : environment->ground_color[c];
            out_color[c] = environment->horizon_color[c] +
                           (pole - environment->horizon_color[c]) * fabsf(d[1]);
        }
        return;
    case SCENE_ENVIRONMENT_CONSTANT:
        memcpy(out_color, environment->color, 3 * sizeof(float));
        return;
    default:
        memset(out_color, 0, 3 * sizeof(float));
    }
}

static void add_harmonics(const float d[3], const float color[3], double solid_angle,
                          double sums[9][3])
{
    const double basis[9] = {
        0.282095,
        0.488603 * d[1],
        0.488603 * d[2],
        0.488603 * d[0],
        1.092548 * d[0] * d[1],
        1.092548 * d[1] * d[2],
        0.315392 * (3.0 * d[2] * d[2] - 1.0),
        1.092548 * d[0] * d[2],
        0.546274 * (d[0] * d[0] - d[1] * d[1]),
    };
    for (int i = 0; i < 9; i++)
        for (int c = 0; c < 3; c++)
            sums[i][c] += basis[i] * color[c] * solid_angle;
}

// Every texel of the finest level once, with its own solid angle.
static void sum_image(const struct environment_level *level, double sums[9][3])
{
    for (uint32_t row = 0; row < level->height; row++) {
        double top = cos(M_PI * row / level->height),
               bottom = cos(M_PI * (row + 1) / level->height);
        double angle = M_PI * (row + 0.5) / level->height;
        for (uint32_t column = 0; column < level->width; column++) {
            double phi = 2.0 * M_PI * ((column + 0.5) / level->width - 0.5);
            float d[3] = {(float)(sin(angle) * sin(phi)), (float)cos(angle),
                          (float)(-sin(angle) * cos(phi))};
            add_harmonics(d, level->pixels + 3 * ((size_t)row * level->width + column),
                          2.0 * M_PI / level->width * (top - bottom), sums);
        }
    }
}

static void sum_sky(const struct scene_environment *environment, double sums[9][3])
{
    const uint32_t rows = SH_SAMPLE_ROWS, columns = 2 * SH_SAMPLE_ROWS;
    for (uint32_t row = 0; row < rows; row++)
        for (uint32_t column = 0; column < columns; column++) {
            // Equal solid angles: y is uniform.
            float y = 1.0f - 2.0f * ((float)row + 0.5f) / (float)rows;
            float phi = 2.0f * (float)M_PI * ((float)column + 0.5f) / (float)columns;
            float r = sqrtf(fmaxf(0.0f, 1.0f - y * y));
            float d[3] = {r * cosf(phi), y, r * sinf(phi)}, color[3];
            sample_environment(environment, d, 0.0f, color);
            add_harmonics(d, color, 1.0, sums);
        }
    const double solid_angle = 4.0 * M_PI / (rows * columns);
    for (int i = 0; i < 9; i++)
        for (int c = 0; c < 3; c++)
            sums[i][c] *= solid_angle;
}

// Projects onto bands 0 to 2 and folds in the clamped cosine over pi (Ramamoorthi and Hanrahan
// 2001: A0 = pi, A1 = 2 pi / 3, A2 = pi / 4), so that a shader only evaluates a polynomial.
static void project_harmonics(const struct scene_environment *environment, vec4 out_vectors[9])
{
    static const double polynomial[9] = {0.282095, 0.488603, 0.488603, 0.488603, 1.092548,
                                         1.092548, 0.315392, 1.092548, 0.546274};
    double sums[9][3] = {{0}};
    if (has_image(environment))
        sum_image(&environment->image->levels[0], sums);
    else
        sum_sky(environment, sums);
    for (int i = 0; i < 9; i++) {
        double lobe_over_pi = i == 0 ? 1.0 : i < 4 ? 2.0 / 3.0 : 0.25;
        for (int c = 0; c < 3; c++)
            out_vectors[i][c] = (float)(sums[i][c] * polynomial[i] * lobe_over_pi);
    }
}

static void octahedral_direction(float u, float v, float out_direction[3])
{
    float x = 2.0f * u - 1.0f, y = 2.0f * v - 1.0f;
    float z = 1.0f - fabsf(x) - fabsf(y);
    if (z < 0.0f) {
        float folded = (1.0f - fabsf(y)) * (x >= 0.0f ? 1.0f : -1.0f);
        y = (1.0f - fabsf(x)) * (y >= 0.0f ? 1.0f : -1.0f);
        x = folded;
    }
    float inverse = 1.0f / sqrtf(x * x + y * y + z * z);
    out_direction[0] = x * inverse;
    out_direction[1] = y * inverse;
    out_direction[2] = z * inverse;
}

// GGX-weighted mean around n, importance sampled with n = v (Karis 2013). A sample stands for the
// solid angle that its density leaves it (Krivanek and Colbert 2008); a mirror's for a texel's.
static void blur_direction(const struct scene_environment *environment, const float n[3],
                           float roughness, float texel_solid_angle, float out_color[3])
{
    float alpha = roughness * roughness;
    vec3 up = {0.0f, 1.0f, 0.0f}, tangent, bitangent;
    if (fabsf(n[1]) > 0.9f)
        up[0] = 1.0f, up[1] = 0.0f;
    glm_vec3_crossn(up, (float *)n, tangent);
    glm_vec3_cross((float *)n, tangent, bitangent);
    double sum[3] = {0}, weight = 0.0;
    uint32_t samples = roughness > 0.0f ? LEVEL_SAMPLES : 1;
    for (uint32_t i = 0; i < samples; i++) {
        float e1 = ((float)i + 0.5f) / (float)samples;
        float e2 = fmodf((float)i * 0.618034f, 1.0f);
        float cosine2 = (1.0f - e1) / (1.0f + (alpha * alpha - 1.0f) * e1);
        float cosine = samples > 1 ? sqrtf(cosine2) : 1.0f;
        float sine = sqrtf(fmaxf(0.0f, 1.0f - cosine * cosine));
        float a = sine * cosf(2.0f * (float)M_PI * e2), b = sine * sinf(2.0f * (float)M_PI * e2);
        float l[3], color[3];
        for (int c = 0; c < 3; c++) {
            float h = a * tangent[c] + b * bitangent[c] + cosine * n[c];
            l[c] = 2.0f * cosine * h - n[c];
        }
        float n_l = l[0] * n[0] + l[1] * n[1] + l[2] * n[2];
        if (n_l <= 0.0f)
            continue;
        float spread = 1.0f + (alpha * alpha - 1.0f) * cosine2;
        float solid_angle =
            samples > 1 ? 4.0f * (float)M_PI * spread * spread / ((float)samples * alpha * alpha)
                        : texel_solid_angle;
        sample_environment(environment, l, fmaxf(solid_angle, texel_solid_angle), color);
        for (int c = 0; c < 3; c++)
            sum[c] += color[c] * n_l;
        weight += n_l;
    }
    for (int c = 0; c < 3; c++)
        out_color[c] = fminf((float)(sum[c] / weight), MAX_RADIANCE);
}

// Integral of the GGX lobe of `shaders/lib/brdf.glsl` over all light directions, split into scale
// and bias of F0 for Schlick's Fresnel; samples half vectors by importance.
static void integrate_brdf(float roughness, float n_v, float out_scale_bias[2])
{
    float a2 = fmaxf(powf(roughness, 4.0f), 1e-6f), sine_v = sqrtf(1.0f - n_v * n_v);
    double scale = 0.0, bias = 0.0;
    for (uint32_t i = 0; i < BRDF_SAMPLES; i++) {
        float e1 = ((float)i + 0.5f) / (float)BRDF_SAMPLES;
        float e2 = fmodf((float)i * 0.618034f, 1.0f);
        float n_h = sqrtf((1.0f - e1) / (1.0f + (a2 - 1.0f) * e1));
        float sine_h = sqrtf(fmaxf(0.0f, 1.0f - n_h * n_h));
        float v_h = sine_v * sine_h * cosf(2.0f * (float)M_PI * e2) + n_v * n_h;
        float n_l = 2.0f * v_h * n_h - n_v;
        if (n_l <= 0.0f || v_h <= 0.0f)
            continue;
        float l = n_v * sqrtf(n_l * n_l * (1.0f - a2) + a2);
        float v = n_l * sqrtf(n_v * n_v * (1.0f - a2) + a2);
        float fraction = 0.5f / (l + v) * 4.0f * n_l * v_h / n_h;
        float fresnel = powf(1.0f - fminf(v_h, 1.0f), 5.0f);
        scale += fraction * (1.0f - fresnel);
        bias += fraction * fresnel;
    }
    out_scale_bias[0] = (float)(scale / BRDF_SAMPLES);
    out_scale_bias[1] = (float)(bias / BRDF_SAMPLES);
}

// Fills the table of `shaders/shared/environment_block.h`.
static void tabulate_brdf(vec4 *nodes)
{
    for (uint32_t i = 0; i < BRDF_EDGE * BRDF_EDGE; i++) {
        uint32_t column = i % BRDF_EDGE;
        float roughness = (float)(i / BRDF_EDGE) / (float)(BRDF_EDGE - 1);
        float root = (float)column / (float)(BRDF_EDGE - 1);
        integrate_brdf(roughness, fmaxf(root * root, BRDF_MIN_COSINE), nodes[i]);
        if (column > 0)
            memcpy(nodes[i - 1] + 2, nodes[i], 2 * sizeof(float));
    }
}

static bool upload_levels(struct gpu_scene *gpu_scene, const struct scene_environment *environment)
{
    // A constant or smooth sky needs no more than a few texels.
    bool pictured = has_image(environment);
    bool any = environment->type != SCENE_ENVIRONMENT_NONE;
    uint32_t edge = pictured ? LEVEL_EDGE : any ? 16 : 1;
    gpu_texture_destroy(&gpu_scene->environment_levels);
    gpu_scene->environment_levels =
        gpu_texture_create(gpu_scene->gpu, &(struct gpu_texture_params){
                                               .label = "environment",
                                               .format = GPU_FORMAT_RGBA16F,
                                               .width = edge,
                                               .height = edge,
                                               .layers = LEVEL_COUNT,
                                               .filter = GPU_FILTER_LINEAR,
                                           });
    float *texels = calloc((size_t)edge * edge, 4 * sizeof(float));
    bool done = gpu_scene->environment_levels && texels;
    for (uint32_t level = 0; done && level < LEVEL_COUNT; level++) {
        for (uint32_t i = 0; any && i < edge * edge; i++) {
            float n[3];
            uint32_t row = i / edge;
            octahedral_direction(((float)(i % edge) + 0.5f) / (float)edge,
                                 ((float)row + 0.5f) / (float)edge, n);
            blur_direction(environment, n, (float)level / (LEVEL_COUNT - 1),
                           4.0f * (float)M_PI / (float)(edge * edge), texels + 4 * i);
        }
        gpu_texture_write(gpu_scene->environment_levels, 0, level, texels);
    }
    free(texels);
    return done;
}

static bool upload_background(struct gpu_scene *gpu_scene,
                              const struct scene_environment *environment)
{
    bool pictured = has_image(environment);
    uint32_t width = pictured ? environment->image->width : 1;
    uint32_t height = pictured ? environment->image->height : 1;
    gpu_texture_destroy(&gpu_scene->environment_background);
    gpu_scene->environment_background =
        gpu_texture_create(gpu_scene->gpu, &(struct gpu_texture_params){
                                               .label = "environment",
                                               .format = GPU_FORMAT_RGBA16F,
                                               .width = width,
                                               .height = height,
                                               .filter = GPU_FILTER_LINEAR,
                                               .repeat_u = true,
                                           });
    float *texels = calloc((size_t)width * height, 4 * sizeof(float));
    bool done = gpu_scene->environment_background && texels;
    for (size_t i = 0; done && pictured && i < (size_t)width * height; i++)
        for (int c = 0; c < 3; c++)
            texels[4 * i + (size_t)c] =
                fminf(environment->image->pixels[3 * i + (size_t)c], MAX_RADIANCE);
    if (done)
        gpu_texture_write(gpu_scene->environment_background, 0, 0, texels);
    free(texels);
    return done;
}

static bool same_pictures(const struct gpu_scene *gpu_scene)
{
    const struct scene_environment *a = &gpu_scene->environment_seen;
    const struct scene_environment *b = &gpu_scene->scene->environment;
    uint64_t serial = has_image(b) ? b->image->serial : 0;
    return a->type == b->type && gpu_scene->environment_serial == serial &&
           memcmp(a->color, b->color, sizeof(a->color)) == 0 &&
           memcmp(a->horizon_color, b->horizon_color, sizeof(a->horizon_color)) == 0 &&
           memcmp(a->ground_color, b->ground_color, sizeof(a->ground_color)) == 0;
}

bool gpu_scene_upload_environment(struct gpu_scene *gpu_scene)
{
    const struct scene_environment *environment = &gpu_scene->scene->environment;
    struct environment_block block = {0};
    if (environment->type != SCENE_ENVIRONMENT_NONE)
        project_harmonics(environment, block.irradiance_sh);
    tabulate_brdf(block.brdf_nodes); // reflections from voxels and rays need it, too
    block.equirectangular = environment->type == SCENE_ENVIRONMENT_EQUIRECT;
    block.level_count = (float)LEVEL_COUNT;
    bool gradient = environment->type == SCENE_ENVIRONMENT_GRADIENT;
    for (int c = 0; c < 3 && environment->type != SCENE_ENVIRONMENT_NONE; c++) {
        block.zenith[c] = environment->color[c];
        block.horizon[c] = gradient ? environment->horizon_color[c] : environment->color[c];
        block.ground[c] = gradient ? environment->ground_color[c] : environment->color[c];
    }
    if (!scene_tables_write(&gpu_scene->tables, TABLE_ENVIRONMENT, &block, sizeof(block)))
        return false;
    // Intensity and rotation are uniforms: the images need not be made again for them.
    if (gpu_scene->environment_levels && same_pictures(gpu_scene))
        return true;
    if (!upload_levels(gpu_scene, environment) || !upload_background(gpu_scene, environment))
        return false;
    gpu_scene->environment_seen = *environment;
    gpu_scene->environment_serial = has_image(environment) ? environment->image->serial : 0;
    return true;
}
