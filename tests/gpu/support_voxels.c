#include "support_voxels.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "renderer/frame/frame_block.h"
#include "renderer/gi/gi_method.h"
#include "support_gpu.h"

#define BOUND_M 30.0f
#define SPECK_M 0.001f

void voxel_rig_init(struct voxel_rig *rig, struct scene *scene)
{
    struct error error = {""};
    memset(rig, 0, sizeof(*rig));
    rig->gpu = gpu_create("auto", test_shader_dir(), &error);
    if (!rig->gpu)
        fail_msg("%s", error.message);
    assert_true(passes_prepare_gpu(rig->gpu));
    scene_update_world_transforms(scene);
    rig->gpu_scene = gpu_scene_create(rig->gpu, scene, &error);
    if (!rig->gpu_scene)
        fail_msg("%s", error.message);
    rig->view = view_create(rig->gpu);
    assert_non_null(rig->view);
    rig->params = test_params(16, 16, FRAME_OUTPUT_LINEAR);
}

void voxel_rig_finish(struct voxel_rig *rig)
{
    uint64_t errors = gpu_error_count(rig->gpu);
    view_destroy(&rig->view);
    gpu_scene_destroy(&rig->gpu_scene);
    gpu_destroy(&rig->gpu);
    assert_int_equal(errors, 0);
}

struct voxel_volume *voxel_rig_volume(struct voxel_rig *rig, enum gi_method method, uint32_t edge,
                                      uint32_t clip_levels)
{
    struct voxel_volume *volume = voxel_volume_create(rig->gpu, &(struct voxel_volume_params){
                                                                    .method = method,
                                                                    .edge = edge,
                                                                    .clip_levels = clip_levels,
                                                                    .directions = VOXEL_ANISOTROPIC,
                                                                    .cache_cones = 16,
                                                                });
    assert_non_null(volume);
    volume->scale = 1.0f;
    return volume;
}

// A frame that does `work` with the volume and nothing else.
static struct frame begin(struct voxel_rig *rig, struct voxel_volume *volume,
                          struct voxel_light_work work)
{
    const struct gi_state gi = {.level_count = volume->level_count,
                                .cell_level_count = volume->cell_level_count,
                                .work = work};
    rig->params.settings.gi_method = volume->params.method;
    const struct frame_inputs inputs = {
        .params = &rig->params,
        .revisions = &rig->gpu_scene->scene->revisions,
        .history = &rig->view->history,
        .scene = gpu_scene_get_facts(rig->gpu_scene),
        .gi_capabilities = gi_methods[volume->params.method]->capabilities,
        .gi = &gi,
    };
    frame_plan_make(&rig->view->plan, &inputs);
    return (struct frame){
        .gpu = rig->gpu,
        .gpu_scene = rig->gpu_scene,
        .view = rig->view,
        .params = &rig->params,
        .camera = rig->params.camera,
        .plan = &rig->view->plan,
        .volume = volume,
        .gi = gi,
    };
}

static void bind(struct voxel_rig *rig, struct voxel_volume *volume)
{
    struct frame_block block = {0};
    block.texture_max_anisotropy = 1.0f;
    frame_block_fill_tables(&rig->gpu_scene->tables, &block);
    gpu_buffer_write(rig->view->frame_block, 0, sizeof(block), &block);
    gpu_scene_bind(rig->gpu_scene);
    view_bind(rig->view);
    voxel_volume_bind(volume);
}

static void run(struct frame *frame, const struct pass *pass)
{
    struct error error = {""};
    if (!pass->run(frame, pass, &error))
        fail_msg("%s", error.message);
    gpu_barrier(frame->gpu);
}

