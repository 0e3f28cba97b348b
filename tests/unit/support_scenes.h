// Helpers for tests over scene files.
#ifndef VOXCAST_TESTS_UNIT_SUPPORT_SCENES_H
#define VOXCAST_TESTS_UNIT_SUPPORT_SCENES_H

#include "renderer/scene/scene.h"

// The path of `name` in the folder of test scenes (VOXCAST_SCENES), in a static buffer. NULL where
// the folder or the file is absent; a printed line then says that the check is skipped and why.
const char *support_scene_path(const char *name);

// Checks, with cmocka's assertions, what holds for every imported scene: indices and references in
// range, all values finite, unit normals and tangents, parents before children.
void support_check_scene(const struct scene *scene);

// The fraction of triangle corners whose tangent agrees with triangle_mesh_make_tangents() for
// texture coordinate set 0: within 26 degrees and with the same handedness.
uint32_t support_count_agreeing_tangents(const struct scene *scene);

#endif
