#include "renderer/scene/scene.h"

#include <assert.h>
#include <cglm/cglm.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/scene/placement.h"

// Reserves `extra` more elements; false at `limit` or when memory runs out.
static bool grow(void **items, uint32_t *capacity, uint32_t count, uint32_t extra, uint32_t limit,
                 size_t item_size)
{
    if (extra > limit || count > limit - extra)
        return false;
    uint32_t needed = count + extra;
    if (needed <= *capacity)
        return true;
    uint64_t wanted = *capacity + (uint64_t)*capacity / 2;
    if (wanted < needed)
        wanted = needed;
    if (wanted > limit)
        wanted = limit;
    void *grown = realloc(*items, wanted * item_size);
    if (!grown)
        return false;
    *items = grown;
    *capacity = (uint32_t)wanted;
    return true;
}

#define GROW(scene, field, singular, extra, limit)                                                 \
    grow((void **)&(scene)->field, &(scene)->singular##_capacity, (scene)->singular##_count,       \
         extra, limit, sizeof(*(scene)->field))

static void copy_name(char *target, size_t size, const char *name)
{
    snprintf(target, size, "%s", name ? name : "");
}

#define VECTOR(...)                                                                                \
    {                                                                                              \
        __VA_ARGS__                                                                                \
    }
#define EMPTY ""

static void environment_init(struct scene_environment *environment)
{
    *environment = (struct scene_environment){
#define PARAMETER(record, name, type, range, unit, initial, ...) .name = initial,
#include "protocol/parameters/environment.def"
#undef PARAMETER
    };
}

struct scene *scene_create(const char *name)
{
    struct scene *scene = calloc(1, sizeof(*scene));
    if (scene) {
        copy_name(scene->name, sizeof(scene->name), name);
        environment_init(&scene->environment);
    }
    return scene;
}

void scene_destroy(struct scene **scene_slot)
{
    struct scene *scene = *scene_slot;
    *scene_slot = NULL;
    if (!scene)
        return;
    for (uint32_t i = 0; i < scene->animation_count; i++) {
        struct scene_animation *animation = &scene->animations[i];
        for (uint32_t j = 0; j < animation->channel_count; j++) {
            free(animation->channels[j].times_s);
            free(animation->channels[j].values);
        }
        free(animation->channels);
    }
    for (uint32_t i = 0; i < scene->image_count; i++)
        image_release(&scene->images[i]);
    for (uint32_t i = 0; i < scene->warning_count; i++)
        free(scene->warnings[i]);
    for (uint32_t i = 0; i < scene->source_file_count; i++)
        free(scene->source_files[i]);
    free(scene->source_files);
    free(scene->source_path);
    free(scene->vertices);
    free(scene->indices);
    free(scene->primitives);
    free(scene->meshes);
    free(scene->materials);
    free(scene->images);
    free(scene->nodes);
    free(scene->lights);
    free(scene->cameras);
    free(scene->animations);
    environment_image_release(&scene->environment.image);
    free(scene);
}

void scene_material_init(struct scene_material *material, const char *name)
{
    *material = (struct scene_material){
#define PARAMETER(record, name, type, range, unit, initial, ...) .name = initial,
#include "protocol/parameters/material.def"
#undef PARAMETER
    };
    copy_name(material->name, sizeof(material->name), name);
    for (int i = 0; i < SCENE_TEXTURE_SLOT_COUNT; i++) {
        material->textures[i].image = SCENE_NONE;
        material->textures[i].scale[0] = 1.0f;
        material->textures[i].scale[1] = 1.0f;
    }
}

void scene_light_init(struct scene_light *light, enum scene_light_type type, const char *name)
{
    *light = (struct scene_light){
#define LIGHT_DEFAULT(name, ...) .name = __VA_ARGS__,
#define LIGHT_PLACEMENT_DEFAULT(name, ...)
#define PARAMETER(record, name, type, range, unit, initial, ...) record##_DEFAULT(name, initial)
#include "protocol/parameters/light.def"
#undef PARAMETER
    };
    light->type = type;
    light->node = SCENE_NONE;
    copy_name(light->name, sizeof(light->name), name);
}

uint32_t scene_add_material(struct scene *scene, const struct scene_material *material)
{
    if (!GROW(scene, materials, material, 1, SCENE_MAX_MATERIALS))
        return SCENE_NONE;
    scene->materials[scene->material_count] = *material;
    scene->revisions.materials++;
    return scene->material_count++;
}

