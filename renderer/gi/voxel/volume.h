// Voxels of a scene on the GPU: index, cells and surfels from geometry, and the radiance texture
// that cones march through. A clipmap follows a camera; a grid covers the scene.
//
// Render thread only.
#ifndef VOXCAST_RENDERER_GI_VOXEL_VOLUME_H
#define VOXCAST_RENDERER_GI_VOXEL_VOLUME_H

#include "renderer/gi/voxel/regions.h"
#include "renderer/gpu/buffer.h"
#include "renderer/gpu/texture.h"
#include "renderer/gpu_scene/gpu_scene.h"
#include "renderer/settings.h"

// A clipmap follows a camera; views beyond this number of volumes share one.
#define VOXEL_MAX_SHARED_VOLUMES 6u
// For views whose settings differ from the others' (frame_params.own_voxels).
#define VOXEL_MAX_OWN_VOLUMES 6u

// Where the number of bounces is limited: whether the cache holds the last one, too. Else pixels
// trace it themselves, and would show one too many.
enum voxel_last_bounce { LAST_BOUNCE_ANY, LAST_BOUNCE_TRACED, LAST_BOUNCE_CACHED };

struct voxel_volume_params {
    enum gi_method method; // GI_METHOD_CLIPMAP or GI_METHOD_GRID
    uint32_t edge;         // voxels along an edge, a power of two
    uint32_t clip_levels;  // 0: chosen from the scene
    enum voxel_directions directions;
    uint32_t cache_cones; // per voxel face
    bool colors;          // surfels store colours besides their material
    enum voxel_last_bounce last_bounce;
};

// Number of levels of a clipmap with these parameters: the coarsest covers the scene, the finest
// resolves a typical object. Uses ratios of extents only, so the scene's unit does not matter.
// Visits every instance.
uint32_t voxel_volume_choose_clip_levels(const struct voxel_volume_params *params,
                                         const struct gpu_scene *gpu_scene);

struct voxel_level {
    uint32_t edge;
    double voxel_edge_m;
    struct voxel_box box;   // voxels that are covered now
    struct voxel_box inner; // part filled from the finer level; empty for none
};

// An instance as it was last voxelized.
struct voxel_instance {
    float matrix[16];
    float bounds_min[3]; // world
    float bounds_max[3];
    bool visible;
};

// Convergence of the volume's light; see gi/light_schedule.c.
struct voxel_light_state {
    bool relight;        // inject light into voxels again
    bool relight_direct; // direct light, too, not only the cache's bounce
    bool filling;        // converged except for voxels that a moving level has newly covered
    bool converged_once; // since the volume was created
    bool start_pending;  // the next frame starts a cache generation
    bool converged;
    bool unsmoothed;             // faces have been traced since they were last smoothed
    bool smooth_due;             // the generation is complete but for that
    bool unlimited;              // number of bounces
    bool all_faces_requested;    // trace all faces, not only requested ones
    uint32_t generation;         // 1 to 65535, then wraps to 1
    uint32_t bounce;             // generations completed since the last change of light
    uint32_t needed;             // generations for the wanted bounces
    uint32_t unrequested_frames; // frames in a row with nothing to trace
    uint32_t next_level;         // next to inject, where a frame does one level
    uint32_t version;            // counts changes of the radiance that cones see
    float change;                // in the last complete generation, relative to the brightest face
    float residual;              // estimated relative change still to come
    float peak;                  // brightest face of that generation / scale
    double entry_ms;             // measured cost of tracing a face
};

struct voxel_volume {
    struct gpu *gpu;
    struct voxel_volume_params params;
    uint32_t level_count;
    uint32_t cell_level_count; // levels with cells of their own: 1 for a grid; the rest are mips of
                               // the last
    uint32_t face_count;
    double anchor[3];
    float bounds_min[3]; // scene bounds that the levels were laid out for
    float bounds_max[3];
    struct voxel_level levels[VOXEL_MAX_LEVELS];

    struct gpu_texture *radiance;
    struct gpu_buffer *block;
    struct gpu_buffer *index;
    struct gpu_buffer *cells;
    struct gpu_buffer *surfels;
    struct gpu_buffer *counters;
    struct gpu_buffer *free_list;
    struct gpu_buffer *work;
    struct gpu_buffer *tiles;
    struct gpu_buffer *lists;
    struct gpu_buffer *surfaces;
    struct gpu_buffer *queue;
    struct gpu_buffer *faces;
    uint32_t cell_capacity;
    uint32_t surfel_capacity;
    uint32_t face_capacity;
    uint32_t face_growth; // doublings so far
    uint32_t tile_capacity;
    uint32_t batch_capacity;
    uint32_t cell_count; // up to the highest cell in use
    size_t list_words;
    size_t mip_words; // at the end of the lists: occupancy bits of mip voxels

    // What to voxelize next.
    bool laid_out;
    bool faces_full; // the pool of face records was too small
    bool everything; // voxelize all
    bool voxelized;  // since the volume was created
    uint32_t region_count;
    uint32_t region_voxels;
    uint32_t batch_count;
    struct voxel_boxes dirty[VOXEL_MAX_LEVELS];
    struct voxel_instance *instances; // as last voxelized
    uint32_t instance_count;
    uint64_t geometry_seen;
    uint64_t transforms_seen;
    uint64_t surfaces_hash;
    uint32_t epoch;    // counts geometry changes, modulo 256
    uint32_t *scratch; // batches to upload
    size_t scratch_words;

    uint64_t lit_key; // hash of everything that light depends on
    struct voxel_light_state light;
    uint32_t frame;   // counts frames drawn
    float scale;      // stored radiance is divided by it
    uint32_t clamped; // values outside the range of half floats so far
    struct voxel_block uniforms;
};

// NULL when GPU memory runs out.
struct voxel_volume *voxel_volume_create(struct gpu *gpu, const struct voxel_volume_params *params);
void voxel_volume_destroy(struct voxel_volume **volume);

// Finds what to voxelize for the present scene and a camera at `eye`, and prepares the triangle
// batches. False when memory runs out.
bool voxel_volume_update(struct voxel_volume *volume, const struct gpu_scene *gpu_scene,
                         const float eye[3]);

// Part of the above, in gi/voxel/pool_estimate.c: surfels that the levels will hold, about. Cost:
// linear in the triangles.
double voxel_estimate_surfels(const struct voxel_volume *volume, const struct gpu_scene *gpu_scene);

// Part of the above, in gi/voxel/voxel_work.c: regions, batches of triangles that may overlap them,
// and the surface table.
bool voxel_volume_prepare_work(struct voxel_volume *volume, const struct gpu_scene *gpu_scene);

// After voxelization: whether the pools were large enough. If not, they have been enlarged and
// everything must be voxelized again (voxel_volume_update(), then the pass). Waits for the GPU.
enum voxel_room { VOXEL_ROOM_ENOUGH, VOXEL_ROOM_GROWN, VOXEL_ROOM_NONE };
enum voxel_room voxel_volume_check_room(struct voxel_volume *volume);

// Uploads the uniforms and binds all buffers and textures.
void voxel_volume_bind(struct voxel_volume *volume);

// Selects the levels that the next dispatch injects light into, or the one (first) that it filters.
void voxel_volume_choose_levels(struct voxel_volume *volume, uint32_t first, uint32_t end);

#endif
