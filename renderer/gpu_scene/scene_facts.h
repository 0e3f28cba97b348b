// What a scene has, as far as a frame depends on it: plain data.
#ifndef VOXCAST_RENDERER_GPU_SCENE_SCENE_FACTS_H
#define VOXCAST_RENDERER_GPU_SCENE_SCENE_FACTS_H

#include <stdbool.h>
#include <stdint.h>

struct gpu_scene_counts {
    uint32_t instances;
    uint32_t lights; // enabled punctual lights
    uint32_t ranged_lights;
    uint32_t area_lights;
    uint32_t large_area_lights; // of these: see area_lights.c
    uint32_t shadow_layers;
    uint32_t unshadowed;          // lights that should cast shadows but got no layer
    uint32_t single_view_shadows; // lights with one shadow view
    uint32_t point_shadows;       // lights with six
    uint32_t colored_primitives;  // with vertex colours other than white
    uint32_t textured_materials;  // used by a visible instance; so are all below
    uint32_t masked_materials;
    uint32_t transparent_materials;
    uint32_t blinn_phong_materials;
    uint32_t specular_materials;
    uint32_t lit_materials; // not unlit
    uint32_t emissive_materials;
    uint32_t reflective_materials; // that reflect any light
    uint32_t transmissive_materials;
    uint32_t sized_lights; // punctual lights with a radius, and area lights that are not large
};

// The scene on the GPU, in numbers.
struct scene_facts {
    struct gpu_scene_counts counts;
    bool environment;                     // there is one, and it gives light
    bool cascaded_shadow;                 // a directional light has cascades
    uint32_t color_classes, data_classes; // sizes of textures, by colour space
    bool texture_transforms, second_uv_set;
};

#endif
