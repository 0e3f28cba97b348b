#include "renderer/scene/triangle_mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/hash.h"
#include "renderer/scene/vector3.h"

#define NO_VERTEX UINT32_MAX

enum winding { WINDING_NONE, WINDING_POSITIVE, WINDING_NEGATIVE };

// A triangle's edge between two welded vertices, stored under the corner where it starts.
struct edge {
    uint64_t key; // smaller welded vertex << 32 | larger one
    uint32_t corner;
};

struct tangent_work {
    struct triangle_mesh *mesh;
    uint32_t uv_set;
    uint32_t *welded;    // per vertex: the first vertex equal to it
    uint8_t *windings;   // per triangle
    float (*along_u)[3]; // per triangle: unit direction of +U
    uint32_t *group;     // per corner: parent in the union-find forest; finally the root
    struct edge *edges;  // three per triangle
    struct edge *edges_scratch;
    double (*sums)[3];     // per corner, used at roots
    uint32_t *vertex_root; // per vertex: its group, NO_VERTEX at first
    uint32_t *next_copy;   // per vertex and copy: the next copy of the same vertex
};

static void finish_work(struct tangent_work *work)
{
    free(work->welded);
    free(work->windings);
    free(work->along_u);
    free(work->group);
    free(work->edges);
    free(work->edges_scratch);
    free(work->sums);
    free(work->vertex_root);
    free(work->next_copy);
}

static bool start_work(struct tangent_work *work)
{
    size_t vertices = work->mesh->vertex_count;
    size_t corners = work->mesh->index_count;
    size_t triangles = corners / 3;

    work->welded = malloc(vertices * sizeof(*work->welded));
    work->windings = malloc(triangles * sizeof(*work->windings));
    work->along_u = malloc(triangles * sizeof(*work->along_u));
    work->group = malloc(corners * sizeof(*work->group));
    work->edges = malloc(corners * sizeof(*work->edges));
    work->edges_scratch = malloc(corners * sizeof(*work->edges));
    work->sums = calloc(corners, sizeof(*work->sums));
    work->vertex_root = malloc((vertices + corners) * sizeof(*work->vertex_root));
    work->next_copy = malloc((vertices + corners) * sizeof(*work->next_copy));
    return work->welded && work->windings && work->along_u && work->group && work->edges &&
           work->edges_scratch && work->sums && work->vertex_root && work->next_copy;
}

// Position, normal and UV: vertices that agree in all of them are welded.
static void weld_words(const struct tangent_work *work, uint32_t vertex, uint32_t out[8])
{
    const struct scene_vertex *source = &work->mesh->vertices[vertex];
    float values[8];
    memcpy(values, source->position, sizeof(source->position));
    memcpy(values + 3, source->normal, sizeof(source->normal));
    memcpy(values + 6, source->uv[work->uv_set], sizeof(source->uv[0]));
    for (int i = 0; i < 8; i++) {
        values[i] += 0.0f; // -0 becomes +0
    }
    memcpy(out, values, sizeof(values));
}

static uint64_t hash_words(const uint32_t words[8])
{
    uint64_t hash = HASH_START;
    for (int i = 0; i < 8; i++) {
        hash = hash_word(hash, words[i]);
    }
    return hash ^ hash >> 29;
}

static bool weld_vertices(struct tangent_work *work)
{
    uint32_t count = work->mesh->vertex_count;
    size_t slots = 16;
    while (slots < (size_t)count * 2) {
        slots *= 2;
    }
    uint32_t *table = malloc(slots * sizeof(*table));
    if (!table) {
        return false;
    }
    memset(table, 0xff, slots * sizeof(*table));
    for (uint32_t vertex = 0; vertex < count; vertex++) {
        uint32_t words[8], other[8];
        weld_words(work, vertex, words);
        size_t slot = hash_words(words) & (slots - 1);
        for (; table[slot] != NO_VERTEX; slot = (slot + 1) & (slots - 1)) {
            weld_words(work, table[slot], other);
            if (memcmp(words, other, sizeof(words)) == 0) {
                break;
            }
        }
        if (table[slot] == NO_VERTEX) {
            table[slot] = vertex;
        }
        work->welded[vertex] = table[slot];
    }
    free(table);
    return true;
}

