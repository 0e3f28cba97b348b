// Work lists of voxelization: regions of voxels, the triangles near them, and the surface table.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/gi/voxel/volume.h"
#include "renderer/hash.h"
#include "renderer/scene/scene.h"

// Up to this number of instances each has its own surfels. Beyond, instances of equal material
// share them, so that the surfel list of a voxel stays bounded.
#define MAX_OWN_SURFACES 4096u

static bool reserve(struct voxel_volume *volume, size_t words)
{
    if (words <= volume->scratch_words)
        return true;
    uint32_t *larger = realloc(volume->scratch, 2 * words * sizeof(*larger));
    if (!larger)
        return false;
    volume->scratch = larger;
    volume->scratch_words = 2 * words;
    return true;
}

static bool box_meets(const struct voxel_volume *volume, const struct voxel_level *level,
                      const struct voxel_box *box, const float low[3], const float high[3])
{
    for (int axis = 0; axis < 3; axis++) {
        double from = (low[axis] - volume->anchor[axis]) / level->voxel_edge_m;
        double to = (high[axis] - volume->anchor[axis]) / level->voxel_edge_m;
        // NaN overlaps nothing.
        if (!(from <= box->high[axis] + 0.01 && to >= box->low[axis] - 0.01))
            return false;
    }
    return true;
}

static void cluster_bounds(const float *m, const struct gpu_scene_cluster *cluster, float scale,
                           float out_low[3], float out_high[3])
{
    const float *c = cluster->center;
    float radius = cluster->radius * scale;
    for (int row = 0; row < 3; row++) {
        float center = m[row] * c[0] + m[4 + row] * c[1] + m[8 + row] * c[2] + m[12 + row];
        out_low[row] = center - radius;
        out_high[row] = center + radius;
    }
}

static bool append_batch(struct voxel_volume *volume, uint32_t instance, uint32_t first,
                         uint32_t count, uint32_t region)
{
    size_t words = sizeof(struct voxel_batch) / 4, at = volume->batch_count * words;
    if (!reserve(volume, at + words))
        return false;
    const struct voxel_batch batch = {instance, first, count, region};
    memcpy(volume->scratch + at, &batch, sizeof(batch));
    volume->batch_count++;
    return true;
}

static bool add_instance_batches(struct voxel_volume *volume, const struct gpu_scene *gpu_scene,
                                 uint32_t number, uint32_t level, const struct voxel_box *box)
{
    const struct gpu_scene_instance *instance = &gpu_scene->instances[number];
    const float *matrix = instance->world_from_local;
    uint32_t triangles = instance->index_count / 3;
    for (uint32_t at = 0; at < triangles; at += VOXEL_BATCH) {
        const struct gpu_scene_cluster *cluster =
            &gpu_scene->clusters[instance->cluster_first + (at >> ID_BLOCK_BITS)];
        float low[3], high[3];
        cluster_bounds(matrix, cluster, instance->scale, low, high);
        uint32_t count = triangles - at < VOXEL_BATCH ? triangles - at : VOXEL_BATCH;
        if (box_meets(volume, &volume->levels[level], box, low, high) &&
            !append_batch(volume, number, at, count, volume->region_count))
            return false;
    }
    return true;
}

static bool add_regions(struct voxel_volume *volume, const struct gpu_scene *gpu_scene,
                        struct voxel_region *regions)
{
    for (uint32_t level = 0; level < volume->cell_level_count; level++) {
        const struct voxel_boxes *dirty = &volume->dirty[level];
        for (uint32_t i = 0; i < dirty->count; i++) {
            const struct voxel_box *box = &dirty->boxes[i];
            struct voxel_region *region = &regions[volume->region_count];
            uint32_t voxels = 1;
            for (int axis = 0; axis < 3; axis++) {
                region->low[axis] = box->low[axis];
                region->size[axis] = box->high[axis] - box->low[axis];
                voxels *= (uint32_t)region->size[axis];
            }
            region->level = level;
            region->first_voxel = volume->region_voxels;
            for (uint32_t j = 0; j < gpu_scene->counts.instances; j++) {
                const struct gpu_scene_instance *instance = &gpu_scene->instances[j];
                if (instance->visible &&
                    box_meets(volume, &volume->levels[level], box, instance->bounds_min,
                              instance->bounds_max) &&
                    !add_instance_batches(volume, gpu_scene, j, level, box))
                    return false;
            }
            volume->region_voxels += voxels;
            volume->region_count++;
        }
    }
    return true;
}

// Surface of each instance, then material and flags of each surface.
static bool write_surfaces(struct voxel_volume *volume, const struct gpu_scene *gpu_scene)
{
    uint32_t instances = gpu_scene->counts.instances;
    uint32_t materials = gpu_scene->scene->material_count;
    bool own = instances <= MAX_OWN_SURFACES;
    size_t words = (size_t)instances + (own ? instances : materials);
    uint32_t *table = calloc(words ? words : 1, sizeof(*table));
    if (!table)
        return false;
    for (uint32_t i = 0; i < materials && !own; i++)
        table[instances + i] = i | SURFACE_LIT_DIRECTLY;
    for (uint32_t i = 0; i < instances; i++) {
        const struct gpu_scene_instance *instance = &gpu_scene->instances[i];
        uint32_t material = gpu_scene->scene->primitives[instance->primitive].material;
        bool directly = instance->emits_directly && !instance->large_emitter;
        table[i] = own ? i : material;
        if (own)
            table[instances + i] = material | (directly ? SURFACE_LIT_DIRECTLY : 0);
        else if (!directly)
            table[instances + material] &= ~SURFACE_LIT_DIRECTLY;
    }
    uint64_t hash = hash_bytes(HASH_START, table, words * sizeof(*table));
    bool done = true;
    if (!volume->surfaces || hash != volume->surfaces_hash) {
        done = gpu_buffer_ensure(volume->gpu, &volume->surfaces, "gi.surfaces", GPU_BUFFER_STATIC,
                                 words * sizeof(*table));
        if (done)
            gpu_buffer_write(volume->surfaces, 0, words * sizeof(*table), table);
        volume->surfaces_hash = hash;
    }
    free(table);
    return done;
}

bool voxel_volume_prepare_work(struct voxel_volume *volume, const struct gpu_scene *gpu_scene)
{
    struct voxel_region regions[VOXEL_MAX_REGIONS];
    memset(regions, 0, sizeof(regions));
    volume->region_count = 0;
    volume->region_voxels = 0;
    volume->batch_count = 0;
    if (!write_surfaces(volume, gpu_scene) || !add_regions(volume, gpu_scene, regions))
        return false;
    if (!volume->work || volume->batch_count > volume->batch_capacity) {
        volume->batch_capacity = 2 * volume->batch_count + 64;
        if (!gpu_buffer_ensure(volume->gpu, &volume->work, "gi.work", GPU_BUFFER_STATIC,
                               sizeof(regions) +
                                   (size_t)volume->batch_capacity * sizeof(struct voxel_batch)))
            return false;
    }
    if (volume->region_count > 0) {
        gpu_buffer_write(volume->work, 0, sizeof(regions), regions);
        gpu_buffer_write(volume->work, sizeof(regions),
                         volume->batch_count * sizeof(struct voxel_batch), volume->scratch);
    }
    return true;
}
