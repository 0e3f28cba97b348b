// The atrium's materials and their images.
#include <math.h>
#include <string.h>

#include "renderer/import/builtin/atrium.h"
#include "renderer/import/builtin/texture_maker.h"

static float clamp01(float x)
{
    return fminf(fmaxf(x, 0.0f), 1.0f);
}

static void tint(const float color[3], float shade, float out_rgba[4])
{
    for (int c = 0; c < 3; c++)
        out_rgba[c] = color[c] * shade;
}

// Distance to the nearest joint of a running bond, in units of the image's edge, and the block's
// number.
static float bond_distance(float u, float v, uint32_t courses, uint32_t blocks, uint32_t out_id[2])
{
    float row = v * (float)courses;
    uint32_t course = (uint32_t)row % courses;
    float column = u * (float)blocks + (course & 1 ? 0.5f : 0.0f);
    uint32_t block = (uint32_t)column % blocks;
    float down = row - floorf(row), along = column - floorf(column);
    out_id[0] = block;
    out_id[1] = course;
    return fminf(fminf(down, 1.0f - down) / (float)courses,
                 fminf(along, 1.0f - along) / (float)blocks);
}

#define ASHLAR_COURSES 4
#define ASHLAR_BLOCKS  2
#define ASHLAR_JOINT   0.004f

static void ashlar_color(float u, float v, float out_rgba[4])
{
    static const float stone[3] = {0.83f, 0.765f, 0.66f};
    uint32_t id[2];
    float distance = bond_distance(u, v, ASHLAR_COURSES, ASHLAR_BLOCKS, id);
    float shade = 0.9f + 0.08f * texture_random(id[0], id[1], 11) +
                  0.1f * (texture_turbulence(u, v, 8, 4, 12) - 0.5f);
    float joint = 1.0f - clamp01((distance - 0.5f * ASHLAR_JOINT) / ASHLAR_JOINT);
    tint(stone, shade * (1.0f - 0.28f * joint), out_rgba);
}

static float ashlar_height(float u, float v)
{
    uint32_t id[2];
    float distance = bond_distance(u, v, ASHLAR_COURSES, ASHLAR_BLOCKS, id);
    float joint = 1.0f - clamp01((distance - 0.5f * ASHLAR_JOINT) / ASHLAR_JOINT);
    return 0.003f * texture_turbulence(u, v, 32, 2, 13) - 0.002f * joint;
}

static void stone_color(float u, float v, float out_rgba[4])
{
    static const float stone[3] = {0.87f, 0.82f, 0.735f};
    tint(stone, 0.9f + 0.2f * (texture_turbulence(u, v, 6, 4, 21) - 0.5f), out_rgba);
}

static float stone_height(float u, float v)
{
    return 0.003f * texture_turbulence(u, v, 24, 2, 22);
}

// 2 x 2 slabs, alternately light and dark, with veins where turbulence crosses its mean.
static float marble_vein(float u, float v, uint32_t seed)
{
    float warp = texture_turbulence(u, v, 3, 4, seed);
    return powf(1.0f - fabsf(2.0f * warp - 1.0f), 14.0f);
}

static float marble_joint_distance(float u, float v)
{
    return fminf(fminf(fabsf(u - 0.5f), fabsf(v - 0.5f)),
                 fminf(fminf(u, 1.0f - u), fminf(v, 1.0f - v)));
}

static void marble_color(float u, float v, float out_rgba[4])
{
    static const float light[3] = {0.88f, 0.85f, 0.79f}, dark[3] = {0.46f, 0.235f, 0.19f};
    uint32_t column = u < 0.5f ? 0 : 1, row = v < 0.5f ? 0 : 1;
    float distance = marble_joint_distance(u, v);
    bool is_dark = (column + row) & 1;
    float vein = marble_vein(u, v, is_dark ? 31 : 32);
    float shade = 0.93f + 0.12f * (texture_turbulence(u, v, 5, 3, 33) - 0.5f);
    float joint = 1.0f - clamp01((distance - 0.0015f) / 0.002f);
    tint(is_dark ? dark : light, shade, out_rgba);
    for (int c = 0; c < 3; c++) {
        float veined = is_dark ? 0.75f : 0.6f;
        out_rgba[c] += (veined - out_rgba[c]) * vein * (is_dark ? 0.3f : 0.4f);
        out_rgba[c] *= 1.0f - 0.45f * joint;
    }
}

