// The parts of the atrium's building.
#include <math.h>

#include "renderer/import/builtin/atrium.h"
#include "renderer/import/builtin/builtin.h"

#define HALF_BAY     (0.5f * ATRIUM_BAY_M)
#define COUNT(items) (sizeof(items) / sizeof((items)[0]))

static void add_centered_box(struct mesh_builder *builder, float half_edge_m, float low_m,
                             float high_m, float bevel_m)
{
    mesh_builder_add_beveled_box(builder, (float[3]){-half_edge_m, low_m, -half_edge_m},
                                 (float[3]){half_edge_m, high_m, half_edge_m}, bevel_m);
}

static uint32_t make_arch(struct scene *scene)
{
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    struct arch_params wall = {
        .width_m = ATRIUM_BAY_M,
        .thickness_m = ATRIUM_WALL_M,
        .top_m = ATRIUM_ARCH_RISE_M,
        .radius_m = {1.2f, 1.2f},
        .segments = 32,
    };
    mesh_builder_add_arch_wall(&builder, &wall);
    uint32_t mesh = mesh_builder_commit_mesh(&builder, scene, "arch", ATRIUM_ASHLAR);
    // Mouldings project from the wall, the keystone from the mouldings.
    mesh_builder_add_arch_band(&builder, (float[2]){1.185f, 1.185f}, (float[2]){1.3f, 1.3f},
                               ATRIUM_WALL_M + 0.06f, 32);
    mesh_builder_add_arch_band(&builder, (float[2]){1.29f, 1.29f}, (float[2]){1.41f, 1.41f},
                               ATRIUM_WALL_M + 0.11f, 32);
    mesh_builder_add_beveled_box(&builder, (float[3]){-0.11f, 1.13f, -0.34f},
                                 (float[3]){0.11f, 1.5f, 0.34f}, 0.02f);
    return mesh_builder_commit(&builder, scene, ATRIUM_STONE) ? mesh : SCENE_NONE;
}

// A quarter of a groin vault: the barrel whose axis is X, on the side of +X. u runs across it.
static void vault_position(const void *context, double u, double v, double out_position[3])
{
    const double *rise = context;
    double angle = M_PI * (u - 0.5);
    double across = sin(angle), along = fabs(across) + (1.0 - fabs(across)) * v;
    out_position[0] = HALF_BAY * along;
    out_position[1] = *rise * cos(angle);
    out_position[2] = HALF_BAY * across;
}

static void vault_normal(const void *context, double u, double v, double out_normal[3])
{
    (void)v;
    const double *rise = context;
    double angle = M_PI * (u - 0.5);
    out_normal[0] = 0.0;
    out_normal[1] = HALF_BAY * cos(angle);
    out_normal[2] = *rise * sin(angle);
    double length = hypot(out_normal[1], out_normal[2]);
    out_normal[1] /= length;
    out_normal[2] /= length;
}

static uint32_t make_vault(struct scene *scene)
{
    const double rise = 1.45;
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    for (int quarter = 0; quarter < 4; quarter++) {
        mesh_builder_add_node(&builder, 0.0f, 0.0f, HALF_BAY, (float)M_PI_2 * (float)quarter);
        struct surface_params params = {
            .position = vault_position,
            .normal = vault_normal,
            .context = &rise,
            .columns = 24,
            .rows = 6,
            .texture_size = {4.6f, 1.5f},
            .flipped = true, // seen from below
        };
        mesh_builder_add_surface(&builder, &params);
    }
    return mesh_builder_commit_mesh(&builder, scene, "groin vault", ATRIUM_PLASTER);
}

static uint32_t make_rib(struct scene *scene)
{
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    mesh_builder_add_node(&builder, 0.0f, 0.0f, HALF_BAY, (float)M_PI_2);
    mesh_builder_add_arch_band(&builder, (float[2]){1.33f, 1.28f}, (float[2]){1.57f, 1.52f}, 0.4f,
                               32);
    return mesh_builder_commit_mesh(&builder, scene, "vault rib", ATRIUM_STONE);
}

