#include "renderer/frame/effects.h"

#include <stdio.h>

#include "renderer/frame/frame_plan.h"

static const struct {
    const char *name;
    const char *define;
} effects[EFFECT_COUNT] = {
#define EFFECT(id, name, define, decision) [EFFECT_##id] = {name, define},
#include "renderer/frame/frame.def"
#undef EFFECT
};

const char *effect_name(enum effect effect)
{
    return effects[effect].name;
}

const char *effect_define(enum effect effect)
{
    return effects[effect].define;
}

// What several effects depend on.
struct effect_facts {
    bool light;     // there is a source
    bool reflected; // and a surface that its light reflects from
    bool soft_shadows_traced;
};

static struct effect_facts find_facts(const struct frame_inputs *in,
                                      const struct quality_level *quality)
{
    const struct render_settings *settings = &in->params->settings;
    const struct gpu_scene_counts *counts = &in->scene.counts;
    bool light = counts->lights > 0 || counts->emissive_materials > 0 ||
                 (settings->environment_light && in->scene.environment);
    return (struct effect_facts){
        .light = light,
        .reflected = light && counts->reflective_materials > 0,
        .soft_shadows_traced = quality->cone_shadows || quality->gather_mode == GATHER_RAYS,
    };
}

// One effect while it is decided.
struct decision {
    bool on;
    bool forceable; // by "force all effects"
    bool calls_for_cones;
    const char *reason;
    char text[96];
};

static void count(struct decision *decision, uint32_t number, const char *noun)
{
    decision->on = number > 0;
    decision->forceable = true;
    decision->reason = decision->text;
    if (number > 0)
        snprintf(decision->text, sizeof(decision->text), "%u %s%s in the scene", number, noun,
                 number > 1 ? "s" : "");
    else
        snprintf(decision->text, sizeof(decision->text), "no %s in the scene", noun);
}

static void choose(struct decision *decision, bool on, bool forceable, const char *because,
                   const char *missing)
{
    decision->on = on;
    decision->forceable = forceable;
    decision->reason = on ? because : missing;
}

static const char *why_no_cones(const struct frame_inputs *in)
{
    if (in->params->settings.gi_method == GI_METHOD_NONE)
        return "no global illumination chosen";
    return in->gi_capabilities & GI_IS_REFERENCE ? "the method is reference"
                                                 : "the method has no voxels";
}

#define COUNTED(number, noun)              count(decision, number, noun);
#define CHOSEN(on, because, missing)       choose(decision, on, true, because, missing);
#define NEVER_FORCED(on, because, missing) choose(decision, on, false, because, missing);
#define IF(allowed, why_not, otherwise)                                                            \
    if (!(allowed))                                                                                \
        choose(decision, false, false, "", why_not);                                               \
    else                                                                                           \
        otherwise
#define CALLS_FOR_CONES(otherwise)                                                                 \
    decision->calls_for_cones = true;                                                              \
    WITH_CONES(otherwise)
#define WITH_CONES(otherwise)                                                                      \
    if (!(in->gi_capabilities & GI_HAS_CONES))                                                     \
        choose(decision, false, false, "", why_no_cones(in));                                      \
    else                                                                                           \
        otherwise

#define EFFECT(id, name, define, rule)                                                             \
    static void decide_##id(struct decision *decision, const struct frame_inputs *in,              \
                            const struct effect_facts *facts)                                      \
    {                                                                                              \
        const struct render_settings *settings = &in->params->settings;                            \
        const struct gpu_scene_counts *counts = &in->scene.counts;                                 \
        (void)settings, (void)counts, (void)facts;                                                 \
        rule                                                                                       \
    }
#include "renderer/frame/frame.def"
#undef EFFECT

static void (*const rules[EFFECT_COUNT])(struct decision *decision, const struct frame_inputs *in,
                                         const struct effect_facts *facts) = {
#define EFFECT(id, name, define, rule) [EFFECT_##id] = decide_##id,
#include "renderer/frame/frame.def"
#undef EFFECT
};

void effects_plan(struct effect_plan *plan, const struct frame_inputs *in,
                  const struct quality_level *quality)
{
    const struct effect_facts facts = find_facts(in, quality);
    *plan = (struct effect_plan){0};
    for (int i = 0; i < EFFECT_COUNT; i++) {
        struct decision decision = {0};
        rules[i](&decision, in, &facts);
        if (!decision.on && decision.forceable && in->params->settings.force_all_effects)
            choose(&decision, true, true, "forced", "");
        if (decision.on)
            plan->bits |= EFFECT_BIT(i);
        plan->calls_for_cones = plan->calls_for_cones || (decision.on && decision.calls_for_cones);
        snprintf(plan->reasons[i], sizeof(plan->reasons[i]), "%s", decision.reason);
    }
}
