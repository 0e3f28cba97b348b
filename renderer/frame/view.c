#include "renderer/frame/view.h"

#include <math.h>
#include <stdlib.h>

#include "renderer/frame/settings_block.h"
#include "shared/frame_block.h"
#include "shared/slots.h"

struct view *view_create(struct gpu *gpu)
{
    struct view *view = calloc(1, sizeof(*view));
    if (!view)
        return NULL;
    view->gpu = gpu;
    view->timer = gpu_timer_create(gpu);
    view->frame_block = gpu_buffer_create(gpu, "view_targets.frame", GPU_BUFFER_STATIC,
                                          sizeof(struct frame_block), NULL);
    view->settings_block = gpu_buffer_create(gpu, "view_targets.settings", GPU_BUFFER_STATIC,
                                             SETTINGS_WORD_COUNT * sizeof(uint32_t), NULL);
    view->shadow_views = gpu_buffer_create(
        gpu, "view_targets.shadow_views", GPU_BUFFER_STATIC,
        (MAX_SHADOW_LAYERS + MAX_CASCADES) * sizeof(struct shadow_view_block), NULL);
    if (!view->timer || !view->frame_block || !view->settings_block || !view->shadow_views)
        view_destroy(&view);
    return view;
}

static void destroy_textures(struct view *view)
{
    gpu_framebuffer_destroy(&view->framebuffer);
    gpu_framebuffer_destroy(&view->list_framebuffer);
    gpu_texture_destroy(&view->ids);
    gpu_texture_destroy(&view->depth);
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
    destroy_textures(view);
    for (int i = 0; i < RESOURCE_COUNT; i++)
        gpu_buffer_destroy(&view->buffers[i]);
    view_release_cascades(view);
    draw_list_finish(&view->draws);
    occlusion_finish(&view->occlusion);
    draw_list_finish(&view->shadow_draws);
    gpu_buffer_destroy(&view->frame_block);
    gpu_buffer_destroy(&view->settings_block);
    gpu_buffer_destroy(&view->shadow_views);
    for (uint32_t i = 0; i < RENDERER_FRAMES_IN_RING; i++) {
        gpu_fence_destroy(&view->ring[i].fence);
        gpu_buffer_destroy(&view->ring[i].pixels);
    }
    gpu_timer_destroy(&view->timer);
    free(view);
}

static bool create_textures(struct view *view, uint32_t width, uint32_t height)
{
    struct gpu_texture_params texture = {.label = "view_targets.textures",
                                         .width = width,
                                         .height = height,
                                         .filter = GPU_FILTER_NEAREST};
    texture.format = GPU_FORMAT_R32UI;
    view->ids = gpu_texture_create(view->gpu, &texture);
    texture.format = GPU_FORMAT_DEPTH32F;
    view->depth = gpu_texture_create(view->gpu, &texture);
    if (!view->ids || !view->depth)
        return false;
    view->framebuffer = gpu_framebuffer_create(view->gpu, "visibility", view->ids, view->depth, 0);
    view->list_framebuffer =
        gpu_framebuffer_create(view->gpu, "transparent lists", NULL, view->depth, 0);
    if (!view->framebuffer || !view->list_framebuffer)
        return false;
    view->width = width;
    view->height = height;
    return true;
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

bool view_reserve(struct view *view, struct gpu_scene *gpu_scene, uint32_t cascade_count)
{
    return draw_list_reserve(&view->draws, gpu_scene) &&
           draw_list_reserve(&view->shadow_draws, gpu_scene) &&
           prepare_cascades(view, gpu_scene->shadow_map, cascade_count) &&
           shadow_map_allocate(gpu_scene->shadow_map);
}

// A buffer has exactly the size that its row asks for: what another size or effect has left is
// freed.
static bool prepare_buffer(struct view *view, enum resource resource, const struct frame_inputs *in,
                           const struct frame_plan *plan)
{
    const struct resource_row *row = &resource_rows[resource];
    struct gpu_buffer **buffer = &view->buffers[resource];
    size_t wanted = row->bytes ? row->bytes(in, plan) : 0;
    if (wanted > 0 && wanted < GPU_BUFFER_MIN_BYTES)
        wanted = GPU_BUFFER_MIN_BYTES;
    if (*buffer && gpu_buffer_size_bytes(*buffer) == wanted)
        return true;
    gpu_buffer_destroy(buffer);
    if (wanted > 0)
        *buffer = gpu_buffer_create(view->gpu, row->label, GPU_BUFFER_STATIC, wanted, NULL);
    return *buffer || wanted == 0;
}

bool view_prepare(struct view *view, const struct frame_inputs *in, const struct frame_plan *plan)
{
    if (plan->width != view->width || plan->height != view->height) {
        destroy_textures(view); // also what a failure has left
        if (!create_textures(view, plan->width, plan->height))
            return false;
    }
    for (int i = 0; i < RESOURCE_COUNT; i++)
        if (!prepare_buffer(view, (enum resource)i, in, plan))
            return false;
    return gpu_buffer_ensure(view->gpu, &view->ring[view->ring_next].pixels, "readback",
                             GPU_BUFFER_READBACK,
                             frame_plan_output_bytes(in) + VIEW_EXPOSURE_BYTES + VIEW_REPORT_BYTES);
}

void view_bind(const struct view *view)
{
    struct gpu *gpu = view->gpu;
    gpu_bind_uniforms(gpu, BIND_FRAME, view->frame_block);
    gpu_bind_uniforms(gpu, BIND_SETTINGS, view->settings_block);
    gpu_bind_texels(gpu, UNIT_SHADOW_VIEWS, view->shadow_views, GPU_TEXEL_UINT4);
    gpu_bind_texture(gpu, UNIT_IDS, view->ids);
    gpu_bind_texture(gpu, UNIT_DEPTH, view->depth);
}