static uint32_t make_coffers(struct scene *scene)
{
    const unsigned sides = BOX_LEFT | BOX_RIGHT | BOX_BOTTOM;
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    for (int i = -1; i <= 1; i++) {
        float x = (float)i, z = 1.55f + 0.85f * (float)i;
        mesh_builder_add_box(&builder, (float[3]){x - 0.1f, -0.28f, 0.2f},
                             (float[3]){x + 0.1f, 0.0f, ATRIUM_GALLERY_DEPTH_M + 0.05f}, sides);
        mesh_builder_add_box(&builder, (float[3]){-HALF_BAY, -0.2f, z - 0.08f},
                             (float[3]){HALF_BAY, 0.0f, z + 0.08f},
                             BOX_FRONT | BOX_BACK | BOX_BOTTOM);
    }
    return mesh_builder_commit_mesh(&builder, scene, "coffers", ATRIUM_WOOD);
}

static uint32_t make_ground_column(struct scene *scene)
{
    static const struct profile_point base[] = {
        {0.3f, 0.14f, 0},   {0.318f, 0.16f, 1}, {0.325f, 0.19f, 1},  {0.318f, 0.22f, 1},
        {0.298f, 0.24f, 0}, {0.28f, 0.24f, 0},  {0.262f, 0.265f, 1}, {0.265f, 0.29f, 0},
        {0.285f, 0.29f, 0}, {0.293f, 0.31f, 1}, {0.285f, 0.33f, 0},  {0.262f, 0.33f, 0},
        {0.248f, 0.36f, 1}, {0.242f, 0.4f, 0},  {0.2f, 0.4f, 0},
    };
    static const struct profile_point capital[] = {
        {0.17f, 2.62f, 0},   {0.203f, 2.62f, 0},  {0.2f, 2.66f, 0},  {0.222f, 2.665f, 1},
        {0.228f, 2.68f, 1},  {0.222f, 2.695f, 1}, {0.2f, 2.7f, 0},   {0.2f, 2.78f, 0},
        {0.225f, 2.785f, 0}, {0.225f, 2.8f, 0},   {0.24f, 2.82f, 1}, {0.27f, 2.86f, 1},
        {0.29f, 2.91f, 1},   {0.292f, 2.95f, 1},  {0.28f, 2.98f, 0}, {0.2f, 2.98f, 0},
    };
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    add_centered_box(&builder, 0.335f, -0.02f, 0.14f, 0.012f);
    mesh_builder_add_lathe(&builder, base, COUNT(base), 28);
    mesh_builder_add_fluted_shaft(&builder, (float[2]){0.24f, 0.203f}, (float[2]){0.4f, 2.62f}, 20,
                                  0.016f);
    mesh_builder_add_lathe(&builder, capital, COUNT(capital), 28);
    add_centered_box(&builder, 0.31f, 2.97f, 3.05f, 0.012f);
    add_centered_box(&builder, 0.35f, 3.04f, 3.16f, 0.015f);
    return mesh_builder_commit_mesh(&builder, scene, "fluted column", ATRIUM_STONE);
}

static uint32_t make_upper_column(struct scene *scene)
{
    static const struct profile_point shaft[] = {
        {0.2f, 1.02f, 0},   {0.218f, 1.04f, 1},  {0.222f, 1.065f, 1}, {0.215f, 1.09f, 0},
        {0.19f, 1.1f, 0},   {0.18f, 1.14f, 1},   {0.178f, 1.4f, 1},   {0.17f, 2.0f, 1},
        {0.155f, 2.62f, 0}, {0.172f, 2.625f, 1}, {0.178f, 2.64f, 1},  {0.172f, 2.655f, 0},
        {0.155f, 2.66f, 0}, {0.155f, 2.74f, 0},  {0.18f, 2.77f, 1},   {0.22f, 2.83f, 1},
        {0.232f, 2.88f, 1}, {0.225f, 2.905f, 0}, {0.1f, 2.905f, 0},
    };
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    // The pedestal closes the balustrades on both sides.
    add_centered_box(&builder, 0.28f, 0.02f, 0.17f, 0.015f);
    add_centered_box(&builder, 0.235f, 0.16f, 0.86f, 0.012f);
    add_centered_box(&builder, 0.285f, 0.85f, 0.95f, 0.015f);
    add_centered_box(&builder, 0.235f, 0.94f, 1.02f, 0.01f);
    mesh_builder_add_lathe(&builder, shaft, COUNT(shaft), 28);
    add_centered_box(&builder, 0.27f, 2.9f, 2.98f, 0.012f);
    add_centered_box(&builder, 0.35f, 2.97f, 3.11f, 0.015f);
    return mesh_builder_commit_mesh(&builder, scene, "column on its pedestal", ATRIUM_STONE);
}

