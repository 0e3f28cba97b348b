// Debug view of the voxels of one level, by ray marching. In: index, cells, face records, radiance
// texture. Out: radiance (SHOW 3 and 4) or display values, shown without exposure and tone curve.
//
// SHOW 0: opacity 1 - exp(-depth) of the chosen face; 1: its albedo; 2: its mean normal; 3: its
// radiance; 4: its cached irradiance / pi. CELLS 0: a mip level, which has only opacity and
// radiance; a checker stands for the rest. A voxel without a surface on the chosen face shows,
// dimmed, the face most turned to the eye.
#include "lib/voxel_cells.glsl"
#include "lib/display.glsl"
#include "lib/radiance_buffer.glsl"

layout(local_size_x = PIXEL_GROUP_WIDTH, local_size_y = PIXEL_GROUP_HEIGHT) in;

layout(binding = UNIT_VOXEL_RADIANCE) uniform sampler3D voxel_radiance;

#define FROM_TEXTURE (SHOW == 0 || SHOW == 3)
#define IS_LIGHT     (SHOW == 3 || SHOW == 4)

const float DIMMED = 0.3;
const float MIN_WEIGHT = 0.03;

struct voxel_hit {
    bool found;
    ivec3 voxel;
    bvec3 side;              // axis of the face that was entered
    float t;                 // along the ray, whose forward component is 1
    vec3 sub_voxel_position; // within the voxel
};

// Radiance times depth, and depth.
vec4 face_texel(uint level, ivec3 voxel, uint face)
{
    ivec3 texels = voxels.levels[level].texel_origin;
    ivec3 address = slot_address(level, voxel_slot(level, voxel));
    return texelFetch(voxel_radiance,
                      texels + ivec3(voxels.levels[level].face_stride * int(face), 0, 0) + address,
                      0);
}

float total_depth(uint level, ivec3 voxel)
{
    float depth = 0.0;
    for (uint face = 0u; face < uint(VOXEL_DIRECTIONS); face++)
        depth += face_texel(level, voxel, face).a;
    return depth;
}

bool is_occupied(uint level, ivec3 voxel)
{
#if CELLS
    return find_cell(level, voxel) != VOXEL_NONE;
#else
    return total_depth(level, voxel) > 0.0;
#endif
}

// The first occupied voxel, skipping those next to the eye, which would hide the rest (Amanatides
// and Woo 1987, "A Fast Voxel Traversal Algorithm for Ray Tracing"). Origin and direction in voxels
// of the level.
voxel_hit march_voxels(uint level, vec3 origin, vec3 direction)
{
    voxel_hit hit;
    hit.found = false;
    ivec3 box = voxels.levels[level].origin;
    int edge = voxels.levels[level].edge;
    direction = mix(direction, vec3(1e-9), lessThan(abs(direction), vec3(1e-9)));
    vec3 inverse = 1.0 / direction;
    vec3 to_low = (vec3(box) - origin) * inverse;
    vec3 to_high = (vec3(box + edge) - origin) * inverse;
    vec3 enter = min(to_low, to_high);
    vec3 leave = max(to_low, to_high);
    float start = max(max(enter.x, max(enter.y, enter.z)), 0.0);
    if (start >= min(leave.x, min(leave.y, leave.z)))
        return hit;
    hit.t = start;
    hit.side = greaterThanEqual(enter, vec3(start));
    hit.voxel = clamp(ivec3(floor(origin + start * direction)), box, box + edge - 1);
    ivec3 step = ivec3(sign(direction));
    vec3 next = (vec3(hit.voxel + max(step, ivec3(0))) - origin) * inverse;
    ivec3 eye_voxel = ivec3(floor(origin));
    for (int i = 0; i < 3 * edge; i++) {
        bool far = any(greaterThan(abs(hit.voxel - eye_voxel), ivec3(1)));
        if (far && is_occupied(level, hit.voxel)) {
            hit.found = true;
            break;
        }
        hit.t = min(next.x, min(next.y, next.z));
        hit.side = lessThanEqual(next, vec3(hit.t));
        hit.voxel += step * ivec3(hit.side);
        next += abs(inverse) * vec3(hit.side);
        if (!voxel_in_level(level, hit.voxel))
            break;
    }
    hit.sub_voxel_position = clamp(origin + hit.t * direction - vec3(hit.voxel), 0.0, 1.0);
    return hit;
}

// `minimum`: optical depth of a surface, above that of a neighbour's rim.
bool face_has_surface(uint level, ivec3 voxel, uint cell, uint face, float minimum)
{
#if FROM_TEXTURE
    return face_texel(level, voxel, face).a > minimum;
#else
    uint words = cell == VOXEL_NONE ? VOXEL_NONE : cell_face(cell, face);
    return words != VOXEL_NONE && face_word(words, FACE_NORMAL) != VOXEL_NONE;
#endif
}

