// Shared by the tests that render: a renderer, small scenes, and images as floats.
#ifndef VOXCAST_TESTS_GPU_SUPPORT_GPU_H
#define VOXCAST_TESTS_GPU_SUPPORT_GPU_H

#include "renderer/renderer.h"

// An image of linear radiance, 4 floats a pixel, row 0 at the top; free() it.
struct test_picture {
    uint32_t width;
    uint32_t height;
    float *pixels;
};

// The folder of shaders: this tree's, or $VOXCAST_SHADER_DIR, where the tests run elsewhere.
const char *test_shader_dir(void);

// The process's renderer; fails the test with the reason if there is none.
struct renderer *test_renderer(void);

// cmocka teardown of the group: destroys it and fails if GL reported errors.
int test_renderer_teardown(void **state);

// Parameters with hard shadows: final quality, fixed exposure, no tone curve.
struct frame_params test_params(uint32_t width, uint32_t height, enum frame_output output);

// Draws `scene` in a view of its own and waits for the image.
struct test_picture test_draw_linear(struct scene *scene, const struct frame_params *params);

// Mean radiance of the centre pixel's neighbourhood (3 x 3), red channel.
float test_center(const struct test_picture *picture);

// A square of the given half-edge in the plane z = 0, facing +Z, of a matte material (IOR 1).
struct scene *test_square_scene(float half_edge, float albedo);

// Looks from (0, 0, distance) at the origin.
void test_look_down_z(struct frame_params *params, float distance);

#endif
