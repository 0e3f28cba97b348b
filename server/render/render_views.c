// The clients' views: whose turn it is, drawing, and passing on pixels.
#include "server/render/render_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/clock.h"

#define STATISTICS_INTERVAL_US 500000u

// How long to wait before asking a reference for news again.
#define PENDING_US 30000u

// While one client's view moves, frames that only converge take at most 1/REFINE_FRACTION of the
// time.
#define REFINE_FRACTION 8u

struct render_client *render_find_client(struct render_thread *thread, uint32_t client_id)
{
    for (uint32_t i = 0; client_id && i < FRAME_STREAM_MAX_CLIENTS; i++) {
        if (thread->clients[i].client_id == client_id)
            return &thread->clients[i];
    }
    return NULL;
}

struct render_client *render_add_client(struct render_thread *thread, uint32_t client_id)
{
    for (uint32_t slot = 0; slot < FRAME_STREAM_MAX_CLIENTS; slot++) {
        if (frame_stream_get_client(thread->params.stream, slot) != client_id)
            continue;
        struct render_client *client = &thread->clients[slot];
        memset(client, 0, sizeof(*client));
        client->view = renderer_view_create(thread->renderer);
        if (!client->view)
            return NULL;
        client->client_id = client_id;
        client->statistics_at_us = clock_now_us(); // the first statistics cover encoded frames, too
        view_options_init(&client->options);
        if (thread->scene)
            render_reset_camera(thread->scene, &client->options.camera);
        render_mark_moving(thread, client);
        return client;
    }
    return NULL;
}

void render_drop_views(struct render_thread *thread)
{
    for (uint32_t slot = 0; slot < FRAME_STREAM_MAX_CLIENTS; slot++) {
        struct render_client *client = &thread->clients[slot];
        if (client->drawing)
            frame_stream_finish(thread->params.stream, slot, NULL);
        client->drawing = false;
        if (client->view)
            renderer_view_destroy(thread->renderer, &client->view);
    }
}

bool render_renew_views(struct render_thread *thread)
{
    for (uint32_t slot = 0; slot < FRAME_STREAM_MAX_CLIENTS; slot++) {
        struct render_client *client = &thread->clients[slot];
        if (!client->client_id)
            continue;
        client->view = renderer_view_create(thread->renderer);
        if (!client->view)
            return false;
        render_mark_moving(thread, client);
        render_notice(thread, client->client_id, "error",
                      "the graphics driver was reset; images start anew");
    }
    return true;
}

void render_remove_gone_clients(struct render_thread *thread, bool all)
{
    for (uint32_t slot = 0; slot < FRAME_STREAM_MAX_CLIENTS; slot++) {
        struct render_client *client = &thread->clients[slot];
        if (!client->client_id ||
            (!all && frame_stream_get_client(thread->params.stream, slot) == client->client_id))
            continue;
        if (client->drawing)
            frame_stream_finish(thread->params.stream, slot, NULL);
        accuracy_service_forget(thread->params.accuracy, client->client_id);
        if (client->view)
            renderer_view_destroy(thread->renderer, &client->view);
        edit_history_clear(&client->history);
        memset(client, 0, sizeof(*client));
    }
    frame_stream_collect_closed(thread->params.stream);
}

void render_mark_dirty(struct render_thread *thread, struct render_client *client)
{
    uint64_t now = clock_now_us();
    for (uint32_t i = 0; i < FRAME_STREAM_MAX_CLIENTS; i++) {
        struct render_client *each = &thread->clients[i];
        if (!each->client_id || (client && each != client))
            continue;
        each->dirty = true;
        each->pending_until_us = 0;
        if (each->dirty_since_us == 0)
            each->dirty_since_us = now;
    }
}

void render_mark_moving(struct render_thread *thread, struct render_client *client)
{
    uint64_t now = clock_now_us();
    for (uint32_t i = 0; i < FRAME_STREAM_MAX_CLIENTS; i++) {
        struct render_client *each = &thread->clients[i];
        if (each->client_id && (!client || each == client))
            quality_controller_move(&each->quality, now);
    }
    render_mark_dirty(thread, client);
}

