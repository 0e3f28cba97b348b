// Scenes made by code for the tests of global illumination. All surfaces are matte. Each scene has
// one camera, which the tests use. Each function fails the test when memory ends.
#ifndef VOXCAST_TESTS_GPU_SUPPORT_GI_SCENES_H
#define VOXCAST_TESTS_GPU_SUPPORT_GI_SCENES_H

#include "renderer/scene/scene.h"
#include "renderer/settings.h"

// A rotation about the axis (2, 3, 1), along which no voxel lies.
void gi_turn(float angle_rad, float out_rotation[4]);

// A closed cube about the origin, seen from inside.
struct gi_box_params {
    float albedo;
    float emission;     // of every wall, cd/m^2
    float intensity_cd; // of a point light in the middle; 0: none
    float half_edge_m;
    float turn_rad;
    uint32_t divisions; // quads along a wall's edge; with more than one, the walls have too many
                        // triangles for planar emitters
};
struct scene *gi_box_scene(const struct gi_box_params *params);

// Looks from the centre of the box at one of its walls, in the order of enum voxel_face. The wall
// exactly fills a square image.
void gi_box_look_at_wall(float turn_rad, uint32_t wall, struct view_camera *out_camera);

// A passage with a bend: a light is in one arm, the camera in the other, which the light reaches
// only around the bend.
struct scene *gi_corridor_scene(void);

// Four coloured walls around a floor with a pillar, open above to an even sky.
struct scene *gi_courtyard_scene(void);

// A closed room lit by a glowing ball of too many triangles for a planar emitter.
struct scene *gi_glowing_ball_scene(void);

// A closed room lit by a planar light over a floor of brushed metal, which shows light and walls.
struct scene *gi_metal_floor_scene(void);

// A low table in a closed room with a light, in front of a mirror: the light under the table and
// the mirror image lie between voxels.
struct scene *gi_table_scene(void);

// A floor under a light of a radius at a height of 2 m. With `sheet`, half of the floor (x < 0) is
// covered at half the height. Seen from above, below the sheet.
struct scene *gi_penumbra_scene(bool sheet, float radius_m);

// Two closed rooms with a wall between them; a light in the first.
struct gi_rooms_params {
    float wall_m;   // thickness of the wall
    float offset_m; // of the wall from the middle
    float turn_rad; // of everything
};
struct scene *gi_rooms_scene(const struct gi_rooms_params *params);
#define GI_ROOMS_HALF_EXTENT_M 2.0f

// Looks around in a room: 0 is the lit one, 1 the dark one.
void gi_rooms_look(const struct gi_rooms_params *params, uint32_t room,
                   struct view_camera *out_camera);

// The view of the scene's first camera.
void gi_scene_camera(const struct scene *scene, struct view_camera *out_camera);

// The longest edge of the scene's bounds.
double gi_scene_extent(const struct scene *scene);

#endif
