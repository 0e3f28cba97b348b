#include <stdlib.h>
#include <turbojpeg.h>

#include "server/stream/frame_encoder.h"

struct jpeg_encoder {
    tjhandle handle;
    unsigned char *buffer;
    unsigned long size;
};

static void destroy(void *memory)
{
    struct jpeg_encoder *encoder = memory;
    free(encoder->buffer);
    if (encoder->handle)
        tjDestroy(encoder->handle);
    free(encoder);
}

static void *create(void)
{
    struct jpeg_encoder *encoder = calloc(1, sizeof(*encoder));
    if (!encoder)
        return NULL;
    encoder->handle = tjInitCompress();
    if (!encoder->handle) {
        destroy(encoder);
        return NULL;
    }
    return encoder;
}

static const uint8_t *encode(void *memory, const struct frame_planes *image, int quality,
                             size_t *out_size)
{
    struct jpeg_encoder *encoder = memory;
    unsigned long needed = tjBufSize(image->width, image->height, TJSAMP_420);
    if (needed > encoder->size) {
        free(encoder->buffer);
        encoder->buffer = malloc(needed);
        encoder->size = encoder->buffer ? needed : 0;
    }
    if (!encoder->buffer)
        return NULL;
    unsigned long bytes = encoder->size;
    const unsigned char *planes[3] = {image->planes[0], image->planes[1], image->planes[2]};
    if (tjCompressFromYUVPlanes(encoder->handle, planes, image->width, image->pitches,
                                image->height, TJSAMP_420, &encoder->buffer, &bytes, quality,
                                TJFLAG_NOREALLOC | TJFLAG_FASTDCT) != 0) {
        log_write(LOG_ERROR, "jpeg_failed width=%d height=%d reason=\"%s\"", image->width,
                  image->height, tjGetErrorStr2(encoder->handle));
        return NULL;
    }
    *out_size = bytes;
    return encoder->buffer;
}

const struct frame_encoder frame_encoder_jpeg = {create, destroy, encode};
