// What a pass is. Order, names and when a pass runs are rows of frame.def; the executor
// (passes/executor.c) does timers, debug groups and bindings.
#ifndef VOXCAST_RENDERER_PASSES_PASS_H
#define VOXCAST_RENDERER_PASSES_PASS_H

#include "renderer/error.h"
#include "renderer/frame/frame.h"
#include "renderer/frame/resource.h"
#include "renderer/gpu/gpu.h"

// A shader and what selects its permutation: lines of a define and its value for each effect and
// switch, and lines that are always the same.
struct shader_program {
    const char *path;
    uint32_t effects;  // EFFECT_BITs
    uint32_t switches; // SWITCH_BITs
    const char *fixed; // "NAME value\n" lines; NULL for none
};

// Of shaders that include shaders/lib/material.glsl.
#define TEXTURE_SWITCHES                                                                           \
    (SWITCH_BIT(COLOR_CLASSES) | SWITCH_BIT(DATA_CLASSES) | SWITCH_BIT(TEXTURE_TRANSFORMS) |       \
     SWITCH_BIT(SECOND_UV_SET))

#define PASS_MAX_PROGRAMS 8

struct pass {
    uint32_t reads;  // bits of resources
    uint32_t writes; // likewise
    uint32_t program_count;
    struct shader_program programs[PASS_MAX_PROGRAMS];

    // Binds and dispatches; allocates nothing. False with a message if a shader fails.
    bool (*run)(struct frame *frame, const struct pass *pass, struct error *out_error);
};

// What a program that traces rays against the triangles and shades the hits is selected by, and
// what it reads. Light tiles are in screen space and do not apply to hits.
#define HIT_EFFECTS                                                                                \
    ((DIRECT_LIGHT_EFFECTS | EFFECT_BIT(EFFECT_VERTEX_COLORS) | EFFECT_BIT(EFFECT_ALPHA_MASK) |    \
      EFFECT_BIT(EFFECT_ENVIRONMENT_LIGHT) | EFFECT_BIT(EFFECT_CLIP_LEVELS) |                      \
      EFFECT_BIT(EFFECT_MULTI_BOUNCE)) &                                                           \
     ~EFFECT_BIT(EFFECT_LIGHT_TILES))
#define HIT_SWITCHES                                                                               \
    (TEXTURE_SWITCHES | SWITCH_BIT(VOXEL_DIRECTIONS) | SWITCH_BIT(GATHER_STEP) |                   \
     SWITCH_BIT(LIT_HITS))
#define HIT_FIXED "LIGHT_TILES 0\nSHADOW_TAPS 1u\n"
#define HIT_READS                                                                                  \
    (RESOURCE(BVH) | RESOURCE(GEOMETRY) | RESOURCE(SCENE_TABLES) | RESOURCE(TEXTURES) |            \
     RESOURCE(SHADOW_MAP) | RESOURCE(ENVIRONMENT) | RESOURCE(VOXELS) | RESOURCE(VOXEL_RADIANCE) |  \
     RESOURCE(IRRADIANCE))

#define PASS(id, name, ...) extern const struct pass name##_pass;
#include "renderer/frame/frame.def"
#undef PASS

extern const struct pass *const all_passes[PASS_COUNT];

// Runs the passes of the plan in order and times each. False with a message if one fails.
bool passes_execute(struct frame *frame, struct error *out_error);

// Tells the GPU what all shaders of passes need to know. Call once, after gpu_create(). False when
// memory runs out.
bool passes_prepare_gpu(struct gpu *gpu);

// Whether every resource is written before it is read, in the order of `passes`. On failure the
// message names the pass and the resource.
bool passes_check(const struct pass *const *passes, uint32_t count, struct error *out_error);

// Bytes of the view's resources that the pass reads, and of those that it writes. What it reads of
// the scene and of voxels depends on the content, and does not count.
uint64_t pass_view_bytes(const struct pass *pass, const struct view *view);

#define PROGRAM_DEFINES_BYTES 512u

// The lines of defines of a program under a plan.
void shader_program_write_defines(const struct shader_program *program,
                                  const struct frame_plan *plan,
                                  char out_defines[PROGRAM_DEFINES_BYTES]);

// The name of a resource that a program binds, as the driver sees it, and its pass does not
// declare. NULL if there is none.
const char *pass_find_undeclared(const struct pass *pass, const struct gpu_program *program);

// The pass's program for the frame's plan. Once per build it is compared with what the pass
// declares: what is undeclared is logged and counts as a GL error, so that declarations cannot
// drift from the shaders. NULL with a message if the shader fails.
const struct gpu_program *pass_program(const struct frame *frame, const struct pass *pass,
                                       uint32_t number, struct error *out_error);

// All programs of the pass. False with a message if a shader fails.
bool pass_programs(const struct frame *frame, const struct pass *pass,
                   const struct gpu_program *out_programs[], struct error *out_error);

// Runs one of the pass's programs, an invocation a rendered pixel.
bool pass_run_pixels(const struct frame *frame, const struct pass *pass, uint32_t number,
                     struct error *out_error);

// Filters the accumulated samples spatially with the pass's program. Does nothing in frames that
// only accumulate.
bool filter_accumulation(const struct frame *frame, const struct pass *pass, uint32_t number,
                         struct error *out_error);

// Finds which of the sun's cascades to render.
void shadow_map_fit_cascades(struct frame *frame);

// Whether a light's shadow map or a cascade must be rendered.
bool shadow_map_is_stale(const struct frame *frame);

// Writes where the cascades lie relative to the whole scene's shadow map.
struct frame_block;
void shadow_map_relate_cascades(const struct frame *frame, struct frame_block *block);

// Dispatches groups of PIXEL_GROUP_WIDTH x PIXEL_GROUP_HEIGHT, or tiles of GROUP_EDGE^2, over the
// rendered pixels, of which each invocation handles `step` x `step`.
void pass_dispatch_pixels(const struct frame *frame, const struct gpu_program *program,
                          uint32_t step);
void pass_dispatch_tiles(const struct frame *frame, const struct gpu_program *program,
                         uint32_t step);

#endif
