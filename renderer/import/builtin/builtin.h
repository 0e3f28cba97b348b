// The built-in scenes, made by code; one file each.
#ifndef VOXCAST_RENDERER_IMPORT_BUILTIN_BUILTIN_H
#define VOXCAST_RENDERER_IMPORT_BUILTIN_BUILTIN_H

#include "renderer/scene/scene.h"

// Each fills an empty scene. False when memory runs out.
bool builtin_build_cornell(struct scene *scene);
bool builtin_build_cornell_objects(struct scene *scene);
bool builtin_build_cornell_objects_diffuse(struct scene *scene);
bool builtin_build_cornell_objects_glossy(struct scene *scene);
bool builtin_build_cornell_objects_glass(struct scene *scene);
bool builtin_build_cornell_objects_emissive(struct scene *scene);
bool builtin_build_atrium(struct scene *scene);
bool builtin_build_atrium_lights(struct scene *scene);
bool builtin_build_furnace(struct scene *scene);
bool builtin_build_material_grid(struct scene *scene);

// Walls and light of the Cornell box, for scenes inside it.
bool builtin_add_cornell_room(struct scene *scene);

// A diffuse material without specular reflection (IOR 1), of the given linear reflectance.
uint32_t builtin_add_matte(struct scene *scene, const char *name, const float reflectance[3]);

// Appends a quad as two triangles to the newest mesh; corners counter-clockwise seen from the
// front. Texture coordinates run from (0, 0) at the first corner to (1, 1) at the third.
bool builtin_add_quad(struct scene *scene, const float corners[4][3], uint32_t material);

// Adds a visible node with a mesh; SCENE_NONE when memory runs out.
uint32_t builtin_add_mesh_node(struct scene *scene, const char *name, uint32_t mesh);

#endif
