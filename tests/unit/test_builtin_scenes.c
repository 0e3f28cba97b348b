// Proves that the built-in scenes are sound: complete and finite data, fronts that agree with the
// normals, no triangles without area, closed shapes of the right size, the same bytes in every
// build, and cameras that see fronts, never the inside of a wall, nor two coincident surfaces. Each
// scene is built twice and inspected; rays from its cameras show what can be seen.
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "renderer/scene/ray_scene.h"
#include "renderer/import/scene_load.h"
#include "renderer/scene/vector3.h"
#include "support_scenes.h"

#define RAYS_ACROSS         96 // per camera
#define RAYS_DOWN           54
#define SAME_POSITION_M     1e-4
#define DOUBLE_CHECK_STRIDE 7 // of the rays, which are searched for a second surface

static const struct expected {
    const char *name;
    uint64_t min_triangles;
    uint32_t point_lights;
    uint32_t cameras;
} expected_scenes[] = {
    {"cornell", 30, 0, 1},
    {"cornell-objects", 20000, 1, 2},
    {"cornell-objects-diffuse", 20000, 1, 2},
    {"cornell-objects-glossy", 20000, 1, 2},
    {"cornell-objects-glass", 20000, 1, 2},
    {"cornell-objects-emissive", 20000, 0, 2},
    {"atrium", 100000, 0, 4},
    {"atrium-lights", 100000, 256, 4},
    {"furnace", 1000, 0, 1},
    {"material-grid", 10000, 0, 1},
};

#define SCENE_COUNT (sizeof(expected_scenes) / sizeof(expected_scenes[0]))

static struct scene *build(const char *name)
{
    struct error error = {0};
    struct scene *scene = scene_create_builtin(name, &error);
    assert_non_null(scene);
    return scene;
}

static void load_triangle(const struct scene *scene, uint32_t first, double out_corners[3][3])
{
    for (int corner = 0; corner < 3; corner++)
        for (int axis = 0; axis < 3; axis++)
            out_corners[corner][axis] =
                scene->vertices[scene->indices[first + (uint32_t)corner]].position[axis];
}

static void cross_of(double corners[3][3], double out_cross[3])
{
    double edges[2][3];
    vector3_subtract(edges[0], corners[1], corners[0]);
    vector3_subtract(edges[1], corners[2], corners[0]);
    vector3_cross(out_cross, edges[0], edges[1]);
}

// Fronts agree with normals, and triangles have area.
static void check_triangles(const struct scene *scene)
{
    uint32_t contrary = 0, degenerate = 0;
    for (uint32_t first = 0; first < scene->index_count; first += 3) {
        double corners[3][3], cross[3], normal[3] = {0};
        load_triangle(scene, first, corners);
        cross_of(corners, cross);
        if (vector3_length(cross) < 1e-11)
            degenerate++;
        for (uint32_t corner = 0; corner < 3; corner++)
            for (int axis = 0; axis < 3; axis++)
                normal[axis] += scene->vertices[scene->indices[first + corner]].normal[axis];
        contrary += vector3_dot(cross, normal) <= 0;
    }
    assert_true(degenerate * 1000ull <= scene->index_count / 3);
    assert_true(contrary * 1000ull <= scene->index_count / 3);
}

static void check_materials(const struct scene *scene)
{
    for (uint32_t i = 0; i < scene->material_count; i++) {
        const struct scene_material *material = &scene->materials[i];
        assert_true(material->metallic >= 0 && material->metallic <= 1);
        assert_true(material->transmission >= 0 && material->transmission <= 1);
        assert_true(material->ior >= 1);
        for (int c = 0; c < 4; c++)
            assert_true(material->base_color[c] >= 0 && material->base_color[c] <= 1);
        for (int c = 0; c < 3; c++)
            assert_true(material->emissive[c] >= 0 && material->emissive[c] <= 1);
    }
}

