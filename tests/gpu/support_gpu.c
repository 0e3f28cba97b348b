#include "support_gpu.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "voxcast_paths.h"

static struct renderer *shared_renderer;

const char *test_shader_dir(void)
{
    const char *folder = getenv("VOXCAST_SHADER_DIR");
    return folder ? folder : VOXCAST_SOURCE_DIR "/shaders";
}

struct renderer *test_renderer(void)
{
    if (!shared_renderer) {
        struct error error = {""};
        shared_renderer = renderer_create(&(struct renderer_params){.gpu = "auto"}, &error);
        if (!shared_renderer)
            fail_msg("no renderer: %s", error.message);
    }
    return shared_renderer;
}

int test_renderer_teardown(void **state)
{
    (void)state;
    if (!shared_renderer)
        return 0;
    struct error error;
    renderer_set_scene(shared_renderer, NULL, &error);
    uint64_t errors = renderer_gl_error_count(shared_renderer);
    renderer_destroy(&shared_renderer);
    if (errors > 0)
        print_error("GL reported %llu errors\n", (unsigned long long)errors);
    return errors > 0 ? -1 : 0;
}

struct frame_params test_params(uint32_t width, uint32_t height, enum frame_output output)
{
    struct frame_params params = {
        .width = width, .height = height, .quality = QUALITY_FINAL, .output = output};
    render_settings_init(&params.settings);
    params.settings.gi_method = GI_METHOD_NONE;
    params.settings.exposure_mode = EXPOSURE_FIXED;
    params.settings.tonemap = TONEMAP_NONE;
    params.camera.up[1] = 1.0f;
    params.camera.fov_y_rad = 0.5f;
    return params;
}

struct test_picture test_draw_linear(struct scene *scene, const struct frame_params *params)
{
    struct renderer *renderer = test_renderer();
    struct error error = {""};
    if (!renderer_set_scene(renderer, scene, &error))
        fail_msg("%s", error.message);
    struct view *view = renderer_view_create(renderer);
    assert_non_null(view);
    if (renderer_view_draw(renderer, view, params, &error) != RENDER_DRAWN)
        fail_msg("%s", error.message);
    struct frame_pixels pixels;
    assert_true(renderer_view_collect(renderer, view, true, &pixels));
    struct test_picture picture = {.width = pixels.width, .height = pixels.height};
    picture.pixels = malloc((size_t)pixels.width * pixels.height * 4 * sizeof(float));
    assert_non_null(picture.pixels);
    for (uint32_t y = 0; y < pixels.height; y++)
        memcpy(picture.pixels + (size_t)y * pixels.width * 4,
               pixels.planes[0] + (size_t)y * pixels.row_pitch_bytes[0],
               pixels.width * 4 * sizeof(float));
    renderer_view_release(renderer, view);
    renderer_view_destroy(renderer, &view);
    return picture;
}

float test_center(const struct test_picture *picture)
{
    float sum = 0.0f;
    for (uint32_t y = picture->height / 2 - 1; y <= picture->height / 2 + 1; y++)
        for (uint32_t x = picture->width / 2 - 1; x <= picture->width / 2 + 1; x++)
            sum += picture->pixels[((size_t)y * picture->width + x) * 4];
    return sum / 9.0f;
}

struct scene *test_square_scene(float half_edge, float albedo)
{
    struct scene *scene = scene_create("square");
    assert_non_null(scene);
    struct scene_material material;
    scene_material_init(&material, "matte");
    for (int c = 0; c < 3; c++)
        material.base_color[c] = albedo;
    material.metallic = 0.0f;
    material.ior = 1.0f;
    assert_int_equal(scene_add_material(scene, &material), 0);
    struct scene_vertex vertices[4] = {0};
    for (int i = 0; i < 4; i++) {
        vertices[i].position[0] = i == 1 || i == 2 ? half_edge : -half_edge;
        vertices[i].position[1] = i >= 2 ? half_edge : -half_edge;
        vertices[i].normal[2] = 1.0f;
        vertices[i].tangent[0] = 1.0f;
        vertices[i].tangent[3] = 1.0f;
        vertices[i].uv[0][0] = i == 1 || i == 2 ? 1.0f : 0.0f;
        vertices[i].uv[0][1] = i >= 2 ? 0.0f : 1.0f;
        for (int c = 0; c < 4; c++)
            vertices[i].color[c] = 1.0f;
    }
    uint32_t mesh = scene_add_mesh(scene, "square");
    const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
    assert_int_equal(scene_add_primitive(scene, vertices, 4, indices, 6, 0), 0);
    uint32_t node = scene_add_node(scene, "square", SCENE_NONE);
    scene->nodes[node].mesh = mesh;
    scene_update_world_transforms(scene);
    return scene;
}

void test_look_down_z(struct frame_params *params, float distance)
{
    memset(&params->camera.eye, 0, sizeof(params->camera.eye));
    memset(&params->camera.target, 0, sizeof(params->camera.target));
    params->camera.eye[2] = distance;
}
