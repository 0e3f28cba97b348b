// Shared by the tests of voxels: a volume that is filled without drawing an image, the content of
// its voxels as sorted records, and scenes that place triangles exactly on voxels.
#ifndef VOXCAST_TESTS_GPU_SUPPORT_VOXELS_H
#define VOXCAST_TESTS_GPU_SUPPORT_VOXELS_H

#include "renderer/gi/voxel/volume.h"
#include "renderer/passes/pass.h"
#include "renderer/frame/view.h"

// A context, a scene on the GPU and what a frame needs to run the voxel passes. One at a time.
struct voxel_rig {
    struct gpu *gpu;
    struct view *view;
    struct gpu_scene *gpu_scene;
    struct frame_params params;
};

// These fail the test if they cannot do their work. The scene stays the caller's.
void voxel_rig_init(struct voxel_rig *rig, struct scene *scene);
void voxel_rig_finish(struct voxel_rig *rig);

struct voxel_volume *voxel_rig_volume(struct voxel_rig *rig, enum gi_method method, uint32_t edge,
                                      uint32_t clip_levels);

// Updates the volume for a camera at `eye`; voxelizes where anything has changed.
void voxel_rig_voxelize(struct voxel_rig *rig, struct voxel_volume *volume, const float eye[3]);

// Injects emission into all voxels, and filters.
void voxel_rig_light(struct voxel_rig *rig, struct voxel_volume *volume);

// What one surface has in one voxel.
struct voxel_record {
    int32_t voxel[3];
    uint32_t level;
    uint32_t words[SURFEL_WORDS - 1]; // of the surfel, from its key on
};

// All of a volume's surfels, sorted by level, voxel and key; free() the records.
struct voxel_records {
    size_t count;
    struct voxel_record *records;
};
struct voxel_records voxel_read_records(const struct voxel_volume *volume);

// How many records differ; prints the first few.
size_t voxel_count_differences(const struct voxel_records *a, const struct voxel_records *b);

uint32_t voxel_record_word(const struct voxel_record *record, uint32_t surfel_word);

// A scene whose bounds are -30 to 30 m, by two specks in its corners. With 64 voxels along an edge,
// voxels of the coarsest level are then 1 m wide, and the anchor is known.
struct scene *voxel_scene_create(void);
float voxel_scene_anchor(void);

// Adds a mesh of its own for `count` triangles (9 floats each) and a node for it. `colors`: one
// (RGB) for each triangle, or NULL for white.
uint32_t voxel_scene_add(struct scene *scene, const float *triangles, uint32_t count,
                         const float *colors, uint32_t material);

// Repeatable: a number in [0, 1).
double voxel_random(uint64_t *state);

#endif