static void test_scenes_are_sound(void **state)
{
    (void)state;
    for (size_t i = 0; i < SCENE_COUNT; i++) {
        const struct expected *expected = &expected_scenes[i];
        struct timespec start, end;
        clock_gettime(CLOCK_MONOTONIC, &start);
        struct scene *scene = build(expected->name);
        clock_gettime(CLOCK_MONOTONIC, &end);
        printf("%s: %llu triangles drawn, %u stored, %u nodes, built in %.0f ms\n", expected->name,
               (unsigned long long)scene_triangle_count(scene), scene->index_count / 3,
               scene->node_count,
               (double)(end.tv_sec - start.tv_sec) * 1e3 +
                   (double)(end.tv_nsec - start.tv_nsec) * 1e-6);
        support_check_scene(scene);
        check_triangles(scene);
        check_materials(scene);
        assert_true(scene_triangle_count(scene) >= expected->min_triangles);
        assert_true(scene->camera_count >= expected->cameras);
        uint32_t points = 0;
        for (uint32_t light = 0; light < scene->light_count; light++)
            points += scene->lights[light].type == SCENE_LIGHT_POINT;
        assert_int_equal(points, expected->point_lights);
        scene_destroy(&scene);
    }
}

static void test_every_scene_is_expected(void **state)
{
    (void)state;
    uint32_t count = 0;
    for (const char *name; (name = scene_builtin_name(count)); count++) {
        bool found = false;
        for (size_t i = 0; i < SCENE_COUNT; i++)
            found = found || strcmp(name, expected_scenes[i].name) == 0;
        assert_true(found);
        assert_non_null(scene_builtin_description(count));
    }
    assert_int_equal(count, SCENE_COUNT);
}

static void test_builds_are_equal(void **state)
{
    (void)state;
    for (size_t i = 0; i < SCENE_COUNT; i++) {
        struct scene *one = build(expected_scenes[i].name), *two = build(expected_scenes[i].name);
        assert_int_equal(one->vertex_count, two->vertex_count);
        assert_int_equal(one->index_count, two->index_count);
        assert_int_equal(one->image_count, two->image_count);
        assert_memory_equal(one->vertices, two->vertices,
                            one->vertex_count * sizeof(*one->vertices));
        assert_memory_equal(one->indices, two->indices, one->index_count * sizeof(*one->indices));
        for (uint32_t image = 0; image < one->image_count; image++)
            assert_memory_equal(one->images[image]->rgba, two->images[image]->rgba,
                                4 * one->images[image]->width * one->images[image]->height);
        scene_destroy(&one);
        scene_destroy(&two);
    }
}

static const struct scene_primitive *find_primitive(const struct scene *scene, const char *mesh)
{
    for (uint32_t i = 0; i < scene->mesh_count; i++)
        if (strcmp(scene->meshes[i].name, mesh) == 0)
            return &scene->primitives[scene->meshes[i].primitive_first];
    fail_msg("no mesh is named %s", mesh);
    return NULL;
}

// By the divergence theorem; positive if the fronts are outside.
static double volume_of(const struct scene *scene, const struct scene_primitive *primitive)
{
    double volume = 0;
    for (uint32_t i = 0; i < primitive->index_count; i += 3) {
        double corners[3][3], cross[3];
        load_triangle(scene, primitive->index_first + i, corners);
        vector3_cross(cross, corners[1], corners[2]);
        volume += vector3_dot(corners[0], cross) / 6;
    }
    return volume;
}

static void test_objects_are_closed_and_of_their_size(void **state)
{
    (void)state;
    struct scene *scene = build("cornell-objects");
    double ball = volume_of(scene, find_primitive(scene, "glass ball"));
    double ring = volume_of(scene, find_primitive(scene, "lacquered ring"));
    double stone = volume_of(scene, find_primitive(scene, "rough stone"));
    assert_true(fabs(ball / (4.0 / 3.0 * M_PI * pow(0.08, 3)) - 1) < 0.01);
    assert_true(fabs(ring / (2 * M_PI * M_PI * 0.05 * pow(0.022, 2)) - 1) < 0.02);
    assert_true(stone > 0.5 * pow(0.14, 3) && stone < pow(0.14, 3));
    scene_destroy(&scene);
}

static const struct scene_material *material_of(const struct scene *scene, const char *mesh)
{
    return &scene->materials[find_primitive(scene, mesh)->material];
}

static float emission_of(const struct scene_material *material)
{
    return material->emissive_strength *
           (material->emissive[0] + material->emissive[1] + material->emissive[2]);
}

