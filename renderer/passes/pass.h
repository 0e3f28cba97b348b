// What a pass is. The executor (passes/executor.c) owns the list of passes and alone decides order,
// timers, debug groups and skipping.
#ifndef VOXCAST_RENDERER_PASSES_PASS_H
#define VOXCAST_RENDERER_PASSES_PASS_H

#include "renderer/error.h"
#include "renderer/frame/frame.h"
#include "renderer/gpu/gpu.h"
#include "renderer/passes/resource.h"

// Whether the image is radiance and goes through exposure and tone curve, rather than shown as is.
bool frame_shows_light(const struct frame *frame);

// Why the debug view has nothing to show, so that the image is plain grey; NULL if it has.
const char *frame_blank_reason(const struct frame *frame);

struct pass {
    const char *name;
    uint32_t effects_used; // EFFECT_BITs that select the shader permutation
    uint32_t reads;        // bits of resources
    uint32_t writes;       // likewise

    // NULL if the pass must run, else why it can be skipped.
    const char *(*skip_reason)(const struct frame *frame);

    bool shows_reference;         // also runs when the image is a reference
    bool runs_while_accumulating; // also runs in accumulate-only frames

    // Binds and dispatches; allocates nothing. False with a message if a shader fails.
    bool (*run)(struct frame *frame, const struct pass *pass, struct error *out_error);
};

// What shading a ray's hit reads (hit_program()).
#define HIT_READS                                                                                  \
    (RESOURCE(BVH) | RESOURCE(GEOMETRY) | RESOURCE(MATERIALS) | RESOURCE(LIGHTS) |                 \
     RESOURCE(SHADOW_MAP) | RESOURCE(ENVIRONMENT) | RESOURCE(VOXELS) | RESOURCE(VOXEL_RADIANCE) |  \
     RESOURCE(IRRADIANCE))

extern const struct pass visibility_pass, gbuffer_pass, shadow_map_pass, voxelize_pass,
    voxel_relight_pass, voxel_filter_pass, irradiance_cache_pass, light_tiles_pass,
    environment_pass, ray_shadows_pass, direct_light_pass, emission_pass, indirect_diffuse_pass,
    indirect_specular_pass, transparency_pass, reference_pass, debug_view_pass, exposure_pass,
    tonemap_pass, readback_pass;

#define PASS_COUNT 20
extern const struct pass *const all_passes[PASS_COUNT];

// Runs the needed passes in order and times each. False with a message if one fails.
bool passes_execute(struct frame *frame, struct error *out_error);

// Compares what a program binds, as the driver sees it, with what its pass declares; once per build
// of the program. What is undeclared is logged and counts as a GL error, so that declarations
// cannot drift from the shaders.
void pass_check_bindings(const struct frame *frame, const struct pass *pass,
                         const struct gpu_program *program);

// Whether every resource is written before it is read, in the order of all_passes. On failure the
// message names the pass and the resource.
bool passes_check(const struct pass *const *passes, uint32_t count, struct error *out_error);

// The shader's permutation for the frame's effects and `extra` defines ("NAME 1" lines).
const struct gpu_program *pass_program(const struct frame *frame, const struct pass *pass,
                                       const char *shader, const char *extra,
                                       struct error *out_error);

// The same for shaders that access voxels: adds the number of directions per voxel.
const struct gpu_program *voxel_program(const struct frame *frame, const struct pass *pass,
                                        const char *shader, const char *extra,
                                        struct error *out_error);

// The same for shaders that trace rays against the triangles and shade the hits.
const struct gpu_program *hit_program(const struct frame *frame, const struct pass *pass,
                                      const char *shader, struct error *out_error);

// Filters the accumulated samples spatially: irradiance, or the specular lobe. Does nothing in
// accumulate-only frames.
bool filter_accumulation(const struct frame *frame, const struct pass *pass, bool specular,
                         struct error *out_error);

// Finds which of the sun's cascades to render. Call before the passes run.
void shadow_map_fit_cascades(struct frame *frame);

// Writes where the cascades lie relative to the whole scene's shadow map.
struct frame_block;
void shadow_map_relate_cascades(const struct frame *frame, struct frame_block *block);

// Dispatches groups of GROUP_EDGE^2 over the rendered pixels.
void pass_dispatch_pixels(const struct frame *frame, const struct gpu_program *program);

#endif
