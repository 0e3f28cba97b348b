// How fast an image follows an edit of a light. The edit is made and taken back in turn, and each
// frame is compared with the converged images of before and after.
#ifndef VOXCAST_SERVER_ACCURACY_EDIT_LATENCY_H
#define VOXCAST_SERVER_ACCURACY_EDIT_LATENCY_H

#include "renderer/renderer.h"
#include "server/accuracy/samples.h"

enum edit_kind {
    EDIT_COLOR,     // the colour times 0.2, 0.6, 1
    EDIT_INTENSITY, // the intensity times 0.25
    EDIT_KIND_COUNT
};

extern const char *const edit_kind_names[EDIT_KIND_COUNT];

struct edit_params {
    struct renderer *renderer; // shows `scene`
    struct scene *scene;       // as before when the measurement returns
    struct view *view;         // to measure in; NULL for a new one
    const struct frame_params *frame;
    enum edit_kind kind;
    uint32_t light, material; // SCENE_NONE for both: the first light that emits, else the first
                              // emissive material
    uint32_t repetitions;     // edits to measure
};

// A change between two images is the mean absolute difference of linear radiance, with the exposure
// of the first converged image, clipped at 1.
enum edit_stage {
    EDIT_FIRST,    // 1 % of the change is in the image
    EDIT_ARRIVED,  // 95 % of the change is there, and stays
    EDIT_INDIRECT, // 95 % of the change of indirect light alone, not clipped, is there, and stays
    EDIT_SETTLED,  // nothing changes any more
    EDIT_STAGE_COUNT
};

extern const char *const edit_stage_names[EDIT_STAGE_COUNT];

struct edit_result {
    uint32_t light, material;                // what was edited; the other one is SCENE_NONE
    double change;                           // between the converged images
    struct samples ms[EDIT_STAGE_COUNT];     // since the edit, over the repetitions
    struct samples frames[EDIT_STAGE_COUNT]; // likewise
};

// Measures. Times are those of drawing and reading back linear images, one after another. False
// with a message if nothing emits or the image does not converge. Finish the result in any case.
bool edit_measure(const struct edit_params *params, struct edit_result *out_result,
                  struct error *out_error);
void edit_result_finish(struct edit_result *result);

#endif