void voxel_rig_voxelize(struct voxel_rig *rig, struct voxel_volume *volume, const float eye[3])
{
    struct error error = {""};
    if (!gpu_scene_update(rig->gpu_scene, &error))
        fail_msg("%s", error.message);
    memcpy(rig->params.camera.eye, eye, sizeof(rig->params.camera.eye));
    assert_true(voxel_volume_update(volume, rig->gpu_scene, eye));
    struct frame frame = begin(rig, volume, (struct voxel_light_work){.voxelize = true});
    bind(rig, volume);
    if (volume->region_count > 0)
        run(&frame, &voxelize_pass);
}

void voxel_rig_light(struct voxel_rig *rig, struct voxel_volume *volume)
{
    const struct voxel_light_work work = {
        .relight = true, .direct = true, .relight_end = volume->cell_level_count};
    struct frame frame = begin(rig, volume, work);
    bind(rig, volume);
    run(&frame, &voxel_relight_pass);
    run(&frame, &voxel_filter_pass);
}

static uint32_t *read_words(const struct gpu_buffer *buffer)
{
    size_t size_bytes = gpu_buffer_size_bytes(buffer);
    uint32_t *words = malloc(size_bytes);
    assert_non_null(words);
    gpu_buffer_read(buffer, 0, size_bytes, words);
    return words;
}

static int compare_records(const void *a, const void *b)
{
    const struct voxel_record *x = a, *y = b;
    if (x->level != y->level)
        return x->level < y->level ? -1 : 1;
    for (int axis = 2; axis >= 0; axis--)
        if (x->voxel[axis] != y->voxel[axis])
            return x->voxel[axis] < y->voxel[axis] ? -1 : 1;
    return (x->words[0] > y->words[0]) - (x->words[0] < y->words[0]);
}

static void find_voxel(const struct voxel_volume *volume, uint32_t level, uint32_t slot,
                       int32_t out_voxel[3])
{
    const struct voxel_level *it = &volume->levels[level];
    int32_t edge = (int32_t)it->edge;
    int32_t at[3] = {(int32_t)slot % edge, (int32_t)slot / edge % edge,
                     (int32_t)slot / edge / edge};
    for (int axis = 0; axis < 3; axis++) {
        int32_t low = it->box.low[axis];
        bool wraps = volume->params.method == GI_METHOD_CLIPMAP;
        out_voxel[axis] = low + (wraps ? (at[axis] - low) & (edge - 1) : at[axis]);
    }
}

static void add_record(struct voxel_records *list, size_t *capacity,
                       const struct voxel_record *record)
{
    if (list->count == *capacity) {
        *capacity = *capacity ? 2 * *capacity : 4096;
        list->records = realloc(list->records, *capacity * sizeof(*list->records));
        assert_non_null(list->records);
    }
    list->records[list->count++] = *record;
}

struct voxel_records voxel_read_records(const struct voxel_volume *volume)
{
    struct voxel_records list = {0};
    size_t capacity = 0;
    uint32_t *index = read_words(volume->index), *cells = read_words(volume->cells);
    uint32_t *surfels = read_words(volume->surfels);
    for (uint32_t level = 0; level < volume->cell_level_count; level++) {
        uint32_t edge = volume->levels[level].edge, slots = edge * edge * edge;
        for (uint32_t slot = 0; slot < slots; slot++) {
            uint32_t entry = index[level * slots + slot];
            if (entry == 0)
                continue;
            const uint32_t *cell = &cells[(size_t)(entry - 1) * CELL_WORDS];
            assert_int_equal(cell[0], slot | (level << CELL_LEVEL_BIT));
            struct voxel_record record = {.level = level};
            find_voxel(volume, level, slot, record.voxel);
            for (uint32_t at = cell[CELL_SURFEL]; at != VOXEL_NONE;) {
                const uint32_t *surfel = &surfels[(size_t)at * SURFEL_WORDS];
                memcpy(record.words, surfel + SURFEL_KEY, sizeof(record.words));
                add_record(&list, &capacity, &record);
                at = surfel[SURFEL_NEXT];
            }
        }
    }
    free(index);
    free(cells);
    free(surfels);
    if (list.count > 0)
        qsort(list.records, list.count, sizeof(*list.records), compare_records);
    return list;
}

