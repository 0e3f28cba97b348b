#include "renderer/scene/ray_scene.h"

#include <assert.h>
#include <embree3/rtcore.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/scene/pinned_images.h"
#include "renderer/scene/texture_sample.h"
#include "renderer/scene/vector3.h"

// Embree's own limit is about 1.8e18; instances that reach beyond this one are left out.
#define RAY_SCENE_MAX_EXTENT 1e17

// Data of one primitive's intersection filter.
struct filter_data {
    const struct scene *scene;
    uint32_t primitive;
    bool is_masked;
    bool lets_light_pass;
};

// Data of an occlusion query for the filters.
struct light_context {
    struct RTCIntersectContext embree; // first, since Embree passes a pointer to it
    const struct ray_scene *ray_scene;
    ray_scene_stops_light *stops_light;
    void *context;
};

struct ray_scene {
    const struct scene *scene;
    RTCDevice device;
    RTCScene top;
    RTCScene *meshes; // by mesh; NULL if no node uses it
    uint32_t mesh_count;
    struct filter_data *filters;   // by primitive
    bool *lets_light_pass;         // by material
    uint32_t *instance_nodes;      // node by instance; an instance is a geometry id of `top`
    uint32_t *instance_primitives; // first primitive of the instance's mesh
    float *instance_extents;       // largest coordinate of the instance's mesh
    uint32_t instance_count;
    uint32_t packet_width; // rays per vector register
    struct pinned_images masks;
};

static float alpha_at(const struct scene *scene, uint32_t primitive, uint32_t triangle, float u,
                      float v)
{
    const struct scene_primitive *source = &scene->primitives[primitive];
    const struct scene_material *material = &scene->materials[source->material];
    const struct scene_texture *base_color = &material->textures[SCENE_TEXTURE_BASE_COLOR];
    const uint32_t *indices = scene->indices + source->index_first + (size_t)triangle * 3;
    const float weights[3] = {1.0f - u - v, u, v};
    float uv[2] = {0};
    float alpha = 0;
    for (int corner = 0; corner < 3; corner++) {
        const struct scene_vertex *vertex = &scene->vertices[indices[corner]];
        uv[0] += weights[corner] * vertex->uv[base_color->uv_set][0];
        uv[1] += weights[corner] * vertex->uv[base_color->uv_set][1];
        alpha += weights[corner] * vertex->color[3];
    }
    float texel[4];
    texture_sample(scene, base_color, uv, texel);
    return alpha * texel[3] * material->base_color[3];
}

static bool is_hole(const struct filter_data *data, const struct RTCHit *hit)
{
    const struct scene *scene = data->scene;
    const struct scene_material *material =
        &scene->materials[scene->primitives[data->primitive].material];
    return alpha_at(scene, data->primitive, hit->primID, hit->u, hit->v) < material->alpha_cutoff;
}

// Fields of a hit, laid out like those of rays (rtcore_ray.h, whose functions are C++ only).
enum hit_field { HIT_U = 3, HIT_V, HIT_TRIANGLE, HIT_GEOMETRY, HIT_INSTANCE };
static_assert(sizeof(struct RTCRay16) == (size_t)RAY_HIT * 16 * sizeof(float), "");
static_assert(sizeof(struct RTCRayHit16) == (size_t)RAY_BATCH_FIELDS * 16 * sizeof(float), "");

static float get_float(const void *fields, uint32_t count, uint32_t field, uint32_t number)
{
    return ((const float *)fields)[field * count + number];
}

static uint32_t get_uint(const void *fields, uint32_t count, uint32_t field, uint32_t number)
{
    return ((const uint32_t *)fields)[field * count + number];
}

static struct RTCHit get_hit(const void *hits, uint32_t count, uint32_t number)
{
    return (struct RTCHit){
        .u = get_float(hits, count, HIT_U, number),
        .v = get_float(hits, count, HIT_V, number),
        .primID = get_uint(hits, count, HIT_TRIANGLE, number),
        .geomID = get_uint(hits, count, HIT_GEOMETRY, number),
        .instID = {get_uint(hits, count, HIT_INSTANCE, number)},
    };
}

