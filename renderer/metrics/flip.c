#include "renderer/metrics/flip.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/metrics/display.h"

#define PI 3.14159265358979f

// Constants of the 2020 paper.
#define COLOR_EXPONENT   0.7f   // q_c
#define COLOR_KNEE       0.4f   // p_c, as a fraction of the largest colour difference
#define COLOR_KNEE_ERROR 0.95f  // p_t, the error at the knee
#define FEATURE_EXPONENT 0.5f   // q_f
#define FEATURE_DEGREES  0.082f // width of the feature detectors

// Contrast sensitivity as sums of Gaussians: a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees.
#define ACHROMATIC_B   0.0047f
#define RED_GREEN_B    0.0053f
#define BLUE_YELLOW_A1 34.1f
#define BLUE_YELLOW_B1 0.04f
#define BLUE_YELLOW_A2 13.5f
#define BLUE_YELLOW_B2 0.025f
#define WIDEST_B       0.04f
#define MAX_RADIUS     256

// A one-dimensional filter; `taps` runs from -radius to radius.
struct kernel {
    int radius;
    float taps[2 * MAX_RADIUS + 1];
};

// Filters for one pixel density.
struct flip_kernels {
    struct kernel achromatic, red_green, blue_yellow[2];
    float blue_yellow_weights[2];
    struct kernel blur, edge, point; // of the feature detectors
};

// Planes of an image during the comparison, width x height floats each.
enum plane {
    PLANE_Y, // of YCxCz before filtering, later L*
    PLANE_X, // then Hunt-adjusted a*
    PLANE_Z, // then Hunt-adjusted b*
    PLANE_EDGE,
    PLANE_POINT,
    PLANE_COUNT
};

struct flip_image {
    uint32_t width, height;
    float *planes[PLANE_COUNT];
    float *scratch[3];
    float *row; // one row, edge pixels repeated
};

// Rec.709 to CIE XYZ, and back.
static const float xyz_from_rgb[3][3] = {{0.4123908f, 0.3575843f, 0.1804808f},
                                         {0.2126390f, 0.7151687f, 0.0721923f},
                                         {0.0193308f, 0.1191948f, 0.9505322f}};
static const float rgb_from_xyz[3][3] = {{3.2409699f, -1.5373832f, -0.4986108f},
                                         {-0.9692436f, 1.8759675f, 0.0415551f},
                                         {0.0556301f, -0.2039770f, 1.0569715f}};
static const float white_xyz[3] = {0.9504559f, 1.0f, 1.0890578f};

static void transform(const float matrix[3][3], const float in[3], float out[3])
{
    for (int row = 0; row < 3; row++)
        out[row] = matrix[row][0] * in[0] + matrix[row][1] * in[1] + matrix[row][2] * in[2];
}

static float lab_curve(float t)
{
    const float delta = 6.0f / 29.0f;
    return t > delta * delta * delta ? cbrtf(t) : t / (3.0f * delta * delta) + 4.0f / 29.0f;
}

// L*, and a* and b* scaled by L* / 100 (Hunt 2004: colours look less saturated in the dark).
static void hunt_lab_from_rgb(const float rgb[3], float out_lab[3])
{
    float xyz[3], f[3];
    transform(xyz_from_rgb, rgb, xyz);
    for (int c = 0; c < 3; c++)
        f[c] = lab_curve(xyz[c] / white_xyz[c]);
    out_lab[0] = 116.0f * f[1] - 16.0f;
    out_lab[1] = 0.01f * out_lab[0] * 500.0f * (f[0] - f[1]);
    out_lab[2] = 0.01f * out_lab[0] * 200.0f * (f[1] - f[2]);
}

// HyAB (Abasi, Tehran and Fairchild 2020): city-block in lightness, Euclidean in chroma.
static float hyab(const float a[3], const float b[3])
{
    return fabsf(a[0] - b[0]) + hypotf(a[1] - b[1], a[2] - b[2]);
}

