// GPU copy of a scene: buffers, texture arrays, light tables and shadow maps. Follows the scene by
// its revisions. Render thread only.
#ifndef VOXCAST_RENDERER_GPU_SCENE_GPU_SCENE_H
#define VOXCAST_RENDERER_GPU_SCENE_GPU_SCENE_H

#include "renderer/gpu/buffer.h"
#include "renderer/gpu/gpu.h"
#include "renderer/gpu/texture.h"
#include "renderer/gpu_scene/scene_facts.h"
#include "renderer/gpu_scene/scene_tables.h"
#include "renderer/gpu_scene/shadow_map.h"
#include "renderer/scene/scene.h"
#include "renderer/settings.h"
#include "shared/area_light_block.h"
#include "shared/bvh.h"
#include "shared/frame_block.h"
#include "shared/instance_block.h"
#include "shared/light_block.h"
#include "shared/material_block.h"
#include "shared/ray_accumulation.h"
#include "shared/slots.h"
#include "shared/texture_block.h"
#include "shared/vertex.h"
#include "shared/work_groups.h"

#define SHADOW_MAP_EDGE 2048u
// Distance of the nearest shadow caster of a light, relative to the scene's diagonal, and its
// maximum in m: a huge, distant object must not clip nearer casters.
#define SHADOW_NEAR_FRACTION 1e-4f
#define SHADOW_NEAR_MAX_M    1e-2f

#define MAX_VIEW_CASCADES (RENDERER_MAX_VIEWS * MAX_CASCADES)

// Draws are grouped by kind and face culling.
enum draw_kind { DRAW_OPAQUE, DRAW_MASKED, DRAW_TRANSPARENT, DRAW_KIND_COUNT };
#define DRAW_CULL_COUNT  3 // enum gpu_cull
#define DRAW_GROUP_COUNT (DRAW_KIND_COUNT * DRAW_CULL_COUNT)

// Up to 2^ID_BLOCK_BITS triangles of a primitive, culled together. Local space. All of them face
// away from an eye if dot(center - eye, axis) >= cutoff * |center - eye| + radius.
struct gpu_scene_cluster {
    float center[3];
    float radius;
    float axis[3];
    float cutoff; // 2 if the normals spread too far to cull
};

// Bounds of up to 2^DRAW_BLOCK_BITS triangles of a primitive, in local space.
#define DRAW_BLOCK_BITS 5
struct gpu_scene_box {
    float low[3];
    float high[3];
};

struct gpu_scene_instance {
    uint32_t node;
    float world_from_local[16]; // the node's, to gpu_scene.origin
    uint32_t primitive;
    uint32_t index_first;
    uint32_t index_count;
    uint32_t cluster_first; // in gpu_scene.clusters
    uint32_t first_id;      // visibility id of the first triangle, minus 1
    float scale;            // maximum stretch of the transform
    uint8_t group;          // kind * DRAW_CULL_COUNT + cull
    bool visible;
    bool emits_directly; // all its emission is sampled directly as planar emitters
    bool large_emitter;  // and voxels gather it instead: see area_lights.c
    float bounds_min[3]; // world: relative to gpu_scene.origin, as in all of
    float bounds_max[3]; // gpu_scene/, frame/, gi/, passes/ and shaders/
};

// Images of one colour space: an array per size, and where each image of the scene is.
struct texture_space {
    uint32_t class_count;
    struct gpu_texture *classes[MAX_CLASSES_PER_SPACE];
    struct image_slot {
        bool used;
        uint32_t class_number;
        uint32_t layer;
        float mean[4]; // linear
    } * image_slots;
};

enum { TEXTURE_SPACE_COLOR, TEXTURE_SPACE_DATA };

struct gpu_scene {
    struct gpu *gpu;
    const struct scene *scene;
    struct scene_revisions seen;
    struct gpu_scene_counts counts;
    // Origin of all positions on the GPU: near the scene, 0 for scenes around the world's origin. A
    // multiple of a power of two, so that the translation does not round.
    double origin[3];

