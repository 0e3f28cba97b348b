// Proves what a frame does, by tables: what a change invalidates, which effects a scene calls for,
// that nothing is left "auto", which passes run, who writes radiance first, and which buffers take
// memory. No GPU is needed.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "renderer/frame/resource.h"
#include "renderer/passes/pass.h"
#include "support_frame.h"

#define BIT(id) (1u << PASS_##id)

static void output_changes(struct situation *it)
{
    it->params.output = FRAME_OUTPUT_LINEAR;
}

static void voxels_become_own(struct situation *it)
{
    it->params.own_voxels = true;
}

static void scene_is_another(struct situation *it)
{
    it->inputs.scene_number = 2;
}

static void nothing_was_drawn(struct situation *it)
{
    it->history.drawn = false;
}

static void there_is_no_method(struct situation *it)
{
    camera_moves(it);
    it->params.settings.gi_method = GI_METHOD_NONE;
    it->inputs.gi_capabilities = 0;
    it->inputs.gi = NULL;
}

static void a_change_invalidates_what_is_made_from_it(void **state)
{
    (void)state;
    static const struct {
        void (*change)(struct situation *it);
        uint32_t invalid;
    } rows[] = {
        {camera_moves, INVALIDATES_FROM_SURFACES},
        {size_changes, INVALIDATES_FROM_SURFACES},
        {quality_changes, INVALIDATES_FROM_SURFACES},
        {geometry_changes, INVALIDATES_EVERYTHING},
        {transform_changes, INVALIDATES_EVERYTHING},
        {material_changes, INVALIDATES_EVERYTHING},
        {light_changes, INVALIDATES_FROM_LIGHT},
        {environment_changes, INVALIDATES_FROM_LIGHT},
        {debug_view_changes, INVALIDATES_FROM_SHADING},
        {output_changes, INVALIDATES_FROM_DISPLAY},
        {tonemap_changes, INVALIDATES_FROM_DISPLAY},
        {bounces_change, INVALIDATES_FROM_LIGHT},
        {voxels_become_own, INVALIDATES_FROM_SHADING},
        {scene_is_another, INVALIDATES_EVERYTHING},
        {nothing_was_drawn, INVALIDATES_EVERYTHING},
    };
    struct situation it;
    struct frame_plan plan;
    at_rest(&it);
    frame_plan_make(&plan, &it.inputs);
    assert_int_equal(plan.changes, INVALIDATES_NOTHING);
    assert_true(plan.unchanged);
    assert_false(plan.visibility_changed);
    uint64_t light_key = plan.light_key;
    for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
        at_rest(&it);
        rows[i].change(&it);
        frame_plan_make(&plan, &it.inputs);
        assert_int_equal(plan.changes, rows[i].invalid);
        assert_false(plan.unchanged);
        assert_int_equal(plan.surfaces_changed, (rows[i].invalid & INVALIDATES_SURFACES) != 0);
        // What light depends on is known by its key, which the volume compares: several views
        // share one. Another scene is another volume.
        bool keyed = (rows[i].invalid & INVALIDATES_LIGHT) && rows[i].change != scene_is_another &&
                     rows[i].change != nothing_was_drawn;
        assert_int_equal(plan.light_key != light_key, keyed);
    }
}

static void another_rendered_size_is_drawn_anew(void **state)
{
    (void)state;
    struct situation it;
    struct frame_plan plan;
    at_rest(&it);
    it.params.quality = it.history.params.quality = QUALITY_FINAL;
    frame_plan_make(&plan, &it.inputs);
    assert_int_equal(plan.width, 2 * WIDTH);
    assert_int_equal(plan.changes, INVALIDATES_NOTHING);
    assert_false(plan.surfaces_changed);
    assert_true(plan.visibility_changed);
    assert_false(plan.unchanged);
    it.inputs.target_width = 2 * WIDTH;
    frame_plan_make(&plan, &it.inputs);
    assert_true(plan.unchanged);
    it.gi.light_converged = false; // every image is soon replaced
    frame_plan_make(&plan, &it.inputs);
    assert_int_equal(plan.width, WIDTH);
    it.params.width = VIEW_MAX_WIDTH;
    it.params.height = VIEW_MAX_HEIGHT;
    frame_plan_make(&plan, &it.inputs);
    assert_int_equal(plan.width, VIEW_MAX_WIDTH);
    assert_int_equal(plan.height, VIEW_MAX_HEIGHT);
}