static struct quality_request request_of(const struct render_client *client)
{
    if (client->options.rung[0])
        return (struct quality_request){.wanted = client->configuration.quality};
    return (struct quality_request){.wanted = client->options.quality,
                                    .adaptive = client->options.adaptive,
                                    .target_frame_ms = client->options.target_frame_ms};
}

static enum quality choose_row(const struct render_client *client, uint64_t now)
{
    struct quality_request request = request_of(client);
    return quality_controller_choose(&client->quality, &request, now);
}

static bool wants_draw(struct render_thread *thread, uint32_t slot, uint64_t now)
{
    const struct render_client *client = &thread->clients[slot];
    return client->client_id && thread->scene && !client->drawing && !client->options.paused &&
           now >= client->pending_until_us &&
           (client->dirty || choose_row(client, now) != client->drawn_row) &&
           frame_stream_wants_frame(thread->params.stream, slot);
}

// Whether the client's image is out of date, rather than only not converged.
static bool is_urgent(const struct render_client *client, uint64_t now)
{
    return client->dirty_since_us != 0 || quality_controller_is_moving(&client->quality, now);
}

// The time from which frames may be drawn that only converge: at once, if nobody moves.
static uint64_t refine_from_us(const struct render_thread *thread, uint64_t now)
{
    for (uint32_t i = 0; i < FRAME_STREAM_MAX_CLIENTS; i++) {
        const struct render_client *client = &thread->clients[i];
        if (client->client_id && !client->options.paused &&
            quality_controller_is_moving(&client->quality, now))
            return thread->refined_at_us + (REFINE_FRACTION - 1) * thread->refine_us;
    }
    return 0;
}

uint64_t render_next_draw_us(struct render_thread *thread)
{
    uint64_t now = clock_now_us(), next = QUALITY_NEVER;
    uint64_t refine_us = refine_from_us(thread, now);
    for (uint32_t slot = 0; slot < FRAME_STREAM_MAX_CLIENTS; slot++) {
        const struct render_client *client = &thread->clients[slot];
        if (!client->client_id || client->options.paused)
            continue;
        struct quality_request request = request_of(client);
        uint64_t change = quality_controller_next_us(&client->quality, &request, now);
        // Time has passed since the last query: the client may have come to rest just now.
        if (client->pending_until_us > now)
            change = client->pending_until_us;
        else if (wants_draw(thread, slot, now))
            change = is_urgent(client, now) || refine_us < now ? now : refine_us;
        next = change < next ? change : next;
    }
    return next;
}

uint64_t render_idle_from_us(struct render_thread *thread)
{
    uint64_t now = clock_now_us(), from = now;
    for (uint32_t slot = 0; slot < FRAME_STREAM_MAX_CLIENTS; slot++) {
        const struct render_client *client = &thread->clients[slot];
        if (!client->client_id || client->options.paused)
            continue;
        if (client->drawing || wants_draw(thread, slot, now))
            return QUALITY_NEVER;
        uint64_t rest_from_us = client->quality.moved_at_us + QUALITY_REST_US;
        if (quality_controller_is_moving(&client->quality, now) && rest_from_us > from)
            from = rest_from_us;
    }
    return from;
}

static void fill_header(struct render_thread *thread, struct render_client *client,
                        uint64_t start_us)
{
    client->header = (struct frame_header){
        .view_id = client->client_id,
        .frame_id = client->frame_count + 1,
        .scene_revision = thread->revision,
        .edit_id = client->edit_id,
        .camera_revision = client->camera_revision,
        .quality = (uint8_t)client->drawn_row,
        .debug_view = (uint8_t)client->options.debug_view,
        .codec = (uint8_t)client->options.codec,
        .epoch = (uint16_t)thread->epoch,
        .queue_us = client->dirty_since_us ? (uint32_t)(start_us - client->dirty_since_us) : 0,
        .draw_at_us = start_us,
    };
}

// The newest frame also shows the commands since, since they changed nothing of the image. True if
// there were any; clients learn of them by the statistics.
static bool take_unchanged(struct render_client *client)
{
    struct frame_header *shown = &client->header;
    bool news =
        shown->camera_revision != client->camera_revision || shown->edit_id != client->edit_id;
    shown->camera_revision = client->camera_revision;
    shown->edit_id = client->edit_id;
    return news;
}

