// Cameras in places, with lenses and with image sizes that nobody would choose.
#include <math.h>
#include <string.h>

#include "renderer/camera.h"
#include "renderer/metrics/picture.h"
#include "server/tool/stability/stage.h"

struct named_camera {
    const char *name;
    struct view_camera camera;
};

// Draws the stage from several cameras and counts the values that are not finite.
static void draw_from(struct stability_run *run, struct stage *stage,
                      const struct named_camera *cameras, uint32_t count)
{
    struct frame_params params = stability_params(run);
    struct stability_view view;
    bool reference = run->method == GI_METHOD_REFERENCE;
    bool done = reference || stability_view_open(&view, run, stage->scene);
    for (uint32_t i = 0; i < count && done; i++) {
        struct picture picture = {0};
        params.camera = cameras[i].camera;
        done = reference ? stability_draw(run, stage->scene, &params, &picture)
                         : stability_view_settle(&view, &params);
        if (!done)
            break;
        const struct picture *drawn = reference ? &picture : &view.picture;
        stability_measure(run, (double)run->bad_values, "%s", cameras[i].name);
        if (!(stability_mean(drawn) > 0.0))
            stability_fail(run, "%s: the image is black", cameras[i].name);
        stability_keep(run, drawn, cameras[i].name);
        picture_finish(&picture);
    }
    if (!reference)
        stability_view_close(&view);
}

static struct view_camera camera_at(const struct stage *stage, float x, float y, float z)
{
    struct view_camera camera = stage->camera;
    memcpy(camera.eye, (float[3]){x, y, z}, sizeof(camera.eye));
    return camera;
}

static void run_positions(struct stability_run *run)
{
    struct stage stage;
    if (!stage_create(run, &(struct stage_params){0}, &stage))
        return;
    const struct {
        const char *name;
        float eye[3];
        float target[3];
    } camera_positions[] = {
        {"in-the-box", {-0.75f, 0.5f, -0.75f}, {0.0f, 1.0f, 1.0f}},
        {"in-the-light", {0.5f, 2.25f, 0.5f}, {0.0f, 1.0f, -1.0f}},
        {"on-the-floor", {0.25f, 0.0f, 1.5f}, {0.0f, 0.0f, -1.0f}},
        {"on-a-corner", {-0.25f, 1.0f, -0.25f}, {1.0f, 1.0f, 1.0f}},
        {"in-a-wall-s-plane", {-2.0f, 1.0f, 1.5f}, {-2.0f, 1.0f, -1.0f}},
    };
    struct named_camera cameras[sizeof(camera_positions) / sizeof(camera_positions[0])];
    const uint32_t count = sizeof(camera_positions) / sizeof(camera_positions[0]);
    stage.scene->lights[stage.light].radius_m = 0.25f;
    for (uint32_t i = 0; i < count; i++) {
        const float *eye = camera_positions[i].eye;
        cameras[i] = (struct named_camera){camera_positions[i].name,
                                           camera_at(&stage, eye[0], eye[1], eye[2])};
        memcpy(cameras[i].camera.target, camera_positions[i].target,
               sizeof(camera_positions[i].target));
    }
    draw_from(run, &stage, cameras, count);
    scene_destroy(&stage.scene);
}

static void run_directions(struct stability_run *run)
{
    struct stage stage;
    if (!stage_create(run, &(struct stage_params){0}, &stage))
        return;
    struct view_camera camera = camera_at(&stage, 0.0f, 2.5f, 0.0f);
    struct named_camera cameras[3] = {
        {"up-along-view", camera}, {"target-at-eye", camera}, {"no-up", camera}};
    memcpy(cameras[0].camera.target, (float[3]){0.0f, 1.0f, 0.0f}, sizeof(camera.target));
    for (int i = 1; i < 3; i++)
        memcpy(cameras[i].camera.target, camera.eye, sizeof(camera.target));
    memset(cameras[2].camera.up, 0, sizeof(camera.up));
    draw_from(run, &stage, cameras, 3);
    scene_destroy(&stage.scene);
}

#define PROBES 12u

// Compares some pixels with images of a single pixel that show the same direction.
static void probe(struct stability_run *run, struct scene *scene, const struct frame_params *params,
                  const struct picture *picture)
{
    struct camera_frame frame;
    camera_frame_init(&frame, &params->camera);
    double brightest = 1e-30;
    for (size_t i = 0; i < 3 * picture_pixel_count(picture); i++)
        brightest = fmax(brightest, (double)picture->rgb[i]);
    for (uint32_t i = 0; i < PROBES; i++) {
        uint32_t x = (uint32_t)((uint64_t)(i * 7 % PROBES) * (params->width - 1) / (PROBES - 1));
        uint32_t y = (uint32_t)((uint64_t)i * (params->height - 1) / (PROBES - 1));
        struct frame_params one = *params;
        struct picture seen;
        float ray[3];
        camera_ray(&frame, params->width, params->height, (float)x + 0.5f, (float)y + 0.5f, ray);
        one.width = one.height = 1;
        one.camera.fov_y_rad = 0.02f;
        for (int axis = 0; axis < 3; axis++)
            one.camera.target[axis] = one.camera.eye[axis] + ray[axis];
        if (!stability_draw(run, scene, &one, &seen))
            return;
        const float *pixel = picture->rgb + 3 * ((size_t)y * params->width + x);
        for (int c = 0; c < 3; c++)
            stability_measure(run, fabs((double)pixel[c] - (double)seen.rgb[c]) / brightest,
                              "pixel %u, %u of %ux%u, %g degrees", x, y, params->width,
                              params->height, (double)params->camera.fov_y_rad * 180.0 / M_PI);
        picture_finish(&seen);
    }
}

