// The Utah teapot: Martin Newell's bicubic Bezier patches (University of Utah, 1975). Rim, body,
// lid and bottom are quarter turns whose rows of control points approximate quarter circles, so a
// row is stored as radius and height; handle and spout are mirrored halves. His axes are x towards
// the spout, y to the side, z up.
#include "renderer/import/builtin/builtin_shapes.h"

#include <math.h>

// Newell's quarter circle has its inner control points at 0.56 of the radius.
#define QUARTER_TANGENT 0.56

#define QUARTER_PATCHES 6
#define HALF_PATCHES    4

// Radius and height of the four rows.
static const double quarter_rows[QUARTER_PATCHES][4][2] = {
    {{1.4, 2.4}, {1.3375, 2.53125}, {1.4375, 2.53125}, {1.5, 2.4}}, // rim
    {{1.5, 2.4}, {1.75, 1.875}, {2.0, 1.35}, {2.0, 0.9}},           // body
    {{2.0, 0.9}, {2.0, 0.45}, {1.5, 0.225}, {1.5, 0.15}},           // body
    {{0.0, 3.15}, {0.8, 3.15}, {0.0, 2.85}, {0.2, 2.7}},            // lid
    {{0.2, 2.7}, {0.4, 2.55}, {1.3, 2.55}, {1.3, 2.4}},             // lid
    {{1.5, 0.15}, {1.5, 0.075}, {1.425, 0.0}, {0.0, 0.0}},          // bottom
};

static const double half_points[HALF_PATCHES][4][4][3] = {
    // Handle.
    {{{-1.6, 0, 2.025}, {-1.6, -0.3, 2.025}, {-1.5, -0.3, 2.25}, {-1.5, 0, 2.25}},
     {{-2.3, 0, 2.025}, {-2.3, -0.3, 2.025}, {-2.5, -0.3, 2.25}, {-2.5, 0, 2.25}},
     {{-2.7, 0, 2.025}, {-2.7, -0.3, 2.025}, {-3, -0.3, 2.25}, {-3, 0, 2.25}},
     {{-2.7, 0, 1.8}, {-2.7, -0.3, 1.8}, {-3, -0.3, 1.8}, {-3, 0, 1.8}}},
    {{{-2.7, 0, 1.8}, {-2.7, -0.3, 1.8}, {-3, -0.3, 1.8}, {-3, 0, 1.8}},
     {{-2.7, 0, 1.575}, {-2.7, -0.3, 1.575}, {-3, -0.3, 1.35}, {-3, 0, 1.35}},
     {{-2.5, 0, 1.125}, {-2.5, -0.3, 1.125}, {-2.65, -0.3, 0.9375}, {-2.65, 0, 0.9375}},
     {{-2, 0, 0.9}, {-2, -0.3, 0.9}, {-1.9, -0.3, 0.6}, {-1.9, 0, 0.6}}},
    // Spout.
    {{{1.7, 0, 1.425}, {1.7, -0.66, 1.425}, {1.7, -0.66, 0.6}, {1.7, 0, 0.6}},
     {{2.6, 0, 1.425}, {2.6, -0.66, 1.425}, {3.1, -0.66, 0.825}, {3.1, 0, 0.825}},
     {{2.3, 0, 2.1}, {2.3, -0.25, 2.1}, {2.4, -0.25, 2.025}, {2.4, 0, 2.025}},
     {{2.7, 0, 2.4}, {2.7, -0.25, 2.4}, {3.3, -0.25, 2.4}, {3.3, 0, 2.4}}},
    {{{2.7, 0, 2.4}, {2.7, -0.25, 2.4}, {3.3, -0.25, 2.4}, {3.3, 0, 2.4}},
     {{2.8, 0, 2.475}, {2.8, -0.25, 2.475}, {3.525, -0.25, 2.49375}, {3.525, 0, 2.49375}},
     {{2.9, 0, 2.475}, {2.9, -0.15, 2.475}, {3.45, -0.15, 2.5125}, {3.45, 0, 2.5125}},
     {{2.8, 0, 2.4}, {2.8, -0.15, 2.4}, {3.2, -0.15, 2.4}, {3.2, 0, 2.4}}},
};

struct patch {
    double points[4][4][3];
};