static float largest_color_difference(void)
{
    static const float green[3] = {0.0f, 1.0f, 0.0f}, blue[3] = {0.0f, 0.0f, 1.0f};
    float a[3], b[3];
    hunt_lab_from_rgb(green, a);
    hunt_lab_from_rgb(blue, b);
    return powf(hyab(a, b), COLOR_EXPONENT);
}

static int clamp_radius(float radius)
{
    return (int)fminf(fmaxf(ceilf(radius), 1.0f), (float)MAX_RADIUS);
}

// exp(-pi^2 x^2 / b), normalised; returns the sum before normalisation.
static float gaussian_kernel(struct kernel *kernel, int radius, float b, float pixels_per_degree)
{
    float sum = 0.0f;
    kernel->radius = radius;
    for (int i = -radius; i <= radius; i++) {
        float x = (float)i / pixels_per_degree;
        kernel->taps[i + radius] = expf(-PI * PI * x * x / b);
        sum += kernel->taps[i + radius];
    }
    for (int i = 0; i <= 2 * radius; i++)
        kernel->taps[i] /= sum;
    return sum;
}

// Scales positive taps to sum 1 and negative ones to sum -1.
static void normalize_detector(struct kernel *kernel)
{
    float positive = 0.0f, negative = 0.0f;
    for (int i = 0; i <= 2 * kernel->radius; i++)
        if (kernel->taps[i] > 0.0f)
            positive += kernel->taps[i];
        else
            negative -= kernel->taps[i];
    for (int i = 0; i <= 2 * kernel->radius; i++)
        kernel->taps[i] /= kernel->taps[i] > 0.0f ? positive : negative > 0.0f ? negative : 1.0f;
}

static void make_kernels(struct flip_kernels *kernels, float pixels_per_degree)
{
    int radius = clamp_radius(3.0f * sqrtf(WIDEST_B / (2.0f * PI * PI)) * pixels_per_degree);
    gaussian_kernel(&kernels->achromatic, radius, ACHROMATIC_B, pixels_per_degree);
    gaussian_kernel(&kernels->red_green, radius, RED_GREEN_B, pixels_per_degree);
    // Sum of two 2D filters, each of which is separable.
    const float amplitudes[2] = {BLUE_YELLOW_A1 * sqrtf(PI / BLUE_YELLOW_B1),
                                 BLUE_YELLOW_A2 * sqrtf(PI / BLUE_YELLOW_B2)};
    const float widths[2] = {BLUE_YELLOW_B1, BLUE_YELLOW_B2};
    float total = 0.0f;
    for (int i = 0; i < 2; i++) {
        float sum = gaussian_kernel(&kernels->blue_yellow[i], radius, widths[i], pixels_per_degree);
        kernels->blue_yellow_weights[i] = amplitudes[i] * sum * sum;
        total += kernels->blue_yellow_weights[i];
    }
    for (int i = 0; i < 2; i++)
        kernels->blue_yellow_weights[i] /= total;
    float deviation = 0.5f * FEATURE_DEGREES * pixels_per_degree;
    radius = clamp_radius(3.0f * deviation);
    kernels->blur.radius = kernels->edge.radius = kernels->point.radius = radius;
    float sum = 0.0f;
    for (int i = -radius; i <= radius; i++) {
        float x = (float)i, squared = x * x / (deviation * deviation);
        float weight = expf(-0.5f * squared);
        sum += weight;
        kernels->blur.taps[i + radius] = weight;
        kernels->edge.taps[i + radius] = -x * weight;
        kernels->point.taps[i + radius] = (squared - 1.0f) * weight;
    }
    for (int i = 0; i <= 2 * radius; i++)
        kernels->blur.taps[i] /= sum;
    normalize_detector(&kernels->edge);
    normalize_detector(&kernels->point);
}

static int clamp_index(int index, int count)
{
    return index < 0 ? 0 : index >= count ? count - 1 : index;
}

