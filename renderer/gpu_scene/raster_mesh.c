// Vertices and indices for rasterisation: the packed attributes of the visibility pass, with each
// triangle's provoking (first) vertex its own, since it carries the triangle's number. A flat
// attribute costs nothing, while gl_PrimitiveID makes a software renderer copy every vertex.
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/gpu_scene/gpu_scene.h"
#include "renderer/scene/scene.h"

#define UNUSED UINT32_MAX

struct mesh_builder {
    const struct scene *scene;
    struct raster_vertex *vertices;
    uint32_t count;
    uint32_t capacity;
    uint32_t *indices;
    uint32_t *placed; // per scene vertex: index in `vertices`, or UNUSED
};

static bool append_vertex(struct mesh_builder *builder, uint32_t scene_vertex, uint32_t *out_index)
{
    if (builder->count == builder->capacity) {
        uint32_t capacity = builder->capacity ? builder->capacity + builder->capacity / 2 : 1024;
        struct raster_vertex *grown =
            realloc(builder->vertices, capacity * sizeof(*builder->vertices));
        if (!grown)
            return false;
        builder->vertices = grown;
        builder->capacity = capacity;
    }
    const struct scene_vertex *source = &builder->scene->vertices[scene_vertex];
    struct raster_vertex *vertex = &builder->vertices[builder->count];
    memcpy(vertex->position, source->position, sizeof(vertex->position));
    memcpy(vertex->uv, source->uv, sizeof(vertex->uv));
    vertex->alpha = source->color[3];
    vertex->triangle = UNUSED;
    *out_index = builder->count++;
    return true;
}

// Rotates the triangle so that its first vertex provokes no other one; copies a vertex if all do.
static bool add_triangle(struct mesh_builder *builder, const uint32_t corners[3], uint32_t number,
                         uint32_t *out_indices)
{
    uint32_t at[3];
    assert(builder->placed);
    for (int i = 0; i < 3; i++) {
        at[i] = builder->placed[corners[i]];
        if (at[i] != UNUSED)
            continue;
        if (!append_vertex(builder, corners[i], &at[i]))
            return false;
        builder->placed[corners[i]] = at[i];
    }
    assert(builder->vertices);
    int first = 0;
    while (first < 3 && builder->vertices[at[first]].triangle != UNUSED)
        first++;
    if (first == 3) {
        first = 0;
        if (!append_vertex(builder, corners[0], &at[0]))
            return false;
        builder->placed[corners[0]] = at[0]; // later triangles reuse the newest copy
    }
    builder->vertices[at[first]].triangle = number;
    for (int i = 0; i < 3; i++)
        out_indices[i] = at[(first + i) % 3];
    return true;
}

static bool build(struct mesh_builder *builder)
{
    const struct scene *scene = builder->scene;
    for (uint32_t i = 0; i < scene->primitive_count; i++) {
        const struct scene_primitive *primitive = &scene->primitives[i];
        for (uint32_t j = 0; j < primitive->index_count; j += 3) {
            uint32_t at = primitive->index_first + j;
            if (!add_triangle(builder, scene->indices + at, j / 3, builder->indices + at))
                return false;
        }
    }
    return true;
}

bool gpu_scene_upload_raster_mesh(struct gpu_scene *gpu_scene)
{
    const struct scene *scene = gpu_scene->scene;
    struct mesh_builder builder = {.scene = scene};
    builder.indices = malloc((scene->index_count + 1u) * sizeof(uint32_t));
    builder.placed = malloc((scene->vertex_count + 1u) * sizeof(uint32_t));
    bool done = builder.indices && builder.placed;
    if (done) {
        memset(builder.placed, 0xff, scene->vertex_count * sizeof(uint32_t));
        done = build(&builder);
    }
    gpu_geometry_destroy(&gpu_scene->geometry);
    gpu_buffer_destroy(&gpu_scene->raster_vertices);
    gpu_buffer_destroy(&gpu_scene->raster_indices);
    if (done) {
        gpu_scene->raster_vertices =
            gpu_buffer_create(gpu_scene->gpu, "geometry.raster_vertices", GPU_BUFFER_STATIC,
                              builder.count * sizeof(*builder.vertices), builder.vertices);
        builder.indices[scene->index_count] = 0; // so that no buffer is too small to be bound
        bool mapped = gpu_get_info(gpu_scene->gpu)->software;
        gpu_scene->raster_indices =
            gpu_buffer_create(gpu_scene->gpu, "geometry.raster_indices",
                              mapped ? GPU_BUFFER_READBACK : GPU_BUFFER_STATIC,
                              (scene->index_count + 1u) * sizeof(uint32_t), builder.indices);
        done = gpu_scene->raster_vertices && gpu_scene->raster_indices;
    }
    if (done)
        gpu_scene->geometry = gpu_geometry_create(gpu_scene->gpu, gpu_scene->raster_vertices,
                                                  gpu_scene->raster_indices);
    free(builder.vertices);
    free(builder.indices);
    free(builder.placed);
    return done && gpu_scene->geometry != NULL;
}
