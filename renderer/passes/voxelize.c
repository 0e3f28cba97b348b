// Voxelizes the triangles of newly covered regions.
#include "renderer/gi/voxel/voxel_cache.h"
#include "renderer/gpu/program.h"
#include "renderer/hash.h"
#include "renderer/passes/pass.h"

// Groups along x where one dimension cannot hold all groups of a dispatch.
#define ROW_GROUPS 4096u
#define MAX_GROWTH 12
// As in shaders/lib/voxel_work.glsl and shaders/voxel/voxel_lists.comp.
#define REGION_RUN 32u
#define CELL_RUN   16u

enum {
    PROGRAM_CLEAR,
    PROGRAM_SMALL,
    PROGRAM_LARGE,
    PROGRAM_CELLS,
    PROGRAM_REPAIR,
    PROGRAM_LIST,
    PROGRAM_ARGUMENTS,
    PROGRAM_TILES,
    PROGRAM_COUNT
};

// Work groups whose invocations process `run` items each.
static uint32_t groups_of(uint32_t count, uint32_t run)
{
    return (count + LINEAR_GROUP * run - 1) / (LINEAR_GROUP * run);
}

static void dispatch_rows(const struct frame *frame, const struct gpu_program *program,
                          uint32_t groups)
{
    uint32_t rows = (groups + ROW_GROUPS - 1) / ROW_GROUPS;
    gpu_dispatch(frame->gpu, program, rows > 1 ? ROW_GROUPS : groups, rows, 1);
    gpu_barrier(frame->gpu);
}

static void empty_regions(const struct frame *frame, const struct gpu_program *const programs[])
{
    struct voxel_volume *volume = frame->volume;
    if (volume->everything) {
        gpu_buffer_clear(volume->index);
        gpu_buffer_fill(volume->counters, 0, COUNTER_CACHE_LEFT * 4, 0);
        gpu_buffer_fill(volume->counters, COUNTER_FACES * 4, 8, 0);
        gpu_texture_clear(volume->radiance);
        gpu_barrier(frame->gpu);
    } else {
        // Light injection may have taken more face records than were free.
        gpu_dispatch(frame->gpu, programs[PROGRAM_REPAIR], 1, 1, 1);
        gpu_barrier(frame->gpu);
        dispatch_rows(frame, programs[PROGRAM_CLEAR], groups_of(volume->region_voxels, REGION_RUN));
    }
    gpu_buffer_fill(volume->counters, COUNTER_TILES * 4, 4, 0);
}

static void enter_triangles(const struct frame *frame, const struct gpu_program *const programs[])
{
    struct voxel_volume *volume = frame->volume;
    dispatch_rows(frame, programs[PROGRAM_SMALL], volume->batch_count);
    gpu_dispatch(frame->gpu, programs[PROGRAM_TILES], 1, 1, 1);
    gpu_barrier(frame->gpu);
    gpu_dispatch_indirect(frame->gpu, programs[PROGRAM_LARGE], volume->counters, COUNTER_TILES * 4);
    gpu_barrier(frame->gpu);
}

static void make_cells(const struct frame *frame, const struct gpu_program *const programs[])
{
    dispatch_rows(frame, programs[PROGRAM_CELLS],
                  groups_of(frame->volume->region_voxels, REGION_RUN));
}

// Before cells are listed.
static void empty_lists(const struct frame *frame, const struct gpu_program *const programs[])
{
    struct voxel_volume *volume = frame->volume;
    gpu_dispatch(frame->gpu, programs[PROGRAM_REPAIR], 1, 1, 1);
    gpu_barrier(frame->gpu);
    if (volume->dirty[volume->cell_level_count - 1].count == 0)
        return; // mips of the coarsest level have not changed
    size_t first = volume->list_words - volume->mip_words;
    gpu_buffer_fill(volume->lists, first * 4, volume->mip_words * 4, 0);
}

