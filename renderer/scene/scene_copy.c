// Copies of a scene, for use while the original is edited.
#include <stdlib.h>
#include <string.h>

#include "renderer/scene/scene.h"

static void *copy_array(const void *source, size_t count, size_t size)
{
    void *copy = malloc((count + 1) * size);
    if (copy && count > 0)
        memcpy(copy, source, count * size);
    return copy;
}

#define COPY(target, source, items, singular)                                                      \
    ((target)->items =                                                                             \
         copy_array((source)->items, (source)->singular##_count, sizeof(*(source)->items)),        \
     (target)->singular##_count = (target)->items ? (source)->singular##_count : 0,                \
     (target)->singular##_capacity = (target)->singular##_count, (target)->items != NULL)

struct scene *scene_copy(const struct scene *source)
{
    struct scene *copy = scene_create(source->name);
    if (!copy)
        return NULL;
    bool done = COPY(copy, source, vertices, vertex) && COPY(copy, source, indices, index) &&
                COPY(copy, source, primitives, primitive) && COPY(copy, source, meshes, mesh) &&
                COPY(copy, source, materials, material) && COPY(copy, source, nodes, node) &&
                COPY(copy, source, lights, light) && COPY(copy, source, images, image);
    for (uint32_t i = 0; i < copy->image_count; i++)
        image_retain(copy->images[i]);
    copy->environment = source->environment;
    environment_image_retain(copy->environment.image);
    copy->revisions = source->revisions;
    if (!done)
        scene_destroy(&copy);
    return copy;
}
