// Injects light into occupied voxels of some levels. In: list of cells, surfels, materials, lights,
// shadow maps, irradiance cache. FRESH 1: only voxels that have not been lit yet. Out: radiance
// texture; face records except for their irradiance.
//
// Radiance of a face is the mean over the surfels that face its way: emission, plus reflectance
// times direct and (MULTI_BOUNCE 1) cached irradiance. Materials are looked up here, so editing one
// needs no voxelization.
#include "lib/voxel_faces.glsl"
#include "lib/voxel_store.glsl"
#define SHADOW_TAPS 2u
#define VIEWLESS    1
#include "lib/lighting.glsl"
#include "lib/material_table.glsl"

layout(local_size_x = LINEAR_GROUP) in;

layout(binding = UNIT_SURFELS) uniform usamplerBuffer surfels;

layout(binding = UNIT_VOXEL_LISTS) uniform usamplerBuffer list_texels;

// Surface of each instance, then material and flags of each surface.
layout(binding = UNIT_VOXEL_SURFACES) uniform usamplerBuffer surfaces;

// Area-weighted sums over what faces one way in the voxel.
struct surfel_sum {
    float weight;
    uint mask;
    vec3 normal;
    vec3 sub_voxel_position;
    vec3 reflectance;
    vec3 emission;
    float opacity;
    // FACE_THIN if it includes a side of a zero-thickness surface. No bool: in arrays of structs
    // Mesa 22.3 hands them to Vulkan as integers of one bit, which are refused.
    uint thin;
};

uint surfel_word(uint word)
{
    return texelFetch(surfels, int(word)).x;
}

vec3 signed_sum(uint word)
{
    return vec3(int(surfel_word(word)), int(surfel_word(word + 1u)), int(surfel_word(word + 2u)));
}

// Adds a surfel to a face's sums; `turn` is -1 for the back of a double-sided surface.
void add_surfel(inout surfel_sum s, uint word, material_block m, bool directly, float turn)
{
    float weight = float(surfel_word(word + SURFEL_WEIGHT));
    float inverse = 1.0 / (255.0 * weight);
    vec3 base = m.base_color.rgb;
    float opacity = 1.0;
    vec3 emission = directly ? vec3(0.0) : m.emission;
#if VOXEL_COLORS
    base *= signed_sum(word + SURFEL_COLOR) * inverse;
    emission *= signed_sum(word + SURFEL_EMISSION) * inverse;
    opacity = float(surfel_word(word + SURFEL_OPACITY)) * inverse;
#endif
    uint alpha = m.flags & (MATERIAL_ALPHA_BLEND | MATERIAL_ALPHA_MASK);
    opacity = alpha != 0u ? clamp(opacity * m.base_color.a, 0.0, 1.0) : 1.0;
    float transmission = m.transmission * (1.0 - m.mean_metallic);
    // Mean reflectance over the hemisphere: the dielectric layer's plus that of the diffuse base,
    // less what the layer reflects by Schlick (F0 and 0.0037 of the rise to F90, see
    // mean_diffuse_fraction()); or the metal's. With mean metallic and roughness.
    bool plain = (m.flags & MATERIAL_IOR_ONE) != 0u;
    vec3 f0 = plain ? vec3(0.0) : min(m.f0 * m.specular_color, 1.0) * m.specular;
    float f90 = plain ? 0.0 : m.specular;
    vec2 fraction = mean_specular_albedo(m.mean_roughness);
    vec3 held = mix(f0, vec3(f90), 0.0037);
    vec3 dielectric = f0 * fraction.x + f90 * fraction.y +
                      base * (1.0 - transmission) * (1.0 - max(held.r, max(held.g, held.b)));
    vec3 reflectance = mix(dielectric, base * fraction.x + fraction.y, m.mean_metallic);
    bool unlit = (m.flags & MATERIAL_SHADING_MASK) == SHADE_UNLIT;
    s.weight += weight;
    s.mask |= surfel_word(word + SURFEL_MASK);
    s.normal += signed_sum(word + SURFEL_NORMAL) * turn;
    s.sub_voxel_position += signed_sum(word + SURFEL_SUB_VOXEL_POSITION) / 255.0;
    s.reflectance += weight * (unlit ? vec3(0.0) : clamp(reflectance, 0.0, 1.0));
    s.emission += weight * (unlit ? vec3(0.0) : emission);
    s.opacity += weight * opacity * (1.0 - transmission);
}

// Fraction of the voxel's cross-section along an axis that its halves cover.
float coverage(uint mask, uint axis)
{
    uint low = axis == 0u ? mask & 0x55u : axis == 1u ? mask & 0x33u : mask & 0x0fu;
    uint high = axis == 0u ? (mask >> 1) & 0x55u : axis == 1u ? (mask >> 2) & 0x33u : mask >> 4;
    return 0.25 * float(bitCount(low | high));
}

// Direct irradiance of a face, averaged over taps around its centre, since shadows are finer than
// voxels. The taps are lifted out of the relief in which the mean position may lie.
const float TAP_LIFT = 0.3;
const float TAP_SPREAD = 0.3;