// Roughness in green: polish worn off in places.
static void marble_roughness(float u, float v, float out_rgba[4])
{
    float distance = marble_joint_distance(u, v);
    float worn = texture_turbulence(u, v, 4, 4, 34);
    out_rgba[1] = distance < 0.003f ? 0.8f : 0.18f + 0.35f * worn * worn;
}

#define FLOOR_TILE_ROWS 6

static void tiles_color(float u, float v, float out_rgba[4])
{
    static const float clay[3] = {0.68f, 0.42f, 0.3f};
    uint32_t id[2];
    float distance = bond_distance(u, v, FLOOR_TILE_ROWS, FLOOR_TILE_ROWS / 2, id);
    float joint = 1.0f - clamp01((distance - 0.003f) / 0.003f);
    float shade = 0.8f + 0.22f * texture_random(id[0], id[1], 41) +
                  0.15f * (texture_turbulence(u, v, 16, 3, 42) - 0.5f);
    tint(clay, shade, out_rgba);
    for (int c = 0; c < 3; c++)
        out_rgba[c] += (0.55f - out_rgba[c]) * 0.6f * joint;
}

static void terracotta_color(float u, float v, float out_rgba[4])
{
    static const float clay[3] = {0.76f, 0.44f, 0.31f};
    tint(clay, 0.85f + 0.3f * (texture_turbulence(u, v, 8, 4, 51) - 0.5f), out_rgba);
}

// Half-round roof tiles: eight rows of channels, four overlapping courses.
static float roof_height(float u, float v)
{
    float across = u * 8.0f - floorf(u * 8.0f), down = v * 4.0f - floorf(v * 4.0f);
    return 0.05f * fabsf(sinf((float)M_PI * across)) + 0.02f * down;
}

static void wood_color(float u, float v, float out_rgba[4])
{
    static const float wood[3] = {0.46f, 0.31f, 0.2f};
    float grain = texture_turbulence(u * 8.0f, v, 4, 3, 61);
    float bands = 0.5f + 0.5f * sinf(2.0f * (float)M_PI * (6.0f * u + 1.5f * grain));
    tint(wood, 0.78f + 0.2f * bands + 0.2f * (grain - 0.5f), out_rgba);
}

// Plain weave: threads alternate over and under.
static float cloth_height(float u, float v)
{
    const float threads = 16.0f;
    float x = u * threads, y = v * threads;
    bool over = ((uint32_t)x + (uint32_t)y) & 1;
    float warp = fabsf(sinf((float)M_PI * x)), weft = fabsf(sinf((float)M_PI * y));
    return 0.012f * (over ? warp : weft);
}

// One leaf, its stem at the bottom of the image; alpha is its outline.
static void leaf_color(float u, float v, float out_rgba[4])
{
    float along = 1.0f - v, across = fabsf(2.0f * u - 1.0f);
    float width = 0.92f * powf(sinf((float)M_PI * powf(clamp01(along), 0.7f)), 0.8f);
    float ripple = 0.03f * sinf(60.0f * along);
    float vein = across < 0.03f ? 1.0f : 0.0f;
    float side_vein = sinf(2.0f * (float)M_PI * (9.0f * along - 2.5f * across));
    vein = fmaxf(vein, side_vein > 0.93f ? 0.5f : 0.0f);
    float shade = 0.75f + 0.35f * (texture_turbulence(u, v, 6, 3, 71) - 0.5f) + 0.18f * vein;
    out_rgba[0] = 0.3f * shade + 0.1f * along;
    out_rgba[1] = 0.52f * shade;
    out_rgba[2] = 0.2f * shade;
    out_rgba[3] = across < width + ripple || (across < 0.06f && along < 0.2f) ? 1.0f : 0.0f;
}

