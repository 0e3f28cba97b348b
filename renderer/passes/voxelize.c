// Voxelizes the triangles of newly covered regions.
#include "renderer/gi/voxel/volume.h"
#include "renderer/passes/pass.h"

// Groups along x where one dimension cannot hold all groups of a dispatch.
#define ROW_GROUPS 4096u
#define MAX_GROWTH 12
// As in shaders/lib/voxel_work.glsl and shaders/voxel/voxel_lists.comp.
#define REGION_RUN 32u
#define CELL_RUN   16u

static const char *voxelize_skip_reason(const struct frame *frame)
{
    if (!frame_has_cones(frame))
        return "no effect needs voxels";
    return frame->light_work.voxelize ? NULL : "geometry and clip levels unmoved";
}

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

struct voxelize_programs {
    const struct gpu_program *clear, *small, *large, *cells, *repair, *list, *arguments, *tiles;
};

static bool get_programs(const struct frame *frame, const struct pass *pass,
                         struct voxelize_programs *programs, struct error *out_error)
{
    const struct {
        const struct gpu_program **program;
        const char *shader, *extra;
    } wanted[] = {
        {&programs->clear, "voxel/voxel_clear.comp", ""},
        {&programs->small, "voxel/voxelize.comp", "LARGE 0\n"},
        {&programs->large, "voxel/voxelize.comp", "LARGE 1\n"},
        {&programs->cells, "voxel/voxel_cells.comp", ""},
        {&programs->repair, "voxel/voxel_lists.comp", "STAGE LISTS_RESET\n"},
        {&programs->list, "voxel/voxel_lists.comp", "STAGE LISTS_APPEND\n"},
        {&programs->arguments, "voxel/voxel_lists.comp", "STAGE LISTS_ARGUMENTS\n"},
        {&programs->tiles, "voxel/voxel_lists.comp", "STAGE LISTS_TILE_ARGUMENTS\n"},
    };
    for (size_t i = 0; i < sizeof(wanted) / sizeof(wanted[0]); i++) {
        *wanted[i].program =
            voxel_program(frame, pass, wanted[i].shader, wanted[i].extra, out_error);
        if (!*wanted[i].program)
            return false;
    }
    return true;
}

static void empty_regions(const struct frame *frame, const struct voxelize_programs *programs)
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
        gpu_dispatch(frame->gpu, programs->repair, 1, 1, 1);
        gpu_barrier(frame->gpu);
        dispatch_rows(frame, programs->clear, groups_of(volume->region_voxels, REGION_RUN));
    }
    gpu_buffer_fill(volume->counters, COUNTER_TILES * 4, 4, 0);
}

static void enter_triangles(const struct frame *frame, const struct voxelize_programs *programs)
{
    struct voxel_volume *volume = frame->volume;
    dispatch_rows(frame, programs->small, volume->batch_count);
    gpu_dispatch(frame->gpu, programs->tiles, 1, 1, 1);
    gpu_barrier(frame->gpu);
    gpu_dispatch_indirect(frame->gpu, programs->large, volume->counters, COUNTER_TILES * 4);
    gpu_barrier(frame->gpu);
}

static void list_cells(const struct frame *frame, const struct voxelize_programs *programs)
{
    struct voxel_volume *volume = frame->volume;
    dispatch_rows(frame, programs->cells, groups_of(volume->region_voxels, REGION_RUN));
    gpu_dispatch(frame->gpu, programs->repair, 1, 1, 1);
    gpu_barrier(frame->gpu);
    if (volume->dirty[volume->cell_level_count - 1].count == 0)
        return; // mips of the coarsest level have not changed
    size_t first = volume->list_words - volume->mip_words;
    gpu_buffer_fill(volume->lists, first * 4, volume->mip_words * 4, 0);
}

static bool voxelize_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    struct voxel_volume *volume = frame->volume;
    struct voxelize_programs programs;
    if (!get_programs(frame, pass, &programs, out_error))
        return false;
    for (int attempt = 0; attempt < MAX_GROWTH; attempt++) {
        empty_regions(frame, &programs);
        enter_triangles(frame, &programs);
        list_cells(frame, &programs);
        enum voxel_room room = voxel_volume_check_room(volume);
        if (room == VOXEL_ROOM_ENOUGH) {
            dispatch_rows(frame, programs.list, groups_of(volume->cell_count, CELL_RUN));
            gpu_dispatch(frame->gpu, programs.arguments, 1, 1, 1);
            volume->everything = false;
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

const struct pass voxelize_pass = {
    .name = "voxelize",
    .effects_used = SURFACE_EFFECTS | EFFECT_BIT(EFFECT_VOXEL_COLORS),
    .runs_while_accumulating = true,
    .reads = RESOURCE(GEOMETRY) | RESOURCE(MATERIALS),
    .writes = RESOURCE(VOXELS) | RESOURCE(IRRADIANCE) | RESOURCE(VOXEL_RADIANCE),
    .skip_reason = voxelize_skip_reason,
    .run = voxelize_run,
};
