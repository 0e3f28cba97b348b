// Camera to rays and to clip space.
#ifndef VOXCAST_RENDERER_CAMERA_H
#define VOXCAST_RENDERER_CAMERA_H

#include <cglm/cglm.h>

#include "renderer/settings.h"

#define CAMERA_MIN_FOV_RAD 0.001f
#define CAMERA_MAX_FOV_RAD 3.13f

// Orthonormal axes and the half-height of the image plane at distance 1.
struct camera_frame {
    vec3 right, up, forward;
    float tan_half_fov;
};

// Handles eye == target (looks along -Z) and an up vector parallel to the view direction.
void camera_frame_init(struct camera_frame *frame, const struct view_camera *camera);

// Reversed Z, infinite far plane: depth = near / distance along forward.
void camera_clip_from_world(const struct camera_frame *frame, const float eye[3], float aspect,
                            float near_m, mat4 out_matrix);

// Direction through a point of the image (pixels, from the top left corner); its forward component
// is 1.
void camera_ray(const struct camera_frame *frame, uint32_t width, uint32_t height, float x, float y,
                float out_direction[3]);

#endif