static void measure_triangle(struct tangent_work *work, uint32_t triangle)
{
    const uint32_t *indices = work->mesh->indices + (size_t)triangle * 3;
    double edges[2][3], uv_edges[2][2];
    const struct scene_vertex *origin = &work->mesh->vertices[indices[0]];
    for (int edge = 0; edge < 2; edge++) {
        const struct scene_vertex *end = &work->mesh->vertices[indices[edge + 1]];
        for (int axis = 0; axis < 3; axis++) {
            edges[edge][axis] = (double)end->position[axis] - origin->position[axis];
        }
        for (int axis = 0; axis < 2; axis++) {
            uv_edges[edge][axis] =
                (double)end->uv[work->uv_set][axis] - origin->uv[work->uv_set][axis];
        }
    }
    double area = uv_edges[0][0] * uv_edges[1][1] - uv_edges[0][1] * uv_edges[1][0];
    double along_u[3];
    for (int axis = 0; axis < 3; axis++) {
        along_u[axis] = edges[0][axis] * uv_edges[1][1] - edges[1][axis] * uv_edges[0][1];
    }
    double length = vector3_length(along_u);
    work->windings[triangle] = WINDING_NONE;
    if (area != 0 && length > 0 && isfinite(length) && isfinite(area)) {
        // V grows down the image and green points up it, so positive areas are the mirrored ones.
        work->windings[triangle] = area < 0 ? WINDING_POSITIVE : WINDING_NEGATIVE;
        double scale = (area < 0 ? -1 : 1) / length;
        for (int axis = 0; axis < 3; axis++) {
            work->along_u[triangle][axis] = (float)(along_u[axis] * scale);
        }
    }
}

static uint32_t find_root(uint32_t *group, uint32_t corner)
{
    while (group[corner] != corner) {
        group[corner] = group[group[corner]];
        corner = group[corner];
    }
    return corner;
}

static void join(uint32_t *group, uint32_t a, uint32_t b)
{
    uint32_t root_a = find_root(group, a);
    uint32_t root_b = find_root(group, b);
    // The smaller root wins, so that the result does not depend on the order of edges.
    group[root_a > root_b ? root_a : root_b] = root_a > root_b ? root_b : root_a;
}

// Least-significant-digit radix sort by key, 11 bits per pass; skips passes in which all keys
// agree.
static void sort_edges(struct tangent_work *work, uint32_t count)
{
    for (int shift = 0; shift < 64; shift += 11) {
        uint32_t starts[2048] = {0};
        for (uint32_t i = 0; i < count; i++) {
            starts[work->edges[i].key >> shift & 2047]++;
        }
        if (count == 0 || starts[work->edges[0].key >> shift & 2047] == count) {
            continue;
        }
        uint32_t sum = 0;
        for (int digit = 0; digit < 2048; digit++) {
            uint32_t digit_count = starts[digit];
            starts[digit] = sum;
            sum += digit_count;
        }
        for (uint32_t i = 0; i < count; i++) {
            work->edges_scratch[starts[work->edges[i].key >> shift & 2047]++] = work->edges[i];
        }
        struct edge *swap = work->edges;
        work->edges = work->edges_scratch;
        work->edges_scratch = swap;
    }
}