static struct cache_key key_of(const struct frame *frame,
                               const struct gpu_program *const programs[])
{
    uint64_t hash = HASH_START;
    for (uint32_t i = 0; i < PROGRAM_COUNT; i++)
        hash = hash_word(hash, gpu_program_source_hash(programs[i]));
    return voxel_cache_key(frame->volume, frame->gpu_scene, hash);
}

// Fills the regions with what is in them. Returns whether that is worth keeping under *out_key.
static bool fill_regions(const struct frame *frame, const struct gpu_program *const programs[],
                         struct cache_key *out_key)
{
    bool cached = voxel_cache_applies(frame->volume);
    empty_regions(frame, programs);
    if (cached)
        *out_key = key_of(frame, programs);
    if (cached && voxel_cache_restore(frame->volume, out_key)) {
        empty_lists(frame, programs);
        return false;
    }
    enter_triangles(frame, programs);
    make_cells(frame, programs);
    empty_lists(frame, programs);
    return cached;
}

static bool voxelize_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    struct voxel_volume *volume = frame->volume;
    const struct gpu_program *programs[PROGRAM_COUNT];
    if (!pass_programs(frame, pass, programs, out_error))
        return false;
    for (int attempt = 0; attempt < MAX_GROWTH; attempt++) {
        struct cache_key key;
        bool keep = fill_regions(frame, programs, &key);
        enum voxel_room room = voxel_volume_check_room(volume);
        if (room == VOXEL_ROOM_ENOUGH) {
            if (keep)
                voxel_cache_keep(volume, &key);
            dispatch_rows(frame, programs[PROGRAM_LIST], groups_of(volume->cell_count, CELL_RUN));
            gpu_dispatch(frame->gpu, programs[PROGRAM_ARGUMENTS], 1, 1, 1);
            volume->everything = false;
            volume->voxelized = true;
            return true;
        }
        if (room == VOXEL_ROOM_NONE ||
            !voxel_volume_update(volume, frame->gpu_scene, frame->camera.eye))
            break;
        voxel_volume_bind(volume);
    }
    volume->laid_out = false;
    return error_set(out_error, "the scene's voxels do not fit into GPU memory; choose a lower "
                                "voxel_resolution");
}

#define EFFECTS  (EFFECT_BIT(EFFECT_VERTEX_COLORS) | EFFECT_BIT(EFFECT_VOXEL_COLORS))
#define SWITCHES (TEXTURE_SWITCHES | SWITCH_BIT(VOXEL_DIRECTIONS))

const struct pass voxelize_pass = {
    .reads = RESOURCE(GEOMETRY) | RESOURCE(SCENE_TABLES) | RESOURCE(TEXTURES),
    .writes = RESOURCE(VOXELS) | RESOURCE(IRRADIANCE) | RESOURCE(VOXEL_RADIANCE),
    .program_count = PROGRAM_COUNT,
    .programs = {[PROGRAM_CLEAR] = {"voxel/voxel_clear.comp", EFFECTS, SWITCHES, NULL},
                 [PROGRAM_SMALL] = {"voxel/voxelize.comp", EFFECTS, SWITCHES, "LARGE 0\n"},
                 [PROGRAM_LARGE] = {"voxel/voxelize.comp", EFFECTS, SWITCHES, "LARGE 1\n"},
                 [PROGRAM_CELLS] = {"voxel/voxel_cells.comp", EFFECTS, SWITCHES, NULL},
                 [PROGRAM_REPAIR] = {"voxel/voxel_lists.comp", EFFECTS, SWITCHES,
                                     "STAGE LISTS_RESET\n"},
                 [PROGRAM_LIST] = {"voxel/voxel_lists.comp", EFFECTS, SWITCHES,
                                   "STAGE LISTS_APPEND\n"},
                 [PROGRAM_ARGUMENTS] = {"voxel/voxel_lists.comp", EFFECTS, SWITCHES,
                                        "STAGE LISTS_ARGUMENTS\n"},
                 [PROGRAM_TILES] = {"voxel/voxel_lists.comp", EFFECTS, SWITCHES,
                                    "STAGE LISTS_TILE_ARGUMENTS\n"}},
    .run = voxelize_run,
};
