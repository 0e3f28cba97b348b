// The scene: plain data in glTF 2.0 units and conventions, edited in place.
//
// Right-handed, Y up, metres, radians; linear Rec.709 colour; point and spot lights in candela,
// directional lights in lux, emission in candela per square metre (nit). Matrices are column-major
// float[16]; quaternions are x, y, z, w. Only one thread at a time may use a scene.
#ifndef VOXCAST_RENDERER_SCENE_SCENE_H
#define VOXCAST_RENDERER_SCENE_SCENE_H

#include <stdbool.h>
#include <stdint.h>

#include "renderer/parameter_types.h"
#include "renderer/image/environment_image.h"
#include "renderer/image/image.h"

#define SCENE_NONE UINT32_MAX

// Beyond this distance from the origin, squared lengths leave the range of floats.
#define SCENE_MAX_COORDINATE_M 1e15f

// Limits. A file beyond them is refused with a message that names the limit.
#define SCENE_MAX_VERTICES   (64u << 20)
#define SCENE_MAX_INDICES    (192u << 20)
#define SCENE_MAX_NODES      200000u
#define SCENE_MAX_MESHES     100000u
#define SCENE_MAX_PRIMITIVES 200000u
#define SCENE_MAX_MATERIALS  16384u
#define SCENE_MAX_IMAGES     4096u
#define SCENE_MAX_LIGHTS     8192u
#define SCENE_MAX_CAMERAS    1024u
#define SCENE_MAX_ANIMATIONS 1024u
#define SCENE_MAX_WARNINGS   64u

// So many removed lights keep their slots, so that they can be restored under their ids.
#define SCENE_KEPT_LIGHTS 256u

enum scene_wrap { SCENE_WRAP_REPEAT, SCENE_WRAP_CLAMP_TO_EDGE, SCENE_WRAP_MIRRORED_REPEAT };

enum scene_animation_path { SCENE_PATH_TRANSLATION, SCENE_PATH_ROTATION, SCENE_PATH_SCALE };

enum scene_interpolation { SCENE_STEP, SCENE_LINEAR, SCENE_CUBIC_SPLINE };

// A texture as a material uses it: uv' = offset + rotate(rotation_rad) * (scale * uv), as in
// KHR_texture_transform. `image` is SCENE_NONE without texture.
struct scene_texture {
    uint32_t image;
    uint32_t uv_set; // 0 or 1
    enum scene_wrap wrap_u;
    enum scene_wrap wrap_v;
    bool nearest; // magnification without filtering
    float offset[2];
    float scale[2];
    float rotation_rad;
};

enum scene_texture_slot {
    SCENE_TEXTURE_BASE_COLOR,         // sRGB, alpha linear
    SCENE_TEXTURE_METALLIC_ROUGHNESS, // G roughness, B metallic
    SCENE_TEXTURE_NORMAL,             // tangent space, +Y up
    SCENE_TEXTURE_OCCLUSION,          // R
    SCENE_TEXTURE_EMISSIVE,           // sRGB
    SCENE_TEXTURE_TRANSMISSION,       // R
    SCENE_TEXTURE_SPECULAR,           // A
    SCENE_TEXTURE_SPECULAR_COLOR,     // sRGB
    SCENE_TEXTURE_SLOT_COUNT
};

// A material as in glTF 2.0 and KHR_materials_{emissive_strength, ior, transmission, volume, unlit,
// specular}. Blinn-Phong materials use base_color as diffuse, specular_color as specular
// reflectance and shininess_from_roughness(roughness).
struct scene_material {
    char name[64];
    enum scene_shading shading;
    enum scene_alpha_mode alpha_mode;
    bool double_sided;
    float alpha_cutoff;
    float base_color[4];
    float metallic;
    float roughness;
    float normal_scale;
    float occlusion_strength;
    float emissive[3]; // 0..1, times emissive_strength in cd/m^2
    float emissive_strength;
    float ior; // 1: no dielectric specular; 0: glTF's backward-compatibility value (F0 = 1)
    float specular;
    float specular_color[3];
    float transmission;
    float thickness_m;
    float attenuation_distance_m; // 0: infinite, no attenuation
    float attenuation_color[3];
    struct scene_texture textures[SCENE_TEXTURE_SLOT_COUNT];
};

struct scene_vertex {
    float position[3];
    float normal[3];
    float tangent[4]; // w is the sign of the bitangent: B = w * cross(N, T)
    float uv[2][2];
    float color[4]; // linear, multiplies base_color; 1 if the file has none
};

