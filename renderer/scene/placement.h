// Transform arithmetic: quaternions x, y, z, w; column-major matrices.
#ifndef VOXCAST_RENDERER_SCENE_PLACEMENT_H
#define VOXCAST_RENDERER_SCENE_PLACEMENT_H

#include <cglm/cglm.h>

// Translation * rotation * scale. A zero quaternion is no rotation.
void placement_matrix(const float translation[3], const float rotation[4], const float scale[3],
                      mat4 out_matrix);

// Unit vector along `vector`; `fallback` if its length is 0 or not finite.
void placement_normalize_or(const float vector[3], const float fallback[3], float out_vector[3]);

// Rotation of -Z to `direction` and of +Y as near to `up` as possible. Handles a zero direction (no
// rotation) and `up` parallel to it.
void placement_look_rotation(const float direction[3], const float up[3], float out_rotation[4]);

// Axis-aligned box around a transformed box.
void placement_transform_box(const float matrix[16], const float box_min[3], const float box_max[3],
                             double out_min[3], double out_max[3]);

#endif
