// Builds with Embree (surface area heuristic); lays nodes out depth first.
#include "renderer/gpu_scene/bvh.h"

#include <embree3/rtcore.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/gpu_scene/gpu_scene.h"
#include "renderer/hash.h"
#include "renderer/scene/scene.h"

#define MAX_LEAF_TRIANGLES 4u
// Of entries in the scene cache: raise it when the layout or the building changes.
#define CACHE_VERSION    1
#define MAX_CACHED_BYTES (1u << 30)
// Embree's limit.
#define MAX_EXTENT 1e17

// A triangle as stored for rays.
struct flat_triangle {
    float corner[3]; // relative to the centre
    uint32_t id;     // visibility id
    float edge_b[3]; // from the corner
    float opacity;   // mean of the material's mask
    float edge_c[3];
    uint32_t flags; // BVH_LIT_DIRECTLY, BVH_ONE_SIDED
};

// Output of Embree's builder, in its own memory: nodes and leaves begin alike.
struct built_node {
    bool leaf;
    struct built_node *children[2];
    struct RTCBounds bounds[2]; // of the children
};

struct built_leaf {
    bool leaf;
    uint32_t count;
    uint32_t triangles[MAX_LEAF_TRIANGLES];
};

// A BVH in memory as it is uploaded, and as the scene cache keeps it; then come the triangles, in
// the order of the leaves, and the nodes.
struct bvh_image {
    uint32_t triangle_count;
    uint32_t node_count;
    uint32_t unused[2]; // 0
};

// Build state.
struct bvh_work {
    const struct gpu_scene *gpu_scene;
    float center[3];
    uint32_t triangle_count;
    struct bvh_image *image;         // with room for as many nodes as there can be
    struct flat_triangle *triangles; // in it, in the scene's order at first
    struct RTCBuildPrimitive *boxes;
    uint32_t node_count, sorted_count;
    uint32_t (*nodes)[4]; // texels; in `image`
    uint32_t *order;      // of the leaves: numbers of triangles
};

static bool blocks_light(const struct gpu_scene_instance *instance)
{
    return instance->visible && instance->group / DRAW_CULL_COUNT != DRAW_TRANSPARENT;
}

// Whether its emission is sampled directly as planar emitters.
static bool emits_directly(const struct gpu_scene_instance *instance)
{
    return instance->emits_directly && !instance->large_emitter;
}

static const struct scene_material *material_of(const struct gpu_scene *gpu_scene,
                                                const struct gpu_scene_instance *instance)
{
    const struct scene *scene = gpu_scene->scene;
    return &scene->materials[scene->primitives[instance->primitive].material];
}

// Fraction of rays that its triangles stop.
static float opacity_of(const struct gpu_scene *gpu_scene,
                        const struct gpu_scene_instance *instance)
{
    const struct scene_material *material = material_of(gpu_scene, instance);
    if (material->alpha_mode != SCENE_ALPHA_MASK)
        return 1.0f;
    uint32_t image = material->textures[SCENE_TEXTURE_BASE_COLOR].image;
    const struct texture_space *space = &gpu_scene->texture_spaces[TEXTURE_SPACE_COLOR];
    return material->base_color[3] *
           (image == SCENE_NONE ? 1.0f : space->image_slots[image].mean[3]);
}

// Hash of everything that the BVH is built from.
static uint64_t content_key(const struct gpu_scene *gpu_scene)
{
    const struct scene_revisions *now = &gpu_scene->scene->revisions;
    uint64_t key = HASH_START;
    key = hash_word(key, now->geometry);
    key = hash_word(key, now->transforms);
    for (uint32_t i = 0; i < gpu_scene->counts.instances; i++) {
        const struct gpu_scene_instance *instance = &gpu_scene->instances[i];
        float opacity = opacity_of(gpu_scene, instance);
        uint32_t bits;
        memcpy(&bits, &opacity, sizeof(bits));
        key = hash_word(key, bits);
        key = hash_word(key, blocks_light(instance) + 2u * emits_directly(instance) +
                                 4u * instance->group);
    }
    return key;
}

static struct flat_triangle *triangles_of(struct bvh_image *image)
{
    return (struct flat_triangle *)(image + 1);
}

static size_t image_bytes(size_t triangle_count, size_t node_count)
{
    return sizeof(struct bvh_image) + triangle_count * sizeof(struct flat_triangle) +
           node_count * BVH_NODE_TEXELS * sizeof(uint32_t[4]);
}