static uint32_t make_balustrade(struct scene *scene)
{
    static const struct profile_point baluster[] = {
        {0.062f, 0.19f, 0}, {0.062f, 0.22f, 0}, {0.04f, 0.245f, 1}, {0.05f, 0.29f, 1},
        {0.072f, 0.36f, 1}, {0.078f, 0.42f, 1}, {0.062f, 0.5f, 1},  {0.042f, 0.58f, 1},
        {0.036f, 0.66f, 1}, {0.042f, 0.7f, 0},  {0.055f, 0.71f, 0}, {0.055f, 0.73f, 0},
        {0.045f, 0.74f, 0}, {0.06f, 0.77f, 0},  {0.06f, 0.81f, 0},
    };
    const int balusters = 11;
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    // The rails end inside the pedestals.
    mesh_builder_add_beveled_box(&builder, (float[3]){-1.3f, 0.03f, -0.13f},
                                 (float[3]){1.3f, 0.195f, 0.13f}, 0.012f);
    mesh_builder_add_beveled_box(&builder, (float[3]){-1.3f, 0.8f, -0.15f},
                                 (float[3]){1.3f, 0.93f, 0.15f}, 0.02f);
    for (int i = 0; i < balusters; i++) {
        float x = 2.3f * ((float)i / (float)(balusters - 1) - 0.5f);
        mesh_builder_add_node(&builder, x, 0.0f, 0.0f, 0.0f);
        mesh_builder_add_lathe(&builder, baluster, COUNT(baluster), 12);
    }
    return mesh_builder_commit_mesh(&builder, scene, "balustrade", ATRIUM_STONE);
}

// A corner pier from the floor to `top_m` with the heads of its bands at the springing line.
static uint32_t make_pier(struct scene *scene, const char *name, float spring_m, float top_m)
{
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    add_centered_box(&builder, 0.42f, -0.02f, 0.25f, 0.02f);
    add_centered_box(&builder, 0.36f, 0.24f, top_m, 0.01f);
    add_centered_box(&builder, 0.385f, spring_m - 0.24f, spring_m - 0.15f, 0.012f);
    add_centered_box(&builder, 0.42f, spring_m - 0.16f, spring_m, 0.02f);
    return mesh_builder_commit_mesh(&builder, scene, name, ATRIUM_STONE);
}

static uint32_t make_pilaster(struct scene *scene)
{
    const float spring = ATRIUM_GROUND_SPRING_M - ATRIUM_GROUND_FLOOR_M;
    const float bands[][4] = {
        // half width, depth, low, high
        {0.26f, 0.23f, -0.02f, 0.2f},
        {0.21f, 0.17f, 0.19f, spring - 0.1f},
        {0.235f, 0.2f, spring - 0.26f, spring - 0.19f},
        {0.26f, 0.24f, spring - 0.13f, spring + 0.01f},
    };
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    for (size_t i = 0; i < COUNT(bands); i++)
        mesh_builder_add_beveled_box(
            &builder, (float[3]){-bands[i][0], bands[i][2], ATRIUM_GALLERY_DEPTH_M - bands[i][1]},
            (float[3]){bands[i][0], bands[i][3], ATRIUM_GALLERY_DEPTH_M + 0.1f}, 0.012f);
    return mesh_builder_commit_mesh(&builder, scene, "pilaster", ATRIUM_STONE);
}

