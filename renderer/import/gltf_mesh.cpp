#include <cmath>
#include <cstdlib>
#include <cstring>
#include <new>

#include "renderer/import/gltf_import.hpp"

extern "C" {
#include "renderer/scene/triangle_mesh.h"
}

#define GLTF_MAX_UV 1e6f

enum gltf_mode {
    GLTF_MODE_TRIANGLES = 4,
    GLTF_MODE_TRIANGLE_STRIP = 5,
    GLTF_MODE_TRIANGLE_FAN = 6
};

// A triangle mesh, freed on exceptions.
struct owned_triangle_mesh {
    struct triangle_mesh mesh = {};
    owned_triangle_mesh() = default;
    owned_triangle_mesh(const owned_triangle_mesh &) = delete;
    owned_triangle_mesh &operator=(const owned_triangle_mesh &) = delete;
    ~owned_triangle_mesh()
    {
        triangle_mesh_finish(&mesh);
    }
};

// A primitive under import: its attributes and the file's vertices that it uses.
struct gltf_primitive {
    const tinygltf::Primitive &source;
    std::string location;
    gltf_elements positions;
    std::vector<uint32_t> used; // attribute indices by vertex of the mesh
};

static int find_attribute(const gltf_primitive &primitive, const char *name)
{
    auto found = primitive.source.attributes.find(name);
    return found == primitive.source.attributes.end() ? -1 : found->second;
}

// False if the primitive lacks the attribute; fails if its type is wrong.
static bool get_attribute(gltf_import &import, const gltf_primitive &primitive, const char *name,
                          uint32_t components_low, uint32_t components_high, gltf_elements &out)
{
    int accessor = find_attribute(primitive, name);
    if (accessor < 0) {
        return false;
    }
    out = gltf_get_elements(import, accessor);
    if (out.components < components_low || out.components > components_high) {
        import_fail("%s: %s has %u components; allowed are %u to %u", primitive.location.c_str(),
                    name, out.components, components_low, components_high);
    }
    if (out.count < primitive.positions.count) {
        import_fail("%s: %s has %u elements, POSITION has %u", primitive.location.c_str(), name,
                    out.count, primitive.positions.count);
    }
    return true;
}

// Corners of the primitive in the file's order, all below the number of vertices.
static std::vector<uint32_t> read_corners(gltf_import &import, const gltf_primitive &primitive)
{
    std::vector<uint32_t> corners;
    uint32_t vertex_count = primitive.positions.count;
    if (primitive.source.indices < 0) {
        corners.resize(vertex_count);
        for (uint32_t i = 0; i < vertex_count; i++) {
            corners[i] = i;
        }
        return corners;
    }
    gltf_elements indices = gltf_get_elements(import, primitive.source.indices);
    bool is_unsigned = indices.component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                       indices.component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                       indices.component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    if (!is_unsigned || indices.components != 1) {
        import_fail("%s: indices must be unsigned integers, one a vertex",
                    primitive.location.c_str());
    }
    corners.resize(indices.count);
    for (uint32_t i = 0; i < indices.count; i++) {
        corners[i] = gltf_read_index(indices, i);
        if (corners[i] >= vertex_count) {
            import_fail("%s: index %u of %u vertices", primitive.location.c_str(), corners[i],
                        vertex_count);
        }
    }
    return corners;
}

static bool is_usable_position(const gltf_elements &positions, uint32_t index)
{
    float position[3] = {};
    gltf_read_element(positions, index, position, 3);
    return std::fabs(position[0]) <= SCENE_MAX_COORDINATE_M &&
           std::fabs(position[1]) <= SCENE_MAX_COORDINATE_M &&
           std::fabs(position[2]) <= SCENE_MAX_COORDINATE_M;
}

