// Looks up the irradiance cache between voxel faces.
#include "lib/voxel_cells.glsl"

vec4 face_light(uint words)
{
    return vec4(unpackHalf2x16(cells[words + CELL_FACE_LIGHT]),
                unpackHalf2x16(cells[words + CELL_FACE_LIGHT + 1u]));
}

// The finest level that holds a place with all its neighbours; `out_room` is how many voxels it lies
// inside. The number of levels if there is none.
uint cache_level(vec3 position, out float out_room)
{
    uint level = 0u;
    out_room = 0.0;
    while (level < voxels.counts.x && (level == 0u || voxels.levels[level].index.z != 0u)) {
        ivec4 origin = voxels.levels[level].origin;
        vec3 at = position * voxels.levels[level].size.y - vec3(origin.xyz);
        vec3 rim = min(at, float(origin.w) - at);
        out_room = min(rim.x, min(rim.y, rim.z)) - 1.0;
        if (out_room >= 0.0)
            return level;
        level++;
    }
    return voxels.counts.x;
}

// Irradiance / pi / scale and openness, of weight a: trilinear between the faces of the eight voxels
// around a place that look the way of `normal`. `position` is relative to the anchor.
void add_cached(uint level, vec3 position, vec3 normal, float share, inout vec4 sum,
                inout float weight)
{
    vec3 at = position * voxels.levels[level].size.y - 0.5;
    ivec3 low = ivec3(floor(at));
    vec3 t = at - vec3(low);
    uint face = dominant_face(normal);
    for (int i = 0; i < 8; i++) {
        ivec3 step = ivec3(i & 1, (i >> 1) & 1, i >> 2);
        uint cell = find_cell(level, low + step);
        if (cell == VOXEL_NONE)
            continue;
        uint words = cell_face(cell, face);
        uint direction = cells[words + CELL_FACE_NORMAL];
        if (direction == VOXEL_NONE || (cells[words + CELL_FACE_STATE] & FACE_FLAG_VALID) == 0u)
            continue;
        vec3 near = mix(1.0 - t, t, vec3(step));
        float facing = max(dot(normal, octahedral_decode(unpackSnorm2x16(direction))), 0.0);
        float w = share * (near.x * near.y * near.z + 1e-4) * facing * facing;
        sum += w * face_light(words);
        weight += w;
    }
}

// Where the faces that look the surface's way are not known, any of its voxel's faces do.
void add_any_face(uint level, vec3 position, vec3 normal, inout vec4 sum, inout float weight)
{
    uint cell = find_cell(level, ivec3(floor(position * voxels.levels[level].size.y)));
    if (cell == VOXEL_NONE)
        return;
    for (uint face = 0u; face < VOXEL_FACES; face++) {
        uint words = cell_face(cell, face);
        uint direction = cells[words + CELL_FACE_NORMAL];
        if (direction == VOXEL_NONE || (cells[words + CELL_FACE_STATE] & FACE_FLAG_VALID) == 0u)
            continue;
        float w = 0.01 + max(dot(normal, octahedral_decode(unpackSnorm2x16(direction))), 0.0);
        sum += w * face_light(words);
        weight += w;
    }
}

// Irradiance / pi / scale; a: openness. Zero where nothing is known yet.
vec4 cached_irradiance(vec3 world, vec3 normal)
{
    vec3 position = world - voxels.anchor.xyz;
    float room;
    uint level = cache_level(position, room);
    if (level >= voxels.counts.x)
        return vec4(0.0);
    vec4 sum = vec4(0.0);
    float weight = 0.0;
#if CLIP_LEVELS
    // Over its last voxels a level fades into the next.
    float own = level + 1u < voxels.counts.x ? clamp(room * 0.25, 0.0, 1.0) : 1.0;
    uint levels = own < 1.0 ? 2u : 1u;
    for (uint i = 0u; i < levels; i++) {
        vec4 part = vec4(0.0);
        float part_weight = 0.0;
        add_cached(level + i, position, normal, 1.0, part, part_weight);
        float share = i == 0u ? own : 1.0 - own;
        if (part_weight > 0.0) {
            sum += part * (share / part_weight);
            weight += share;
        }
    }
#else
    add_cached(level, position, normal, 1.0, sum, weight);
#endif
    if (weight < 1e-6)
        add_any_face(level, position, normal, sum, weight);
    return weight > 0.0 ? sum / weight : vec4(0.0);
}
