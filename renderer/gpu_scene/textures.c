// Images in texture arrays: one array per power-of-two edge and colour space.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define STB_IMAGE_RESIZE_IMPLEMENTATION
#define STB_IMAGE_RESIZE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image_resize.h>
#pragma GCC diagnostic pop

#include "renderer/gpu_scene/gpu_scene.h"
#include "renderer/image/image.h"
#include "renderer/scene/scene.h"

#define MIN_CLASS_EDGE_LOG2    4  // 16 texels
#define MAX_CLASS_EDGE_LOG2    12 // 4096 texels
#define MAX_SOFTWARE_EDGE_LOG2 11

// On a software renderer every class costs every pixel, so small images are enlarged into the next
// class as long as that takes no more memory than this.
#define MAX_SOFTWARE_ENLARGED_BYTES (96u << 20)

struct texture_class {
    uint32_t edge_log2;
    uint32_t layers;
};

static uint32_t edge_log2_of(const struct gpu_scene *gpu_scene, const struct image *image)
{
    uint32_t limit =
        gpu_get_info(gpu_scene->gpu)->software ? MAX_SOFTWARE_EDGE_LOG2 : MAX_CLASS_EDGE_LOG2;
    uint32_t edge = image->width > image->height ? image->width : image->height;
    uint32_t log2 = MIN_CLASS_EDGE_LOG2;
    while (log2 < limit && (1u << log2) < edge)
        log2++;
    return log2;
}

int gpu_scene_texture_space(int slot)
{
    return COLOR_TEXTURE_SLOTS & (1u << slot) ? TEXTURE_SPACE_COLOR : TEXTURE_SPACE_DATA;
}

static uint64_t class_bytes(uint32_t edge_log2, uint32_t layers)
{
    return ((uint64_t)4 << (2 * edge_log2)) * 4 / 3 * layers;
}

// Merges a count of images per edge into classes, largest first; images of a merged edge use the
// next larger class. `out_class_of` maps edge to class.
static uint32_t choose_classes(uint32_t counts[MAX_CLASS_EDGE_LOG2 + 1], bool software,
                               struct texture_class classes[MAX_CLASSES_PER_SPACE],
                               uint32_t out_class_of[MAX_CLASS_EDGE_LOG2 + 1])
{
    uint32_t class_count = 0;
    for (uint32_t log2 = MAX_CLASS_EDGE_LOG2 + 1; log2-- > MIN_CLASS_EDGE_LOG2;) {
        if (counts[log2] == 0)
            continue;
        bool merge = class_count == MAX_CLASSES_PER_SPACE;
        if (class_count > 0 && software)
            merge = merge || class_bytes(classes[class_count - 1].edge_log2, counts[log2]) <=
                                 MAX_SOFTWARE_ENLARGED_BYTES;
        if (!merge)
            classes[class_count++] = (struct texture_class){.edge_log2 = log2};
        out_class_of[log2] = class_count - 1;
        classes[class_count - 1].layers += counts[log2];
    }
    return class_count;
}

static float linear_from_srgb(float value)
{
    return value <= 0.04045f ? value / 12.92f : powf((value + 0.055f) / 1.055f, 2.4f);
}

static void compute_mean(const struct image *image, bool color, float out_mean[4])
{
    uint64_t count = (uint64_t)image->width * image->height;
    uint64_t step = count > 4096 ? count / 4096 : 1; // an estimate is enough
    double sum[4] = {0};
    uint64_t taken = 0;
    for (uint64_t i = 0; i < count; i += step, taken++)
        for (int c = 0; c < 4; c++) {
            float value = image->rgba[i * 4 + c] / 255.0f;
            sum[c] += color && c < 3 ? linear_from_srgb(value) : value;
        }
    for (int c = 0; c < 4; c++)
        out_mean[c] = taken ? (float)(sum[c] / (double)taken) : 1.0f;
}

// Writes an image to a layer, scaled to the class's edge.
static bool write_layer(struct gpu_texture *texture, uint32_t layer, const struct image *image,
                        bool color)
{
    uint32_t edge = gpu_texture_edge(texture);
    if (image->width == edge && image->height == edge) {
        gpu_texture_write(texture, 0, layer, image->rgba);
        return true;
    }
    uint8_t *scaled = malloc((size_t)edge * edge * 4);
    if (!scaled)
        return false;
    stbir_resize_uint8_generic(image->rgba, (int)image->width, (int)image->height, 0, scaled,
                               (int)edge, (int)edge, 0, 4, 3, STBIR_FLAG_ALPHA_PREMULTIPLIED,
                               STBIR_EDGE_WRAP, STBIR_FILTER_DEFAULT,
                               color ? STBIR_COLORSPACE_SRGB : STBIR_COLORSPACE_LINEAR, NULL);
    gpu_texture_write(texture, 0, layer, scaled);
    free(scaled);
    return true;
}

