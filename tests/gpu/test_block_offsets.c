// Proves that C and the driver agree on the layout of every block of shaders/shared: the offset of
// each member, asked of the driver for a shader that declares them all, is that of the C struct;
// and every member of the headers is looked at.
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
    {"frame.clip_from_world", offsetof(struct frame_block, clip_from_world)},
    {"frame.eye", offsetof(struct frame_block, eye)},
    {"frame.near_m", offsetof(struct frame_block, near_m)},
    {"frame.forward", offsetof(struct frame_block, forward)},
    {"frame.scene_diagonal_m", offsetof(struct frame_block, scene_diagonal_m)},
    {"frame.ray_corner", offsetof(struct frame_block, ray_corner)},
    {"frame.ray_min_offset_m", offsetof(struct frame_block, ray_min_offset_m)},
    {"frame.ray_dx", offsetof(struct frame_block, ray_dx)},
    {"frame.light_min_distance2", offsetof(struct frame_block, light_min_distance2)},
    {"frame.ray_dy", offsetof(struct frame_block, ray_dy)},
    {"frame.shadow_near_m", offsetof(struct frame_block, shadow_near_m)},
    {"frame.bvh_origin", offsetof(struct frame_block, bvh_origin)},
    {"frame.specular_max_roughness", offsetof(struct frame_block, specular_max_roughness)},
    {"frame.render_size", offsetof(struct frame_block, render_size)},
    {"frame.tile_count", offsetof(struct frame_block, tile_count)},
    {"frame.output_size", offsetof(struct frame_block, output_size)},
    {"frame.luma_pitch_bytes", offsetof(struct frame_block, luma_pitch_bytes)},
    {"frame.chroma_pitch_bytes", offsetof(struct frame_block, chroma_pitch_bytes)},
    {"frame.light_count", offsetof(struct frame_block, light_count)},
    {"frame.first_instance", offsetof(struct frame_block, first_instance)},
    {"frame.first_id_block", offsetof(struct frame_block, first_id_block)},
    {"frame.first_material", offsetof(struct frame_block, first_material)},
    {"frame.first_texture", offsetof(struct frame_block, first_texture)},
    {"frame.first_light", offsetof(struct frame_block, first_light)},
    {"frame.first_area_light", offsetof(struct frame_block, first_area_light)},
    {"frame.environment_texel", offsetof(struct frame_block, environment_texel)},
    {"frame.area_light_count", offsetof(struct frame_block, area_light_count)},
    {"frame.light_mask_words", offsetof(struct frame_block, light_mask_words)},
    {"frame.cascade_count", offsetof(struct frame_block, cascade_count)},
    {"frame.debug_view", offsetof(struct frame_block, debug_view)},
    {"frame.debug_level", offsetof(struct frame_block, debug_level)},
    {"frame.debug_face", offsetof(struct frame_block, debug_face)},
    {"frame.all_blinn_phong", offsetof(struct frame_block, all_blinn_phong)},
    {"frame.shadow_tap_count", offsetof(struct frame_block, shadow_tap_count)},
    {"frame.sun_shadow_view", offsetof(struct frame_block, sun_shadow_view)},
    {"frame.tonemap", offsetof(struct frame_block, tonemap)},
    {"frame.gamma", offsetof(struct frame_block, gamma)},
    {"frame.exposure_scale", offsetof(struct frame_block, exposure_scale)},
    {"frame.exposure_bias", offsetof(struct frame_block, exposure_bias)},
    {"frame.environment_intensity", offsetof(struct frame_block, environment_intensity)},
    {"frame.environment_rotation_rad", offsetof(struct frame_block, environment_rotation_rad)},
    {"frame.texture_max_anisotropy", offsetof(struct frame_block, texture_max_anisotropy)},
    {"frame.texture_dither_levels", offsetof(struct frame_block, texture_dither_levels)},
    {"frame.cascades[0].scale", offsetof(struct frame_block, cascades[0].scale)},
    {"frame.cascades[0].layer", offsetof(struct frame_block, cascades[0].layer)},
    {"frame.cascades[0].offset", offsetof(struct frame_block, cascades[0].offset)},
    {"frame.cascades[1].scale", offsetof(struct frame_block, cascades[1].scale)},
    {"frame.cascades[1].layer", offsetof(struct frame_block, cascades[1].layer)},
    {"frame.cascades[1].offset", offsetof(struct frame_block, cascades[1].offset)},
    {"voxels.anchor", offsetof(struct voxel_block, anchor)},
    {"voxels.radiance_scale", offsetof(struct voxel_block, radiance_scale)},
    {"voxels.level_count", offsetof(struct voxel_block, level_count)},
    {"voxels.face_count", offsetof(struct voxel_block, face_count)},
    {"voxels.cell_capacity", offsetof(struct voxel_block, cell_capacity)},
    {"voxels.surfel_capacity", offsetof(struct voxel_block, surfel_capacity)},
    {"voxels.region_count", offsetof(struct voxel_block, region_count)},
    {"voxels.region_voxel_count", offsetof(struct voxel_block, region_voxel_count)},
    {"voxels.batch_count", offsetof(struct voxel_block, batch_count)},
    {"voxels.tile_capacity", offsetof(struct voxel_block, tile_capacity)},
    {"voxels.cache_generation", offsetof(struct voxel_block, cache_generation)},
    {"voxels.frame_number", offsetof(struct voxel_block, frame_number)},
    {"voxels.trace_budget", offsetof(struct voxel_block, trace_budget)},
    {"voxels.all_faces", offsetof(struct voxel_block, all_faces)},
    {"voxels.ao_radius_m", offsetof(struct voxel_block, ao_radius_m)},
    {"voxels.indirect_intensity", offsetof(struct voxel_block, indirect_intensity)},
    {"voxels.specular_max_roughness", offsetof(struct voxel_block, specular_max_roughness)},
    {"voxels.cone_max_diameter_m", offsetof(struct voxel_block, cone_max_diameter_m)},
    {"voxels.peak_radiance", offsetof(struct voxel_block, peak_radiance)},
    {"voxels.sample_count", offsetof(struct voxel_block, sample_count)},
    {"voxels.specular_min_reflectance", offsetof(struct voxel_block, specular_min_reflectance)},
    {"voxels.cache_march.step_diameters", offsetof(struct voxel_block, cache_march.step_diameters)},
    {"voxels.cache_march.start_voxels", offsetof(struct voxel_block, cache_march.start_voxels)},
    {"voxels.cache_march.cone_count", offsetof(struct voxel_block, cache_march.cone_count)},
    {"voxels.cache_march.tan_half_angle", offsetof(struct voxel_block, cache_march.tan_half_angle)},
    {"voxels.pixel_march.step_diameters", offsetof(struct voxel_block, pixel_march.step_diameters)},
    {"voxels.pixel_march.start_voxels", offsetof(struct voxel_block, pixel_march.start_voxels)},
    {"voxels.pixel_march.cone_count", offsetof(struct voxel_block, pixel_march.cone_count)},
    {"voxels.pixel_march.tan_half_angle", offsetof(struct voxel_block, pixel_march.tan_half_angle)},
    {"voxels.cell_level_count", offsetof(struct voxel_block, cell_level_count)},
    {"voxels.face_record_words", offsetof(struct voxel_block, face_record_words)},
    {"voxels.face_capacity", offsetof(struct voxel_block, face_capacity)},
    {"voxels.geometry_epoch", offsetof(struct voxel_block, geometry_epoch)},
    {"voxels.list_capacity", offsetof(struct voxel_block, list_capacity)},
    {"voxels.first_level", offsetof(struct voxel_block, first_level)},
    {"voxels.end_level", offsetof(struct voxel_block, end_level)},
    {"voxels.instance_count", offsetof(struct voxel_block, instance_count)},
    {"voxels.cache_cones[0].direction", offsetof(struct voxel_block, cache_cones[0].direction)},
    {"voxels.cache_cones[0].weight", offsetof(struct voxel_block, cache_cones[0].weight)},
    {"voxels.cache_cones[1].direction", offsetof(struct voxel_block, cache_cones[1].direction)},
    {"voxels.cache_cones[1].weight", offsetof(struct voxel_block, cache_cones[1].weight)},
    {"voxels.pixel_cones[0].direction", offsetof(struct voxel_block, pixel_cones[0].direction)},
    {"voxels.pixel_cones[0].weight", offsetof(struct voxel_block, pixel_cones[0].weight)},
    {"voxels.pixel_cones[1].direction", offsetof(struct voxel_block, pixel_cones[1].direction)},
    {"voxels.pixel_cones[1].weight", offsetof(struct voxel_block, pixel_cones[1].weight)},
    {"voxels.levels[0].origin", offsetof(struct voxel_block, levels[0].origin)},
    {"voxels.levels[0].edge", offsetof(struct voxel_block, levels[0].edge)},
    {"voxels.levels[0].inner_origin", offsetof(struct voxel_block, levels[0].inner_origin)},
    {"voxels.levels[0].inner_edge", offsetof(struct voxel_block, levels[0].inner_edge)},
    {"voxels.levels[0].texel_origin", offsetof(struct voxel_block, levels[0].texel_origin)},
    {"voxels.levels[0].face_stride", offsetof(struct voxel_block, levels[0].face_stride)},
    {"voxels.levels[0].first_index", offsetof(struct voxel_block, levels[0].first_index)},
    {"voxels.levels[0].edge_log2", offsetof(struct voxel_block, levels[0].edge_log2)},
    {"voxels.levels[0].wraps", offsetof(struct voxel_block, levels[0].wraps)},
    {"voxels.levels[0].dirty", offsetof(struct voxel_block, levels[0].dirty)},
    {"voxels.levels[0].voxel_edge_m", offsetof(struct voxel_block, levels[0].voxel_edge_m)},
    {"voxels.levels[0].inverse_voxel_edge",
     offsetof(struct voxel_block, levels[0].inverse_voxel_edge)},
    {"voxels.levels[1].origin", offsetof(struct voxel_block, levels[1].origin)},
    {"voxels.levels[1].edge", offsetof(struct voxel_block, levels[1].edge)},
    {"voxels.levels[1].inner_origin", offsetof(struct voxel_block, levels[1].inner_origin)},
    {"voxels.levels[1].inner_edge", offsetof(struct voxel_block, levels[1].inner_edge)},
    {"voxels.levels[1].texel_origin", offsetof(struct voxel_block, levels[1].texel_origin)},
    {"voxels.levels[1].face_stride", offsetof(struct voxel_block, levels[1].face_stride)},
    {"voxels.levels[1].first_index", offsetof(struct voxel_block, levels[1].first_index)},
    {"voxels.levels[1].edge_log2", offsetof(struct voxel_block, levels[1].edge_log2)},
    {"voxels.levels[1].wraps", offsetof(struct voxel_block, levels[1].wraps)},
    {"voxels.levels[1].dirty", offsetof(struct voxel_block, levels[1].dirty)},
    {"voxels.levels[1].voxel_edge_m", offsetof(struct voxel_block, levels[1].voxel_edge_m)},
    {"voxels.levels[1].inverse_voxel_edge",
     offsetof(struct voxel_block, levels[1].inverse_voxel_edge)},
    {"instances[0].world_from_local", offsetof(struct instance_block, world_from_local)},
    {"instances[0].first_triangle", offsetof(struct instance_block, first_triangle)},
    {"instances[0].material", offsetof(struct instance_block, material)},
    {"instances[0].first_visibility_id", offsetof(struct instance_block, first_visibility_id)},
    {"instances[0].flags", offsetof(struct instance_block, flags)},
    {"materials[0].base_color", offsetof(struct material_block, base_color)},
    {"materials[0].emission", offsetof(struct material_block, emission)},
    {"materials[0].alpha_cutoff", offsetof(struct material_block, alpha_cutoff)},
    {"materials[0].metallic", offsetof(struct material_block, metallic)},
    {"materials[0].roughness", offsetof(struct material_block, roughness)},
    {"materials[0].normal_scale", offsetof(struct material_block, normal_scale)},
    {"materials[0].occlusion_strength", offsetof(struct material_block, occlusion_strength)},
    {"materials[0].f0", offsetof(struct material_block, f0)},
    {"materials[0].specular", offsetof(struct material_block, specular)},
    {"materials[0].transmission", offsetof(struct material_block, transmission)},
    {"materials[0].thickness_m", offsetof(struct material_block, thickness_m)},
    {"materials[0].specular_color", offsetof(struct material_block, specular_color)},
    {"materials[0].attenuation_distance_m",
     offsetof(struct material_block, attenuation_distance_m)},
    {"materials[0].attenuation_color", offsetof(struct material_block, attenuation_color)},
    {"materials[0].ior", offsetof(struct material_block, ior)},
    {"materials[0].mean_metallic", offsetof(struct material_block, mean_metallic)},
    {"materials[0].mean_roughness", offsetof(struct material_block, mean_roughness)},
    {"materials[0].flags", offsetof(struct material_block, flags)},
    {"materials[0].first_texture", offsetof(struct material_block, first_texture)},
    {"materials[0].texture_mask", offsetof(struct material_block, texture_mask)},
    {"textures[0].uv_row_u", offsetof(struct texture_block, uv_row_u)},
    {"textures[0].uv_row_v", offsetof(struct texture_block, uv_row_v)},
    {"textures[0].sampling", offsetof(struct texture_block, sampling)},
    {"lights[0].position", offsetof(struct light_block, position)},
    {"lights[0].type", offsetof(struct light_block, type)},
    {"lights[0].direction", offsetof(struct light_block, direction)},
    {"lights[0].range_m", offsetof(struct light_block, range_m)},
    {"lights[0].intensity", offsetof(struct light_block, intensity)},
    {"lights[0].radius_m", offsetof(struct light_block, radius_m)},
    {"lights[0].cone_scale", offsetof(struct light_block, cone_scale)},
    {"lights[0].cone_offset", offsetof(struct light_block, cone_offset)},
    {"lights[0].cos_outer_cone", offsetof(struct light_block, cos_outer_cone)},
    {"lights[0].shadow.first_view", offsetof(struct light_block, shadow.first_view)},
    {"lights[0].shadow.view_count", offsetof(struct light_block, shadow.view_count)},
    {"lights[0].shadow.light_id", offsetof(struct light_block, shadow.light_id)},
    {"lights[0].shadow.has_cascades", offsetof(struct light_block, shadow.has_cascades)},
    {"area_lights[0].corners[0]", offsetof(struct area_light_block, corners)},
    {"area_lights[0].radiance", offsetof(struct area_light_block, radiance)},
    {"area_lights[0].area_m2", offsetof(struct area_light_block, area_m2)},
    {"area_lights[0].center", offsetof(struct area_light_block, center)},
    {"area_lights[0].in_voxels", offsetof(struct area_light_block, in_voxels)},
    {"area_lights[0].normal", offsetof(struct area_light_block, normal)},
    {"area_lights[0].two_sided", offsetof(struct area_light_block, two_sided)},
    {"area_lights[0].shadow.first_view", offsetof(struct area_light_block, shadow.first_view)},
    {"area_lights[0].shadow.view_count", offsetof(struct area_light_block, shadow.view_count)},
    {"area_lights[0].shadow.light_id", offsetof(struct area_light_block, shadow.light_id)},
    {"area_lights[0].shadow.has_cascades", offsetof(struct area_light_block, shadow.has_cascades)},
    {"shadow_views[0].clip_from_world", offsetof(struct shadow_view_block, clip_from_world)},
    {"shadow_views[0].texel_m", offsetof(struct shadow_view_block, texel_m)},
    {"shadow_views[0].perspective", offsetof(struct shadow_view_block, perspective)},
    {"shadow_views[0].depth_range_m", offsetof(struct shadow_view_block, depth_range_m)},
    {"environment.irradiance_sh[0]", offsetof(struct environment_block, irradiance_sh)},
    {"environment.equirectangular", offsetof(struct environment_block, equirectangular)},
    {"environment.level_count", offsetof(struct environment_block, level_count)},
    {"environment.zenith", offsetof(struct environment_block, zenith)},
    {"environment.horizon", offsetof(struct environment_block, horizon)},
    {"environment.ground", offsetof(struct environment_block, ground)},
    {"environment.brdf_nodes[0]", offsetof(struct environment_block, brdf_nodes)},
    {"regions[0].low", offsetof(struct voxel_region, low)},
    {"regions[0].level", offsetof(struct voxel_region, level)},
    {"regions[0].size", offsetof(struct voxel_region, size)},
    {"regions[0].first_voxel", offsetof(struct voxel_region, first_voxel)},
    {"batches[0].instance", offsetof(struct voxel_batch, instance)},
    {"batches[0].first_triangle", offsetof(struct voxel_batch, first_triangle)},
    {"batches[0].triangle_count", offsetof(struct voxel_batch, triangle_count)},
    {"batches[0].region", offsetof(struct voxel_batch, region)},
    {"tiles[0].instance", offsetof(struct voxel_tile, instance)},
    {"tiles[0].triangle", offsetof(struct voxel_tile, triangle)},
    {"tiles[0].region", offsetof(struct voxel_tile, region)},
    {"tiles[0].columns", offsetof(struct voxel_tile, columns)},
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

