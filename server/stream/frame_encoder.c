#include "server/stream/frame_encoder.h"

static const struct frame_encoder *const encoders[FRAME_CODEC_COUNT] = {
    [FRAME_CODEC_JPEG] = &frame_encoder_jpeg,
};

const struct frame_encoder *frame_encoder_of(enum frame_codec codec)
{
    return encoders[codec];
}
