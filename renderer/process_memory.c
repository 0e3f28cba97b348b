#include "renderer/process_memory.h"

#include <stdio.h>

struct process_memory process_memory_read(void)
{
    struct process_memory memory = {0};
    char line[256];
    FILE *status = fopen("/proc/self/status", "r");
    while (status && fgets(line, sizeof(line), status)) {
        unsigned long long kib;
        if (sscanf(line, "VmRSS: %llu", &kib) == 1)
            memory.rss_bytes = kib << 10;
        if (sscanf(line, "VmHWM: %llu", &kib) == 1)
            memory.peak_bytes = kib << 10;
    }
    if (status)
        fclose(status);
    return memory;
}
