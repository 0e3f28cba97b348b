// Proves that voxels which follow a camera and moving objects equal those of a volume that was
// filled on the spot. After random walks of either and of both, all surfels are the same to the
// bit; the radiance of all levels and mips is the same up to the order of sums; only what has come
// into reach or has moved is voxelized; and nothing leaks. Also proves that filtering across
// addresses that wrap around equals filtering of voxels laid out in a row.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support_voxels.h"

#define EDGE        32u
#define CLIP_LEVELS 3u
#define SNAP_VOXELS 2u // as in renderer/gi/voxel/volume.c
#define OBJECTS     8u
#define STEPS       200u
#define CHECK_EVERY 40u
#define LEAK_STEPS  500u
#define REACH_M     24.0

struct walk {
    struct voxel_rig rig;
    struct scene *scene;
    struct voxel_volume *volume;
    uint32_t first_node; // of the objects
    uint64_t seed;
    float eye[3];
};

static double in_range(uint64_t *seed, double low, double high)
{
    return low + (high - low) * voxel_random(seed);
}

// A ball of `rows` x 2 `rows` quads, in colours.
static uint32_t add_ball(struct scene *scene, uint32_t rows, double radius_m)
{
    uint32_t count = 4 * rows * rows;
    float *triangles = malloc(sizeof(float) * 9 * count),
          *colors = malloc(sizeof(float) * 3 * count);
    assert_non_null(triangles);
    assert_non_null(colors);
    float *at = triangles;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t quad = i / 2, row = quad / (2 * rows), column = quad % (2 * rows);
        static const uint32_t steps[2][3][2] = {{{0, 0}, {1, 0}, {1, 1}}, {{0, 0}, {1, 1}, {0, 1}}};
        for (int k = 0; k < 3; k++) {
            double polar = M_PI * (row + steps[i & 1][k][0]) / rows;
            double turn = M_PI * (column + steps[i & 1][k][1]) / rows;
            *at++ = (float)(radius_m * sin(polar) * sin(turn));
            *at++ = (float)(radius_m * cos(polar));
            *at++ = (float)(radius_m * sin(polar) * cos(turn));
        }
        for (uint32_t c = 0; c < 3; c++)
            colors[3 * i + c] = 0.2f + 0.6f * (float)((quad * (c + 3)) % 7) / 7.0f;
    }
    uint32_t node = voxel_scene_add(scene, triangles, count, colors, 0);
    free(triangles);
    free(colors);
    return node;
}

static void add_object(struct walk *walk, uint32_t object)
{
    float translation[3], rotation[4], scale[3];
    double length = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        translation[axis] = (float)in_range(&walk->seed, -REACH_M, REACH_M);
        scale[axis] = (float)in_range(&walk->seed, 0.3, 1.2);
    }
    for (int i = 0; i < 4; i++) {
        rotation[i] = (float)in_range(&walk->seed, -1.0, 1.0);
        length += (double)rotation[i] * rotation[i];
    }
    for (int i = 0; i < 4; i++)
        rotation[i] /= (float)sqrt(length);
    scale[0] *= voxel_random(&walk->seed) < 0.3 ? -1.0f : 1.0f;
    scene_set_node_transform(walk->scene, walk->first_node + object, translation, rotation, scale);
}

static void begin_walk(struct walk *walk, uint64_t seed, enum gi_method method)
{
    memset(walk, 0, sizeof(*walk));
    walk->seed = seed;
    walk->scene = voxel_scene_create();
    walk->first_node = walk->scene->node_count;
    for (uint32_t i = 0; i < OBJECTS; i++)
        add_ball(walk->scene, 4 + 2 * i, 1.0 + 0.4 * i);
    // A floor for all of the scene, of two large triangles.
    const float r = (float)REACH_M;
    const float floor[18] = {-r, -5.3f, -r, r,  -5.1f, r, r, -5.0f, -r,
                             -r, -5.3f, -r, -r, -5.2f, r, r, -5.1f, r};
    voxel_scene_add(walk->scene, floor, 2, NULL, 0);
    for (uint32_t i = 0; i < OBJECTS; i++)
        add_object(walk, i);
    voxel_rig_init(&walk->rig, walk->scene);
    walk->volume =
        voxel_rig_volume(&walk->rig, method, EDGE, method == GI_METHOD_CLIPMAP ? CLIP_LEVELS : 0);
    voxel_rig_voxelize(&walk->rig, walk->volume, walk->eye);
}

