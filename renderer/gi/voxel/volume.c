#include "renderer/gi/voxel/volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/scene/scene.h"

// Levels move in steps of so many voxels, so that voxels of the coarser level are covered whole.
#define SNAP_VOXELS 2
// The coarsest level is larger than the scene by so many of its voxels. The third keeps surfaces at
// the scene's bounds off voxel faces, where they would fill both sides.
#define MARGIN_VOXELS 4.0
#define ANCHOR_OFFSET (1.0 / 3.0)
// Voxels of the finest level along a typical object.
#define TYPICAL_OBJECT_VOXELS 64.0f
#define TILE_CAPACITY         65535u
// Room in the pools over what is estimated. Measured: 1.3 times as many surfels in cornell-objects,
// 1.4 in Sponza, 1.9 in the atrium, whose triangles are small; 0.7 to 1.0 times as many cells.
#define SURFEL_ROOM 2.2
#define CELL_ROOM   1.1
// Fraction of all voxels that the pools begin with at most; 0.12 are occupied in the atrium.
#define MAX_OCCUPIED 0.3

static uint32_t log2_of(uint32_t edge)
{
    uint32_t log2 = 0;
    while ((1u << log2) < edge)
        log2++;
    return log2;
}

static void free_pools(struct voxel_volume *volume)
{
    gpu_buffer_destroy(&volume->cells);
    gpu_buffer_destroy(&volume->surfels);
    gpu_buffer_destroy(&volume->free_list);
    gpu_buffer_destroy(&volume->lists);
    gpu_buffer_destroy(&volume->queue);
    gpu_buffer_destroy(&volume->faces);
}

static struct gpu_buffer *make(struct voxel_volume *volume, const char *label, size_t words)
{
    if (!gpu_texels_fit(volume->gpu, GPU_TEXEL_UINT, words * 4))
        return NULL;
    return gpu_buffer_create(volume->gpu, label, GPU_BUFFER_STATIC, words * 4, NULL);
}

static uint32_t face_words(const struct voxel_volume *volume)
{
    return FACE_RECORD_WORDS(volume->params.cache_cones);
}

static uint32_t face_capacity(const struct voxel_volume *volume)
{
    return (volume->cell_capacity + volume->cell_capacity / 2) << volume->face_growth;
}

static bool create_pools(struct voxel_volume *volume)
{
    size_t cells = volume->cell_capacity, surfels = volume->surfel_capacity;
    // Occupancy bits of the mip levels.
    size_t bits = 0;
    for (uint32_t i = volume->cell_level_count; i < volume->level_count; i++)
        bits += (size_t)1 << (3 * log2_of(volume->levels[i].edge));
    volume->mip_words = bits / 32 + 1;
    volume->list_words = volume->level_count * cells + volume->mip_words;
    volume->cells = make(volume, "gi.cells", cells * CELL_WORDS);
    volume->surfels = make(volume, "gi.surfels", surfels * SURFEL_WORDS);
    volume->face_capacity = face_capacity(volume);
    volume->faces = make(volume, "gi.faces", (size_t)volume->face_capacity * face_words(volume));
    volume->free_list = make(volume, "gi.free", cells + 2 * surfels + volume->face_capacity);
    volume->lists = make(volume, "gi.lists", volume->list_words);
    volume->queue = make(volume, "gi.queue", cells * CACHE_CLASSES);
    return volume->cells && volume->surfels && volume->faces && volume->free_list &&
           volume->lists && volume->queue;
}

static struct gpu_texture *create_texture(const struct voxel_volume *volume)
{
    uint32_t outer = volume->params.edge + 2;
    uint32_t height = outer * volume->cell_level_count;
    // Mip levels lie side by side: halves, quarters and so on down to 8 voxels, with borders, are
    // together no wider than the finest level.
    if (volume->level_count > volume->cell_level_count)
        height += outer / 2 + 1;
    uint32_t width = volume->face_count * outer;
    return gpu_texture_create(volume->gpu, &(struct gpu_texture_params){
                                               .label = "gi.radiance",
                                               .format = GPU_FORMAT_RGBA16F,
                                               .width = width,
                                               .height = height,
                                               .depth = outer,
                                               .filter = GPU_FILTER_LINEAR,
                                           });
}