static void set_texture(struct scene_material *material, enum scene_texture_slot slot,
                        uint32_t image, float repeats_per_m)
{
    material->textures[slot].image = image;
    material->textures[slot].scale[0] = material->textures[slot].scale[1] = repeats_per_m;
}

struct atrium_images {
    uint32_t ashlar, ashlar_normal, stone, stone_normal, marble, marble_roughness;
    uint32_t tiles, terracotta, roof_normal, wood, cloth_normal, leaf;
};

static bool make_images(struct scene *scene, struct atrium_images *images)
{
    *images = (struct atrium_images){
        .ashlar = texture_make(scene, 512, ashlar_color),
        .ashlar_normal = texture_make_normal_map(scene, 512, ashlar_height),
        .stone = texture_make(scene, 256, stone_color),
        .stone_normal = texture_make_normal_map(scene, 256, stone_height),
        .marble = texture_make(scene, 512, marble_color),
        .marble_roughness = texture_make(scene, 256, marble_roughness),
        .tiles = texture_make(scene, 256, tiles_color),
        .terracotta = texture_make(scene, 256, terracotta_color),
        .roof_normal = texture_make_normal_map(scene, 256, roof_height),
        .wood = texture_make(scene, 256, wood_color),
        .cloth_normal = texture_make_normal_map(scene, 256, cloth_height),
        .leaf = texture_make(scene, 256, leaf_color),
    };
    uint32_t ids[sizeof(*images) / sizeof(uint32_t)];
    memcpy(ids, images, sizeof(ids));
    for (size_t i = 0; i < sizeof(ids) / sizeof(ids[0]); i++)
        if (ids[i] == SCENE_NONE)
            return false;
    return true;
}

static void set_pictures(struct scene_material materials[ATRIUM_MATERIAL_COUNT],
                         const struct atrium_images *images)
{
    const struct picture {
        enum atrium_material material;
        enum scene_texture_slot slot;
        uint32_t image;
        float repeats_per_m;
    } pictures[] = {
        {ATRIUM_ASHLAR, SCENE_TEXTURE_BASE_COLOR, images->ashlar, 1.0f / 1.5f},
        {ATRIUM_ASHLAR, SCENE_TEXTURE_NORMAL, images->ashlar_normal, 1.0f / 1.5f},
        {ATRIUM_STONE, SCENE_TEXTURE_BASE_COLOR, images->stone, 1.0f},
        {ATRIUM_STONE, SCENE_TEXTURE_NORMAL, images->stone_normal, 1.0f},
        {ATRIUM_PLASTER, SCENE_TEXTURE_NORMAL, images->stone_normal, 1.0f},
        {ATRIUM_MARBLE, SCENE_TEXTURE_BASE_COLOR, images->marble, 1.0f / 1.5f},
        {ATRIUM_MARBLE, SCENE_TEXTURE_METALLIC_ROUGHNESS, images->marble_roughness, 1.0f / 1.5f},
        {ATRIUM_TILES, SCENE_TEXTURE_BASE_COLOR, images->tiles, 1.0f / 1.2f},
        {ATRIUM_WOOD, SCENE_TEXTURE_BASE_COLOR, images->wood, 1.0f},
        {ATRIUM_ROOF, SCENE_TEXTURE_BASE_COLOR, images->terracotta, 0.5f},
        {ATRIUM_ROOF, SCENE_TEXTURE_NORMAL, images->roof_normal, 0.5f},
        {ATRIUM_TERRACOTTA, SCENE_TEXTURE_BASE_COLOR, images->terracotta, 1.0f},
        {ATRIUM_LEAF, SCENE_TEXTURE_BASE_COLOR, images->leaf, 1.0f},
        {ATRIUM_RED_CLOTH, SCENE_TEXTURE_NORMAL, images->cloth_normal, 10.0f},
        {ATRIUM_GREEN_CLOTH, SCENE_TEXTURE_NORMAL, images->cloth_normal, 10.0f},
        {ATRIUM_BLUE_CLOTH, SCENE_TEXTURE_NORMAL, images->cloth_normal, 10.0f},
    };
    for (size_t i = 0; i < sizeof(pictures) / sizeof(pictures[0]); i++)
        set_texture(&materials[pictures[i].material], pictures[i].slot, pictures[i].image,
                    pictures[i].repeats_per_m);
}