static void end_walk(struct walk *walk)
{
    voxel_volume_destroy(&walk->volume);
    voxel_rig_finish(&walk->rig);
    scene_destroy(&walk->scene);
}

// Less than a voxel, some voxels, or to another position altogether.
static void step_camera(struct walk *walk)
{
    double kind = voxel_random(&walk->seed);
    double size = kind < 0.5 ? 0.3 : kind < 0.9 ? 4.0 : 50.0;
    for (int axis = 0; axis < 3; axis++) {
        double at = walk->eye[axis] + in_range(&walk->seed, -size, size);
        walk->eye[axis] = (float)fmin(fmax(at, -32.0), 32.0);
    }
}

static void step_object(struct walk *walk)
{
    uint32_t object = (uint32_t)(voxel_random(&walk->seed) * OBJECTS);
    double kind = voxel_random(&walk->seed);
    const struct scene_node *node = &walk->scene->nodes[walk->first_node + object];
    if (kind < 0.2) {
        scene_set_node_visible(walk->scene, walk->first_node + object, !node->visible);
    } else if (kind < 0.6) { // a little
        float translation[3], rotation[4], scale[3];
        memcpy(translation, node->translation, sizeof(translation));
        memcpy(rotation, node->rotation, sizeof(rotation));
        memcpy(scale, node->scale, sizeof(scale));
        for (int axis = 0; axis < 3; axis++) {
            double at = translation[axis] + in_range(&walk->seed, -0.8, 0.8);
            translation[axis] = (float)fmin(fmax(at, -REACH_M), REACH_M);
        }
        scene_set_node_transform(walk->scene, walk->first_node + object, translation, rotation,
                                 scale);
    } else {
        add_object(walk, object);
    }
}

static float *read_texels(const struct gpu_texture *texture, size_t *out_values)
{
    *out_values = gpu_texture_size_bytes(texture) / 2; // halves
    float *texels = malloc(*out_values * sizeof(float));
    assert_non_null(texels);
    gpu_texture_read(texture, texels, *out_values * sizeof(float));
    return texels;
}

// Counts values of the radiance textures that differ by more than rounding to halves and the order
// of sums explain.
static size_t count_radiance_differences(const struct voxel_volume *a, const struct voxel_volume *b)
{
    size_t count, other, differences = 0, lit = 0;
    float *x = read_texels(a->radiance, &count), *y = read_texels(b->radiance, &other);
    assert_int_equal(count, other);
    for (size_t i = 0; i < count; i++) {
        lit += y[i] > 0.0f;
        differences += !(fabsf(x[i] - y[i]) <= 0.004f + 0.004f * fabsf(y[i]));
    }
    assert_true(lit > 1000);
    free(x);
    free(y);
    return differences;
}

static void compare_with_fresh(struct walk *walk, uint32_t step)
{
    struct voxel_volume *volume = walk->volume;
    struct voxel_volume *fresh =
        voxel_rig_volume(&walk->rig, volume->params.method, EDGE, volume->params.clip_levels);
    voxel_rig_light(&walk->rig, volume);
    voxel_rig_voxelize(&walk->rig, fresh, walk->eye);
    voxel_rig_light(&walk->rig, fresh);
    for (uint32_t i = 0; i < volume->level_count; i++)
        assert_memory_equal(&volume->levels[i], &fresh->levels[i], sizeof(volume->levels[i]));
    assert_memory_equal(volume->anchor, fresh->anchor, sizeof(fresh->anchor));
    struct voxel_records walked = voxel_read_records(volume), now = voxel_read_records(fresh);
    size_t surfels = voxel_count_differences(&walked, &now);
    size_t texels = count_radiance_differences(volume, fresh);
    print_message("  step %u: %zu surfels, %zu differ; %zu values of radiance differ\n", step,
                  now.count, surfels, texels);
    free(walked.records);
    free(now.records);
    voxel_volume_destroy(&fresh);
    if (surfels > 0 || texels > 0)
        fail_msg("the volume that walked is not as a fresh one");
}

