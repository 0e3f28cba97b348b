#include "renderer/frame/view.h"

#include <math.h>
#include <stdlib.h>

#include "renderer/frame/frame.h"
#include "shared/display.h"

struct view *view_create(struct gpu *gpu)
{
    struct view *view = calloc(1, sizeof(*view));
    if (!view)
        return NULL;
    view->gpu = gpu;
    view->timer = gpu_timer_create(gpu);
    view->frame_block =
        gpu_buffer_create(gpu, "view.frame", GPU_BUFFER_STATIC, sizeof(struct frame_block), NULL);
    view->exposure = gpu_buffer_create(gpu, "view.exposure", GPU_BUFFER_STATIC,
                                       sizeof(vec4) + HISTOGRAM_BINS * sizeof(uint32_t), NULL);
    view->shadow_views = gpu_buffer_create(
        gpu, "view.shadow_views", GPU_BUFFER_STATIC,
        (MAX_SHADOW_LAYERS + MAX_CASCADES) * sizeof(struct shadow_view_block), NULL);
    if (!view->timer || !view->frame_block || !view->exposure || !view->shadow_views)
        view_destroy(&view);
    return view;
}

static void destroy_sized_targets(struct view *view)
{
    gpu_framebuffer_destroy(&view->framebuffer);
    gpu_framebuffer_destroy(&view->list_framebuffer);
    gpu_texture_destroy(&view->ids);
    gpu_texture_destroy(&view->depth);
    gpu_buffer_destroy(&view->gbuffer);
    gpu_buffer_destroy(&view->radiance);
    gpu_buffer_destroy(&view->light_masks);
    gpu_buffer_destroy(&view->fragments);
    gpu_buffer_destroy(&view->transparent_tiles);
    gpu_buffer_destroy(&view->accumulation);
    gpu_buffer_destroy(&view->glossy_tiles);
    view->width = 0;
    view->height = 0;
}

void view_release_cascades(struct view *view)
{
    for (uint32_t i = 0; i < view->cascade_count; i++)
        shadow_map_give_cascade(view->cascade_owner, view->cascade_numbers[i]);
    view->cascade_count = 0;
    view->cascade_owner = NULL;
}

void view_destroy(struct view **view_slot)
{
    struct view *view = *view_slot;
    *view_slot = NULL;
    if (!view)
        return;
    live_reference_finish(&view->reference);
    destroy_sized_targets(view);
    view_release_cascades(view);
    draw_list_finish(&view->draws);
    draw_list_finish(&view->shadow_draws);
    gpu_buffer_destroy(&view->frame_block);
    gpu_buffer_destroy(&view->exposure);
    gpu_buffer_destroy(&view->output);
    gpu_buffer_destroy(&view->shadow_views);
    for (uint32_t i = 0; i < RENDERER_FRAMES_IN_RING; i++) {
        gpu_fence_destroy(&view->ring[i].fence);
        gpu_buffer_destroy(&view->ring[i].pixels);
    }
    gpu_timer_destroy(&view->timer);
    free(view);
}

size_t view_output_layout(const struct frame_params *params, size_t out_offsets[3],
                          uint32_t out_pitches[3])
{
    uint32_t width = params->width, height = params->height;
    for (int i = 0; i < 3; i++) {
        out_offsets[i] = 0;
        out_pitches[i] = 0;
    }
    if (params->output != FRAME_OUTPUT_YCBCR) {
        out_pitches[0] = width * (params->output == FRAME_OUTPUT_RGBA8 ? 4 : 16);
        return (size_t)out_pitches[0] * height;
    }
    // Blocks of 8 x 2 pixels write whole words: pad rows to 8 and their number to 2.
    uint32_t rows = (height + 1) & ~1u;
    out_pitches[0] = (width + 7) & ~7u;
    out_pitches[1] = out_pitches[2] = out_pitches[0] / 2;
    out_offsets[1] = (size_t)out_pitches[0] * rows;
    out_offsets[2] = out_offsets[1] + (size_t)out_pitches[1] * (rows / 2);
    return out_offsets[2] + (size_t)out_pitches[2] * (rows / 2);
}