// Triangle `index` of a list, strip or fan, wound as in glTF 2.0, 3.7.2.1.
static void get_triangle(const std::vector<uint32_t> &corners, int mode, size_t index,
                         uint32_t out[3])
{
    if (mode == GLTF_MODE_TRIANGLE_STRIP) {
        size_t odd = index % 2;
        out[0] = corners[index];
        out[1] = corners[index + 1 + odd];
        out[2] = corners[index + 2 - odd];
    } else if (mode == GLTF_MODE_TRIANGLE_FAN) {
        out[0] = corners[index + 1];
        out[1] = corners[index + 2];
        out[2] = corners[0];
    } else {
        memcpy(out, &corners[index * 3], 3 * sizeof(*out));
    }
}

static void keep_triangles(gltf_import &import, const gltf_primitive &primitive,
                           const std::vector<uint32_t> &corners, std::vector<uint32_t> &out)
{
    int mode = primitive.source.mode < 0 ? GLTF_MODE_TRIANGLES : primitive.source.mode;
    size_t triangle_count = corners.size() < 3            ? 0
                            : mode == GLTF_MODE_TRIANGLES ? corners.size() / 3
                                                          : corners.size() - 2;
    if (mode == GLTF_MODE_TRIANGLES && corners.size() % 3 != 0) {
        import_warn_once(import, "%s: the incomplete last triangle is dropped",
                         primitive.location.c_str());
    }
    size_t unusable = 0;
    out.reserve(triangle_count * 3);
    for (size_t i = 0; i < triangle_count; i++) {
        uint32_t triangle[3];
        get_triangle(corners, mode, i, triangle);
        if (triangle[0] == triangle[1] || triangle[1] == triangle[2] ||
            triangle[2] == triangle[0]) {
            continue; // joins strips, or has no area anyway
        }
        bool usable = true;
        for (uint32_t corner : triangle) {
            usable = usable && is_usable_position(primitive.positions, corner);
        }
        if (usable) {
            out.insert(out.end(), triangle, triangle + 3);
        } else {
            unusable++;
        }
    }
    import.scene->rejects.triangles += (uint32_t)unusable;
    if (unusable > 0) {
        import_warn_once(import,
                         "%s: %zu triangles with positions that are not finite or beyond "
                         "%g m are dropped",
                         primitive.location.c_str(), unusable, (double)SCENE_MAX_COORDINATE_M);
    }
}

// Renumbers `triangles` by first use and drops unused vertices. The numbers are kept in the import,
// since clearing them for each primitive would cost time proportional to the accessor.
static void compact_vertices(gltf_import &import, gltf_primitive &primitive,
                             std::vector<uint32_t> &triangles)
{
    if (import.vertex_numbers.size() < primitive.positions.count) {
        import.vertex_numbers.resize(primitive.positions.count, SCENE_NONE);
    }
    for (uint32_t &corner : triangles) {
        uint32_t &number = import.vertex_numbers[corner];
        if (number == SCENE_NONE) {
            number = (uint32_t)primitive.used.size();
            primitive.used.push_back(corner);
        }
        corner = number;
    }
    for (uint32_t vertex : primitive.used) {
        import.vertex_numbers[vertex] = SCENE_NONE;
    }
}

static void read_uv(gltf_import &import, const gltf_primitive &primitive, uint32_t set,
                    struct triangle_mesh &mesh)
{
    gltf_elements elements;
    const char *name = set == 0 ? "TEXCOORD_0" : "TEXCOORD_1";
    if (!get_attribute(import, primitive, name, 2, 2, elements)) {
        return;
    }
    for (uint32_t i = 0; i < mesh.vertex_count; i++) {
        float *uv = mesh.vertices[i].uv[set];
        gltf_read_element(elements, primitive.used[i], uv, 2);
        bool unusable_found = false;
        for (int axis = 0; axis < 2; axis++) {
            if (!(std::fabs(uv[axis]) <= GLTF_MAX_UV)) {
                uv[axis] = 0;
                unusable_found = true;
                import_warn_once(import, "%s: %s values that are not finite or huge are taken as 0",
                                 primitive.location.c_str(), name);
            }
        }
        import.scene->rejects.vertices += unusable_found;
    }
}

