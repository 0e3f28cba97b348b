// Proves that voxels are exact: a triangle is recorded in a voxel, and in each of its eight halves,
// if and only if it overlaps that closed cube. Each triangle is an object of its own, so that its
// voxels can be told apart. The expected voxels are found by testing all voxels around it on the 13
// separating axes of a triangle and a cube, in double precision. Also proves that neither the order
// of triangles nor the number of threads changes anything.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "renderer/hash.h"
#include "support_voxels.h"

#define EDGE      64u
#define TRIANGLES 360u
#define KINDS     9u
#define INSIDE_M  29.0
#define PERMUTED  4000u

static double in_range(uint64_t *seed, double low, double high)
{
    return low + (high - low) * voxel_random(seed);
}

static void random_corners(uint64_t *seed, double center_range, double size, float out[9])
{
    double center[3];
    for (int axis = 0; axis < 3; axis++)
        center[axis] = in_range(seed, -center_range, center_range);
    for (int i = 0; i < 9; i++)
        out[i] = (float)(center[i % 3] + in_range(seed, -size, size));
}

// Moves corners to the nearest multiples of `step`.
static void snap(float corners[9], float step)
{
    for (int i = 0; i < 9; i++)
        corners[i] = step * roundf(corners[i] / step);
}

// A triangle of a kind, in metres, which are voxels of the coarser level, from the anchor.
static void make_triangle(uint64_t *seed, uint32_t kind, float out[9])
{
    int axis = (int)(3.0 * voxel_random(seed));
    switch (kind) {
    case 0: // some voxels large
        random_corners(seed, 14.0, 4.0, out);
        break;
    case 1: // tiny, many within one voxel
        random_corners(seed, 15.0, 0.05, out);
        break;
    case 2: // slivers
        random_corners(seed, 8.0, 7.0, out);
        for (int i = 0; i < 3; i++)
            out[6 + i] = 0.5f * (out[i] + out[3 + i]) + (float)in_range(seed, -1e-3, 1e-3);
        break;
    case 3: // from end to end
        for (int i = 0; i < 9; i++)
            out[i] = (float)((voxel_random(seed) < 0.5 ? -1.0 : 1.0) *
                             in_range(seed, 0.5 * INSIDE_M, INSIDE_M));
        break;
    case 4: // along an axis, between voxels' faces
        random_corners(seed, 10.0, 6.0, out);
        for (int i = 1; i < 3; i++)
            out[3 * i + axis] = out[axis];
        break;
    case 5: // corners on voxels' corners
        random_corners(seed, 10.0, 5.0, out);
        snap(out, 1.0f);
        break;
    case 6: // in a plane between voxels, edges along voxels' edges and diagonals
        random_corners(seed, 10.0, 5.0, out);
        snap(out, 1.0f);
        for (int i = 1; i < 3; i++)
            out[3 * i + axis] = out[axis];
        break;
    case 7: // corners on the corners of halves of the finer level
        random_corners(seed, 12.0, 2.0, out);
        snap(out, 0.25f);
        break;
    default: // mirrored and scaled by their nodes
        random_corners(seed, 1.0, 1.0, out);
        break;
    }
}

static bool has_area(const float corners[9])
{
    double e[3], f[3];
    for (int axis = 0; axis < 3; axis++) {
        e[axis] = (double)corners[3 + axis] - corners[axis];
        f[axis] = (double)corners[6 + axis] - corners[axis];
    }
    double x = e[1] * f[2] - e[2] * f[1], y = e[2] * f[0] - e[0] * f[2];
    return fabs(x) + fabs(y) + fabs(e[0] * f[1] - e[1] * f[0]) > 1e-9;
}

static void set_transform(struct scene_node *node, uint64_t *seed, bool mirrored)
{
    float anchor = voxel_scene_anchor();
    for (int axis = 0; axis < 3; axis++) {
        node->translation[axis] = anchor;
        if (!mirrored)
            continue;
        node->translation[axis] = (float)in_range(seed, -12.0, 12.0);
        node->scale[axis] = (float)in_range(seed, 0.3, 4.0) * (axis == 0 ? -1.0f : 1.0f);
    }
    if (mirrored) {
        float angle = (float)in_range(seed, 0.0, 3.0);
        const float turned[4] = {0.6f * sinf(angle), 0.8f * sinf(angle), 0.0f, cosf(angle)};
        memcpy(node->rotation, turned, sizeof(turned));
    }
}

