#include "server/tool/stability/scene_check.h"

#include <math.h>
#include <stddef.h>

static bool are_finite(const float *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(values[i]))
            return false;
    return true;
}

static bool is_unit(const float vector[3])
{
    double squared = (double)vector[0] * vector[0] + (double)vector[1] * vector[1] +
                     (double)vector[2] * vector[2];
    return fabs(squared - 1.0) < 1e-3;
}

static const char *check_vertices(const struct scene *scene)
{
    for (uint32_t i = 0; i < scene->vertex_count; i++) {
        const struct scene_vertex *vertex = &scene->vertices[i];
        if (!are_finite((const float *)vertex, sizeof(*vertex) / sizeof(float)))
            return "a vertex is not finite";
        if (!is_unit(vertex->normal) || !is_unit(vertex->tangent) ||
            fabsf(vertex->tangent[3]) != 1.0f)
            return "a vertex has a direction that is not unit length";
    }
    for (uint32_t i = 0; i < scene->index_count; i++)
        if (scene->indices[i] >= scene->vertex_count)
            return "an index is beyond the vertices";
    return NULL;
}

static const char *check_primitives(const struct scene *scene)
{
    for (uint32_t i = 0; i < scene->primitive_count; i++) {
        const struct scene_primitive *primitive = &scene->primitives[i];
        if (primitive->material >= scene->material_count || primitive->mesh >= scene->mesh_count)
            return "a primitive's material or mesh is not there";
        if (primitive->index_count == 0 || primitive->index_count % 3 != 0 ||
            primitive->index_first + primitive->index_count > scene->index_count)
            return "a primitive's indices are not there";
    }
    return NULL;
}

static const char *check_nodes(const struct scene *scene)
{
    for (uint32_t i = 0; i < scene->node_count; i++) {
        const struct scene_node *node = &scene->nodes[i];
        if (node->parent != SCENE_NONE && node->parent >= i)
            return "a node comes before its parent";
        if ((node->mesh != SCENE_NONE && node->mesh >= scene->mesh_count) ||
            (node->light != SCENE_NONE && scene->lights[node->light].node != i) ||
            (node->camera != SCENE_NONE && scene->cameras[node->camera].node != i))
            return "a node holds what is not there";
        if (!are_finite(node->translation, 3) || !are_finite(node->scale, 3) ||
            !are_finite(node->rotation, 4) || !are_finite(node->world_from_local, 16))
            return "a node's placement is not finite";
    }
    for (uint32_t i = 0; i < scene->light_count; i++) {
        const struct scene_light *light = &scene->lights[i];
        if (light->node >= scene->node_count)
            return "a light's node is not there";
        if (!isfinite(light->intensity) || light->intensity < 0.0f || !are_finite(light->color, 3))
            return "a light's intensity is not finite or negative";
    }
    for (uint32_t i = 0; i < scene->camera_count; i++)
        if (!(scene->cameras[i].fov_y_rad > 0.0f && scene->cameras[i].fov_y_rad < 3.1416f))
            return "a camera's field of view is out of range";
    return NULL;
}

static const char *check_materials(const struct scene *scene)
{
    for (uint32_t i = 0; i < scene->material_count; i++) {
        const struct scene_material *material = &scene->materials[i];
        for (int slot = 0; slot < SCENE_TEXTURE_SLOT_COUNT; slot++) {
            const struct scene_texture *texture = &material->textures[slot];
            if ((texture->image != SCENE_NONE && texture->image >= scene->image_count) ||
                texture->uv_set > 1)
                return "a texture's image is not there";
        }
        if (!isfinite(material->emissive_strength) || !are_finite(material->base_color, 4) ||
            !(material->roughness >= 0.0f && material->roughness <= 1.0f) ||
            !(material->metallic >= 0.0f && material->metallic <= 1.0f))
            return "a material is out of range";
    }
    return scene->material_count > 0 ? NULL : "there is no material";
}

const char *scene_check(const struct scene *scene)
{
    const char *(*const checks[])(const struct scene *) = {check_vertices, check_primitives,
                                                           check_nodes, check_materials};
    const char *wrong = NULL;
    for (size_t i = 0; i < sizeof(checks) / sizeof(checks[0]) && !wrong; i++)
        wrong = checks[i](scene);
    return wrong;
}
