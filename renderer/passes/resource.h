// What passes read and write on the GPU: one row a resource.
#ifndef VOXCAST_RENDERER_PASSES_RESOURCE_H
#define VOXCAST_RENDERER_PASSES_RESOURCE_H

#include <stdbool.h>
#include <stdint.h>

enum resource {
    RESOURCE_GEOMETRY,    // instances, vertices, indices
    RESOURCE_MATERIALS,   // and textures
    RESOURCE_LIGHTS,      // punctual and area lights, and their shadow views
    RESOURCE_ENVIRONMENT, // harmonics, filtered levels, background
    RESOURCE_BVH,
    RESOURCE_VOXELS,         // index, cells, surfels and lists
    RESOURCE_VOXEL_RADIANCE, // what cones are traced through
    RESOURCE_IRRADIANCE,     // the cache: face records
    RESOURCE_SHADOW_MAP,
    RESOURCE_IDS,
    RESOURCE_DEPTH,
    RESOURCE_GBUFFER,
    RESOURCE_LIGHT_MASKS,
    RESOURCE_TILES,        // that reflections are traced in, or transparent layers shaded
    RESOURCE_ACCUMULATION, // samples of pixels, summed over frames
    RESOURCE_FRAGMENTS,    // lists of transparent layers
    RESOURCE_RADIANCE,
    RESOURCE_EXPOSURE,
    RESOURCE_OUTPUT,
    RESOURCE_COUNT
};

#define RESOURCE(name) (1u << RESOURCE_##name)

enum resource_scope {
    SCOPE_SCENE,  // uploaded before the passes run
    SCOPE_VOLUME, // of voxels: kept over frames
    SCOPE_VIEW,
};

struct resource_row {
    const char *name;
    enum resource_scope scope;
    bool history;     // what earlier frames wrote is read
    uint32_t storage; // bits of the storage bindings
    uint32_t units;   // bits of the texture units
    uint32_t images;  // bits of the image units
};

extern const struct resource_row resource_rows[RESOURCE_COUNT];

#endif
