// Progress of measuring, and who is told of it.
#ifndef VOXCAST_SERVER_ACCURACY_PROGRESS_H
#define VOXCAST_SERVER_ACCURACY_PROGRESS_H

#include "server/accuracy/sweep.h"

enum accuracy_stage {
    ACCURACY_TRACING,   // the reference image; about twice a second
    ACCURACY_TRACED,    // or loaded
    ACCURACY_MEASURING, // configurations: before the first, and after each
};

// Progress of a run.
struct accuracy_progress {
    enum accuracy_stage stage;
    uint32_t samples;                     // of the reference image, per pixel; 0 if it was loaded
    double noise;                         // of the reference image; not finite until it is known
    uint32_t done, configuration_count;   // configurations
    const struct configuration *measured; // the newest, in this run; NULL for none
    const struct configuration *next;     // NULL after the last one
    double measured_s;                    // what `measured` took
    double left_s;                        // of this stage; NaN until it is known
};

// Receives the progress of a run, and may end it. All zero: nobody.
struct accuracy_watch {
    bool (*tell)(void *user, const struct accuracy_progress *progress); // false ends the run
    void *user;
};

#endif
