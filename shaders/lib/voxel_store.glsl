// Converts the radiance of a voxel's surfaces to the texels of its faces.
#include "lib/voxel_texture.glsl"

struct face_sums {
    vec4 texels[VOXEL_FACES]; // rgb: radiance * depth, a: depth
};

face_sums no_face_sums()
{
    face_sums sums;
    for (uint i = 0u; i < VOXEL_FACES; i++)
        sums.texels[i] = vec4(0.0);
    return sums;
}

// Adds a surface of radiance rgb and optical depth a; each face gets the depth projected to it.
void add_face(inout face_sums sums, vec3 normal, vec4 value)
{
#if VOXEL_DIRECTIONS == 1
    sums.texels[0] += vec4(value.rgb * value.a, value.a);
#else
    for (uint i = 0u; i < VOXEL_FACES; i++) {
        float depth = value.a * max(dot(normal, face_direction(i)), 0.0);
        sums.texels[i] += vec4(value.rgb * depth, depth);
    }
#endif
}

void store_faces(face_sums sums, uint level, uint slot)
{
    ivec3 address = slot_address(level, slot);
    for (uint i = 0u; i < uint(VOXEL_DIRECTIONS); i++) {
        float excess = max(sums.texels[i].a / float(VOXEL_MAX_DEPTH), 1.0);
        store_voxel_face(level, address, i, sums.texels[i] / excess);
    }
}