static void probe_shape(struct stability_run *run, uint32_t width, uint32_t height, double fov_deg)
{
    struct stage stage;
    if (!stage_create(run, &(struct stage_params){0}, &stage))
        return;
    struct frame_params params = stability_params(run);
    params.camera = stage.camera;
    params.camera.fov_y_rad = (float)(fov_deg * M_PI / 180.0);
    params.width = width;
    params.height = height;
    struct picture picture;
    if (stability_draw(run, stage.scene, &params, &picture)) {
        stability_keep(run, &picture, "drawn");
        probe(run, stage.scene, &params, &picture);
        picture_finish(&picture);
    }
    scene_destroy(&stage.scene);
}

static void run_lenses(struct stability_run *run)
{
    probe_shape(run, STABILITY_WIDTH, STABILITY_HEIGHT, 1.0);
    probe_shape(run, STABILITY_WIDTH, STABILITY_HEIGHT, 179.0);
}

static void run_shapes(struct stability_run *run)
{
    probe_shape(run, 1, 1, 60.0);
    probe_shape(run, 4096, 17, 20.0);
    probe_shape(run, 17, 2160, 60.0);
}

// A card so near that it fills the image.
static void run_near(struct stability_run *run)
{
    struct stage stage;
    if (!stage_create(run, &(struct stage_params){0}, &stage))
        return;
    const float distance = 1e-4f;
    struct scene_vertex v[3] = {stage_vertex(-0.01f, -0.01f, 0.0f),
                                stage_vertex(0.01f, -0.01f, 0.0f), stage_vertex(0.0f, 0.02f, 0.0f)};
    struct scene_material card;
    scene_material_init(&card, "card");
    card.shading = SCENE_SHADING_UNLIT;
    card.double_sided = true;
    uint32_t material = scene_add_material(stage.scene, &card);
    struct view_camera camera = camera_at(&stage, 0.0f, 1.0f, 1.0f);
    memcpy(camera.target, (float[3]){0.0f, 1.0f, 0.0f}, sizeof(camera.target));
    stage_add_triangles(&stage, v, 1, material, (const float[3]){0.0f, 1.0f, 1.0f - distance});
    struct frame_params params = stability_params(run);
    params.camera = camera;
    struct picture picture;
    if (stability_draw(run, stage.scene, &params, &picture)) {
        for (size_t i = 0; i < 3 * picture_pixel_count(&picture); i++)
            stability_measure(run, fabs((double)picture.rgb[i] - 1.0), "value %zu", i);
        picture_finish(&picture);
    }
    scene_destroy(&stage.scene);
}

// The camera goes far away and back: the converged image does not depend on where it was before.
static void run_teleport(struct stability_run *run)
{
    struct stage stage;
    struct stability_view view;
    struct picture first = {0};
    if (!stage_create(run, &(struct stage_params){0}, &stage))
        return;
    struct frame_params params = stability_params(run), away;
    params.camera = stage.camera;
    // A fixed number of bounces would differ: new voxels take their light from converged ones,
    // which is one bounce more.
    params.settings.bounces = 0;
    away = params;
    away.camera = camera_at(&stage, 5000.0f, 300.0f, -7000.0f);
    if (stability_view_open(&view, run, stage.scene) && stability_view_settle(&view, &params)) {
        first = view.picture;
        view.picture = (struct picture){0};
        bool done = stability_view_draw(&view, &away) == RENDER_DRAWN &&
                    stability_view_draw(&view, &params) == RENDER_DRAWN;
        stability_keep(run, &view.picture, "first-frame-back");
        if (done && stability_view_settle(&view, &params)) {
            uint32_t pixel = 0;
            double difference = stability_difference(&view.picture, &first, &pixel);
            stability_measure(run, difference, "pixel %u, %u", pixel % first.width,
                              pixel / first.width);
        }
    }
    stability_view_close(&view);
    picture_finish(&first);
    scene_destroy(&stage.scene);
}

static const struct stability_case cases[] = {
    {.name = "camera-places",
     .invariant = "in a solid, in a light, on surfaces: finite and not black",
     .methods = STABILITY_ALL,
     .bound = 0.0,
     .unit = "values not finite",
     .run = run_positions},
    {.name = "camera-directions",
     .invariant = "up along the view, no up, no direction: finite and not black",
     .methods = STABILITY_ALL,
     .bound = 0.0,
     .unit = "values not finite",
     .run = run_directions},
    {.name = "camera-lenses",
     .invariant = "at 1 and 179 degrees each pixel is what an image of it alone shows",
     .methods = STABILITY_NONE,
     .bound = 0.002,
     .unit = "of the brightest",
     .run = run_lenses},
    {.name = "camera-shapes",
     .invariant = "in 1x1, 4096x17 and 17x2160 each pixel is what an image of it alone shows",
     .methods = STABILITY_NONE,
     .bound = 0.002,
     .unit = "of the brightest",
     .run = run_shapes},
    {.name = "camera-near",
     .invariant = "a card 0.1 mm in front of the eye hides everything",
     .methods = STABILITY_DRAWN,
     .bound = 0.0001,
     .unit = "of the card",
     .run = run_near},
    {.name = "camera-teleport",
     .invariant = "kilometres away and back, the image converges to what it was",
     .methods = STABILITY_DRAWN,
     .bound = 0.004,
     .voxel_bound = 0.016, // light has converged when 0.8 % are still to come, in either image
     .unit = "of the brightest",
     .run = run_teleport},
};

const struct stability_table stability_camera = {
    .name = "camera",
    .title = "Camera",
    .cases = cases,
    .count = sizeof(cases) / sizeof(cases[0]),
};