static void add_wall_box(struct mesh_builder *builder, float left, float right, float low,
                         float high, float depth)
{
    mesh_builder_add_beveled_box(builder, (float[3]){left, low, ATRIUM_GALLERY_DEPTH_M - depth},
                                 (float[3]){right, high, ATRIUM_GALLERY_DEPTH_M + 0.05f}, 0.012f);
}

static uint32_t make_door(struct scene *scene)
{
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    add_wall_box(&builder, -0.78f, -0.6f, -0.01f, 2.5f, 0.12f);
    add_wall_box(&builder, 0.6f, 0.78f, -0.01f, 2.5f, 0.12f);
    add_wall_box(&builder, -0.82f, 0.82f, 2.48f, 2.66f, 0.14f);
    add_wall_box(&builder, -0.9f, 0.9f, 2.65f, 2.74f, 0.22f);
    uint32_t mesh = mesh_builder_commit_mesh(&builder, scene, "door", ATRIUM_STONE);
    add_wall_box(&builder, -0.61f, 0.61f, 0.0f, 2.49f, 0.04f);
    for (int leaf = 0; leaf < 2; leaf++)
        for (int panel = 0; panel < 4; panel++) {
            float left = leaf ? 0.06f : -0.54f, low = 0.12f + 0.59f * (float)panel;
            add_wall_box(&builder, left, left + 0.48f, low, low + 0.5f, 0.065f);
            add_wall_box(&builder, left + 0.09f, left + 0.39f, low + 0.09f, low + 0.41f, 0.085f);
        }
    if (!mesh_builder_commit(&builder, scene, ATRIUM_WOOD))
        return SCENE_NONE;
    for (int leaf = 0; leaf < 2; leaf++)
        mesh_builder_add_sphere(
            &builder, (float[3]){leaf ? 0.03f : -0.03f, 1.25f, ATRIUM_GALLERY_DEPTH_M - 0.085f},
            0.025f, 12, 8);
    return mesh_builder_commit(&builder, scene, ATRIUM_BRASS) ? mesh : SCENE_NONE;
}

bool atrium_make_parts(struct scene *scene, struct atrium_parts *out_parts)
{
    struct atrium_parts *parts = out_parts;
    return (parts->arch = make_arch(scene)) != SCENE_NONE &&
           (parts->vault = make_vault(scene)) != SCENE_NONE &&
           (parts->rib = make_rib(scene)) != SCENE_NONE &&
           (parts->coffers = make_coffers(scene)) != SCENE_NONE &&
           (parts->ground_column = make_ground_column(scene)) != SCENE_NONE &&
           (parts->upper_column = make_upper_column(scene)) != SCENE_NONE &&
           (parts->balustrade = make_balustrade(scene)) != SCENE_NONE &&
           (parts->ground_pier = make_pier(scene, "corner pier, ground floor", 3.15f, 4.9f)) !=
               SCENE_NONE &&
           (parts->upper_pier = make_pier(scene, "corner pier, upper floor", 3.1f, 4.85f)) !=
               SCENE_NONE &&
           (parts->pilaster = make_pilaster(scene)) != SCENE_NONE &&
           (parts->door = make_door(scene)) != SCENE_NONE;
}

struct ring {
    const char *name;
    enum atrium_material material;
    const struct profile_point *profile;
    uint32_t count;
};

static bool add_ring(struct scene *scene, const struct ring *ring)
{
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    mesh_builder_add_loop(&builder, (float[2]){ATRIUM_COURT_HALF_X, ATRIUM_COURT_HALF_Z},
                          ring->profile, ring->count);
    uint32_t mesh = mesh_builder_commit_mesh(&builder, scene, ring->name, ring->material);
    return mesh != SCENE_NONE && builtin_add_mesh_node(scene, ring->name, mesh) != SCENE_NONE;
}

