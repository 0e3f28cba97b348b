// Shapes of mesh_builder.h that are made from an outline or an equation.
#include <assert.h>
#include <math.h>
#include <string.h>

#include "renderer/import/builtin/mesh_builder.h"

#define MAX_ARCH_SEGMENTS 64u

// A straight segment of an outline with the normals (out, up) and lengths at its ends.
struct outline_piece {
    struct profile_point from, to;
    float normals[2][2];
    float lengths[2]; // along the outline, metres
};

static bool piece_normal(const struct profile_point *from, float out_normal[2])
{
    float along[2] = {from[1].out - from[0].out, from[1].up - from[0].up};
    float length = hypotf(along[0], along[1]);
    if (length < 1e-6f)
        return false;
    out_normal[0] = along[1] / length;
    out_normal[1] = -along[0] / length;
    return true;
}

// Describes segment `i`; false if it has no length.
static bool outline_piece_init(struct outline_piece *piece, const struct profile_point *profile,
                               uint32_t count, uint32_t i, float length_before)
{
    float own[2];
    if (!piece_normal(&profile[i], own))
        return false;
    piece->from = profile[i];
    piece->to = profile[i + 1];
    piece->lengths[0] = length_before;
    piece->lengths[1] =
        length_before + hypotf(piece->to.out - piece->from.out, piece->to.up - piece->from.up);
    for (uint32_t end = 0; end < 2; end++) {
        float neighbour[2] = {0};
        bool has = end ? i + 2 < count && piece_normal(&profile[i + 1], neighbour)
                       : i > 0 && piece_normal(&profile[i - 1], neighbour);
        bool smooth = has && profile[i + end].smooth;
        for (int axis = 0; axis < 2; axis++)
            piece->normals[end][axis] = own[axis] + (smooth ? neighbour[axis] : 0.0f);
        float size = hypotf(piece->normals[end][0], piece->normals[end][1]);
        piece->normals[end][0] /= size;
        piece->normals[end][1] /= size;
    }
    return true;
}

static void add_lathe_piece(struct mesh_builder *builder, const struct outline_piece *piece,
                            uint32_t segments, float turn_length)
{
    uint32_t first = builder->mesh.vertex_count;
    for (uint32_t i = 0; i <= segments; i++) {
        float turn = (float)i / (float)segments;
        // Modulo, so that the seam closes exactly.
        float angle = 2.0f * (float)M_PI * (float)(i % segments) / (float)segments;
        float x = sinf(angle), z = cosf(angle);
        for (int end = 0; end < 2; end++) {
            const struct profile_point *point = end ? &piece->to : &piece->from;
            const float *normal = piece->normals[end];
            mesh_builder_add_vertex(builder, (float[3]){point->out * x, point->up, point->out * z},
                                    (float[3]){normal[0] * x, normal[1], normal[0] * z},
                                    turn * turn_length, -piece->lengths[end]);
        }
    }
    for (uint32_t i = 0; i < segments; i++) {
        uint32_t a = first + 2 * i;
        mesh_builder_add_triangle(builder, a, a + 2, a + 3);
        mesh_builder_add_triangle(builder, a, a + 3, a + 1);
    }
}

void mesh_builder_add_lathe(struct mesh_builder *builder, const struct profile_point *profile,
                            uint32_t count, uint32_t segments)
{
    float widest = 0.0f, length = 0.0f;
    for (uint32_t i = 0; i < count; i++)
        widest = fmaxf(widest, profile[i].out);
    // A whole number of metres around, so that textures match at the seam.
    float turn_length = fmaxf(1.0f, roundf(2.0f * (float)M_PI * widest));
    for (uint32_t i = 0; i + 1 < count; i++) {
        struct outline_piece piece;
        if (!outline_piece_init(&piece, profile, count, i, length))
            continue;
        length = piece.lengths[1];
        if (piece.from.out > 0.0f || piece.to.out > 0.0f)
            add_lathe_piece(builder, &piece, segments, turn_length);
    }
}