static void test_objects_of_one_kind(void **state)
{
    (void)state;
    static const char *const objects[] = {"copper teapot", "glass ball", "lacquered ring",
                                          "rough stone"};
    struct scene *diffuse = build("cornell-objects-diffuse");
    struct scene *glossy = build("cornell-objects-glossy");
    struct scene *glass = build("cornell-objects-glass");
    struct scene *emissive = build("cornell-objects-emissive");
    for (int i = 0; i < 4; i++) {
        const struct scene_material *matt = material_of(diffuse, objects[i]);
        assert_true(matt->metallic == 0.0f && matt->transmission == 0.0f && matt->ior == 1.0f);
        const struct scene_material *lacquer = material_of(glossy, objects[i]);
        assert_true(lacquer->roughness < 0.2f && lacquer->ior > 1.0f && lacquer->metallic == 0.0f);
        const struct scene_material *clear = material_of(glass, objects[i]);
        assert_true(clear->transmission == 1.0f && clear->roughness == 0.0f);
        // Closed objects refract; the pot's wall is thin.
        assert_true((clear->thickness_m > 0.0f) == (i != 0));
        assert_true(emission_of(material_of(emissive, objects[i])) > 0.1f);
    }
    // Nothing else emits there, and in the other scenes nothing but the light emits.
    assert_true(emission_of(material_of(emissive, "lamp")) == 0.0f);
    assert_true(emission_of(material_of(glass, "lamp")) > 10.0f);
    assert_int_equal(emissive->light_count, 0);
    scene_destroy(&diffuse);
    scene_destroy(&glossy);
    scene_destroy(&glass);
    scene_destroy(&emissive);
}

static void test_teapot_has_newells_proportions(void **state)
{
    (void)state;
    struct scene *scene = build("cornell-objects");
    const struct scene_primitive *teapot = find_primitive(scene, "copper teapot");
    // Newell's body is 4 units wide; his pot is 3.15 high and stands on 0; its handle reaches to
    // -3.
    double unit = (teapot->bounds_max[2] - teapot->bounds_min[2]) / 4.0;
    assert_true(fabs(teapot->bounds_max[1] / unit - 3.15) < 0.01);
    assert_true(fabs(teapot->bounds_min[1] / unit) < 0.001);
    assert_true(fabs(teapot->bounds_min[0] / unit + 3.0) < 0.03);
    assert_true(teapot->bounds_max[0] / unit > 3.3 && teapot->bounds_max[0] / unit < 3.525);
    // Outward fronts: the body alone holds well over 20 cubic units.
    assert_true(volume_of(scene, teapot) > 20 * pow(unit, 3));
    scene_destroy(&scene);
}

struct camera_ray {
    uint32_t rays, hits, backs, checked, doubles;
};

static bool shows_back(const struct scene *scene, const struct ray_hit *hit)
{
    const struct scene_primitive *primitive = &scene->primitives[hit->primitive];
    if (scene->materials[hit->material].double_sided)
        return false;
    double corners[3][3], cross[3], world[3] = {0};
    load_triangle(scene, primitive->index_first + 3 * hit->triangle, corners);
    cross_of(corners, cross);
    const float *matrix = scene->nodes[hit->node].world_from_local;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            world[row] += (double)matrix[4 * column + row] * cross[column];
    return world[0] * hit->normal[0] + world[1] * hit->normal[1] + world[2] * hit->normal[2] < 0;
}

// Whether the local point lies inside the triangle and in its plane.
static bool triangle_holds(double corners[3][3], const double point[3])
{
    double cross[3], edge[3], to_point[3], part[3];
    cross_of(corners, cross);
    double area = vector3_length(cross);
    if (area <= 0)
        return false;
    vector3_subtract(to_point, point, corners[0]);
    if (fabs(vector3_dot(to_point, cross)) > SAME_POSITION_M * area)
        return false;
    for (int i = 0; i < 3; i++) {
        vector3_subtract(edge, corners[(i + 1) % 3], corners[i]);
        vector3_subtract(to_point, point, corners[i]);
        vector3_cross(part, edge, to_point);
        if (vector3_dot(part, cross) < 1e-3 * area * area)
            return false;
    }
    return true;
}

