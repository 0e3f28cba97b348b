// The header before the image in a binary message. PROTOCOL.md gives the offsets.
#ifndef VOXCAST_PROTOCOL_FRAME_HEADER_H
#define VOXCAST_PROTOCOL_FRAME_HEADER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define FRAME_HEADER_BYTES 104u

enum frame_flags {
    FRAME_CONVERGED = 1, // no better image of this state will follow
};

struct frame_header {
    uint8_t flags;
    uint8_t codec; // enum frame_codec
    uint32_t view_id;
    uint32_t jpeg_bytes;
    uint64_t frame_id;
    uint64_t scene_revision;
    uint64_t edit_id;         // newest applied edit of this client
    uint64_t camera_revision; // newest applied camera.set
    uint16_t width;
    uint16_t height;
    uint8_t quality;
    uint8_t debug_view;
    uint16_t epoch;
    float convergence; // 0 to 1
    uint32_t queue_us;
    uint32_t draw_us;
    uint32_t readback_us;
    uint32_t encode_us;
    uint32_t send_wait_us;
    uint64_t draw_at_us; // monotonic clock
    uint64_t sent_at_us;
    uint32_t reference_samples; // per pixel, of a reference image; else 0
    float reference_noise;      // standard error of a pixel over the mean luminance; 0: unknown
};

// Writes FRAME_HEADER_BYTES bytes.
void frame_header_encode(const struct frame_header *header, uint8_t *out);

// False if `bytes` do not begin with a header, or if the header announces more bytes than there
// are. `out_image_offset` is where the image begins.
bool frame_header_decode(const uint8_t *bytes, size_t length, struct frame_header *out_header,
                         size_t *out_image_offset);

#endif
