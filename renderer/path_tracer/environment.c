#include "renderer/path_tracer/environment.h"

#include <stdlib.h>

#define MAX_COLUMNS 512u
#define MAX_ROWS    256u
// A gradient sky varies by row only.
#define GRADIENT_ROWS 64u
// Minimum weight of a cell over the mean luminance, so that every cell is sampled.
#define MIN_WEIGHT 0.01f
// Brightest cell over the mean from which importance sampling pays.
#define UNEVEN 4.0f
#define PI     ((float)M_PI)

struct environment {
    const struct scene_environment *source;
    float sine, cosine; // of the rotation
    uint32_t columns, rows;
    float *row_ends;    // cumulative distribution
    float *column_ends; // of each row
    float *densities;   // per steradian, by cell
    bool shines, uneven;
};

static float3 picture_texel(const struct environment_image *source, int64_t column, int64_t row)
{
    int64_t width = source->width, height = source->height;
    column = ((column % width) + width) % width;
    row = row < 0 ? 0 : row >= height ? height - 1 : row;
    return load3(source->pixels + (size_t)(row * width + column) * 3);
}

static float3 picture_at(const struct environment_image *source, float3 direction)
{
    float u = 0.5f + atan2f(direction[0], -direction[2]) / (2.0f * PI);
    float v = acosf(min1(max1(direction[1], -1.0f), 1.0f)) / PI;
    float x = u * (float)source->width - 0.5f, y = v * (float)source->height - 0.5f;
    int64_t column = (int64_t)floorf(x), row = (int64_t)floorf(y);
    float across = x - floorf(x), down = y - floorf(y);
    float3 upper = picture_texel(source, column, row) * (1.0f - across) +
                   picture_texel(source, column + 1, row) * across;
    float3 lower = picture_texel(source, column, row + 1) * (1.0f - across) +
                   picture_texel(source, column + 1, row + 1) * across;
    return upper * (1.0f - down) + lower * down;
}

// Before rotation and intensity.
static float3 radiance_of(const struct scene_environment *source, float3 direction)
{
    float3 horizon = load3(source->horizon_color);
    float3 pole = load3(direction[1] >= 0.0f ? source->color : source->ground_color);
    switch (source->type) {
    case SCENE_ENVIRONMENT_EQUIRECT:
        return source->image ? picture_at(source->image, direction) : splat3(0.0f);
    case SCENE_ENVIRONMENT_GRADIENT:
        return horizon + (pole - horizon) * fabsf(direction[1]);
    case SCENE_ENVIRONMENT_CONSTANT:
        return load3(source->color);
    default:
        return splat3(0.0f);
    }
}

// Mean luminance of a cell: over its texels, or at its centre.
static float cell_luminance(const struct environment *environment, uint32_t column, uint32_t row)
{
    const struct scene_environment *source = environment->source;
    if (source->type != SCENE_ENVIRONMENT_EQUIRECT || !source->image) {
        float angle = PI * ((float)row + 0.5f) / (float)environment->rows;
        return luminance3(radiance_of(source, make3(sinf(angle), cosf(angle), 0.0f)));
    }
    const struct environment_image *image = source->image;
    uint32_t left = (uint32_t)((uint64_t)column * image->width / environment->columns);
    uint32_t right = (uint32_t)((uint64_t)(column + 1) * image->width / environment->columns);
    uint32_t top = (uint32_t)((uint64_t)row * image->height / environment->rows);
    uint32_t bottom = (uint32_t)((uint64_t)(row + 1) * image->height / environment->rows);
    float sum = 0.0f;
    for (uint32_t y = top; y < bottom; y++)
        for (uint32_t x = left; x < right; x++)
            sum += max1(luminance3(picture_texel(image, x, y)), 0.0f);
    return sum / (float)((right - left) * (bottom - top));
}

// Bilinear filtering spreads a cell's light half a texel into its neighbours.
static float spread_luminance(const struct environment *environment, const float *luminances,
                              uint32_t column, uint32_t row)
{
    uint32_t columns = environment->columns, rows = environment->rows;
    float largest = luminances[(size_t)row * columns + column];
    for (int dy = -1; dy <= 1; dy++)
        for (uint32_t dx = 0; dx < 3; dx++) {
            uint32_t x = (column + columns + dx - 1) % columns;
            int64_t y = (int64_t)row + dy;
            if (y >= 0 && y < rows)
                largest = max1(largest, 0.5f * luminances[(size_t)y * columns + x]);
        }
    return largest;
}

static float cell_solid_angle(const struct environment *environment, uint32_t row)
{
    float rows = (float)environment->rows;
    return 2.0f * PI / (float)environment->columns *
           (cosf(PI * (float)row / rows) - cosf(PI * (float)(row + 1) / rows));
}