uint32_t scene_add_image(struct scene *scene, struct image *image)
{
    if (!GROW(scene, images, image, 1, SCENE_MAX_IMAGES))
        return SCENE_NONE;
    scene->images[scene->image_count] = image_retain(image);
    scene->revisions.geometry++;
    return scene->image_count++;
}

uint32_t scene_add_mesh(struct scene *scene, const char *name)
{
    if (!GROW(scene, meshes, mesh, 1, SCENE_MAX_MESHES))
        return SCENE_NONE;
    struct scene_mesh *mesh = &scene->meshes[scene->mesh_count];
    *mesh = (struct scene_mesh){.primitive_first = scene->primitive_count};
    copy_name(mesh->name, sizeof(mesh->name), name);
    return scene->mesh_count++;
}

static void primitive_compute_bounds(const struct scene *scene, struct scene_primitive *primitive)
{
    for (int axis = 0; axis < 3; axis++) {
        primitive->bounds_min[axis] = INFINITY;
        primitive->bounds_max[axis] = -INFINITY;
    }
    for (uint32_t i = 0; i < primitive->vertex_count; i++) {
        const float *position = scene->vertices[primitive->vertex_first + i].position;
        for (int axis = 0; axis < 3; axis++) {
            primitive->bounds_min[axis] = fminf(primitive->bounds_min[axis], position[axis]);
            primitive->bounds_max[axis] = fmaxf(primitive->bounds_max[axis], position[axis]);
        }
    }
}

static bool is_somewhere(const float position[3])
{
    return fabsf(position[0]) <= SCENE_MAX_COORDINATE_M &&
           fabsf(position[1]) <= SCENE_MAX_COORDINATE_M &&
           fabsf(position[2]) <= SCENE_MAX_COORDINATE_M;
}

// Replaces values that are not finite; true if there were any.
static bool repair_values(float *values, uint32_t count, float value)
{
    bool repaired = false;
    for (uint32_t i = 0; i < count; i++)
        if (!isfinite(values[i])) {
            values[i] = value;
            repaired = true;
        }
    return repaired;
}

// One bad component invalidates a direction: the remaining ones would point elsewhere.
static bool repair_direction(float direction[3])
{
    bool repaired = repair_values(direction, 3, 0.0f);
    if (repaired)
        memset(direction, 0, 3 * sizeof(float));
    return repaired;
}

// Copies vertices. One with an invalid position gets that of `place`; no triangle keeps it.
static void copy_vertices(struct scene *scene, const struct scene_vertex *vertices,
                          uint32_t vertex_count)
{
    struct scene_vertex *target = scene->vertices + scene->vertex_count;
    static const float origin[3] = {0};
    const float *known_position = origin;
    for (uint32_t i = 0; i < vertex_count && known_position == origin; i++)
        if (is_somewhere(vertices[i].position))
            known_position = vertices[i].position;
    for (uint32_t i = 0; i < vertex_count; i++) {
        target[i] = vertices[i];
        if (!is_somewhere(target[i].position))
            memcpy(target[i].position, known_position, sizeof(target[i].position));
        bool repaired = repair_direction(target[i].normal);
        repaired = repair_direction(target[i].tangent) || repaired;
        repaired = repair_values(&target[i].tangent[3], 1, 1.0f) || repaired;
        repaired = repair_values(&target[i].uv[0][0], 4, 0.0f) || repaired;
        repaired = repair_values(target[i].color, 4, 1.0f) || repaired;
        scene->rejects.vertices += repaired;
    }
}

// Copies triangles whose corners all have valid positions. Returns the number of indices.
static uint32_t copy_triangles(struct scene *scene, const struct scene_vertex *vertices,
                               uint32_t vertex_count, const uint32_t *indices, uint32_t index_count)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < index_count; i += 3) {
        bool usable = true;
        for (uint32_t corner = i; corner < i + 3; corner++) {
            assert(indices[corner] < vertex_count);
            usable = usable && is_somewhere(vertices[indices[corner]].position);
        }
        scene->rejects.triangles += !usable;
        for (uint32_t corner = i; corner < i + 3 && usable; corner++)
            scene->indices[scene->index_count + kept++] = indices[corner] + scene->vertex_count;
    }
    return kept;
}

