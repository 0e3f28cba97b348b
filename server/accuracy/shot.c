#include "server/accuracy/shot.h"

#include <math.h>

#define FRAMING_FOV_RAD 0.8f

void shot_close(struct shot *shot)
{
    if (shot->renderer)
        renderer_destroy(&shot->renderer);
    scene_destroy(&shot->scene);
}

void shot_default_camera(const struct scene *scene, float aspect, struct view_camera *out_camera)
{
    *out_camera = (struct view_camera){.up = {0.0f, 1.0f, 0.0f}, .fov_y_rad = FRAMING_FOV_RAD};
    if (scene->camera_count > 0) {
        scene_get_camera_placement(scene, 0, out_camera->eye, out_camera->target, out_camera->up);
        out_camera->fov_y_rad = scene->cameras[0].fov_y_rad;
        return;
    }
    double low[3], high[3];
    if (!scene_bounds(scene, low, high)) {
        out_camera->eye[2] = 1.0f;
        return;
    }
    double radius = 0.0;
    for (int axis = 0; axis < 3; axis++)
        radius += (high[axis] - low[axis]) * (high[axis] - low[axis]) / 4.0;
    radius = fmax(sqrt(radius), 1e-6);
    double half_fov = 0.5 * FRAMING_FOV_RAD;
    if (aspect < 1.0f)
        half_fov = atan(tan(half_fov) * aspect);
    double distance = 1.05 * radius / sin(half_fov);
    static const double direction[3] = {0.32, 0.28, 0.905};
    for (int axis = 0; axis < 3; axis++) {
        double center = 0.5 * (low[axis] + high[axis]);
        out_camera->target[axis] = (float)center;
        out_camera->eye[axis] = (float)(center + distance * direction[axis]);
    }
}