// Rejects hits in the holes of alpha-masked materials.
static void filter_hit(const struct RTCFilterFunctionNArguments *arguments)
{
    for (uint32_t i = 0; i < arguments->N; i++) {
        if (!arguments->valid[i])
            continue;
        struct RTCHit hit = get_hit(arguments->hit, arguments->N, i);
        if (is_hole(arguments->geometryUserPtr, &hit))
            arguments->valid[i] = 0;
    }
}

static struct ray_crossing crossing_of(const struct ray_scene *ray_scene, const struct RTCHit *hit,
                                       float distance)
{
    return (struct ray_crossing){
        .node = ray_scene->instance_nodes[hit->instID[0]],
        .primitive = ray_scene->instance_primitives[hit->instID[0]] + hit->geomID,
        .triangle = hit->primID,
        .barycentric = {hit->u, hit->v},
        .distance = distance,
    };
}

static bool stops_ray(const struct RTCFilterFunctionNArguments *arguments, uint32_t number)
{
    const struct filter_data *data = arguments->geometryUserPtr;
    struct RTCHit hit = get_hit(arguments->hit, arguments->N, number);
    if (data->is_masked && is_hole(data, &hit))
        return false;
    const struct light_context *light = (const struct light_context *)arguments->context;
    if (!data->lets_light_pass)
        return true;
    struct ray_crossing crossing = crossing_of(
        light->ray_scene, &hit, get_float(arguments->ray, arguments->N, RAY_DISTANCE, number));
    return light->stops_light &&
           light->stops_light(light->context,
                              get_uint(arguments->ray, arguments->N, RAY_ID, number), &crossing);
}

// Also rejects hits on what light passes through.
static void filter_occlusion(const struct RTCFilterFunctionNArguments *arguments)
{
    for (uint32_t i = 0; i < arguments->N; i++) {
        if (arguments->valid[i] && !stops_ray(arguments, i))
            arguments->valid[i] = 0;
    }
}

// Filters cost time: only geometry that needs one gets it.
static void set_filters(RTCGeometry geometry, const struct filter_data *data)
{
    bool any = data->is_masked || data->lets_light_pass;
    rtcSetGeometryIntersectFilterFunction(geometry, data->is_masked ? filter_hit : NULL);
    rtcSetGeometryOccludedFilterFunction(geometry, any ? filter_occlusion : NULL);
}

static bool is_masked(const struct scene *scene, uint32_t primitive)
{
    const struct scene_material *material =
        &scene->materials[scene->primitives[primitive].material];
    return material->alpha_mode == SCENE_ALPHA_MASK;
}

static void attach_primitive(struct ray_scene *ray_scene, RTCScene mesh, uint32_t primitive,
                             uint32_t id)
{
    const struct scene *scene = ray_scene->scene;
    const struct scene_primitive *source = &scene->primitives[primitive];
    RTCGeometry geometry = rtcNewGeometry(ray_scene->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               scene->vertices, 0, sizeof(*scene->vertices), scene->vertex_count);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, scene->indices,
                               source->index_first * sizeof(uint32_t), 3 * sizeof(uint32_t),
                               source->index_count / 3);
    ray_scene->filters[primitive] =
        (struct filter_data){scene, primitive, is_masked(scene, primitive),
                             ray_scene->lets_light_pass[source->material]};
    rtcSetGeometryUserData(geometry, &ray_scene->filters[primitive]);
    set_filters(geometry, &ray_scene->filters[primitive]);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(mesh, geometry, id);
    rtcReleaseGeometry(geometry);
}

static RTCScene build_mesh(struct ray_scene *ray_scene, uint32_t mesh)
{
    const struct scene_mesh *source = &ray_scene->scene->meshes[mesh];
    RTCScene built = rtcNewScene(ray_scene->device);
    rtcSetSceneFlags(built, RTC_SCENE_FLAG_ROBUST);
    for (uint32_t i = 0; i < source->primitive_count; i++)
        attach_primitive(ray_scene, built, source->primitive_first + i, i);
    rtcCommitScene(built);
    return built;
}