static void bernstein(double t, double out_weights[4], double out_slopes[4])
{
    double s = 1.0 - t;
    const double weights[4] = {s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
    const double slopes[4] = {-3 * s * s, 3 * s * s - 6 * s * t, 6 * s * t - 3 * t * t, 3 * t * t};
    for (int i = 0; i < 4; i++) {
        out_weights[i] = weights[i];
        out_slopes[i] = slopes[i];
    }
}

static void patch_evaluate(const struct patch *patch, double u, double v, double out[3][3])
{
    double u_weights[4], u_slopes[4], v_weights[4], v_slopes[4];
    bernstein(u, u_weights, u_slopes);
    bernstein(v, v_weights, v_slopes);
    for (int axis = 0; axis < 3; axis++) {
        out[0][axis] = out[1][axis] = out[2][axis] = 0.0;
        for (int row = 0; row < 4; row++)
            for (int column = 0; column < 4; column++) {
                double value = patch->points[row][column][axis];
                out[0][axis] += v_weights[row] * u_weights[column] * value;
                out[1][axis] += v_weights[row] * u_slopes[column] * value;
                out[2][axis] += v_slopes[row] * u_weights[column] * value;
            }
    }
}

// From Newell's axes to Y up.
static void turn_upright(const double vector[3], double out[3])
{
    out[0] = vector[0];
    out[1] = vector[2];
    out[2] = -vector[1];
}

static void patch_position(const void *context, double u, double v, double out_position[3])
{
    double values[3][3];
    patch_evaluate(context, u, v, values);
    turn_upright(values[0], out_position);
}

static void patch_normal(const void *context, double u, double v, double out_normal[3])
{
    double values[3][3], normal[3], length;
    // Where a row of control points collapses to one point, the derivative along it vanishes. The
    // normal has a limit there; a point nearby approximates it well.
    for (int attempt = 0; attempt < 2; attempt++) {
        patch_evaluate(context, u, v, values);
        for (int axis = 0; axis < 3; axis++) {
            int next = (axis + 1) % 3, last = (axis + 2) % 3;
            normal[axis] = values[1][next] * values[2][last] - values[1][last] * values[2][next];
        }
        length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
        if (length > 1e-7)
            break;
        v = v < 0.5 ? 1e-4 : 1.0 - 1e-4;
    }
    for (int axis = 0; axis < 3; axis++)
        normal[axis] /= length;
    turn_upright(normal, out_normal);
}

// Adds the patch, mirrored by the signs of x and y.
static void add_patch(struct mesh_builder *builder, const double points[4][4][3],
                      const int signs[2], uint32_t divisions)
{
    struct patch patch;
    for (int row = 0; row < 4; row++)
        for (int column = 0; column < 4; column++)
            for (int axis = 0; axis < 3; axis++)
                patch.points[row][column][axis] =
                    points[row][column][axis] * (axis < 2 ? signs[axis] : 1);
    struct surface_params params = {
        .position = patch_position,
        .normal = patch_normal,
        .context = &patch,
        .columns = divisions,
        .rows = divisions,
        .texture_size = {1.0f, 1.0f},
        .flipped = signs[0] * signs[1] < 0,
    };
    mesh_builder_add_surface(builder, &params);
}

void mesh_builder_add_teapot(struct mesh_builder *builder, float scale, uint32_t divisions)
{
    mat4 placement;
    glm_mat4_copy(builder->placement, placement);
    glm_scale_uni(builder->placement, scale);
    for (int i = 0; i < QUARTER_PATCHES; i++) {
        double points[4][4][3];
        for (int row = 0; row < 4; row++) {
            double radius = quarter_rows[i][row][0], height = quarter_rows[i][row][1];
            const double quarter[4][2] = {{radius, 0},
                                          {radius, -QUARTER_TANGENT * radius},
                                          {QUARTER_TANGENT * radius, -radius},
                                          {0, -radius}};
            for (int column = 0; column < 4; column++) {
                points[row][column][0] = quarter[column][0];
                points[row][column][1] = quarter[column][1];
                points[row][column][2] = height;
            }
        }
        for (int quarter = 0; quarter < 4; quarter++) {
            const int signs[2] = {quarter & 1 ? -1 : 1, quarter & 2 ? -1 : 1};
            add_patch(builder, points, signs, divisions);
        }
    }
    for (int i = 0; i < HALF_PATCHES; i++)
        for (int side = 0; side < 2; side++) {
            const int signs[2] = {1, side ? -1 : 1};
            add_patch(builder, half_points[i], signs, divisions);
        }
    glm_mat4_copy(placement, builder->placement);
}
