// Filters voxels of a level from the eight of the finer level, so that a wide cone reads one coarse
// texel. In: list of voxels, radiance texture, cells. Out: radiance texture, cells of clip levels.
//
// Per face composites the two voxels of each column front to back, then averages the four columns
// (anisotropic pre-integration, Crassin et al. 2011). Stores optical depth.
#include "lib/voxel_faces.glsl"
#include "lib/voxel_texture.glsl"

layout(local_size_x = LINEAR_GROUP) in;

layout(binding = UNIT_VOXEL_RADIANCE) uniform sampler3D voxel_radiance;

layout(binding = UNIT_VOXEL_LISTS) uniform usamplerBuffer list_texels;

#define LEVEL voxels.first_level
#define FINER (LEVEL - 1u)

vec4 fetch_finer(ivec3 voxel, uint face)
{
    ivec3 texels = voxels.levels[FINER].texel_origin;
    ivec3 address = slot_address(FINER, voxel_slot(FINER, voxel));
    return texelFetch(voxel_radiance,
                      texels + ivec3(voxels.levels[FINER].face_stride * int(face), 0, 0) + address,
                      0);
}

// Radiance and opacity of one texel.
vec4 seen_through(vec4 texel)
{
    float covered = 1.0 - exp(-texel.a);
    return vec4(texel.rgb * (covered / max(texel.a, 1e-9)), covered);
}

vec4 filtered_face(ivec3 corner, uint face)
{
    uint axis = face >> 1u;
    ivec3 along = ivec3(axis == 0u, axis == 1u, axis == 2u);
    ivec3 right = along.zxy;
    ivec3 up = along.yzx;
    bool positive = (face & 1u) == 0u;
    vec4 sum = vec4(0.0);
    for (int i = 0; i < 4; i++) {
        ivec3 at = corner + right * (i & 1) + up * (i >> 1);
        vec4 front = seen_through(fetch_finer(at + (positive ? along : ivec3(0)), face));
        vec4 back = seen_through(fetch_finer(at + (positive ? ivec3(0) : along), face));
        sum += front + back * (1.0 - front.a);
    }
    sum *= 0.25;
    float depth = min(-log(max(1.0 - sum.a, 1e-9)), float(VOXEL_MAX_DEPTH));
    return vec4(sum.rgb * (depth / max(sum.a, 1e-9)), depth);
}

#if VOXEL_DIRECTIONS == 1
// One value for all directions: the mean of the six.
vec4 filtered_mean(ivec3 corner)
{
    vec4 sum = vec4(0.0);
    for (uint axis = 0u; axis < 3u; axis++)
        for (uint side = 0u; side < 2u; side++) {
            // The isotropic texture has one face; only the order of front and back differs.
            vec4 value = filtered_face(corner, 2u * axis + side);
            sum += value;
        }
    return sum / 6.0;
}
#endif

#if CLIP_LEVELS
// Copies the mean irradiance of the finer voxels, so that a level is lit as soon as it becomes
// visible.
void inherit_irradiance(uint slot, ivec3 corner)
{
    uint cell = index_word(voxels.levels[LEVEL].first_index + slot) - 1u;
    if (cell == VOXEL_NONE)
        return;
    uint children[8];
    uint left = 0u; // faces that any of them has
    for (int i = 0; i < 8; i++) {
        children[i] = find_cell(FINER, corner + ivec3(i & 1, (i >> 1) & 1, i >> 2));
        left |= children[i] == VOXEL_NONE ? 0u : cell_faces(children[i]);
    }
    if (left == 0u)
        return;
    do {
        uint face = uint(findLSB(left));
        vec4 sum = vec4(0.0);
        float count = 0.0;
        uint like = VOXEL_NONE;
        int i = 0;
        do {
            uint child = children[i];
            uint from = child == VOXEL_NONE ? VOXEL_NONE : cell_face(child, face);
            if (from == VOXEL_NONE)
                continue;
            uvec4 shown = face_shown(from);
            if (shown.x == VOXEL_NONE || (shown.w & FACE_VALID) == 0u)
                continue;
            like = from;
            sum += face_light(from);
            count += 1.0;
        } while (++i < 8);
        vec3 former;
        uint to =
            like == VOXEL_NONE ? VOXEL_NONE : make_face(cell, LEVEL, corner >> 1, face, former);
        if (to == VOXEL_NONE)
            continue;
        sum /= count;
        uvec2 halves = uvec2(packHalf2x16(sum.xy), packHalf2x16(sum.zw));
        faces[to + FACE_NORMAL] = face_word(like, FACE_NORMAL);
        faces[to + FACE_LIGHT] = halves.x;
        faces[to + FACE_LIGHT + 1u] = halves.y;
        faces[to + FACE_SHOWN] = halves.x;
        faces[to + FACE_SHOWN + 1u] = halves.y;
        faces[to + FACE_STATE] = FACE_VALID;
    } while ((left &= left - 1u) != 0u);
}
#endif

void main()
{
    uint number = gl_GlobalInvocationID.x;
    if (number >= counters[COUNTER_LISTS + LEVEL * COUNTER_LIST_WORDS + 3u])
        return;
    uint slot = texelFetch(list_texels, int(LEVEL * voxels.list_capacity + number)).x;
    ivec3 corner = slot_voxel(LEVEL, slot) * 2;
    ivec3 address = slot_address(LEVEL, slot);
#if VOXEL_DIRECTIONS == 1
    store_voxel_face(LEVEL, address, 0u, filtered_mean(corner));
#else
    uint face = 0u;
    do {
        store_voxel_face(LEVEL, address, face, filtered_face(corner, face));
    } while (++face < VOXEL_FACES);
#endif
#if CLIP_LEVELS
    if (LEVEL < voxels.cell_level_count)
        inherit_irradiance(slot, corner);
#endif
}
