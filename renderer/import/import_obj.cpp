#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <new>
#include <sstream>
#include <unordered_map>

#include "renderer/import/obj_import.hpp"

extern "C" {
#include "renderer/import/importers.h"
#include "renderer/import/scene_load.h"
#include "renderer/scene/triangle_mesh.h"
}

#define OBJ_MAX_UV      1e6f
#define OBJ_MAX_CORNERS 32768u // of one face: triangulation can take quadratic time

#define OBJ_NO_INDEX INT64_MIN

// Indices into the file's lists, from 0; OBJ_NO_INDEX where the face has none.
struct obj_corner {
    int64_t position;
    int64_t uv;
    int64_t normal;
};

struct obj_face {
    uint32_t corner_first;
    uint32_t corner_count;
    uint32_t smoothing; // group; 0: flat
};

struct obj_float3 {
    float value[3];
};

// Triangle corners with equal keys share a vertex.
struct vertex_key {
    uint32_t position;
    uint32_t uv;     // SCENE_NONE: none
    uint64_t normal; // in the file's list, in the smooth normals, or the face's own
    bool operator==(const vertex_key &other) const
    {
        return position == other.position && uv == other.uv && normal == other.normal;
    }
};

struct vertex_key_hash {
    size_t operator()(const vertex_key &key) const
    {
        uint64_t hash = key.position * 0x9e3779b97f4a7c15ull;
        hash = (hash ^ key.uv) * 0xc2b2ae3d27d4eb4full;
        hash = (hash ^ hash >> 29 ^ key.normal) * 0x165667b19e3779f9ull;
        return hash ^ hash >> 32;
    }
};

#define NORMAL_SMOOTH (1ull << 62)
#define NORMAL_FLAT   (1ull << 63)

// Data collected by the parser's callbacks.
struct obj_document {
    obj_import *import;
    std::vector<obj_float3> positions, normals, uvs;
    std::vector<obj_corner> corners;
    std::map<uint32_t, std::vector<obj_face>> faces; // by the scene's material
    std::vector<obj_face> *material_faces = nullptr;
    uint32_t smoothing = 0;
    uint64_t triangle_corners = 0;
    std::unordered_map<uint64_t, obj_float3> smooth_normals; // by group << 32 | position
};

static void add_value(std::vector<obj_float3> &list, float x, float y, float z)
{
    if (list.size() >= SCENE_MAX_VERTICES) {
        import_fail("more than %u vertices, normals or texture coordinates", SCENE_MAX_VERTICES);
    }
    list.push_back({{x, y, z}});
}

static void on_position(void *user, float x, float y, float z, float)
{
    add_value(((obj_document *)user)->positions, x, y, z);
}

static void on_normal(void *user, float x, float y, float z)
{
    add_value(((obj_document *)user)->normals, x, y, z);
}

static void on_uv(void *user, float x, float y, float)
{
    add_value(((obj_document *)user)->uvs, x, y, 0);
}

// Converts an index as written (1 is the first, -1 the newest, 0 or absent none) to one from 0.
static int64_t resolve_index(int index, size_t count)
{
    if (index == 0) {
        return OBJ_NO_INDEX;
    }
    return index > 0 ? (int64_t)index - 1 : (int64_t)count + index;
}

static void on_face(void *user, tinyobj::index_t *indices, int count)
{
    obj_document &document = *(obj_document *)user;
    if (count < 3) {
        import_warn_once(*document.import, "faces of fewer than 3 corners are dropped");
        return;
    }
    document.triangle_corners += 3 * ((uint64_t)count - 2);
    if (count > (int)OBJ_MAX_CORNERS || document.triangle_corners > SCENE_MAX_INDICES) {
        import_fail("a face of %d corners, or more than %u corners in all; allowed are 3 to %u a "
                    "face",
                    count, SCENE_MAX_INDICES, OBJ_MAX_CORNERS);
    }
    obj_face face = {(uint32_t)document.corners.size(), (uint32_t)count, document.smoothing};
    for (int i = 0; i < count; i++) {
        document.corners.push_back(
            {resolve_index(indices[i].vertex_index, document.positions.size()),
             resolve_index(indices[i].texcoord_index, document.uvs.size()),
             resolve_index(indices[i].normal_index, document.normals.size())});
    }
    if (!document.material_faces) {
        document.material_faces = &document.faces[0];
    }
    document.material_faces->push_back(face);
}

