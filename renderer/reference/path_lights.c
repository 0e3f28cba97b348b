#include "renderer/reference/path_lights.h"

#include <stdlib.h>
#include <string.h>

#include "renderer/scene/vector3.h"
#include "renderer/reference/path_surface.h"

// The renderer's: nearer than this to a light (1 mm) the inverse square no longer grows.
#define MIN_LIGHT_DISTANCE_SQUARED 1e-6

struct punctual {
    enum scene_light_type type;
    bool casts_shadow;
    double position[3];
    double direction[3]; // unit, of shining
    double intensity[3]; // cd or lux
    double range_m;
    double cos_inner, cos_outer;
};

struct emitter {
    uint32_t node, primitive, triangle;
    double power_end; // cumulative: area times luminance of this and all before
};

struct path_lights {
    const struct scene *scene;
    struct punctual *punctuals;
    uint32_t punctual_count;
    struct emitter *emitters;
    uint32_t emitter_count;
    double power;
};

static double luminance(const double rgb[3])
{
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

static double material_luminance(const struct scene_material *material)
{
    double rgb[3];
    if (material->shading == SCENE_SHADING_UNLIT)
        return 0.0;
    for (int c = 0; c < 3; c++)
        rgb[c] = (double)material->emissive[c] * material->emissive_strength;
    return luminance(rgb);
}

static void add_punctual(struct path_lights *lights, uint32_t id)
{
    const struct scene_light *light = &lights->scene->lights[id];
    float position[3], direction[3];
    scene_get_light_placement(lights->scene, id, position, direction);
    struct punctual *punctual = &lights->punctuals[lights->punctual_count++];
    *punctual = (struct punctual){
        .type = light->type,
        .casts_shadow = light->casts_shadow,
        .range_m = light->type == SCENE_LIGHT_DIRECTIONAL ? 0.0 : light->range_m,
        .cos_inner = cos(light->inner_cone_rad),
        .cos_outer = cos(light->outer_cone_rad),
    };
    for (int i = 0; i < 3; i++) {
        punctual->position[i] = position[i];
        punctual->direction[i] = direction[i];
        punctual->intensity[i] = (double)light->color[i] * light->intensity;
    }
}

// Adds a primitive's triangles, or with `emitters` NULL only counts them.
static uint32_t add_emitters(const struct scene *scene, uint32_t node, uint32_t primitive,
                             struct emitter *emitters, double *power)
{
    const struct scene_primitive *source = &scene->primitives[primitive];
    double radiance = material_luminance(&scene->materials[source->material]);
    uint32_t count = radiance > 0.0 ? source->index_count / 3 : 0;
    for (uint32_t i = 0; emitters && i < count; i++) {
        struct ray_hit hit = {.node = node, .primitive = primitive, .triangle = i};
        double corners[3][3], normal[3];
        path_triangle_corners(scene, &hit, corners, normal);
        *power += 0.5 * vector3_length(normal) * radiance;
        emitters[i] = (struct emitter){node, primitive, i, *power};
    }
    return count;
}

// Counts emissive triangles, and lists them if there is a list.
static uint32_t find_emitters(struct path_lights *lights)
{
    const struct scene *scene = lights->scene;
    uint32_t count = 0;
    lights->power = 0.0;
    for (uint32_t node = 0; node < scene->node_count; node++) {
        const struct scene_node *source = &scene->nodes[node];
        if (source->mesh == SCENE_NONE || !source->world_visible || source->removed)
            continue;
        const struct scene_mesh *mesh = &scene->meshes[source->mesh];
        for (uint32_t i = 0; i < mesh->primitive_count; i++)
            count +=
                add_emitters(scene, node, mesh->primitive_first + i,
                             lights->emitters ? lights->emitters + count : NULL, &lights->power);
    }
    return count;
}

struct path_lights *path_lights_create(const struct scene *scene)
{
    struct path_lights *lights = calloc(1, sizeof(*lights));
    if (!lights)
        return NULL;
    lights->scene = scene;
    lights->punctuals = calloc(scene->light_count + 1, sizeof(*lights->punctuals));
    lights->emitter_count = find_emitters(lights);
    lights->emitters = calloc(lights->emitter_count + 1, sizeof(*lights->emitters));
    if (!lights->punctuals || !lights->emitters) {
        path_lights_destroy(&lights);
        return NULL;
    }
    find_emitters(lights);
    for (uint32_t i = 0; i < scene->light_count; i++) {
        const struct scene_light *light = &scene->lights[i];
        if (light->enabled && !light->removed && light->intensity > 0.0f &&
            scene->nodes[light->node].world_visible)
            add_punctual(lights, i);
    }
    return lights;
}

void path_lights_destroy(struct path_lights **lights)
{
    if (*lights) {
        free((*lights)->punctuals);
        free((*lights)->emitters);
    }
    free(*lights);
    *lights = NULL;
}

// KHR_lights_punctual: inverse square, window of the range, angular falloff of spots.
static bool evaluate_punctual(const struct punctual *light, const double position[3],
                              struct path_light_sample *out_sample)
{
    double strength = 1.0;
    out_sample->distance = INFINITY;
    out_sample->casts_shadow = light->casts_shadow;
    for (int axis = 0; axis < 3; axis++)
        out_sample->direction[axis] = -light->direction[axis];
    if (light->type != SCENE_LIGHT_DIRECTIONAL) {
        double to_light[3];
        vector3_subtract(to_light, light->position, position);
        double distance = vector3_length(to_light);
        if (!(distance > 0.0))
            return false;
        for (int axis = 0; axis < 3; axis++)
            out_sample->direction[axis] = to_light[axis] / distance;
        out_sample->distance = distance;
        strength = 1.0 / fmax(distance * distance, MIN_LIGHT_DISTANCE_SQUARED);
        if (light->range_m > 0.0)
            strength *= fmin(fmax(1.0 - pow(distance / light->range_m, 4.0), 0.0), 1.0);
        if (light->type == SCENE_LIGHT_SPOT) {
            double cosine = -vector3_dot(light->direction, out_sample->direction);
            double scale = 1.0 / fmax(0.001, light->cos_inner - light->cos_outer);
            double angular = fmin(fmax((cosine - light->cos_outer) * scale, 0.0), 1.0);
            strength *= angular * angular;
        }
    }
    for (int c = 0; c < 3; c++)
        out_sample->light[c] = light->intensity[c] * strength;
    return strength > 0.0;
}

bool path_lights_choose_punctual(const struct path_lights *lights, const double position[3],
                                 const double normal[3], double u,
                                 struct path_light_sample *out_sample)
{
    // One pass: each light replaces the chosen one with the probability of its share so far.
    double total = 0.0, chosen = 0.0;
    for (uint32_t i = 0; i < lights->punctual_count; i++) {
        struct path_light_sample sample;
        if (!evaluate_punctual(&lights->punctuals[i], position, &sample))
            continue;
        double weight = luminance(sample.light) * vector3_dot(normal, sample.direction);
        if (!(weight > 0.0))
            continue;
        total += weight;
        double share = weight / total;
        if (u < share) {
            *out_sample = sample;
            chosen = weight;
            u /= share;
        } else {
            u = (u - share) / (1.0 - share);
        }
    }
    for (int c = 0; c < 3 && chosen > 0.0; c++)
        out_sample->light[c] *= total / chosen;
    return chosen > 0.0;
}

bool path_lights_choose_emitter(const struct path_lights *lights, const double u[3],
                                struct ray_hit *out_point)
{
    if (lights->emitter_count == 0)
        return false;
    double wanted = u[0] * lights->power;
    uint32_t low = 0, high = lights->emitter_count - 1;
    while (low < high) {
        uint32_t middle = (low + high) / 2;
        if (lights->emitters[middle].power_end > wanted)
            high = middle;
        else
            low = middle + 1;
    }
    const struct emitter *emitter = &lights->emitters[low];
    double root = sqrt(u[1]);
    *out_point = (struct ray_hit){
        .node = emitter->node,
        .primitive = emitter->primitive,
        .triangle = emitter->triangle,
        .material = lights->scene->primitives[emitter->primitive].material,
        .barycentric = {(float)(root * (1.0 - u[2])), (float)(root * u[2])},
    };
    return true;
}

double path_lights_emitter_density(const struct path_lights *lights, uint32_t material)
{
    if (!(lights->power > 0.0))
        return 0.0;
    return material_luminance(&lights->scene->materials[material]) / lights->power;
}

void path_environment(const struct scene *scene, const double direction[3], double out_radiance[3])
{
    const struct scene_environment *environment = &scene->environment;
    double sine = sin(environment->rotation_rad), cosine = cos(environment->rotation_rad);
    double x = cosine * direction[0] - sine * direction[2], y = direction[1];
    double z = sine * direction[0] + cosine * direction[2];
    const float *texel = NULL;
    if (environment->type == SCENE_ENVIRONMENT_EQUIRECT && environment->pixels) {
        double u = 0.5 + atan2(x, -z) / (2.0 * M_PI);
        double v = acos(fmin(fmax(y, -1.0), 1.0)) / M_PI;
        uint32_t column = (uint32_t)(u * environment->width) % environment->width;
        uint32_t row = (uint32_t)fmin(v * environment->height, environment->height - 1.0);
        texel = environment->pixels + ((size_t)row * environment->width + column) * 3;
    }
    const float *pole = y >= 0.0 ? environment->color : environment->ground_color;
    for (int c = 0; c < 3; c++) {
        double value = 0.0;
        if (texel)
            value = texel[c];
        else if (environment->type == SCENE_ENVIRONMENT_CONSTANT)
            value = environment->color[c];
        else if (environment->type == SCENE_ENVIRONMENT_GRADIENT)
            value = environment->horizon_color[c] +
                    (pole[c] - (double)environment->horizon_color[c]) * fabs(y);
        out_radiance[c] = value * environment->intensity;
    }
}
