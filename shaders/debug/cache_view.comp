// Debug view of the irradiance cache on visible surfaces. In: G-buffer, cells, face records. Out:
// display values, shown without exposure and tone curve.
//
// AGE 0: ambient visibility, white where nothing near occludes the hemisphere. AGE 1: state of the
// record of each pixel's voxel face. Green: light of this generation, cones traced through the
// present geometry. Yellow: light of an older generation, to be looked up at the cones' hits. Red:
// cones traced through older geometry. Light blue: never traced, light copied from another level.
// Blue: never traced. Grey: no record. The older its newest request, the darker.
#include "lib/gbuffer.glsl"
#include "lib/cache_lookup.glsl"
#include "lib/radiance_buffer.glsl"

layout(local_size_x = PIXEL_GROUP_WIDTH, local_size_y = PIXEL_GROUP_HEIGHT) in;

#if AGE
const float REQUEST_FRAMES = 24.0; // as in shaders/gi/cache_select.comp
const float DARKEST = 0.35;

// Record of the voxel face at a surface, or of another face of the voxel; VOXEL_NONE if there is
// none.
uint record_at(vec3 world, vec3 normal)
{
    vec3 position = world - voxels.anchor;
    float room;
    uint level = cache_level(position, room);
    if (level >= voxels.cell_level_count)
        return VOXEL_NONE;
    uint cell = find_cell(level, ivec3(floor(position * voxels.levels[level].inverse_voxel_edge)));
    if (cell == VOXEL_NONE)
        return VOXEL_NONE;
    uint found = VOXEL_NONE;
    float maximum = -2.0;
    for (uint face = 0u; face < VOXEL_FACES; face++) {
        uint words = cell_face(cell, face);
        float alike = dot(normal, face_direction(face));
        if (words != VOXEL_NONE && face_word(words, FACE_NORMAL) != VOXEL_NONE && alike > maximum) {
            found = words;
            maximum = alike;
        }
    }
    return found;
}

vec3 cache_color(surface s)
{
    uint words = record_at(s.position, s.geometric_normal);
    if (words == VOXEL_NONE)
        return vec3(0.25);
    uint state = face_word(words, FACE_STATE);
    vec3 color = vec3(0.2, 0.8, 0.25);
    if ((state & 0xffffu) != voxels.cache_generation)
        color = vec3(0.95, 0.8, 0.15);
    if ((state >> FACE_EPOCH_BIT) != voxels.geometry_epoch)
        color = vec3(0.9, 0.2, 0.15);
    if ((state & FACE_MARCHED) == 0u)
        color = (state & FACE_VALID) != 0u ? vec3(0.35, 0.75, 0.95) : vec3(0.15, 0.25, 0.95);
    uint asked = face_word(words, FACE_REQUEST);
    float age = asked == 0u ? 1.0 : min(float(voxels.frame_number - asked) / REQUEST_FRAMES, 1.0);
    return color * mix(1.0, DARKEST, age);
}
#else
vec3 cache_color(surface s)
{
    return vec3(cached_irradiance(s.position, s.geometric_normal).a);
}
#endif

void main()
{
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, frame.render_size)))
        return;
    surface s = gbuffer_load(pixel);
    vec3 color = s.shading < SHADE_UNLIT ? cache_color(s) : vec3(0.0);
    radiance[pixel_index(pixel)] = vec4(color, 1.0);
}
