#include "renderer/passes/resource.h"

#include "shared/slots.h"

#define BIT(slot)         (1u << (slot))
#define CLASSES_OF(first) (((1u << MAX_CLASSES_PER_SPACE) - 1) << (first))

const struct resource_row resource_rows[RESOURCE_COUNT] = {
    [RESOURCE_GEOMETRY] = {"geometry", SCOPE_SCENE,
                           .storage = BIT(BIND_INSTANCES) | BIT(BIND_ID_BLOCKS) |
                                      BIT(BIND_VERTICES) | BIT(BIND_INDICES)},
    [RESOURCE_MATERIALS] = {"materials", SCOPE_SCENE,
                            .storage = BIT(BIND_MATERIALS) | BIT(BIND_TEXTURES),
                            .units =
                                CLASSES_OF(UNIT_COLOR_CLASSES) | CLASSES_OF(UNIT_DATA_CLASSES)},
    [RESOURCE_LIGHTS] = {"lights", SCOPE_SCENE,
                         .storage =
                             BIT(BIND_LIGHTS) | BIT(BIND_AREA_LIGHTS) | BIT(BIND_SHADOW_VIEWS)},
    [RESOURCE_ENVIRONMENT] = {"environment", SCOPE_SCENE, .storage = BIT(BIND_ENVIRONMENT),
                              .units = BIT(UNIT_ENVIRONMENT) | BIT(UNIT_BACKGROUND)},
    [RESOURCE_BVH] = {"bvh", SCOPE_SCENE, .units = BIT(UNIT_BVH_NODES) | BIT(UNIT_BVH_TRIANGLES)},
    [RESOURCE_VOXELS] = {"voxels", SCOPE_VOLUME, .history = true,
                         .storage = BIT(BIND_VOXEL_INDEX) | BIT(BIND_CELLS) | BIT(BIND_SURFELS) |
                                    BIT(BIND_VOXEL_COUNTERS) | BIT(BIND_VOXEL_FREE) |
                                    BIT(BIND_VOXEL_WORK) | BIT(BIND_VOXEL_TILES) |
                                    BIT(BIND_VOXEL_LISTS) | BIT(BIND_VOXEL_SURFACES)},
    [RESOURCE_VOXEL_RADIANCE] = {"voxel_radiance", SCOPE_VOLUME, .history = true,
                                 .units = BIT(UNIT_VOXEL_RADIANCE),
                                 .images = BIT(IMAGE_VOXEL_RADIANCE)},
    [RESOURCE_IRRADIANCE] = {"irradiance", SCOPE_VOLUME, .history = true,
                             .storage = BIT(BIND_FACES) | BIT(BIND_CACHE_QUEUE)},
    [RESOURCE_SHADOW_MAP] = {"shadow_map", SCOPE_SCENE, .history = true,
                             .units = BIT(UNIT_SHADOW_MAP)},
    [RESOURCE_IDS] = {"ids", SCOPE_VIEW, .units = BIT(UNIT_IDS)},
    [RESOURCE_DEPTH] = {"depth", SCOPE_VIEW, .units = BIT(UNIT_DEPTH)},
    [RESOURCE_GBUFFER] = {"gbuffer", SCOPE_VIEW, .storage = BIT(BIND_GBUFFER)},
    [RESOURCE_LIGHT_MASKS] = {"light_masks", SCOPE_VIEW, .storage = BIT(BIND_LIGHT_MASKS)},
    [RESOURCE_TILES] = {"tiles", SCOPE_VIEW, .storage = BIT(BIND_TILES)},
    [RESOURCE_ACCUMULATION] = {"accumulation", SCOPE_VIEW, .history = true,
                               .storage = BIT(BIND_INDIRECT)},
    [RESOURCE_FRAGMENTS] = {"fragments", SCOPE_VIEW, .storage = BIT(BIND_FRAGMENTS)},
    [RESOURCE_RADIANCE] = {"radiance", SCOPE_VIEW, .storage = BIT(BIND_RADIANCE)},
    [RESOURCE_EXPOSURE] = {"exposure", SCOPE_VIEW, .history = true, .storage = BIT(BIND_EXPOSURE)},
    [RESOURCE_OUTPUT] = {"output", SCOPE_VIEW, .storage = BIT(BIND_OUTPUT)},
};