// The corners in voxels of a level, as the shader finds them.
static void corners_in_voxels(const struct scene *scene, uint32_t node, double voxel_edge_m,
                              double out[3][3])
{
    const float *m = scene->nodes[node].world_from_local;
    const struct scene_mesh *mesh = &scene->meshes[scene->nodes[node].mesh];
    const struct scene_primitive *primitive = &scene->primitives[mesh->primitive_first];
    for (uint32_t i = 0; i < 3; i++) {
        const float *p = scene->vertices[scene->indices[primitive->index_first + i]].position;
        for (int row = 0; row < 3; row++) {
            double world = (double)m[row] * p[0] + (double)m[4 + row] * p[1] +
                           (double)m[8 + row] * p[2] + m[12 + row];
            out[i][row] = (world - (double)voxel_scene_anchor()) / voxel_edge_m;
        }
    }
}

static bool separates(const double axis[3], const double v[3][3], const double low[3], double edge)
{
    double box_min = 0.0, box_max = 0.0, minimum = INFINITY, maximum = -INFINITY;
    for (int i = 0; i < 3; i++) {
        double a = axis[i] * low[i], b = axis[i] * (low[i] + edge);
        box_min += fmin(a, b);
        box_max += fmax(a, b);
        double at = axis[0] * v[i][0] + axis[1] * v[i][1] + axis[2] * v[i][2];
        minimum = fmin(minimum, at);
        maximum = fmax(maximum, at);
    }
    return maximum < box_min || minimum > box_max;
}

// Whether the triangle overlaps the closed cube [low, low + edge]^3.
static bool overlaps(const double v[3][3], const double low[3], double edge)
{
    double edges[3][3], relative[3][3];
    const double origin[3] = {0.0, 0.0, 0.0};
    for (int i = 0; i < 3; i++)
        for (int axis = 0; axis < 3; axis++) {
            edges[i][axis] = v[(i + 1) % 3][axis] - v[i][axis];
            relative[i][axis] = v[i][axis] - low[axis];
        }
    for (int axis = 0; axis < 3; axis++) {
        double unit[3] = {axis == 0, axis == 1, axis == 2};
        if (separates(unit, relative, origin, edge))
            return false;
        for (int i = 0; i < 3; i++) {
            double *e = edges[i];
            double cross[3] = {unit[1] * e[2] - unit[2] * e[1], unit[2] * e[0] - unit[0] * e[2],
                               unit[0] * e[1] - unit[1] * e[0]};
            if (separates(cross, relative, origin, edge))
                return false;
        }
    }
    double *e = edges[0], *f = edges[1];
    double normal[3] = {e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2],
                        e[0] * f[1] - e[1] * f[0]};
    return !separates(normal, relative, origin, edge);
}

static uint32_t expected_mask(const double v[3][3], const int32_t voxel[3])
{
    uint32_t mask = 0;
    for (uint32_t i = 0; i < 8; i++) {
        double low[3] = {voxel[0] + 0.5 * (i & 1), voxel[1] + 0.5 * (i >> 1 & 1),
                         voxel[2] + 0.5 * (i >> 2)};
        mask |= (uint32_t)overlaps(v, low, 0.5) << i;
    }
    double low[3] = {voxel[0], voxel[1], voxel[2]};
    assert_int_equal(mask != 0, overlaps(v, low, 1.0));
    return mask;
}

struct comparison {
    size_t voxels; // that are occupied
    size_t wrong;
};

// Compares one triangle in one level: `masks` is what the volume holds, one byte a voxel.
static void compare_triangle(const double v[3][3], const struct voxel_box *level,
                             const uint8_t *masks, struct comparison *result)
{
    struct voxel_box box;
    int32_t edge = level->high[0] - level->low[0];
    for (int axis = 0; axis < 3; axis++) {
        double low = fmin(v[0][axis], fmin(v[1][axis], v[2][axis]));
        double high = fmax(v[0][axis], fmax(v[1][axis], v[2][axis]));
        box.low[axis] = (int32_t)fmax(floor(low) - 2.0, level->low[axis]);
        box.high[axis] = (int32_t)fmin(ceil(high) + 2.0, level->high[axis]);
    }
    int32_t at[3];
    for (at[2] = box.low[2]; at[2] < box.high[2]; at[2]++)
        for (at[1] = box.low[1]; at[1] < box.high[1]; at[1]++)
            for (at[0] = box.low[0]; at[0] < box.high[0]; at[0]++) {
                uint32_t expected = expected_mask(v, at);
                size_t slot =
                    (size_t)((at[2] - level->low[2]) * edge + at[1] - level->low[1]) * edge +
                    at[0] - level->low[0];
                result->voxels += expected != 0;
                result->wrong += masks[slot] != expected;
                if (masks[slot] != expected && result->wrong < 5)
                    print_message("  voxel %d %d %d holds %02x, expected %02x\n", at[0], at[1],
                                  at[2], masks[slot], expected);
            }
}