static float mesh_extent(const struct scene *scene, uint32_t mesh)
{
    const struct scene_mesh *source = &scene->meshes[mesh];
    float extent = 0;
    for (uint32_t i = 0; i < source->primitive_count; i++) {
        const struct scene_primitive *primitive = &scene->primitives[source->primitive_first + i];
        for (int axis = 0; axis < 3; axis++) {
            extent = fmaxf(extent, fmaxf(fabsf(primitive->bounds_min[axis]),
                                         fabsf(primitive->bounds_max[axis])));
        }
    }
    return extent;
}

static void add_instances(struct ray_scene *ray_scene)
{
    const struct scene *scene = ray_scene->scene;
    for (uint32_t node = 0; node < scene->node_count; node++) {
        uint32_t mesh = scene->nodes[node].mesh;
        if (mesh == SCENE_NONE)
            continue;
        if (!ray_scene->meshes[mesh]) {
            ray_scene->meshes[mesh] = build_mesh(ray_scene, mesh);
        }
        uint32_t id = ray_scene->instance_count++;
        RTCGeometry instance = rtcNewGeometry(ray_scene->device, RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(instance, ray_scene->meshes[mesh]);
        rtcAttachGeometryByID(ray_scene->top, instance, id);
        rtcReleaseGeometry(instance);
        ray_scene->instance_nodes[id] = node;
        ray_scene->instance_primitives[id] = scene->meshes[mesh].primitive_first;
        ray_scene->instance_extents[id] = mesh_extent(scene, mesh);
    }
}

static uint32_t native_width(RTCDevice device)
{
    if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED))
        return 16;
    return rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) ? 8 : 4;
}

struct ray_scene *ray_scene_create(const struct scene *scene)
{
    return ray_scene_create_for_light(&(struct ray_scene_params){.scene = scene});
}

struct ray_scene *ray_scene_create_for_light(const struct ray_scene_params *params)
{
    const struct scene *scene = params->scene;
    struct ray_scene *ray_scene = calloc(1, sizeof(*ray_scene));
    if (!ray_scene)
        return NULL;
    ray_scene->scene = scene;
    ray_scene->mesh_count = scene->mesh_count;
    ray_scene->device = rtcNewDevice(params->calling_thread_only ? "threads=1" : NULL);
    ray_scene->meshes = calloc(scene->mesh_count + 1, sizeof(*ray_scene->meshes));
    ray_scene->filters = calloc(scene->primitive_count + 1, sizeof(*ray_scene->filters));
    ray_scene->lets_light_pass = calloc(scene->material_count + 1, sizeof(bool));
    ray_scene->instance_nodes = calloc(scene->node_count + 1, sizeof(uint32_t));
    ray_scene->instance_primitives = calloc(scene->node_count + 1, sizeof(uint32_t));
    ray_scene->instance_extents = calloc(scene->node_count + 1, sizeof(float));
    if (!ray_scene->device || !ray_scene->meshes || !ray_scene->filters ||
        !ray_scene->instance_nodes || !ray_scene->instance_primitives ||
        !ray_scene->instance_extents || !ray_scene->lets_light_pass ||
        !pinned_images_take(&ray_scene->masks, scene, true)) {
        ray_scene_destroy(&ray_scene);
        return NULL;
    }
    if (params->lets_light_pass) {
        memcpy(ray_scene->lets_light_pass, params->lets_light_pass,
               scene->material_count * sizeof(bool));
    }
    ray_scene->packet_width = native_width(ray_scene->device);
    ray_scene->top = rtcNewScene(ray_scene->device);
    rtcSetSceneFlags(ray_scene->top, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC);
    add_instances(ray_scene);
    ray_scene_update_transforms(ray_scene);
    if (rtcGetDeviceError(ray_scene->device) != RTC_ERROR_NONE)
        ray_scene_destroy(&ray_scene);
    return ray_scene;
}