// Cross sections of a gallery: `out` from the court line. The solid is on the left.
static const struct profile_point ground_floor[] = {
    {3.05f, 0.15f, 0}, {-0.5f, 0.15f, 0}, {-0.52f, 0.13f, 0}, {-0.52f, -0.02f, 0}};
static const struct profile_point outer_wall[] = {{3.0f, 11.9f, 0}, {3.0f, 0.05f, 0}};
static const struct profile_point outer_face[] = {
    {3.4f, 0.0f, 0}, {3.4f, 11.9f, 0}, {2.95f, 11.9f, 0}};
static const struct profile_point upper_slab[] = {
    {-0.25f, 5.42f, 0}, {-0.25f, 5.0f, 0}, {3.05f, 5.0f, 0}};
static const struct profile_point upper_floor[] = {{3.05f, 5.4f, 0}, {0.27f, 5.4f, 0}};
static const struct profile_point lower_cornice[] = {
    {0.28f, 5.35f, 0},  {0.28f, 5.45f, 0},  {-0.5f, 5.45f, 0},  {-0.5f, 5.38f, 0},
    {-0.48f, 5.36f, 1}, {-0.47f, 5.32f, 1}, {-0.43f, 5.27f, 1}, {-0.37f, 5.25f, 0},
    {-0.37f, 5.2f, 0},  {-0.33f, 5.18f, 0}, {-0.33f, 5.05f, 0}, {-0.3f, 5.03f, 0},
    {-0.3f, 4.93f, 0},  {-0.24f, 4.93f, 0},
};
static const struct profile_point ceiling[] = {{3.05f, 10.65f, 0}, {0.2f, 10.65f, 0}};
static const struct profile_point ceiling_under[] = {
    {-0.25f, 10.8f, 0}, {-0.25f, 10.2f, 0}, {3.05f, 10.2f, 0}};
static const struct profile_point upper_cornice[] = {
    {-0.24f, 10.62f, 0}, {-0.58f, 10.62f, 0}, {-0.58f, 10.55f, 0}, {-0.56f, 10.53f, 1},
    {-0.54f, 10.48f, 1}, {-0.48f, 10.42f, 1}, {-0.4f, 10.4f, 0},   {-0.4f, 10.34f, 0},
    {-0.35f, 10.32f, 0}, {-0.35f, 10.18f, 0}, {-0.31f, 10.16f, 0}, {-0.31f, 10.04f, 0},
    {-0.24f, 10.04f, 0},
};
static const struct profile_point roof[] = {{-0.8f, 10.6f, 0},
                                            {3.75f, 11.95f, 0},
                                            {3.75f, 12.2f, 0},
                                            {-0.8f, 10.85f, 0},
                                            {-0.8f, 10.6f, 0}};

bool atrium_add_rings(struct scene *scene)
{
    const struct ring rings[] = {
        {"gallery floor", ATRIUM_TILES, ground_floor, COUNT(ground_floor)},
        {"outer wall, inside", ATRIUM_PLASTER, outer_wall, COUNT(outer_wall)},
        {"outer wall, outside", ATRIUM_ASHLAR, outer_face, COUNT(outer_face)},
        {"upper gallery slab", ATRIUM_PLASTER, upper_slab, COUNT(upper_slab)},
        {"upper gallery floor", ATRIUM_TILES, upper_floor, COUNT(upper_floor)},
        {"lower cornice", ATRIUM_STONE, lower_cornice, COUNT(lower_cornice)},
        {"loft floor", ATRIUM_PLASTER, ceiling, COUNT(ceiling)},
        {"upper gallery ceiling", ATRIUM_PLASTER, ceiling_under, COUNT(ceiling_under)},
        {"upper cornice", ATRIUM_STONE, upper_cornice, COUNT(upper_cornice)},
        {"roof", ATRIUM_ROOF, roof, COUNT(roof)},
    };
    for (size_t i = 0; i < COUNT(rings); i++)
        if (!add_ring(scene, &rings[i]))
            return false;
    return true;
}