// Filters along rows and repeats edge pixels. `out` must not be `in`.
static void filter_rows(const struct flip_image *image, const struct kernel *kernel,
                        const float *in, float *out)
{
    int width = (int)image->width, radius = kernel->radius;
    for (uint32_t y = 0; y < image->height; y++, in += width, out += width) {
        for (int x = -radius; x < width + radius; x++)
            image->row[x + radius] = in[clamp_index(x, width)];
        memset(out, 0, (size_t)width * sizeof(float));
        for (int i = 0; i <= 2 * radius; i++) {
            const float tap = kernel->taps[i], *from = image->row + i;
            for (int x = 0; x < width; x++)
                out[x] += tap * from[x];
        }
    }
}

static void filter_columns(const struct flip_image *image, const struct kernel *kernel,
                           const float *in, float *out)
{
    int width = (int)image->width, height = (int)image->height, radius = kernel->radius;
    for (int y = 0; y < height; y++, out += width) {
        memset(out, 0, (size_t)width * sizeof(float));
        for (int i = 0; i <= 2 * radius; i++) {
            const float tap = kernel->taps[i];
            const float *from = in + (size_t)clamp_index(y + i - radius, height) * (size_t)width;
            for (int x = 0; x < width; x++)
                out[x] += tap * from[x];
        }
    }
}

// Filters a plane in place with a separable kernel.
static void filter_plane(const struct flip_image *image, const struct kernel *kernel, float *plane)
{
    filter_rows(image, kernel, plane, image->scratch[0]);
    filter_columns(image, kernel, image->scratch[0], plane);
}

// Magnitude of one detector's responses along both axes, on the lightness in `normalized`.
static void detect(const struct flip_image *image, const struct kernel *blur,
                   const struct kernel *detector, const float *normalized, float *out)
{
    size_t count = (size_t)image->width * image->height;
    float *along_y = image->scratch[1];
    filter_rows(image, detector, normalized, image->scratch[0]);
    filter_columns(image, blur, image->scratch[0], out);
    filter_rows(image, blur, normalized, image->scratch[0]);
    filter_columns(image, detector, image->scratch[0], along_y);
    for (size_t i = 0; i < count; i++)
        out[i] = hypotf(out[i], along_y[i]);
}

static bool flip_image_init(struct flip_image *image, uint32_t width, uint32_t height)
{
    size_t count = (size_t)width * height;
    *image = (struct flip_image){.width = width, .height = height};
    bool done = true;
    for (int i = 0; i < PLANE_COUNT; i++) {
        image->planes[i] = malloc(count * sizeof(float));
        done = done && image->planes[i];
    }
    for (int i = 0; i < 3; i++) {
        image->scratch[i] = malloc(count * sizeof(float));
        done = done && image->scratch[i];
    }
    image->row = malloc((width + 2 * MAX_RADIUS) * sizeof(float));
    return done && image->row;
}

static void flip_image_finish(struct flip_image *image)
{
    for (int i = 0; i < PLANE_COUNT; i++)
        free(image->planes[i]);
    for (int i = 0; i < 3; i++)
        free(image->scratch[i]);
    free(image->row);
}

