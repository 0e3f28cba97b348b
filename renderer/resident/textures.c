// Pictures into texture arrays: one array per power-of-two edge and colour space.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define STB_IMAGE_RESIZE_IMPLEMENTATION
#define STB_IMAGE_RESIZE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image_resize.h>
#pragma GCC diagnostic pop

#include "renderer/resident/resident.h"

#define MIN_CLASS_EDGE_LOG2    4  // 16 texels
#define MAX_CLASS_EDGE_LOG2    12 // 4096 texels
#define MAX_SOFTWARE_EDGE_LOG2 11
#define DEFAULT_ANISOTROPY     1.0f

struct texture_class {
    uint32_t edge_log2;
    bool color;
    uint32_t layers;
};

static uint32_t edge_log2_of(const struct resident *resident, const struct image *image)
{
    uint32_t limit =
        gpu_get_info(resident->gpu)->software ? MAX_SOFTWARE_EDGE_LOG2 : MAX_CLASS_EDGE_LOG2;
    uint32_t edge = image->width > image->height ? image->width : image->height;
    uint32_t log2 = MIN_CLASS_EDGE_LOG2;
    while (log2 < limit && (1u << log2) < edge)
        log2++;
    return log2;
}

static bool slot_is_color(int slot)
{
    return slot == SCENE_TEXTURE_BASE_COLOR || slot == SCENE_TEXTURE_EMISSIVE ||
           slot == SCENE_TEXTURE_SPECULAR_COLOR;
}

// The class for an edge and colour space, made if need be; when all classes are taken, the next
// larger one of the colour space.
static uint32_t find_class(struct texture_class *classes, uint32_t *count, uint32_t edge_log2,
                           bool color)
{
    uint32_t best = MAX_TEXTURE_CLASSES;
    for (uint32_t i = 0; i < *count; i++) {
        if (classes[i].color != color)
            continue;
        if (classes[i].edge_log2 == edge_log2)
            return i;
        if (classes[i].edge_log2 > edge_log2 &&
            (best == MAX_TEXTURE_CLASSES || classes[i].edge_log2 < classes[best].edge_log2))
            best = i;
    }
    // Half of the classes for either colour space.
    uint32_t of_space = 0;
    for (uint32_t i = 0; i < *count; i++)
        of_space += classes[i].color == color;
    if (of_space < MAX_TEXTURE_CLASSES / 2) {
        classes[*count] = (struct texture_class){.edge_log2 = edge_log2, .color = color};
        return (*count)++;
    }
    if (best != MAX_TEXTURE_CLASSES)
        return best;
    for (uint32_t i = 0; i < *count; i++)
        if (classes[i].color == color &&
            (best == MAX_TEXTURE_CLASSES || classes[i].edge_log2 > classes[best].edge_log2))
            best = i;
    return best;
}

static float linear_from_srgb(float value)
{
    return value <= 0.04045f ? value / 12.92f : powf((value + 0.055f) / 1.055f, 2.4f);
}

