#include "server/tool/stability/stage.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/import/builtin/builtin.h"
#include "renderer/metrics/picture.h"
#include "server/tool/stability/stability_internal.h"

#define LIGHT_CD 30.0f

static const float up[3] = {0.0f, 1.0f, 0.0f};

void stage_to_world(const struct stage *stage, const float stage_position[3], float out_world[3])
{
    for (int axis = 0; axis < 3; axis++)
        out_world[axis] =
            (float)((double)stage_position[axis] * stage->scale + stage->offset[axis]);
}

static uint32_t add_mesh_node(struct stage *stage, uint32_t mesh, const float stage_position[3])
{
    uint32_t node =
        mesh == SCENE_NONE ? SCENE_NONE : builtin_add_mesh_node(stage->scene, "object", mesh);
    if (node == SCENE_NONE)
        return node;
    struct scene_node *it = &stage->scene->nodes[node];
    stage_to_world(stage, stage_position, it->translation);
    for (int axis = 0; axis < 3; axis++)
        it->scale[axis] = (float)stage->scale;
    scene_update_world_transforms(stage->scene);
    return node;
}

uint32_t stage_add(struct stage *stage, struct mesh_builder *builder, uint32_t material,
                   const float stage_position[3])
{
    return add_mesh_node(stage, mesh_builder_commit_mesh(builder, stage->scene, "object", material),
                         stage_position);
}

struct scene_vertex stage_vertex(float x, float y, float z)
{
    return (struct scene_vertex){.position = {x, y, z},
                                 .normal = {0.0f, 1.0f, 0.0f},
                                 .tangent = {1.0f, 0.0f, 0.0f, 1.0f},
                                 .color = {1.0f, 1.0f, 1.0f, 1.0f}};
}

uint32_t stage_add_triangles(struct stage *stage, const struct scene_vertex *vertices,
                             uint32_t triangle_count, uint32_t material,
                             const float stage_position[3])
{
    uint32_t mesh = scene_add_mesh(stage->scene, "triangles");
    uint32_t *indices = malloc((size_t)3 * triangle_count * sizeof(*indices));
    for (uint32_t i = 0; indices && i < 3 * triangle_count; i++)
        indices[i] = i;
    bool done = indices && mesh != SCENE_NONE &&
                scene_add_primitive(stage->scene, vertices, 3 * triangle_count, indices,
                                    3 * triangle_count, material) != SCENE_NONE;
    free(indices);
    return done ? add_mesh_node(stage, mesh, stage_position) : SCENE_NONE;
}

static void add_wall(struct mesh_builder *builder, const float corners[4][3])
{
    mesh_builder_add_quad(builder, corners);
}

// 4 m wide and deep, 3 m high, about the origin of x and z; seen from inside.
static void add_room(struct stage *stage)
{
    static const float floor[4][3] = {{-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}};
    static const float ceiling[4][3] = {{-2, 3, -2}, {2, 3, -2}, {2, 3, 2}, {-2, 3, 2}};
    static const float back[4][3] = {{-2, 0, -2}, {2, 0, -2}, {2, 3, -2}, {-2, 3, -2}};
    static const float front[4][3] = {{2, 0, 2}, {-2, 0, 2}, {-2, 3, 2}, {2, 3, 2}};
    static const float left[4][3] = {{-2, 0, 2}, {-2, 0, -2}, {-2, 3, -2}, {-2, 3, 2}};
    static const float right[4][3] = {{2, 0, -2}, {2, 0, 2}, {2, 3, 2}, {2, 3, -2}};
    static const float origin[3] = {0};
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    add_wall(&builder, floor);
    add_wall(&builder, ceiling);
    add_wall(&builder, back);
    add_wall(&builder, front);
    stage_add(stage, &builder, stage->walls, origin);
    add_wall(&builder, left);
    stage_add(stage, &builder,
              builtin_add_matte(stage->scene, "red", (const float[3]){0.6f, 0.15f, 0.1f}), origin);
    add_wall(&builder, right);
    stage_add(stage, &builder,
              builtin_add_matte(stage->scene, "green", (const float[3]){0.15f, 0.5f, 0.2f}),
              origin);
}

static void add_objects(struct stage *stage)
{
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    mesh_builder_add_box(&builder, (const float[3]){-0.5f, 0.0f, -0.5f},
                         (const float[3]){0.5f, 1.0f, 0.5f}, BOX_ALL);
    stage->box =
        stage_add(stage, &builder,
                  builtin_add_matte(stage->scene, "blue", (const float[3]){0.2f, 0.3f, 0.6f}),
                  (const float[3]){-0.75f, 0.0f, -0.75f});
    struct scene_material glossy;
    scene_material_init(&glossy, "glossy");
    glossy.metallic = 0.0f;
    glossy.roughness = 0.3f;
    mesh_builder_add_sphere(&builder, (const float[3]){0.0f, 0.0f, 0.0f}, 0.5f, 24, 16);
    stage->ball = stage_add(stage, &builder, scene_add_material(stage->scene, &glossy),
                            (const float[3]){0.75f, 0.5f, 0.25f});
}

bool stage_create(struct stability_run *run, const struct stage_params *params,
                  struct stage *out_stage)
{
    struct stage *stage = out_stage;
    *stage = (struct stage){.scene = scene_create("stage"),
                            .scale = params->scale > 0.0 ? params->scale : 1.0,
                            .light = SCENE_NONE};
    if (!stage->scene) {
        stability_fail(run, "out of memory");
        return false;
    }
    memcpy(stage->offset, params->offset, sizeof(stage->offset));
    stage->walls = builtin_add_matte(stage->scene, "white", (const float[3]){0.7f, 0.7f, 0.7f});
    add_room(stage);
    if (!params->no_objects)
        add_objects(stage);
    struct scene_light light;
    scene_light_init(&light, SCENE_LIGHT_POINT, "lamp");
    float area = (float)(stage->scale * stage->scale);
    light.intensity = (params->light_cd > 0.0f ? params->light_cd : LIGHT_CD) * area;
    float position[3];
    stage_to_world(stage, (const float[3]){0.5f, 2.25f, 0.5f}, position);
    if (!params->no_light)
        stage->light =
            scene_add_light(stage->scene, &light, position, (const float[3]){0.0f, -1.0f, 0.0f});
    scene_update_world_transforms(stage->scene);
    stage_to_world(stage, (const float[3]){0.0f, 1.5f, 1.75f}, stage->camera.eye);
    stage_to_world(stage, (const float[3]){0.0f, 1.0f, -0.5f}, stage->camera.target);
    memcpy(stage->camera.up, up, sizeof(up));
    stage->camera.fov_y_rad = 1.2f;
    return true;
}

bool stage_draw(struct stability_run *run, struct stage *stage, struct picture *out_picture)
{
    struct frame_params params = stability_params(run);
    params.camera = stage->camera;
    bool done = stability_draw(run, stage->scene, &params, out_picture);
    scene_destroy(&stage->scene);
    return done;
}

static bool copy_picture(const struct picture *source, struct picture *out_copy)
{
    if (!picture_init(out_copy, source->width, source->height))
        return false;
    memcpy(out_copy->rgb, source->rgb, 3 * picture_pixel_count(source) * sizeof(float));
    return true;
}

bool stage_draw_usual(struct stability_run *run, struct picture *out_picture)
{
    struct picture *usual = &run->suite->usual[run->method];
    struct stage stage;
    *out_picture = (struct picture){0};
    if (!usual->rgb &&
        (!stage_create(run, &(struct stage_params){0}, &stage) || !stage_draw(run, &stage, usual)))
        return false;
    return copy_picture(usual, out_picture);
}