static void effects_follow_the_scene_and_the_settings(void **state)
{
    (void)state;
    struct situation it;
    struct frame_plan plan;
    at_rest(&it);
#define ROW(effect, member)                                                                        \
    {                                                                                              \
        EFFECT_##effect, offsetof(struct gpu_scene_counts, member)                                 \
    }
    static const struct {
        enum effect effect;
        size_t count;
    } rows[] = {
        ROW(TEXTURES, textured_materials),
        ROW(ALPHA_MASK, masked_materials),
        ROW(VERTEX_COLORS, colored_primitives),
        ROW(SPECULAR, specular_materials),
        ROW(PUNCTUAL_LIGHTS, lights),
        ROW(AREA_LIGHTS, area_lights),
        ROW(SHADOWS, shadow_layers),
        ROW(SINGLE_VIEW_SHADOWS, single_view_shadows),
        ROW(POINT_SHADOWS, point_shadows),
        ROW(LIGHT_TILES, ranged_lights),
        ROW(BLINN_PHONG, blinn_phong_materials),
        ROW(TRANSPARENCY, transparent_materials),
        ROW(INDIRECT_SPECULAR, specular_materials),
        ROW(REFRACTION, transmissive_materials),
        ROW(SOFT_SHADOWS, sized_lights),
        ROW(VOXEL_COLORS, textured_materials),
    };
    for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++)
        for (uint32_t number = 0; number < 3; number++) {
            uint32_t bit = EFFECT_BIT(rows[i].effect);
            at_rest(&it);
            memcpy((char *)&it.inputs.scene.counts + rows[i].count, &number, sizeof(number));
            frame_plan_make(&plan, &it.inputs);
            assert_int_equal((plan.effects.bits & bit) != 0, number > 0);
            assert_true(plan.effects.reasons[rows[i].effect][0] != '\0');
        }
}

static void what_cones_draw_is_off_without_them(void **state)
{
    (void)state;
    struct situation it;
    struct frame_plan with, without, reference;
    at_rest(&it);
    it.params.settings.force_all_effects = true;
    it.params.settings.ambient_occlusion = true;
    it.inputs.scene.counts.sized_lights = 1;
    frame_plan_make(&with, &it.inputs);
    assert_int_equal(with.effects.bits, ((uint64_t)1 << EFFECT_COUNT) - 1);
    there_is_no_method(&it);
    frame_plan_make(&without, &it.inputs);
    it.params.settings.gi_method = GI_METHOD_REFERENCE;
    it.inputs.gi_capabilities = GI_IS_REFERENCE;
    frame_plan_make(&reference, &it.inputs);
    assert_int_equal(reference.effects.bits, without.effects.bits);
    uint32_t indirect = with.effects.bits & ~without.effects.bits;
    assert_true(indirect & EFFECT_BIT(EFFECT_INDIRECT_DIFFUSE));
    assert_true(indirect & EFFECT_BIT(EFFECT_REFRACTION));
    assert_true(without.effects.bits & EFFECT_BIT(EFFECT_TRANSPARENCY));
    for (int i = 0; i < EFFECT_COUNT; i++) {
        if (!(indirect & EFFECT_BIT(i)))
            continue;
        // Forced or not: there is nothing to trace.
        assert_string_equal(without.effects.reasons[i], "no global illumination chosen");
        assert_string_equal(reference.effects.reasons[i], "the method is reference");
    }
}