static bool create_sized_targets(struct view *view, uint32_t width, uint32_t height)
{
    struct gpu_texture_params texture = {
        .label = "view.targets", .width = width, .height = height, .filter = GPU_FILTER_NEAREST};
    texture.format = GPU_FORMAT_R32UI;
    view->ids = gpu_texture_create(view->gpu, &texture);
    texture.format = GPU_FORMAT_DEPTH32F;
    view->depth = gpu_texture_create(view->gpu, &texture);
    if (!view->ids || !view->depth)
        return false;
    view->framebuffer = gpu_framebuffer_create(view->gpu, "visibility", view->ids, view->depth, 0);
    view->list_framebuffer =
        gpu_framebuffer_create(view->gpu, "transparent lists", NULL, view->depth, 0);
    size_t pixels = (size_t)width * height;
    view->gbuffer =
        gpu_buffer_create(view->gpu, "view.gbuffer", GPU_BUFFER_STATIC, pixels * 32, NULL);
    view->radiance =
        gpu_buffer_create(view->gpu, "view.radiance", GPU_BUFFER_STATIC, pixels * 16, NULL);
    view->width = width;
    view->height = height;
    return view->framebuffer && view->list_framebuffer && view->gbuffer && view->radiance;
}

static bool prepare_cascades(struct view *view, struct shadow_map *map, uint32_t wanted)
{
    if (view->cascade_count == wanted && view->cascade_owner == map)
        return true;
    view_release_cascades(view);
    view->cascade_owner = map;
    while (view->cascade_count < wanted) {
        uint32_t number = shadow_map_take_cascade(map);
        if (number == UINT32_MAX)
            return false;
        view->cascade_fitted[view->cascade_count] = false;
        view->cascade_numbers[view->cascade_count++] = number;
    }
    return true;
}

// Buffers for indirect light besides the volume.
static bool prepare_indirect(struct view *view, const struct frame *frame)
{
    bool done = true;
    uint32_t effect_bits = frame->plan.bits;
    enum gather_mode gather = frame_has_cones(frame) ? frame_gather_mode(frame) : GATHER_CACHE;
    uint32_t step = frame_gather_step(frame);
    size_t accumulation =
        (size_t)((view->width + step - 1) / step) * ((view->height + step - 1) / step);
    accumulation *= frame_accumulation_planes(frame);
    if (frame_wants_ray_shadows(frame))
        accumulation += (size_t)view->width * view->height;
    if (gather == GATHER_CACHE)
        gpu_buffer_destroy(&view->accumulation);
    else
        done = gpu_buffer_ensure(view->gpu, &view->accumulation, "view.gathered", GPU_BUFFER_STATIC,
                                 accumulation * sizeof(vec4));
    size_t tiles = (size_t)((view->width + GROUP_EDGE - 1) / GROUP_EDGE) *
                   ((view->height + GROUP_EDGE - 1) / GROUP_EDGE);
    if (effect_bits & EFFECT_BIT(EFFECT_INDIRECT_SPECULAR))
        done = done && gpu_buffer_ensure(view->gpu, &view->glossy_tiles, "view.glossy_tiles",
                                         GPU_BUFFER_STATIC, 16 + 4 * tiles);
    else
        gpu_buffer_destroy(&view->glossy_tiles);
    return done;
}

// Rendered size over output size.
static float resolution_scale(const struct frame *frame)
{
    // The reference chooses its own samples per pixel.
    if (frame->gi_capabilities & GI_IS_REFERENCE)
        return 1.0f;
    // While light converges every image is soon replaced: do not supersample a static camera until
    // then. Except without multi-bounce, where pixels request the faces.
    bool settling = frame_has_cones(frame) && !frame->light_converged &&
                    !frame->visibility_changed && frame_has(frame, EFFECT_MULTI_BOUNCE);
    if (settling)
        return fminf(frame->quality->resolution_scale, 1.0f);
    return frame->quality->resolution_scale;
}