// How many triangles of one node lie at the hit, in its plane. Nodes are only rotated and moved.
static uint32_t count_at_hit(const struct scene *scene, const struct scene_node *node,
                             const struct ray_hit *hit)
{
    double point[3] = {0}, normal[3] = {0};
    const float *matrix = node->world_from_local;
    for (int axis = 0; axis < 3; axis++)
        for (int row = 0; row < 3; row++) {
            double heading = (double)hit->position[row] - matrix[12 + row];
            point[axis] += matrix[4 * axis + row] * heading;
            normal[axis] += (double)matrix[4 * axis + row] * hit->normal[row];
        }
    uint32_t count = 0;
    const struct scene_mesh *mesh = &scene->meshes[node->mesh];
    for (uint32_t i = 0; i < mesh->primitive_count; i++) {
        const struct scene_primitive *primitive = &scene->primitives[mesh->primitive_first + i];
        bool inside = true;
        for (int axis = 0; axis < 3; axis++)
            inside = inside && point[axis] > primitive->bounds_min[axis] - 1e-3 &&
                     point[axis] < primitive->bounds_max[axis] + 1e-3;
        for (uint32_t k = 0; inside && k < primitive->index_count; k += 3) {
            double corners[3][3], cross[3];
            load_triangle(scene, primitive->index_first + k, corners);
            cross_of(corners, cross);
            count += fabs(vector3_dot(cross, normal)) > 0.9999 * vector3_length(cross) &&
                     triangle_holds(corners, point);
        }
    }
    return count;
}

static bool is_doubled(const struct scene *scene, const struct ray_hit *hit)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < scene->node_count; i++)
        if (scene->nodes[i].mesh != SCENE_NONE)
            count += count_at_hit(scene, &scene->nodes[i], hit);
    return count > 1;
}

static void look(const struct scene *scene, const struct ray_scene *rays, uint32_t camera,
                 struct camera_ray *camera_ray)
{
    float eye[3], target[3], up[3];
    scene_get_camera_placement(scene, camera, eye, target, up);
    const float *matrix = scene->nodes[scene->cameras[camera].node].world_from_local;
    float half = tanf(0.5f * scene->cameras[camera].fov_y_rad);
    for (int i = 0; i < RAYS_ACROSS * RAYS_DOWN; i++) {
        float x = (((float)(i % RAYS_ACROSS) + 0.37f) / RAYS_ACROSS * 2 - 1) * half * 16 / 9;
        float y = (1 - ((float)(i / RAYS_ACROSS) + 0.53f) / RAYS_DOWN * 2) * half;
        float direction[3], length = sqrtf(x * x + y * y + 1);
        for (int axis = 0; axis < 3; axis++)
            direction[axis] = (x * matrix[axis] + y * matrix[4 + axis] - matrix[8 + axis]) / length;
        struct ray_hit hit;
        camera_ray->rays++;
        if (!ray_scene_intersect(rays, eye, direction, 1000, &hit))
            continue;
        camera_ray->hits++;
        camera_ray->backs += shows_back(scene, &hit);
        if (i % DOUBLE_CHECK_STRIDE == 0) {
            camera_ray->checked++;
            camera_ray->doubles += is_doubled(scene, &hit);
        }
    }
}

static void test_cameras_see_fronts_alone(void **state)
{
    (void)state;
    for (size_t i = 0; i < SCENE_COUNT; i++) {
        struct scene *scene = build(expected_scenes[i].name);
        struct ray_scene *rays = ray_scene_create(scene);
        assert_non_null(rays);
        for (uint32_t camera = 0; camera < scene->camera_count; camera++) {
            struct camera_ray camera_ray = {0};
            look(scene, rays, camera, &camera_ray);
            printf("%s, %s: %u of %u rays hit, %u backs, %u of %u doubled\n", scene->name,
                   scene->cameras[camera].name, camera_ray.hits, camera_ray.rays, camera_ray.backs,
                   camera_ray.doubles, camera_ray.checked);
            assert_true(camera_ray.hits * 5 > camera_ray.rays); // open scenes show much sky
            // A ray may slip between two triangles of unequal division.
            assert_true(camera_ray.backs * 1000 <= camera_ray.hits);
            assert_int_equal(camera_ray.doubles, 0);
        }
        ray_scene_destroy(&rays);
        scene_destroy(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_scene_is_expected),
        cmocka_unit_test(test_scenes_are_sound),
        cmocka_unit_test(test_builds_are_equal),
        cmocka_unit_test(test_objects_are_closed_and_of_their_size),
        cmocka_unit_test(test_objects_of_one_kind),
        cmocka_unit_test(test_teapot_has_newells_proportions),
        cmocka_unit_test(test_cameras_see_fronts_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
