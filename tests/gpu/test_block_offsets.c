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

#include "renderer/frame/settings_block.h"
#include "renderer/gpu/program.h"
#include "renderer/passes/pass.h"
#include "support_gpu.h"
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
    "    sum = frame.debug_view + voxels.level_count + instances[1].material + materials[1].flags "
    "+\n"
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
    snprintf(target, sizeof(target), "%s/shared", test_shader_dir());
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

// Settings are one word each, in the order of their rows.
static void settings_are_the_drivers(void **state)
{
    (void)state;
    static const char *const names[] = {
#define PARAMETER(record, name, ...) #name,
#include "protocol/parameters/settings.def"
#undef PARAMETER
    };
    struct error error = {""};
    struct gpu *gpu = gpu_create("auto", test_shader_dir(), &error);
    if (!gpu)
        fail_msg("%s", error.message);
    assert_true(passes_prepare_gpu(gpu));
    const struct gpu_program *program =
        gpu_program_get(gpu, "post/tonemap.comp", "OUTPUT 1\nDISPLAY_READY 0\nBLANK 0\n", &error);
    if (!program)
        fail_msg("%s", error.message);
    for (size_t i = 0; i < SETTINGS_WORD_COUNT; i++) {
        char path[96];
        uint32_t offset = UINT32_MAX;
        snprintf(path, sizeof(path), "settings_uniforms.%s", names[i]);
        assert_true(gpu_program_find_member(program, path, &offset));
        assert_int_equal(offset, i * sizeof(uint32_t));
    }
    gpu_destroy(&gpu);
    struct render_settings settings;
    uint32_t words[SETTINGS_WORD_COUNT];
    render_settings_init(&settings);
    settings.gamma = 2.5f;
    settings.bounces = 7;
    settings.shadows = true;
    settings_block_fill(&settings, words);
    float gamma;
    memcpy(&gamma, &words[SETTINGS_WORD_gamma], sizeof(gamma));
    assert_float_equal(gamma, 2.5f, 0.0f);
    assert_int_equal(words[SETTINGS_WORD_bounces], 7);
    assert_int_equal(words[SETTINGS_WORD_shadows], 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(offsets_are_the_drivers),
        cmocka_unit_test(settings_are_the_drivers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
