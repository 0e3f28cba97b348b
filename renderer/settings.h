// What a frame looks like beside the scene itself: plain data, set by whoever asks for the frame.
#ifndef VOXCAST_RENDERER_SETTINGS_H
#define VOXCAST_RENDERER_SETTINGS_H

#include <stdbool.h>
#include <stdint.h>

#define VIEW_MAX_WIDTH  4096u
#define VIEW_MAX_HEIGHT 2160u
#define VIEW_MIN_EDGE   1u

// How indirect light is found; see ARCHITECTURE.md.
enum gi_method {
    GI_METHOD_NONE,      // direct light only
    GI_METHOD_CLIPMAP,   // voxel cones through nested cubes around the camera
    GI_METHOD_GRID,      // voxel cones through one cube around the scene and its mip chain
    GI_METHOD_REFERENCE, // paths, traced on the CPU: see renderer/path_tracer/reference.h
    GI_METHOD_COUNT
};

// Voxels along an edge of a cube. "Auto" leaves it to the quality level.
enum voxel_resolution {
    VOXEL_RESOLUTION_AUTO,
    VOXEL_RESOLUTION_64,
    VOXEL_RESOLUTION_128,
    VOXEL_RESOLUTION_256, // grid only; clipmaps take 128
    VOXEL_RESOLUTION_COUNT
};

// Whether a voxel holds one radiance for each of six directions, or one for all.
enum voxel_directions { VOXEL_ANISOTROPIC, VOXEL_ISOTROPIC, VOXEL_DIRECTIONS_COUNT };

// Cones per hemisphere.
enum cone_set {
    CONE_SET_AUTO,
    CONE_SET_5,
    CONE_SET_6,
    CONE_SET_9,
    CONE_SET_16,
    CONE_SET_32,
    CONE_SET_COUNT
};

// Where diffuse light is gathered: by cones at voxel faces only, at every other pixel, at every
// pixel; or by rays against the triangles, which wait until the camera rests and the light in
// voxels has settled. "Auto" leaves it to the quality level.
enum gather_mode {
    GATHER_AUTO,
    GATHER_CACHE,
    GATHER_HALF,
    GATHER_PIXEL,
    GATHER_RAYS,
    GATHER_COUNT
};

// How many clip levels are relit in a frame.
enum levels_per_frame { LEVELS_PER_FRAME_ALL, LEVELS_PER_FRAME_ONE, LEVELS_PER_FRAME_COUNT };

#define CLIP_MAX_LEVELS 6u
#define CONE_STEP_MIN   0.25f
#define CONE_STEP_MAX   2.0f

enum tonemap { TONEMAP_HABLE, TONEMAP_ACES, TONEMAP_KHRONOS_NEUTRAL, TONEMAP_NONE, TONEMAP_COUNT };

enum exposure_mode { EXPOSURE_AUTOMATIC, EXPOSURE_FIXED, EXPOSURE_MODE_COUNT };

enum shading_model { SHADING_MODEL_GGX, SHADING_MODEL_BLINN_PHONG, SHADING_MODEL_COUNT };

enum debug_view {
    DEBUG_VIEW_FINAL,
    DEBUG_VIEW_DIRECT,
    DEBUG_VIEW_ALBEDO,
    DEBUG_VIEW_NORMAL,
    DEBUG_VIEW_ROUGHNESS,
    DEBUG_VIEW_METALLIC,
    DEBUG_VIEW_EMISSION,
    DEBUG_VIEW_DEPTH,
    DEBUG_VIEW_IDS,
    DEBUG_VIEW_LIGHTS_PER_TILE,
    DEBUG_VIEW_SHADOW_CASCADES,
    DEBUG_VIEW_VOXEL_OPACITY, // these five: one level and face, ray-marched; dimmed where another
                              // face stands in, since the voxel has no surface that way
    DEBUG_VIEW_VOXEL_ALBEDO,
    DEBUG_VIEW_VOXEL_NORMAL,
    DEBUG_VIEW_VOXEL_RADIANCE,
    DEBUG_VIEW_VOXEL_IRRADIANCE,
    DEBUG_VIEW_INDIRECT_DIFFUSE,
    DEBUG_VIEW_INDIRECT_SPECULAR,
    DEBUG_VIEW_AMBIENT_OCCLUSION, // ambient visibility: white sees no occluder nearby
    DEBUG_VIEW_CACHE_AGE,         // colours as in shaders/debug/cache_view.comp
    DEBUG_VIEW_TILE_CLASSES,      // colours as in shaders/debug/tile_classes.comp
    DEBUG_VIEW_COUNT
};

