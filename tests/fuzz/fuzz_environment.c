// Feeds arbitrary bytes to the decoders of environment images and uses what they accept. Run:
// fuzz_environment corpus/environment
#include <stddef.h>
#include <stdint.h>

#include "renderer/image/environment_image.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct error error;
    struct environment_image *image = environment_image_decode(data, size, &error);
    for (size_t i = 0; image && i < (size_t)image->width * image->height * 3; i++)
        if (!(image->pixels[i] >= 0.0f && image->pixels[i] <= ENVIRONMENT_MAX_RADIANCE))
            __builtin_trap();
    environment_image_release(&image);
    return 0;
}
