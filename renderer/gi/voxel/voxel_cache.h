// Voxels of a scene's first voxelization in the scene cache: on a CPU that pass takes a quarter of
// the time to the first image, and its result depends on the scene and on where levels lie alone.
#ifndef VOXCAST_RENDERER_GI_VOXEL_VOXEL_CACHE_H
#define VOXCAST_RENDERER_GI_VOXEL_VOXEL_CACHE_H

#include "renderer/cache/scene_cache.h"
#include "renderer/gi/voxel/volume.h"

// Whether this voxelization is one to keep or take: the first of a volume, on a CPU.
bool voxel_cache_applies(const struct voxel_volume *volume);

// Key of all that it depends on. `programs` is a hash of the shaders that make voxels. About 5 ms
// for Sponza.
struct cache_key voxel_cache_key(const struct voxel_volume *volume,
                                 const struct gpu_scene *gpu_scene, uint64_t programs);

// Fills index, cells and surfels of an emptied volume. False, and all is empty still, if the cache
// does not hold them, they do not fit into the pools, or anything in them is out of range.
bool voxel_cache_restore(struct voxel_volume *volume, const struct cache_key *key);

// Keeps them, once they are complete. Waits for the GPU.
void voxel_cache_keep(const struct voxel_volume *volume, const struct cache_key *key);

#endif