// The chosen face, or of those with a surface the one most turned against the ray; VOXEL_NONE if
// the voxel has no surface.
uint shown_face(uint level, ivec3 voxel, uint cell, uint chosen, vec3 direction)
{
    float minimum = 0.0;
#if FROM_TEXTURE
    minimum = MIN_WEIGHT * total_depth(level, voxel);
#endif
    if (face_has_surface(level, voxel, cell, chosen, minimum))
        return chosen;
    uint best = VOXEL_NONE;
    float maximum = -2.0;
    for (uint face = 0u; face < VOXEL_FACES; face++) {
        float towards = -dot(direction, face_direction(face));
        if (towards > maximum && face_has_surface(level, voxel, cell, face, minimum)) {
            best = face;
            maximum = towards;
        }
    }
    return best;
}

#if SHOW == 1
// Records that are filled from a finer level have no albedo: uses a record of the finer level.
uint record_with_albedo(uint level, ivec3 voxel, uint face, uint words)
{
    bool bare = true;
    for (uint finer = level; finer > 0u && bare; finer--) {
        bare = face_word(words, FACE_ALBEDO) == 0u &&
               unpackHalf2x16(face_word(words, FACE_DIRECT + 1u)).y == 0.0;
        uint found = VOXEL_NONE;
        ivec3 corner = 2 * voxel;
        for (int i = 0; i < 8; i++) {
            ivec3 child = corner + ivec3(i & 1, (i >> 1) & 1, i >> 2);
            uint cell =
                voxel_in_level(finer - 1u, child) ? find_cell(finer - 1u, child) : VOXEL_NONE;
            uint record = cell == VOXEL_NONE ? VOXEL_NONE : cell_face(cell, face);
            if (record != VOXEL_NONE && face_word(record, FACE_NORMAL) != VOXEL_NONE) {
                found = record;
                voxel = child;
            }
        }
        bare = bare && found != VOXEL_NONE;
        words = bare ? found : words;
    }
    return words;
}
#endif

// Value of a face; `words` is its record.
vec3 face_color(uint level, ivec3 voxel, uint face, uint words)
{
#if SHOW == 0
    return vec3(1.0 - exp(-face_texel(level, voxel, face).a));
#elif SHOW == 1
    uint bits = face_word(record_with_albedo(level, voxel, face, words), FACE_ALBEDO);
    return transfer(vec3(bits & 1023u, (bits >> 10) & 1023u, (bits >> 20) & 1023u) / 1023.0);
#elif SHOW == 2
    return octahedral_decode(unpackSnorm2x16(face_word(words, FACE_NORMAL))) * 0.5 + 0.5;
#elif SHOW == 3
    vec4 texel = face_texel(level, voxel, face);
    return texel.rgb * (voxels.radiance_scale / texel.a);
#else
    bool known = (face_word(words, FACE_STATE) & FACE_VALID) != 0u;
    return known ? face_light(words).rgb * voxels.radiance_scale : vec3(0.0);
#endif
}

// Dark edges on large enough voxels, and a shade per axis.
float block_shade(voxel_hit hit, float pixels_per_voxel)
{
    vec3 rim = max(min(hit.sub_voxel_position, 1.0 - hit.sub_voxel_position), vec3(hit.side));
    float line = 1.0 - clamp(min(rim.x, min(rim.y, rim.z)) * pixels_per_voxel - 0.5, 0.0, 1.0);
    float strength = 0.35 * clamp((pixels_per_voxel - 4.0) / 8.0, 0.0, 1.0);
    float tone = hit.side.y ? 1.0 : hit.side.x ? 0.82 : 0.91;
    return tone * (1.0 - strength * line);
}

// Pattern for missing data.
vec3 checker(ivec3 voxel)
{
    return ((voxel.x + voxel.y + voxel.z) & 1) != 0 ? vec3(0.34, 0.0, 0.3) : vec3(0.22, 0.0, 0.19);
}

vec3 shown_color(uint level, voxel_hit hit, vec3 direction)
{
#if !CELLS && !FROM_TEXTURE
    return checker(hit.voxel);
#else
    uint chosen = frame.debug_face;
    uint cell = VOXEL_NONE;
#if CELLS
    cell = find_cell(level, hit.voxel);
#endif
    uint face = shown_face(level, hit.voxel, cell, chosen, direction);
    if (face == VOXEL_NONE)
        return IS_LIGHT ? vec3(0.0) : checker(hit.voxel);
    uint words = 0u;
#if !FROM_TEXTURE
    words = cell_face(cell, face);
#endif
    return face_color(level, hit.voxel, face, words) * (face == chosen ? 1.0 : DIMMED);
#endif
}

void main()
{
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, frame.render_size)))
        return;
    uint level = frame.debug_level;
    float inverse = voxels.levels[level].inverse_voxel_edge;
    vec3 direction = ray_direction(vec2(pixel)) * inverse;
    voxel_hit hit = march_voxels(level, (frame.eye - voxels.anchor) * inverse, direction);
    vec3 color = vec3(0.0);
    if (hit.found) {
        color = shown_color(level, hit, normalize(direction));
#if !IS_LIGHT
        color *= block_shade(hit, 1.0 / max(hit.t * length(frame.ray_dx) * inverse, 1e-6));
#endif
    }
    radiance[pixel.y * frame.render_size.x + pixel.x] = vec4(color, 1.0);
}
