// The tree is Embree's (surface area heuristic), laid out in order of depth.
#include "renderer/resident/triangle_tree.h"

#include <embree3/rtcore.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/resident/resident.h"

#define MAX_LEAF_TRIANGLES 4u
// Embree's own range.
#define MAX_EXTENT 1e17

// A triangle as rays meet it.
struct flat_triangle {
    float corner[3]; // relative to the centre
    uint32_t id;     // visibility id
    float edge_b[3]; // from there
    float opacity;   // mean of a masked material
    float edge_c[3];
    uint32_t flags; // TREE_LIT_DIRECTLY, TREE_ONE_SIDED
};

// What Embree's builder makes, from its own memory.
struct built_node {
    bool leaf;
    struct RTCBounds bounds[2]; // of the children
    struct built_node *children[2];
    uint32_t count; // of a leaf
    uint32_t triangles[MAX_LEAF_TRIANGLES];
};

// Everything on its way to the GPU.
struct tree_work {
    const struct resident *resident;
    float center[3];
    uint32_t triangle_count;
    struct flat_triangle *triangles; // in the order of the document
    struct RTCBuildPrimitive *boxes;
    uint32_t node_count, sorted_count;
    uint32_t (*nodes)[4];         // texels
    struct flat_triangle *sorted; // in the order of the leaves
};

static bool blocks_light(const struct resident_instance *instance)
{
    return instance->visible && instance->group / DRAW_CULL_COUNT != DRAW_TRANSPARENT;
}

// Whether its emission reaches others as that of planar emitters.
static bool emits_directly(const struct resident_instance *instance)
{
    return instance->emits_directly && !instance->large_emitter;
}

static const struct scene_material *material_of(const struct resident *resident,
                                                const struct resident_instance *instance)
{
    const struct scene *scene = resident->scene;
    return &scene->materials[scene->primitives[instance->primitive].material];
}

// Share of rays that its triangles stop.
static float opacity_of(const struct resident *resident, const struct resident_instance *instance)
{
    const struct scene_material *material = material_of(resident, instance);
    if (material->alpha_mode != SCENE_ALPHA_MASK)
        return 1.0f;
    uint32_t image = material->textures[SCENE_TEXTURE_BASE_COLOR].image;
    const struct texture_space *space = &resident->texture_spaces[TEXTURE_SPACE_COLOR];
    return material->base_color[3] * (image == SCENE_NONE ? 1.0f : space->places[image].mean[3]);
}

// Of all that the tree is made from.
static uint64_t content_key(const struct resident *resident)
{
    const struct scene_revisions *now = &resident->scene->revisions;
    uint64_t key = 1469598103934665603ull;
    key = (key ^ now->geometry) * 1099511628211ull;
    key = (key ^ now->transforms) * 1099511628211ull;
    for (uint32_t i = 0; i < resident->counts.instances; i++) {
        const struct resident_instance *instance = &resident->instances[i];
        float opacity = opacity_of(resident, instance);
        uint32_t bits;
        memcpy(&bits, &opacity, sizeof(bits));
        key = (key ^ bits) * 1099511628211ull;
        key = (key ^
               (blocks_light(instance) + 2u * emits_directly(instance) + 4u * instance->group)) *
              1099511628211ull;
    }
    return key;
}

bool resident_need_tree(struct resident *resident)
{
    uint64_t key = content_key(resident);
    if (resident->tree && resident->tree->key == key)
        return true;
    triangle_tree_destroy(&resident->tree);
    resident->tree = triangle_tree_create(resident);
    if (resident->tree)
        resident->tree->key = key;
    return resident->tree != NULL;
}

static void place_corner(const struct tree_work *work, const float matrix[16],
                         const float position[3], double out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = (double)matrix[axis] * position[0] + (double)matrix[4 + axis] * position[1] +
                    (double)matrix[8 + axis] * position[2] + (double)matrix[12 + axis] -
                    (double)work->center[axis];
}

// Adds a triangle unless it has no area or reaches too far.
static void add_triangle(struct tree_work *work, const double corners[3][3],
                         const struct flat_triangle *traits)
{
    struct flat_triangle triangle = *traits;
    struct RTCBuildPrimitive box = {.primID = work->triangle_count};
    float *lower = &box.lower_x, *upper = &box.upper_x;
    double edges[2][3], area[3], extent = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        lower[axis] = (float)fmin(corners[0][axis], fmin(corners[1][axis], corners[2][axis]));
        upper[axis] = (float)fmax(corners[0][axis], fmax(corners[1][axis], corners[2][axis]));
        triangle.corner[axis] = (float)corners[0][axis];
        for (int i = 0; i < 2; i++)
            edges[i][axis] = corners[i + 1][axis] - corners[0][axis];
        triangle.edge_b[axis] = (float)edges[0][axis];
        triangle.edge_c[axis] = (float)edges[1][axis];
        for (int i = 0; i < 3; i++)
            extent = fmax(extent, fabs(corners[i][axis]));
        // Rounding must not leave a corner outside.
        lower[axis] = nextafterf(lower[axis], -INFINITY);
        upper[axis] = nextafterf(upper[axis], INFINITY);
    }
    for (int axis = 0; axis < 3; axis++) {
        int j = (axis + 1) % 3, k = (axis + 2) % 3;
        area[axis] = edges[0][j] * edges[1][k] - edges[0][k] * edges[1][j];
    }
    double size = area[0] * area[0] + area[1] * area[1] + area[2] * area[2];
    if (!(size > 0.0) || !isfinite(size) || !(extent < MAX_EXTENT))
        return;
    work->boxes[work->triangle_count] = box;
    work->triangles[work->triangle_count++] = triangle;
}