static void compute_mean(const struct image *image, bool color, float out_mean[4])
{
    uint64_t count = (uint64_t)image->width * image->height;
    uint64_t step = count > 4096 ? count / 4096 : 1; // an estimate will do
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

// Writes an image into a layer, scaled to the class's edge.
static bool write_layer(struct gpu_texture *texture, const struct texture_class *class,
                        uint32_t layer, const struct image *image)
{
    uint32_t edge = 1u << class->edge_log2;
    if (image->width == edge && image->height == edge) {
        gpu_texture_write(texture, 0, layer, image->rgba);
        return true;
    }
    uint8_t *scaled = malloc((size_t)edge * edge * 4);
    if (!scaled)
        return false;
    stbir_resize_uint8_generic(
        image->rgba, (int)image->width, (int)image->height, 0, scaled, (int)edge, (int)edge, 0, 4,
        3, STBIR_FLAG_ALPHA_PREMULTIPLIED, STBIR_EDGE_WRAP, STBIR_FILTER_DEFAULT,
        class->color ? STBIR_COLORSPACE_SRGB : STBIR_COLORSPACE_LINEAR, NULL);
    gpu_texture_write(texture, 0, layer, scaled);
    free(scaled);
    return true;
}

// Marks which images are used as colour and as data.
static void find_uses(const struct scene *scene, uint8_t *uses)
{
    for (uint32_t i = 0; i < scene->material_count; i++)
        for (int slot = 0; slot < SCENE_TEXTURE_SLOT_COUNT; slot++) {
            uint32_t image = scene->materials[i].textures[slot].image;
            if (image < scene->image_count)
                uses[image] |= slot_is_color(slot) ? 1 : 2;
        }
}

static bool create_arrays(struct resident *resident, const struct texture_class *classes,
                          uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        struct gpu_texture_params params = {
            .label = "textures",
            .format = classes[i].color ? GPU_FORMAT_SRGB8_ALPHA8 : GPU_FORMAT_RGBA8,
            .width = 1u << classes[i].edge_log2,
            .height = 1u << classes[i].edge_log2,
            .layers = classes[i].layers,
            .levels = classes[i].edge_log2 + 1,
            .filter = GPU_FILTER_LINEAR,
            .repeat_u = true,
            .repeat_v = true,
        };
        resident->texture_classes[i] = gpu_texture_create(resident->gpu, &params);
        if (!resident->texture_classes[i])
            return false;
    }
    return true;
}

static bool fill_arrays(struct resident *resident, const struct texture_class *classes,
                        const uint8_t *uses)
{
    const struct scene *scene = resident->scene;
    for (uint32_t i = 0; i < scene->image_count; i++)
        for (int space = 0; space < 2; space++) {
            if (!(uses[i] & (1 << space)))
                continue;
            struct image_place *place =
                space == 0 ? &resident->color_places[i] : &resident->data_places[i];
            compute_mean(scene->images[i], space == 0, place->mean);
            if (!write_layer(resident->texture_classes[place->class_number],
                             &classes[place->class_number], place->layer, scene->images[i]))
                return false;
        }
    for (uint32_t i = 0; i < resident->texture_class_count; i++)
        gpu_texture_generate_levels(resident->texture_classes[i]);
    return true;
}

bool resident_upload_textures(struct resident *resident)
{
    const struct scene *scene = resident->scene;
    for (uint32_t i = 0; i < MAX_TEXTURE_CLASSES; i++)
        gpu_texture_destroy(&resident->texture_classes[i]);
    resident->texture_class_count = 0;
    free(resident->color_places);
    free(resident->data_places);
    size_t count = scene->image_count ? scene->image_count : 1;
    resident->color_places = calloc(count, sizeof(*resident->color_places));
    resident->data_places = calloc(count, sizeof(*resident->data_places));
    uint8_t *uses = calloc(count, 1);
    if (!uses || !resident->color_places || !resident->data_places) {
        free(uses);
        return false;
    }
    find_uses(scene, uses);
    struct texture_class classes[MAX_TEXTURE_CLASSES];
    // Largest first, so that a shortage of classes never shrinks a picture.
    for (uint32_t log2 = MAX_CLASS_EDGE_LOG2 + 1; log2-- > MIN_CLASS_EDGE_LOG2;)
        for (uint32_t i = 0; i < scene->image_count; i++) {
            if (edge_log2_of(resident, scene->images[i]) != log2)
                continue;
            for (int space = 0; space < 2; space++) {
                if (!(uses[i] & (1 << space)))
                    continue;
                uint32_t number =
                    find_class(classes, &resident->texture_class_count, log2, space == 0);
                struct image_place *place =
                    space == 0 ? &resident->color_places[i] : &resident->data_places[i];
                place->class_number = number;
                place->layer = classes[number].layers++;
            }
        }
    bool done = create_arrays(resident, classes, resident->texture_class_count) &&
                fill_arrays(resident, classes, uses);
    free(uses);
    return done;
}
