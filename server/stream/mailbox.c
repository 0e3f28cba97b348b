#include "server/stream/mailbox.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

struct mailbox {
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    bool woken;
    uint32_t count;
    struct command *commands[MAILBOX_CAPACITY]; // oldest first
};

struct mailbox *mailbox_create(void)
{
    struct mailbox *mailbox = calloc(1, sizeof(*mailbox));
    if (!mailbox)
        return NULL;
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_mutex_init(&mailbox->mutex, NULL);
    pthread_cond_init(&mailbox->changed, &attributes);
    pthread_condattr_destroy(&attributes);
    return mailbox;
}

void mailbox_destroy(struct mailbox **mailbox)
{
    if (!*mailbox)
        return;
    for (uint32_t i = 0; i < (*mailbox)->count; i++)
        free((*mailbox)->commands[i]);
    pthread_cond_destroy(&(*mailbox)->changed);
    pthread_mutex_destroy(&(*mailbox)->mutex);
    free(*mailbox);
    *mailbox = NULL;
}

static struct command *remove_at(struct mailbox *mailbox, uint32_t index)
{
    struct command *command = mailbox->commands[index];
    mailbox->count--;
    memmove(&mailbox->commands[index], &mailbox->commands[index + 1],
            (mailbox->count - index) * sizeof(mailbox->commands[0]));
    return command;
}

// The index of the waiting command that `command` supersedes, or mailbox->count.
static uint32_t find_superseded(const struct mailbox *mailbox, const struct command *command)
{
    for (uint32_t i = mailbox->count; i-- > 0;) {
        const struct command *older = mailbox->commands[i];
        if (older->client_id != command->client_id)
            continue;
        if (command_supersedes(command, older))
            return older->superseded_count < COMMAND_MAX_SUPERSEDED ? i : mailbox->count;
        if (!(method_get_flags(older->method) & METHOD_MERGES))
            break;
    }
    return mailbox->count;
}

static void pass_on_edit_ids(const struct command *older, struct command *newer)
{
    memcpy(newer->superseded, older->superseded, sizeof(newer->superseded));
    newer->superseded_count = older->superseded_count;
    if (older->has_edit_id)
        newer->superseded[newer->superseded_count++] = older->edit_id;
}

static bool has_room(const struct mailbox *mailbox, uint32_t client_id)
{
    uint32_t own = 0;
    for (uint32_t i = 0; i < mailbox->count; i++)
        own += mailbox->commands[i]->client_id == client_id;
    return mailbox->count < MAILBOX_CAPACITY && own < MAILBOX_MAX_PER_CLIENT;
}

enum mailbox_result mailbox_post(struct mailbox *mailbox, struct command *command,
                                 struct rpc_id *out_superseded)
{
    enum mailbox_result result = MAILBOX_POSTED;
    pthread_mutex_lock(&mailbox->mutex);
    uint32_t index = find_superseded(mailbox, command);
    if (index < mailbox->count) {
        struct command *older = remove_at(mailbox, index);
        pass_on_edit_ids(older, command);
        *out_superseded = older->id;
        free(older);
        result = MAILBOX_SUPERSEDED;
    } else if (!has_room(mailbox, command->client_id)) {
        result = MAILBOX_FULL;
    }
    if (result != MAILBOX_FULL) {
        mailbox->commands[mailbox->count++] = command;
        pthread_cond_signal(&mailbox->changed);
    }
    pthread_mutex_unlock(&mailbox->mutex);
    return result;
}

struct command *mailbox_take(struct mailbox *mailbox)
{
    pthread_mutex_lock(&mailbox->mutex);
    struct command *command = mailbox->count > 0 ? remove_at(mailbox, 0) : NULL;
    pthread_mutex_unlock(&mailbox->mutex);
    return command;
}

void mailbox_wait(struct mailbox *mailbox, uint64_t deadline_us)
{
    struct timespec deadline = {.tv_sec = (time_t)(deadline_us / 1000000u),
                                .tv_nsec = (long)(deadline_us % 1000000u) * 1000};
    pthread_mutex_lock(&mailbox->mutex);
    int status = 0;
    while (!mailbox->woken && mailbox->count == 0 && status == 0) {
        if (deadline_us == MAILBOX_NO_DEADLINE)
            status = pthread_cond_wait(&mailbox->changed, &mailbox->mutex);
        else
            status = pthread_cond_timedwait(&mailbox->changed, &mailbox->mutex, &deadline);
    }
    mailbox->woken = false;
    pthread_mutex_unlock(&mailbox->mutex);
}

void mailbox_wake(struct mailbox *mailbox)
{
    pthread_mutex_lock(&mailbox->mutex);
    mailbox->woken = true;
    pthread_cond_signal(&mailbox->changed);
    pthread_mutex_unlock(&mailbox->mutex);
}