uint32_t scene_add_primitive(struct scene *scene, const struct scene_vertex *vertices,
                             uint32_t vertex_count, const uint32_t *indices, uint32_t index_count,
                             uint32_t material)
{
    assert(scene->mesh_count > 0);
    assert(material < scene->material_count);
    assert(index_count % 3 == 0);
    if (!GROW(scene, vertices, vertex, vertex_count, SCENE_MAX_VERTICES) ||
        !GROW(scene, indices, index, index_count, SCENE_MAX_INDICES) ||
        !GROW(scene, primitives, primitive, 1, SCENE_MAX_PRIMITIVES))
        return SCENE_NONE;

    struct scene_primitive *primitive = &scene->primitives[scene->primitive_count];
    *primitive = (struct scene_primitive){
        .mesh = scene->mesh_count - 1,
        .material = material,
        .index_first = scene->index_count,
        .vertex_first = scene->vertex_count,
        .vertex_count = vertex_count,
    };
    primitive->index_count = copy_triangles(scene, vertices, vertex_count, indices, index_count);
    if (primitive->index_count == 0)
        return SCENE_NONE;
    copy_vertices(scene, vertices, vertex_count);
    scene->vertex_count += vertex_count;
    scene->index_count += primitive->index_count;
    primitive_compute_bounds(scene, primitive);
    scene->meshes[scene->mesh_count - 1].primitive_count++;
    scene->revisions.geometry++;
    return scene->primitive_count++;
}

uint32_t scene_add_node(struct scene *scene, const char *name, uint32_t parent)
{
    assert(parent == SCENE_NONE || parent < scene->node_count);
    if (!GROW(scene, nodes, node, 1, SCENE_MAX_NODES))
        return SCENE_NONE;
    struct scene_node *node = &scene->nodes[scene->node_count];
    *node = (struct scene_node){
        .parent = parent,
        .mesh = SCENE_NONE,
        .light = SCENE_NONE,
        .camera = SCENE_NONE,
        .visible = true,
        .rotation = {0.0f, 0.0f, 0.0f, 1.0f},
        .scale = {1.0f, 1.0f, 1.0f},
    };
    copy_name(node->name, sizeof(node->name), name);
    scene->revisions.geometry++;
    return scene->node_count++;
}

// The root node of a removed light to be reused, or a new one.
static uint32_t take_root_node(struct scene *scene, uint32_t light, const char *name)
{
    uint32_t id = light < scene->light_count ? scene->lights[light].node : SCENE_NONE;
    if (id == SCENE_NONE || !scene->nodes[id].removed || scene->nodes[id].parent != SCENE_NONE)
        return scene_add_node(scene, name, SCENE_NONE);
    struct scene_node *node = &scene->nodes[id];
    node->removed = false;
    node->visible = true;
    copy_name(node->name, sizeof(node->name), name);
    scene->revisions.geometry++;
    return id;
}

// Slot in the list of lights: a new one, or a removed light's once there are many.
static uint32_t find_light_placement(const struct scene *scene)
{
    uint32_t removed = 0, first = scene->light_count;
    for (uint32_t i = scene->light_count; i-- > 0;)
        if (scene->lights[i].removed) {
            removed++;
            first = i;
        }
    bool is_full = scene->light_count == SCENE_MAX_LIGHTS;
    return removed > SCENE_KEPT_LIGHTS || (is_full && removed > 0) ? first : scene->light_count;
}

uint32_t scene_add_light(struct scene *scene, const struct scene_light *light,
                         const float position[3], const float direction[3])
{
    uint32_t id = find_light_placement(scene);
    if (id == scene->light_count && !GROW(scene, lights, light, 1, SCENE_MAX_LIGHTS))
        return SCENE_NONE;
    uint32_t node = take_root_node(scene, id, light->name);
    if (node == SCENE_NONE)
        return SCENE_NONE;
    if (id == scene->light_count)
        scene->light_count++;
    scene->lights[id] = *light;
    scene->lights[id].node = node;
    scene->lights[id].removed = false;
    scene->nodes[node].light = id;
    scene->revisions.lights++;
    scene_set_light_placement(scene, id, position, direction);
    return id;
}

uint32_t scene_add_camera(struct scene *scene, const char *name, const float eye[3],
                          const float target[3], const float up[3], float fov_y_rad)
{
    if (!GROW(scene, cameras, camera, 1, SCENE_MAX_CAMERAS))
        return SCENE_NONE;
    uint32_t node_id = scene_add_node(scene, name, SCENE_NONE);
    if (node_id == SCENE_NONE)
        return SCENE_NONE;
    struct scene_camera *camera = &scene->cameras[scene->camera_count];
    *camera = (struct scene_camera){.node = node_id, .fov_y_rad = fov_y_rad};
    copy_name(camera->name, sizeof(camera->name), name);

    struct scene_node *node = &scene->nodes[node_id];
    node->camera = scene->camera_count;
    float direction[3] = {target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]};
    memcpy(node->translation, eye, sizeof(node->translation));
    placement_look_rotation(direction, up, node->rotation);
    scene_update_world_transforms(scene);
    return scene->camera_count++;
}