static void fail_draw(struct render_thread *thread, struct render_client *client,
                      const struct error *error)
{
    client->dirty = false;
    client->dirty_since_us = 0;
    log_write(LOG_ERROR, "draw_failed client=%u width=%u height=%u reason=\"%s\"",
              client->client_id, client->options.width, client->options.height, error->message);
    render_notice(thread, client->client_id, "error", error->message);
}

struct render_settings render_resolve_settings(const struct render_thread *thread)
{
    struct render_settings settings = thread->settings;
    if (settings.voxel_resolution == VOXEL_RESOLUTION_AUTO)
        settings.voxel_resolution = renderer_get_info(thread->renderer)->software
                                        ? VOXEL_RESOLUTION_64
                                        : VOXEL_RESOLUTION_128;
    return settings;
}

// Exposure and tone curve stay those of the shared settings.
static void apply_configuration(const struct configuration_override *configuration,
                                struct frame_params *params)
{
    struct render_settings settings = configuration->settings;
    render_settings_take(&settings, &params->settings, INVALIDATES_DISPLAY);
    params->settings = settings;
    params->own_voxels = true;
    double scale = configuration->scale;
    scale = fmin(scale, (double)VIEW_MAX_WIDTH / params->width);
    scale = fmin(scale, (double)VIEW_MAX_HEIGHT / params->height);
    params->width = (uint32_t)fmax(round(params->width * scale), VIEW_MIN_EDGE);
    params->height = (uint32_t)fmax(round(params->height * scale), VIEW_MIN_EDGE);
}

static bool draw(struct render_thread *thread, uint32_t slot, uint64_t now)
{
    struct render_client *client = &thread->clients[slot];
    client->drawn_row = choose_row(client, now);
    client->drawn_wanted = request_of(client).wanted;
    client->drawn_moving = quality_controller_is_moving(&client->quality, now);
    client->drawn_to_refine = !is_urgent(client, now);
    if (client->drawn_to_refine)
        thread->refined_at_us = now;
    struct frame_params params = {
        .camera = client->options.camera,
        .width = client->options.width,
        .height = client->options.height,
        .quality = client->drawn_row,
        .debug_view = client->options.debug_view,
        .debug_level = client->options.debug_level,
        .debug_face = client->options.debug_face,
        .output = FRAME_OUTPUT_YCBCR,
        .settings = render_resolve_settings(thread),
        .user_id = client->frame_count + 1,
    };
    if (client->options.rung[0])
        apply_configuration(&client->configuration, &params);
    struct error error = {""};
    uint64_t start = clock_now_us();
    enum render_result result = renderer_view_draw(thread->renderer, client->view, &params, &error);
    if (result == RENDER_FAILED) {
        fail_draw(thread, client, &error);
    } else if (result == RENDER_UNCHANGED) {
        client->dirty = false;
        client->dirty_since_us = 0;
        if (take_unchanged(client) || client->statistics_due)
            render_send_statistics(thread, slot);
    } else if (result == RENDER_PENDING) {
        client->dirty_since_us = 0;
        client->pending_until_us = clock_now_us() + PENDING_US;
    } else if (result == RENDER_DRAWN) {
        fill_header(thread, client, start);
        client->dirty = true; // until the renderer says that nothing more is to be drawn
        client->dirty_since_us = 0;
        client->drawn_at_us = clock_now_us();
        client->header.draw_us = (uint32_t)(client->drawn_at_us - start);
        client->frame_count++;
        client->drawing = true;
        frame_stream_begin(thread->params.stream, slot);
    }
    return result == RENDER_DRAWN;
}

// Draws for the next client, in turn, that is urgent (or not).
static bool draw_one_of(struct render_thread *thread, bool urgent)
{
    for (uint32_t i = 0; i < FRAME_STREAM_MAX_CLIENTS; i++) {
        uint32_t slot = (thread->next_client + i) % FRAME_STREAM_MAX_CLIENTS;
        uint64_t now = clock_now_us();
        if (is_urgent(&thread->clients[slot], now) != urgent || !wants_draw(thread, slot, now))
            continue;
        if (draw(thread, slot, now)) {
            thread->next_client = slot + 1;
            return true;
        }
    }
    return false;
}