void ray_scene_destroy(struct ray_scene **ray_scene_slot)
{
    struct ray_scene *ray_scene = *ray_scene_slot;
    *ray_scene_slot = NULL;
    if (!ray_scene)
        return;
    if (ray_scene->top) {
        rtcReleaseScene(ray_scene->top);
    }
    for (uint32_t i = 0; ray_scene->meshes && i < ray_scene->mesh_count; i++) {
        if (ray_scene->meshes[i])
            rtcReleaseScene(ray_scene->meshes[i]);
    }
    if (ray_scene->device)
        rtcReleaseDevice(ray_scene->device);
    pinned_images_release(&ray_scene->masks);
    free(ray_scene->meshes);
    free(ray_scene->filters);
    free(ray_scene->lets_light_pass);
    free(ray_scene->instance_nodes);
    free(ray_scene->instance_primitives);
    free(ray_scene->instance_extents);
    free(ray_scene);
}

// Rows of the adjugate of the upper 3 x 3 part: the inverse times the determinant, which is
// returned.
static double adjugate(const float matrix[16], double out_rows[3][3])
{
    double columns[3][3];
    for (int axis = 0; axis < 3; axis++) {
        for (int i = 0; i < 3; i++)
            columns[axis][i] = matrix[axis * 4 + i];
    }
    for (int axis = 0; axis < 3; axis++)
        vector3_cross(out_rows[axis], columns[(axis + 1) % 3], columns[(axis + 2) % 3]);
    return vector3_dot(out_rows[0], columns[0]);
}

// Embree inverts the matrix: rejects matrices that are singular or exceed its range.
static bool is_usable_matrix(const float matrix[16], float extent)
{
    double rows[3][3];
    double largest = 0;
    for (int i = 0; i < 16; i++) {
        if (!isfinite(matrix[i]))
            return false;
        largest = fmax(largest, fabs((double)matrix[i]) * (i < 12 ? extent : 1.0));
    }
    return largest < RAY_SCENE_MAX_EXTENT && fabs(adjugate(matrix, rows)) > 1e-30;
}

void ray_scene_update_transforms(struct ray_scene *ray_scene)
{
    for (uint32_t i = 0; i < ray_scene->instance_count; i++) {
        const struct scene_node *node = &ray_scene->scene->nodes[ray_scene->instance_nodes[i]];
        RTCGeometry instance = rtcGetGeometry(ray_scene->top, i);
        if (node->world_visible && !node->removed &&
            is_usable_matrix(node->world_from_local, ray_scene->instance_extents[i])) {
            rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR,
                                    node->world_from_local);
            rtcEnableGeometry(instance);
        } else {
            rtcDisableGeometry(instance);
        }
        rtcCommitGeometry(instance);
    }
    rtcCommitScene(ray_scene->top);
}

void ray_scene_update_materials(struct ray_scene *ray_scene)
{
    const struct scene *scene = ray_scene->scene;
    bool any_rebuilt = false;
    pinned_images_take(&ray_scene->masks, scene, true);
    for (uint32_t mesh = 0; mesh < ray_scene->mesh_count; mesh++) {
        const struct scene_mesh *source = &scene->meshes[mesh];
        bool rebuild = false;
        for (uint32_t i = 0; ray_scene->meshes[mesh] && i < source->primitive_count; i++) {
            uint32_t primitive = source->primitive_first + i;
            if (ray_scene->filters[primitive].is_masked == is_masked(scene, primitive))
                continue;
            RTCGeometry geometry = rtcGetGeometry(ray_scene->meshes[mesh], i);
            ray_scene->filters[primitive].is_masked = is_masked(scene, primitive);
            set_filters(geometry, &ray_scene->filters[primitive]);
            rtcCommitGeometry(geometry);
            rebuild = true;
        }
        if (rebuild)
            rtcCommitScene(ray_scene->meshes[mesh]);
        any_rebuilt = any_rebuilt || rebuild;
    }
    if (any_rebuilt)
        ray_scene_update_transforms(ray_scene);
}

