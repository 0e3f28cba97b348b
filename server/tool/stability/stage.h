// The stage of most cases: a closed room with a box, a glossy ball and a light. All positions are
// multiples of 1/16 m, so that floats hold them as far as 10^6 m from the origin.
#ifndef VOXCAST_SERVER_TOOL_STABILITY_STAGE_H
#define VOXCAST_SERVER_TOOL_STABILITY_STAGE_H

#include "renderer/import/builtin/mesh_builder.h"
#include "renderer/settings.h"
#include "server/tool/stability/stability.h"

struct stage_params {
    double scale;     // of everything; 0 means 1. The image must stay the same
    double offset[3]; // m, of everything, applied after the scale
    float light_cd;   // before the scale; 0: the default
    bool no_light;
    bool no_objects; // the room alone
};

struct stage {
    struct scene *scene;       // owned by the caller
    struct view_camera camera; // looks into the room
    uint32_t light;            // SCENE_NONE for none
    uint32_t ball, box;        // nodes
    uint32_t walls;            // material
    double scale;
    double offset[3];
};

// False, with the run failed, when memory ends.
bool stage_create(struct stability_run *run, const struct stage_params *params,
                  struct stage *out_stage);

// Adds a node to the stage that carries what is in the builder.
uint32_t stage_add(struct stage *stage, struct mesh_builder *builder, uint32_t material,
                   const float stage_position[3]);

// The same for triangles as they are, with their own vertices, 3 a triangle.
uint32_t stage_add_triangles(struct stage *stage, const struct scene_vertex *vertices,
                             uint32_t triangle_count, uint32_t material,
                             const float stage_position[3]);

// A valid vertex: white, facing up.
struct scene_vertex stage_vertex(float x, float y, float z);

// Converts the stage's metres to world units.
void stage_to_world(const struct stage *stage, const float stage_position[3], float out_world[3]);

// As stability_draw(), from the stage's camera with the usual parameters. Destroys the scene.
bool stage_draw(struct stability_run *run, struct stage *stage, struct picture *out_picture);

// The same for the default stage, which is drawn once and then kept.
bool stage_draw_usual(struct stability_run *run, struct picture *out_picture);

#endif