void mesh_builder_add_loop(struct mesh_builder *builder, const float half_extent[2],
                           const struct profile_point *profile, uint32_t count)
{
    static const float corners[4][2] = {{-1, 1}, {1, 1}, {1, -1}, {-1, -1}}; // signs of x, z
    static const float outward[4][2] = {{0, 1}, {1, 0}, {0, -1}, {-1, 0}};
    float length = 0.0f;
    for (uint32_t i = 0; i + 1 < count; i++) {
        struct outline_piece piece;
        if (!outline_piece_init(&piece, profile, count, i, length))
            continue;
        length = piece.lengths[1];
        for (int leg = 0; leg < 4; leg++) {
            uint32_t vertices[4]; // begin from, begin to, end from, end to
            for (int k = 0; k < 4; k++) {
                const struct profile_point *point = k & 1 ? &piece.to : &piece.from;
                const float *corner = corners[(leg + (k >> 1)) & 3], *normal = piece.normals[k & 1];
                float x = corner[0] * (half_extent[0] + point->out);
                float z = corner[1] * (half_extent[1] + point->out);
                float along = outward[leg][1] * x - outward[leg][0] * z;
                vertices[k] = mesh_builder_add_vertex(
                    builder, (float[3]){x, point->up, z},
                    (float[3]){normal[0] * outward[leg][0], normal[1], normal[0] * outward[leg][1]},
                    along, -piece.lengths[k & 1]);
            }
            mesh_builder_add_triangle(builder, vertices[0], vertices[2], vertices[3]);
            mesh_builder_add_triangle(builder, vertices[0], vertices[3], vertices[1]);
        }
    }
}

// One groove of a shaft.
struct flute {
    double radius[2], height[2], depth;
    double angle_first, angle_span;
};

static void flute_position(const void *context, double u, double v, double out_position[3])
{
    const struct flute *flute = context;
    double angle = flute->angle_first + flute->angle_span * u;
    // Entasis: the shaft narrows faster towards its head.
    double taper = 0.3 * v + 0.7 * v * v;
    double radius = flute->radius[0] + (flute->radius[1] - flute->radius[0]) * taper -
                    flute->depth * sin(M_PI * u);
    out_position[0] = radius * sin(angle);
    out_position[1] = flute->height[0] + (flute->height[1] - flute->height[0]) * v;
    out_position[2] = radius * cos(angle);
}

void mesh_builder_add_fluted_shaft(struct mesh_builder *builder, const float radius_m[2],
                                   const float height_m[2], uint32_t flutes, float depth_m)
{
    for (uint32_t i = 0; i < flutes; i++) {
        struct flute flute = {
            .radius = {radius_m[0], radius_m[1]},
            .height = {height_m[0], height_m[1]},
            .depth = depth_m,
            .angle_first = 2.0 * M_PI * i / flutes,
            .angle_span = 2.0 * M_PI / flutes,
        };
        struct surface_params params = {
            .position = flute_position,
            .context = &flute,
            .columns = 4,
            .rows = 5,
            .texture_size = {2.0f * (float)M_PI * radius_m[0] / (float)flutes,
                             height_m[0] - height_m[1]},
        };
        mesh_builder_add_surface(builder, &params);
    }
}

struct torus {
    double ring_radius, tube_radius;
};

static void torus_position(const void *context, double u, double v, double out_position[3])
{
    const struct torus *torus = context;
    double ring = 2.0 * M_PI * u, tube = 2.0 * M_PI * v;
    double radius = torus->ring_radius + torus->tube_radius * cos(tube);
    out_position[0] = radius * sin(ring);
    out_position[1] = torus->tube_radius * sin(tube);
    out_position[2] = radius * cos(ring);
}

void mesh_builder_add_torus(struct mesh_builder *builder, float ring_radius_m, float tube_radius_m,
                            uint32_t ring_segments, uint32_t tube_segments)
{
    struct torus torus = {ring_radius_m, tube_radius_m};
    struct surface_params params = {
        .position = torus_position,
        .context = &torus,
        .columns = ring_segments,
        .rows = tube_segments,
        .texture_size = {2.0f * (float)M_PI * ring_radius_m, -2.0f * (float)M_PI * tube_radius_m},
    };
    mesh_builder_add_surface(builder, &params);
}

