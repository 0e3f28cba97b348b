// Memory of this process, as the system counts it.
#ifndef VOXCAST_RENDERER_PROCESS_MEMORY_H
#define VOXCAST_RENDERER_PROCESS_MEMORY_H

#include <stdint.h>

struct process_memory {
    uint64_t rss_bytes;  // now, libraries included
    uint64_t peak_bytes; // the most so far
};

// Zeros where the system does not tell. Any thread.
struct process_memory process_memory_read(void);

#endif
