// Voxels of a scene on the GPU: the index, cells and surfels that geometry leaves, and the radiance
// texture that cones walk through. A clipmap follows a camera; a grid covers the scene.
//
// Render thread only.
#ifndef VOXCAST_RENDERER_GI_VOLUME_H
#define VOXCAST_RENDERER_GI_VOLUME_H

#include "renderer/gi/regions.h"
#include "renderer/gpu/buffer.h"
#include "renderer/gpu/texture.h"
#include "renderer/gpu_scene/gpu_scene.h"
#include "renderer/settings.h"

struct voxel_volume_params {
    enum gi_method method; // GI_METHOD_CLIPMAP or GI_METHOD_GRID
    uint32_t edge;         // voxels along an edge, a power of two
    uint32_t clip_levels;  // 0: as the scene calls for
    enum voxel_directions directions;
    uint32_t cache_cones; // per voxel face
    bool colors;          // surfels hold colours of their own, beside their material's
};

// How many levels a clipmap of these parameters has: as many as it takes for the coarsest to cover
// the scene while the finest resolves a typical object. Goes by ratios of extents, so that the
// scene's unit does not matter. Looks at every instance.
uint32_t voxel_volume_choose_clip_levels(const struct voxel_volume_params *params,
                                         const struct gpu_scene *gpu_scene);

struct voxel_level {
    uint32_t edge;
    double voxel_edge_m;
    struct voxel_box box;   // what the voxels cover now
    struct voxel_box inner; // what the finer level fills; empty for none
};

// What an instance was when it was last voxelized.
struct voxel_instance {
    float matrix[16];
    float bounds_min[3]; // world
    float bounds_max[3];
    bool visible;
};

// How far light has come on its way to being converged; see gi/light.c.
struct voxel_light_state {
    bool relight;        // voxels must be lit anew
    bool relight_direct; // by lights, too, rather than by the cache alone
    bool filling;        // settled but for voxels that a moving level has brought in
    bool settled_once;   // since the volume was made
    bool start_pending;  // the next frame begins a generation of the cache
    bool converged;
    bool unlimited;              // bounces
    bool all_faces_requested;    // voxels need all faces, not only those that pixels see
    bool feeds;                  // voxels reflect what the cache holds
    uint32_t generation;         // counts, 1 to 65535, then over again
    uint32_t bounce;             // generations completed since light last changed
    uint32_t needed;             // generations for the bounces asked for
    uint32_t unrequested_frames; // in a row, in which nothing was left to trace
    uint32_t left;               // faces that the newest report says are stale
    uint32_t next_level;         // to relight, where one level is relit a frame
    uint32_t version;            // counts changes of the radiance that cones see
    float change;    // in the generation that ended last, relative to the brightest face
    float rest;      // relative change that is still to come
    float peak;      // brightest face then, over the scale
    double entry_ms; // measured cost of a face
};

struct voxel_volume {
    struct gpu *gpu;
    struct voxel_volume_params params;
    uint32_t level_count;
    uint32_t cell_level_count; // levels that have cells of their own: 1 for a grid; then come mips
                               // of the last
    uint32_t face_count;
    double anchor[3];
    float bounds_min[3]; // of the scene that the voxels were laid out for
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
    uint32_t face_growth; // doublings
    uint32_t tile_capacity;
    uint32_t batch_capacity;
    uint32_t cell_count; // cells up to the highest in use
    size_t list_words;
    size_t mip_words; // of those, at the end: bits that tell which voxels of mips are occupied

    // What must be voxelized next.
    bool laid_out;
    bool faces_full; // the pool of face records was too small
    bool everything; // all voxels anew
    uint32_t region_count;
    uint32_t region_voxels;
    uint32_t batch_count;
    struct voxel_boxes dirty[VOXEL_MAX_LEVELS];
    struct voxel_instance *instances; // as voxelized
    uint32_t instance_count;
    uint64_t geometry_seen;
    uint64_t transforms_seen;
    uint64_t surfaces_hash;
    uint32_t epoch;    // counts changes of geometry, modulo 256
    uint32_t *scratch; // chunks on their way to the GPU
    size_t scratch_words;

    uint64_t lit_key; // of everything that light depends on
    struct voxel_light_state light;
    uint32_t frame;   // counts draws
    float scale;      // radiance is stored divided by it
    uint32_t clamped; // values that half floats did not hold, so far
    struct voxel_block uniforms;
};

// NULL when GPU memory ends.
struct voxel_volume *voxel_volume_create(struct gpu *gpu, const struct voxel_volume_params *params);
void voxel_volume_destroy(struct voxel_volume **volume);

// Works out what must be voxelized for the scene as it is and a camera at `eye`, and prepares the
// chunks of triangles. False when memory ends.
bool voxel_volume_update(struct voxel_volume *volume, const struct gpu_scene *gpu_scene,
                         const float eye[3]);

// Part of the above, in gi/chunks.c: regions, chunks of triangles that may touch them, and the
// table of surfaces.
bool voxel_volume_prepare_work(struct voxel_volume *volume, const struct gpu_scene *gpu_scene);

// After a voxelization: whether it had room. If not, pools have been enlarged and everything must
// be voxelized again (voxel_volume_update, then the pass). Waits for the GPU.
enum voxel_room { VOXEL_ROOM_ENOUGH, VOXEL_ROOM_GROWN, VOXEL_ROOM_NONE };
enum voxel_room voxel_volume_check_room(struct voxel_volume *volume);

// Writes the uniforms and binds everything.
void voxel_volume_bind(struct voxel_volume *volume);

// Which levels the next dispatch lights, or which it filters (the first).
void voxel_volume_choose_levels(struct voxel_volume *volume, uint32_t first, uint32_t end);

#endif
