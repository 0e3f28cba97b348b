// Proves that C and the driver agree on the layout of every block of shaders/shared: the offset of
// each member, asked of the driver for a shader that declares them all, is that of the C struct.
// The table of members is made from the headers (block_members.mjs), so that none is forgotten.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "renderer/gpu/program.h"
#include "shared/area_light_block.h"
#include "shared/environment_block.h"
#include "shared/frame_block.h"
#include "shared/instance_block.h"
#include "shared/light_block.h"
#include "shared/material_block.h"
#include "shared/shadow_view_block.h"
#include "shared/texture_block.h"
#include "shared/voxel_block.h"
#include "shared/voxel_work.h"
#include "voxcast_paths.h"

static const char shader[] =
    "#include \"shared/area_light_block.h\"\n"
    "#include \"shared/environment_block.h\"\n"
    "#include \"shared/frame_block.h\"\n"
    "#include \"shared/instance_block.h\"\n"
    "#include \"shared/light_block.h\"\n"
    "#include \"shared/material_block.h\"\n"
    "#include \"shared/texture_block.h\"\n"
    "#include \"shared/voxel_work.h\"\n"
    "layout(local_size_x = 1) in;\n"
    "layout(std140, binding = 0) uniform b0 { frame_block frame; };\n"
    "layout(std140, binding = 1) uniform b1 { voxel_block voxels; };\n"
    "layout(std430, binding = 0) buffer b2 { instance_block instances[]; };\n"
    "layout(std430, binding = 1) buffer b3 { material_block materials[]; };\n"
    "layout(std430, binding = 2) buffer b4 { texture_block textures[]; };\n"
    "layout(std430, binding = 3) buffer b5 { light_block lights[]; };\n"
    "layout(std430, binding = 4) buffer b6 { area_light_block area_lights[]; };\n"
    "layout(std430, binding = 5) buffer b7 { shadow_view_block shadow_views[]; };\n"
    "layout(std430, binding = 6) buffer b8 { environment_block environment; };\n"
    "layout(std430, binding = 7) buffer b9 { voxel_region regions[]; };\n"
    "layout(std430, binding = 8) buffer b10 { voxel_batch batches[]; };\n"
    "layout(std430, binding = 9) buffer b11 { voxel_tile tiles[]; };\n"
    "layout(std430, binding = 10) buffer b12 { uint sum; };\n"
    "void main()\n"
    "{\n"
    "    sum = frame.tonemap + voxels.level_count + instances[1].material + materials[1].flags +\n"
    "          textures[1].sampling + lights[1].type + area_lights[1].two_sided +\n"
    "          shadow_views[1].perspective + environment.equirectangular + regions[1].level +\n"
    "          batches[1].region + tiles[1].columns;\n"
    "}\n";

static const struct member {
    const char *name; // as the shader has it
    size_t offset;    // as C has it
} members[] = {
#include "block_members.inc" // made from the headers by block_members.mjs
};

#define MEMBER_COUNT (sizeof(members) / sizeof(members[0]))

static void write_shader(const char *folder)
{
    char path[256], target[512];
    snprintf(path, sizeof(path), "%s/shared", folder);
    snprintf(target, sizeof(target), "%s/shaders/shared", VOXCAST_SOURCE_DIR);
    assert_int_equal(symlink(target, path), 0);
    snprintf(path, sizeof(path), "%s/offsets.comp", folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(shader, file) >= 0);
    fclose(file);
}

static void remove_shader(const char *folder)
{
    char path[256];
    snprintf(path, sizeof(path), "%s/shared", folder);
    unlink(path);
    snprintf(path, sizeof(path), "%s/offsets.comp", folder);
    unlink(path);
    rmdir(folder);
}

static void offsets_are_the_drivers(void **state)
{
    (void)state;
    char folder[] = "/tmp/voxcast-offsets-XXXXXX";
    struct error error = {""};
    assert_non_null(mkdtemp(folder));
    write_shader(folder);
    struct gpu *gpu = gpu_create("auto", folder, &error);
    const struct gpu_program *program =
        gpu ? gpu_program_get(gpu, "offsets.comp", "", &error) : NULL;
    remove_shader(folder);
    if (!program)
        fail_msg("%s", error.message);
    uint32_t wrong = 0;
    for (size_t i = 0; i < MEMBER_COUNT; i++) {
        uint32_t offset = UINT32_MAX;
        bool found = gpu_program_find_member(program, members[i].name, &offset);
        if (found && offset == members[i].offset)
            continue;
        print_error("%s: %zu in C, %s%u in the shader\n", members[i].name, members[i].offset,
                    found ? "" : "missing: ", offset);
        wrong++;
    }
    assert_int_equal(gpu_error_count(gpu), 0);
    gpu_destroy(&gpu);
    assert_int_equal(wrong, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(offsets_are_the_drivers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
