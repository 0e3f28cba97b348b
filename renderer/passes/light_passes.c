// Light: which lamps reach which tile, environment, direct light, and emission alone.
#include "renderer/passes/pass.h"
#include "renderer/view.h"

static bool has(const struct frame *frame, enum effect effect)
{
    return (frame->plan.bits & EFFECT_BIT(effect)) != 0;
}

// Debug views of the G-buffer show no light.
static bool shows_light(const struct frame *frame)
{
    return frame->params->debug_view == DEBUG_VIEW_FINAL ||
           frame->params->debug_view == DEBUG_VIEW_DIRECT;
}

static const char *light_tiles_skip_reason(const struct frame *frame)
{
    if (!has(frame, EFFECT_LIGHT_TILES))
        return "no light of limited range";
    if (!shows_light(frame) && frame->params->debug_view != DEBUG_VIEW_LIGHTS_PER_TILE)
        return "the debug view shows no light";
    return NULL;
}

static bool light_tiles_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    const struct gpu_program *program =
        pass_program(frame, pass, "light/light_tiles.comp", "", out_error);
    if (!program)
        return false;
    gpu_dispatch(frame->gpu, program, frame->tiles_x, frame->tiles_y, 1);
    return true;
}

const struct pass light_tiles_pass = {
    .name = "light_tiles",
    .effects_used = EFFECT_BIT(EFFECT_TRANSPARENCY),
    .use_count = 2,
    .uses = {{RESOURCE_DEPTH, ACCESS_READ}, {RESOURCE_LIGHT_MASKS, ACCESS_WRITE}},
    .skip_reason = light_tiles_skip_reason,
    .run = light_tiles_run,
};

static const char *environment_skip_reason(const struct frame *frame)
{
    if (!has(frame, EFFECT_ENVIRONMENT))
        return "no environment in the scene";
    return frame->params->debug_view == DEBUG_VIEW_FINAL ? NULL
                                                         : "the debug view shows no environment";
}

static bool environment_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    const struct gpu_program *program =
        pass_program(frame, pass, "light/environment.comp", "", out_error);
    if (!program)
        return false;
    pass_dispatch_pixels(frame, program);
    return true;
}

const struct pass environment_pass = {
    .name = "environment",
    .effects_used = EFFECT_BIT(EFFECT_BLINN_PHONG) | EFFECT_BIT(EFFECT_SPECULAR),
    .use_count = 3,
    .uses = {{RESOURCE_GBUFFER, ACCESS_READ},
             {RESOURCE_DEPTH, ACCESS_READ},
             {RESOURCE_RADIANCE, ACCESS_WRITE}},
    .skip_reason = environment_skip_reason,
    .run = environment_run,
};

static const char *direct_light_skip_reason(const struct frame *frame)
{
    if (!has(frame, EFFECT_PUNCTUAL_LIGHTS) && !has(frame, EFFECT_AREA_LIGHTS))
        return "no light in the scene";
    return shows_light(frame) ? NULL : "the debug view shows no light";
}

static bool direct_light_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    // The first pass to write radiance starts from the emission.
    bool first = environment_skip_reason(frame) != NULL;
    const char *extra = frame->params->debug_view == DEBUG_VIEW_DIRECT ? "FIRST 2\n"
                        : first                                        ? "FIRST 1\n"
                                                                       : "FIRST 0\n";
    const struct gpu_program *program =
        pass_program(frame, pass, "light/direct_light.comp", extra, out_error);
    if (!program)
        return false;
    pass_dispatch_pixels(frame, program);
    return true;
}

const struct pass direct_light_pass = {
    .name = "direct_light",
    .effects_used = DIRECT_LIGHT_EFFECTS,
    .use_count = 5,
    .uses = {{RESOURCE_GBUFFER, ACCESS_READ},
             {RESOURCE_DEPTH, ACCESS_READ},
             {RESOURCE_SHADOW_MAP, ACCESS_READ},
             {RESOURCE_LIGHT_MASKS, ACCESS_READ},
             {RESOURCE_RADIANCE, ACCESS_READ_WRITE}},
    .skip_reason = direct_light_skip_reason,
    .run = direct_light_run,
};

static const char *emission_skip_reason(const struct frame *frame)
{
    if (!shows_light(frame))
        return "the debug view shows no light";
    bool other = !environment_skip_reason(frame) || !direct_light_skip_reason(frame);
    return other ? "another light pass writes it" : NULL;
}

static bool emission_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    const struct gpu_program *program =
        pass_program(frame, pass, "light/emission.comp", "", out_error);
    if (!program)
        return false;
    pass_dispatch_pixels(frame, program);
    return true;
}

const struct pass emission_pass = {
    .name = "emission",
    .use_count = 2,
    .uses = {{RESOURCE_GBUFFER, ACCESS_READ}, {RESOURCE_RADIANCE, ACCESS_WRITE}},
    .skip_reason = emission_skip_reason,
    .run = emission_run,
};