// Key of everything that the BVH is built from, by content.
static struct cache_key content_cache_key(const struct gpu_scene *gpu_scene)
{
    const struct scene *scene = gpu_scene->scene;
    struct cache_key key = cache_key_start("bvh", CACHE_VERSION);
    cache_key_add(&key, scene->vertices, scene->vertex_count * sizeof(*scene->vertices));
    cache_key_add(&key, scene->indices, scene->index_count * sizeof(*scene->indices));
    cache_key_add(&key, gpu_scene->bounds_min, sizeof(gpu_scene->bounds_min));
    cache_key_add(&key, gpu_scene->bounds_max, sizeof(gpu_scene->bounds_max));
    for (uint32_t i = 0; i < gpu_scene->counts.instances; i++) {
        const struct gpu_scene_instance *instance = &gpu_scene->instances[i];
        const uint32_t words[] = {
            instance->index_first,    instance->index_count,
            instance->first_id,       blocks_light(instance),
            emits_directly(instance), material_of(gpu_scene, instance)->double_sided};
        float opacity = opacity_of(gpu_scene, instance);
        cache_key_add(&key, words, sizeof(words));
        cache_key_add(&key, &opacity, sizeof(opacity));
        cache_key_add(&key, instance->world_from_local, sizeof(instance->world_from_local));
    }
    return key;
}

bool gpu_scene_need_bvh(struct gpu_scene *gpu_scene)
{
    uint64_t key = content_key(gpu_scene);
    if (gpu_scene->bvh && gpu_scene->bvh->key == key)
        return true;
    bvh_destroy(&gpu_scene->bvh);
    // Those of edited scenes hardly ever come back.
    gpu_scene->bvh = bvh_create(gpu_scene, !gpu_scene->bvh_made);
    gpu_scene->bvh_made = true;
    if (gpu_scene->bvh)
        gpu_scene->bvh->key = key;
    return gpu_scene->bvh != NULL;
}

static void to_scene_corner(const struct bvh_work *work, const float matrix[16],
                            const float position[3], double out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = (double)matrix[axis] * position[0] + (double)matrix[4 + axis] * position[1] +
                    (double)matrix[8 + axis] * position[2] + (double)matrix[12 + axis] -
                    (double)work->center[axis];
}