// The driver lists elements of arrays of structs one by one: those of the table are the first two.
static void every_member_is_looked_at(void **state)
{
    (void)state;
    static const char *const headers[] = {"area_light_block", "environment_block", "frame_block",
                                          "instance_block",   "light_block",       "material_block",
                                          "texture_block",    "shadow_view_block", "voxel_block",
                                          "voxel_work"};
    for (size_t i = 0; i < sizeof(headers) / sizeof(headers[0]); i++) {
        char path[512], line[512];
        snprintf(path, sizeof(path), "%s/shaders/shared/%s.h", VOXCAST_SOURCE_DIR, headers[i]);
        FILE *file = fopen(path, "r");
        assert_non_null(file);
        while (fgets(line, sizeof(line), file)) {
            char type[64], name[64];
            if (line[0] != ' ' ||
                sscanf(line, "    %63[a-z0-9_A-Z()] %63[a-z0-9_]", type, name) != 2 ||
                strncmp(name, "unused", 6) == 0)
                continue;
            bool found = false;
            for (size_t j = 0; j < MEMBER_COUNT && !found; j++)
                found = strstr(members[j].name, name) != NULL;
            if (!found)
                fail_msg("%s: nobody looks at the offset of %s", path, name);
        }
        fclose(file);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(offsets_are_the_drivers),
        cmocka_unit_test(every_member_is_looked_at),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