// Fills the cumulative distributions from the cells' luminances, which become densities.
static void fill_visibility(struct environment *environment, float *luminances)
{
    uint32_t columns = environment->columns, rows = environment->rows;
    double mean = 0.0, total = 0.0;
    float brightest = 0.0f;
    for (uint32_t row = 0; row < rows; row++)
        for (uint32_t column = 0; column < columns; column++) {
            float luminance = luminances[(size_t)row * columns + column];
            mean += (double)(luminance * cell_solid_angle(environment, row)) / (4.0 * M_PI);
            brightest = max1(brightest, luminance);
        }
    environment->shines = mean > 0.0 && isfinite(mean);
    environment->uneven = brightest > UNEVEN * (float)mean;
    float minimum = environment->shines ? MIN_WEIGHT * (float)mean : 1.0f;
    for (uint32_t row = 0; row < rows; row++) {
        double row_sum = 0.0;
        for (uint32_t column = 0; column < columns; column++) {
            size_t cell = (size_t)row * columns + column;
            environment->densities[cell] =
                spread_luminance(environment, luminances, column, row) + minimum;
            row_sum += environment->densities[cell];
            environment->column_ends[cell] = (float)row_sum;
        }
        for (uint32_t column = 0; column < columns; column++)
            environment->column_ends[(size_t)row * columns + column] /= (float)row_sum;
        total += row_sum * (double)cell_solid_angle(environment, row);
        environment->row_ends[row] = (float)total;
    }
    for (uint32_t row = 0; row < rows; row++)
        environment->row_ends[row] /= (float)total;
    for (size_t cell = 0; cell < (size_t)columns * rows; cell++)
        environment->densities[cell] /= (float)total;
}

struct environment *environment_create(const struct scene_environment *source)
{
    struct environment *environment = calloc(1, sizeof(*environment));
    if (!environment)
        return NULL;
    bool pictured = source->type == SCENE_ENVIRONMENT_EQUIRECT && source->image;
    environment->source = source;
    environment->sine = sinf(source->rotation_rad);
    environment->cosine = cosf(source->rotation_rad);
    environment->columns =
        pictured ? (source->image->width < MAX_COLUMNS ? source->image->width : MAX_COLUMNS) : 1;
    environment->rows = pictured
                            ? (source->image->height < MAX_ROWS ? source->image->height : MAX_ROWS)
                            : GRADIENT_ROWS;
    size_t cells = (size_t)environment->columns * environment->rows;
    environment->row_ends = calloc(environment->rows, sizeof(float));
    environment->column_ends = calloc(cells, sizeof(float));
    environment->densities = calloc(cells, sizeof(float));
    float *luminances = calloc(cells, sizeof(float));
    bool done =
        environment->row_ends && environment->column_ends && environment->densities && luminances;
    for (uint32_t i = 0; done && i < cells; i++)
        luminances[i] =
            cell_luminance(environment, i % environment->columns, i / environment->columns);
    if (done)
        fill_visibility(environment, luminances);
    environment->shines = environment->shines && source->intensity > 0.0f;
    free(luminances);
    if (!done)
        environment_destroy(&environment);
    return environment;
}

void environment_destroy(struct environment **environment)
{
    if (*environment) {
        free((*environment)->row_ends);
        free((*environment)->column_ends);
        free((*environment)->densities);
    }
    free(*environment);
    *environment = NULL;
}

bool environment_shines(const struct environment *environment)
{
    return environment->shines;
}

bool environment_is_uneven(const struct environment *environment)
{
    return environment->uneven;
}

// Rotates directions as shaders/lib/environment.glsl does.
static float3 to_environment(const struct environment *environment, float3 d)
{
    return make3(environment->cosine * d[0] - environment->sine * d[2], d[1],
                 environment->sine * d[0] + environment->cosine * d[2]);
}

float3 environment_radiance(const struct environment *environment, float3 direction)
{
    if (!environment->shines)
        return splat3(0.0f);
    return radiance_of(environment->source, to_environment(environment, direction)) *
           environment->source->intensity;
}

float environment_density(const struct environment *environment, float3 direction)
{
    float3 d = to_environment(environment, direction);
    float u = 0.5f + atan2f(d[0], -d[2]) / (2.0f * PI);
    float v = acosf(min1(max1(d[1], -1.0f), 1.0f)) / PI;
    uint32_t column = (uint32_t)(clamp01(u) * (float)environment->columns);
    uint32_t row = (uint32_t)(clamp01(v) * (float)environment->rows);
    column = column < environment->columns ? column : environment->columns - 1;
    row = row < environment->rows ? row : environment->rows - 1;
    return environment->densities[(size_t)row * environment->columns + column];
}

// Index of the cumulative distribution's interval that contains `u`; `out_within` is the position
// in it, 0..1.
static uint32_t find_within(const float *ends, uint32_t count, float u, float *out_within)
{
    uint32_t low = 0, high = count - 1;
    while (low < high) {
        uint32_t middle = (low + high) / 2;
        if (ends[middle] > u)
            high = middle;
        else
            low = middle + 1;
    }
    float begin = low > 0 ? ends[low - 1] : 0.0f;
    *out_within = clamp01((u - begin) / max1(ends[low] - begin, 1e-30f));
    return low;
}

float3 environment_sample(const struct environment *environment, const float u[2])
{
    float across, down;
    uint32_t row = find_within(environment->row_ends, environment->rows, u[0], &down);
    uint32_t column = find_within(environment->column_ends + (size_t)row * environment->columns,
                                  environment->columns, u[1], &across);
    float rows = (float)environment->rows;
    float top = cosf(PI * (float)row / rows), bottom = cosf(PI * (float)(row + 1) / rows);
    float y = top + (bottom - top) * down, radius = sqrtf(clamp01(1.0f - y * y));
    float angle = 2.0f * PI * (((float)column + across) / (float)environment->columns - 0.5f);
    float x = radius * sinf(angle), z = -radius * cosf(angle);
    return make3(environment->cosine * x + environment->sine * z, y,
                 -environment->sine * x + environment->cosine * z);
}