static void read_colors(gltf_import &import, const gltf_primitive &primitive,
                        struct triangle_mesh &mesh)
{
    gltf_elements elements = {};
    bool present = get_attribute(import, primitive, "COLOR_0", 3, 4, elements);
    for (uint32_t i = 0; i < mesh.vertex_count; i++) {
        float *color = mesh.vertices[i].color;
        color[0] = color[1] = color[2] = color[3] = 1;
        if (!present) {
            continue;
        }
        gltf_read_element(elements, primitive.used[i], color, 4);
        for (int channel = 0; channel < 4; channel++) {
            color[channel] = !(color[channel] >= 0) ? 0 : std::fmin(color[channel], 1.0f);
        }
    }
}

static void read_normals(gltf_import &import, const gltf_primitive &primitive,
                         struct triangle_mesh &mesh)
{
    gltf_elements elements;
    if (!get_attribute(import, primitive, "NORMAL", 3, 3, elements)) {
        if (!triangle_mesh_make_flat_normals(&mesh)) {
            throw std::bad_alloc();
        }
        return;
    }
    for (uint32_t i = 0; i < mesh.vertex_count; i++) {
        gltf_read_element(elements, primitive.used[i], mesh.vertices[i].normal, 3);
    }
    uint32_t repaired = triangle_mesh_repair_normals(&mesh);
    import.scene->rejects.vertices += repaired;
    if (repaired > 0) {
        import_warn_once(import, "%s: %u normals that are zero or not finite are recomputed",
                         primitive.location.c_str(), repaired);
    }
}

static void set_tangents(gltf_import &import, const gltf_primitive &primitive,
                         struct triangle_mesh &mesh, uint32_t material)
{
    const scene_texture &normal_map =
        import.scene->materials[material].textures[SCENE_TEXTURE_NORMAL];
    gltf_elements elements;
    if (normal_map.image == SCENE_NONE) {
        triangle_mesh_set_any_tangents(&mesh);
    } else if (find_attribute(primitive, "NORMAL") >= 0 &&
               get_attribute(import, primitive, "TANGENT", 4, 4, elements)) {
        for (uint32_t i = 0; i < mesh.vertex_count; i++) {
            gltf_read_element(elements, primitive.used[i], mesh.vertices[i].tangent, 4);
        }
        triangle_mesh_repair_tangents(&mesh);
    } else if (!triangle_mesh_make_tangents(&mesh, normal_map.uv_set)) {
        throw std::bad_alloc();
    }
}

static uint32_t find_material(gltf_import &import, const gltf_primitive &primitive)
{
    if (primitive.source.material >= 0) {
        return import.material_ids[(size_t)primitive.source.material];
    }
    if (import.model.materials.empty()) {
        return 0;
    }
    if (import.default_material == SCENE_NONE) {
        scene_material material;
        scene_material_init(&material, "default");
        import.default_material = scene_add_material(import.scene, &material);
        if (import.default_material == SCENE_NONE) {
            import_fail("more than %u materials, or out of memory", SCENE_MAX_MATERIALS);
        }
    }
    return import.default_material;
}

static void fill_mesh(const gltf_primitive &primitive, const std::vector<uint32_t> &triangles,
                      struct triangle_mesh &mesh)
{
    mesh.vertex_count = (uint32_t)primitive.used.size();
    mesh.index_count = (uint32_t)triangles.size();
    mesh.vertices = (struct scene_vertex *)calloc(mesh.vertex_count, sizeof(*mesh.vertices));
    mesh.indices = (uint32_t *)malloc(triangles.size() * sizeof(*mesh.indices));
    if (!mesh.vertices || !mesh.indices) {
        throw std::bad_alloc();
    }
    memcpy(mesh.indices, triangles.data(), triangles.size() * sizeof(*mesh.indices));
    for (uint32_t i = 0; i < mesh.vertex_count; i++) {
        gltf_read_element(primitive.positions, primitive.used[i], mesh.vertices[i].position, 3);
    }
}