static size_t collect_masks(const struct voxel_records *records, uint32_t level, uint32_t surface,
                            const struct voxel_box *box, uint8_t *masks)
{
    size_t found = 0, edge = (size_t)(box->high[0] - box->low[0]);
    memset(masks, 0, edge * edge * edge);
    for (size_t i = 0; i < records->count; i++) {
        const struct voxel_record *record = &records->records[i];
        if (record->level != level || voxel_record_word(record, SURFEL_KEY) >> 3 != surface)
            continue;
        size_t x = (size_t)(record->voxel[0] - box->low[0]);
        size_t y = (size_t)(record->voxel[1] - box->low[1]);
        size_t z = (size_t)(record->voxel[2] - box->low[2]);
        masks[(z * edge + y) * edge + x] |= (uint8_t)voxel_record_word(record, SURFEL_MASK);
        found++;
    }
    return found;
}

// Volume and reference of `scene`, whose nodes from `first` on hold one triangle each.
static void check_scene(struct voxel_rig *rig, const struct scene *scene, uint32_t first,
                        uint32_t tile_capacity)
{
    struct voxel_volume *volume = voxel_rig_volume(rig, GI_METHOD_CLIPMAP, EDGE, 2);
    const float eye[3] = {1.7f, -2.3f, 0.4f};
    voxel_rig_voxelize(rig, volume, eye);
    if (tile_capacity > 0) { // then triangles that find no room are walked whole
        volume->tile_capacity = tile_capacity;
        volume->everything = true;
        voxel_rig_voxelize(rig, volume, eye);
    }
    assert_int_equal(volume->cell_level_count, 2);
    assert_true(volume->levels[1].voxel_edge_m == 1.0);
    assert_true(volume->anchor[0] == (double)voxel_scene_anchor());
    struct voxel_records records = voxel_read_records(volume);
    uint8_t *masks = malloc((size_t)EDGE * EDGE * EDGE);
    assert_non_null(masks);
    struct comparison kinds[KINDS] = {0};
    size_t held = 0, expected = 0, wrong = 0;
    for (uint32_t level = 0; level < 2; level++)
        for (uint32_t node = first; node < scene->node_count; node++) {
            double v[3][3];
            corners_in_voxels(scene, node, volume->levels[level].voxel_edge_m, v);
            held += collect_masks(&records, level, node, &volume->levels[level].box, masks);
            compare_triangle(v, &volume->levels[level].box, masks, &kinds[(node - first) % KINDS]);
        }
    for (uint32_t kind = 0; kind < KINDS; kind++) {
        print_message("  kind %u: %zu voxels, %zu wrong\n", kind, kinds[kind].voxels,
                      kinds[kind].wrong);
        expected += kinds[kind].voxels;
        wrong += kinds[kind].wrong;
    }
    free(masks);
    free(records.records);
    voxel_volume_destroy(&volume);
    assert_int_equal(wrong, 0);
    assert_int_equal(held, expected); // none outside the reference's boxes
}

static void test_voxels_are_those_that_triangles_overlap(void **state)
{
    (void)state;
    struct scene *scene = voxel_scene_create();
    uint32_t first = scene->node_count;
    uint64_t seed = 11;
    for (uint32_t i = 0; i < TRIANGLES; i++) {
        float corners[9];
        do
            make_triangle(&seed, i % KINDS, corners);
        while (!has_area(corners));
        uint32_t node = voxel_scene_add(scene, corners, 1, NULL, 0);
        set_transform(&scene->nodes[node], &seed, i % KINDS == 8);
    }
    struct voxel_rig rig;
    voxel_rig_init(&rig, scene);
    check_scene(&rig, scene, first, 0);
    check_scene(&rig, scene, first, 5);
    voxel_rig_finish(&rig);
    scene_destroy(&scene);
}

static void test_what_has_no_area_is_nowhere(void **state)
{
    (void)state;
    struct scene *scene = voxel_scene_create();
    const float corners[2][9] = {{1, 1, 1, 1, 1, 1, 1, 1, 1}, {1, 1, 1, 4, 4, 4, 2, 2, 2}};
    for (int i = 0; i < 2; i++)
        voxel_scene_add(scene, corners[i], 1, NULL, 0);
    struct voxel_rig rig;
    voxel_rig_init(&rig, scene);
    struct voxel_volume *volume = voxel_rig_volume(&rig, GI_METHOD_GRID, EDGE, 0);
    voxel_rig_voxelize(&rig, volume, (const float[3]){0, 0, 0});
    struct voxel_records records = voxel_read_records(volume);
    for (size_t i = 0; i < records.count; i++)
        assert_int_equal(voxel_record_word(&records.records[i], SURFEL_KEY) >> 3, 0);
    assert_true(records.count > 0);
    free(records.records);
    voxel_volume_destroy(&volume);
    voxel_rig_finish(&rig);
    scene_destroy(&scene);
}

