#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "renderer/import/obj_import.hpp"

// Depth of height 1, in texel widths; MTL leaves the scale open.
#define OBJ_BUMP_DEPTH_TEXELS 4.0f

// Pins an image, or none, while it lives.
class image_pins
{
  public:
    explicit image_pins(struct image *image) : pinned(image && image_pin(image) ? image : nullptr)
    {
        fine = pinned == image;
    }
    ~image_pins()
    {
        if (pinned) {
            image_unpin(pinned);
        }
    }
    image_pins(const image_pins &) = delete;
    image_pins &operator=(const image_pins &) = delete;
    bool fine;

  private:
    struct image *pinned;
};

static struct image *new_image(uint32_t width, uint32_t height)
{
    uint8_t *rgba = (uint8_t *)malloc((size_t)width * height * 4);
    struct image *image = rgba ? image_create(width, height, rgba) : nullptr;
    if (!image) {
        free(rgba);
    }
    return image;
}

// Texel of `image` at column x, row y of an image of another size.
static const uint8_t *scaled_texel(const struct image *image, uint32_t x, uint32_t y,
                                   uint32_t width, uint32_t height)
{
    size_t column = (size_t)x * image->width / width;
    size_t row = (size_t)y * image->height / height;
    return image->rgba + (row * image->width + column) * 4;
}

struct image *obj_merge_mask(struct image *color, struct image *mask)
{
    image_pins color_pins(color), mask_pins(mask);
    if (!color_pins.fine || !mask_pins.fine) {
        return nullptr;
    }
    uint32_t width = std::max(color ? color->width : 1, mask->width);
    uint32_t height = std::max(color ? color->height : 1, mask->height);
    struct image *merged = new_image(width, height);
    for (uint32_t y = 0; merged && y < height; y++) {
        for (uint32_t x = 0; x < width; x++) {
            uint8_t *to = merged->rgba + ((size_t)y * width + x) * 4;
            const uint8_t *from = color ? scaled_texel(color, x, y, width, height) : nullptr;
            const uint8_t *hole = scaled_texel(mask, x, y, width, height);
            for (int channel = 0; channel < 3; channel++) {
                to[channel] = from ? from[channel] : 255;
            }
            // Masks are either grey or alpha: the smaller value is the one in use.
            to[3] = std::min(hole[0], hole[3]);
        }
    }
    return merged;
}

struct image *obj_merge_metallic_roughness(struct image *metallic, struct image *roughness)
{
    image_pins metallic_pins(metallic), roughness_pins(roughness);
    if (!metallic_pins.fine || !roughness_pins.fine) {
        return nullptr;
    }
    uint32_t width = std::max(metallic ? metallic->width : 1, roughness ? roughness->width : 1);
    uint32_t height = std::max(metallic ? metallic->height : 1, roughness ? roughness->height : 1);
    struct image *merged = new_image(width, height);
    for (uint32_t y = 0; merged && y < height; y++) {
        for (uint32_t x = 0; x < width; x++) {
            uint8_t *to = merged->rgba + ((size_t)y * width + x) * 4;
            to[0] = 255;
            to[1] = roughness ? scaled_texel(roughness, x, y, width, height)[0] : 255;
            to[2] = metallic ? scaled_texel(metallic, x, y, width, height)[0] : 255;
            to[3] = 255;
        }
    }
    return merged;
}

static float height_at(const struct image *heights, uint32_t x, uint32_t y)
{
    const uint8_t *texel =
        heights->rgba + ((size_t)(y % heights->height) * heights->width + x % heights->width) * 4;
    return (float)(texel[0] + texel[1] + texel[2]) / (3 * 255.0f);
}

struct image *obj_make_normal_map(struct image *heights, float multiplier)
{
    image_pins pins(heights);
    if (!pins.fine) {
        return nullptr;
    }
    uint32_t width = heights->width;
    uint32_t height = heights->height;
    struct image *made = new_image(width, height);
    float depth = multiplier * OBJ_BUMP_DEPTH_TEXELS / 2;
    for (uint32_t y = 0; made && y < height; y++) {
        for (uint32_t x = 0; x < width; x++) {
            float along_u = height_at(heights, x + 1, y) - height_at(heights, x + width - 1, y);
            float down = height_at(heights, x, y + 1) - height_at(heights, x, y + height - 1);
            float slope[2] = {-along_u * depth, down * depth};
            float length = std::sqrt(slope[0] * slope[0] + slope[1] * slope[1] + 1);
            float normal[3] = {slope[0] / length, slope[1] / length, 1 / length};
            uint8_t *to = made->rgba + ((size_t)y * width + x) * 4;
            for (int axis = 0; axis < 3; axis++) {
                to[axis] = (uint8_t)std::lround((normal[axis] * 0.5f + 0.5f) * 255);
            }
            to[3] = 255;
        }
    }
    return made;
}

bool obj_is_normal_map(struct image *image)
{
    image_pins pins(image);
    if (!pins.fine) {
        return false;
    }
    uint64_t sums[3] = {};
    size_t count = (size_t)image->width * image->height;
    for (size_t i = 0; i < count; i++) {
        for (int channel = 0; channel < 3; channel++) {
            sums[channel] += image->rgba[i * 4 + channel];
        }
    }
    double red = (double)sums[0] / count, green = (double)sums[1] / count;
    double blue = (double)sums[2] / count;
    return blue > 180 && std::fabs(red - 128) < 24 && std::fabs(green - 128) < 24;
}
