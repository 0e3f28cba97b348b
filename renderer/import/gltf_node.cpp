#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <new>

#include "renderer/import/gltf_import.hpp"
#include "renderer/scene/vector3.h"

#define GLTF_MAX_TRANSLATION 1e15 // metres
#define GLTF_MAX_SCALE       1e15
#define GLTF_MIN_FOV_RAD     0.001
#define GLTF_MAX_FOV_RAD     3.1
#define GLTF_DEFAULT_FOV_RAD 0.8
#define GLTF_MAX_INTENSITY   1e12 // candela or lux

#define GLTF_NO_PARENT (-1)

// Reserves one more element in one of the scene's arrays.
template <typename item>
static void reserve_one(item *&items, uint32_t count, uint32_t &capacity, uint32_t limit,
                        const char *what)
{
    if (count >= limit) {
        import_fail("more than %u %s", limit, what);
    }
    if (count < capacity) {
        return;
    }
    uint32_t grown_capacity = capacity ? capacity * 2 : 16;
    item *grown = (item *)realloc(items, (size_t)grown_capacity * sizeof(item));
    if (!grown) {
        throw std::bad_alloc();
    }
    items = grown;
    capacity = grown_capacity;
}

static std::vector<int> find_parents(const tinygltf::Model &model)
{
    std::vector<int> parents(model.nodes.size(), GLTF_NO_PARENT);
    for (size_t i = 0; i < model.nodes.size(); i++) {
        for (int child : model.nodes[i].children) {
            int &parent = parents[(size_t)child];
            if (parent != GLTF_NO_PARENT) {
                import_fail("nodes[%d] is listed as a child twice, by nodes[%d] and nodes[%zu]",
                            child, parent, i);
            }
            parent = (int)i;
        }
    }
    return parents;
}

// Appends all descendants of the nodes in `order`, parents first. Iterative, since chains can be as
// long as the file.
static void add_descendants(const tinygltf::Model &model, std::vector<int> &order)
{
    for (size_t next = 0; next < order.size(); next++) {
        const std::vector<int> &children = model.nodes[(size_t)order[next]].children;
        order.insert(order.end(), children.begin(), children.end());
    }
}

static void check_no_cycles(const tinygltf::Model &model, const std::vector<int> &parents)
{
    std::vector<int> order;
    for (size_t i = 0; i < parents.size(); i++) {
        if (parents[i] == GLTF_NO_PARENT) {
            order.push_back((int)i);
        }
    }
    add_descendants(model, order);
    if (order.size() != model.nodes.size()) {
        import_fail("%zu nodes are descendants of themselves", model.nodes.size() - order.size());
    }
}

// Roots of the default scene, else of the first; all root nodes if there is no scene.
static std::vector<int> find_roots(gltf_import &import, const std::vector<int> &parents)
{
    const tinygltf::Model &model = import.model;
    std::vector<int> roots;
    if (model.scenes.empty()) {
        for (size_t i = 0; i < parents.size(); i++) {
            if (parents[i] == GLTF_NO_PARENT) {
                roots.push_back((int)i);
            }
        }
        return roots;
    }
    size_t scene = model.defaultScene >= 0 ? (size_t)model.defaultScene : 0;
    std::vector<bool> listed(parents.size());
    for (int node : model.scenes[scene].nodes) {
        if (parents[(size_t)node] != GLTF_NO_PARENT) {
            import_fail("scenes[%zu] lists nodes[%d], which is a child of nodes[%d]", scene, node,
                        parents[(size_t)node]);
        }
        if (!listed[(size_t)node]) {
            listed[(size_t)node] = true;
            roots.push_back(node);
        }
    }
    return roots;
}

// Rotation matrix, as columns, to a unit quaternion. After K. Shoemake (1985).
static void quaternion_from_columns(const double columns[3][3], float out[4])
{
    double trace = columns[0][0] + columns[1][1] + columns[2][2];
    double q[4];
    if (trace > 0) {
        double s = std::sqrt(trace + 1) * 2;
        q[0] = (columns[1][2] - columns[2][1]) / s;
        q[1] = (columns[2][0] - columns[0][2]) / s;
        q[2] = (columns[0][1] - columns[1][0]) / s;
        q[3] = s / 4;
    } else {
        int i = columns[1][1] > columns[0][0] ? 1 : 0;
        if (columns[2][2] > columns[i][i]) {
            i = 2;
        }
        int j = (i + 1) % 3;
        int k = (i + 2) % 3;
        double s = std::sqrt(1 + columns[i][i] - columns[j][j] - columns[k][k]) * 2;
        q[i] = s / 4;
        q[j] = (columns[i][j] + columns[j][i]) / s;
        q[k] = (columns[i][k] + columns[k][i]) / s;
        q[3] = (columns[j][k] - columns[k][j]) / s;
    }
    for (int i = 0; i < 4; i++) {
        out[i] = gltf_float(q[i], i == 3 ? 1 : 0);
    }
}

