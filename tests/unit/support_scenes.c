#include "support_scenes.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "renderer/scene/triangle_mesh.h"
#include "server/tool/stability/scene_check.h"

const char *support_scene_path(const char *name)
{
    static char path[4096];
    const char *folder = getenv("VOXCAST_SCENES");
    if (!folder || !folder[0]) {
        printf("skipped: %s (VOXCAST_SCENES names no folder of test scenes)\n", name);
        return NULL;
    }
    snprintf(path, sizeof(path), "%s/%s", folder, name);
    if (access(path, R_OK) != 0) {
        printf("skipped: %s (not in the folder of test scenes)\n", path);
        return NULL;
    }
    return path;
}

void support_check_scene(const struct scene *scene)
{
    const char *wrong = scene_check(scene);
    if (wrong) {
        fail_msg("%s", wrong);
    }
    // Holds for files; edits may make the inner cone larger than the outer one, and then both count
    // as one.
    for (uint32_t i = 0; i < scene->light_count; i++) {
        assert_true(scene->lights[i].inner_cone_rad <= scene->lights[i].outer_cone_rad);
    }
}

uint32_t support_count_agreeing_tangents(const struct scene *scene)
{
    uint32_t agreeing = 0;
    for (uint32_t i = 0; i < scene->primitive_count; i++) {
        const struct scene_primitive *primitive = &scene->primitives[i];
        struct triangle_mesh made = {
            .vertices = malloc(primitive->vertex_count * sizeof(struct scene_vertex)),
            .vertex_count = primitive->vertex_count,
            .indices = malloc(primitive->index_count * sizeof(uint32_t)),
            .index_count = primitive->index_count,
        };
        assert_non_null(made.vertices);
        assert_non_null(made.indices);
        memcpy(made.vertices, scene->vertices + primitive->vertex_first,
               made.vertex_count * sizeof(struct scene_vertex));
        const uint32_t *stored = scene->indices + primitive->index_first;
        for (uint32_t corner = 0; corner < made.index_count; corner++) {
            made.indices[corner] = stored[corner] - primitive->vertex_first;
        }
        assert_true(triangle_mesh_make_tangents(&made, 0));
        for (uint32_t corner = 0; corner < made.index_count; corner++) {
            const float *a = scene->vertices[stored[corner]].tangent;
            const float *b = made.vertices[made.indices[corner]].tangent;
            agreeing += a[0] * b[0] + a[1] * b[1] + a[2] * b[2] > 0.9f && a[3] == b[3];
        }
        triangle_mesh_finish(&made);
    }
    return agreeing;
}