vec3 direct_irradiance(vec3 position, vec3 normal, bool thin, float voxel_m)
{
#if PUNCTUAL_LIGHTS || AREA_LIGHTS
    surface s;
    s.normal = normal;
    s.geometric_normal = normal;
    s.view = normal;
    s.base_color = vec3(1.0);
    s.metallic = 0.0;
    s.f0 = vec3(0.0);
    s.f90 = 0.0;
    s.roughness = 1.0;
    s.occlusion = 1.0;
    s.emission = vec3(0.0);
    s.shading = SHADE_PBR;
    s.thin = thin;
    mat3 axes = frame_about(normal);
    vec3 sum = vec3(0.0);
    int i = 0;
    do {
        vec2 at = TAPS == 1 ? vec2(0.0) : vec2((i & 1) * 2 - 1, (i >> 1) * 2 - 1) * TAP_SPREAD;
        s.position = position + (axes[0] * at.x + axes[1] * at.y + normal * TAP_LIFT) * voxel_m;
        sum += direct_light(s, uvec2(0u));
    } while (++i < TAPS);
    return sum / (float(TAPS) * voxels.radiance_scale);
#else
    return vec3(0.0);
#endif
}

// Writes a face's sums to its record of the irradiance cache and adds its light to the texels.
void store_side(uint cell, uint level, ivec3 voxel, uint i, surfel_sum s, inout face_sums sums)
{
    vec3 cached;
    uint words = make_face(cell, level, voxel, i, cached);
    if (words == VOXEL_NONE)
        return;
    float inverse = 1.0 / s.weight;
    vec3 normal = safe_normalize(s.normal, face_direction(i));
    vec3 sub_voxel_position = clamp(s.sub_voxel_position * inverse, 0.0, 1.0);
    vec3 position =
        voxels.anchor + (vec3(voxel) + sub_voxel_position) * voxels.levels[level].voxel_edge_m;
    vec3 albedo = clamp(s.reflectance * inverse, 0.0, 1.0);
    vec3 direct = s.emission * (inverse / voxels.radiance_scale) +
                  albedo * direct_irradiance(position, normal, s.thin != 0u,
                                             voxels.levels[level].voxel_edge_m);
    // Proportional to coverage: the parts of a slanted wall in neighbouring voxels add up to a
    // whole one.
    float opacity = min(s.opacity * inverse, 1.0);
    // Touched halves overestimate the coverage of slivers.
    float covered = min(coverage(s.mask, i >> 1u), s.weight / float(SURFEL_WEIGHT_SCALE));
    float depth = covered * min(-log(max(1.0 - opacity, 1e-9)), float(VOXEL_MAX_DEPTH));
    direct = clamp_to_half(direct);
    uvec3 packed_position = uvec3(sub_voxel_position * 1023.0 + 0.5);
    uvec3 packed_albedo = uvec3(albedo * 1023.0 + 0.5);
    faces[words + FACE_NORMAL] = packSnorm2x16(octahedral_encode(normal));
    faces[words + FACE_SUB_VOXEL_POSITION] =
        packed_position.x | (packed_position.y << 10) | (packed_position.z << 20) | s.thin;
    faces[words + FACE_DIRECT] = packHalf2x16(direct.rg);
    faces[words + FACE_DIRECT + 1u] = packHalf2x16(vec2(direct.b, depth));
    faces[words + FACE_ALBEDO] =
        packed_albedo.x | (packed_albedo.y << 10) | (packed_albedo.z << 20);
#if MULTI_BOUNCE
    direct += albedo * cached;
#endif
    add_face(sums, normal, vec4(direct, depth));
}

void main()
{
    uint number = gl_GlobalInvocationID.x;
    if (number >= counters[COUNTER_LISTS + LIST_LIT * COUNTER_LIST_WORDS + 3u])
        return;
    uint cell = texelFetch(list_texels, int(LIST_LIT * voxels.list_capacity + number)).x;
    uint cell_bits = cell_word(cell, 0u);
    uint slot = cell_bits & CELL_SLOT_MASK;
    uint level = cell_bits >> CELL_LEVEL_BIT;
    if (level < voxels.first_level || level >= voxels.end_level)
        return;
#if FRESH
    if (cell_faces(cell) != 0u)
        return;
#endif
    surfel_sum surfel_sums[VOXEL_FACES];
    for (uint i = 0u; i < VOXEL_FACES; i++)
        surfel_sums[i] = surfel_sum(0.0, 0u, vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), 0.0, 0u);
    uint at = cell_word(cell, CELL_SURFEL);
    if (at == VOXEL_NONE)
        return;
    uint found = 0u; // a bit a face
    do {
        uint word = at * SURFEL_WORDS;
        uint key = surfel_word(word + SURFEL_KEY);
        uint surface_word = texelFetch(surfaces, int(voxels.instance_count + (key >> 3))).x;
        material_block m = load_material(surface_word & SURFACE_MATERIAL_MASK);
        bool directly = (surface_word & SURFACE_LIT_DIRECTLY) != 0u;
        add_surfel(surfel_sums[key & 7u], word, m, directly, 1.0);
        if ((m.flags & MATERIAL_DOUBLE_SIDED) != 0u) {
            add_surfel(surfel_sums[(key & 7u) ^ 1u], word, m, directly, -1.0);
            surfel_sums[key & 7u].thin = FACE_THIN;
            surfel_sums[(key & 7u) ^ 1u].thin = FACE_THIN;
            found |= 1u << ((key & 7u) ^ 1u);
        }
        found |= 1u << (key & 7u);
    } while ((at = surfel_word(at * SURFEL_WORDS + SURFEL_NEXT)) != VOXEL_NONE);
    face_sums sums = no_face_sums();
    ivec3 voxel = slot_voxel(level, slot);
    uint gone = cell_faces(cell) & ~found;
    if (gone != 0u) {
        do {
            faces[cell_face(cell, uint(findLSB(gone))) + FACE_NORMAL] = VOXEL_NONE;
        } while ((gone &= gone - 1u) != 0u);
    }
    do {
        uint i = uint(findLSB(found));
        store_side(cell, level, voxel, i, surfel_sums[i], sums);
    } while ((found &= found - 1u) != 0u);
    store_faces(sums, level, slot);
}