static void a_method_without_voxels_is_told_from_none(void **state)
{
    (void)state;
    struct situation it;
    struct frame_plan plan;
    at_rest(&it);
    it.inputs.gi_capabilities = 0; // though it draws with something
    it.params.debug_view = DEBUG_VIEW_VOXEL_NORMAL;
    frame_plan_make(&plan, &it.inputs);
    assert_string_equal(plan.effects.reasons[EFFECT_INDIRECT_DIFFUSE], "the method has no voxels");
    assert_non_null(strstr(frame_plan_blank_reason(&it.inputs), "the method has no voxels"));
    assert_false(frame_plan_has_cones(&it.inputs));
    there_is_no_method(&it);
    assert_non_null(strstr(frame_plan_blank_reason(&it.inputs), "without global illumination"));
}

static void nothing_stays_auto(void **state)
{
    (void)state;
    struct situation it;
    struct frame_plan plan;
    for (int quality = 0; quality < QUALITY_COUNT; quality++)
        for (int cones = 0; cones < CONE_SET_COUNT; cones++)
            for (int gather = 0; gather < GATHER_COUNT; gather++)
                for (int own_step = 0; own_step < 2; own_step++) {
                    const struct quality_level *level = &quality_levels[quality];
                    at_rest(&it);
                    it.params.quality = (enum quality)quality;
                    it.params.settings.cone_set = (enum cone_set)cones;
                    it.params.settings.gather_mode = (enum gather_mode)gather;
                    it.params.settings.cone_step = own_step ? 0.75f : 0.0f;
                    frame_plan_make(&plan, &it.inputs);
                    bool own_cones = cones != CONE_SET_AUTO, own_mode = gather != GATHER_AUTO;
                    assert_int_equal(plan.quality.cone_set,
                                     own_cones ? cones : (int)level->cone_set);
                    assert_int_not_equal(plan.cache_cone_set, CONE_SET_AUTO);
                    assert_int_equal(plan.quality.gather_mode,
                                     own_mode ? gather : (int)level->gather_mode);
                    assert_float_equal(plan.quality.cone_step, own_step ? 0.75f : level->cone_step,
                                       0.0f);
                    assert_true(plan.cache_cone_step > 0.0f);
                    assert_in_range(plan.gather_step, 1, 2);
                }
}

static void nothing(struct situation *it)
{
    (void)it;
}

static void camera_moves_among_shadows(struct situation *it)
{
    camera_moves(it);
    it->inputs.scene.counts.shadow_layers = it->inputs.scene.counts.single_view_shadows = 1;
    it->inputs.shadows_stale = true;
}

static void light_is_edited(struct situation *it)
{
    it->revisions.lights++;
    it->gi.light_converged = false;
    it->gi.work = (struct voxel_light_work){.relight = true, .direct = true, .trace = true};
}

static void there_is_an_environment(struct situation *it)
{
    camera_moves(it);
    it->inputs.scene.environment = true;
}

static void nothing_gives_light(struct situation *it)
{
    camera_moves(it);
    it->inputs.scene.counts.lights = 0;
}

static void everything_is_unlit(struct situation *it)
{
    camera_moves(it);
    it->inputs.scene.counts.lit_materials = 0;
}

static void glass_is_in_view(struct situation *it)
{
    camera_moves(it);
    it->inputs.scene.counts.transparent_materials = 1;
    it->inputs.transparent_in_view = true;
}

static void glass_is_out_of_view(struct situation *it)
{
    glass_is_in_view(it);
    it->inputs.transparent_in_view = false;
}

static void a_reference_is_shown(struct situation *it)
{
    there_is_no_method(it);
    it->params.settings.gi_method = GI_METHOD_REFERENCE;
    it->inputs.gi_capabilities = GI_IS_REFERENCE;
    it->inputs.reference_shown = true;
}

static void normals_are_shown(struct situation *it)
{
    it->params.debug_view = DEBUG_VIEW_NORMAL;
}

