// Clients' measurements of accuracy, on a copy of the document as it is when they ask.
#include "server/render/render_internal.h"

#include <string.h>

#include "renderer/clock.h"

static bool prepare(struct render_thread *thread, const struct render_client *client,
                    const struct command *command, struct accuracy_ticket *out_ticket,
                    struct error *out_error)
{
    const struct view_options *view = &client->options;
    uint64_t start = clock_now_us();
    struct accuracy_request request = {
        .client_id = client->client_id,
        .scene = scene_copy(thread->scene),
        .source = thread->scene_label,
        .revision = thread->revision,
        .params = {.camera = view->camera,
                   .width = view->width,
                   .height = view->height,
                   .quality = view->quality,
                   .settings = render_resolve_settings(thread)},
        .sweep = command_sweep_names[command->sweep],
        .until_noise = command->noise,
        .max_s = command->seconds,
    };
    if (!request.scene)
        return error_set(out_error, "out of memory for a copy of the scene");
    log_write(LOG_DEBUG, "scene_copied client=%u time_us=%llu", client->client_id,
              (unsigned long long)(clock_now_us() - start));
    return accuracy_service_prepare(thread->params.accuracy, &request, out_ticket, out_error);
}

void render_run_accuracy_start(struct render_thread *thread, struct render_client *client,
                               const struct command *command)
{
    struct accuracy_ticket ticket = {0};
    struct error error = {""};
    struct rpc_error reply;
    if (thread->settings.gi_method == GI_METHOD_REFERENCE) {
        rpc_error_field(&reply, "gi_method", NULL,
                        "gi_method is reference, which is what others are measured by; choose "
                        "none, clipmap or grid first");
        render_reply_error(thread, command, &reply);
        return;
    }
    if (!prepare(thread, client, command, &ticket, &error)) {
        rpc_error_set(&reply, RPC_INTERNAL_ERROR, "%s", error.message);
        render_reply_error(thread, command, &reply);
        return;
    }
    cJSON *result = cJSON_CreateObject();
    cJSON_AddStringToObject(result, "measurement", ticket.id);
    cJSON_AddNumberToObject(result, "rung_count", ticket.configuration_count);
    cJSON_AddNumberToObject(result, "width", ticket.width);
    cJSON_AddNumberToObject(result, "height", ticket.height);
    cJSON_AddNumberToObject(result, "epoch", (double)thread->epoch);
    cJSON_AddNumberToObject(result, "revision", (double)thread->revision);
    render_clear_configuration(thread, client);
    render_reply(thread, command, result);
    accuracy_service_submit(thread->params.accuracy, client->client_id);
}

void render_run_accuracy_cancel(struct render_thread *thread, const struct command *command)
{
    accuracy_service_cancel(thread->params.accuracy, command->client_id);
    render_reply(thread, command, cJSON_CreateObject());
}

bool render_find_configuration(struct render_thread *thread, const struct command *command,
                               struct configuration_override *out_configuration,
                               struct rpc_error *out_error)
{
    for (uint32_t i = 0; i < command->value_count; i++) {
        const struct parameter_value *value = &command->values[i];
        struct frame_params params;
        struct error error;
        double scale;
        if (strcmp(value->parameter->name, "rung") != 0 || !value->text[0])
            continue;
        if (!accuracy_service_get_configuration(thread->params.accuracy, command->client_id,
                                                value->text, &params, &scale, &error))
            return rpc_error_field(out_error, "rung", NULL, "rung: %s", error.message);
        *out_configuration = (struct configuration_override){
            .quality = params.quality, .scale = scale, .settings = params.settings};
    }
    return true;
}

void render_clear_configuration(struct render_thread *thread, struct render_client *client)
{
    if (!client->client_id || !client->options.rung[0])
        return;
    client->options.rung[0] = '\0';
    render_mark_dirty(thread, client);
}
