#include "renderer/scene/placement.h"

#include <math.h>
#include <string.h>

void placement_matrix(const float translation[3], const float rotation[4], const float scale[3],
                      mat4 out_matrix)
{
    versor quaternion = {rotation[0], rotation[1], rotation[2], rotation[3]};
    float norm = glm_quat_norm(quaternion);
    if (norm > 0.0f && isfinite(norm))
        glm_vec4_divs(quaternion, norm, quaternion);
    else
        glm_quat_identity(quaternion);
    glm_quat_mat4(quaternion, out_matrix);
    for (int axis = 0; axis < 3; axis++) {
        glm_vec3_scale(out_matrix[axis], scale[axis], out_matrix[axis]);
        out_matrix[3][axis] = translation[axis];
    }
}

void placement_normalize_or(const float vector[3], const float fallback[3], float out_vector[3])
{
    double length = sqrt((double)vector[0] * vector[0] + (double)vector[1] * vector[1] +
                         (double)vector[2] * vector[2]);
    if (!(length > 1e-30) || !isfinite(length)) {
        memcpy(out_vector, fallback, 3 * sizeof(float));
        return;
    }
    for (int axis = 0; axis < 3; axis++)
        out_vector[axis] = (float)(vector[axis] / length);
}

void placement_look_rotation(const float direction[3], const float up[3], float out_rotation[4])
{
    vec3 forward, upward, right;
    placement_normalize_or(direction, (float[3]){0.0f, 0.0f, -1.0f}, forward);
    placement_normalize_or(up, (float[3]){0.0f, 1.0f, 0.0f}, upward);
    glm_vec3_cross(forward, upward, right);
    if (glm_vec3_norm(right) < 1e-5f) {
        vec3 other = {0.0f, 0.0f, 1.0f};
        if (fabsf(forward[2]) > 0.9f)
            other[0] = 1.0f, other[2] = 0.0f;
        glm_vec3_cross(forward, other, right);
    }
    glm_vec3_normalize(right);
    glm_vec3_cross(right, forward, upward);

    mat3 basis;
    glm_vec3_copy(right, basis[0]);
    glm_vec3_copy(upward, basis[1]);
    glm_vec3_negate_to(forward, basis[2]);
    versor quaternion;
    glm_mat3_quat(basis, quaternion);
    memcpy(out_rotation, quaternion, sizeof(versor));
}

void placement_transform_box(const float matrix[16], const float box_min[3], const float box_max[3],
                             double out_min[3], double out_max[3])
{
    for (int row = 0; row < 3; row++) {
        out_min[row] = matrix[12 + row];
        out_max[row] = matrix[12 + row];
        for (int column = 0; column < 3; column++) {
            double a = (double)matrix[column * 4 + row] * box_min[column];
            double b = (double)matrix[column * 4 + row] * box_max[column];
            out_min[row] += fmin(a, b);
            out_max[row] += fmax(a, b);
        }
    }
}
