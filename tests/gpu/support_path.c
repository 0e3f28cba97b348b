#include "support_path.h"

#include <stdlib.h>

#include "renderer/path_tracer/snapshot.h"

bool path_trace(const struct path_params *params, struct path_picture *out_picture)
{
    struct error error;
    struct snapshot *snapshot = snapshot_create(params->scene, false, &error);
    if (!snapshot)
        return false;
    struct reference *reference = reference_create(
        &(struct reference_params){.scene = snapshot,
                                   .camera = params->camera,
                                   .width = params->width,
                                   .height = params->height,
                                   .max_bounces = params->bounces,
                                   .seed = params->seed,
                                   .estimator = params->estimator,
                                   .threads = params->threads ? params->threads : 2,
                                   .pixel_center = params->pixel_center},
        &error);
    snapshot_release(&snapshot);
    size_t bytes = (size_t)params->width * params->height * 4 * sizeof(float);
    struct path_picture picture = {params->width, params->height, malloc(bytes), malloc(bytes),
                                   malloc(bytes)};
    bool done = reference && picture.direct && picture.sky && picture.indirect &&
                reference_render(reference, params->samples);
    if (done) {
        reference_get_picture(
            reference, REFERENCE_LAYER(REFERENCE_EMISSION) | REFERENCE_LAYER(REFERENCE_DIRECT),
            picture.direct);
        reference_get_picture(reference, REFERENCE_LAYER(REFERENCE_SKY), picture.sky);
        reference_get_picture(reference, REFERENCE_INDIRECT_LAYERS, picture.indirect);
        *out_picture = picture;
    } else {
        path_picture_finish(&picture);
    }
    if (reference)
        reference_destroy(&reference);
    return done;
}

void path_picture_finish(struct path_picture *picture)
{
    free(picture->direct);
    free(picture->sky);
    free(picture->indirect);
    *picture = (struct path_picture){0};
}
