#include <stdlib.h>

#include "renderer/image/file_access.h"
#include "renderer/image/image_decode.h"
#include "renderer/import/scene_load.h"

bool scene_load_environment(const char *path, struct scene_environment *environment,
                            struct error *out_error)
{
    uint8_t *bytes = NULL;
    size_t size;
    if (!asset_read_file(path, SCENE_MAX_FILE_BYTES, &bytes, &size, NULL, out_error)) {
        return false;
    }
    struct error cause;
    uint32_t width, height;
    float *pixels = image_decode_radiance(bytes, size, &width, &height, &cause);
    free(bytes);
    if (!pixels) {
        return error_set(out_error, "environment '%.200s': %.200s", path, cause.message);
    }
    free(environment->pixels);
    environment->type = SCENE_ENVIRONMENT_EQUIRECT;
    environment->width = width;
    environment->height = height;
    environment->pixels = pixels;
    return true;
}
