// The families, in the order in which they are run.
#include "server/tool/stability/stability.h"

extern const struct stability_table stability_geometry, stability_scale, stability_camera,
    stability_light, stability_material, stability_determinism, stability_energy, stability_motion,
    stability_walls, stability_hostile, stability_faults;

const struct stability_table *const stability_tables[] = {
    &stability_geometry, &stability_scale,       &stability_camera, &stability_light,
    &stability_material, &stability_determinism, &stability_energy, &stability_motion,
    &stability_walls,    &stability_hostile,     &stability_faults,
};

const uint32_t stability_table_count = sizeof(stability_tables) / sizeof(stability_tables[0]);