// Makes column `axis` perpendicular to those before it, and unit length; chooses any direction if
// nothing is left of it.
static void orthonormalize(double columns[3][3], int axis)
{
    double *column = columns[axis];
    for (int before = 0; before < axis; before++) {
        double along = vector3_dot(column, columns[before]);
        for (int i = 0; i < 3; i++) {
            column[i] -= along * columns[before][i];
        }
    }
    double length = vector3_length(column);
    if (length < 1e-9) {
        // The unit axis least parallel to the others, made perpendicular in turn.
        int best = 0;
        for (int candidate = 1; candidate < 3; candidate++) {
            double lean_best = 0, lean = 0;
            for (int before = 0; before < axis; before++) {
                lean_best += std::fabs(columns[before][best]);
                lean += std::fabs(columns[before][candidate]);
            }
            best = lean < lean_best ? candidate : best;
        }
        for (int i = 0; i < 3; i++) {
            column[i] = i == best ? 1 : 0;
        }
        return axis == 0 ? (void)0 : orthonormalize(columns, axis);
    }
    for (int i = 0; i < 3; i++) {
        column[i] /= length;
    }
}

static void set_from_matrix(gltf_import &import, const std::vector<double> &matrix,
                            scene_node &node)
{
    double columns[3][3];
    double scale[3];
    bool clamped = false;
    for (int axis = 0; axis < 3; axis++) {
        for (int i = 0; i < 3; i++) {
            columns[axis][i] = matrix[(size_t)(axis * 4 + i)];
        }
        double length = std::hypot(columns[axis][0], columns[axis][1], columns[axis][2]);
        scale[axis] = std::min(length, GLTF_MAX_SCALE);
        clamped = clamped || length > GLTF_MAX_SCALE;
        for (int i = 0; i < 3; i++) {
            columns[axis][i] = length > 0 ? columns[axis][i] / length : 0;
        }
    }
    double shear = 0;
    for (int axis = 0; axis < 3; axis++) {
        shear = std::max(shear, std::fabs(vector3_dot(columns[axis], columns[(axis + 1) % 3])));
    }
    if (shear > 1e-3) {
        import_warn_once(import, "node matrices with shear are approximated without it");
    }
    if (clamped) {
        import_warn_once(import, "node scales beyond %g are taken as %g", GLTF_MAX_SCALE,
                         GLTF_MAX_SCALE);
    }
    double cross[3];
    vector3_cross(cross, columns[0], columns[1]);
    bool mirrored = vector3_dot(cross, columns[2]) < 0;
    for (int axis = 0; mirrored && axis < 3; axis++) {
        scale[axis] = -scale[axis]; // all three, so that the rest is a rotation
        for (int i = 0; i < 3; i++) {
            columns[axis][i] = -columns[axis][i];
        }
    }
    orthonormalize(columns, 0);
    orthonormalize(columns, 1);
    vector3_cross(columns[2], columns[0], columns[1]);
    quaternion_from_columns(columns, node.rotation);
    for (int axis = 0; axis < 3; axis++) {
        node.scale[axis] = (float)scale[axis];
        node.translation[axis] =
            gltf_clamped(import, matrix[(size_t)(12 + axis)], -GLTF_MAX_TRANSLATION,
                         GLTF_MAX_TRANSLATION, "node translation");
    }
}

static void set_rotation(gltf_import &import, const std::vector<double> &rotation, scene_node &node)
{
    double largest = 0;
    for (double value : rotation) {
        largest = std::max(largest, std::fabs(value));
    }
    double square = 0;
    for (double value : rotation) {
        square += largest > 0 ? value / largest * (value / largest) : 0;
    }
    if (!(largest > 0)) {
        import_warn_once(import, "node rotations of length 0 are taken as none");
        return;
    }
    for (size_t i = 0; i < 4; i++) {
        node.rotation[i] = (float)(rotation[i] / largest / std::sqrt(square));
    }
}

static void set_placement(gltf_import &import, const tinygltf::Node &source, scene_node &node)
{
    if (source.matrix.size() == 16) {
        set_from_matrix(import, source.matrix, node);
        return;
    }
    for (size_t i = 0; i < 3 && source.translation.size() == 3; i++) {
        node.translation[i] = gltf_clamped(import, source.translation[i], -GLTF_MAX_TRANSLATION,
                                           GLTF_MAX_TRANSLATION, "node translation");
    }
    for (size_t i = 0; i < 3 && source.scale.size() == 3; i++) {
        node.scale[i] =
            gltf_clamped(import, source.scale[i], -GLTF_MAX_SCALE, GLTF_MAX_SCALE, "node scale");
    }
    if (source.rotation.size() == 4) {
        set_rotation(import, source.rotation, node);
    }
}