bool render_draw_next(struct render_thread *thread)
{
    uint64_t now = clock_now_us(), refine_us = refine_from_us(thread, now);
    // While somebody moves, refinement gets 1/REFINE_FRACTION of the time, and priority when it is
    // due.
    if (refine_us > 0 && refine_us <= now && draw_one_of(thread, false))
        return true;
    return draw_one_of(thread, true) || (refine_us == 0 && draw_one_of(thread, false));
}

static void count_frame(struct render_thread *thread, struct render_client *client, uint64_t now)
{
    double interval_s = (double)(now - client->collected_at_us) / 1e6;
    if (interval_s > 1.0 || interval_s <= 0.0)
        client->frames_per_second = 0.0;
    else if (client->frames_per_second == 0.0)
        client->frames_per_second = 1.0 / interval_s;
    else
        client->frames_per_second += 0.1 * (1.0 / interval_s - client->frames_per_second);
    client->collected_at_us = now;
    client->statistics_due = true;
    pthread_mutex_lock(&thread->status_mutex);
    thread->status.frames_drawn++;
    thread->status.draw_us += now - client->header.draw_at_us;
    pthread_mutex_unlock(&thread->status_mutex);
}

static void take_convergence(struct render_client *client, const struct frame_pixels *pixels)
{
    client->convergence =
        quality_convergence(client->drawn_row, client->drawn_wanted, pixels->convergence);
    client->header.convergence = client->convergence;
    client->header.reference_samples = pixels->reference_samples;
    client->header.reference_noise = pixels->reference_noise;
    if (client->convergence >= 1.0f)
        client->header.flags |= FRAME_CONVERGED;
    struct quality_request request = request_of(client);
    quality_controller_take_frame(&client->quality, &request, client->drawn_row,
                                  client->drawn_moving, pixels->frame_time_ms);
}

static void take_refine_time(struct render_thread *thread, const struct render_client *client,
                             uint64_t now)
{
    if (!client->drawn_to_refine)
        return;
    thread->refined_at_us = now;
    thread->refine_us = now - client->header.draw_at_us;
}

// False if the frame is not there yet.
static bool collect(struct render_thread *thread, uint32_t slot, bool wait)
{
    struct render_client *client = &thread->clients[slot];
    struct frame_pixels pixels;
    if (!renderer_view_collect(thread->renderer, client->view, wait, &pixels)) {
        if (!wait)
            return false;
        log_write(LOG_ERROR, "frame_lost client=%u", client->client_id);
        client->drawing = false;
        frame_stream_finish(thread->params.stream, slot, NULL);
        return true;
    }
    uint64_t now = clock_now_us();
    client->header.readback_us = (uint32_t)(now - client->drawn_at_us);
    take_convergence(client, &pixels);
    take_refine_time(thread, client, now);
    encode_workers_submit(thread->params.workers, slot, &client->header, &pixels);
    renderer_view_release(thread->renderer, client->view);
    client->drawing = false;
    count_frame(thread, client, now);
    if (now - client->statistics_at_us >= STATISTICS_INTERVAL_US)
        render_send_statistics(thread, slot);
    return true;
}

bool render_collect(struct render_thread *thread, bool wait)
{
    bool collected = false;
    uint32_t oldest = FRAME_STREAM_MAX_CLIENTS;
    for (uint32_t slot = 0; slot < FRAME_STREAM_MAX_CLIENTS; slot++) {
        const struct render_client *client = &thread->clients[slot];
        if (!client->drawing)
            continue;
        if (collect(thread, slot, false))
            collected = true;
        else if (oldest == FRAME_STREAM_MAX_CLIENTS ||
                 client->drawn_at_us < thread->clients[oldest].drawn_at_us)
            oldest = slot;
    }
    if (wait && !collected && oldest < FRAME_STREAM_MAX_CLIENTS)
        collected = collect(thread, oldest, true);
    return collected;
}
