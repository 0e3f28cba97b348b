#include "renderer/frame/occlusion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Below it, reading pixels costs more than the triangles.
#define MIN_TRIANGLES 32768u
// Two passes wait for pixels twice and share fewer vertices: they are worthwhile with up to this
// part of the triangles (measured: 0.75 costs as much as all). If not, tried again after so many
// frames.
#define WORTHWHILE   0.6f
#define FRAMES_UNTIL 60u
#define TILE_LOG2    1 // edge in pixels of the finest tiles
#define MAX_SPAN     4 // tiles in x and y that a box is compared with; else coarser ones
// Relative, for what rounding does to depth between here and the rasteriser.
#define DEPTH_MARGIN    1e-4f
#define SUBPIXEL_MARGIN (1.0f / 64)

void occlusion_finish(struct occlusion *occlusion)
{
    draw_list_finish(&occlusion->list);
    free(occlusion->seen);
    free(occlusion->pixels);
    free(occlusion->farthest);
    *occlusion = (struct occlusion){0};
}

bool occlusion_pays(struct occlusion *occlusion, const struct gpu_scene *gpu_scene,
                    uint32_t triangles)
{
    if (!gpu_scene->boxes || triangles < MIN_TRIANGLES)
        return false;
    if (occlusion->frames_until == 0)
        return true;
    occlusion->frames_until--;
    return false;
}

void occlusion_judge(struct occlusion *occlusion, uint32_t drawn, uint32_t triangles)
{
    if ((float)drawn <= WORTHWHILE * (float)triangles)
        return;
    occlusion->frames_until = FRAMES_UNTIL;
    occlusion->has_seen = false;
}

static uint32_t count_blocks(const struct gpu_scene *gpu_scene)
{
    return gpu_scene->cluster_count << (ID_BLOCK_BITS - DRAW_BLOCK_BITS);
}

bool occlusion_has_seen(const struct occlusion *occlusion, const struct gpu_scene *gpu_scene)
{
    return occlusion->has_seen && occlusion->block_count == count_blocks(gpu_scene);
}

static uint32_t tiles_along(uint32_t pixels, uint32_t level)
{
    return ((pixels - 1) >> (TILE_LOG2 + level)) + 1;
}

// The levels together are less than twice as many as the finest, but for single rows.
static size_t count_tiles(uint32_t width, uint32_t height)
{
    size_t total = 1;
    for (uint32_t level = 0; tiles_along(width, level) * tiles_along(height, level) > 1; level++)
        total += (size_t)tiles_along(width, level) * tiles_along(height, level);
    return total;
}

static bool fit_pixels(struct occlusion *occlusion, uint32_t width, uint32_t height)
{
    if (occlusion->width == width && occlusion->height == height)
        return true;
    free(occlusion->pixels);
    free(occlusion->farthest);
    occlusion->pixels = malloc((size_t)width * height * sizeof(*occlusion->pixels));
    occlusion->farthest = calloc(count_tiles(width, height), sizeof(*occlusion->farthest));
    bool done = occlusion->pixels && occlusion->farthest;
    occlusion->width = done ? width : 0;
    occlusion->height = done ? height : 0;
    return done;
}

// Reversed Z: the farthest depth is the minimum.
static void reduce_pixels(const struct occlusion *occlusion, const float *depths)
{
    uint32_t columns = tiles_along(occlusion->width, 0), rows = tiles_along(occlusion->height, 0);
    for (uint32_t i = 0; i < columns * rows; i++)
        occlusion->farthest[i] = INFINITY;
    for (uint32_t y = 0; y < occlusion->height; y++) {
        float *row = occlusion->farthest + (size_t)(y >> TILE_LOG2) * columns;
        for (uint32_t x = 0; x < occlusion->width; x++)
            row[x >> TILE_LOG2] = fminf(row[x >> TILE_LOG2], *depths++);
    }
}

static void reduce_tiles(const struct occlusion *occlusion)
{
    float *from = occlusion->farthest;
    for (uint32_t level = 0;; level++) {
        uint32_t columns = tiles_along(occlusion->width, level);
        uint32_t rows = tiles_along(occlusion->height, level);
        if (columns * rows == 1)
            return;
        float *to = from + (size_t)columns * rows;
        uint32_t half = tiles_along(occlusion->width, level + 1);
        for (uint32_t i = 0; i < half * tiles_along(occlusion->height, level + 1); i++)
            to[i] = INFINITY;
        for (uint32_t y = 0; y < rows; y++)
            for (uint32_t x = 0; x < columns; x++) {
                float *tile = &to[(y / 2) * half + x / 2];
                *tile = fminf(*tile, from[y * columns + x]);
            }
        from = to;
    }
}

// What the camera sees of a box: pixels, and the depth of its nearest corner.
struct box_image {
    uint32_t low[2];
    uint32_t high[2];
    float nearest;
    bool empty;
};