// A coloured heap of triangles of all sizes; `turn` shuffles their order.
static struct scene *heap_scene(uint64_t turn)
{
    float *triangles = malloc(sizeof(float) * 9 * PERMUTED);
    float *colors = malloc(sizeof(float) * 3 * PERMUTED);
    assert_non_null(triangles);
    assert_non_null(colors);
    uint64_t seed = 23;
    for (uint32_t i = 0; i < PERMUTED; i++) {
        double size = exp2(in_range(&seed, -4.0, 3.5));
        random_corners(&seed, 18.0, size, triangles + (size_t)9 * i);
        for (uint32_t c = 0; c < 3; c++)
            colors[3 * i + c] = (float)voxel_random(&seed);
    }
    for (uint32_t i = PERMUTED - 1; turn && i > 0; i--) {
        uint32_t j = (uint32_t)(voxel_random(&turn) * (i + 1));
        for (uint32_t k = 0; k < 9; k++) {
            float swapped = triangles[9 * i + k];
            triangles[9 * i + k] = triangles[9 * j + k];
            triangles[9 * j + k] = swapped;
        }
        for (uint32_t k = 0; k < 3; k++) {
            float swapped = colors[3 * i + k];
            colors[3 * i + k] = colors[3 * j + k];
            colors[3 * j + k] = swapped;
        }
    }
    struct scene *scene = voxel_scene_create();
    voxel_scene_add(scene, triangles, PERMUTED, colors, 0);
    free(triangles);
    free(colors);
    return scene;
}

static struct voxel_records heap_records(uint64_t turn)
{
    struct scene *scene = heap_scene(turn);
    struct voxel_rig rig;
    voxel_rig_init(&rig, scene);
    struct voxel_volume *volume = voxel_rig_volume(&rig, GI_METHOD_CLIPMAP, EDGE, 2);
    voxel_rig_voxelize(&rig, volume, (const float[3]){1, 2, 3});
    struct voxel_records records = voxel_read_records(volume);
    voxel_volume_destroy(&volume);
    voxel_rig_finish(&rig);
    scene_destroy(&scene);
    return records;
}

static void test_order_changes_nothing(void **state)
{
    (void)state;
    struct voxel_records plain = heap_records(0);
    print_message("  %zu surfels\n", plain.count);
    assert_true(plain.count > 20000);
    for (uint64_t turn = 1; turn <= 3; turn++) {
        struct voxel_records shuffled = heap_records(turn);
        assert_int_equal(voxel_count_differences(&plain, &shuffled), 0);
        free(shuffled.records);
    }
    free(plain.records);
}

static uint64_t digest(const struct voxel_records *records)
{
    return hash_bytes(HASH_START, records->records, records->count * sizeof(*records->records));
}

static int print_digest(void)
{
    struct voxel_records records = heap_records(0);
    printf("digest %016llx\n", (unsigned long long)digest(&records));
    free(records.records);
    return 0;
}

// Mesa reads LP_NUM_THREADS once a process.
static void test_threads_change_nothing(void **state)
{
    (void)state;
    struct voxel_records plain = heap_records(0);
    char expected[64], path[4096], command[4200], line[64];
    snprintf(expected, sizeof(expected), "digest %016llx\n", (unsigned long long)digest(&plain));
    free(plain.records);
    ssize_t length = readlink("/proc/self/exe", path, sizeof(path) - 1);
    assert_true(length > 0);
    path[length] = '\0';
    for (int threads = 0; threads <= 4; threads++) {
        snprintf(command, sizeof(command), "LP_NUM_THREADS=%d '%s' digest", threads, path);
        FILE *output = popen(command, "r");
        assert_non_null(output);
        bool found = false;
        while (fgets(line, sizeof(line), output))
            found = found || strcmp(line, expected) == 0;
        assert_int_equal(pclose(output), 0);
        if (!found)
            fail_msg("with %d threads voxels differ", threads);
    }
}

int main(int argc, char **argv)
{
    if (argc > 1 && strcmp(argv[1], "digest") == 0)
        return print_digest();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_voxels_are_those_that_triangles_overlap),
        cmocka_unit_test(test_what_has_no_area_is_nowhere),
        cmocka_unit_test(test_order_changes_nothing),
        cmocka_unit_test(test_threads_change_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
