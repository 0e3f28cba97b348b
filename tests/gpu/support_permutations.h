// Permutations of shaders that frames can ask for, found by plans of many random frames.
#ifndef VOXCAST_TESTS_GPU_SUPPORT_PERMUTATIONS_H
#define VOXCAST_TESTS_GPU_SUPPORT_PERMUTATIONS_H

#include "renderer/passes/pass.h"

#define PERMUTATION_SET_SIZE (1u << 18) // slots

// A set of hashes, half of its slots at most. All zero is empty.
struct hash_set {
    uint32_t count;
    uint64_t slots[PERMUTATION_SET_SIZE];
};

// Whether the hash is new.
bool hash_set_add(struct hash_set *set, uint64_t hash);

// One program as one frame asks for it.
struct permutation {
    enum pass_id pass;
    uint32_t number; // of the pass's programs
    const struct shader_program *shader;
    const char *defines;
    const struct frame_inputs *in;
    const struct frame_plan *plan;
};

// Calls `take` once for each permutation that the frames ask for. Returns how many there are.
uint32_t permutations_visit(void (*take)(void *context, const struct permutation *permutation),
                            void *context);

// Whether some defines of the permutation, as many as `depth` (1 to 3), have values together that
// they had in none that was asked about before. `known` remembers.
bool permutation_has_new_combination(struct hash_set *known, const struct permutation *permutation,
                                     uint32_t depth);

#endif