// Whether a placement turns triangles over: their edges then change places.
static bool is_mirrored(const float m[16])
{
    double cross[3] = {(double)m[5] * m[10] - (double)m[6] * m[9],
                       (double)m[6] * m[8] - (double)m[4] * m[10],
                       (double)m[4] * m[9] - (double)m[5] * m[8]};
    return m[0] * cross[0] + m[1] * cross[1] + m[2] * cross[2] < 0.0;
}

static void add_instance(struct tree_work *work, const struct resident_instance *instance)
{
    const struct scene *scene = work->resident->scene;
    const struct scene_primitive *primitive = &scene->primitives[instance->primitive];
    const float *matrix = instance->world_from_local;
    struct flat_triangle traits = {
        .opacity = opacity_of(work->resident, instance),
        .flags = (emits_directly(instance) ? TREE_LIT_DIRECTLY : 0) |
                 (material_of(work->resident, instance)->double_sided ? 0 : TREE_ONE_SIDED),
    };
    bool mirrored = is_mirrored(matrix);
    for (uint32_t i = 0; i < instance->index_count / 3; i++) {
        double corners[3][3];
        for (int corner = 0; corner < 3; corner++) {
            uint32_t index = scene->indices[primitive->index_first + 3 * i + (uint32_t)corner];
            int at = mirrored && corner > 0 ? 3 - corner : corner;
            place_corner(work, matrix, scene->vertices[index].position, corners[at]);
        }
        traits.id = instance->first_id + i + 1;
        add_triangle(work, corners, &traits);
    }
}

static bool gather_triangles(struct tree_work *work)
{
    const struct resident *resident = work->resident;
    size_t most = 0;
    for (uint32_t i = 0; i < resident->counts.instances; i++)
        most += blocks_light(&resident->instances[i]) ? resident->instances[i].index_count / 3 : 0;
    for (int axis = 0; axis < 3; axis++)
        work->center[axis] = 0.5f * (resident->bounds_min[axis] + resident->bounds_max[axis]);
    work->triangles = malloc((most + 1) * sizeof(*work->triangles));
    work->sorted = malloc((most + 1) * sizeof(*work->sorted));
    // Embree's primitives are aligned to their size.
    work->boxes = aligned_alloc(32, (most + 1) * sizeof(*work->boxes));
    if (!work->triangles || !work->sorted || !work->boxes)
        return false;
    for (uint32_t i = 0; i < resident->counts.instances; i++)
        if (blocks_light(&resident->instances[i]))
            add_instance(work, &resident->instances[i]);
    return true;
}

static void *create_node(RTCThreadLocalAllocator allocator, unsigned child_count, void *user)
{
    (void)child_count;
    (void)user;
    struct built_node *node = rtcThreadLocalAlloc(allocator, sizeof(*node), 16);
    *node = (struct built_node){0};
    return node;
}

static void set_children(void *node, void **children, unsigned child_count, void *user)
{
    (void)user;
    for (unsigned i = 0; i < child_count; i++)
        ((struct built_node *)node)->children[i] = children[i];
}

static void set_bounds(void *node, const struct RTCBounds **bounds, unsigned child_count,
                       void *user)
{
    (void)user;
    for (unsigned i = 0; i < child_count; i++)
        ((struct built_node *)node)->bounds[i] = *bounds[i];
}

static void *create_leaf(RTCThreadLocalAllocator allocator, const struct RTCBuildPrimitive *boxes,
                         size_t count, void *user)
{
    (void)user;
    struct built_node *node = rtcThreadLocalAlloc(allocator, sizeof(*node), 16);
    *node = (struct built_node){.leaf = true, .count = (uint32_t)count};
    for (size_t i = 0; i < count; i++)
        node->triangles[i] = boxes[i].primID;
    return node;
}

static void write_floats(uint32_t texel[4], const float values[3], uint32_t word)
{
    memcpy(texel, values, 3 * sizeof(float));
    texel[3] = word;
}

static uint32_t flatten(struct tree_work *work, const struct built_node *node);

// A child's word; its triangles go behind those before.
static uint32_t flatten_child(struct tree_work *work, const struct built_node *child)
{
    if (!child)
        return TREE_LEAF;
    if (!child->leaf)
        return flatten(work, child);
    uint32_t first = work->sorted_count;
    for (uint32_t i = 0; i < child->count; i++)
        work->sorted[work->sorted_count++] = work->triangles[child->triangles[i]];
    return TREE_LEAF | first << TREE_COUNT_BITS | child->count;
}