static void check_walk(enum gi_method method, bool moves_camera, bool moves_objects, uint64_t seed)
{
    struct walk walk;
    begin_walk(&walk, seed, method);
    for (uint32_t step = 1; step <= STEPS; step++) {
        if (moves_camera)
            step_camera(&walk);
        if (moves_objects)
            step_object(&walk);
        voxel_rig_voxelize(&walk.rig, walk.volume, walk.eye);
        if (step % 7 == 0)
            voxel_rig_light(&walk.rig, walk.volume);
        if (step % CHECK_EVERY == 0)
            compare_with_fresh(&walk, step);
    }
    end_walk(&walk);
}

static void test_camera_walks(void **state)
{
    (void)state;
    check_walk(GI_METHOD_CLIPMAP, true, false, 1);
}

static void test_objects_walk(void **state)
{
    (void)state;
    check_walk(GI_METHOD_CLIPMAP, false, true, 2);
    check_walk(GI_METHOD_GRID, false, true, 3);
}

static void test_camera_and_objects_walk(void **state)
{
    (void)state;
    check_walk(GI_METHOD_CLIPMAP, true, true, 4);
}

static uint32_t voxels_of_level(const struct voxel_volume *volume, uint32_t level)
{
    uint32_t voxels = 0;
    for (uint32_t i = 0; i < volume->dirty[level].count; i++) {
        const struct voxel_box *box = &volume->dirty[level].boxes[i];
        voxels += (uint32_t)((box->high[0] - box->low[0]) * (box->high[1] - box->low[1]) *
                             (box->high[2] - box->low[2]));
    }
    return voxels;
}

// From a position where every level's region is about to move: at most three slabs a level, and one
// on a step along one axis.
static void test_only_what_comes_into_reach_is_voxelized(void **state)
{
    (void)state;
    struct walk walk;
    begin_walk(&walk, 5, GI_METHOD_CLIPMAP);
    uint32_t slab = EDGE * EDGE * SNAP_VOXELS, moved = 0;
    for (uint32_t step = 0; step < 64; step++) {
        float size = (float)walk.volume->levels[0].voxel_edge_m;
        bool diagonal = step >= 32;
        for (int axis = 0; axis < 3; axis++)
            walk.eye[axis] += diagonal || axis == (int)(step % 3) ? size : 0.0f;
        voxel_rig_voxelize(&walk.rig, walk.volume, walk.eye);
        for (uint32_t level = 0; level < CLIP_LEVELS; level++) {
            uint32_t voxels = voxels_of_level(walk.volume, level);
            assert_true(voxels <= (diagonal ? 3 * slab : slab));
            moved += voxels > 0;
        }
        assert_int_equal(voxels_of_level(walk.volume, CLIP_LEVELS - 1), 0);
        voxel_rig_voxelize(&walk.rig, walk.volume, walk.eye);
        assert_int_equal(walk.volume->region_count, 0);
    }
    print_message("  %u moves of levels\n", moved);
    assert_true(moved > 20);
    end_walk(&walk);
}

// An object that moves marks what it leaves and where it goes, and nothing else.
static void test_only_where_objects_move_is_voxelized(void **state)
{
    (void)state;
    struct walk walk;
    begin_walk(&walk, 6, GI_METHOD_CLIPMAP);
    for (uint32_t step = 0; step < 50; step++) {
        struct gpu_scene_instance before = walk.rig.gpu_scene->instances[1];
        add_object(&walk, 0);
        voxel_rig_voxelize(&walk.rig, walk.volume, walk.eye);
        const struct gpu_scene_instance *after = &walk.rig.gpu_scene->instances[1];
        for (uint32_t level = 0; level < CLIP_LEVELS; level++) {
            double edge = walk.volume->levels[level].voxel_edge_m, boxes[2] = {1.0, 1.0};
            for (int axis = 0; axis < 3; axis++) {
                boxes[0] *= (before.bounds_max[axis] - before.bounds_min[axis]) / edge + 6.0;
                boxes[1] *= (after->bounds_max[axis] - after->bounds_min[axis]) / edge + 6.0;
            }
            // Overlapping boxes are merged.
            bool together = walk.volume->dirty[level].count < 2;
            double maximum = boxes[0] + boxes[1];
            assert_true(voxels_of_level(walk.volume, level) <= (together ? 4.0 : 1.0) * maximum);
        }
    }
    end_walk(&walk);
}