// Marks the images that the space's textures use, and counts them by edge.
static void find_uses(const struct gpu_scene *gpu_scene, int space_number,
                      uint32_t out_counts[MAX_CLASS_EDGE_LOG2 + 1])
{
    const struct scene *scene = gpu_scene->scene;
    struct image_slot *image_slots = gpu_scene->texture_spaces[space_number].image_slots;
    for (uint32_t i = 0; i < scene->material_count; i++)
        for (int slot = 0; slot < SCENE_TEXTURE_SLOT_COUNT; slot++) {
            uint32_t image = scene->materials[i].textures[slot].image;
            if (image >= scene->image_count || gpu_scene_texture_space(slot) != space_number ||
                image_slots[image].used)
                continue;
            image_slots[image].used = true;
            out_counts[edge_log2_of(gpu_scene, scene->images[image])]++;
        }
}

static bool create_arrays(struct gpu_scene *gpu_scene, struct texture_space *space, bool color,
                          const struct texture_class *classes)
{
    // One mip level instead of two halves the cost on a CPU; shaders dither the level to hide the
    // steps.
    bool software = gpu_get_info(gpu_scene->gpu)->software;
    for (uint32_t i = 0; i < space->class_count; i++) {
        space->classes[i] = gpu_texture_create(
            gpu_scene->gpu,
            &(struct gpu_texture_params){
                .label = "textures",
                .format = color ? GPU_FORMAT_SRGB8_ALPHA8 : GPU_FORMAT_RGBA8,
                .width = 1u << classes[i].edge_log2,
                .height = 1u << classes[i].edge_log2,
                .layers = classes[i].layers,
                .levels = classes[i].edge_log2 + 1,
                .filter = software ? GPU_FILTER_LINEAR_NEAREST_LEVEL : GPU_FILTER_LINEAR,
                .repeat_u = true,
                .repeat_v = true,
            });
        if (!space->classes[i])
            return false;
    }
    return true;
}

static bool upload_space(struct gpu_scene *gpu_scene, int space_number)
{
    const struct scene *scene = gpu_scene->scene;
    struct texture_space *space = &gpu_scene->texture_spaces[space_number];
    bool color = space_number == TEXTURE_SPACE_COLOR;
    for (uint32_t i = 0; i < MAX_CLASSES_PER_SPACE; i++)
        gpu_texture_destroy(&space->classes[i]);
    free(space->image_slots);
    space->image_slots =
        calloc(scene->image_count ? scene->image_count : 1, sizeof(*space->image_slots));
    if (!space->image_slots)
        return false;
    uint32_t counts[MAX_CLASS_EDGE_LOG2 + 1] = {0}, class_of[MAX_CLASS_EDGE_LOG2 + 1] = {0};
    struct texture_class classes[MAX_CLASSES_PER_SPACE];
    find_uses(gpu_scene, space_number, counts);
    space->class_count =
        choose_classes(counts, gpu_get_info(gpu_scene->gpu)->software, classes, class_of);
    if (!create_arrays(gpu_scene, space, color, classes))
        return false;
    uint32_t next_layer[MAX_CLASSES_PER_SPACE] = {0};
    for (uint32_t i = 0; i < scene->image_count; i++) {
        struct image_slot *image_entry = &space->image_slots[i];
        if (!image_entry->used)
            continue;
        image_entry->class_number = class_of[edge_log2_of(gpu_scene, scene->images[i])];
        image_entry->layer = next_layer[image_entry->class_number]++;
        compute_mean(scene->images[i], color, image_entry->mean);
        if (!write_layer(space->classes[image_entry->class_number], image_entry->layer,
                         scene->images[i], color))
            return false;
    }
    for (uint32_t i = 0; i < space->class_count; i++)
        gpu_texture_generate_levels(space->classes[i]);
    return true;
}

bool gpu_scene_upload_textures(struct gpu_scene *gpu_scene)
{
    return upload_space(gpu_scene, TEXTURE_SPACE_COLOR) &&
           upload_space(gpu_scene, TEXTURE_SPACE_DATA);
}
