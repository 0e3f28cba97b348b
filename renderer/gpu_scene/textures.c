// Images in texture arrays: one array per power-of-two edge and colour space.
#include <stdlib.h>
#include <string.h>

#include "renderer/gpu_scene/gpu_scene.h"
#include "renderer/gpu_scene/texture_layers.h"
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

// Which layer of which array holds an image.
static struct texture_layer layer_of(const struct gpu_scene *gpu_scene, int space_number,
                                     uint32_t image)
{
    const struct texture_space *space = &gpu_scene->texture_spaces[space_number];
    const struct image_slot *slot = &space->image_slots[image];
    return (struct texture_layer){.gpu = gpu_scene->gpu,
                                  .texture = space->classes[slot->class_number],
                                  .layer = slot->layer,
                                  .image = gpu_scene->scene->images[image],
                                  .color = space_number == TEXTURE_SPACE_COLOR};
}

// Fills all layers. Levels are generated for whole arrays, where any layer lacks them: the others'
// stay the same. What was made is kept for the next time.
static bool fill_layers(struct gpu_scene *gpu_scene, int space_number, bool made[])
{
    struct texture_space *space = &gpu_scene->texture_spaces[space_number];
    uint32_t count = gpu_scene->scene->image_count;
    bool incomplete[MAX_CLASSES_PER_SPACE] = {false};
    for (uint32_t i = 0; i < count; i++) {
        struct image_slot *slot = &space->image_slots[i];
        if (!slot->used)
            continue;
        bool whole;
        struct texture_layer layer = layer_of(gpu_scene, space_number, i);
        if (!texture_layer_load(&layer, slot->mean, &whole))
            return false;
        made[i] = !whole;
        incomplete[slot->class_number] = incomplete[slot->class_number] || !whole;
    }
    for (uint32_t i = 0; i < space->class_count; i++)
        if (incomplete[i])
            gpu_texture_generate_levels(space->classes[i]);
    for (uint32_t i = 0; i < count && scene_cache_is_open(); i++) {
        if (!made[i])
            continue;
        struct texture_layer layer = layer_of(gpu_scene, space_number, i);
        texture_layer_keep(&layer, space->image_slots[i].mean);
    }
    return true;
}

static void assign_layers(struct gpu_scene *gpu_scene, struct texture_space *space,
                          const uint32_t class_of[])
{
    const struct scene *scene = gpu_scene->scene;
    uint32_t next_layer[MAX_CLASSES_PER_SPACE] = {0};
    for (uint32_t i = 0; i < scene->image_count; i++) {
        struct image_slot *slot = &space->image_slots[i];
        if (!slot->used)
            continue;
        slot->class_number = class_of[edge_log2_of(gpu_scene, scene->images[i])];
        slot->layer = next_layer[slot->class_number]++;
    }
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
    assign_layers(gpu_scene, space, class_of);
    bool *made = calloc(scene->image_count ? scene->image_count : 1, sizeof(*made));
    bool done = made && fill_layers(gpu_scene, space_number, made);
    free(made);
    return done;
}

bool gpu_scene_upload_textures(struct gpu_scene *gpu_scene)
{
    return upload_space(gpu_scene, TEXTURE_SPACE_COLOR) &&
           upload_space(gpu_scene, TEXTURE_SPACE_DATA);
}
