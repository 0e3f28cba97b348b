// Traces the cones of the chosen voxel faces. In: queue, cells, radiance texture. Out: the faces'
// irradiance and how much it changed.
#define CONE_SMOOTH 0
#include "lib/voxel_cells.glsl"
#include "lib/gather.glsl"

layout(local_size_x = LINEAR_GROUP) in;

layout(std430, binding = BIND_VOXEL_COUNTERS) buffer voxel_counter_storage
{
    uint counters[];
};

layout(std430, binding = BIND_CACHE_QUEUE) readonly buffer queue_storage
{
    uint queue[];
};

// Relative change in 1/255, and of what cannot be told 255.
uint relative_change(vec3 before, vec3 after)
{
    float size = max(luminance(before), luminance(after));
    float difference = luminance(abs(after - before));
    return uint(clamp(difference / max(size, 1e-9), 0.0, 1.0) * 255.0 + 0.5);
}

void main()
{
    uint number = gl_GlobalInvocationID.x;
    if (number >= counters[COUNTER_CACHE_TRACED])
        return;
    uint urgency = 0u;
    while (number >= counters[COUNTER_CACHE_CLASSES + urgency]) {
        number -= counters[COUNTER_CACHE_CLASSES + urgency];
        urgency++;
    }
    uint entry = queue[urgency * voxels.options.x + number];
    uint cell = entry >> 3;
    uint words = cell_face(cell, entry & 7u);
    uint level = cells[cell * CELL_WORDS] >> CELL_LEVEL_BIT;
    ivec3 voxel = slot_voxel(level, cells[cell * CELL_WORDS] & CELL_SLOT_MASK);
    vec3 normal = octahedral_decode(unpackSnorm2x16(cells[words + CELL_FACE_NORMAL]));
    uint bits = cells[words + CELL_FACE_PLACE];
    vec3 place = vec3(bits & 1023u, (bits >> 10) & 1023u, bits >> 20) / 1023.0;
    vec3 position = voxels.anchor.xyz + (vec3(voxel) + place) * voxels.levels[level].size.x;
    gathered found = gather_diffuse(position, normal, vec2(1.0, 0.0));
    vec3 before = vec3(unpackHalf2x16(cells[words + CELL_FACE_LIGHT]),
                       unpackHalf2x16(cells[words + CELL_FACE_LIGHT + 1u]).x);
    vec3 light = min(found.light, vec3(65504.0));
    uint change = relative_change(before, light);
    cells[words + CELL_FACE_LIGHT] = packHalf2x16(light.rg);
    cells[words + CELL_FACE_LIGHT + 1u] = packHalf2x16(vec2(light.b, found.openness));
    cells[words + CELL_FACE_STATE] =
        voxels.cache.x | (change << 16) | FACE_FLAG_VALID | FACE_FLAG_TRACED;
    // Of the brightest light only: dark corners must not keep the whole from being done.
    float weighted = luminance(abs(light - before));
    atomicMax(counters[COUNTER_CACHE_CHANGE], floatBitsToUint(weighted));
    atomicMax(counters[COUNTER_CACHE_PEAK], floatBitsToUint(luminance(light)));
}
