// Edits of a built scene: each changes the data and increments the affected revisions.
#include "renderer/scene/scene.h"

#include <assert.h>
#include <cglm/cglm.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/scene/placement.h"

void scene_set_node_transform(struct scene *scene, uint32_t node_id, const float translation[3],
                              const float rotation[4], const float scale[3])
{
    assert(node_id < scene->node_count);
    struct scene_node *node = &scene->nodes[node_id];
    memcpy(node->translation, translation, sizeof(node->translation));
    memcpy(node->rotation, rotation, sizeof(node->rotation));
    memcpy(node->scale, scale, sizeof(node->scale));
    scene_update_world_transforms(scene);
}

void scene_set_node_visible(struct scene *scene, uint32_t node, bool visible)
{
    assert(node < scene->node_count);
    scene->nodes[node].visible = visible;
    scene_update_world_transforms(scene);
}

void scene_set_material(struct scene *scene, uint32_t material, const struct scene_material *value)
{
    assert(material < scene->material_count);
    scene->materials[material] = *value;
    scene->revisions.materials++;
}

void scene_set_light(struct scene *scene, uint32_t light_id, const struct scene_light *value)
{
    assert(light_id < scene->light_count);
    struct scene_light *light = &scene->lights[light_id];
    uint32_t node = light->node;
    *light = *value;
    light->node = node;
    scene->revisions.lights++;
}

void scene_set_light_placement(struct scene *scene, uint32_t light, const float position[3],
                               const float direction[3])
{
    assert(light < scene->light_count);
    struct scene_node *node = &scene->nodes[scene->lights[light].node];
    mat4 parent_from_world = GLM_MAT4_IDENTITY_INIT;
    if (node->parent != SCENE_NONE) {
        mat4 world_from_parent;
        memcpy(world_from_parent, scene->nodes[node->parent].world_from_local,
               sizeof(world_from_parent));
        if (fabsf(glm_mat4_det(world_from_parent)) > 1e-30f)
            glm_mat4_inv(world_from_parent, parent_from_world);
    }
    vec3 local_position, local_direction;
    glm_mat4_mulv3(parent_from_world, (float *)position, 1.0f, local_position);
    glm_mat4_mulv3(parent_from_world, (float *)direction, 0.0f, local_direction);
    memcpy(node->translation, local_position, sizeof(node->translation));
    placement_look_rotation(local_direction, (float[3]){0.0f, 1.0f, 0.0f}, node->rotation);
    scene_update_world_transforms(scene);
}

void scene_get_light_placement(const struct scene *scene, uint32_t light, float out_position[3],
                               float out_direction[3])
{
    assert(light < scene->light_count);
    const float *matrix = scene->nodes[scene->lights[light].node].world_from_local;
    for (int axis = 0; axis < 3; axis++) {
        out_position[axis] = matrix[12 + axis];
        out_direction[axis] = -matrix[8 + axis];
    }
    placement_normalize_or(out_direction, (float[3]){0.0f, 0.0f, -1.0f}, out_direction);
}

void scene_remove_light(struct scene *scene, uint32_t light_id)
{
    assert(light_id < scene->light_count);
    struct scene_light *light = &scene->lights[light_id];
    if (light->removed)
        return;
    light->removed = true;
    struct scene_node *node = &scene->nodes[light->node];
    node->light = SCENE_NONE;
    // Removes the node with its light unless it carries something else.
    bool has_child = false;
    for (uint32_t i = light->node + 1; i < scene->node_count; i++)
        has_child = has_child || scene->nodes[i].parent == light->node;
    if (node->mesh == SCENE_NONE && node->camera == SCENE_NONE && !has_child)
        node->removed = true;
    scene->revisions.lights++;
    scene_update_world_transforms(scene);
}

bool scene_restore_light(struct scene *scene, uint32_t light_id)
{
    assert(light_id < scene->light_count);
    struct scene_light *light = &scene->lights[light_id];
    if (!light->removed)
        return false;
    light->removed = false;
    scene->nodes[light->node].light = light_id;
    scene->nodes[light->node].removed = false;
    scene->revisions.lights++;
    scene->revisions.geometry++;
    scene_update_world_transforms(scene);
    return true;
}

void scene_set_environment(struct scene *scene, const struct scene_environment *environment)
{
    if (scene->environment.image != environment->image)
        environment_image_release(&scene->environment.image);
    scene->environment = *environment;
    scene->revisions.environment++;
}

// Index of the last key at or before the time; 0 before the first.
static uint32_t find_key(const struct scene_animation_channel *channel, float time_s)
{
    uint32_t low = 0, high = channel->key_count;
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if (channel->times_s[middle] <= time_s)
            low = middle;
        else
            high = middle;
    }
    return low;
}

// Interpolates as in glTF 2.0, appendix C. `out_value` has 3 or 4 components, depending on the
// channel's path.
static void sample_channel(const struct scene_animation_channel *channel, float time_s,
                           float out_value[4])
{
    uint32_t width = channel->path == SCENE_PATH_ROTATION ? 4 : 3;
    uint32_t stride = channel->interpolation == SCENE_CUBIC_SPLINE ? 3 * width : width;
    uint32_t value_at = channel->interpolation == SCENE_CUBIC_SPLINE ? width : 0;
    uint32_t key = find_key(channel, time_s);
    const float *here = channel->values + (size_t)key * stride;
    bool between = key + 1 < channel->key_count && time_s > channel->times_s[key];
    if (!between || channel->interpolation == SCENE_STEP) {
        memcpy(out_value, here + value_at, width * sizeof(float));
        return;
    }
    const float *next = here + stride;
    float span_s = channel->times_s[key + 1] - channel->times_s[key];
    float t = span_s > 0.0f ? (time_s - channel->times_s[key]) / span_s : 0.0f;
    if (channel->interpolation == SCENE_LINEAR) {
        if (channel->path == SCENE_PATH_ROTATION)
            glm_quat_slerp((float *)here, (float *)next, t, out_value);
        else
            glm_vec3_lerp((float *)here, (float *)next, t, out_value);
        return;
    }
    float t2 = t * t, t3 = t2 * t;
    for (uint32_t i = 0; i < width; i++)
        out_value[i] = (2 * t3 - 3 * t2 + 1) * here[width + i] +
                       span_s * (t3 - 2 * t2 + t) * here[2 * width + i] +
                       (-2 * t3 + 3 * t2) * next[width + i] + span_s * (t3 - t2) * next[i];
}

void scene_animate(struct scene *scene, uint32_t animation_id, float time_s)
{
    assert(animation_id < scene->animation_count);
    const struct scene_animation *animation = &scene->animations[animation_id];
    time_s = fminf(fmaxf(time_s, 0.0f), animation->duration_s);
    for (uint32_t i = 0; i < animation->channel_count; i++) {
        const struct scene_animation_channel *channel = &animation->channels[i];
        struct scene_node *node = &scene->nodes[channel->node];
        float *targets[] = {
            [SCENE_PATH_TRANSLATION] = node->translation,
            [SCENE_PATH_ROTATION] = node->rotation,
            [SCENE_PATH_SCALE] = node->scale,
        };
        float value[4];
        sample_channel(channel, time_s, value);
        memcpy(targets[channel->path], value,
               (channel->path == SCENE_PATH_ROTATION ? 4 : 3) * sizeof(float));
    }
    scene_update_world_transforms(scene);
}
