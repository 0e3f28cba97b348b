#include "server/stream/outbox.h"

#include <pthread.h>
#include <stdlib.h>

struct outbox {
    struct outbox_params params;
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    bool closed;
    uint32_t first;
    uint32_t count;
    struct outbox_message messages[OUTBOX_CAPACITY];
};

struct outbox *outbox_create(const struct outbox_params *params)
{
    struct outbox *outbox = calloc(1, sizeof(*outbox));
    if (!outbox)
        return NULL;
    outbox->params = *params;
    pthread_mutex_init(&outbox->mutex, NULL);
    pthread_cond_init(&outbox->changed, NULL);
    return outbox;
}

void outbox_destroy(struct outbox **outbox)
{
    if (!*outbox)
        return;
    struct outbox_message message;
    while (outbox_take(*outbox, &message))
        free(message.text);
    pthread_cond_destroy(&(*outbox)->changed);
    pthread_mutex_destroy(&(*outbox)->mutex);
    free(*outbox);
    *outbox = NULL;
}

void outbox_post(struct outbox *outbox, uint32_t client_id, char *text)
{
    if (!text)
        return;
    pthread_mutex_lock(&outbox->mutex);
    while (outbox->count == OUTBOX_CAPACITY && !outbox->closed)
        pthread_cond_wait(&outbox->changed, &outbox->mutex);
    bool wake = outbox->count == 0 && !outbox->closed;
    if (!outbox->closed) {
        uint32_t last = (outbox->first + outbox->count++) % OUTBOX_CAPACITY;
        outbox->messages[last] = (struct outbox_message){client_id, text};
        text = NULL;
    }
    pthread_mutex_unlock(&outbox->mutex);
    free(text);
    if (wake)
        outbox->params.wake(outbox->params.user);
}

bool outbox_take(struct outbox *outbox, struct outbox_message *out_message)
{
    pthread_mutex_lock(&outbox->mutex);
    bool taken = outbox->count > 0;
    if (taken) {
        *out_message = outbox->messages[outbox->first];
        outbox->first = (outbox->first + 1) % OUTBOX_CAPACITY;
        outbox->count--;
        pthread_cond_signal(&outbox->changed);
    }
    pthread_mutex_unlock(&outbox->mutex);
    return taken;
}

void outbox_close(struct outbox *outbox)
{
    pthread_mutex_lock(&outbox->mutex);
    outbox->closed = true;
    pthread_cond_broadcast(&outbox->changed);
    pthread_mutex_unlock(&outbox->mutex);
}