static void on_material(void *user, const char *name, int)
{
    obj_document &document = *(obj_document *)user;
    auto found = document.import->material_ids.find(name);
    uint32_t id = 0;
    if (found != document.import->material_ids.end()) {
        id = found->second;
    } else {
        import_warn_once(*document.import, "some materials are defined nowhere: shown in white");
    }
    document.material_faces = &document.faces[id];
}

// Smoothing groups arrive as groups with a marked name; see obj_normalize_text().
static void on_group(void *user, const char **names, int count)
{
    obj_document &document = *(obj_document *)user;
    if (count > 0 && names[0][0] == OBJ_SMOOTHING_PREFIX) {
        document.smoothing = (uint32_t)strtoul(names[0] + 1, nullptr, 10);
    }
}

static void check_corners(obj_document &document)
{
    for (obj_corner &corner : document.corners) {
        if (corner.position < 0 || corner.position >= (int64_t)document.positions.size()) {
            import_fail("a face names a vertex that is not among the file's %zu",
                        document.positions.size());
        }
        if (corner.uv != OBJ_NO_INDEX &&
            (corner.uv < 0 || corner.uv >= (int64_t)document.uvs.size())) {
            corner.uv = OBJ_NO_INDEX;
            import_warn_once(*document.import, "texture coordinates out of range are taken as 0");
        }
        if (corner.normal != OBJ_NO_INDEX &&
            (corner.normal < 0 || corner.normal >= (int64_t)document.normals.size())) {
            corner.normal = OBJ_NO_INDEX;
            import_warn_once(*document.import, "normals out of range are recomputed");
        }
    }
}

static bool is_usable(const obj_document &document, const obj_face &face)
{
    for (uint32_t i = 0; i < face.corner_count; i++) {
        const obj_corner &corner = document.corners[face.corner_first + i];
        for (float value : document.positions[(size_t)corner.position].value) {
            if (!(std::fabs(value) <= SCENE_MAX_COORDINATE_M)) {
                return false;
            }
        }
    }
    return true;
}

// Newell's normal of a face; its length is twice the area.
static void face_normal(const obj_document &document, const obj_face &face, double out[3])
{
    out[0] = out[1] = out[2] = 0;
    for (uint32_t i = 0; i < face.corner_count; i++) {
        uint32_t after = (i + 1) % face.corner_count;
        const float *a =
            document.positions[(size_t)document.corners[face.corner_first + i].position].value;
        const float *b =
            document.positions[(size_t)document.corners[face.corner_first + after].position].value;
        for (int axis = 0; axis < 3; axis++) {
            int u = (axis + 1) % 3, v = (axis + 2) % 3;
            out[axis] += ((double)a[u] - b[u]) * ((double)a[v] + b[v]);
        }
    }
}

static void collect_smooth_normals(obj_document &document)
{
    std::unordered_map<uint64_t, std::array<double, 3>> sums;
    for (const auto &entry : document.faces) {
        for (const obj_face &face : entry.second) {
            if (face.smoothing == 0 || !is_usable(document, face)) {
                continue;
            }
            double normal[3];
            face_normal(document, face, normal);
            for (uint32_t i = 0; i < face.corner_count; i++) {
                const obj_corner &corner = document.corners[face.corner_first + i];
                if (corner.normal == OBJ_NO_INDEX) {
                    auto &sum = sums[(uint64_t)face.smoothing << 32 | (uint64_t)corner.position];
                    for (size_t axis = 0; axis < 3; axis++) {
                        sum[axis] += normal[axis];
                    }
                }
            }
        }
    }
    for (const auto &entry : sums) {
        obj_float3 normal = {};
        const auto &sum = entry.second;
        double length = std::hypot(sum[0], sum[1], sum[2]);
        for (size_t axis = 0; length > 0 && axis < 3; axis++) {
            normal.value[axis] = (float)(sum[axis] / length);
        }
        document.smooth_normals[entry.first] = normal;
    }
}