    struct scene_tables tables;
    struct gpu_buffer *vertices;
    struct gpu_buffer *indices;
    struct gpu_buffer *raster_vertices;
    struct gpu_buffer
        *raster_indices;           // same triangles as `indices`, but rotated; CPU drivers: mapped
    struct gpu_geometry *geometry; // of the raster buffers
    struct gpu_scene_instance *instances;
    struct gpu_scene_cluster *clusters; // of all primitives
    struct gpu_scene_box *boxes;        // likewise, a cluster's blocks in a row; CPU drivers only
    uint32_t cluster_count;             // of all instances: maximum number of draws
    bool drawable;                      // there is any triangle
    float bounds_min[3];
    float bounds_max[3];
    float diagonal_m; // of the bounds; 1 without geometry

    struct bvh *bvh; // for rays; NULL until needed
    bool bvh_made;   // there has been one

    bool texture_transforms;                // any texture has a KHR_texture_transform
    bool second_uv_set;                     // any texture reads the second set of coordinates
    struct texture_space texture_spaces[2]; // sRGB colour, linear data

    uint32_t directional_light; // index in `lights` of the light with cascades, or NO_SHADOW
    float directional_axis[3];
    struct shadow_map *shadow_map;
    struct shadow_view_block shadow_views[MAX_SHADOW_LAYERS];
    bool shadow_stale[MAX_SHADOW_LAYERS];
    uint64_t shadow_epoch_seen;
    uint32_t sun_shadow_view; // of directional_light
    uint64_t shadow_revision; // counts changes of shadow casters and lights
    uint64_t caster_hash;     // hash of the casters, except their transforms
    bool casters_changed;     // since the shadow maps last handled it

    struct scene_environment environment_seen; // what the pictures below were made from; its
    uint64_t environment_serial;               // image may be gone, but not this number of it
    struct gpu_texture *environment_levels;
    struct gpu_texture *environment_background;
};

// Uploads everything; NULL with a message when memory runs out. `scene` must outlive the result.
struct gpu_scene *gpu_scene_create(struct gpu *gpu, const struct scene *scene,
                                   struct error *out_error);
void gpu_scene_destroy(struct gpu_scene **gpu_scene);

// Uploads what has changed by the scene's revisions. False with a message when memory runs out.
bool gpu_scene_update(struct gpu_scene *gpu_scene, struct error *out_error);

struct scene_facts gpu_scene_get_facts(const struct gpu_scene *gpu_scene);

// Parts of the above, in files of their own.
bool gpu_scene_upload_geometry(struct gpu_scene *gpu_scene);
bool gpu_scene_upload_raster_mesh(struct gpu_scene *gpu_scene);
bool gpu_scene_build_clusters(struct gpu_scene *gpu_scene);
bool gpu_scene_upload_instances(struct gpu_scene *gpu_scene);
bool gpu_scene_upload_textures(struct gpu_scene *gpu_scene);
bool gpu_scene_upload_materials(struct gpu_scene *gpu_scene);
bool gpu_scene_upload_lights(struct gpu_scene *gpu_scene);
bool gpu_scene_upload_environment(struct gpu_scene *gpu_scene);
void gpu_scene_count_materials(struct gpu_scene *gpu_scene);

// Brings gpu_scene->bvh up to date with the geometry; cheap if it is. False when memory runs out.
bool gpu_scene_need_bvh(struct gpu_scene *gpu_scene);

// World position of the scene to one relative to gpu_scene->origin; may work in place.
void gpu_scene_from_world(const struct gpu_scene *gpu_scene, const float world[3],
                          float out_position[3]);

// Near plane's distance of shadow views.
float gpu_scene_shadow_near_m(const struct gpu_scene *gpu_scene);

// Colour space of a texture slot.
int gpu_scene_texture_space(int slot);

// Binds all buffers and textures of the scene to their slots.
void gpu_scene_bind(const struct gpu_scene *gpu_scene);

// Orthographic view of a box along `axis` (unit, the light's direction), as deep as the whole
// scene.
void gpu_scene_directional_view(const struct gpu_scene *gpu_scene, const float axis[3],
                                const float box_min[3], const float box_max[3],
                                struct shadow_view_block *out_view);

// Finds planar emitters among the visible instances. Returns their number.
uint32_t gpu_scene_find_area_lights(struct gpu_scene *gpu_scene,
                                    struct area_light_block out_lights[MAX_AREA_LIGHTS]);

#endif