struct sphere {
    double center[3], radius;
};

static void sphere_normal(const void *context, double u, double v, double out_normal[3])
{
    (void)context;
    double turn = 2.0 * M_PI * u, latitude = M_PI * (v - 0.5);
    double radius = v <= 0.0 || v >= 1.0 ? 0.0 : cos(latitude);
    out_normal[0] = radius * sin(turn);
    out_normal[1] = sin(latitude);
    out_normal[2] = radius * cos(turn);
}

static void sphere_position(const void *context, double u, double v, double out_position[3])
{
    const struct sphere *sphere = context;
    sphere_normal(context, u, v, out_position);
    for (int axis = 0; axis < 3; axis++)
        out_position[axis] = sphere->center[axis] + sphere->radius * out_position[axis];
}

void mesh_builder_add_sphere(struct mesh_builder *builder, const float center[3], float radius_m,
                             uint32_t segments, uint32_t rings)
{
    struct sphere sphere = {{center[0], center[1], center[2]}, radius_m};
    struct surface_params params = {
        .position = sphere_position,
        .normal = sphere_normal,
        .context = &sphere,
        .columns = segments,
        .rows = rings,
        .texture_size = {2.0f * (float)M_PI * radius_m, -(float)M_PI * radius_m},
    };
    mesh_builder_add_surface(builder, &params);
}

struct rod {
    vec3 from, to, across, other;
    double radius;
};

static void rod_position(const void *context, double u, double v, double out_position[3])
{
    const struct rod *rod = context;
    double turn = 2.0 * M_PI * u;
    for (int axis = 0; axis < 3; axis++)
        out_position[axis] =
            rod->from[axis] + v * (rod->to[axis] - rod->from[axis]) +
            rod->radius * (cos(turn) * rod->across[axis] + sin(turn) * rod->other[axis]);
}

void mesh_builder_add_rod(struct mesh_builder *builder, const float from[3], const float to[3],
                          float radius_m, uint32_t segments)
{
    struct rod rod = {.radius = radius_m};
    vec3 axis;
    memcpy(rod.from, from, sizeof(rod.from));
    memcpy(rod.to, to, sizeof(rod.to));
    glm_vec3_sub(rod.to, rod.from, axis);
    float length = glm_vec3_norm(axis);
    glm_vec3_ortho(axis, rod.across);
    glm_vec3_normalize(rod.across);
    glm_vec3_cross(axis, rod.across, rod.other);
    glm_vec3_normalize(rod.other);
    struct surface_params params = {
        .position = rod_position,
        .context = &rod,
        .columns = segments,
        .rows = 1,
        .texture_size = {2.0f * (float)M_PI * radius_m, length},
    };
    mesh_builder_add_surface(builder, &params);
}

// Points of an arch, left to right, on the opening and on the outline around it.
struct arch {
    float inner[MAX_ARCH_SEGMENTS + 1][2], outer[MAX_ARCH_SEGMENTS + 1][2];
    float inner_radius[2], outer_radius[2];
    float angles[MAX_ARCH_SEGMENTS + 1]; // from vertical
    uint32_t segments;
    float half_thickness;
};

static void add_arch_faces(struct mesh_builder *builder, const struct arch *arch)
{
    for (uint32_t i = 0; i < arch->segments; i++) {
        const float *ring[4] = {arch->inner[i], arch->inner[i + 1], arch->outer[i + 1],
                                arch->outer[i]};
        float front[4][3], back[4][3];
        for (int k = 0; k < 4; k++) {
            const float *p = ring[k];
            memcpy(front[k], (float[3]){p[0], p[1], arch->half_thickness}, sizeof(front[k]));
            memcpy(back[3 - k], (float[3]){p[0], p[1], -arch->half_thickness}, sizeof(back[k]));
        }
        mesh_builder_add_quad(builder, front);
        mesh_builder_add_quad(builder, back);
    }
}