// Triangles of one material under construction.
struct obj_batch {
    std::vector<scene_vertex> vertices;
    std::vector<uint32_t> indices;
    std::unordered_map<vertex_key, uint32_t, vertex_key_hash> vertex_ids;
    uint64_t flat_faces = 0;
};

static void fill_vertex(const obj_document &document, const obj_face &face,
                        const obj_corner &corner, const double normal[3], scene_vertex &vertex)
{
    memcpy(vertex.position, document.positions[(size_t)corner.position].value,
           sizeof(vertex.position));
    vertex.color[0] = vertex.color[1] = vertex.color[2] = vertex.color[3] = 1;
    if (corner.uv != OBJ_NO_INDEX) {
        const float *uv = document.uvs[(size_t)corner.uv].value;
        bool repaired = false;
        for (int axis = 0; axis < 2; axis++) {
            float value = axis == 1 ? 1 - uv[1] : uv[0]; // OBJ's V points up
            bool usable = std::fabs(value) <= OBJ_MAX_UV;
            vertex.uv[0][axis] = usable ? value : 0;
            repaired = repaired || !usable;
        }
        document.import->scene->rejects.vertices += repaired;
    }
    if (corner.normal != OBJ_NO_INDEX) {
        memcpy(vertex.normal, document.normals[(size_t)corner.normal].value, sizeof(vertex.normal));
    } else if (face.smoothing != 0) {
        uint64_t key = (uint64_t)face.smoothing << 32 | (uint64_t)corner.position;
        memcpy(vertex.normal, document.smooth_normals.at(key).value, sizeof(vertex.normal));
    } else {
        double length = std::hypot(normal[0], normal[1], normal[2]);
        for (int axis = 0; length > 0 && axis < 3; axis++) {
            vertex.normal[axis] = (float)(normal[axis] / length);
        }
    }
}

static uint32_t vertex_of(const obj_document &document, obj_batch &batch, const obj_face &face,
                          const obj_corner &corner, const double normal[3])
{
    vertex_key key = {(uint32_t)corner.position,
                      corner.uv == OBJ_NO_INDEX ? SCENE_NONE : (uint32_t)corner.uv, 0};
    if (corner.normal != OBJ_NO_INDEX) {
        key.normal = (uint64_t)corner.normal;
    } else {
        key.normal =
            face.smoothing ? NORMAL_SMOOTH | face.smoothing : NORMAL_FLAT | batch.flat_faces;
    }
    auto inserted = batch.vertex_ids.emplace(key, (uint32_t)batch.vertices.size());
    if (inserted.second) {
        scene_vertex vertex = {};
        fill_vertex(document, face, corner, normal, vertex);
        batch.vertices.push_back(vertex);
    }
    return inserted.first->second;
}

static void add_face(obj_document &document, obj_batch &batch, const obj_face &face)
{
    double normal[3];
    std::vector<const float *> points(face.corner_count);
    std::vector<uint32_t> ids(face.corner_count), triangles;
    face_normal(document, face, normal);
    for (uint32_t i = 0; i < face.corner_count; i++) {
        const obj_corner &corner = document.corners[face.corner_first + i];
        points[i] = document.positions[(size_t)corner.position].value;
        ids[i] = vertex_of(document, batch, face, corner, normal);
    }
    batch.flat_faces++;
    obj_triangulate(points, triangles);
    for (size_t i = 0; i < triangles.size(); i += 3) {
        uint32_t a = ids[triangles[i]], b = ids[triangles[i + 1]], c = ids[triangles[i + 2]];
        if (a != b && b != c && c != a) {
            batch.indices.insert(batch.indices.end(), {a, b, c});
        }
    }
}

