#include "renderer/import/builtin/builtin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/scene/placement.h"
#include "renderer/import/scene_load.h"

static const struct builtin_scene {
    const char *name;
    const char *description;
    bool (*build)(struct scene *scene);
} builtin_scenes[] = {
    {"cornell", "the Cornell box by its published measurements, lit by its ceiling light",
     builtin_build_cornell},
    {"cornell-objects", "metal, glass, lacquer and roughness in the Cornell box",
     builtin_build_cornell_objects},
    {"cornell-objects-diffuse", "the same objects, all matt",
     builtin_build_cornell_objects_diffuse},
    {"cornell-objects-glossy", "the same objects, all lacquered",
     builtin_build_cornell_objects_glossy},
    {"cornell-objects-glass", "the same objects, all of clear glass",
     builtin_build_cornell_objects_glass},
    {"cornell-objects-emissive", "the same objects, which alone shine",
     builtin_build_cornell_objects_emissive},
    {"atrium", "a palace court in the sun: arcades, curtains, plants", builtin_build_atrium},
    {"atrium-lights", "the same at dusk with 256 lanterns", builtin_build_atrium_lights},
    {"furnace", "a white furnace: everything must look the same", builtin_build_furnace},
    {"material-grid", "spheres by roughness, metalness and colour", builtin_build_material_grid},
};

#define BUILTIN_COUNT (sizeof(builtin_scenes) / sizeof(builtin_scenes[0]))

const char *scene_builtin_name(uint32_t index)
{
    return index < BUILTIN_COUNT ? builtin_scenes[index].name : NULL;
}

const char *scene_builtin_description(uint32_t index)
{
    return index < BUILTIN_COUNT ? builtin_scenes[index].description : NULL;
}

struct scene *scene_create_builtin(const char *name, struct error *out_error)
{
    char known[256] = "";
    for (size_t i = 0; i < BUILTIN_COUNT; i++) {
        const struct builtin_scene *builtin = &builtin_scenes[i];
        if (strcmp(builtin->name, name) != 0) {
            strncat(known, i ? ", " : "", sizeof(known) - strlen(known) - 1);
            strncat(known, builtin->name, sizeof(known) - strlen(known) - 1);
            continue;
        }
        struct scene *scene = scene_create(name);
        if (scene && builtin->build(scene) &&
            asprintf(&scene->source_path, "builtin:%s", name) > 0) {
            scene_update_world_transforms(scene);
            return scene;
        }
        scene_destroy(&scene);
        error_set(out_error, "out of memory while building builtin:%s", name);
        return NULL;
    }
    error_set(out_error, "there is no built-in scene \"%s\"; built in are %s", name, known);
    return NULL;
}

uint32_t builtin_add_matte(struct scene *scene, const char *name, const float reflectance[3])
{
    struct scene_material material;
    scene_material_init(&material, name);
    memcpy(material.base_color, reflectance, 3 * sizeof(float));
    material.metallic = 0.0f;
    material.ior = 1.0f;
    return scene_add_material(scene, &material);
}

bool builtin_add_quad(struct scene *scene, const float corners[4][3], uint32_t material)
{
    vec3 u, v, normal, tangent;
    glm_vec3_sub((float *)corners[1], (float *)corners[0], u);
    glm_vec3_sub((float *)corners[3], (float *)corners[0], v);
    glm_vec3_cross(u, v, normal);
    placement_normalize_or(normal, (float[3]){0.0f, 1.0f, 0.0f}, normal);
    placement_normalize_or(u, (float[3]){1.0f, 0.0f, 0.0f}, tangent);
    struct scene_vertex vertices[4] = {0};
    for (int i = 0; i < 4; i++) {
        struct scene_vertex *vertex = &vertices[i];
        memcpy(vertex->position, corners[i], sizeof(vertex->position));
        memcpy(vertex->normal, normal, sizeof(vertex->normal));
        memcpy(vertex->tangent, tangent, sizeof(vec3));
        vertex->tangent[3] = -1.0f; // v runs down the image
        vertex->uv[0][0] = vertex->uv[1][0] = i == 1 || i == 2 ? 1.0f : 0.0f;
        vertex->uv[0][1] = vertex->uv[1][1] = i >= 2 ? 1.0f : 0.0f;
        for (int c = 0; c < 4; c++)
            vertex->color[c] = 1.0f;
    }
    static const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
    return scene_add_primitive(scene, vertices, 4, indices, 6, material) != SCENE_NONE;
}

uint32_t builtin_add_mesh_node(struct scene *scene, const char *name, uint32_t mesh)
{
    uint32_t node = scene_add_node(scene, name, SCENE_NONE);
    if (node != SCENE_NONE)
        scene->nodes[node].mesh = mesh;
    return node;
}