// False where the box reaches past the near plane or is not finite, so that corners do not tell.
static bool project_box(const struct draw_block *block, uint32_t width, uint32_t height,
                        struct box_image *out_image)
{
    const float *bounds[2] = {block->box->low, block->box->high};
    float low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, nearest = 0.0f;
    for (uint32_t corner = 0; corner < 8; corner++) {
        float clip[4];
        for (int row = 0; row < 4; row++) {
            const float *r = block->clip_rows[row];
            clip[row] = r[0] * bounds[corner & 1][0] + r[1] * bounds[(corner >> 1) & 1][1] +
                        r[2] * bounds[corner >> 2][2] + r[3];
        }
        if (!(clip[3] > 0.0f && clip[2] < clip[3]))
            return false;
        float inverse = 1.0f / clip[3];
        float at[2] = {(0.5f + 0.5f * clip[0] * inverse) * (float)width,
                       (0.5f - 0.5f * clip[1] * inverse) * (float)height};
        for (int axis = 0; axis < 2; axis++) {
            low[axis] = fminf(low[axis], at[axis]);
            high[axis] = fmaxf(high[axis], at[axis]);
        }
        nearest = fmaxf(nearest, clip[2] * inverse);
    }
    out_image->empty = false;
    const float last[2] = {(float)(width - 1), (float)(height - 1)};
    for (int axis = 0; axis < 2; axis++) {
        // Pixels whose centres the box covers, but for what the rasteriser's fixed point moves.
        float from = fmaxf(ceilf(low[axis] - 0.5f - SUBPIXEL_MARGIN), 0.0f);
        float to = fminf(floorf(high[axis] - 0.5f + SUBPIXEL_MARGIN), last[axis]);
        out_image->empty |= !(from <= to);
        out_image->low[axis] = (uint32_t)from;
        out_image->high[axis] = (uint32_t)to;
    }
    out_image->nearest = nearest * (1.0f + DEPTH_MARGIN);
    return true;
}

static bool is_behind(const struct occlusion *occlusion, const struct draw_block *block)
{
    struct box_image image;
    if (!project_box(block, occlusion->width, occlusion->height, &image))
        return false;
    if (image.empty)
        return true;
    const float *tiles = occlusion->farthest;
    uint32_t shift = TILE_LOG2;
    while ((image.high[0] >> shift) - (image.low[0] >> shift) >= MAX_SPAN ||
           (image.high[1] >> shift) - (image.low[1] >> shift) >= MAX_SPAN) {
        uint32_t level = shift - TILE_LOG2;
        tiles +=
            (size_t)tiles_along(occlusion->width, level) * tiles_along(occlusion->height, level);
        shift++;
    }
    uint32_t columns = tiles_along(occlusion->width, shift - TILE_LOG2);
    for (uint32_t y = image.low[1] >> shift; y <= image.high[1] >> shift; y++)
        for (uint32_t x = image.low[0] >> shift; x <= image.high[0] >> shift; x++)
            if (!(tiles[y * columns + x] > image.nearest))
                return false;
    return true;
}

static bool was_seen(const void *user, const struct draw_block *block)
{
    return ((const struct occlusion *)user)->seen[block->number];
}

static bool may_be_seen(const void *user, const struct draw_block *block)
{
    const struct occlusion *occlusion = user;
    return !occlusion->seen[block->number] && !is_behind(occlusion, block);
}

bool occlusion_list_seen(struct occlusion *occlusion, const struct gpu_scene *gpu_scene,
                         const mat4 clip_from_world, const float *eye)
{
    return draw_list_fill_blocks(&occlusion->list, gpu_scene, clip_from_world, eye,
                                 &(struct draw_filter){was_seen, occlusion});
}

bool occlusion_list_rest(struct occlusion *occlusion, const struct gpu_scene *gpu_scene,
                         const mat4 clip_from_world, const float *eye,
                         const struct gpu_texture *depth, uint32_t width, uint32_t height)
{
    if (!fit_pixels(occlusion, width, height))
        return false;
    gpu_texture_read_layer(depth, 0, 0, occlusion->pixels);
    reduce_pixels(occlusion, (const float *)occlusion->pixels);
    reduce_tiles(occlusion);
    return draw_list_fill_blocks(&occlusion->list, gpu_scene, clip_from_world, eye,
                                 &(struct draw_filter){may_be_seen, occlusion});
}

bool occlusion_note_seen(struct occlusion *occlusion, const struct gpu_scene *gpu_scene,
                         const struct gpu_texture *ids, uint32_t width, uint32_t height)
{
    uint32_t count = count_blocks(gpu_scene);
    if (count != occlusion->block_count) {
        free(occlusion->seen);
        occlusion->seen = malloc(count);
        occlusion->block_count = occlusion->seen ? count : 0;
    }
    if (!occlusion->seen || !fit_pixels(occlusion, width, height))
        return false;
    gpu_texture_read_layer(ids, 0, 0, occlusion->pixels);
    memset(occlusion->seen, 0, count);
    occlusion->has_seen = false;
    for (size_t i = 0; i < (size_t)width * height; i++) {
        uint32_t id = occlusion->pixels[i];
        if (id == 0)
            continue;
        occlusion->seen[(id - 1) >> DRAW_BLOCK_BITS] = 1;
        occlusion->has_seen = true;
    }
    return true;
}