// Triangles index_first .. index_first + index_count - 1 of scene->indices, which are absolute
// indices into scene->vertices.
struct scene_primitive {
    uint32_t mesh;
    uint32_t material;
    uint32_t index_first;
    uint32_t index_count;
    uint32_t vertex_first;
    uint32_t vertex_count;
    float bounds_min[3]; // local space
    float bounds_max[3];
};

// Primitives primitive_first .. primitive_first + primitive_count - 1 of scene->primitives.
struct scene_mesh {
    char name[64];
    uint32_t primitive_first;
    uint32_t primitive_count;
};

// Parents precede their children in scene->nodes. `removed` nodes keep their slot so that ids stay
// valid; they are neither drawn nor listed.
struct scene_node {
    char name[64];
    uint32_t parent; // SCENE_NONE: root
    uint32_t mesh;   // SCENE_NONE: none; likewise below
    uint32_t light;
    uint32_t camera;
    bool visible;
    bool removed;
    float translation[3];
    float rotation[4];
    float scale[3];
    float world_from_local[16]; // updated by scene_update_world_transforms()
    bool world_visible;         // this and every ancestor is visible; updated likewise
};

// KHR_lights_punctual: positioned by its node, emitting along the node's -Z axis. `removed` lights
// keep their slot in scene->lights so that ids stay valid.
struct scene_light {
    char name[64];
    enum scene_light_type type;
    uint32_t node;
    bool enabled;
    bool removed;
    bool casts_shadow;
    float color[3];
    float intensity; // cd (point, spot) or lux (directional)
    float range_m;   // 0: unlimited
    float inner_cone_rad;
    float outer_cone_rad;
    float radius_m; // of a sphere light; 0: a point
};

// Positioned by its node, looking along the node's -Z axis with +Y up.
struct scene_camera {
    char name[64];
    uint32_t node;
    float fov_y_rad;
};

struct scene_environment {
    enum scene_environment_type type;
    float intensity; // multiplies the colours below or the image; the result is in cd/m^2
    float color[3];  // constant colour, or the gradient's zenith
    float horizon_color[3];
    float ground_color[3];
    float rotation_rad; // about +Y
    // One reference, or NULL. It stays while another type is chosen. Direction of column u:
    // longitude 2 pi (u - 0.5) from -Z towards +X.
    struct environment_image *image;
};

struct scene_animation_channel {
    uint32_t node;
    enum scene_animation_path path;
    enum scene_interpolation interpolation;
    uint32_t key_count;
    float *times_s; // owned, increasing, key_count
    float *values;  // owned, key_count x (3 or 4), x 3 for cubic splines (in, value, out)
};

struct scene_animation {
    char name[64];
    float duration_s;
    uint32_t channel_count;
    struct scene_animation_channel *channels; // owned
};

// Each counts changes of one part of the scene; consumers compare with what they last saw.
struct scene_revisions {
    uint64_t geometry;   // vertices, indices, primitives, images, the set of nodes
    uint64_t transforms; // node transforms and visibility
    uint64_t materials;
    uint64_t lights;
    uint64_t environment;
};

// Rejected input: values that would cause errors elsewhere.
struct scene_rejects {
    uint32_t triangles;  // left out: a corner is not finite or beyond SCENE_MAX_COORDINATE_M
    uint32_t vertices;   // with directions, coordinates or colours that are not finite
    uint32_t parameters; // of materials, lights and cameras, out of range in the file
};

struct scene {
    char name[128];
    char *source_path;   // canonical path, or "builtin:NAME"; owned
    char **source_files; // canonical paths of every file read, for hot reload; owned
    uint32_t source_file_count;
    char *warnings[SCENE_MAX_WARNINGS]; // what the loader ignored or repaired; owned
    uint32_t warning_count;
    struct scene_rejects rejects;
    uint32_t missing_image_count; // images that could not be read and were left out

    struct scene_vertex *vertices;
    uint32_t vertex_count, vertex_capacity;
    uint32_t *indices;
    uint32_t index_count, index_capacity;
    struct scene_primitive *primitives;
    uint32_t primitive_count, primitive_capacity;
    struct scene_mesh *meshes;
    uint32_t mesh_count, mesh_capacity;
    struct scene_material *materials; // never empty once built: material 0 exists
    uint32_t material_count, material_capacity;
    struct image **images; // a reference to each
    uint32_t image_count, image_capacity;
    struct scene_node *nodes;
    uint32_t node_count, node_capacity;
    struct scene_light *lights;
    uint32_t light_count, light_capacity;
    struct scene_camera *cameras;
    uint32_t camera_count, camera_capacity;
    struct scene_animation *animations;
    uint32_t animation_count, animation_capacity;
    struct scene_environment environment;
    struct scene_revisions revisions;
};