static void test_pools_do_not_leak(void **state)
{
    (void)state;
    struct walk walk;
    begin_walk(&walk, 7, GI_METHOD_CLIPMAP);
    uint32_t counters[COUNTER_LISTS], maximum[3] = {0}, taken[3] = {0};
    for (uint32_t step = 0; step < LEAK_STEPS; step++) {
        step_camera(&walk);
        if (step % 2 == 0)
            step_object(&walk);
        voxel_rig_voxelize(&walk.rig, walk.volume, walk.eye);
        if (step % 3 == 0)
            voxel_rig_light(&walk.rig, walk.volume);
        gpu_buffer_read(walk.volume->counters, 0, sizeof(counters), counters);
        const uint32_t pools[3][2] = {{COUNTER_CELLS, COUNTER_FREE_CELLS},
                                      {COUNTER_SURFELS, COUNTER_FREE_SURFELS},
                                      {COUNTER_FACES, COUNTER_FREE_FACES}};
        for (int i = 0; i < 3; i++) {
            // The number of free ones may be below 0 until the free lists are rebuilt.
            int32_t free_ones = (int32_t)counters[pools[i][1]];
            uint32_t used = counters[pools[i][0]] - (uint32_t)(free_ones > 0 ? free_ones : 0);
            maximum[i] = used > maximum[i] ? used : maximum[i];
            taken[i] = counters[pools[i][0]];
        }
        assert_int_equal(counters[COUNTER_OVERFLOW], 0);
    }
    const char *const names[] = {"cells", "surfels", "face records"};
    for (int i = 0; i < 3; i++) {
        print_message("  %s: %u in use at most, %u ever taken\n", names[i], maximum[i], taken[i]);
        assert_true(taken[i] <= maximum[i] + maximum[i] / 20 + 64);
    }
    compare_with_fresh(&walk, LEAK_STEPS);
    end_walk(&walk);
}

// Where lighting found no room for face records, the next voxelization makes room.
static void test_face_records_grow(void **state)
{
    (void)state;
    struct walk walk;
    begin_walk(&walk, 9, GI_METHOD_CLIPMAP);
    uint32_t capacity = walk.volume->face_capacity;
    walk.volume->face_capacity = 100;
    voxel_rig_light(&walk.rig, walk.volume);
    add_object(&walk, 0);
    voxel_rig_voxelize(&walk.rig, walk.volume, walk.eye);
    assert_int_equal(walk.volume->face_capacity, 2 * capacity);
    compare_with_fresh(&walk, 1);
    end_walk(&walk);
}

struct texels {
    const float *values; // 4 each
    uint32_t width, height;
};

static const float *texel_at(const struct texels *texels, const int32_t at[3])
{
    return texels->values +
           4 * (((size_t)at[2] * texels->height + at[1]) * texels->width + (size_t)at[0]);
}

// As a sampler filters: `at` in texels.
static void filter(const struct texels *texels, const double at[3], double out[4])
{
    memset(out, 0, 4 * sizeof(*out));
    for (int i = 0; i < 8; i++) {
        int32_t corner[3];
        double weight = 1.0;
        for (int axis = 0; axis < 3; axis++) {
            double low = floor(at[axis] - 0.5), t = at[axis] - 0.5 - low;
            corner[axis] = (int32_t)low + (i >> axis & 1);
            weight *= i >> axis & 1 ? t : 1.0 - t;
        }
        const float *texel = texel_at(texels, corner);
        for (int c = 0; c < 4; c++)
            out[c] += weight * texel[c];
    }
}