// Adds a triangle unless it has no area or exceeds MAX_EXTENT.
static void add_triangle(struct bvh_work *work, const double corners[3][3],
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
        // Rounds outwards, so that no corner is outside.
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

// Whether a transform mirrors triangles, which swaps their edges.
static bool is_mirrored(const float m[16])
{
    double cross[3] = {(double)m[5] * m[10] - (double)m[6] * m[9],
                       (double)m[6] * m[8] - (double)m[4] * m[10],
                       (double)m[4] * m[9] - (double)m[5] * m[8]};
    return m[0] * cross[0] + m[1] * cross[1] + m[2] * cross[2] < 0.0;
}

static void add_instance(struct bvh_work *work, const struct gpu_scene_instance *instance)
{
    const struct scene *scene = work->gpu_scene->scene;
    const struct scene_primitive *primitive = &scene->primitives[instance->primitive];
    const float *matrix = instance->world_from_local;
    struct flat_triangle traits = {
        .opacity = opacity_of(work->gpu_scene, instance),
        .flags = (emits_directly(instance) ? BVH_LIT_DIRECTLY : 0) |
                 (material_of(work->gpu_scene, instance)->double_sided ? 0 : BVH_ONE_SIDED),
    };
    bool mirrored = is_mirrored(matrix);
    for (uint32_t i = 0; i < instance->index_count / 3; i++) {
        double corners[3][3];
        for (int corner = 0; corner < 3; corner++) {
            uint32_t index = scene->indices[primitive->index_first + 3 * i + (uint32_t)corner];
            int at = mirrored && corner > 0 ? 3 - corner : corner;
            to_scene_corner(work, matrix, scene->vertices[index].position, corners[at]);
        }
        traits.id = instance->first_id + i + 1;
        add_triangle(work, corners, &traits);
    }
}

static void find_center(const struct gpu_scene *gpu_scene, float out_center[3])
{
    for (int axis = 0; axis < 3; axis++)
        out_center[axis] = 0.5f * (gpu_scene->bounds_min[axis] + gpu_scene->bounds_max[axis]);
}

static bool collect_triangles(struct bvh_work *work)
{
    const struct gpu_scene *gpu_scene = work->gpu_scene;
    size_t maximum = 0;
    for (uint32_t i = 0; i < gpu_scene->counts.instances; i++)
        maximum +=
            blocks_light(&gpu_scene->instances[i]) ? gpu_scene->instances[i].index_count / 3 : 0;
    find_center(gpu_scene, work->center);
    // There are fewer inner nodes than leaves; the root is a node even above a single leaf. Pages
    // that no node reaches take no memory.
    work->image = calloc(1, image_bytes(maximum, maximum + 1));
    work->order = malloc((maximum + 1) * sizeof(*work->order));
    // Embree requires primitives aligned to their size.
    work->boxes = aligned_alloc(32, (maximum + 1) * sizeof(*work->boxes));
    if (!work->image || !work->order || !work->boxes)
        return false;
    work->triangles = triangles_of(work->image);
    for (uint32_t i = 0; i < gpu_scene->counts.instances; i++)
        if (blocks_light(&gpu_scene->instances[i]))
            add_instance(work, &gpu_scene->instances[i]);
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
    struct built_leaf *leaf = rtcThreadLocalAlloc(allocator, sizeof(*leaf), 16);
    *leaf = (struct built_leaf){.leaf = true, .count = (uint32_t)count};
    for (size_t i = 0; i < count; i++)
        leaf->triangles[i] = boxes[i].primID;
    return leaf;
}

static void write_floats(uint32_t texel[4], const float values[3], uint32_t word)
{
    memcpy(texel, values, 3 * sizeof(float));
    texel[3] = word;
}

static uint32_t flatten(struct bvh_work *work, const struct built_node *node);

// A child's word; appends the triangles of a leaf.
static uint32_t flatten_child(struct bvh_work *work, const struct built_node *child)
{
    if (!child)
        return BVH_LEAF;
    if (!child->leaf)
        return flatten(work, child);
    const struct built_leaf *leaf = (const struct built_leaf *)child;
    uint32_t first = work->sorted_count;
    for (uint32_t i = 0; i < leaf->count; i++)
        work->order[work->sorted_count++] = leaf->triangles[i];
    return BVH_LEAF | first << BVH_COUNT_BITS | leaf->count;
}

// Recursion depth is that of the BVH, at most BVH_MAX_DEPTH.
static uint32_t flatten(struct bvh_work *work, const struct built_node *node)
{
    uint32_t number = work->node_count++;
    for (int i = 0; i < 2; i++) {
        const struct RTCBounds *bounds = &node->bounds[i];
        const float nothing[2][3] = {{INFINITY, INFINITY, INFINITY},
                                     {-INFINITY, -INFINITY, -INFINITY}};
        const struct built_node *child = node->children[i];
        uint32_t word = flatten_child(work, child);
        uint32_t(*texels)[4] = work->nodes + (size_t)number * BVH_NODE_TEXELS + 2 * i;
        write_floats(texels[0], child ? &bounds->lower_x : nothing[0], word);
        write_floats(texels[1], child ? &bounds->upper_x : nothing[1], 0);
    }
    return number;
}

// Moves triangles to the order of the leaves, in place: Embree puts each into one leaf.
static void sort_triangles(struct bvh_work *work)
{
    for (uint32_t i = 0; i < work->triangle_count; i++) {
        struct flat_triangle first = work->triangles[i];
        uint32_t at = i;
        while (work->order[at] != i) { // fills `at` from where its triangle is now
            uint32_t from = work->order[at];
            work->triangles[at] = work->triangles[from];
            work->order[at] = at;
            at = from;
        }
        work->triangles[at] = first;
        work->order[at] = at;
    }
}

static bool build(struct bvh_work *work)
{
    RTCDevice device = rtcNewDevice(NULL);
    RTCBVH embree_bvh = device ? rtcNewBVH(device) : NULL;
    work->nodes = (uint32_t(*)[4])(work->triangles + work->triangle_count);
    struct built_node *root = NULL;
    if (embree_bvh && work->triangle_count > 0) {
        struct RTCBuildArguments arguments = rtcDefaultBuildArguments();
        arguments.buildQuality = RTC_BUILD_QUALITY_MEDIUM;
        arguments.maxBranchingFactor = 2;
        arguments.maxDepth = BVH_MAX_DEPTH - 1;
        arguments.maxLeafSize = MAX_LEAF_TRIANGLES;
        arguments.bvh = embree_bvh;
        arguments.primitives = work->boxes;
        arguments.primitiveCount = work->triangle_count;
        arguments.primitiveArrayCapacity = work->triangle_count;
        arguments.createNode = create_node;
        arguments.setNodeChildren = set_children;
        arguments.setNodeBounds = set_bounds;
        arguments.createLeaf = create_leaf;
        root = rtcBuildBVH(&arguments);
    }
    free(work->boxes);
    work->boxes = NULL;
    bool done = embree_bvh && (root || work->triangle_count == 0);
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
    if (embree_bvh)
        rtcReleaseBVH(embree_bvh);
    if (device)
        rtcReleaseDevice(device);
    return done;
}

static struct gpu_buffer *upload(struct gpu *gpu, const void *texels, size_t count)
{
    if (!gpu_texels_fit(gpu, GPU_TEXEL_UINT4, count * 16))
        return NULL;
    return gpu_buffer_create(gpu, "geometry.bvh", GPU_BUFFER_STATIC, count * 4 * sizeof(uint32_t),
                             texels);
}

// From a built or restored image. NULL when memory runs out.
static struct bvh *upload_image(const struct gpu_scene *gpu_scene, struct bvh_image *image)
{
    struct bvh *bvh = calloc(1, sizeof(*bvh));
    if (!bvh)
        return NULL;
    const struct flat_triangle *triangles = triangles_of(image);
    size_t count = image->triangle_count;
    find_center(gpu_scene, bvh->center);
    bvh->triangle_count = image->triangle_count;
    bvh->nodes =
        upload(gpu_scene->gpu, triangles + count, (size_t)image->node_count * BVH_NODE_TEXELS);
    bvh->triangles = upload(gpu_scene->gpu, triangles, count * BVH_TRIANGLE_TEXELS);
    if (!bvh->nodes || !bvh->triangles)
        bvh_destroy(&bvh);
    return bvh;
}

// Whether a node's word leads to triangles that there are, or to a node after it at a depth that
// shaders' stacks allow. Notes that node's depth.
static bool check_child(const struct bvh_image *image, uint8_t depths[], uint32_t node,
                        uint32_t word)
{
    if (word & BVH_LEAF) {
        uint32_t count = word & ((1u << BVH_COUNT_BITS) - 1u);
        uint32_t first = (word & ~BVH_LEAF) >> BVH_COUNT_BITS;
        return count == 0 ||
               (first <= image->triangle_count && count <= image->triangle_count - first);
    }
    if (word <= node || word >= image->node_count || depths[node] + 1 >= BVH_MAX_DEPTH)
        return false;
    depths[word] = depths[word] > depths[node] ? depths[word] : (uint8_t)(depths[node] + 1);
    return true;
}

static bool check_image(struct bvh_image *image, size_t size)
{
    if (size < sizeof(*image) || image->node_count == 0 ||
        size != image_bytes(image->triangle_count, image->node_count))
        return false;
    uint8_t *depths = calloc(image->node_count, sizeof(*depths));
    const uint32_t(*nodes)[4] = (const uint32_t(*)[4])(triangles_of(image) + image->triangle_count);
    bool fine = depths != NULL;
    for (uint32_t i = 0; i < image->node_count && fine; i++)
        for (uint32_t child = 0; child < 2; child++)
            fine = fine && check_child(image, depths, i, nodes[i * BVH_NODE_TEXELS + 2 * child][3]);
    free(depths);
    return fine;
}

// The scene's first BVH from the scene cache; NULL if it is not there.
static struct bvh *restore(const struct gpu_scene *gpu_scene, const struct cache_key *key)
{
    size_t size = 0;
    struct bvh_image *image = scene_cache_read(key, MAX_CACHED_BYTES, &size);
    struct bvh *bvh = image && check_image(image, size) ? upload_image(gpu_scene, image) : NULL;
    free(image);
    return bvh;
}

// Builds it; keeps it under `key`, if that is not NULL.
static struct bvh *build_new(const struct gpu_scene *gpu_scene, const struct cache_key *key)
{
    struct bvh_work work = {.gpu_scene = gpu_scene};
    struct bvh *bvh = NULL;
    if (collect_triangles(&work) && build(&work) && work.sorted_count == work.triangle_count) {
        sort_triangles(&work);
        work.image->triangle_count = work.triangle_count;
        work.image->node_count = work.node_count;
        size_t bytes = image_bytes(work.triangle_count, work.node_count);
        if (key && bytes <= MAX_CACHED_BYTES)
            scene_cache_write(key, work.image, bytes);
        bvh = upload_image(gpu_scene, work.image);
    }
    free(work.image);
    free(work.boxes);
    free(work.order);
    return bvh;
}

struct bvh *bvh_create(const struct gpu_scene *gpu_scene, bool cached)
{
    if (!cached || !scene_cache_is_open())
        return build_new(gpu_scene, NULL);
    struct cache_key key = content_cache_key(gpu_scene);
    struct bvh *bvh = restore(gpu_scene, &key);
    return bvh ? bvh : build_new(gpu_scene, &key);
}

void bvh_destroy(struct bvh **bvh_slot)
{
    struct bvh *bvh = *bvh_slot;
    *bvh_slot = NULL;
    if (!bvh)
        return;
    gpu_buffer_destroy(&bvh->nodes);
    gpu_buffer_destroy(&bvh->triangles);
    free(bvh);
}
