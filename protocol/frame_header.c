#include "protocol/frame_header.h"

#include <string.h>

static uint8_t *put(uint8_t *at, uint64_t value, size_t bytes)
{
    for (size_t i = 0; i < bytes; i++)
        at[i] = (uint8_t)(value >> (8 * i));
    return at + bytes;
}

static uint64_t get(const uint8_t **at, size_t bytes)
{
    uint64_t value = 0;
    for (size_t i = 0; i < bytes; i++)
        value |= (uint64_t)(*at)[i] << (8 * i);
    *at += bytes;
    return value;
}

void frame_header_encode(const struct frame_header *header, uint8_t *out)
{
    uint32_t convergence_bits, noise_bits;
    memcpy(&convergence_bits, &header->convergence, 4);
    memcpy(&noise_bits, &header->reference_noise, 4);
    memcpy(out, "VXF1", 4);
    uint8_t *at = put(out + 4, FRAME_HEADER_BYTES, 2);
    at = put(at, header->flags, 1);
    at = put(at, header->codec, 1);
    at = put(at, header->view_id, 4);
    at = put(at, header->jpeg_bytes, 4);
    at = put(at, header->frame_id, 8);
    at = put(at, header->scene_revision, 8);
    at = put(at, header->edit_id, 8);
    at = put(at, header->camera_revision, 8);
    at = put(at, header->width, 2);
    at = put(at, header->height, 2);
    at = put(at, header->quality, 1);
    at = put(at, header->debug_view, 1);
    at = put(at, header->epoch, 2);
    at = put(at, convergence_bits, 4);
    at = put(at, header->queue_us, 4);
    at = put(at, header->draw_us, 4);
    at = put(at, header->readback_us, 4);
    at = put(at, header->encode_us, 4);
    at = put(at, header->send_wait_us, 4);
    at = put(at, header->draw_at_us, 8);
    at = put(at, header->sent_at_us, 8);
    at = put(at, header->reference_samples, 4);
    put(at, noise_bits, 4);
}

bool frame_header_decode(const uint8_t *bytes, size_t length, struct frame_header *out_header,
                         size_t *out_image_offset)
{
    if (length < FRAME_HEADER_BYTES || memcmp(bytes, "VXF1", 4) != 0)
        return false;
    const uint8_t *at = bytes + 4;
    size_t header_bytes = get(&at, 2);
    struct frame_header header = {0};
    header.flags = (uint8_t)get(&at, 1);
    header.codec = (uint8_t)get(&at, 1);
    header.view_id = (uint32_t)get(&at, 4);
    header.jpeg_bytes = (uint32_t)get(&at, 4);
    if (header_bytes < FRAME_HEADER_BYTES || length < header_bytes ||
        length - header_bytes < header.jpeg_bytes)
        return false;
    header.frame_id = get(&at, 8);
    header.scene_revision = get(&at, 8);
    header.edit_id = get(&at, 8);
    header.camera_revision = get(&at, 8);
    header.width = (uint16_t)get(&at, 2);
    header.height = (uint16_t)get(&at, 2);
    header.quality = (uint8_t)get(&at, 1);
    header.debug_view = (uint8_t)get(&at, 1);
    header.epoch = (uint16_t)get(&at, 2);
    uint32_t convergence_bits = (uint32_t)get(&at, 4);
    memcpy(&header.convergence, &convergence_bits, 4);
    header.queue_us = (uint32_t)get(&at, 4);
    header.draw_us = (uint32_t)get(&at, 4);
    header.readback_us = (uint32_t)get(&at, 4);
    header.encode_us = (uint32_t)get(&at, 4);
    header.send_wait_us = (uint32_t)get(&at, 4);
    header.draw_at_us = get(&at, 8);
    header.sent_at_us = get(&at, 8);
    header.reference_samples = (uint32_t)get(&at, 4);
    uint32_t noise_bits = (uint32_t)get(&at, 4);
    memcpy(&header.reference_noise, &noise_bits, 4);
    *out_header = header;
    *out_image_offset = header_bytes;
    return true;
}
