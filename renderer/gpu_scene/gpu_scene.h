// A scene as the GPU holds it: buffers, texture arrays, light tables and shadow maps. Kept in step
// with the scene document by its revisions. Render thread only.
#ifndef VOXCAST_RENDERER_GPU_SCENE_GPU_SCENE_H
#define VOXCAST_RENDERER_GPU_SCENE_GPU_SCENE_H

#include "renderer/gpu/buffer.h"
#include "renderer/gpu/gpu.h"
#include "renderer/gpu/texture.h"
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
// Nearest shadow caster of a light, relative to the scene's diagonal; and the most it is in m, or
// something huge and far away would let nearer casters through.
#define SHADOW_NEAR_FRACTION 1e-4f
#define SHADOW_NEAR_MAX_M    1e-2f

#define MAX_VIEW_CASCADES (RENDERER_MAX_VIEWS * MAX_CASCADES)

// Draws are sorted into groups of one kind and one face culling.
enum draw_kind { DRAW_OPAQUE, DRAW_MASKED, DRAW_TRANSPARENT, DRAW_KIND_COUNT };
#define DRAW_CULL_COUNT  3 // enum gpu_cull
#define DRAW_GROUP_COUNT (DRAW_KIND_COUNT * DRAW_CULL_COUNT)

// Up to 2^ID_BLOCK_BITS triangles of a primitive: what is culled at once. Local space. All its
// triangles face away from an eye if dot(center - eye, axis) >= cutoff * |center - eye| + radius.
struct gpu_scene_cluster {
    float center[3];
    float radius;
    float axis[3];
    float cutoff; // 2 where the triangles face too many ways to say
};

struct gpu_scene_instance {
    uint32_t node;
    float world_from_local[16]; // of the node, about the resident's origin
    uint32_t primitive;
    uint32_t index_first;
    uint32_t index_count;
    uint32_t cluster_first; // in resident->clusters
    uint32_t first_id;      // visibility id of the first triangle, less 1
    float scale;            // largest stretch of the placement
    uint8_t group;          // kind * DRAW_CULL_COUNT + cull
    bool visible;
    bool emits_directly; // all its emission reaches others as that of planar emitters
    bool large_emitter;  // of those, one that voxels hold better: see area_lights.c
    float bounds_min[3]; // world about the resident's origin; likewise wherever "world" is said
    float bounds_max[3]; // below renderer.h
};

struct gpu_scene_counts {
    uint32_t instances;
    uint32_t lights; // enabled punctual lights
    uint32_t ranged_lights;
    uint32_t area_lights;
    uint32_t large_area_lights; // of those: see area_lights.c
    uint32_t shadow_layers;
    uint32_t unshadowed;          // lights that shall cast shadows, but there is no layer left
    uint32_t single_view_shadows; // lights with one view
    uint32_t point_shadows;       // lights with six
    uint32_t colored_primitives;  // with vertex colours other than white
    uint32_t textured_materials;  // in use by a visible instance; likewise below
    uint32_t masked_materials;
    uint32_t transparent_materials;
    uint32_t blinn_phong_materials;
    uint32_t specular_materials;
    uint32_t lit_materials; // that are not unlit
    uint32_t emissive_materials;
    uint32_t reflective_materials; // that pass light on at all
    uint32_t transmissive_materials;
    uint32_t sized_lights; // punctual lights with a radius, and small planar emitters
};

