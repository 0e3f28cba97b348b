// The stats notification.
#include "server/render/render_internal.h"

#include <stdlib.h>

#include "renderer/clock.h"
#include "server/accuracy/statistics_json.h"

static void add_pass_time(cJSON *pass, const struct frame_statistics *statistics, uint32_t index,
                          const void *user)
{
    (void)user;
    bool ran = statistics->passes[index].ran;
    cJSON_AddBoolToObject(pass, "ran", ran);
    cJSON_AddNumberToObject(pass, "time_ms", ran ? statistics->passes[index].time_ms : 0.0);
}

// The stage that takes longest. Waiting for an acknowledgement counts only where it is longer than
// two frames under way can hide.
static const char *find_bottleneck(double render_ms, const struct stage_times *times)
{
    struct {
        const char *name;
        double time_ms;
    } stages[] = {
        {"render", render_ms},
        {"encode", times->encode_ms},
        {"network", times->send_wait_ms},
        {"client", times->acknowledge_ms / FRAME_STREAM_MAX_UNACKNOWLEDGED},
    };
    const char *name = "none";
    double longest_ms = 0.0;
    for (size_t i = 0; i < sizeof(stages) / sizeof(stages[0]); i++) {
        if (stages[i].time_ms > longest_ms) {
            longest_ms = stages[i].time_ms;
            name = stages[i].name;
        }
    }
    return name;
}

static void add_stages(cJSON *params, const struct render_client *client,
                       const struct stage_times *times)
{
    double draw_ms = client->header.draw_us / 1000.0;
    double readback_ms = client->header.readback_us / 1000.0;
    cJSON *stages = cJSON_AddObjectToObject(params, "stages_ms");
    cJSON_AddNumberToObject(stages, "queue", client->header.queue_us / 1000.0);
    cJSON_AddNumberToObject(stages, "draw", draw_ms);
    cJSON_AddNumberToObject(stages, "readback", readback_ms);
    cJSON_AddNumberToObject(stages, "encode", times->encode_ms);
    cJSON_AddNumberToObject(stages, "send_wait", times->send_wait_ms);
    cJSON_AddNumberToObject(stages, "acknowledge", times->acknowledge_ms);
    cJSON_AddStringToObject(params, "bottleneck", find_bottleneck(draw_ms + readback_ms, times));
}

void render_send_statistics(struct render_thread *thread, uint32_t slot)
{
    struct render_client *client = &thread->clients[slot];
    struct frame_statistics *statistics = calloc(1, sizeof(*statistics));
    if (!statistics)
        return;
    struct stage_times times;
    struct frame_stream_totals totals;
    renderer_view_get_statistics(thread->renderer, client->view, statistics);
    frame_stream_get_times(thread->params.stream, slot, &times);
    frame_stream_get_totals(thread->params.stream, &totals);
    cJSON *params = cJSON_CreateObject();
    cJSON_AddNumberToObject(params, "frame_id", (double)client->frame_count);
    cJSON_AddNumberToObject(params, "edit_id", (double)client->header.edit_id);
    cJSON_AddNumberToObject(params, "camera_revision", (double)client->header.camera_revision);
    cJSON_AddNumberToObject(params, "width", client->options.width);
    cJSON_AddNumberToObject(params, "height", client->options.height);
    cJSON_AddNumberToObject(params, "render_width", statistics->render_width);
    cJSON_AddNumberToObject(params, "render_height", statistics->render_height);
    cJSON_AddStringToObject(params, "quality", quality_names[client->drawn_row]);
    cJSON_AddStringToObject(params, "wanted_quality", quality_names[client->drawn_wanted]);
    cJSON_AddNumberToObject(params, "convergence", (double)client->convergence);
    cJSON_AddNumberToObject(params, "frames_per_second", client->frames_per_second);
    cJSON_AddNumberToObject(params, "frame_time_ms", statistics->frame_time_ms);
    cJSON_AddNumberToObject(params, "jpeg_bytes", times.jpeg_bytes);
    cJSON_AddNumberToObject(params, "exposure", statistics->exposure);
    cJSON_AddNumberToObject(params, "clients", totals.client_count);
    statistics_add_json(params, statistics,
                        &(struct statistics_format){
                            .add_times = add_pass_time, .memory_key = "memory", .lists = true});
    add_stages(params, client, &times);
    outbox_post(thread->params.outbox, client->client_id, rpc_write_notification("stats", params));
    client->statistics_due = false;
    client->statistics_at_us = clock_now_us();
    free(statistics);
}
