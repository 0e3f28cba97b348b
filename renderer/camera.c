#include "renderer/camera.h"

#include <math.h>

#include "renderer/scene/placement.h"

void camera_frame_init(struct camera_frame *frame, const struct view_camera *camera)
{
    vec3 direction;
    versor rotation;
    mat4 matrix;
    glm_vec3_sub((float *)camera->target, (float *)camera->eye, direction);
    placement_look_rotation(direction, camera->up, rotation);
    glm_quat_mat4(rotation, matrix);
    glm_vec3_copy(matrix[0], frame->right);
    glm_vec3_copy(matrix[1], frame->up);
    glm_vec3_negate_to(matrix[2], frame->forward);
    float fov = fminf(fmaxf(camera->fov_y_rad, CAMERA_MIN_FOV_RAD), CAMERA_MAX_FOV_RAD);
    frame->tan_half_fov = tanf(0.5f * fov);
}

void camera_clip_from_world(const struct camera_frame *frame, const float eye[3], float aspect,
                            float near_m, mat4 out_matrix)
{
    const float *axes[2] = {frame->right, frame->up};
    float scales[2] = {1.0f / (frame->tan_half_fov * aspect), 1.0f / frame->tan_half_fov};
    glm_mat4_zero(out_matrix);
    for (int column = 0; column < 3; column++) {
        for (int row = 0; row < 2; row++)
            out_matrix[column][row] = axes[row][column] * scales[row];
        out_matrix[column][3] = frame->forward[column];
    }
    for (int row = 0; row < 2; row++)
        out_matrix[3][row] = -glm_vec3_dot((float *)axes[row], (float *)eye) * scales[row];
    out_matrix[3][3] = -glm_vec3_dot((float *)frame->forward, (float *)eye);
    out_matrix[3][2] = near_m;
}

void camera_ray(const struct camera_frame *frame, uint32_t width, uint32_t height, float x, float y,
                float out_direction[3])
{
    float aspect = (float)width / (float)height;
    float right = (2.0f * x / (float)width - 1.0f) * frame->tan_half_fov * aspect;
    float up = (1.0f - 2.0f * y / (float)height) * frame->tan_half_fov;
    for (int axis = 0; axis < 3; axis++)
        out_direction[axis] =
            frame->forward[axis] + right * frame->right[axis] + up * frame->up[axis];
}