// Pictures of one colour space: an array per edge, and where each of the scene's images went.
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
    // All places on the GPU count from here: near the scene, 0 for scenes about the world's origin,
    // and whole multiples of a power of two, so that moving there rounds nothing.
    double origin[3];

    struct gpu_buffer *vertices;
    struct gpu_buffer *indices;
    struct gpu_buffer *instance_blocks;
    struct gpu_buffer *id_blocks;
    struct gpu_buffer *raster_vertices;
    struct gpu_buffer *raster_indices; // triangle by triangle as `indices`, but turned
    struct gpu_geometry *geometry;     // of the two
    struct gpu_scene_instance *instances;
    struct gpu_scene_cluster *clusters; // of all primitives
    uint32_t cluster_count;             // of all instances: the most draws there can be
    bool drawable;                      // any triangle at all
    float bounds_min[3];
    float bounds_max[3];
    float diagonal_m; // of the bounds; 1 where there is no geometry

    struct bvh *bvh; // of what gathering rays meet; NULL until asked for

    struct gpu_buffer *materials;
    struct gpu_buffer *texture_blocks;
    bool texture_transforms;                // any texture has a KHR_texture_transform of its own
    bool second_uv_set;                     // any texture reads the second set of coordinates
    struct texture_space texture_spaces[2]; // sRGB colour, linear data

    struct gpu_buffer *lights;
    struct gpu_buffer *area_lights;
    uint32_t directional_light; // index in `lights` of the one with view cascades, or NO_SHADOW
    float directional_axis[3];
    struct shadow_map *shadow_map;
    struct shadow_view_block shadow_views[MAX_SHADOW_LAYERS];
    bool shadow_stale[MAX_SHADOW_LAYERS];
    uint64_t shadow_epoch_seen;
    uint32_t sun_shadow_view; // of directional_light
    uint64_t shadow_revision; // counts changes of any shadow caster or light
    uint64_t caster_hash;     // of what instances cast, but for where they are
    bool casters_changed;     // since the shadow maps were last told

    struct gpu_buffer *environment;
    struct scene_environment environment_seen; // what the pictures below were made from; its
    uint64_t environment_serial;               // image may be gone, but not this number of it
    struct gpu_texture *environment_levels;
    struct gpu_texture *environment_background;
};

// Uploads everything; NULL with a message when memory ends. `scene` must outlive the result.
struct gpu_scene *gpu_scene_create(struct gpu *gpu, const struct scene *scene,
                                   struct error *out_error);
void gpu_scene_destroy(struct gpu_scene **gpu_scene);

// Uploads what the scene's revisions say has changed. False with a message when memory ends.
bool gpu_scene_update(struct gpu_scene *gpu_scene, struct error *out_error);

// Parts of the above, one file each.
bool gpu_scene_upload_geometry(struct gpu_scene *gpu_scene);
bool gpu_scene_upload_raster_mesh(struct gpu_scene *gpu_scene);
bool gpu_scene_build_clusters(struct gpu_scene *gpu_scene);
bool gpu_scene_upload_instances(struct gpu_scene *gpu_scene);
bool gpu_scene_upload_textures(struct gpu_scene *gpu_scene);
bool gpu_scene_upload_materials(struct gpu_scene *gpu_scene);
bool gpu_scene_upload_lights(struct gpu_scene *gpu_scene);
bool gpu_scene_upload_environment(struct gpu_scene *gpu_scene);
void gpu_scene_count_materials(struct gpu_scene *gpu_scene);

// Makes resident->tree that of the geometry as it is now; cheap where it is already. False when
// memory ends.
bool gpu_scene_need_tree(struct gpu_scene *gpu_scene);

// From the scene's world to that about the resident's origin; in place or not.
void gpu_scene_from_world(const struct gpu_scene *gpu_scene, const float world[3],
                          float out_position[3]);

// Distance of the near plane of lights' shadow views.
float gpu_scene_shadow_near_m(const struct gpu_scene *gpu_scene);

// Which space a texture slot reads from.
int gpu_scene_texture_space(int slot);

// Binds all buffers and textures of the scene to their slots.
void gpu_scene_bind(const struct gpu_scene *gpu_scene);

// The orthographic view along `axis` (unit, the way that light travels) of a box, as deep as the
// whole scene.
void gpu_scene_directional_view(const struct gpu_scene *gpu_scene, const float axis[3],
                                const float box_min[3], const float box_max[3],
                                struct shadow_view_block *out_view);

// Finds the planar emitters among the visible instances. Returns their number.
uint32_t gpu_scene_find_area_lights(struct gpu_scene *gpu_scene,
                                    struct area_light_block out_lights[MAX_AREA_LIGHTS]);

#endif