// An empty scene. Add at least one material before the first primitive. NULL when out of memory.
struct scene *scene_create(const char *name);
void scene_destroy(struct scene **scene);

// Copies what images depend on, for another thread: everything except animations, cameras, files
// and warnings. Shares images, which never change. Cost: copying vertices and indices, tens of
// milliseconds for a million triangles. NULL when out of memory.
struct scene *scene_copy(const struct scene *source);

// glTF 2.0 defaults for every field: white, metallic 1, roughness 1, IOR 1.5, no textures.
void scene_material_init(struct scene_material *material, const char *name);

// A white, enabled, shadow-casting light of intensity 1 with glTF's default cone (0, pi/4).
void scene_light_init(struct scene_light *light, enum scene_light_type type, const char *name);

// The builders append and return the new id, or SCENE_NONE at a limit or when memory runs out.
uint32_t scene_add_material(struct scene *scene, const struct scene_material *material);

// Takes a reference of its own; the caller keeps its own.
uint32_t scene_add_image(struct scene *scene, struct image *image);

// A mesh without primitives; call scene_add_primitive() before the next scene_add_mesh().
uint32_t scene_add_mesh(struct scene *scene, const char *name);

// Appends a triangle list to the newest mesh. `indices` count from 0 within `vertices` and must be
// below vertex_count; index_count is a multiple of 3. Computes the bounds. Repairs what is not
// finite: leaves out triangles with such positions and sets other values to 0 (colours to 1).
// Counts both in scene->rejects. Also SCENE_NONE where no triangle is left: a primitive without any
// has no bounds. Importers tell their users of that themselves, beforehand.
uint32_t scene_add_primitive(struct scene *scene, const struct scene_vertex *vertices,
                             uint32_t vertex_count, const uint32_t *indices, uint32_t index_count,
                             uint32_t material);

// A visible node with an identity transform. `parent` is SCENE_NONE or an existing node.
uint32_t scene_add_node(struct scene *scene, const char *name, uint32_t parent);

// Adds a light and its root node. `direction` need not be unit length.
uint32_t scene_add_light(struct scene *scene, const struct scene_light *light,
                         const float position[3], const float direction[3]);

// Adds a camera and its root node at `eye`, looking at `target`.
uint32_t scene_add_camera(struct scene *scene, const char *name, const float eye[3],
                          const float target[3], const float up[3], float fov_y_rad);

void scene_add_warning(struct scene *scene, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
bool scene_add_source_file(struct scene *scene, const char *path);

// Edits. Each changes the data and increments the affected revisions.
void scene_set_node_transform(struct scene *scene, uint32_t node, const float translation[3],
                              const float rotation[4], const float scale[3]);
void scene_set_node_visible(struct scene *scene, uint32_t node, bool visible);
void scene_set_material(struct scene *scene, uint32_t material, const struct scene_material *value);
void scene_set_light(struct scene *scene, uint32_t light, const struct scene_light *value);

// World-space position and direction of a light: moves its node.
void scene_set_light_placement(struct scene *scene, uint32_t light, const float position[3],
                               const float direction[3]);
void scene_get_light_placement(const struct scene *scene, uint32_t light, float out_position[3],
                               float out_direction[3]);
void scene_remove_light(struct scene *scene, uint32_t light);

// Restores a removed light under its id. If another light has used its slot meanwhile, it keeps
// that light's values. False if it is not removed.
bool scene_restore_light(struct scene *scene, uint32_t light);

// Takes over the reference of environment->image, which may be the one that is there already.
void scene_set_environment(struct scene *scene, const struct scene_environment *environment);

// Recomputes world_from_local and world_visible of every node from local transforms. Call after
// building; edits call it themselves.
void scene_update_world_transforms(struct scene *scene);

// Poses the nodes of one animation at a time in seconds (clamped to its duration).
void scene_animate(struct scene *scene, uint32_t animation, float time_s);

// World-space box of all visible geometry, in double, since scenes can be far from the origin.
// False, with outputs unchanged, if there is none.
bool scene_bounds(const struct scene *scene, double out_min[3], double out_max[3]);

// Triangles drawn: counts a mesh once per node.
uint64_t scene_triangle_count(const struct scene *scene);

// World-space eye, target (1 m ahead) and up of a camera.
void scene_get_camera_placement(const struct scene *scene, uint32_t camera, float out_eye[3],
                                float out_target[3], float out_up[3]);

#endif