// Linear RGB 0..1 to filtered Hunt-adjusted L*a*b* and features.
static void analyze(struct flip_image *image, const struct flip_kernels *kernels,
                    const struct picture *picture)
{
    size_t count = picture_pixel_count(picture);
    float *y = image->planes[PLANE_Y], *cx = image->planes[PLANE_X], *cz = image->planes[PLANE_Z];
    float *normalized = image->scratch[2];
    for (size_t i = 0; i < count; i++) {
        float xyz[3];
        transform(xyz_from_rgb, picture->rgb + 3 * i, xyz);
        for (int c = 0; c < 3; c++)
            xyz[c] /= white_xyz[c];
        normalized[i] = xyz[1];
        y[i] = 116.0f * xyz[1] - 16.0f;
        cx[i] = 500.0f * (xyz[0] - xyz[1]);
        cz[i] = 200.0f * (xyz[1] - xyz[2]);
    }
    detect(image, &kernels->blur, &kernels->edge, normalized, image->planes[PLANE_EDGE]);
    detect(image, &kernels->blur, &kernels->point, normalized, image->planes[PLANE_POINT]);
    filter_plane(image, &kernels->achromatic, y);
    filter_plane(image, &kernels->red_green, cx);
    memcpy(image->scratch[1], cz, count * sizeof(float));
    filter_plane(image, &kernels->blue_yellow[0], cz);
    filter_plane(image, &kernels->blue_yellow[1], image->scratch[1]);
    for (size_t i = 0; i < count; i++) {
        float blue_yellow = kernels->blue_yellow_weights[0] * cz[i] +
                            kernels->blue_yellow_weights[1] * image->scratch[1][i];
        float luminance = (y[i] + 16.0f) / 116.0f;
        const float xyz[3] = {(luminance + cx[i] / 500.0f) * white_xyz[0], luminance,
                              (luminance - blue_yellow / 200.0f) * white_xyz[2]};
        float rgb[3], lab[3];
        transform(rgb_from_xyz, xyz, rgb);
        for (int c = 0; c < 3; c++)
            rgb[c] = fminf(fmaxf(rgb[c], 0.0f), 1.0f);
        hunt_lab_from_rgb(rgb, lab);
        y[i] = lab[0];
        cx[i] = lab[1];
        cz[i] = lab[2];
    }
}

// Compares linear images; raises the map to the errors that exceed it.
static void raise_errors(struct flip_image images[2], const struct flip_kernels *kernels,
                         const struct picture pictures[2], float *map)
{
    const float largest = largest_color_difference(), knee = COLOR_KNEE * largest;
    size_t count = picture_pixel_count(&pictures[0]);
    for (int k = 0; k < 2; k++)
        analyze(&images[k], kernels, &pictures[k]);
    for (size_t i = 0; i < count; i++) {
        float lab[2][3], edge[2], point[2];
        for (int k = 0; k < 2; k++) {
            for (int c = 0; c < 3; c++)
                lab[k][c] = images[k].planes[PLANE_Y + c][i];
            edge[k] = images[k].planes[PLANE_EDGE][i];
            point[k] = images[k].planes[PLANE_POINT][i];
        }
        float color = powf(hyab(lab[0], lab[1]), COLOR_EXPONENT);
        color = color < knee ? color * COLOR_KNEE_ERROR / knee
                             : COLOR_KNEE_ERROR +
                                   (color - knee) / (largest - knee) * (1.0f - COLOR_KNEE_ERROR);
        float feature = fmaxf(fabsf(edge[0] - edge[1]), fabsf(point[0] - point[1]));
        feature = powf(fminf(feature * 0.70710678f, 1.0f), FEATURE_EXPONENT);
        float error = powf(fminf(color, 1.0f), 1.0f - feature);
        // Avoids 0 to the power 0, which is 1, where nothing differs.
        map[i] = fmaxf(map[i], color > 0.0f ? error : 0.0f);
    }
}

// Buffers of both comparisons.
struct flip_work {
    struct flip_image images[2];
    struct picture pictures[2]; // linear 0..1
    struct flip_kernels *kernels;
};

static void flip_work_finish(struct flip_work *work)
{
    for (int k = 0; k < 2; k++) {
        flip_image_finish(&work->images[k]);
        picture_finish(&work->pictures[k]);
    }
    free(work->kernels);
}

static bool flip_work_init(struct flip_work *work, const struct picture *like,
                           float pixels_per_degree)
{
    *work = (struct flip_work){.kernels = malloc(sizeof(*work->kernels))};
    bool done = work->kernels != NULL;
    for (int k = 0; k < 2; k++)
        done = done && flip_image_init(&work->images[k], like->width, like->height) &&
               picture_init(&work->pictures[k], like->width, like->height);
    if (done)
        make_kernels(work->kernels, pixels_per_degree);
    else
        flip_work_finish(work);
    return done;
}

