// Furnishings of the atrium: curtains, banners, plants and the fountain.
#include <math.h>

#include "renderer/import/builtin/atrium.h"
#include "renderer/import/builtin/texture_maker.h"

#define COUNT(items) (sizeof(items) / sizeof((items)[0]))

// One half of a pair of curtains, pulled to its side by a tie.
struct curtain {
    double side; // -1 left, 1 right
    double low, high;
};

static void curtain_position(const void *context, double u, double v, double out_position[3])
{
    const struct curtain *curtain = context;
    const double tie = 0.4; // fraction of the height
    double open = v > tie ? (v - tie) / (1.0 - tie) : 0.55 * (tie - v) / tie;
    open = open * open * (3.0 - 2.0 * open);
    double width = 0.26 + 0.88 * open;
    double fold = sin(2.0 * M_PI * 7.0 * u) + 0.35 * sin(2.0 * M_PI * 3.0 * u + 1.3 + 2.0 * v);
    double amplitude = 0.03 + 0.035 * (1.0 - open);
    double across = curtain->side < 0.0 ? u : 1.0 - u;
    out_position[0] = curtain->side * (1.17 - width * across);
    out_position[1] = curtain->low + (curtain->high - curtain->low) * v;
    out_position[2] = amplitude * fold;
}

static uint32_t make_curtains(struct scene *scene, uint32_t material)
{
    const float rod_y = 3.06f;
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    for (int half = 0; half < 2; half++) {
        struct curtain curtain = {half ? 1.0 : -1.0, 0.3, rod_y - 0.035};
        struct surface_params params = {
            .position = curtain_position,
            .context = &curtain,
            .columns = 72,
            .rows = 32,
            .texture_size = {1.6f, -2.7f},
        };
        mesh_builder_add_surface(&builder, &params);
    }
    uint32_t mesh = mesh_builder_commit_mesh(&builder, scene, "curtains", material);
    mesh_builder_add_rod(&builder, (float[3]){-1.3f, rod_y, 0}, (float[3]){1.3f, rod_y, 0}, 0.022f,
                         12);
    for (int half = 0; half < 2; half++) {
        // The ties.
        mesh_builder_add_node(&builder, half ? 1.04f : -1.04f, 1.39f, 0.0f, 0.0f);
        mesh_builder_add_torus(&builder, 0.155f, 0.018f, 24, 8);
    }
    return mesh_builder_commit(&builder, scene, ATRIUM_BRASS) ? mesh : SCENE_NONE;
}

static void banner_position(const void *context, double u, double v, double out_position[3])
{
    const double *heights = context;
    double loose = 1.0 - v; // the rod keeps it straight
    double wave = 0.05 * sin(2.0 * M_PI * (2.2 * u + 0.3 * v)) +
                  0.03 * sin(2.0 * M_PI * (1.1 * v - 0.7 * u) + 0.6);
    // Two tongues at its lower end.
    double tongue = 0.28 * fabs(2.0 * u - 1.0) * loose;
    out_position[0] = 1.7 * (u - 0.5) * (1.0 - 0.04 * loose);
    out_position[1] = heights[0] + (heights[1] - heights[0]) * v - tongue;
    out_position[2] = -0.78 + wave * (0.15 + 0.85 * loose);
}

static uint32_t make_banner(struct scene *scene, uint32_t material)
{
    const float rod_y = 8.15f;
    const double heights[2] = {4.15, rod_y - 0.02};
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    struct surface_params params = {
        .position = banner_position,
        .context = heights,
        .columns = 40,
        .rows = 48,
        .texture_size = {1.7f, -4.0f},
    };
    mesh_builder_add_surface(&builder, &params);
    uint32_t mesh = mesh_builder_commit_mesh(&builder, scene, "banner", material);
    mesh_builder_add_rod(&builder, (float[3]){-1.58f, rod_y, -0.78f},
                         (float[3]){1.58f, rod_y, -0.78f}, 0.025f, 12);
    for (int end = -1; end <= 1; end += 2) {
        float x = 1.5f * (float)end;
        mesh_builder_add_rod(&builder, (float[3]){x, rod_y - 0.12f, -0.1f},
                             (float[3]){x, rod_y, -0.8f}, 0.018f, 12);
        mesh_builder_add_sphere(&builder, (float[3]){1.6f * (float)end, rod_y, -0.78f}, 0.05f, 16,
                                10);
    }
    return mesh_builder_commit(&builder, scene, ATRIUM_BRASS) ? mesh : SCENE_NONE;
}

// A leaf on an arching stalk from the middle of a pot.
struct leaf {
    double turn, rise, droop; // direction, slope at the base and bend, radians
    double start, length, width;
};

static void leaf_position(const void *context, double u, double v, double out_position[3])
{
    const struct leaf *leaf = context;
    double bend = fmax(leaf->droop * v, 1e-6);
    // A circular arc in the vertical plane of its direction.
    double out = leaf->length * v * (sin(leaf->rise) - sin(leaf->rise - bend)) / bend;
    double up = leaf->length * v * (cos(leaf->rise - bend) - cos(leaf->rise)) / bend;
    out += leaf->start * cos(leaf->rise);
    up += leaf->start * sin(leaf->rise);
    double side = leaf->width * (u - 0.5);
    up -= 0.6 * fabs(side); // a crease along its middle
    out_position[0] = out * sin(leaf->turn) + side * cos(leaf->turn);
    out_position[1] = 0.5 + up;
    out_position[2] = out * cos(leaf->turn) - side * sin(leaf->turn);
}