void scene_add_warning(struct scene *scene, const char *format, ...)
{
    if (scene->warning_count == SCENE_MAX_WARNINGS)
        return;
    va_list arguments;
    va_start(arguments, format);
    char *text = NULL;
    if (vasprintf(&text, format, arguments) >= 0)
        scene->warnings[scene->warning_count++] = text;
    va_end(arguments);
}

bool scene_add_source_file(struct scene *scene, const char *path)
{
    for (uint32_t i = 0; i < scene->source_file_count; i++)
        if (strcmp(scene->source_files[i], path) == 0)
            return true;
    size_t count = scene->source_file_count + 1u;
    char **grown = realloc(scene->source_files, count * sizeof(*grown));
    if (!grown)
        return false;
    scene->source_files = grown;
    grown[count - 1] = strdup(path);
    if (!grown[count - 1])
        return false;
    scene->source_file_count++;
    return true;
}

void scene_update_world_transforms(struct scene *scene)
{
    for (uint32_t i = 0; i < scene->node_count; i++) {
        struct scene_node *node = &scene->nodes[i];
        mat4 local;
        placement_matrix(node->translation, node->rotation, node->scale, local);
        bool shown = node->visible && !node->removed;
        if (node->parent == SCENE_NONE) {
            memcpy(node->world_from_local, local, sizeof(local));
            node->world_visible = shown;
        } else {
            struct scene_node *parent = &scene->nodes[node->parent];
            glm_mat4_mul((vec4 *)parent->world_from_local, local, (vec4 *)node->world_from_local);
            node->world_visible = shown && parent->world_visible;
        }
    }
    scene->revisions.transforms++;
}

bool scene_bounds(const struct scene *scene, double out_min[3], double out_max[3])
{
    double low[3] = {INFINITY, INFINITY, INFINITY};
    double high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t i = 0; i < scene->node_count; i++) {
        const struct scene_node *node = &scene->nodes[i];
        if (node->mesh == SCENE_NONE || !node->world_visible)
            continue;
        const struct scene_mesh *mesh = &scene->meshes[node->mesh];
        for (uint32_t j = 0; j < mesh->primitive_count; j++) {
            double box_min[3], box_max[3];
            const struct scene_primitive *primitive = &scene->primitives[mesh->primitive_first + j];
            if (primitive->vertex_count == 0)
                continue;
            placement_transform_box(node->world_from_local, primitive->bounds_min,
                                    primitive->bounds_max, box_min, box_max);
            for (int axis = 0; axis < 3; axis++) {
                low[axis] = fmin(low[axis], box_min[axis]);
                high[axis] = fmax(high[axis], box_max[axis]);
            }
        }
    }
    if (!(low[0] <= high[0]))
        return false;
    memcpy(out_min, low, sizeof(low));
    memcpy(out_max, high, sizeof(high));
    return true;
}

uint64_t scene_triangle_count(const struct scene *scene)
{
    uint64_t count = 0;
    for (uint32_t i = 0; i < scene->node_count; i++) {
        const struct scene_node *node = &scene->nodes[i];
        if (node->mesh == SCENE_NONE || !node->world_visible)
            continue;
        const struct scene_mesh *mesh = &scene->meshes[node->mesh];
        for (uint32_t j = 0; j < mesh->primitive_count; j++)
            count += scene->primitives[mesh->primitive_first + j].index_count / 3;
    }
    return count;
}

void scene_get_camera_placement(const struct scene *scene, uint32_t camera, float out_eye[3],
                                float out_target[3], float out_up[3])
{
    assert(camera < scene->camera_count);
    const float *matrix = scene->nodes[scene->cameras[camera].node].world_from_local;
    float forward[3], up[3];
    for (int axis = 0; axis < 3; axis++) {
        forward[axis] = -matrix[8 + axis];
        up[axis] = matrix[4 + axis];
    }
    placement_normalize_or(forward, (float[3]){0.0f, 0.0f, -1.0f}, forward);
    placement_normalize_or(up, (float[3]){0.0f, 1.0f, 0.0f}, out_up);
    for (int axis = 0; axis < 3; axis++) {
        out_eye[axis] = matrix[12 + axis];
        out_target[axis] = matrix[12 + axis] + forward[axis];
    }
}