bool view_prepare(struct view *view, const struct frame *frame)
{
    const struct frame_params *params = frame->params;
    const struct gpu_scene *gpu_scene = frame->gpu_scene;
    uint32_t effect_bits = frame->plan.bits;
    float scale = resolution_scale(frame);
    // GPU memory is planned for VIEW_MAX_WIDTH x VIEW_MAX_HEIGHT: do not supersample beyond it.
    if ((float)params->width * scale * (float)params->height * scale >
        (float)VIEW_MAX_WIDTH * VIEW_MAX_HEIGHT)
        scale = 1.0f;
    uint32_t width = (uint32_t)((float)params->width * scale);
    uint32_t height = (uint32_t)((float)params->height * scale);
    width = width ? width : 1;
    height = height ? height : 1;
    if (width != view->width || height != view->height) {
        destroy_sized_targets(view);
        if (!create_sized_targets(view, width, height))
            return false;
    }
    struct gpu *gpu = view->gpu;
    size_t offsets[3];
    uint32_t pitches[3];
    size_t output_bytes = view_output_layout(params, offsets, pitches);
    bool done =
        gpu_buffer_ensure(gpu, &view->output, "view.output", GPU_BUFFER_STATIC, output_bytes) &&
        gpu_buffer_ensure(gpu, &view->ring[view->ring_next].pixels, "readback", GPU_BUFFER_READBACK,
                          output_bytes + VIEW_EXPOSURE_BYTES + VIEW_REPORT_BYTES) &&
        draw_list_reserve(&view->draws, gpu_scene) &&
        draw_list_reserve(&view->shadow_draws, gpu_scene);
    if (effect_bits & EFFECT_BIT(EFFECT_LIGHT_TILES)) {
        size_t tiles = (size_t)((width + LIGHT_TILE_EDGE - 1) / LIGHT_TILE_EDGE) *
                       ((height + LIGHT_TILE_EDGE - 1) / LIGHT_TILE_EDGE);
        size_t words = (gpu_scene->counts.lights + 31) / 32;
        done = done && gpu_buffer_ensure(gpu, &view->light_masks, "view.light_masks",
                                         GPU_BUFFER_STATIC, tiles * words * 4);
    } else {
        gpu_buffer_destroy(&view->light_masks);
    }
    if (effect_bits & EFFECT_BIT(EFFECT_TRANSPARENCY)) {
        size_t pixels = (size_t)width * height;
        done = done &&
               gpu_buffer_ensure(gpu, &view->fragments, "view.fragments", GPU_BUFFER_STATIC,
                                 16 + pixels * 4 + pixels * BLENDED_PER_PIXEL * 8) &&
               gpu_buffer_ensure(gpu, &view->transparent_tiles, "view.fragments", GPU_BUFFER_STATIC,
                                 16 + 4 * (size_t)((width + GROUP_EDGE - 1) / GROUP_EDGE) *
                                          ((height + GROUP_EDGE - 1) / GROUP_EDGE));
    } else {
        gpu_buffer_destroy(&view->fragments);
        gpu_buffer_destroy(&view->transparent_tiles);
    }
    done = done && prepare_indirect(view, frame);
    bool cascades =
        (effect_bits & EFFECT_BIT(EFFECT_SHADOWS)) && gpu_scene->directional_light != NO_SHADOW;
    return done && prepare_cascades(view, gpu_scene->shadow_map,
                                    cascades ? frame->quality->shadow_cascades : 0);
}

void view_bind(const struct view *view)
{
    struct gpu *gpu = view->gpu;
    gpu_bind_uniforms(gpu, BIND_FRAME, view->frame_block);
    gpu_bind_storage(gpu, BIND_SHADOW_VIEWS, view->shadow_views);
    gpu_bind_storage(gpu, BIND_GBUFFER, view->gbuffer);
    gpu_bind_storage(gpu, BIND_RADIANCE, view->radiance);
    gpu_bind_storage(gpu, BIND_LIGHT_MASKS, view->light_masks);
    gpu_bind_storage(gpu, BIND_OUTPUT, view->output);
    gpu_bind_storage(gpu, BIND_EXPOSURE, view->exposure);
    gpu_bind_storage(gpu, BIND_FRAGMENTS, view->fragments);
    gpu_bind_storage(gpu, BIND_TILES, view->transparent_tiles);
    gpu_bind_storage(gpu, BIND_INDIRECT, view->accumulation);
    gpu_bind_texture(gpu, UNIT_IDS, view->ids);
    gpu_bind_texture(gpu, UNIT_DEPTH, view->depth);
}
