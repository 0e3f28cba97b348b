#include "server/document/edit_log.h"

#include "renderer/renderer.h"

void edit_log_add(struct edit_log *log, uint64_t revision, cJSON *edit)
{
    if (log->count == EDIT_LOG_ENTRIES) {
        cJSON_Delete(log->entries[log->first].edit);
        log->first = (log->first + 1) % EDIT_LOG_ENTRIES;
        log->count--;
    }
    uint32_t last = (log->first + log->count++) % EDIT_LOG_ENTRIES;
    log->entries[last].revision = revision;
    log->entries[last].edit = edit;
}

void edit_log_clear(struct edit_log *log)
{
    for (uint32_t i = 0; i < log->count; i++)
        cJSON_Delete(log->entries[(log->first + i) % EDIT_LOG_ENTRIES].edit);
    log->count = 0;
    log->first = 0;
}

cJSON *edit_log_since(const struct edit_log *log, uint64_t since, uint64_t newest)
{
    if (since > newest || newest - since > log->count)
        return NULL;
    cJSON *edits = cJSON_CreateArray();
    for (uint32_t i = 0; i < log->count; i++) {
        uint32_t at = (log->first + i) % EDIT_LOG_ENTRIES;
        if (log->entries[at].revision > since)
            cJSON_AddItemToArray(edits, cJSON_Duplicate(log->entries[at].edit, true));
    }
    return edits;
}