// Directions of voxel faces, in the order of the radiance texture.
enum voxel_face {
    VOXEL_FACE_POSITIVE_X,
    VOXEL_FACE_NEGATIVE_X,
    VOXEL_FACE_POSITIVE_Y,
    VOXEL_FACE_NEGATIVE_Y,
    VOXEL_FACE_POSITIVE_Z,
    VOXEL_FACE_NEGATIVE_Z,
    VOXEL_FACE_COUNT
};

enum quality { QUALITY_DRAFT, QUALITY_INTERACTIVE, QUALITY_HIGH, QUALITY_FINAL, QUALITY_COUNT };

// Names as the protocol and the command line spell them; indexed by the enums above.
extern const char *const gi_method_names[GI_METHOD_COUNT];
extern const char *const voxel_resolution_names[VOXEL_RESOLUTION_COUNT];
extern const char *const voxel_directions_names[VOXEL_DIRECTIONS_COUNT];
extern const char *const cone_set_names[CONE_SET_COUNT];
extern const char *const gather_mode_names[GATHER_COUNT];
extern const char *const levels_per_frame_names[LEVELS_PER_FRAME_COUNT];
extern const char *const voxel_face_names[VOXEL_FACE_COUNT];
extern const char *const tonemap_names[TONEMAP_COUNT];
extern const char *const exposure_mode_names[EXPOSURE_MODE_COUNT];
extern const char *const shading_model_names[SHADING_MODEL_COUNT];
extern const char *const debug_view_names[DEBUG_VIEW_COUNT];
extern const char *const quality_names[QUALITY_COUNT];

// Shared by all views of a scene.
struct render_settings {
    enum gi_method gi_method;
    enum voxel_resolution voxel_resolution;
    enum voxel_directions voxel_directions;
    uint32_t clip_levels; // 1 to CLIP_MAX_LEVELS; 0: as many as the scene's extent calls for
    enum cone_set cone_set;
    float cone_step; // length of a step over the cone's diameter; 0: by the quality level
    enum gather_mode gather_mode;
    uint32_t bounces;          // of indirect light, 1 to 16; 0: unlimited
    float indirect_intensity;  // 1 is physical
    bool ambient_occlusion;    // darkens indirect diffuse light by the cones' occlusion
    bool soft_shadows;         // of lights that have a size
    bool indirect_specular;    // one cone along the reflection
    bool refraction;           // one cone through transmissive surfaces
    bool environment_light;    // cones that leave the scene see the environment
    bool voxelize_every_frame; // grid only: for comparison with engines that must
    enum levels_per_frame levels_per_frame; // clipmap only
    enum tonemap tonemap;
    enum exposure_mode exposure_mode;
    float exposure_ev; // added stops; in fixed mode radiance is scaled by 2^exposure_ev
    float gamma;       // 0 means the sRGB curve; else a plain power
    enum shading_model shading_model; // for materials that do not say Blinn-Phong themselves
    bool shadows;
    bool force_all_effects; // run every effect, needed or not: for proving that planning is exact
};

// One row of the quality table: what costs time and may be traded for it.
struct quality_level {
    float resolution_scale;   // rendered size over shown size; 2 averages four samples a pixel
    float texture_anisotropy; // 1 is plain trilinear
    uint32_t shadow_taps;     // PCF taps per light and pixel
    uint32_t shadow_cascades; // of the sun, around the camera, beside the map of the whole scene
    enum voxel_resolution voxel_resolution; // on a GPU at least 128
    enum cone_set cone_set;
    float cone_step;
    enum gather_mode gather_mode;
    uint32_t ray_step;          // where rays gather: every how many-th rendered pixel has them,
    uint32_t ray_pictures;      // and how many pictures of one ray each are averaged
    bool cone_shadows;          // soft shadows by cones, where rays do not show them
    float specular_roughness;   // rougher surfaces reflect as if by the cached irradiance
    float specular_reflectance; // and so do those that reflect less than this head-on
};

extern const struct quality_level quality_levels[QUALITY_COUNT];

struct view_camera {
    float eye[3];    // world, metres
    float target[3]; // world
    float up[3];
    float fov_y_rad;
};

void render_settings_init(struct render_settings *settings);
bool render_settings_equal(const struct render_settings *a, const struct render_settings *b);

// Whether a view shows what only global illumination has.
bool debug_view_needs_voxels(enum debug_view view);

#endif
