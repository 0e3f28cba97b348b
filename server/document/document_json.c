#include "server/document/document_json.h"

#include <stdlib.h>

#include "server/document/thumbnail.h"

static const char *const texture_slot_names[SCENE_TEXTURE_SLOT_COUNT] = {
    "base_color", "metallic_roughness", "normal",   "occlusion",
    "emissive",   "transmission",       "specular", "specular_color",
};

static void add_id(cJSON *object, const char *name, uint32_t id)
{
    if (id == SCENE_NONE)
        cJSON_AddNullToObject(object, name);
    else
        cJSON_AddNumberToObject(object, name, id);
}

static void add_vector(cJSON *object, const char *name, const float *vector, int count)
{
    cJSON_AddItemToObject(object, name, cJSON_CreateFloatArray(vector, count));
}

void document_json_add_group(cJSON *object, const struct document *document,
                             enum parameter_group group, uint32_t id)
{
    for (size_t i = 0; i < parameter_count(); i++) {
        const struct parameter *parameter = parameter_at(i);
        if (parameter->group != group)
            continue;
        struct parameter_value value;
        document_get(document, parameter, id, &value);
        cJSON_AddItemToObjectCS(object, parameter->name, parameter_value_to_json(&value));
    }
}

cJSON *document_json_group(const struct document *document, enum parameter_group group, uint32_t id)
{
    cJSON *object = cJSON_CreateObject();
    document_json_add_group(object, document, group, id);
    return object;
}

cJSON *document_json_values(const struct parameter_value *values, uint32_t value_count)
{
    cJSON *object = cJSON_CreateObject();
    for (uint32_t i = 0; i < value_count; i++)
        cJSON_AddItemToObjectCS(object, values[i].parameter->name,
                                parameter_value_to_json(&values[i]));
    return object;
}

cJSON *document_json_light(const struct document *document, uint32_t id)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddNumberToObject(object, "id", id);
    add_id(object, "node", document->scene->lights[id].node);
    document_json_add_group(object, document, GROUP_LIGHT, id);
    return object;
}

cJSON *document_json_node(const struct document *document, uint32_t id)
{
    const struct scene_node *node = &document->scene->nodes[id];
    cJSON *object = cJSON_CreateObject();
    cJSON_AddNumberToObject(object, "id", id);
    add_id(object, "parent", node->parent);
    add_id(object, "mesh", node->mesh);
    add_id(object, "light", node->light);
    add_id(object, "camera", node->camera);
    document_json_add_group(object, document, GROUP_NODE, id);
    return object;
}

static cJSON *mesh_to_json(const struct scene *scene, uint32_t id)
{
    const struct scene_mesh *mesh = &scene->meshes[id];
    cJSON *object = cJSON_CreateObject();
    cJSON_AddNumberToObject(object, "id", id);
    cJSON_AddStringToObject(object, "name", mesh->name);
    cJSON *primitives = cJSON_AddArrayToObject(object, "primitives");
    for (uint32_t i = 0; i < mesh->primitive_count; i++) {
        const struct scene_primitive *primitive = &scene->primitives[mesh->primitive_first + i];
        uint32_t triangle_count = primitive->index_count / 3;
        cJSON *item = cJSON_CreateObject();
        cJSON_AddNumberToObject(item, "id", mesh->primitive_first + i);
        cJSON_AddNumberToObject(item, "material", primitive->material);
        cJSON_AddNumberToObject(item, "triangles", triangle_count);
        cJSON_AddItemToArray(primitives, item);
    }
    return object;
}

static cJSON *material_to_json(const struct document *document, uint32_t id)
{
    const struct scene *scene = document->scene;
    cJSON *object = cJSON_CreateObject();
    cJSON_AddNumberToObject(object, "id", id);
    document_json_add_group(object, document, GROUP_MATERIAL, id);
    cJSON *textures = cJSON_AddObjectToObject(object, "textures");
    for (int slot = 0; slot < SCENE_TEXTURE_SLOT_COUNT; slot++) {
        const struct scene_texture *texture = &scene->materials[id].textures[slot];
        if (texture->image == SCENE_NONE)
            continue;
        cJSON *item = cJSON_AddObjectToObject(textures, texture_slot_names[slot]);
        cJSON_AddNumberToObject(item, "image", texture->image);
        cJSON_AddNumberToObject(item, "width", scene->images[texture->image]->width);
        cJSON_AddNumberToObject(item, "height", scene->images[texture->image]->height);
        cJSON_AddNumberToObject(item, "uv_set", texture->uv_set);
    }
    return object;
}

static cJSON *camera_to_json(const struct scene *scene, uint32_t id)
{
    float eye[3], target[3], up[3];
    scene_get_camera_placement(scene, id, eye, target, up);
    cJSON *object = cJSON_CreateObject();
    cJSON_AddNumberToObject(object, "id", id);
    add_id(object, "node", scene->cameras[id].node);
    cJSON_AddStringToObject(object, "name", scene->cameras[id].name);
    add_vector(object, "eye", eye, 3);
    add_vector(object, "target", target, 3);
    add_vector(object, "up", up, 3);
    cJSON_AddNumberToObject(object, "fov_y_rad", scene->cameras[id].fov_y_rad);
    return object;
}