static void add_leaves(struct mesh_builder *builder)
{
    const uint32_t leaves = 76;
    for (uint32_t i = 0; i < leaves; i++) {
        float inner = (float)i / (float)leaves; // outer leaves hang, inner ones stand
        struct leaf leaf = {
            .turn = 2.399963 * i, // the golden angle
            .rise = 0.45 + 0.95 * inner + 0.15 * texture_random(i, 0, 81),
            .droop = 1.7 - 1.1 * inner + 0.4 * texture_random(i, 1, 81),
            .start = 0.08 + 0.25 * texture_random(i, 2, 81),
            .length = 0.5 + 0.4 * texture_random(i, 3, 81),
            .width = 0.13 + 0.07 * texture_random(i, 4, 81),
        };
        struct surface_params params = {
            .position = leaf_position,
            .context = &leaf,
            .columns = 2,
            .rows = 6,
            .texture_size = {1.0f, -1.0f}, // the stem is at the bottom of the image
        };
        mesh_builder_add_surface(builder, &params);
    }
}

static uint32_t make_plant(struct scene *scene)
{
    static const struct profile_point pot[] = {
        {0.0f, 0.0f, 0},    {0.2f, 0.0f, 0},    {0.215f, 0.015f, 1}, {0.22f, 0.05f, 0},
        {0.225f, 0.05f, 0}, {0.285f, 0.4f, 0},  {0.315f, 0.4f, 0},   {0.325f, 0.42f, 1},
        {0.328f, 0.5f, 1},  {0.315f, 0.52f, 1}, {0.295f, 0.515f, 0}, {0.28f, 0.44f, 0},
    };
    static const struct profile_point soil[] = {{0.285f, 0.46f, 0}, {0.0f, 0.49f, 0}};
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    mesh_builder_add_lathe(&builder, pot, COUNT(pot), 32);
    uint32_t mesh = mesh_builder_commit_mesh(&builder, scene, "potted plant", ATRIUM_TERRACOTTA);
    mesh_builder_add_lathe(&builder, soil, COUNT(soil), 32);
    if (!mesh_builder_commit(&builder, scene, ATRIUM_SOIL))
        return SCENE_NONE;
    add_leaves(&builder);
    return mesh_builder_commit(&builder, scene, ATRIUM_LEAF) ? mesh : SCENE_NONE;
}

static uint32_t make_fountain(struct scene *scene)
{
    static const struct profile_point basin[] = {
        {1.9f, -0.02f, 0}, {1.9f, 0.14f, 0},  {1.62f, 0.14f, 0}, {1.62f, 0.2f, 0},
        {1.55f, 0.24f, 1}, {1.52f, 0.32f, 1}, {1.54f, 0.42f, 1}, {1.6f, 0.46f, 0},
        {1.66f, 0.48f, 1}, {1.67f, 0.54f, 1}, {1.63f, 0.57f, 1}, {1.42f, 0.57f, 1},
        {1.37f, 0.54f, 1}, {1.36f, 0.48f, 0}, {1.36f, 0.2f, 0},  {0.2f, 0.2f, 0},
    };
    static const struct profile_point stem[] = {
        {0.32f, 0.18f, 0}, {0.32f, 0.5f, 0},  {0.24f, 0.54f, 0}, {0.15f, 0.66f, 1},
        {0.13f, 0.85f, 1}, {0.17f, 1.0f, 1},  {0.18f, 1.06f, 1}, {0.12f, 1.14f, 0},
        {0.2f, 1.16f, 0},  {0.42f, 1.24f, 1}, {0.62f, 1.36f, 1}, {0.7f, 1.46f, 0},
        {0.74f, 1.47f, 1}, {0.745f, 1.5f, 1}, {0.73f, 1.52f, 1}, {0.68f, 1.51f, 0},
        {0.58f, 1.42f, 1}, {0.4f, 1.34f, 1},  {0.16f, 1.3f, 0},  {0.12f, 1.36f, 0},
        {0.08f, 1.5f, 1},  {0.07f, 1.62f, 0}, {0.12f, 1.64f, 0}, {0.14f, 1.7f, 1},
        {0.12f, 1.78f, 1}, {0.06f, 1.86f, 1}, {0.0f, 1.9f, 0},
    };
    static const struct profile_point water[] = {{1.4f, 0.46f, 0}, {0.2f, 0.46f, 0}};
    static const struct profile_point bowl_water[] = {{0.66f, 1.47f, 0}, {0.05f, 1.47f, 0}};
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    mesh_builder_add_lathe(&builder, basin, COUNT(basin), 64);
    mesh_builder_add_lathe(&builder, stem, COUNT(stem), 48);
    uint32_t mesh = mesh_builder_commit_mesh(&builder, scene, "fountain", ATRIUM_STONE);
    mesh_builder_add_lathe(&builder, water, COUNT(water), 64);
    mesh_builder_add_lathe(&builder, bowl_water, COUNT(bowl_water), 48);
    return mesh_builder_commit(&builder, scene, ATRIUM_WATER) ? mesh : SCENE_NONE;
}

bool atrium_make_furnishings(struct scene *scene, struct atrium_furnishings *out_furnishings)
{
    static const uint32_t cloths[3] = {ATRIUM_RED_CLOTH, ATRIUM_GREEN_CLOTH, ATRIUM_BLUE_CLOTH};
    struct atrium_furnishings *all = out_furnishings;
    for (int i = 0; i < 3; i++) {
        all->curtains[i] = make_curtains(scene, cloths[i]);
        all->banners[i] = make_banner(scene, cloths[i]);
        if (all->curtains[i] == SCENE_NONE || all->banners[i] == SCENE_NONE)
            return false;
    }
    return (all->plant = make_plant(scene)) != SCENE_NONE &&
           (all->fountain = make_fountain(scene)) != SCENE_NONE;
}
