// A scene, a renderer that shows it, and a frame of it.
#ifndef VOXCAST_SERVER_ACCURACY_SHOT_H
#define VOXCAST_SERVER_ACCURACY_SHOT_H

#include "renderer/renderer.h"

struct shot {
    struct scene *scene;
    struct renderer *renderer;
    struct frame_params params; // with FRAME_OUTPUT_YCBCR; the caller may set another output
};

void shot_close(struct shot *shot);

// The default view of a scene: its first camera, else one that frames the bounds from the front and
// slightly above.
void shot_default_camera(const struct scene *scene, float aspect, struct view_camera *out_camera);

#endif