static bool create_storage(struct voxel_volume *volume)
{
    size_t per_level = (size_t)1 << (3 * log2_of(volume->params.edge));
    volume->radiance = create_texture(volume);
    volume->index = make(volume, "gi.index", per_level * volume->cell_level_count);
    volume->counters = make(volume, "gi.counters", COUNTER_COUNT);
    volume->tile_capacity = TILE_CAPACITY;
    volume->tiles = make(volume, "gi.tiles", (size_t)TILE_CAPACITY * 4);
    volume->block = make(volume, "gi.uniforms", sizeof(struct voxel_block) / 4);
    return volume->radiance && volume->index && volume->counters && volume->tiles && volume->block;
}

// Chooses capacities so that the pools need not grow while voxelizing, which starts over then. The
// estimate counts triangles that share voxels more than once, so it is not trusted without bound.
static bool size_pools(struct voxel_volume *volume, const struct gpu_scene *gpu_scene)
{
    uint32_t edge = volume->params.edge;
    double area = (double)edge * edge * volume->cell_level_count, all = area * edge;
    double surfels = voxel_estimate_surfels(volume, gpu_scene);
    volume->surfel_capacity =
        (uint32_t)fmax(fmin(SURFEL_ROOM * surfels, 2.0 * MAX_OCCUPIED * all), 6.0 * area);
    volume->cell_capacity =
        (uint32_t)fmax(fmin(CELL_ROOM * surfels, MAX_OCCUPIED * all), 4.0 * area);
    if (create_pools(volume))
        return true;
    free_pools(volume);
    volume->surfel_capacity = (uint32_t)(6.0 * area);
    volume->cell_capacity = (uint32_t)(4.0 * area);
    return create_pools(volume);
}

static void destroy_storage(struct voxel_volume *volume)
{
    free_pools(volume);
    gpu_texture_destroy(&volume->radiance);
    gpu_buffer_destroy(&volume->index);
    gpu_buffer_destroy(&volume->counters);
    gpu_buffer_destroy(&volume->tiles);
    gpu_buffer_destroy(&volume->block);
    gpu_buffer_destroy(&volume->work);
    gpu_buffer_destroy(&volume->surfaces);
    volume->batch_capacity = 0;
}

struct voxel_volume *voxel_volume_create(struct gpu *gpu, const struct voxel_volume_params *params)
{
    struct voxel_volume *volume = calloc(1, sizeof(*volume));
    if (!volume)
        return NULL;
    volume->gpu = gpu;
    volume->params = *params;
    volume->face_count = params->directions == VOXEL_ANISOTROPIC ? VOXEL_FACES : 1;
    return volume;
}

void voxel_volume_destroy(struct voxel_volume **volume_slot)
{
    struct voxel_volume *volume = *volume_slot;
    *volume_slot = NULL;
    if (!volume)
        return;
    destroy_storage(volume);
    free(volume->instances);
    free(volume->scratch);
    free(volume);
}

