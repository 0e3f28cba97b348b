// Finds planar emitters: every emissive triangle is a Lambertian source, and two coplanar triangles
// that share an edge form a parallelogram or quad.
#include <math.h>
#include <string.h>

#include "renderer/gpu_scene/gpu_scene.h"
#include "renderer/scene/scene.h"

// Emissive primitives of more triangles (curved emitters) are not split into planar emitters.
#define MAX_EMITTER_TRIANGLES 12u
// Emitters of at least this fraction of the surface of the scene's bounds are large: with global
// illumination cones gather their light and see the unoccluded part, which a shadow map from the
// centre would not.
#define LARGE_FRACTION 0.03f

static void emitted_radiance(const struct gpu_scene *gpu_scene,
                             const struct scene_material *material, float out_radiance[3])
{
    uint32_t image = material->textures[SCENE_TEXTURE_EMISSIVE].image;
    for (int c = 0; c < 3; c++) {
        out_radiance[c] = material->emissive[c] * material->emissive_strength;
        if (image < gpu_scene->scene->image_count)
            out_radiance[c] *=
                gpu_scene->texture_spaces[TEXTURE_SPACE_COLOR].image_slots[image].mean[c];
    }
}

static void load_corner(const struct scene *scene, const struct gpu_scene_instance *instance,
                        uint32_t corner, float out_world[3])
{
    uint32_t index = scene->indices[instance->index_first + corner];
    const float *matrix = instance->world_from_local;
    const float *p = scene->vertices[index].position;
    for (int row = 0; row < 3; row++)
        out_world[row] =
            matrix[row] * p[0] + matrix[4 + row] * p[1] + matrix[8 + row] * p[2] + matrix[12 + row];
}

// Area vector (half the cross product) of a triangle.
static void area_vector(float a[3], float b[3], float c[3], float out_vector[3])
{
    vec3 u, v;
    glm_vec3_sub(b, a, u);
    glm_vec3_sub(c, a, v);
    glm_vec3_cross(u, v, out_vector);
    glm_vec3_scale(out_vector, 0.5f, out_vector);
}

// Joins two triangles into a quad if they are coplanar and share an edge: writes the four corners
// in order and returns true.
static bool join_quad(float first[3][3], float second[3][3], float out_corners[4][3])
{
    vec3 n1, n2;
    area_vector(first[0], first[1], first[2], n1);
    area_vector(second[0], second[1], second[2], n2);
    float size = sqrtf(glm_vec3_norm(n1) + glm_vec3_norm(n2));
    glm_vec3_normalize(n1);
    glm_vec3_normalize(n2);
    if (glm_vec3_dot(n1, n2) < 0.9999f)
        return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            // The shared edge runs i -> i+1 in the first triangle and j -> j+1, reversed, in the
            // second.
            if (glm_vec3_distance(first[i], second[(j + 1) % 3]) > 1e-4f * size ||
                glm_vec3_distance(first[(i + 1) % 3], second[j]) > 1e-4f * size)
                continue;
            memcpy(out_corners[0], first[(i + 1) % 3], sizeof(vec3));
            memcpy(out_corners[1], first[(i + 2) % 3], sizeof(vec3));
            memcpy(out_corners[2], first[i], sizeof(vec3));
            memcpy(out_corners[3], second[(j + 2) % 3], sizeof(vec3));
            return true;
        }
    return false;
}

static void write_light(struct area_light_block *light, float corners[4][3],
                        const float radiance[3], bool both_sides, bool mirrored)
{
    *light = (struct area_light_block){0};
    vec3 half, other;
    area_vector(corners[0], corners[1], corners[2], half);
    area_vector(corners[0], corners[2], corners[3], other);
    glm_vec3_add(half, other, half);
    float area = glm_vec3_norm(half);
    for (int i = 0; i < 4; i++) {
        int from = mirrored ? 3 - i : i;
        memcpy(light->corners[i], corners[from], sizeof(vec3));
        for (int axis = 0; axis < 3; axis++)
            light->center[axis] += 0.25f * corners[i][axis];
    }
    light->two_sided = both_sides;
    memcpy(light->radiance, radiance, sizeof(vec3));
    light->area_m2 = area;
    glm_vec3_scale(half, (mirrored ? -1.0f : 1.0f) / area, light->normal);
    light->shadow.first_view = NO_SHADOW;
}