// Geometric normal in world space, unit length, on the ray's side.
static void fill_normal(const struct scene_node *node, const struct RTCHit *hit,
                        const float direction[3], float out_normal[3])
{
    double rows[3][3];
    double normal[3] = {0};
    // Normals transform by the inverse transpose; the determinant's sign is handled below.
    adjugate(node->world_from_local, rows);
    const double local[3] = {hit->Ng_x, hit->Ng_y, hit->Ng_z};
    for (int axis = 0; axis < 3; axis++) {
        for (int i = 0; i < 3; i++)
            normal[i] += rows[axis][i] * local[axis];
    }
    double length = vector3_length(normal);
    double facing = normal[0] * direction[0] + normal[1] * direction[1] + normal[2] * direction[2];
    for (int axis = 0; axis < 3; axis++)
        out_normal[axis] = length > 0 ? (float)(normal[axis] / (facing > 0 ? -length : length)) : 0;
}

// In place, field by field: loading a copy that was just written in parts would stall.
static void fill_ray(struct RTCRay *target, const struct ray *ray)
{
    target->org_x = ray->origin[0];
    target->org_y = ray->origin[1];
    target->org_z = ray->origin[2];
    target->tnear = 0.0f;
    target->dir_x = ray->direction[0];
    target->dir_y = ray->direction[1];
    target->dir_z = ray->direction[2];
    target->time = 0.0f;
    target->tfar = ray->max_distance;
    target->mask = UINT32_MAX;
    target->id = 0;
    target->flags = 0;
}

static bool closest_hit(const struct ray_scene *ray_scene, const struct ray *ray,
                        struct RTCRayHit *out_query)
{
    fill_ray(&out_query->ray, ray);
    out_query->hit.geomID = RTC_INVALID_GEOMETRY_ID;
    out_query->hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(ray_scene->top, &context, out_query);
    return out_query->hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

void ray_batch_init(struct ray_batch *batch, const struct ray_scene *ray_scene, bool coherent)
{
    batch->width = coherent ? ray_scene->packet_width : 1;
    batch->count = 0;
}

static void find_packet(RTCScene scene, const int *valid, uint32_t width,
                        struct RTCIntersectContext *context, void *packet)
{
    switch (width) {
    case 16:
        rtcIntersect16(valid, scene, context, packet);
        break;
    case 8:
        rtcIntersect8(valid, scene, context, packet);
        break;
    case 4:
        rtcIntersect4(valid, scene, context, packet);
        break;
    default:
        rtcIntersect1(scene, context, packet);
    }
}

static void occlude_packet(RTCScene scene, const int *valid, uint32_t width,
                           struct RTCIntersectContext *context, void *packet)
{
    switch (width) {
    case 16:
        rtcOccluded16(valid, scene, context, packet);
        break;
    case 8:
        rtcOccluded8(valid, scene, context, packet);
        break;
    case 4:
        rtcOccluded4(valid, scene, context, packet);
        break;
    default:
        rtcOccluded1(scene, context, packet);
    }
}

// Sets the fields that all rays of a packet share.
static inline void fill_packet(float *packet, uint32_t width, uint32_t first)
{
    uint32_t *words = (uint32_t *)packet;
    for (uint32_t i = 0; i < width; i++) {
        packet[RAY_NEAR * width + i] = 0.0f;
        packet[RAY_TIME * width + i] = 0.0f;
        words[RAY_MASK * width + i] = UINT32_MAX;
        words[RAY_ID * width + i] = first + i;
        words[RAY_FLAGS * width + i] = 0;
        words[(RAY_HIT + HIT_GEOMETRY) * width + i] = RTC_INVALID_GEOMETRY_ID;
        words[(RAY_HIT + HIT_INSTANCE) * width + i] = RTC_INVALID_GEOMETRY_ID;
    }
}

typedef void packet_function(RTCScene scene, const int *valid, uint32_t width,
                             struct RTCIntersectContext *context, void *packet);

static inline void cast_all(const struct ray_scene *ray_scene, struct ray_batch *batch,
                            struct RTCIntersectContext *context, packet_function *cast)
{
    uint32_t width = batch->width;
    for (uint32_t i = 0; width == 1 && i < batch->count; i++) {
        float *ray = ray_batch_fields(batch, i);
        fill_packet(ray, 1, i);
        cast(ray_scene->top, NULL, 1, context, ray);
    }
    for (uint32_t first = 0; width > 1 && first < batch->count; first += width) {
        _Alignas(64) int valid[16];
        for (uint32_t i = 0; i < width; i++)
            valid[i] = first + i < batch->count ? -1 : 0;
        float *packet = ray_batch_fields(batch, first);
        fill_packet(packet, width, first);
        cast(ray_scene->top, valid, width, context, packet);
    }
}

void ray_scene_find_all(const struct ray_scene *ray_scene, struct ray_batch *batch)
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    cast_all(ray_scene, batch, &context, find_packet);
}