static void voxels_are_shown_without_any(struct situation *it)
{
    there_is_no_method(it);
    it->params.debug_view = DEBUG_VIEW_VOXEL_NORMAL;
}

static void indirect_light_is_shown(struct situation *it)
{
    it->params.debug_view = DEBUG_VIEW_INDIRECT_DIFFUSE;
}

static void output_is_linear(struct situation *it)
{
    it->params.output = FRAME_OUTPUT_LINEAR;
}

#define SURFACES (BIT(VISIBILITY) | BIT(GBUFFER))
#define SHOWN    (BIT(EXPOSURE) | BIT(TONEMAP) | BIT(READBACK))
#define SHADED   (BIT(DIRECT_LIGHT) | BIT(INDIRECT_DIFFUSE) | SHOWN)

static const struct {
    const char *name;
    void (*change)(struct situation *it);
    uint32_t passes; // that run
    enum pass_id radiance_writer;
} situations[] = {
    {"first sample", nothing, BIT(INDIRECT_DIFFUSE) | BIT(READBACK), PASS_COUNT},
    {"few samples", samples_are_few, BIT(INDIRECT_DIFFUSE) | BIT(READBACK), PASS_COUNT},
    {"all samples", all_samples_are_in, SHADED, PASS_DIRECT_LIGHT},
    {"moving", camera_moves, SURFACES | SHADED, PASS_DIRECT_LIGHT},
    {"shadows", camera_moves_among_shadows, SURFACES | BIT(SHADOW_MAP) | SHADED, PASS_DIRECT_LIGHT},
    {"light edited", light_is_edited,
     BIT(VOXEL_RELIGHT) | BIT(VOXEL_FILTER) | BIT(IRRADIANCE_CACHE) | SHADED, PASS_DIRECT_LIGHT},
    {"environment", there_is_an_environment, SURFACES | BIT(ENVIRONMENT) | SHADED,
     PASS_ENVIRONMENT},
    {"dark", nothing_gives_light, SURFACES | BIT(EMISSION) | SHOWN, PASS_EMISSION},
    {"unlit", everything_is_unlit, SURFACES | BIT(EMISSION) | BIT(INDIRECT_DIFFUSE) | SHOWN,
     PASS_EMISSION},
    {"glass", glass_is_in_view, SURFACES | BIT(TRANSPARENCY) | SHADED, PASS_DIRECT_LIGHT},
    {"no glass", glass_is_out_of_view, SURFACES | SHADED, PASS_DIRECT_LIGHT},
    {"no method", there_is_no_method, SURFACES | BIT(DIRECT_LIGHT) | SHOWN, PASS_DIRECT_LIGHT},
    {"reference", a_reference_is_shown, BIT(REFERENCE) | SHOWN, PASS_COUNT},
    {"normals", normals_are_shown, BIT(DEBUG_VIEW) | BIT(TONEMAP) | BIT(READBACK), PASS_COUNT},
    {"blank", voxels_are_shown_without_any, SURFACES | BIT(TONEMAP) | BIT(READBACK), PASS_COUNT},
    {"indirect", indirect_light_is_shown, BIT(INDIRECT_DIFFUSE) | SHOWN, PASS_COUNT},
    {"linear", output_is_linear,
     BIT(DIRECT_LIGHT) | BIT(INDIRECT_DIFFUSE) | BIT(TONEMAP) | BIT(READBACK), PASS_DIRECT_LIGHT},
};

static void passes_run_where_they_are_needed(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof(situations) / sizeof(situations[0]); i++) {
        struct situation it;
        struct frame_plan plan;
        uint32_t runs = 0;
        at_rest(&it);
        situations[i].change(&it);
        frame_plan_make(&plan, &it.inputs);
        for (int pass = 0; pass < PASS_COUNT; pass++) {
            const char *reason = plan.skip_reasons[pass];
            if (!reason)
                runs |= 1u << pass;
            else
                assert_true(reason[0] != '\0');
        }
        for (int pass = 0; pass < PASS_COUNT; pass++)
            if ((runs ^ situations[i].passes) & (1u << pass))
                fail_msg("%s: %s %s", situations[i].name, pass_name((enum pass_id)pass),
                         runs & (1u << pass) ? "runs" : plan.skip_reasons[pass]);
        assert_int_equal(plan.radiance_writer, situations[i].radiance_writer);
    }
}

