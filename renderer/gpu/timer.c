#include "renderer/gpu/timer.h"

#include <assert.h>
#include <stdlib.h>

#include "renderer/gpu/internal.h"

#define FRAMES_IN_FLIGHT 4

struct gpu_timer {
    struct gpu *gpu;
    GLuint queries[FRAMES_IN_FLIGHT][GPU_TIMER_SLOTS][2];
    bool pending[FRAMES_IN_FLIGHT][GPU_TIMER_SLOTS];
    double started_ms[GPU_TIMER_SLOTS];
    double time_ms[GPU_TIMER_SLOTS];
    uint32_t frame;
};

struct gpu_timer *gpu_timer_create(struct gpu *gpu)
{
    struct gpu_timer *timer = calloc(1, sizeof(*timer));
    if (!timer)
        return NULL;
    timer->gpu = gpu;
    if (gpu->info.gpu_timers)
        glCreateQueries(GL_TIMESTAMP, FRAMES_IN_FLIGHT * GPU_TIMER_SLOTS * 2,
                        &timer->queries[0][0][0]);
    return timer;
}

void gpu_timer_destroy(struct gpu_timer **timer)
{
    if (*timer && (*timer)->gpu->info.gpu_timers)
        glDeleteQueries(FRAMES_IN_FLIGHT * GPU_TIMER_SLOTS * 2, &(*timer)->queries[0][0][0]);
    free(*timer);
    *timer = NULL;
}

void gpu_timer_begin_frame(struct gpu_timer *timer)
{
    gpu_timer_poll(timer);
    timer->frame = (timer->frame + 1) % FRAMES_IN_FLIGHT;
    // Gives up results that have not arrived after FRAMES_IN_FLIGHT frames, rather than wait.
    for (uint32_t slot = 0; slot < GPU_TIMER_SLOTS; slot++)
        timer->pending[timer->frame][slot] = false;
}

void gpu_timer_begin(struct gpu_timer *timer, uint32_t slot)
{
    assert(slot < GPU_TIMER_SLOTS);
    if (timer->gpu->info.gpu_timers)
        glQueryCounter(timer->queries[timer->frame][slot][0], GL_TIMESTAMP);
    else
        timer->started_ms[slot] = gpu_clock_ms(timer->gpu);
}

void gpu_timer_end(struct gpu_timer *timer, uint32_t slot)
{
    assert(slot < GPU_TIMER_SLOTS);
    if (timer->gpu->info.gpu_timers) {
        glQueryCounter(timer->queries[timer->frame][slot][1], GL_TIMESTAMP);
        timer->pending[timer->frame][slot] = true;
        return;
    }
    // CPU drivers queue rasterisation: finish it here, so that each pass shows its own time. The
    // frame needs the work anyway before it is read back.
    glFinish();
    timer->time_ms[slot] = gpu_clock_ms(timer->gpu) - timer->started_ms[slot];
}

void gpu_timer_poll(struct gpu_timer *timer)
{
    if (!timer->gpu->info.gpu_timers)
        return;
    // Oldest frame first, so that the newest result wins.
    for (uint32_t age = FRAMES_IN_FLIGHT; age-- > 0;) {
        uint32_t frame = (timer->frame + FRAMES_IN_FLIGHT - age) % FRAMES_IN_FLIGHT;
        for (uint32_t slot = 0; slot < GPU_TIMER_SLOTS; slot++) {
            if (!timer->pending[frame][slot])
                continue;
            GLint available = 0;
            GLuint *pair = timer->queries[frame][slot];
            glGetQueryObjectiv(pair[1], GL_QUERY_RESULT_AVAILABLE, &available);
            if (!available)
                continue;
            GLuint64 begin = 0, end = 0;
            glGetQueryObjectui64v(pair[0], GL_QUERY_RESULT, &begin);
            glGetQueryObjectui64v(pair[1], GL_QUERY_RESULT, &end);
            timer->time_ms[slot] = end > begin ? (double)(end - begin) / 1e6 : 0.0;
            timer->pending[frame][slot] = false;
        }
    }
}

double gpu_timer_get_ms(const struct gpu_timer *timer, uint32_t slot)
{
    assert(slot < GPU_TIMER_SLOTS);
    return timer->time_ms[slot];
}

bool gpu_timer_probe(struct gpu *gpu)
{
    (void)gpu;
    GLint bits = 0;
    glGetQueryiv(GL_TIMESTAMP, GL_QUERY_COUNTER_BITS, &bits);
    return bits >= 32;
}
