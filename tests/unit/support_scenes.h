// Helpers for tests over scene files.
#ifndef VOXCAST_TESTS_UNIT_SUPPORT_SCENES_H
#define VOXCAST_TESTS_UNIT_SUPPORT_SCENES_H

#include "renderer/scene/scene.h"

// The path of `name` in the folder of test scenes (VOXCAST_SCENES), in a static buffer; NULL, with
// a line printed that the check is skipped and why, where the folder or the file is absent.
const char *support_scene_path(const char *name);

// Checks, by cmocka's assertions, what holds for every imported scene: indices and references in
// range, all values finite, unit normals and tangents, parents before children.
void support_check_scene(const struct scene *scene);

// Of all triangle corners, how many have the tangent that triangle_mesh_make_tangents() gives from
// texture coordinate set 0, within 26 degrees and with the same handedness.
uint32_t support_count_agreeing_tangents(const struct scene *scene);

#endif