static void buffers_take_memory_only_where_used(void **state)
{
    (void)state;
    static const struct {
        enum resource resource;
        void (*change)(struct situation *it); // that calls for it
    } rows[] = {
        {RESOURCE_FRAGMENTS, glass_is_in_view},
    };
    struct situation it;
    struct frame_plan plan;
    at_rest(&it);
    frame_plan_make(&plan, &it.inputs);
    for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
        const struct resource_row *row = &resource_rows[rows[i].resource];
        at_rest(&it);
        frame_plan_make(&plan, &it.inputs);
        assert_int_equal(row->bytes(&it.inputs, &plan), 0);
        rows[i].change(&it);
        frame_plan_make(&plan, &it.inputs);
        assert_true(row->bytes(&it.inputs, &plan) > 0);
    }
    at_rest(&it);
    it.inputs.scene.counts.ranged_lights = it.inputs.scene.counts.lights = 33;
    frame_plan_make(&plan, &it.inputs);
    assert_int_equal(resource_rows[RESOURCE_LIGHT_MASKS].bytes(&it.inputs, &plan), 4 * 3 * 2 * 4);
    size_t with_rays = frame_plan_accumulation_bytes(&it.inputs, &plan);
    assert_int_equal(with_rays, (size_t)WIDTH * HEIGHT * 2 * 16);
    it.params.settings.gather_mode = GATHER_CACHE;
    frame_plan_make(&plan, &it.inputs);
    assert_int_equal(frame_plan_accumulation_bytes(&it.inputs, &plan), 0);
}

static void a_resource_is_written_before_it_is_read(void **state)
{
    (void)state;
    struct error error = {""};
    assert_true(passes_check(all_passes, PASS_COUNT, &error));
    const struct pass *swapped[PASS_COUNT];
    memcpy(swapped, all_passes, sizeof(swapped));
    swapped[PASS_VISIBILITY] = all_passes[PASS_GBUFFER];
    swapped[PASS_GBUFFER] = all_passes[PASS_VISIBILITY];
    assert_false(passes_check(swapped, PASS_COUNT, &error));
    assert_non_null(strstr(error.message, "reads ids before"));
}

static void a_plan_depends_on_its_inputs_alone(void **state)
{
    (void)state;
    struct situation it;
    struct frame_plan one, two;
    at_rest(&it);
    camera_moves(&it);
    const struct situation before = it;
    memset(&one, 0x55, sizeof(one));
    memset(&two, 0xaa, sizeof(two));
    frame_plan_make(&one, &it.inputs);
    frame_plan_make(&two, &it.inputs);
    assert_memory_equal(&before, &it, sizeof(it));
    assert_memory_equal(one.switches, two.switches, sizeof(one.switches));
    assert_memory_equal(&one.effects, &two.effects, sizeof(one.effects));
    assert_int_equal(one.light_key, two.light_key);
    assert_int_equal(one.accumulation_after.key, two.accumulation_after.key);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_change_invalidates_what_is_made_from_it),
        cmocka_unit_test(another_rendered_size_is_drawn_anew),
        cmocka_unit_test(effects_follow_the_scene_and_the_settings),
        cmocka_unit_test(what_cones_draw_is_off_without_them),
        cmocka_unit_test(a_method_without_voxels_is_told_from_none),
        cmocka_unit_test(nothing_stays_auto),
        cmocka_unit_test(passes_run_where_they_are_needed),
        cmocka_unit_test(buffers_take_memory_only_where_used),
        cmocka_unit_test(a_resource_is_written_before_it_is_read),
        cmocka_unit_test(a_plan_depends_on_its_inputs_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