bool atrium_add_materials(struct scene *scene)
{
    static const struct {
        const char *name;
        float color[3];
        float roughness, metallic;
    } looks[ATRIUM_MATERIAL_COUNT] = {
        [ATRIUM_ASHLAR] = {"ashlar", {1, 1, 1}, 0.85f, 0},
        [ATRIUM_STONE] = {"limestone", {1, 1, 1}, 0.7f, 0},
        [ATRIUM_PLASTER] = {"plaster", {0.78f, 0.73f, 0.64f}, 0.95f, 0},
        [ATRIUM_MARBLE] = {"marble floor", {1, 1, 1}, 1.0f, 0},
        [ATRIUM_TILES] = {"clay floor", {1, 1, 1}, 0.6f, 0},
        [ATRIUM_WOOD] = {"dark wood", {1, 1, 1}, 0.55f, 0},
        [ATRIUM_ROOF] = {"roof tiles", {1, 1, 1}, 0.9f, 0},
        [ATRIUM_TERRACOTTA] = {"terracotta", {1, 1, 1}, 0.9f, 0},
        [ATRIUM_BRASS] = {"brass", {0.89f, 0.73f, 0.4f}, 0.3f, 1},
        [ATRIUM_WATER] = {"water", {0.02f, 0.06f, 0.07f}, 0.04f, 0},
        [ATRIUM_SOIL] = {"soil", {0.05f, 0.035f, 0.025f}, 1.0f, 0},
        [ATRIUM_LEAF] = {"leaf", {1, 1, 1}, 0.5f, 0},
        [ATRIUM_RED_CLOTH] = {"red cloth", {0.55f, 0.02f, 0.025f}, 0.85f, 0},
        [ATRIUM_GREEN_CLOTH] = {"green cloth", {0.03f, 0.26f, 0.06f}, 0.85f, 0},
        [ATRIUM_BLUE_CLOTH] = {"blue cloth", {0.03f, 0.08f, 0.45f}, 0.85f, 0},
    };
    struct atrium_images images;
    if (!make_images(scene, &images))
        return false;
    struct scene_material materials[ATRIUM_MATERIAL_COUNT];
    for (int i = 0; i < ATRIUM_MATERIAL_COUNT; i++) {
        scene_material_init(&materials[i], looks[i].name);
        memcpy(materials[i].base_color, looks[i].color, sizeof(looks[i].color));
        materials[i].roughness = looks[i].roughness;
        materials[i].metallic = looks[i].metallic;
        materials[i].double_sided = i >= ATRIUM_LEAF;
        if (i >= ATRIUM_RED_CLOTH)
            materials[i].normal_scale = 0.4f;
    }
    materials[ATRIUM_WATER].ior = 1.33f;
    materials[ATRIUM_PLASTER].normal_scale = 0.5f;
    materials[ATRIUM_LEAF].alpha_mode = SCENE_ALPHA_MASK;
    set_pictures(materials, &images);
    for (int i = 0; i < ATRIUM_MATERIAL_COUNT; i++)
        if (scene_add_material(scene, &materials[i]) == SCENE_NONE)
            return false;
    return true;
}
