// GLSL programs: includes, permutations by defines, and hot reload.
#ifndef VOXCAST_RENDERER_GPU_PROGRAM_H
#define VOXCAST_RENDERER_GPU_PROGRAM_H

#include "renderer/gpu/gpu.h"

struct shader_source;

// The permutation of a shader file (path below the shader folder) for these defines, built on first
// use and kept until several hundred others have been asked for. `path` names a compute shader
// ("gbuffer.comp") or, without extension, a pair of .vert and .frag. `defines` are lines of a name
// and a value, or "". NULL on failure.
const struct gpu_program *gpu_program_get(struct gpu *gpu, const char *path, const char *defines,
                                          struct error *out_error);

// Lines of defines that stand before every shader. Call before the first program is built; copied.
// False when memory runs out.
bool gpu_set_shader_defines(struct gpu *gpu, const char *defines);

// The very text that a stage is compiled from: the file at `path`, with its extension, and its
// includes, below the defines of all shaders and `defines`. `source` is set in either case;
// shader_source_finish() frees it.
bool gpu_program_read_stage(const struct gpu *gpu, const char *path, const char *defines,
                            struct shader_source *source, struct error *out_error);

// Rebuilds programs whose files have changed on disk; checks a few times per second at most. A
// program that fails keeps its last good build. Returns the number rebuilt; errors go to
// `out_error`.
uint32_t gpu_programs_reload_changed(struct gpu *gpu, struct error *out_error);

// Starts watching the shader folder.
void gpu_programs_watch(struct gpu *gpu);

// What a program reads or writes, as the driver sees it: code that a permutation leaves out does
// not count.
struct gpu_program_bindings {
    uint32_t storage; // bits of the bindings of storage blocks
    uint64_t units;   // bits of the texture units
    uint32_t images;  // bits of the image units
};

const struct gpu_program_bindings *gpu_program_get_bindings(const struct gpu_program *program);

// Whether this is asked for the first time since the program was built.
bool gpu_program_take_new(const struct gpu_program *program);

// The offset in bytes of a member of a uniform or storage block, such as "frame.near_m" or
// "lights[0].type", as the driver lays it out. False if the program has none of this name.
bool gpu_program_find_member(const struct gpu_program *program, const char *name,
                             uint32_t *out_offset);

// Programs built so far.
uint64_t gpu_programs_built(const struct gpu *gpu);

// Hash of its source, as the driver gets it.
uint64_t gpu_program_source_hash(const struct gpu_program *program);

uint32_t gpu_program_name(const struct gpu_program *program);
void gpu_programs_destroy(struct gpu *gpu);

#endif
