// Measures clients' views for the daemon: what `voxcast accuracy` does, for a copy of the document,
// on a thread and with a renderer of its own. A client has one measurement; those of several
// clients run one after another. Clients hear of it by `accuracy.progress` and read its files over
// HTTP.
//
// It delays nobody: the path tracer's workers have the lowest priority, and frames are drawn only
// while accuracy_service_set_idle() says that no client waits for one.
#ifndef VOXCAST_SERVER_ACCURACY_ACCURACY_SERVICE_H
#define VOXCAST_SERVER_ACCURACY_ACCURACY_SERVICE_H

#include <stdbool.h>
#include <stdint.h>

#include "renderer/renderer.h"
#include "server/stream/outbox.h"

#define ACCURACY_ID_SIZE 33u // 32 hexadecimal digits

// Views are measured at no more pixels than this.
#define ACCURACY_MAX_PIXELS (640u * 360u)

#define ACCURACY_LIVE_CONFIGURATION "live" // the client's own settings and quality

struct accuracy_service;

struct accuracy_service_params {
    const char *gpu;       // as in struct renderer_params; outlives the service
    struct outbox *outbox; // outlives the service
};

// The thread starts with the first measurement. NULL when out of memory.
struct accuracy_service *accuracy_service_create(const struct accuracy_service_params *params);

// Cancels all measurements and removes their files, for a program that ends. No measurement can be
// prepared afterwards. Does not wait for the one that runs. Any thread.
void accuracy_service_stop(struct accuracy_service *service);

// Ends the measurement that runs, which may take as long as one frame or the build of a BVH, and
// removes all files.
void accuracy_service_destroy(struct accuracy_service **service);

struct accuracy_request {
    uint32_t client_id;
    struct scene *scene;        // a copy of the document, taken over even on failure
    const char *source;         // of the document, as clients know it
    uint64_t revision;          // of the document
    struct frame_params params; // the client's view: camera, size, quality and settings
    const char *sweep;          // "quick" or "full"
    double until_noise, max_s;  // of the reference: see struct reference_image_params
};

struct accuracy_ticket {
    char id[ACCURACY_ID_SIZE];
    uint32_t configuration_count;
    uint32_t width, height; // as measured
};

// Prepares a measurement. It replaces the client's former one, which ends and whose files go. It
// waits until accuracy_service_submit(), so that the client can be told of it first. False with a
// message; then the former one stays. Runs on the render thread, as all functions below but the
// last.
bool accuracy_service_prepare(struct accuracy_service *service,
                              const struct accuracy_request *request,
                              struct accuracy_ticket *out_ticket, struct error *out_error);
void accuracy_service_submit(struct accuracy_service *service, uint32_t client_id);

// Ends the client's measurement, if there is one; its results so far stay.
void accuracy_service_cancel(struct accuracy_service *service, uint32_t client_id);

// The same for a client that has gone; also removes its files.
void accuracy_service_forget(struct accuracy_service *service, uint32_t client_id);

// Whether configurations may be drawn: no client waits for a frame of its own.
void accuracy_service_set_idle(struct accuracy_service *service, bool idle);

// How a configuration of the client's newest measurement is drawn: `params` receives its quality
// and settings, as measured. False with a message that lists the configurations.
bool accuracy_service_get_configuration(struct accuracy_service *service, uint32_t client_id,
                                        const char *name, struct frame_params *out_params,
                                        double *out_scale, struct error *out_error);

// The file that answers GET /accuracy/ID/NAME; false if there is none (yet). Any thread.
bool accuracy_service_find_file(struct accuracy_service *service, const char *url, char *out_path,
                                size_t size);

#endif
