// Small scenes and images for tests of the reference path tracer. All functions fail the test when
// memory ends.
#ifndef VOXCAST_TESTS_UNIT_SUPPORT_REFERENCE_H
#define VOXCAST_TESTS_UNIT_SUPPORT_REFERENCE_H

#include "renderer/path_tracer/reference.h"
#include "renderer/scene/scene.h"

// An empty scene without an environment.
struct scene *support_scene_create(void);

// Matte: base colour in all channels, no dielectric layer.
uint32_t support_add_matte(struct scene *scene, float reflectance);

// Black, emitting radiance in cd/m^2, on its front only.
uint32_t support_add_emissive(struct scene *scene, float radiance);

// A clear dielectric that transmits everything; a body if it has a thickness.
uint32_t support_add_glass(struct scene *scene, float ior, float roughness, float thickness_m);

// Corners counter-clockwise seen from the front. A node of its own.
void support_add_quad(struct scene *scene, uint32_t material, const float corners[4][3]);

// A rectangle in the plane z = `z` that faces +Z, or -Z if `down`.
void support_add_floor(struct scene *scene, uint32_t material, const float low[2],
                       const float high[2], float z, bool down);
void support_add_box(struct scene *scene, uint32_t material, const float low[3],
                     const float high[3]);

// 16x16 pixels of a very narrow view from `eye` to `target`, unlimited bounces.
struct reference_params support_narrow_view(const float eye[3], const float target[3]);

// A reference of the scene as it is now; fills in params->scene. The caller destroys it.
struct reference *support_reference_create(const struct scene *scene,
                                           const struct reference_params *params);

// Means of red, green and blue over the image of a set of layers after this many samples.
void support_reference_mean(const struct scene *scene, const struct reference_params *params,
                            uint32_t samples, uint32_t layers, double out_mean[3]);

// Prints and checks |measured / expected - 1| <= tolerance.
#define support_assert_ratio(measured, expected, tolerance, what)                                  \
    do {                                                                                           \
        double measured_ = (measured), expected_ = (expected);                                     \
        print_message("  %s: measured %.6g expected %.6g ratio %.5f\n", what, measured_,           \
                      expected_, measured_ / expected_);                                           \
        assert_true(fabs(measured_ / expected_ - 1.0) <= (tolerance));                             \
    } while (0)

#endif