static uint32_t corner_after(uint32_t corner)
{
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

static uint32_t welded_at(const struct tangent_work *work, uint32_t corner)
{
    return work->welded[work->mesh->indices[corner]];
}

// Joins the corners at both ends of every edge shared by two triangles of equal winding.
static void group_corners(struct tangent_work *work)
{
    uint32_t edge_count = 0;
    for (uint32_t corner = 0; corner < work->mesh->index_count; corner++) {
        work->group[corner] = corner;
        if (work->windings[corner / 3] != WINDING_NONE) {
            uint64_t a = welded_at(work, corner);
            uint64_t b = welded_at(work, corner_after(corner));
            work->edges[edge_count++] = (struct edge){a < b ? a << 32 | b : b << 32 | a, corner};
        }
    }
    sort_edges(work, edge_count);
    for (uint32_t first = 0, last; first < edge_count; first = last) {
        uint32_t newest[3] = {NO_VERTEX, NO_VERTEX, NO_VERTEX}; // newest corner by winding
        for (last = first; last < edge_count && work->edges[last].key == work->edges[first].key;
             last++) {
            uint32_t corner = work->edges[last].corner;
            uint32_t winding = work->windings[corner / 3];
            uint32_t other = newest[winding];
            newest[winding] = corner;
            if (other == NO_VERTEX) {
                continue;
            }
            bool same_start = welded_at(work, corner) == welded_at(work, other);
            join(work->group, corner, same_start ? other : corner_after(other));
            join(work->group, corner_after(corner), same_start ? corner_after(other) : other);
        }
    }
}

// Projects `vector` into the plane of `normal` and normalises it; false if nothing is left.
static bool project_unit(double out[3], const double vector[3], const float normal[3])
{
    double along = vector[0] * normal[0] + vector[1] * normal[1] + vector[2] * normal[2];
    for (int axis = 0; axis < 3; axis++) {
        out[axis] = vector[axis] - along * normal[axis];
    }
    double length = vector3_length(out);
    if (!(length > 1e-12)) {
        return false;
    }
    for (int axis = 0; axis < 3; axis++) {
        out[axis] /= length;
    }
    return true;
}

static void add_corner(struct tangent_work *work, uint32_t corner)
{
    uint32_t after = corner_after(corner);
    uint32_t before = corner_after(after);
    const struct scene_vertex *vertices = work->mesh->vertices;
    const uint32_t *indices = work->mesh->indices;
    const struct scene_vertex *vertex = &vertices[indices[corner]];
    const float *along_u = work->along_u[corner / 3];
    double edge_after[3], edge_before[3], tangent[3], unit_after[3], unit_before[3];
    for (int axis = 0; axis < 3; axis++) {
        double position = vertex->position[axis];
        edge_after[axis] = vertices[indices[after]].position[axis] - position;
        edge_before[axis] = vertices[indices[before]].position[axis] - position;
    }
    double direction[3] = {along_u[0], along_u[1], along_u[2]};
    if (!project_unit(tangent, direction, vertex->normal) ||
        !project_unit(unit_after, edge_after, vertex->normal) ||
        !project_unit(unit_before, edge_before, vertex->normal)) {
        return;
    }
    double angle = acos(fmax(-1, fmin(1, vector3_dot(unit_after, unit_before))));
    double *sum = work->sums[find_root(work->group, corner)];
    for (int axis = 0; axis < 3; axis++) {
        sum[axis] += angle * tangent[axis];
    }
}

// The copy of `vertex` for the group `root`, created on first use; copies go to the end of the
// vertices, where there is space.
static uint32_t vertex_for_group(struct tangent_work *work, uint32_t vertex, uint32_t root)
{
    if (work->vertex_root[vertex] == NO_VERTEX) {
        work->vertex_root[vertex] = root;
        return vertex;
    }
    uint32_t last = vertex;
    for (uint32_t copy = vertex; copy != NO_VERTEX; copy = work->next_copy[copy]) {
        if (work->vertex_root[copy] == root) {
            return copy;
        }
        last = copy;
    }
    uint32_t added = work->mesh->vertex_count++;
    work->mesh->vertices[added] = work->mesh->vertices[vertex];
    work->vertex_root[added] = root;
    work->next_copy[added] = NO_VERTEX;
    work->next_copy[last] = added;
    return added;
}

static void write_tangents(struct tangent_work *work)
{
    struct triangle_mesh *mesh = work->mesh;
    memset(work->vertex_root, 0xff, mesh->vertex_count * sizeof(uint32_t));
    memset(work->next_copy, 0xff, mesh->vertex_count * sizeof(uint32_t));
    for (uint32_t corner = 0; corner < mesh->index_count; corner++) {
        enum winding winding = work->windings[corner / 3];
        if (winding == WINDING_NONE) {
            continue; // gets its vertex's tangent, since UV is constant on it
        }
        uint32_t root = find_root(work->group, corner);
        uint32_t index = vertex_for_group(work, mesh->indices[corner], root);
        struct scene_vertex *at = &mesh->vertices[index];
        mesh->indices[corner] = index;
        for (int axis = 0; axis < 3; axis++) {
            at->tangent[axis] = (float)work->sums[root][axis];
        }
        at->tangent[3] = winding == WINDING_POSITIVE ? 1.0f : -1.0f;
    }
}

bool triangle_mesh_make_tangents(struct triangle_mesh *mesh, uint32_t uv_set)
{
    struct tangent_work work = {.mesh = mesh, .uv_set = uv_set};
    bool done = false;
    size_t max_vertices = (size_t)mesh->vertex_count + mesh->index_count;
    if (mesh->index_count == 0) {
        return true;
    }
    if (max_vertices >= NO_VERTEX || !start_work(&work) || !weld_vertices(&work)) {
        goto finish;
    }
    struct scene_vertex *vertices = realloc(mesh->vertices, max_vertices * sizeof(*vertices));
    if (!vertices) {
        goto finish;
    }
    mesh->vertices = vertices;
    for (uint32_t triangle = 0; triangle < mesh->index_count / 3; triangle++) {
        measure_triangle(&work, triangle);
    }
    group_corners(&work);
    for (uint32_t corner = 0; corner < mesh->index_count; corner++) {
        if (work.windings[corner / 3] != WINDING_NONE) {
            add_corner(&work, corner);
        }
    }
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        memset(vertices[i].tangent, 0, sizeof(vertices[i].tangent));
    }
    write_tangents(&work);
    triangle_mesh_repair_tangents(mesh); // unit length, and a valid value where a sum vanished
    done = true;

finish:
    finish_work(&work);
    return done;
}
