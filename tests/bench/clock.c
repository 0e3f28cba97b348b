// Prints the processor's clock in GHz: additions of which each waits for the last take a cycle
// each.
#include <stdint.h>
#include <stdio.h>
#include <time.h>

#define ROUNDS 20000000
#define TRIES  5

static double now_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// The compiler must not join additions.
#define ADD                                                                                        \
    sum += 1, __extension__({                                                                      \
        __asm__ volatile("" : "+r"(sum));                                                          \
        0;                                                                                         \
    })
#define ADD_8 (void)(ADD, ADD, ADD, ADD, ADD, ADD, ADD, ADD)

int main(void)
{
    double best = 0.0;
    for (int i = 0; i < TRIES; i++) {
        uint64_t sum = 0;
        double began = now_s();
        for (int j = 0; j < ROUNDS; j++)
            ADD_8;
        double rate = (double)sum / (now_s() - began) * 1e-9;
        best = rate > best ? rate : best;
    }
    printf("%.2f\n", best);
    return 0;
}