// One face of a level, voxel by voxel as they lie in the world.
static float *unwrap(const struct texels *texels, const struct voxel_level_block *level,
                     uint32_t face)
{
    float *values = malloc(sizeof(float) * 4 * EDGE * EDGE * EDGE);
    assert_non_null(values);
    float *out = values;
    for (int32_t z = 0; z < (int32_t)EDGE; z++)
        for (int32_t y = 0; y < (int32_t)EDGE; y++)
            for (int32_t x = 0; x < (int32_t)EDGE; x++) {
                const int32_t position[3] = {x, y, z};
                int32_t at[3];
                for (int axis = 0; axis < 3; axis++)
                    at[axis] = level->texel_origin[axis] +
                               ((level->origin[axis] + position[axis]) & (int32_t)(EDGE - 1));
                at[0] += level->face_stride * (int32_t)face;
                memcpy(out, texel_at(texels, at), 4 * sizeof(float));
                out += 4;
            }
    return values;
}

// A position in voxels from the level's lowest corner, no nearer to its rim than half a voxel;
// mostly within half a voxel of where addresses wrap around.
static void random_position(uint64_t *seed, const struct voxel_level_block *level, double out[3])
{
    for (int axis = 0; axis < 3; axis++) {
        out[axis] = in_range(seed, 0.5, EDGE - 0.5);
        int32_t seam = -level->origin[axis] & (int32_t)(EDGE - 1);
        if (seam > 0 && voxel_random(seed) < 0.7)
            out[axis] = seam + in_range(seed, -0.5, 0.5);
    }
}

static void test_filtering_across_the_seam(void **state)
{
    (void)state;
    struct walk walk;
    begin_walk(&walk, 8, GI_METHOD_CLIPMAP);
    uint32_t points = 0, filled = 0;
    double largest = 0.0;
    for (uint32_t step = 0; step < 5; step++) {
        // Close to an object.
        const struct scene_node *node = &walk.scene->nodes[walk.first_node + OBJECTS - 1 - step];
        for (int axis = 0; axis < 3; axis++)
            walk.eye[axis] = node->translation[axis] + (float)in_range(&walk.seed, -2.0, 2.0);
        voxel_rig_voxelize(&walk.rig, walk.volume, walk.eye);
        voxel_rig_light(&walk.rig, walk.volume);
        size_t count;
        float *values = read_texels(walk.volume->radiance, &count);
        struct texels texels = {.values = values, .width = gpu_texture_edge(walk.volume->radiance)};
        texels.height = (uint32_t)(count / 4 / texels.width / (EDGE + 2));
        for (uint32_t i = 0; i < CLIP_LEVELS * VOXEL_FACES; i++) {
            const struct voxel_level_block *level = &walk.volume->uniforms.levels[i / VOXEL_FACES];
            uint32_t face = i % VOXEL_FACES;
            float *plain = unwrap(&texels, level, face);
            struct texels straight = {.values = plain, .width = EDGE, .height = EDGE};
            for (uint32_t point = 0; point < 4000; point++) {
                double position[3], at[3], expected[4], found[4];
                random_position(&walk.seed, level, position);
                // As sample_level() in shaders/lib/cone.glsl.
                for (int axis = 0; axis < 3; axis++) {
                    double voxel = level->origin[axis] + position[axis];
                    at[axis] = voxel - floor(voxel / EDGE) * EDGE + level->texel_origin[axis];
                }
                at[0] += (double)level->face_stride * face;
                filter(&texels, at, found);
                // The filter's last neighbour has no weight where it lies beyond the rim.
                for (int axis = 0; axis < 3; axis++)
                    position[axis] = fmin(position[axis], EDGE - 0.5 - 1e-12);
                filter(&straight, position, expected);
                for (int c = 0; c < 4; c++)
                    largest = fmax(largest, fabs(found[c] - expected[c]));
                filled += expected[3] > 0.0;
                points++;
            }
            free(plain);
        }
        free(values);
    }
    print_message("  %u points, %u of them not empty: largest difference %g\n", points, filled,
                  largest);
    assert_true(largest < 1e-9);
    assert_true(filled > 1000);
    end_walk(&walk);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_camera_walks),
        cmocka_unit_test(test_objects_walk),
        cmocka_unit_test(test_camera_and_objects_walk),
        cmocka_unit_test(test_only_what_comes_into_reach_is_voxelized),
        cmocka_unit_test(test_only_where_objects_move_is_voxelized),
        cmocka_unit_test(test_pools_do_not_leak),
        cmocka_unit_test(test_face_records_grow),
        cmocka_unit_test(test_filtering_across_the_seam),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