static uint32_t add_instance(const struct gpu_scene *gpu_scene,
                             const struct gpu_scene_instance *instance,
                             const struct scene_material *material, uint32_t count,
                             struct area_light_block *lights)
{
    const struct scene *scene = gpu_scene->scene;
    float radiance[3];
    emitted_radiance(gpu_scene, material, radiance);
    mat4 matrix;
    memcpy(matrix, instance->world_from_local, sizeof(matrix));
    bool mirrored = glm_mat4_det(matrix) < 0.0f;
    uint32_t triangles = instance->index_count / 3;
    for (uint32_t i = 0; i < triangles && count < MAX_AREA_LIGHTS; i++) {
        float first[3][3], second[3][3], corners[4][3];
        for (uint32_t c = 0; c < 3; c++) {
            load_corner(scene, instance, 3 * i + c, first[c]);
            if (i + 1 < triangles)
                load_corner(scene, instance, 3 * (i + 1) + c, second[c]);
        }
        if (i + 1 < triangles && join_quad(first, second, corners)) {
            i++;
        } else {
            memcpy(corners, first, sizeof(first));
            memcpy(corners[3], first[2], sizeof(vec3));
        }
        vec3 area;
        area_vector(first[0], first[1], first[2], area);
        float size = glm_vec3_norm(area);
        if (size > 0.0f && isfinite(size))
            write_light(&lights[count++], corners, radiance, material->double_sided, mirrored);
    }
    return count;
}

static float bounds_area(const struct gpu_scene *gpu_scene)
{
    float size[3];
    for (int axis = 0; axis < 3; axis++)
        size[axis] = gpu_scene->bounds_max[axis] - gpu_scene->bounds_min[axis];
    return 2.0f * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0]);
}

static bool is_emissive(const struct scene_material *material)
{
    return material->emissive_strength > 0.0f && material->shading != SCENE_SHADING_UNLIT &&
           (material->emissive[0] > 0.0f || material->emissive[1] > 0.0f ||
            material->emissive[2] > 0.0f);
}

uint32_t gpu_scene_find_area_lights(struct gpu_scene *gpu_scene,
                                    struct area_light_block out_lights[MAX_AREA_LIGHTS])
{
    const struct scene *scene = gpu_scene->scene;
    float large = LARGE_FRACTION * bounds_area(gpu_scene);
    uint32_t count = 0;
    gpu_scene->counts.large_area_lights = 0;
    for (uint32_t i = 0; i < gpu_scene->counts.instances; i++) {
        struct gpu_scene_instance *instance = &gpu_scene->instances[i];
        const struct scene_material *material =
            &scene->materials[scene->primitives[instance->primitive].material];
        instance->emits_directly = false;
        instance->large_emitter = false;
        if (!instance->visible || !is_emissive(material) || count == MAX_AREA_LIGHTS ||
            instance->index_count / 3 > MAX_EMITTER_TRIANGLES)
            continue;
        uint32_t first = count;
        count = add_instance(gpu_scene, instance, material, count, out_lights);
        float area = 0.0f;
        for (uint32_t j = first; j < count; j++)
            area += out_lights[j].area_m2;
        instance->emits_directly = true;
        instance->large_emitter = area >= large;
        for (uint32_t j = first; j < count && instance->large_emitter; j++)
            out_lights[j].in_voxels = 1;
        gpu_scene->counts.large_area_lights += instance->large_emitter ? count - first : 0;
    }
    return count;
}