// The curved side of an arch: the underside, or the upper side with its front upwards.
static void add_arch_curve(struct mesh_builder *builder, const struct arch *arch, bool outer)
{
    const float(*points)[2] = outer ? arch->outer : arch->inner;
    const float *radius = outer ? arch->outer_radius : arch->inner_radius;
    float side = outer ? 1.0f : -1.0f, length = 0.0f;
    uint32_t first = builder->mesh.vertex_count;
    for (uint32_t i = 0; i <= arch->segments; i++) {
        if (i > 0)
            length += hypotf(points[i][0] - points[i - 1][0], points[i][1] - points[i - 1][1]);
        float normal[3] = {side * sinf(arch->angles[i]) / radius[0],
                           side * cosf(arch->angles[i]) / radius[1], 0.0f};
        for (int back = 0; back < 2; back++) {
            float z = back ? -arch->half_thickness : arch->half_thickness;
            mesh_builder_add_vertex(builder, (float[3]){points[i][0], points[i][1], z}, normal,
                                    length, z);
        }
    }
    for (uint32_t i = 0; i < arch->segments; i++) {
        uint32_t a = first + 2 * i, b = a + (outer ? 2 : 1), d = a + (outer ? 1 : 2);
        mesh_builder_add_triangle(builder, a, b, a + 3);
        mesh_builder_add_triangle(builder, a, a + 3, d);
    }
}

static void set_arch_point(struct arch *arch, uint32_t i, float angle)
{
    bool end = i == 0 || i == arch->segments; // exactly on the springing line
    float x = i == 0 ? -1.0f : end ? 1.0f : sinf(angle), y = end ? 0.0f : cosf(angle);
    arch->angles[i] = angle;
    arch->inner[i][0] = arch->inner_radius[0] * x;
    arch->inner[i][1] = arch->inner_radius[1] * y;
    arch->outer[i][0] = arch->outer_radius[0] * x;
    arch->outer[i][1] = arch->outer_radius[1] * y;
}

void mesh_builder_add_arch_wall(struct mesh_builder *builder, const struct arch_params *params)
{
    assert(params->segments % 4 == 0 && params->segments <= MAX_ARCH_SEGMENTS);
    struct arch arch = {
        .inner_radius = {params->radius_m[0], params->radius_m[1]},
        .segments = params->segments,
        .half_thickness = 0.5f * params->thickness_m,
    };
    // Rays from the middle of the springing line hit the wall's sides, then its top; one ray passes
    // through each upper corner.
    float half_width = 0.5f * params->width_m, corner = atan2f(half_width, params->top_m);
    int32_t half = (int32_t)params->segments / 2, quarter = half / 2;
    for (int32_t i = 0; i <= 2 * half; i++) {
        int32_t step = abs(i - half);
        float angle = step <= quarter ? corner * (float)step / (float)quarter
                                      : corner + ((float)M_PI_2 - corner) *
                                                     (float)(step - quarter) / (float)quarter;
        set_arch_point(&arch, (uint32_t)i, i < half ? -angle : angle);
        float *outer = arch.outer[i];
        if (step >= quarter)
            outer[0] = i < half ? -half_width : half_width;
        else
            outer[0] = copysignf(params->top_m * tanf(angle), (float)(i - half));
        outer[1] = step == 2 * quarter ? 0.0f
                   : step > quarter    ? half_width / tanf(angle)
                                       : params->top_m;
    }
    add_arch_faces(builder, &arch);
    add_arch_curve(builder, &arch, false);
}

void mesh_builder_add_arch_band(struct mesh_builder *builder, const float inner_m[2],
                                const float outer_m[2], float thickness_m, uint32_t segments)
{
    assert(segments <= MAX_ARCH_SEGMENTS);
    struct arch arch = {
        .inner_radius = {inner_m[0], inner_m[1]},
        .outer_radius = {outer_m[0], outer_m[1]},
        .segments = segments,
        .half_thickness = 0.5f * thickness_m,
    };
    for (uint32_t i = 0; i <= segments; i++)
        set_arch_point(&arch, i, (float)M_PI * ((float)i / (float)segments - 0.5f));
    add_arch_faces(builder, &arch);
    add_arch_curve(builder, &arch, false);
    add_arch_curve(builder, &arch, true);
}
