// Small pieces of placement arithmetic: quaternions x, y, z, w; column-major matrices.
#ifndef VOXCAST_RENDERER_SCENE_PLACEMENT_H
#define VOXCAST_RENDERER_SCENE_PLACEMENT_H

#include <cglm/cglm.h>

// Translation * rotation * scale. A zero quaternion counts as no rotation.
void placement_matrix(const float translation[3], const float rotation[4], const float scale[3],
                      mat4 out_matrix);

// The unit vector along `vector`, or `fallback` where its length is 0 or not finite.
void placement_normalize_or(const float vector[3], const float fallback[3], float out_vector[3]);

// The rotation that turns -Z to `direction` and +Y as near to `up` as can be. Copes with a zero
// direction (no turn) and with `up` parallel to it.
void placement_look_rotation(const float direction[3], const float up[3], float out_rotation[4]);

// The axis-aligned box around a transformed box.
void placement_transform_box(const float matrix[16], const float box_min[3], const float box_max[3],
                             double out_min[3], double out_max[3]);

#endif
