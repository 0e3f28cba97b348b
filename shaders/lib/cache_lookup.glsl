// Interpolates the irradiance cache between voxel faces.
#include "lib/voxel_cells.glsl"

// The finest level that contains a position with all its neighbours, or the number of levels if
// none does; `out_room` is how far inside it lies, in voxels.
uint cache_level(vec3 position, out float out_room)
{
    uint level = 0u;
    do {
        ivec3 origin = voxels.levels[level].origin;
        vec3 at = position * voxels.levels[level].inverse_voxel_edge - vec3(origin);
        vec3 rim = min(at, float(voxels.levels[level].edge) - at);
        out_room = min(rim.x, min(rim.y, rim.z)) - 1.0;
        level += out_room < 0.0 ? 1u : 0u;
    } while (out_room < 0.0 && level < voxels.cell_level_count);
    return level;
}

// Minimum axis weight (squared normal component): a surface reads the faces of every axis above it,
// so that nothing jumps where the dominant axis changes.
const float MIN_WEIGHT = 0.1;

// Of the 2x2x2 voxels around a position, counted along x, then y, then z.
ivec3 voxel_step(uint number)
{
    return ivec3(number & 1u, (number >> 1) & 1u, number >> 2);
}

// Adds irradiance / pi / scale and ambient visibility, interpolated trilinearly between the faces
// of the eight voxels around `position` that face the way of `normal`. `position` is relative to
// the anchor.
void add_cached(uint level, vec3 position, vec3 normal, inout vec4 sum, inout float weight)
{
    vec3 at = position * voxels.levels[level].inverse_voxel_edge - 0.5;
    ivec3 low = ivec3(floor(at));
    vec3 t = at - vec3(low);
    vec3 axis_weights = normal * normal;
    uint axes = (axis_weights.x > MIN_WEIGHT ? 1u : 0u) | (axis_weights.y > MIN_WEIGHT ? 2u : 0u) |
                (axis_weights.z > MIN_WEIGHT ? 4u : 0u);
    // Inlines find_cell(), to read what is the same for all eight only once.
    ivec3 origin = voxels.levels[level].origin;
    uint first_index = voxels.levels[level].first_index;
    uint shift = voxels.levels[level].edge_log2;
    int edge_mask = voxels.levels[level].edge - 1;
    low -= voxels.levels[level].wraps != 0u ? ivec3(0) : origin;
    // A CPU driver runs a loop for all lanes as often as one of them needs it, and branches always.
    // So the faces that there are, often a quarter of what the normal asks for, are listed first:
    // a bit for each voxel and axis, four bits a voxel.
    bvec3 negative = lessThan(normal, vec3(0.0));
    uint waiting = 0u;
    uint i = 0u;
    do {
        uvec3 slot = uvec3((low + voxel_step(i)) & edge_mask);
        uint entry =
            index_word(first_index + (slot.x | (slot.y << shift) | (slot.z << (2u * shift))));
        uint cell = max(entry, 1u) - 1u;
        uvec2 x = cell_words(cell, 0u).zw; // of the faces from word CELL_FACES on
        uvec4 yz = cell_words(cell, 4u);
        uint found = ((negative.x ? x.y : x.x) != 0u ? 1u : 0u) |
                     ((negative.y ? yz.y : yz.x) != 0u ? 2u : 0u) |
                     ((negative.z ? yz.w : yz.z) != 0u ? 4u : 0u);
        waiting |= entry != 0u ? (found & axes) << (4u * i) : 0u;
    } while (++i < 8u);
    if (waiting == 0u)
        return;
    uint record_words = voxels.face_record_words;
    do {
        uint bit = uint(findLSB(waiting));
        uint axis = bit & 3u;
        ivec3 step = voxel_step(bit >> 2);
        uvec3 slot = uvec3((low + step) & edge_mask);
        uint cell =
            index_word(first_index + (slot.x | (slot.y << shift) | (slot.z << (2u * shift)))) - 1u;
        uint face = 2u * axis + (negative[axis] ? 1u : 0u);
        uvec4 shown = face_shown((cell_word(cell, CELL_FACES + face) - 1u) * record_words);
        float facing = max(dot(normal, octahedral_decode(unpackSnorm2x16(shown.x))), 0.0);
        facing *= facing;
        vec4 light = face_shown_light(shown);
        vec3 near = mix(1.0 - t, t, vec3(step));
        float fraction = near.x * near.y * near.z + 1e-4;
        // Ambient visibility 0 marks an unknown face.
        bool known = shown.x != VOXEL_NONE && light.a > 0.0;
        float w = known ? fraction * facing * facing : 0.0;
        sum += known ? w * light : vec4(0.0);
        weight += w;
    } while ((waiting &= waiting - 1u) != 0u);
}

// If the matching faces are unknown (weight 0), uses any face of the voxel.
void add_any_face(uint level, vec3 position, vec3 normal, inout vec4 sum, inout float weight)
{
    uint cell = find_cell(level, ivec3(floor(position * voxels.levels[level].inverse_voxel_edge)));
    // Where the weight is known, the body runs once on a CPU rather than for every face.
    uint face = weight < 1e-6 && cell != VOXEL_NONE ? 0u : VOXEL_FACES;
    if (face == VOXEL_FACES)
        return;
    do {
        uint words = cell_face(cell, face);
        if (words == VOXEL_NONE)
            continue;
        uvec4 shown = face_shown(words);
        if (shown.x == VOXEL_NONE || (shown.w & FACE_VALID) == 0u)
            continue;
        float w = 0.01 + max(dot(normal, octahedral_decode(unpackSnorm2x16(shown.x))), 0.0);
        sum += w * face_shown_light(shown);
        weight += w;
    } while (++face < VOXEL_FACES);
}

// Irradiance / pi / scale; a: ambient visibility. Zero where unknown.
vec4 cached_irradiance(vec3 world, vec3 normal)
{
    vec3 position = world - voxels.anchor;
    float room;
    uint level = cache_level(position, room);
    if (level >= voxels.cell_level_count)
        return vec4(0.0);
    vec4 sum = vec4(0.0);
    float weight = 0.0;
#if CLIP_LEVELS
    // A level fades into the next over its last voxels.
    float own = level + 1u < voxels.cell_level_count ? clamp(room * 0.25, 0.0, 1.0) : 1.0;
    uint levels = own < 1.0 ? 2u : 1u;
    uint i = 0u;
    do {
        vec4 part = vec4(0.0);
        float part_weight = 0.0;
        add_cached(level + i, position, normal, part, part_weight);
        float fraction = i == 0u ? own : 1.0 - own;
        if (part_weight > 0.0) {
            sum += part * (fraction / part_weight);
            weight += fraction;
        }
    } while (++i < levels);
#else
    add_cached(level, position, normal, sum, weight);
#endif
    add_any_face(level, position, normal, sum, weight);
    return weight > 0.0 ? sum / weight : vec4(0.0);
}
