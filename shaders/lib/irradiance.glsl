// Asks for voxel faces of the irradiance cache.
#include "lib/irradiance_read.glsl"

// Asks for the faces that cached_irradiance() reads.
void request_faces(vec3 world, vec3 normal, uint frame_number)
{
    vec3 position = world - voxels.anchor.xyz;
    float room;
    uint level = cache_level(position, room);
    for (uint i = 0u; i < 2u && level + i < voxels.counts.x; i++) {
        if (voxels.levels[level].index.z == 0u && i > 0u)
            return;
        vec3 at = position * voxels.levels[level + i].size.y - 0.5;
        ivec3 low = ivec3(floor(at));
        uint face = dominant_face(normal);
        for (int j = 0; j < 8; j++) {
            uint cell = find_cell(level + i, low + ivec3(j & 1, (j >> 1) & 1, j >> 2));
            if (cell != VOXEL_NONE)
                cells[cell_face(cell, face) + CELL_FACE_REQUEST] = frame_number;
        }
        if (room >= 4.0)
            return;
    }
}
