#include "support_scenes.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "renderer/scene/triangle_mesh.h"

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

static void check_unit(const float vector[3])
{
    double square = (double)vector[0] * vector[0] + (double)vector[1] * vector[1] +
                    (double)vector[2] * vector[2];
    assert_true(fabs(square - 1) < 1e-3);
}

static void check_vertices(const struct scene *scene)
{
    for (uint32_t i = 0; i < scene->vertex_count; i++) {
        const struct scene_vertex *vertex = &scene->vertices[i];
        const float *values = (const float *)vertex;
        for (size_t value = 0; value < sizeof(*vertex) / sizeof(float); value++) {
            assert_true(isfinite(values[value]));
        }
        check_unit(vertex->normal);
        check_unit(vertex->tangent);
        assert_true(fabsf(vertex->tangent[3]) == 1);
    }
    for (uint32_t i = 0; i < scene->primitive_count; i++) {
        const struct scene_primitive *primitive = &scene->primitives[i];
        assert_true(primitive->material < scene->material_count);
        assert_true(primitive->mesh < scene->mesh_count);
        assert_true(primitive->index_count > 0 && primitive->index_count % 3 == 0);
        assert_true(primitive->index_first + primitive->index_count <= scene->index_count);
    }
    for (uint32_t i = 0; i < scene->index_count; i++) {
        assert_true(scene->indices[i] < scene->vertex_count);
    }
}

static void check_nodes(const struct scene *scene)
{
    for (uint32_t i = 0; i < scene->node_count; i++) {
        const struct scene_node *node = &scene->nodes[i];
        assert_true(node->parent == SCENE_NONE || node->parent < i);
        assert_true(node->mesh == SCENE_NONE || node->mesh < scene->mesh_count);
        assert_true(node->light == SCENE_NONE || scene->lights[node->light].node == i);
        assert_true(node->camera == SCENE_NONE || scene->cameras[node->camera].node == i);
        for (int axis = 0; axis < 3; axis++) {
            assert_true(isfinite(node->translation[axis]) && isfinite(node->scale[axis]));
        }
        for (int part = 0; part < 4; part++) {
            assert_true(isfinite(node->rotation[part]));
        }
    }
    for (uint32_t i = 0; i < scene->light_count; i++) {
        const struct scene_light *light = &scene->lights[i];
        assert_true(light->node < scene->node_count);
        assert_true(isfinite(light->intensity) && light->intensity >= 0);
        assert_true(light->inner_cone_rad <= light->outer_cone_rad);
    }
    for (uint32_t i = 0; i < scene->camera_count; i++) {
        assert_true(scene->cameras[i].fov_y_rad > 0 && scene->cameras[i].fov_y_rad < 3.1416f);
    }
}

void support_check_scene(const struct scene *scene)
{
    assert_true(scene->material_count > 0);
    check_vertices(scene);
    check_nodes(scene);
    for (uint32_t i = 0; i < scene->material_count; i++) {
        const struct scene_material *material = &scene->materials[i];
        for (int slot = 0; slot < SCENE_TEXTURE_SLOT_COUNT; slot++) {
            const struct scene_texture *texture = &material->textures[slot];
            assert_true(texture->image == SCENE_NONE || texture->image < scene->image_count);
            assert_true(texture->uv_set < 2);
        }
        assert_true(isfinite(material->emissive_strength));
        assert_true(material->roughness >= 0 && material->roughness <= 1);
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