bool flip_ldr(const struct picture *test, const struct picture *reference, float pixels_per_degree,
              float *out_map)
{
    const struct picture *sources[2] = {test, reference};
    struct flip_work work;
    if (!flip_work_init(&work, reference, pixels_per_degree))
        return false;
    size_t count = picture_pixel_count(reference);
    for (int k = 0; k < 2; k++)
        for (size_t i = 0; i < 3 * count; i++)
            work.pictures[k].rgb[i] =
                display_linear_from_srgb(fminf(fmaxf(sources[k]->rgb[i], 0.0f), 1.0f));
    memset(out_map, 0, count * sizeof(float));
    raise_errors(work.images, work.kernels, work.pictures, out_map);
    flip_work_finish(&work);
    return true;
}

static float luminance_at(const struct picture *picture, size_t pixel)
{
    const float *rgb = picture->rgb + 3 * pixel;
    float value = 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2];
    return isfinite(value) ? fmaxf(value, 0.0f) : 0.0f;
}

static int compare_floats(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

// Tone curve of HDR-FLIP: ACES in Narkowicz's fit, at 0.6 of the radiance.
static float shown(float radiance)
{
    float x = 0.6f * fminf(radiance, 1e9f);
    return fminf((x * (2.51f * x + 0.03f)) / (x * (2.43f * x + 0.59f) + 0.14f), 1.0f);
}

struct flip_exposures flip_find_exposures(const struct picture *reference)
{
    // The curve's input for 0.85: the positive root of a quadratic equation.
    const float t = 0.85f;
    const float a = 0.36f * (2.51f - t * 2.43f), b = 0.6f * (0.03f - t * 0.59f), c = -t * 0.14f;
    const float bright = (-b + sqrtf(b * b - 4.0f * a * c)) / (2.0f * a);
    size_t count = picture_pixel_count(reference), lit = 0;
    float *luminances = malloc(count * sizeof(float));
    if (!luminances)
        return (struct flip_exposures){0.0f, 0.0f, 1};
    for (size_t i = 0; i < count; i++) {
        luminances[i] = luminance_at(reference, i);
        lit += luminances[i] > 0.0f;
    }
    qsort(luminances, count, sizeof(float), compare_floats);
    float highest = luminances[count - 1];
    // If half of the image is black, the median of the rest.
    float median = luminances[count / 2] > 0.0f ? luminances[count / 2]
                   : lit > 0                    ? luminances[count - lit + lit / 2]
                                                : 0.0f;
    free(luminances);
    if (!(median > 0.0f))
        return (struct flip_exposures){0.0f, 0.0f, 1};
    struct flip_exposures exposures = {log2f(bright / highest), log2f(bright / median), 2};
    float stops = ceilf(exposures.stop_stops - exposures.start_stops);
    if (stops > 2.0f)
        exposures.count = (uint32_t)fminf(stops, (float)FLIP_MAX_EXPOSURES);
    return exposures;
}

bool flip_hdr(const struct picture *test, const struct picture *reference,
              const struct flip_exposures *exposures, float pixels_per_degree, float *out_map)
{
    const struct picture *sources[2] = {test, reference};
    struct flip_work work;
    if (!flip_work_init(&work, reference, pixels_per_degree))
        return false;
    size_t count = picture_pixel_count(reference);
    memset(out_map, 0, count * sizeof(float));
    float step = exposures->count > 1 ? (exposures->stop_stops - exposures->start_stops) /
                                            (float)(exposures->count - 1)
                                      : 0.0f;
    for (uint32_t e = 0; e < exposures->count; e++) {
        float scale = exp2f(exposures->start_stops + (float)e * step);
        for (int k = 0; k < 2; k++)
            for (size_t i = 0; i < 3 * count; i++) {
                float value = sources[k]->rgb[i];
                work.pictures[k].rgb[i] =
                    isfinite(value) ? shown(fmaxf(value, 0.0f) * scale) : 0.0f;
            }
        raise_errors(work.images, work.kernels, work.pictures, out_map);
    }
    flip_work_finish(&work);
    return true;
}