static void set_cone(gltf_import &import, const tinygltf::SpotLight &spot, scene_light &light)
{
    light.outer_cone_rad =
        gltf_clamped(import, spot.outerConeAngle, 0.001, M_PI / 2, "light outer cone angle");
    light.inner_cone_rad = gltf_clamped(import, spot.innerConeAngle, 0, light.outer_cone_rad,
                                        "light inner cone angle");
}

static void add_light(gltf_import &import, int index, uint32_t node)
{
    const tinygltf::Light &source = import.model.lights[(size_t)index];
    scene *target = import.scene;
    scene_light light;
    enum scene_light_type type = SCENE_LIGHT_POINT;
    if (source.type == "directional") {
        type = SCENE_LIGHT_DIRECTIONAL;
    } else if (source.type == "spot") {
        type = SCENE_LIGHT_SPOT;
    } else if (source.type != "point") {
        import_fail("light %d: type '%s' is unknown; allowed are directional, point and spot",
                    index, import_short_name(source.type, 40).c_str());
    }
    reserve_one(target->lights, target->light_count, target->light_capacity, SCENE_MAX_LIGHTS,
                "lights");
    scene_light_init(&light, type, import_short_name(source.name, 64).c_str());
    light.node = node;
    for (size_t i = 0; i < 3 && source.color.size() == 3; i++) {
        light.color[i] = gltf_clamped(import, source.color[i], 0, 1e6, "light colour");
    }
    light.intensity =
        gltf_clamped(import, source.intensity, 0, GLTF_MAX_INTENSITY, "light intensity");
    light.range_m = gltf_clamped(import, source.range, 0, FLT_MAX, "light range");
    if (type == SCENE_LIGHT_SPOT) {
        set_cone(import, source.spot, light);
    }
    target->lights[target->light_count] = light;
    target->nodes[node].light = target->light_count++;
}

static void add_camera(gltf_import &import, int index, uint32_t node)
{
    const tinygltf::Camera &source = import.model.cameras[(size_t)index];
    scene *target = import.scene;
    scene_camera camera = {};
    double fov_y_rad = source.perspective.yfov;
    if (source.type == "orthographic") {
        // The orthographic view's height, at a distance of 10 m.
        fov_y_rad = 2 * std::atan(std::fabs(source.orthographic.ymag) / 10);
        import_warn_once(import, "orthographic cameras are shown in perspective");
    } else if (source.type != "perspective") {
        import_fail("cameras[%d].type '%s' is unknown; allowed are perspective and orthographic",
                    index, import_short_name(source.type, 40).c_str());
    }
    if (!(fov_y_rad > 0 && fov_y_rad < M_PI)) {
        import_warn_once(import, "cameras[%d]: a field of view of %g rad is taken as %g", index,
                         fov_y_rad, GLTF_DEFAULT_FOV_RAD);
        fov_y_rad = GLTF_DEFAULT_FOV_RAD;
    }
    reserve_one(target->cameras, target->camera_count, target->camera_capacity, SCENE_MAX_CAMERAS,
                "cameras");
    std::string name = source.name.empty() ? target->nodes[node].name : source.name;
    snprintf(camera.name, sizeof(camera.name), "%s", import_short_name(name, 64).c_str());
    camera.node = node;
    camera.fov_y_rad = (float)std::clamp(fov_y_rad, GLTF_MIN_FOV_RAD, GLTF_MAX_FOV_RAD);
    target->cameras[target->camera_count] = camera;
    target->nodes[node].camera = target->camera_count++;
}

static int find_light(const tinygltf::Node &node)
{
    auto found = node.extensions.find("KHR_lights_punctual");
    return found == node.extensions.end() ? -1 : found->second.Get("light").GetNumberAsInt();
}

static void add_node(gltf_import &import, int index, uint32_t parent)
{
    const tinygltf::Node &source = import.model.nodes[(size_t)index];
    uint32_t id = scene_add_node(import.scene, import_short_name(source.name, 64).c_str(), parent);
    if (id == SCENE_NONE) {
        import_fail("more than %u nodes, or out of memory", SCENE_MAX_NODES);
    }
    import.node_ids[(size_t)index] = id;
    set_placement(import, source, import.scene->nodes[id]);
    if (source.mesh >= 0) {
        import.scene->nodes[id].mesh = gltf_import_mesh(import, source.mesh);
    }
    if (source.camera >= 0) {
        add_camera(import, source.camera, id);
    }
    int light = find_light(source);
    if (light >= 0) {
        add_light(import, light, id);
    }
}

void gltf_import_nodes(gltf_import &import)
{
    const tinygltf::Model &model = import.model;
    std::vector<int> parents = find_parents(model);
    check_no_cycles(model, parents);
    std::vector<int> order = find_roots(import, parents);
    add_descendants(model, order);
    import.node_ids.assign(model.nodes.size(), SCENE_NONE);
    for (int node : order) {
        int parent = parents[(size_t)node];
        add_node(import, node,
                 parent == GLTF_NO_PARENT ? SCENE_NONE : import.node_ids[(size_t)parent]);
    }
}
