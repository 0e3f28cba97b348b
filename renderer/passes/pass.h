// What a pass is, and what it is given to run. The
// executor (passes/executor.c) has their list and alone decides about order, timers, debug groups
// and skipping.
#ifndef VOXCAST_RENDERER_PASSES_PASS_H
#define VOXCAST_RENDERER_PASSES_PASS_H

#include "renderer/error.h"
#include "renderer/frame/frame.h"
#include "renderer/gpu/gpu.h"

enum resource {
    RESOURCE_IDS,
    RESOURCE_DEPTH,
    RESOURCE_GBUFFER,
    RESOURCE_SHADOW_MAP,
    RESOURCE_VOXELS,         // index, cells, surfels and lists
    RESOURCE_VOXEL_RADIANCE, // what cones walk through
    RESOURCE_IRRADIANCE,     // the cache in cells
    RESOURCE_LIGHT_MASKS,
    RESOURCE_RADIANCE,
    RESOURCE_FRAGMENTS,
    RESOURCE_EXPOSURE,
    RESOURCE_OUTPUT,
    RESOURCE_COUNT
};

enum access { ACCESS_READ = 1, ACCESS_WRITE = 2, ACCESS_READ_WRITE = 3 };

#define PASS_MAX_USES 10

struct resource_use {
    enum resource resource;
    enum access access;
};

// Whether the picture is of light, which goes through exposure and tone curve; else it is displayed
// as it is.
bool frame_shows_light(const struct frame *frame);

// Why there is nothing that the debug view could show, so that the picture is plain grey; NULL if
// there is.
const char *frame_blank_reason(const struct frame *frame);

struct pass {
    const char *name;
    uint32_t effects_used; // EFFECT_BITs that pick this pass's shader permutation
    uint32_t use_count;
    struct resource_use uses[PASS_MAX_USES];

    // NULL if the pass must run, else the reason in words why it need not.
    const char *(*skip_reason)(const struct frame *frame);

    bool shows_reference;         // runs where a reference's picture is shown, too
    bool runs_while_accumulating; // runs in quiet frames, too

    // Binds, dispatches, returns; allocates nothing. False with a message if a shader fails.
    bool (*run)(struct frame *frame, const struct pass *pass, struct error *out_error);
};

extern const struct pass visibility_pass, gbuffer_pass, shadow_map_pass, voxelize_pass,
    voxel_relight_pass, voxel_filter_pass, irradiance_cache_pass, light_tiles_pass,
    environment_pass, ray_shadows_pass, direct_light_pass, emission_pass, indirect_diffuse_pass,
    indirect_specular_pass, transparency_pass, reference_pass, debug_view_pass, exposure_pass,
    tonemap_pass, readback_pass;

#define PASS_COUNT 20
extern const struct pass *const all_passes[PASS_COUNT];

// Runs the passes that are needed, in order, timing each. False with a message if one fails.
bool passes_execute(struct frame *frame, struct error *out_error);

// Tells whether every resource is written before it is read, in the order of all_passes. On
// failure names the pass and the resource.
bool passes_check(const struct pass *const *passes, uint32_t count, struct error *out_error);

// The permutation of a shader for the frame's effects, with `extra` defines ("NAME 1\n" lines).
const struct gpu_program *pass_program(const struct frame *frame, const struct pass *pass,
                                       const char *shader, const char *extra,
                                       struct error *out_error);

// The same for shaders that touch voxels: adds how many directions a voxel has.
const struct gpu_program *voxel_program(const struct frame *frame, const struct pass *pass,
                                        const char *shader, const char *extra,
                                        struct error *out_error);

// The same for shaders that trace rays against the triangles and shade what they meet.
const struct gpu_program *hit_program(const struct frame *frame, const char *shader,
                                      struct error *out_error);

// Averages over neighbours what rays from pixels have found, irradiance or what lobes mirror; not
// in quiet frames.
bool filter_accumulation(const struct frame *frame, bool specular, struct error *out_error);

// Works out which cascades of the sun must be drawn; before the passes run.
void shadow_map_fit_cascades(struct frame *frame);

// Tells the shaders where the cascades lie in the map of the whole scene.
struct frame_block;
void shadow_map_relate_cascades(const struct frame *frame, struct frame_block *block);

// Groups of GROUP_EDGE^2 over the rendered pixels.
void pass_dispatch_pixels(const struct frame *frame, const struct gpu_program *program);

#endif