// Recursion goes as deep as the tree, TREE_MAX_DEPTH.
static uint32_t flatten(struct tree_work *work, const struct built_node *node)
{
    uint32_t number = work->node_count++;
    for (int i = 0; i < 2; i++) {
        const struct RTCBounds *bounds = &node->bounds[i];
        const float nothing[2][3] = {{INFINITY, INFINITY, INFINITY},
                                     {-INFINITY, -INFINITY, -INFINITY}};
        const struct built_node *child = node->children[i];
        uint32_t word = flatten_child(work, child);
        uint32_t(*texels)[4] = work->nodes + (size_t)number * TREE_NODE_TEXELS + 2 * i;
        write_floats(texels[0], child ? &bounds->lower_x : nothing[0], word);
        write_floats(texels[1], child ? &bounds->upper_x : nothing[1], 0);
    }
    return number;
}

static bool build(struct tree_work *work)
{
    RTCDevice device = rtcNewDevice(NULL);
    RTCBVH bvh = device ? rtcNewBVH(device) : NULL;
    // Inner nodes are fewer than leaves; the root is one even above a single leaf.
    work->nodes =
        calloc(((size_t)work->triangle_count + 1) * TREE_NODE_TEXELS, sizeof(uint32_t[4]));
    struct built_node *root = NULL;
    if (bvh && work->nodes && work->triangle_count > 0) {
        struct RTCBuildArguments arguments = rtcDefaultBuildArguments();
        arguments.buildQuality = RTC_BUILD_QUALITY_MEDIUM;
        arguments.maxBranchingFactor = 2;
        arguments.maxDepth = TREE_MAX_DEPTH - 1;
        arguments.maxLeafSize = MAX_LEAF_TRIANGLES;
        arguments.bvh = bvh;
        arguments.primitives = work->boxes;
        arguments.primitiveCount = work->triangle_count;
        arguments.primitiveArrayCapacity = work->triangle_count;
        arguments.createNode = create_node;
        arguments.setNodeChildren = set_children;
        arguments.setNodeBounds = set_bounds;
        arguments.createLeaf = create_leaf;
        root = rtcBuildBVH(&arguments);
    }
    bool done = bvh && work->nodes && (root || work->triangle_count == 0);
    if (done) {
        struct built_node above = {.children = {root}};
        if (root)
            above.bounds[0] = (struct RTCBounds){.lower_x = -INFINITY,
                                                 .lower_y = -INFINITY,
                                                 .lower_z = -INFINITY,
                                                 .upper_x = INFINITY,
                                                 .upper_y = INFINITY,
                                                 .upper_z = INFINITY};
        flatten(work, root && !root->leaf ? root : &above);
    }
    if (bvh)
        rtcReleaseBVH(bvh);
    if (device)
        rtcReleaseDevice(device);
    return done;
}

// A texture of so many texels in rows; takes its size from `texels`, which has no padding.
static struct gpu_texture *upload(struct gpu *gpu, const char *label, const void *texels,
                                  size_t count)
{
    size_t width = (size_t)1 << TREE_ROW_BITS;
    size_t height = (count + width - 1) / width;
    height = height ? height : 1;
    if (height > gpu_get_info(gpu)->max_texture_edge)
        return NULL;
    uint32_t(*rows)[4] = calloc(width * height, sizeof(*rows));
    if (!rows)
        return NULL;
    memcpy(rows, texels, count * sizeof(*rows));
    struct gpu_texture_params params = {.label = label,
                                        .format = GPU_FORMAT_RGBA32UI,
                                        .width = (uint32_t)width,
                                        .height = (uint32_t)height,
                                        .filter = GPU_FILTER_NEAREST};
    struct gpu_texture *texture = gpu_texture_create(gpu, &params);
    if (texture)
        gpu_texture_write(texture, 0, 0, rows);
    free(rows);
    return texture;
}

struct triangle_tree *triangle_tree_create(const struct resident *resident)
{
    struct tree_work work = {.resident = resident};
    struct triangle_tree *tree = calloc(1, sizeof(*tree));
    if (tree && gather_triangles(&work) && build(&work)) {
        memcpy(tree->center, work.center, sizeof(tree->center));
        tree->triangle_count = work.sorted_count;
        tree->nodes = upload(resident->gpu, "geometry.tree", work.nodes,
                             (size_t)work.node_count * TREE_NODE_TEXELS);
        tree->triangles = upload(resident->gpu, "geometry.tree", work.sorted,
                                 (size_t)work.sorted_count * TREE_TRIANGLE_TEXELS);
    }
    free(work.triangles);
    free(work.sorted);
    free(work.boxes);
    free(work.nodes);
    if (tree && (!tree->nodes || !tree->triangles))
        triangle_tree_destroy(&tree);
    return tree;
}

void triangle_tree_destroy(struct triangle_tree **tree_slot)
{
    struct triangle_tree *tree = *tree_slot;
    *tree_slot = NULL;
    if (!tree)
        return;
    gpu_texture_destroy(&tree->nodes);
    gpu_texture_destroy(&tree->triangles);
    free(tree);
}