static int compare_floats(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static float extent_of(const struct gpu_scene *gpu_scene)
{
    float extent = 0.0f;
    for (int axis = 0; axis < 3; axis++)
        extent = fmaxf(extent, gpu_scene->bounds_max[axis] - gpu_scene->bounds_min[axis]);
    return extent > 0.0f && isfinite(extent) ? extent : 1.0f;
}

uint32_t voxel_volume_choose_clip_levels(const struct voxel_volume_params *params,
                                         const struct gpu_scene *gpu_scene)
{
    uint32_t maximum = params->edge <= 64 ? 4 : CLIP_MAX_LEVELS;
    if (params->clip_levels > 0)
        return params->clip_levels < CLIP_MAX_LEVELS ? params->clip_levels : CLIP_MAX_LEVELS;
    float extent = extent_of(gpu_scene);
    float *extents = malloc((gpu_scene->counts.instances + 1) * sizeof(*extents));
    uint32_t count = 0;
    for (uint32_t i = 0; extents && i < gpu_scene->counts.instances; i++) {
        const struct gpu_scene_instance *instance = &gpu_scene->instances[i];
        float largest = 0.0f;
        for (int axis = 0; axis < 3; axis++)
            largest = fmaxf(largest, instance->bounds_max[axis] - instance->bounds_min[axis]);
        if (instance->visible && largest > 0.0f)
            extents[count++] = largest;
    }
    float typical = extent;
    if (count > 0) {
        qsort(extents, count, sizeof(*extents), compare_floats);
        typical = extents[count / 2];
    }
    free(extents);
    float wanted = TYPICAL_OBJECT_VOXELS / (float)params->edge;
    float levels = 1.0f + roundf(log2f(extent / typical * wanted));
    return (uint32_t)fminf(fmaxf(levels, 1.0f), (float)maximum);
}

// Lays out the levels over the scene's bounds; allocates what depends on their number.
static bool lay_out(struct voxel_volume *volume, const struct gpu_scene *gpu_scene)
{
    bool clipmap = volume->params.method == GI_METHOD_CLIPMAP;
    for (int axis = 0; axis < 3; axis++) {
        float low = gpu_scene->bounds_min[axis], high = gpu_scene->bounds_max[axis];
        bool finite = isfinite(low) && isfinite(high);
        volume->bounds_min[axis] = finite ? low : 0.0f;
        volume->bounds_max[axis] = finite ? high : 0.0f;
    }
    float extent = extent_of(gpu_scene);
    uint32_t edge = volume->params.edge;
    uint32_t cell_level_count =
        clipmap ? voxel_volume_choose_clip_levels(&volume->params, gpu_scene) : 1;
    bool same = volume->radiance && cell_level_count == volume->cell_level_count;
    // A single level has mips down to 8^3. Of several, each is the mip of the finer one.
    uint32_t levels = cell_level_count > 1 ? cell_level_count : 1 + log2_of(edge) - 3;
    volume->level_count = levels;
    volume->cell_level_count = cell_level_count;
    uint32_t doublings = cell_level_count - 1;
    double coarse = extent / ((double)edge - MARGIN_VOXELS);
    // Exact powers of two apart and exact as floats, so that shaders compute the same voxels.
    double fine = (double)(float)ldexp(coarse, -(int)doublings);
    for (uint32_t i = 0; i < levels; i++) {
        volume->levels[i].edge = i < cell_level_count ? edge : edge >> (i - doublings);
        volume->levels[i].voxel_edge_m = ldexp(fine, (int)i);
    }
    double middle_offset = ANCHOR_OFFSET * ldexp(fine, (int)doublings);
    for (int axis = 0; axis < 3; axis++) {
        double middle = 0.5 * ((double)volume->bounds_min[axis] + volume->bounds_max[axis]);
        volume->anchor[axis] = (double)(float)(middle + middle_offset);
    }
    if (!same) {
        destroy_storage(volume);
        if (!create_storage(volume))
            return false;
    }
    volume->laid_out = true;
    volume->everything = true;
    return true;
}

static bool covers_scene(const struct voxel_volume *volume, const struct gpu_scene *gpu_scene)
{
    float old_size = 0.0f, size = 0.0f;
    for (int axis = 0; axis < 3; axis++) {
        // Less than the margin, of which the anchor's offset uses a third of a voxel.
        float slack = 1.5f * (float)volume->levels[volume->cell_level_count - 1].voxel_edge_m;
        float low = gpu_scene->bounds_min[axis], high = gpu_scene->bounds_max[axis];
        if (low < volume->bounds_min[axis] - slack || high > volume->bounds_max[axis] + slack)
            return false;
        old_size = fmaxf(old_size, volume->bounds_max[axis] - volume->bounds_min[axis]);
        size = fmaxf(size, high - low);
    }
    // A scene that has shrunk gets finer voxels.
    return !(size < 0.5f * old_size);
}

// Region of a clip level: around the camera, clamped to the scene.
static void position_level(const struct voxel_volume *volume, uint32_t number, const float eye[3],
                           struct voxel_box *out_box)
{
    const struct voxel_level *level = &volume->levels[number];
    int32_t edge = (int32_t)level->edge;
    for (int axis = 0; axis < 3; axis++) {
        if (number >= volume->cell_level_count) { // mip of the level before
            out_box->low[axis] = volume->levels[number - 1].box.low[axis] / 2;
            out_box->high[axis] = out_box->low[axis] + edge;
            continue;
        }
        double center = eye[axis];
        double half = 0.5 * (edge - MARGIN_VOXELS) * level->voxel_edge_m;
        double low = volume->bounds_min[axis] + half, high = volume->bounds_max[axis] - half;
        if (low > high)
            low = high = 0.5 * ((double)volume->bounds_min[axis] + volume->bounds_max[axis]);
        center = fmin(fmax(center, low), high);
        double voxel = (center - volume->anchor[axis]) / level->voxel_edge_m;
        int32_t snapped = SNAP_VOXELS * (int32_t)floor(voxel / SNAP_VOXELS + 0.5);
        // The coarsest level covers the scene and does not move.
        if (number + 1 == volume->cell_level_count)
            snapped = 0;
        out_box->low[axis] = snapped - edge / 2;
        out_box->high[axis] = snapped + edge / 2;
    }
}

// Moves every level and marks the voxels newly covered by it.
static void move_levels(struct voxel_volume *volume, const float eye[3])
{
    for (uint32_t i = 0; i < volume->level_count; i++) {
        struct voxel_level *level = &volume->levels[i];
        struct voxel_box box;
        position_level(volume, i, eye, &box);
        volume->dirty[i].count = 0;
        if (volume->everything)
            voxel_boxes_add(&volume->dirty[i], box);
        else if (i < volume->cell_level_count)
            voxel_boxes_entered(&volume->dirty[i], &level->box, &box);
        level->box = box;
        level->inner = (struct voxel_box){0};
        for (int axis = 0; axis < 3 && i > 0 && i < volume->cell_level_count; axis++) {
            level->inner.low[axis] = volume->levels[i - 1].box.low[axis] / 2;
            level->inner.high[axis] = volume->levels[i - 1].box.high[axis] / 2;
        }
    }
}

static struct voxel_box box_of_bounds(const struct voxel_volume *volume,
                                      const struct voxel_level *level, const float low[3],
                                      const float high[3])
{
    struct voxel_box box;
    for (int axis = 0; axis < 3; axis++) {
        // Padded by more than rounding can move a triangle.
        double from = (low[axis] - volume->anchor[axis]) / level->voxel_edge_m - 1.01;
        double to = (high[axis] - volume->anchor[axis]) / level->voxel_edge_m + 1.01;
        box.low[axis] = (int32_t)floor(fmin(fmax(from, -1e9), 1e9));
        box.high[axis] = (int32_t)ceil(fmin(fmax(to, -1e9), 1e9)) + 1;
    }
    return box;
}

static void mark_bounds(struct voxel_volume *volume, const struct voxel_box kept[],
                        const float low[3], const float high[3])
{
    for (uint32_t i = 0; i < volume->cell_level_count; i++) {
        struct voxel_box box = box_of_bounds(volume, &volume->levels[i], low, high);
        box = voxel_box_intersect(&box, &kept[i]);
        voxel_boxes_add(&volume->dirty[i], box);
    }
}

static void remember_instance(struct voxel_instance *seen,
                              const struct gpu_scene_instance *instance)
{
    memcpy(seen->matrix, instance->world_from_local, sizeof(seen->matrix));
    memcpy(seen->bounds_min, instance->bounds_min, sizeof(seen->bounds_min));
    memcpy(seen->bounds_max, instance->bounds_max, sizeof(seen->bounds_max));
    seen->visible = instance->visible;
}

// Marks the former and present bounds of moved, shown and hidden objects. `kept`: per level the
// region that was covered before and still is; the rest is already marked.
static void mark_moved_instances(struct voxel_volume *volume, const struct gpu_scene *gpu_scene,
                                 const struct voxel_box kept[])
{
    for (uint32_t i = 0; i < volume->instance_count; i++) {
        const struct gpu_scene_instance *instance = &gpu_scene->instances[i];
        struct voxel_instance *seen = &volume->instances[i];
        const float *matrix = instance->world_from_local;
        if (seen->visible == instance->visible &&
            memcmp(seen->matrix, matrix, sizeof(seen->matrix)) == 0)
            continue;
        if (seen->visible)
            mark_bounds(volume, kept, seen->bounds_min, seen->bounds_max);
        if (instance->visible)
            mark_bounds(volume, kept, instance->bounds_min, instance->bounds_max);
        remember_instance(seen, instance);
    }
}

static bool remember_all_instances(struct voxel_volume *volume, const struct gpu_scene *gpu_scene)
{
    uint32_t count = gpu_scene->counts.instances;
    free(volume->instances);
    volume->instances = calloc(count ? count : 1, sizeof(*volume->instances));
    volume->instance_count = volume->instances ? count : 0;
    for (uint32_t i = 0; i < volume->instance_count; i++)
        remember_instance(&volume->instances[i], &gpu_scene->instances[i]);
    return volume->instances != NULL;
}

static struct gpu_buffer *enlarge(struct voxel_volume *volume, struct gpu_buffer **old,
                                  const char *label, size_t words, size_t words_used)
{
    struct gpu_buffer *larger = make(volume, label, words);
    if (larger)
        gpu_buffer_copy(larger, 0, *old, 0, words_used * 4);
    gpu_buffer_destroy(old);
    return larger;
}

// A cell has up to six faces, most have fewer than two. Once light has converged, existing records
// stay and injection allocates the missing ones. Before that all start over, so that the result
// does not depend on what had been traced.
static bool make_room_for_faces(struct voxel_volume *volume)
{
    volume->faces_full = false;
    if (volume->face_growth >= 2)
        return true;
    volume->face_growth++;
    if (!volume->light.converged_once) {
        volume->everything = true;
        free_pools(volume);
        return create_pools(volume);
    }
    uint32_t used = volume->face_capacity;
    size_t others = volume->cell_capacity + 2 * (size_t)volume->surfel_capacity;
    volume->face_capacity = face_capacity(volume);
    volume->faces = enlarge(volume, &volume->faces, "gi.faces",
                            (size_t)volume->face_capacity * face_words(volume),
                            (size_t)used * face_words(volume));
    volume->free_list = enlarge(volume, &volume->free_list, "gi.free",
                                others + volume->face_capacity, others + used);
    gpu_buffer_fill(volume->counters, COUNTER_FACES * 4, 4, used);
    gpu_buffer_fill(volume->counters, COUNTER_OVERFLOW * 4, 4, 0);
    volume->light.relight = true;
    volume->light.relight_direct = true;
    return volume->faces && volume->free_list;
}

// After a failed allocation: frees the rest, so that the next frame starts over.
static void give_up_storage(struct voxel_volume *volume)
{
    destroy_storage(volume);
    volume->laid_out = false;
}

static bool update(struct voxel_volume *volume, const struct gpu_scene *gpu_scene,
                   const float eye[3])
{
    const struct scene_revisions *now = &gpu_scene->scene->revisions;
    bool geometry = !volume->laid_out || now->geometry != volume->geometry_seen;
    bool transforms = now->transforms != volume->transforms_seen;
    if (geometry || (transforms && !covers_scene(volume, gpu_scene)))
        if (!lay_out(volume, gpu_scene))
            return false;
    if (volume->faces_full && !make_room_for_faces(volume))
        return false;
    struct voxel_box before[VOXEL_MAX_LEVELS], kept[VOXEL_MAX_LEVELS];
    for (uint32_t i = 0; i < volume->level_count; i++)
        before[i] = volume->levels[i].box;
    move_levels(volume, eye);
    if (!volume->cells && !size_pools(volume, gpu_scene))
        return false;
    for (uint32_t i = 0; i < volume->level_count; i++)
        kept[i] = voxel_box_intersect(&before[i], &volume->levels[i].box);
    if (volume->everything) {
        if (!remember_all_instances(volume, gpu_scene))
            return false;
    } else if (transforms) {
        mark_moved_instances(volume, gpu_scene, kept);
    }
    // Cone hits stay valid when the camera moves, but not when geometry does.
    if (volume->everything || transforms)
        volume->epoch = (volume->epoch + 1) & 0xffu;
    volume->geometry_seen = now->geometry;
    volume->transforms_seen = now->transforms;
    return voxel_volume_prepare_work(volume, gpu_scene);
}

bool voxel_volume_update(struct voxel_volume *volume, const struct gpu_scene *gpu_scene,
                         const float eye[3])
{
    bool done = update(volume, gpu_scene, eye);
    if (!done)
        give_up_storage(volume);
    return done;
}

static void grow_if_full(uint32_t *capacity, uint32_t used)
{
    if (used >= *capacity)
        *capacity += *capacity / 2;
}

enum voxel_room voxel_volume_check_room(struct voxel_volume *volume)
{
    uint32_t counters[COUNTER_LISTS];
    gpu_buffer_read(volume->counters, 0, sizeof(counters), counters);
    volume->cell_count = counters[COUNTER_CELLS] < volume->cell_capacity ? counters[COUNTER_CELLS]
                                                                         : volume->cell_capacity;
    if (!counters[COUNTER_OVERFLOW])
        return VOXEL_ROOM_ENOUGH;
    free_pools(volume);
    if (counters[COUNTER_OVERFLOW] & OVERFLOW_POOLS) {
        grow_if_full(&volume->cell_capacity, counters[COUNTER_CELLS]);
        grow_if_full(&volume->surfel_capacity, counters[COUNTER_SURFELS]);
    }
    // Grows from 1.5 records per cell to 6, the maximum.
    if (counters[COUNTER_OVERFLOW] & OVERFLOW_FACES && volume->face_growth < 2)
        volume->face_growth++;
    volume->everything = true;
    if (create_pools(volume))
        return VOXEL_ROOM_GROWN;
    give_up_storage(volume);
    return VOXEL_ROOM_NONE;
}

static void fill_levels(const struct voxel_volume *volume, struct voxel_block *block)
{
    bool clipmap = volume->params.method == GI_METHOD_CLIPMAP;
    int32_t outer = (int32_t)volume->params.edge + 2;
    int32_t mip_x = 0;
    for (uint32_t i = 0; i < volume->level_count; i++) {
        const struct voxel_level *level = &volume->levels[i];
        struct voxel_level_block *target = &block->levels[i];
        int32_t edge = (int32_t)level->edge;
        bool mip = i >= volume->cell_level_count;
        for (int axis = 0; axis < 3; axis++) {
            target->origin[axis] = level->box.low[axis];
            target->inner_origin[axis] = level->inner.low[axis];
            target->texel_origin[axis] = 1;
        }
        target->edge = edge;
        target->inner_edge = level->inner.high[0] - level->inner.low[0];
        target->texel_origin[1] += outer * (int32_t)(mip ? volume->cell_level_count : i);
        if (mip) {
            target->texel_origin[0] += mip_x;
            mip_x += (int32_t)volume->face_count * (edge + 2);
        }
        target->face_stride = volume->face_count > 1 ? edge + 2 : 0;
        uint32_t log2 = log2_of(level->edge);
        target->first_index = mip ? 0 : i << (3 * log2);
        target->edge_log2 = log2;
        target->wraps = clipmap && !mip;
        target->dirty = volume->dirty[i].count > 0;
        target->voxel_edge_m = (float)level->voxel_edge_m;
        target->inverse_voxel_edge = (float)(1.0 / level->voxel_edge_m);
    }
}

void voxel_volume_bind(struct voxel_volume *volume)
{
    struct gpu *gpu = volume->gpu;
    struct voxel_block *block = &volume->uniforms;
    for (int axis = 0; axis < 3; axis++)
        block->anchor[axis] = (float)volume->anchor[axis];
    block->radiance_scale = volume->scale;
    block->level_count = volume->level_count;
    block->face_count = volume->face_count;
    block->cell_capacity = volume->cell_capacity;
    block->surfel_capacity = volume->surfel_capacity;
    block->region_count = volume->region_count;
    block->region_voxel_count = volume->region_voxels;
    block->batch_count = volume->batch_count;
    block->tile_capacity = volume->tile_capacity;
    block->cell_level_count = volume->cell_level_count;
    block->face_record_words = face_words(volume);
    block->face_capacity = volume->face_capacity;
    block->geometry_epoch = volume->epoch;
    // Limits cone footprints to a voxel of the coarsest level. Wider cones blend in what lies
    // before an opening or behind a corner, and see both sides of thin slanted walls.
    block->cone_max_diameter_m = (float)volume->levels[volume->cell_level_count - 1].voxel_edge_m;
    block->list_capacity = volume->cell_capacity;
    block->instance_count = volume->instance_count;
    fill_levels(volume, block);
    gpu_buffer_write(volume->block, 0, sizeof(*block), block);
    gpu_bind_uniforms(gpu, BIND_VOXELS, volume->block);
    gpu_bind_storage(gpu, BIND_VOXEL_INDEX, volume->index);
    gpu_bind_storage(gpu, BIND_CELLS, volume->cells);
    gpu_bind_storage(gpu, BIND_SURFELS, volume->surfels);
    gpu_bind_storage(gpu, BIND_VOXEL_COUNTERS, volume->counters);
    gpu_bind_storage(gpu, BIND_VOXEL_FREE, volume->free_list);
    gpu_bind_storage(gpu, BIND_VOXEL_TILES, volume->tiles);
    gpu_bind_storage(gpu, BIND_VOXEL_LISTS, volume->lists);
    gpu_bind_storage(gpu, BIND_CACHE_QUEUE, volume->queue);
    gpu_bind_storage(gpu, BIND_FACES, volume->faces);
    gpu_bind_texels(gpu, UNIT_VOXEL_INDEX, volume->index, GPU_TEXEL_UINT);
    gpu_bind_texels(gpu, UNIT_CELLS, volume->cells, GPU_TEXEL_UINT4);
    gpu_bind_texels(gpu, UNIT_FACES, volume->faces, GPU_TEXEL_UINT4);
    gpu_bind_texels(gpu, UNIT_SURFELS, volume->surfels, GPU_TEXEL_UINT);
    gpu_bind_texels(gpu, UNIT_VOXEL_WORK, volume->work, GPU_TEXEL_UINT4);
    gpu_bind_texels(gpu, UNIT_VOXEL_LISTS, volume->lists, GPU_TEXEL_UINT);
    gpu_bind_texels(gpu, UNIT_VOXEL_SURFACES, volume->surfaces, GPU_TEXEL_UINT);
    gpu_bind_texels(gpu, UNIT_CACHE_QUEUE, volume->queue, GPU_TEXEL_UINT);
    gpu_bind_texture(gpu, UNIT_VOXEL_RADIANCE, volume->radiance);
    gpu_bind_image(gpu, IMAGE_VOXEL_RADIANCE, volume->radiance);
}

void voxel_volume_choose_levels(struct voxel_volume *volume, uint32_t first, uint32_t end)
{
    struct voxel_block *block = &volume->uniforms;
    block->first_level = first;
    block->end_level = end;
    gpu_buffer_write(volume->block, offsetof(struct voxel_block, first_level),
                     sizeof(block->first_level) + sizeof(block->end_level), &block->first_level);
}