// Copies the batch to plain arrays, completes normals and tangents, and appends it to the mesh.
static void add_primitive(obj_document &document, obj_batch &batch, uint32_t material)
{
    scene *target = document.import->scene;
    struct triangle_mesh mesh = {};
    mesh.vertex_count = (uint32_t)batch.vertices.size();
    mesh.index_count = (uint32_t)batch.indices.size();
    mesh.vertices = (scene_vertex *)malloc(mesh.vertex_count * sizeof(scene_vertex));
    mesh.indices = (uint32_t *)malloc(mesh.index_count * sizeof(uint32_t));
    bool done = mesh.vertices && mesh.indices;
    if (done) {
        memcpy(mesh.vertices, batch.vertices.data(), mesh.vertex_count * sizeof(scene_vertex));
        memcpy(mesh.indices, batch.indices.data(), mesh.index_count * sizeof(uint32_t));
        batch = obj_batch();
        triangle_mesh_repair_normals(&mesh);
        if (target->materials[material].textures[SCENE_TEXTURE_NORMAL].image == SCENE_NONE) {
            triangle_mesh_set_any_tangents(&mesh);
        } else {
            done = triangle_mesh_make_tangents(&mesh, 0);
        }
    }
    done = done && scene_add_primitive(target, mesh.vertices, mesh.vertex_count, mesh.indices,
                                       mesh.index_count, material) != SCENE_NONE;
    triangle_mesh_finish(&mesh);
    if (!done) {
        import_fail("more than %u vertices or %u triangle corners, or out of memory",
                    SCENE_MAX_VERTICES, SCENE_MAX_INDICES);
    }
}

// One mesh with a primitive per material, whatever the groups: fewer draws.
static void add_geometry(obj_document &document)
{
    scene *target = document.import->scene;
    uint32_t mesh = SCENE_NONE;
    for (const auto &entry : document.faces) {
        obj_batch batch;
        for (const obj_face &face : entry.second) {
            if (is_usable(document, face)) {
                add_face(document, batch, face);
            } else {
                target->rejects.triangles++;
                import_warn_once(
                    *document.import,
                    "faces with positions that are not finite or beyond %g m are dropped",
                    (double)SCENE_MAX_COORDINATE_M);
            }
        }
        if (batch.indices.empty()) {
            continue;
        }
        if (mesh == SCENE_NONE) {
            mesh = scene_add_mesh(target, target->name);
            uint32_t node = scene_add_node(target, target->name, SCENE_NONE);
            if (mesh == SCENE_NONE || node == SCENE_NONE) {
                throw std::bad_alloc();
            }
            target->nodes[node].mesh = mesh;
        }
        add_primitive(document, batch, entry.first);
    }
    if (mesh == SCENE_NONE) {
        import_fail("the file has no faces that can be drawn");
    }
}

static void import_document(obj_import &import, const uint8_t *bytes, size_t size)
{
    std::vector<std::string> libraries;
    std::istringstream text(obj_normalize_text((const char *)bytes, size, libraries));
    obj_import_materials(import, libraries);
    obj_document document;
    document.import = &import;
    tinyobj::callback_t callbacks;
    callbacks.vertex_cb = on_position;
    callbacks.normal_cb = on_normal;
    callbacks.texcoord_cb = on_uv;
    callbacks.index_cb = on_face;
    callbacks.usemtl_cb = on_material;
    callbacks.group_cb = on_group;
    std::string message;
    if (!tinyobj::LoadObjWithCallback(text, callbacks, &document, nullptr, nullptr, &message)) {
        import_fail("%s", import_short_name(message, 300).c_str());
    }
    text.str("");
    check_corners(document);
    collect_smooth_normals(document);
    add_geometry(document);
    scene_update_world_transforms(import.scene);
}

struct scene *scene_import_obj_memory(const void *bytes, size_t size, const char *base_folder,
                                      struct error *out_error)
{
    obj_import import;
    import_work work = [&import](const uint8_t *data, size_t count) {
        import_document(import, data, count);
    };
    return import_from_memory(import, "OBJ", bytes, size, base_folder, work, out_error);
}

struct scene *scene_import_obj(const char *path, struct error *out_error)
{
    obj_import import;
    import_work work = [&import](const uint8_t *data, size_t count) {
        import_document(import, data, count);
    };
    return import_from_file(import, "OBJ", path, work, out_error);
}
