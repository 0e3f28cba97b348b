// Shared by the atrium's files: dimensions, materials and parts.
//
// The courtyard's arcades stand on the rectangle +-COURT_HALF_X, +-COURT_HALF_Z (the "court line"),
// around a court without roof; galleries of GALLERY_DEPTH run behind them on two floors. A "bay" is
// the piece between two columns: x along the court line from -BAY/2 to BAY/2, z from the court line
// (0) to the outer wall (GALLERY_DEPTH), y from the ground.
#ifndef VOXCAST_RENDERER_IMPORT_BUILTIN_ATRIUM_H
#define VOXCAST_RENDERER_IMPORT_BUILTIN_ATRIUM_H

#include "renderer/import/builtin/mesh_builder.h"

#define ATRIUM_BAY_M           3.0f
#define ATRIUM_BAYS_X          8
#define ATRIUM_BAYS_Z          3
#define ATRIUM_COURT_HALF_X    12.0f
#define ATRIUM_COURT_HALF_Z    4.5f
#define ATRIUM_GALLERY_DEPTH_M 3.0f
#define ATRIUM_WALL_M          0.5f  // thickness of the arcades
#define ATRIUM_GROUND_FLOOR_M  0.15f // heights
#define ATRIUM_GROUND_SPRING_M 3.3f
#define ATRIUM_UPPER_FLOOR_M   5.4f
#define ATRIUM_UPPER_SPRING_M  8.5f
#define ATRIUM_CEILING_M       10.2f
#define ATRIUM_ARCH_RISE_M     1.7f // of an arcade's wall above the springing line

enum atrium_material {
    ATRIUM_ASHLAR,
    ATRIUM_STONE,
    ATRIUM_PLASTER,
    ATRIUM_MARBLE,
    ATRIUM_TILES,
    ATRIUM_WOOD,
    ATRIUM_ROOF,
    ATRIUM_TERRACOTTA,
    ATRIUM_BRASS,
    ATRIUM_WATER,
    ATRIUM_SOIL,
    ATRIUM_LEAF,
    ATRIUM_RED_CLOTH,
    ATRIUM_GREEN_CLOTH,
    ATRIUM_BLUE_CLOTH,
    ATRIUM_MATERIAL_COUNT
};

// Adds every material in the enum's order, so that ids equal its values.
bool atrium_add_materials(struct scene *scene);

// Meshes of the building; functions return false when memory runs out.
struct atrium_parts {
    uint32_t arch;    // arcade wall over one bay, y = 0 at the springing line
    uint32_t vault;   // groin vault over one bay, likewise
    uint32_t rib;     // across the gallery at a column, likewise
    uint32_t coffers; // beams under one bay's ceiling, y = 0 at the ceiling
    uint32_t ground_column, upper_column, balustrade; // y = 0 at the floor
    uint32_t ground_pier, upper_pier, pilaster;
    uint32_t door;
};
bool atrium_make_parts(struct scene *scene, struct atrium_parts *out_parts);

// Everything that runs around the whole court in one piece: floors, outer wall, cornices and roof.
bool atrium_add_rings(struct scene *scene);

// Meshes of the furnishings.
struct atrium_furnishings {
    uint32_t curtains[3]; // a pair in a ground-floor arch, y = 0 at the ground
    uint32_t banners[3];  // in front of an upper-floor arch, likewise
    uint32_t plant, fountain;
};
bool atrium_make_furnishings(struct scene *scene, struct atrium_furnishings *out_furnishings);

// Adds a node with a mesh; SCENE_NONE when memory runs out.
uint32_t atrium_add_node(struct scene *scene, const char *name, uint32_t parent, uint32_t mesh,
                         const float position[3], float turn_rad);

// Bays on the court's four sides, numbered around it, and their axes, where columns stand.
#define ATRIUM_BAY_COUNT (2 * (ATRIUM_BAYS_X + ATRIUM_BAYS_Z))

struct atrium_bay {
    float x, z;     // centre on the court line
    float turn_rad; // rotates +Z to the gallery
    int side;       // 0 to 3: +Z, +X, -Z, -X
    int number;     // along its side, from 0
    int side_bays;  // bays on its side
};
struct atrium_bay atrium_bay(int index);

// From a bay's x, z to the world's.
void atrium_bay_point(const struct atrium_bay *bay, float x, float z, float out_xz[2]);

// 256 lanterns with a coloured light each.
bool atrium_add_lanterns(struct scene *scene);

#endif