static void check_amplification(gltf_import &import, size_t index_count)
{
    import.index_total += index_count;
    uint64_t allowed = import.buffer_bytes * GLTF_INDICES_PER_BYTE;
    if (import.index_total > (allowed > GLTF_FREE_INDICES ? allowed : GLTF_FREE_INDICES)) {
        import_fail("primitives that share accessors add up to more than %u triangle corners and "
                    "%u for each byte of the buffers",
                    GLTF_FREE_INDICES, GLTF_INDICES_PER_BYTE);
    }
}

// Imports a primitive and completes its attributes; first adds the mesh if `mesh_id` is unset.
static void import_primitive(gltf_import &import, const tinygltf::Mesh &mesh_source,
                             gltf_primitive &primitive, uint32_t &mesh_id)
{
    if (primitive.source.mode >= 0 && primitive.source.mode < GLTF_MODE_TRIANGLES) {
        import_warn_once(import, "%s: points and lines are not drawn", primitive.location.c_str());
        return;
    }
    if (!get_attribute(import, primitive, "POSITION", 3, 3, primitive.positions)) {
        import_warn_once(import, "%s: no POSITION, nothing to draw", primitive.location.c_str());
        return;
    }
    std::vector<uint32_t> triangles;
    {
        std::vector<uint32_t> corners = read_corners(import, primitive);
        check_amplification(import, corners.size() * (primitive.source.mode > 4 ? 3 : 1));
        keep_triangles(import, primitive, corners, triangles);
    }
    if (triangles.empty()) {
        return;
    }
    compact_vertices(import, primitive, triangles);
    uint32_t material = find_material(import, primitive);
    owned_triangle_mesh owned;
    fill_mesh(primitive, triangles, owned.mesh);
    triangles = std::vector<uint32_t>();
    read_uv(import, primitive, 0, owned.mesh);
    read_uv(import, primitive, 1, owned.mesh);
    read_colors(import, primitive, owned.mesh);
    read_normals(import, primitive, owned.mesh);
    set_tangents(import, primitive, owned.mesh, material);
    if (mesh_id == SCENE_NONE) {
        mesh_id = scene_add_mesh(import.scene, import_short_name(mesh_source.name, 64).c_str());
    }
    if (mesh_id == SCENE_NONE ||
        scene_add_primitive(import.scene, owned.mesh.vertices, owned.mesh.vertex_count,
                            owned.mesh.indices, owned.mesh.index_count, material) == SCENE_NONE) {
        import_fail("%s: more than %u vertices, %u triangle corners, %u primitives or %u meshes, "
                    "or out of memory",
                    primitive.location.c_str(), SCENE_MAX_VERTICES, SCENE_MAX_INDICES,
                    SCENE_MAX_PRIMITIVES, SCENE_MAX_MESHES);
    }
}

uint32_t gltf_import_mesh(gltf_import &import, int mesh)
{
    size_t index = (size_t)mesh;
    if (import.mesh_ids.empty()) {
        import.mesh_ids.assign(import.model.meshes.size(), SCENE_NONE);
        import.mesh_done.assign(import.model.meshes.size(), false);
    }
    if (import.mesh_done[index]) {
        return import.mesh_ids[index];
    }
    const tinygltf::Mesh &source = import.model.meshes[index];
    uint32_t mesh_id = SCENE_NONE;
    for (size_t i = 0; i < source.primitives.size(); i++) {
        gltf_primitive primitive = {source.primitives[i],
                                    "meshes[" + std::to_string(index) + "].primitives[" +
                                        std::to_string(i) + "]",
                                    {},
                                    {}};
        import_primitive(import, source, primitive, mesh_id);
    }
    import.mesh_ids[index] = mesh_id;
    import.mesh_done[index] = true;
    return mesh_id;
}