uint32_t voxel_record_word(const struct voxel_record *record, uint32_t surfel_word)
{
    return record->words[surfel_word - SURFEL_KEY];
}

static void print_record(const char *what, const struct voxel_record *record)
{
    print_message("      %s level %u voxel %d %d %d key %u mask %02x weight %u\n", what,
                  record->level, record->voxel[0], record->voxel[1], record->voxel[2],
                  voxel_record_word(record, SURFEL_KEY), voxel_record_word(record, SURFEL_MASK),
                  voxel_record_word(record, SURFEL_WEIGHT));
}

size_t voxel_count_differences(const struct voxel_records *a, const struct voxel_records *b)
{
    size_t differences = 0, i = 0, j = 0;
    while (i < a->count || j < b->count) {
        int order = i == a->count   ? 1
                    : j == b->count ? -1
                                    : compare_records(&a->records[i], &b->records[j]);
        bool same =
            order == 0 && memcmp(&a->records[i], &b->records[j], sizeof(struct voxel_record)) == 0;
        if (!same && differences++ < 4) {
            if (order <= 0)
                print_record("first: ", &a->records[i]);
            if (order >= 0)
                print_record("second:", &b->records[j]);
        }
        i += order <= 0;
        j += order >= 0;
    }
    return differences;
}

double voxel_random(uint64_t *state)
{
    *state = *state * 6364136223846793005ull + 1442695040888963407ull;
    return (double)(*state >> 11) / 9007199254740992.0;
}

uint32_t voxel_scene_add(struct scene *scene, const float *triangles, uint32_t count,
                         const float *colors, uint32_t material)
{
    struct scene_vertex *vertices = calloc((size_t)count * 3, sizeof(*vertices));
    uint32_t *indices = calloc((size_t)count * 3, sizeof(*indices));
    assert_non_null(vertices);
    assert_non_null(indices);
    for (uint32_t i = 0; i < 3 * count; i++) {
        struct scene_vertex *vertex = &vertices[i];
        memcpy(vertex->position, triangles + (size_t)3 * i, sizeof(vertex->position));
        vertex->normal[2] = 1.0f;
        vertex->tangent[0] = 1.0f;
        vertex->tangent[3] = 1.0f;
        vertex->color[3] = 1.0f;
        for (size_t c = 0; c < 3; c++)
            vertex->color[c] = colors ? colors[(size_t)(i / 3) * 3 + c] : 1.0f;
        indices[i] = i;
    }
    uint32_t mesh = scene_add_mesh(scene, "triangles");
    assert_int_not_equal(
        scene_add_primitive(scene, vertices, 3 * count, indices, 3 * count, material), SCENE_NONE);
    free(vertices);
    free(indices);
    uint32_t node = scene_add_node(scene, "triangles", SCENE_NONE);
    assert_int_not_equal(node, SCENE_NONE);
    scene->nodes[node].mesh = mesh;
    return node;
}

struct scene *voxel_scene_create(void)
{
    struct scene *scene = scene_create("voxels");
    assert_non_null(scene);
    struct scene_material material;
    scene_material_init(&material, "glowing");
    material.metallic = 0.0f;
    material.ior = 1.0f;
    for (int c = 0; c < 3; c++)
        material.emissive[c] = 1.0f;
    material.emissive_strength = 1.0f;
    assert_int_equal(scene_add_material(scene, &material), 0);
    const float a = BOUND_M, b = BOUND_M - SPECK_M;
    const float specks[18] = {-a, -a, -a, -b, -a, -a, -a, -b, -b, //
                              a,  a,  a,  b,  a,  a,  a,  b,  b};
    voxel_scene_add(scene, specks, 2, NULL, 0);
    return scene;
}

float voxel_scene_anchor(void)
{
    return (float)(1.0 / 3.0);
}