void ray_scene_occlude_all(const struct ray_scene *ray_scene, struct ray_batch *batch,
                           ray_scene_stops_light *stops_light, void *context)
{
    struct light_context light = {
        .ray_scene = ray_scene, .stops_light = stops_light, .context = context};
    rtcInitIntersectContext(&light.embree);
    cast_all(ray_scene, batch, &light.embree, occlude_packet);
}

bool ray_scene_get_crossing(const struct ray_scene *ray_scene, const struct ray_batch *batch,
                            uint32_t ray, struct ray_crossing *out_crossing)
{
    uint32_t width = batch->width;
    const float *fields = ray_batch_fields(batch, ray);
    struct RTCHit hit = get_hit(fields + (size_t)RAY_HIT * width, width, 0);
    if (hit.geomID == RTC_INVALID_GEOMETRY_ID)
        return false;
    *out_crossing = crossing_of(ray_scene, &hit, fields[RAY_DISTANCE * width]);
    return true;
}

uint64_t ray_scene_cast_all(const struct ray_scene *ray_scene, const struct ray_load *rays,
                            uint64_t count)
{
    uint64_t hits = 0;
    struct light_context light = {.ray_scene = ray_scene};
    rtcInitIntersectContext(&light.embree);
    for (uint64_t i = 0; i < count; i++) {
        struct RTCRayHit query;
        fill_ray(&query.ray, &rays[i].ray);
        if (rays[i].is_shadow) {
            rtcOccluded1(ray_scene->top, &light.embree, &query.ray);
            hits += query.ray.tfar < 0.0f;
            continue;
        }
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(ray_scene->top, &light.embree, &query);
        hits += query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
    return hits;
}

bool ray_scene_intersect(const struct ray_scene *ray_scene, const float origin[3],
                         const float direction[3], float max_distance, struct ray_hit *out_hit)
{
    bool finite = isfinite(max_distance) && max_distance > 0;
    for (int axis = 0; axis < 3; axis++)
        finite = finite && isfinite(origin[axis]) && isfinite(direction[axis]);
    if (!finite || (direction[0] == 0 && direction[1] == 0 && direction[2] == 0)) {
        return false;
    }
    const struct ray ray = {.origin = {origin[0], origin[1], origin[2]},
                            .direction = {direction[0], direction[1], direction[2]},
                            .max_distance = max_distance};
    struct RTCRayHit query;
    if (!closest_hit(ray_scene, &ray, &query))
        return false;
    struct ray_crossing crossing = crossing_of(ray_scene, &query.hit, query.ray.tfar);
    const struct scene *scene = ray_scene->scene;
    const struct scene_node *node = &scene->nodes[crossing.node];
    out_hit->node = crossing.node;
    out_hit->primitive = crossing.primitive;
    out_hit->triangle = crossing.triangle;
    out_hit->material = scene->primitives[out_hit->primitive].material;
    out_hit->barycentric[0] = query.hit.u;
    out_hit->barycentric[1] = query.hit.v;
    out_hit->distance = query.ray.tfar;
    for (int axis = 0; axis < 3; axis++)
        out_hit->position[axis] = origin[axis] + direction[axis] * query.ray.tfar;
    fill_normal(node, &query.hit, direction, out_hit->normal);
    return true;
}
