#include "renderer/import/scene_load.h"

bool scene_load_environment(const char *path, struct scene_environment *environment,
                            struct error *out_error)
{
    struct environment_image *image = environment_image_load(path, out_error);
    if (!image) {
        return false;
    }
    environment_image_release(&environment->image);
    environment->type = SCENE_ENVIRONMENT_EQUIRECT;
    environment->image = image;
    return true;
}
