// Requests voxel faces of the irradiance cache.
#define FACES_STORED
#include "lib/cache_lookup.glsl"

// Requests the faces that cached_irradiance() reads.
void request_faces(vec3 world, vec3 normal, uint frame_number)
{
    vec3 position = world - voxels.anchor;
    float room;
    uint level = cache_level(position, room);
    if (level >= voxels.cell_level_count)
        return;
    uint end = min(level + (room < 4.0 ? 2u : 1u), voxels.cell_level_count);
    do {
        vec3 at = position * voxels.levels[level].inverse_voxel_edge - 0.5;
        ivec3 low = ivec3(floor(at));
        int j = 0;
        do {
            uint cell = find_cell(level, low + ivec3(j & 1, (j >> 1) & 1, j >> 2));
            if (cell == VOXEL_NONE)
                continue;
            for (uint axis = 0u; axis < 3u; axis++) {
                float along = axis == 0u ? normal.x : axis == 1u ? normal.y : normal.z;
                uint words = cell_face(cell, 2u * axis + (along < 0.0 ? 1u : 0u));
                if (words != VOXEL_NONE && along * along > MIN_WEIGHT)
                    faces[words + FACE_REQUEST] = frame_number;
            }
        } while (++j < 8);
    } while (++level < end);
}
