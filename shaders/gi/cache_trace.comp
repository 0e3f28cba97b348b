// Updates the irradiance of the selected voxel faces. In: queue, face records, radiance texture.
// Out: the faces' irradiance and its change.
//
// MARCH 1: traces their cones and stores where each hits. MARCH 0: reads the radiance at the stored
// hits.
#define CONE_SMOOTH 0
#define FACES_STORED
#include "lib/voxel_cells.glsl"
#include "lib/cone_hemisphere.glsl"

layout(local_size_x = LINEAR_GROUP) in;

layout(std430, binding = BIND_VOXEL_COUNTERS) buffer voxel_counter_storage
{
    uint counters[];
};

#include "lib/clamp_half.glsl"

layout(binding = UNIT_CACHE_QUEUE) uniform usamplerBuffer queue;

// Queue entry of an invocation, class by class; VOXEL_NONE past the end.
uint find_entry(uint number)
{
#if MARCH
    uint urgency = 0u;
    uint count = counters[COUNTER_MARCH + 3u];
#else
    uint urgency = CACHE_MARCH_CLASSES;
    uint count = counters[COUNTER_LOOKUP + 3u];
#endif
    if (number >= count)
        return VOXEL_NONE;
    for (;;) {
        uint length = min(counters[COUNTER_CACHE_CLASSES + urgency], voxels.list_capacity);
        if (number < length)
            return texelFetch(queue, int(urgency * voxels.list_capacity + number)).x;
        number -= length;
        urgency++;
    }
}

uint relative_change(vec3 before, vec3 after)
{
    float size = max(luminance(before), luminance(after));
    float difference = luminance(abs(after - before));
    return uint(clamp(difference / max(size, 1e-9), 0.0, 1.0) * 63.0 + 0.5);
}

void main()
{
    uint words = find_entry(gl_GlobalInvocationID.x);
    if (words == VOXEL_NONE)
        return;
    uvec4 shown = face_shown(words);
    uint state = shown.w;
    uint cell = cell_word(face_word(words, FACE_CELL) >> 3, 0u);
    uint level = cell >> CELL_LEVEL_BIT;
    vec3 corner = vec3(slot_voxel(level, cell & CELL_SLOT_MASK));
    vec3 normal = octahedral_decode(unpackSnorm2x16(shown.x));
    uvec4 former = face_words(words, FACE_LIGHT); // light (two words), position, request
    vec4 former_light = vec4(unpackHalf2x16(former.x), unpackHalf2x16(former.y));
    uint bits = former.z;
    vec3 sub_voxel_position =
        vec3(bits & 1023u, (bits >> 10) & 1023u, (bits >> 20) & 1023u) / 1023.0;
    vec3 position = (corner + sub_voxel_position) * voxels.levels[level].voxel_edge_m;
    // Rotates the cones of neighbours differently, so that interpolation averages more directions.
    ivec3 odd = ivec3(corner) & 1;
    float angle = float(odd.x + 2 * odd.y + 4 * odd.z) * (PI / 4.0);
    hemisphere g =
        begin_hemisphere(position, normal, (bits & FACE_THIN) != 0u, vec2(cos(angle), sin(angle)));
    cone_sum found = no_cone_sum();
#if MARCH
    cone_sum along = no_cone_sum();
#endif
    uint i = 0u;
    do {
#if MARCH
        uint hit;
        add_cone(g, i, along, hit);
        faces[words + FACE_WORDS + i] = hit;
        // Reads radiance at the hit, as MARCH 0 does: the result then does not depend on the frame
        // in which a face was marched.
        add_cone_at_hit(g, i, hit, found);
#else
        add_cone_at_hit(g, i, face_word(words, FACE_WORDS + i), found);
#endif
    } while (++i < uint(voxels.cache_march.cone_count));
#if MARCH
    found.ambient_visibility = along.ambient_visibility;
#else
    found.ambient_visibility = former_light.a;
#endif
    vec3 before = former_light.rgb;
    vec3 light = clamp_to_half(found.light);
    uint red_green = packHalf2x16(light.rg);
    faces[words + FACE_LIGHT] = red_green;
    faces[words + FACE_LIGHT + 1u] = packHalf2x16(vec2(light.b, found.ambient_visibility));
    // New faces show their own light until they are smoothed.
    if ((state & FACE_MARCHED) == 0u) {
        faces[words + FACE_SHOWN] = red_green;
        faces[words + FACE_SHOWN + 1u] =
            packHalf2x16(vec2(light.b, max(found.ambient_visibility, 0.001)));
    }
    uint epoch = MARCH != 0 ? voxels.geometry_epoch : state >> FACE_EPOCH_BIT;
    faces[words + FACE_STATE] = voxels.cache_generation |
                                (relative_change(before, light) << FACE_CHANGE_BIT) | FACE_VALID |
                                FACE_MARCHED | (epoch << FACE_EPOCH_BIT);
    // Relative to at least a hundredth of the peak, so that dark faces do not delay convergence.
    float change =
        luminance(abs(light - before)) / max(luminance(light) + 0.01 * voxels.peak_radiance, 1e-9);
    atomicMax(counters[COUNTER_CACHE_CHANGE], floatBitsToUint(change));
    atomicMax(counters[COUNTER_CACHE_PEAK], floatBitsToUint(luminance(light)));
}
