// Counts NaN and infinity. In: a resource. Out: their number and the position of the first.
//
// TEXTURE 0: a buffer of records; masks tell which words are floats and which have a half float in
// the low or high half. TEXTURE 1, 2, 3: a 2D texture, an array, a 3D texture of floats.
#include "shared/finite_check.h"
#include "shared/slots.h"
#include "shared/work_groups.h"

layout(local_size_x = LINEAR_GROUP) in;

layout(std430, binding = BIND_CHECK) buffer check_storage
{
    finite_check_shape shape;
    finite_check_masks masks;
    finite_check_result results[];
}
check;

#if TEXTURE == CHECK_BUFFER
layout(std430, binding = BIND_CHECKED) readonly buffer checked_storage
{
    uint words[];
};
#elif TEXTURE == CHECK_TEXTURE_2D
layout(binding = UNIT_CHECKED) uniform sampler2D checked;
#elif TEXTURE == CHECK_TEXTURE_ARRAY
layout(binding = UNIT_CHECKED) uniform sampler2DArray checked;
#else
layout(binding = UNIT_CHECKED) uniform sampler3D checked;
#endif

// Tests the bits: compilers may assume that floats are finite.
uint float_is_bad(uint bits)
{
    return (bits & 0x7f800000u) == 0x7f800000u ? 1u : 0u;
}

uint half_is_bad(uint bits)
{
    return (bits & 0x7c00u) == 0x7c00u ? 1u : 0u;
}

// `shape` and `masks` are copies from the block: reading storage for every word is slow.
uint count_bad(uint at, finite_check_shape shape, finite_check_masks masks)
{
#if TEXTURE == CHECK_BUFFER
    uint bit = 1u << min(at % shape.record_words, 31u);
    uint word = words[masks.first_word + at];
    return ((masks.floats & bit) != 0u ? float_is_bad(word) : 0u) +
           ((masks.low_halves & bit) != 0u ? half_is_bad(word) : 0u) +
           ((masks.high_halves & bit) != 0u ? half_is_bad(word >> 16) : 0u);
#else
    int level = int(shape.texture_level);
    uint width = uint(textureSize(checked, level).x);
    uint height = uint(textureSize(checked, level).y);
    ivec3 address = ivec3(at % width, at / width % height, at / width / height);
#if TEXTURE == CHECK_TEXTURE_2D
    vec4 texel = texelFetch(checked, address.xy, level);
#else
    vec4 texel = texelFetch(checked, address, level);
#endif
    uvec4 bits = floatBitsToUint(texel);
    return float_is_bad(bits.x) + float_is_bad(bits.y) + float_is_bad(bits.z) +
           float_is_bad(bits.w);
#endif
}

void main()
{
    finite_check_shape shape = check.shape;
    finite_check_masks masks = check.masks;
    uint stride = gl_NumWorkGroups.x * LINEAR_GROUP;
    for (uint at = gl_GlobalInvocationID.x; at < shape.length; at += stride) {
        uint bad = count_bad(at, shape, masks);
        if (bad > 0u) {
            atomicAdd(check.results[shape.result].count, bad);
            atomicMin(check.results[shape.result].first, at);
        }
    }
}
