// A surface point to shade: unpacked from the G-buffer, or loaded from a visibility id.
#include "lib/frame.glsl"
#include "shared/shading_model.h"

struct surface {
    vec3 position;         // world
    vec3 normal;           // shading normal, world, unit
    vec3 geometric_normal; // facing the viewer
    vec3 view;             // towards the eye, unit
    vec3 base_color;
    float metallic;
    vec3 f0; // of the dielectric part
    float f90;
    float roughness;
    float occlusion;
    vec3 emission; // cd/m^2
    uint shading;  // SHADE_*
    bool thin;     // double-sided, so possibly without thickness
};