static cJSON *animation_to_json(const struct document *document, uint32_t id)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddNumberToObject(object, "id", id);
    cJSON_AddStringToObject(object, "name", document->scene->animations[id].name);
    cJSON_AddNumberToObject(object, "duration_s", document->scene->animations[id].duration_s);
    document_json_add_group(object, document, GROUP_ANIMATION, id);
    return object;
}

static void add_lists(cJSON *object, const struct document *document)
{
    const struct scene *scene = document->scene;
    cJSON *list = cJSON_AddArrayToObject(object, "nodes");
    for (uint32_t i = 0; i < scene->node_count; i++) {
        if (!scene->nodes[i].removed)
            cJSON_AddItemToArray(list, document_json_node(document, i));
    }
    list = cJSON_AddArrayToObject(object, "meshes");
    for (uint32_t i = 0; i < scene->mesh_count; i++)
        cJSON_AddItemToArray(list, mesh_to_json(scene, i));
    list = cJSON_AddArrayToObject(object, "materials");
    for (uint32_t i = 0; i < scene->material_count; i++)
        cJSON_AddItemToArray(list, material_to_json(document, i));
    list = cJSON_AddArrayToObject(object, "lights");
    for (uint32_t i = 0; i < scene->light_count; i++) {
        if (!scene->lights[i].removed)
            cJSON_AddItemToArray(list, document_json_light(document, i));
    }
    list = cJSON_AddArrayToObject(object, "cameras");
    for (uint32_t i = 0; i < scene->camera_count; i++)
        cJSON_AddItemToArray(list, camera_to_json(scene, i));
    list = cJSON_AddArrayToObject(object, "animations");
    for (uint32_t i = 0; i < scene->animation_count; i++)
        cJSON_AddItemToArray(list, animation_to_json(document, i));
}

static void add_bounds(cJSON *object, const struct scene *scene)
{
    double low[3], high[3];
    if (!scene_bounds(scene, low, high)) {
        cJSON_AddNullToObject(object, "bounds");
        return;
    }
    cJSON *bounds = cJSON_AddObjectToObject(object, "bounds");
    cJSON_AddItemToObject(bounds, "min", cJSON_CreateDoubleArray(low, 3));
    cJSON_AddItemToObject(bounds, "max", cJSON_CreateDoubleArray(high, 3));
}

static void add_counts(cJSON *object, const struct scene *scene)
{
    uint32_t nodes = 0, lights = 0;
    for (uint32_t i = 0; i < scene->node_count; i++)
        nodes += !scene->nodes[i].removed;
    for (uint32_t i = 0; i < scene->light_count; i++)
        lights += !scene->lights[i].removed;
    cJSON *counts = cJSON_AddObjectToObject(object, "counts");
    cJSON_AddNumberToObject(counts, "nodes", nodes);
    cJSON_AddNumberToObject(counts, "meshes", scene->mesh_count);
    cJSON_AddNumberToObject(counts, "primitives", scene->primitive_count);
    cJSON_AddNumberToObject(counts, "materials", scene->material_count);
    cJSON_AddNumberToObject(counts, "images", scene->image_count);
    cJSON_AddNumberToObject(counts, "lights", lights);
    cJSON_AddNumberToObject(counts, "cameras", scene->camera_count);
    cJSON_AddNumberToObject(counts, "animations", scene->animation_count);
    cJSON_AddNumberToObject(counts, "vertices", scene->vertex_count);
    cJSON_AddNumberToObject(counts, "triangles", (double)scene_triangle_count(scene));
}

cJSON *document_json_scene(const struct document *document)
{
    const struct scene *scene = document->scene;
    cJSON *object = cJSON_CreateObject();
    cJSON_AddStringToObject(object, "name", scene->name);
    cJSON_AddStringToObject(object, "source", scene->source_path ? scene->source_path : "");
    add_lists(object, document);
    cJSON *environment = document_json_group(document, GROUP_ENVIRONMENT, 0);
    const struct environment_image *image = scene->environment.image;
    cJSON_AddBoolToObject(environment, "has_picture", image != NULL);
    cJSON_AddItemToObject(environment, "image",
                          image ? cJSON_CreateString(image->name) : cJSON_CreateNull());
    cJSON_AddItemToObject(object, "environment", environment);
    cJSON_AddItemToObject(object, "settings", document_json_group(document, GROUP_SETTINGS, 0));
    add_bounds(object, scene);
    add_counts(object, scene);
    cJSON *warnings = cJSON_AddArrayToObject(object, "warnings");
    for (uint32_t i = 0; i < scene->warning_count; i++)
        cJSON_AddItemToArray(warnings, cJSON_CreateString(scene->warnings[i]));
    return object;
}

cJSON *document_json_texture(const struct scene *scene, uint32_t image_id)
{
    struct image *image = scene->images[image_id];
    struct thumbnail thumbnail;
    if (!thumbnail_create(image, &thumbnail))
        return NULL;
    cJSON *object = cJSON_CreateObject();
    cJSON_AddNumberToObject(object, "image", image_id);
    cJSON_AddNumberToObject(object, "width", image->width);
    cJSON_AddNumberToObject(object, "height", image->height);
    cJSON *small = cJSON_AddObjectToObject(object, "thumbnail");
    cJSON_AddNumberToObject(small, "width", thumbnail.width);
    cJSON_AddNumberToObject(small, "height", thumbnail.height);
    cJSON_AddStringToObject(small, "jpeg", thumbnail.base64);
    thumbnail_finish(&thumbnail);
    return object;
}
