// Vertices, indices, instances and visibility ids.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/gpu_scene/gpu_scene.h"
#include "renderer/hash.h"
#include "renderer/scene/placement.h"
#include "renderer/scene/scene.h"

static uint32_t pack_snorm(float value)
{
    float clamped = fminf(fmaxf(value, -1.0f), 1.0f);
    return (uint32_t)(int32_t)lrintf(clamped * 32767.0f) & 0xffffu;
}

// Octahedral, as octahedral_encode() in shaders/lib/frame.glsl; VERTEX_NO_DIRECTION for zero or
// non-finite vectors.
static uint32_t pack_direction(const float v[3])
{
    float sum = fabsf(v[0]) + fabsf(v[1]) + fabsf(v[2]);
    if (!(sum > 0.0f) || !isfinite(sum))
        return VERTEX_NO_DIRECTION;
    float x = v[0] / sum, y = v[1] / sum;
    if (v[2] < 0.0f) {
        float folded = (1.0f - fabsf(y)) * (x >= 0.0f ? 1.0f : -1.0f);
        y = (1.0f - fabsf(x)) * (y >= 0.0f ? 1.0f : -1.0f);
        x = folded;
    }
    return pack_snorm(x) | pack_snorm(y) << 16;
}

// Packs the scene's vertices into the words that shaders read. From malloc; NULL when memory runs
// out.
static uint32_t *pack_vertices(const struct scene *scene)
{
    uint32_t *words = malloc(((size_t)scene->vertex_count * VERTEX_WORDS + 1) * sizeof(*words));
    for (uint32_t i = 0; words && i < scene->vertex_count; i++) {
        const struct scene_vertex *vertex = &scene->vertices[i];
        uint32_t *target = words + (size_t)i * VERTEX_WORDS;
        memset(target, 0, VERTEX_WORDS * sizeof(*target));
        memcpy(target, vertex->position, sizeof(vertex->position));
        target[VERTEX_NORMAL] = pack_direction(vertex->normal);
        target[VERTEX_TANGENT] = (pack_direction(vertex->tangent) & ~0x10000u) |
                                 (vertex->tangent[3] < 0.0f ? 0x10000u : 0u);
        memcpy(target + VERTEX_UV, vertex->uv[0], sizeof(vertex->uv[0]));
        memcpy(target + VERTEX_SECOND_UV, vertex->uv[1], sizeof(vertex->uv[1]));
        memcpy(target + VERTEX_COLOR, vertex->color, sizeof(vertex->color));
    }
    return words;
}

static bool upload(struct gpu_scene *gpu_scene, struct gpu_buffer **buffer, const char *label,
                   enum gpu_texel texel, size_t size_bytes, const void *data)
{
    gpu_buffer_destroy(buffer);
    if (!gpu_texels_fit(gpu_scene->gpu, texel, size_bytes))
        return false;
    *buffer = gpu_buffer_create(gpu_scene->gpu, label, GPU_BUFFER_STATIC, size_bytes, data);
    return *buffer != NULL;
}

static uint32_t count_instances(const struct scene *scene)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < scene->node_count; i++)
        if (scene->nodes[i].mesh != SCENE_NONE && !scene->nodes[i].removed)
            count += scene->meshes[scene->nodes[i].mesh].primitive_count;
    return count;
}

// Gives each instance a run of visibility ids that starts at a block boundary, and uploads the
// owner of each block.
static bool upload_id_blocks(struct gpu_scene *gpu_scene)
{
    const uint32_t block_size = 1u << ID_BLOCK_BITS;
    uint64_t block_count = 0;
    for (uint32_t i = 0; i < gpu_scene->counts.instances; i++)
        block_count += (gpu_scene->instances[i].index_count / 3 + block_size - 1) / block_size;
    if (block_count >= UINT32_MAX / block_size)
        return false;
    uint32_t *owners = malloc((block_count ? block_count : 1) * sizeof(*owners));
    if (!owners)
        return false;
    uint32_t at = 0;
    for (uint32_t i = 0; i < gpu_scene->counts.instances; i++) {
        uint32_t triangles = gpu_scene->instances[i].index_count / 3;
        gpu_scene->instances[i].first_id = at << ID_BLOCK_BITS;
        for (uint32_t j = 0; j < (triangles + block_size - 1) / block_size; j++)
            owners[at++] = i;
    }
    gpu_scene->cluster_count = at;
    bool done = scene_tables_write(&gpu_scene->tables, TABLE_ID_BLOCKS, owners,
                                   block_count * sizeof(*owners));
    free(owners);
    return done;
}

static bool has_colors(const struct scene *scene, const struct scene_primitive *primitive)
{
    for (uint32_t i = 0; i < primitive->vertex_count; i++) {
        const float *color = scene->vertices[primitive->vertex_first + i].color;
        if (color[0] != 1.0f || color[1] != 1.0f || color[2] != 1.0f || color[3] != 1.0f)
            return true;
    }
    return false;
}

bool gpu_scene_upload_geometry(struct gpu_scene *gpu_scene)
{
    const struct scene *scene = gpu_scene->scene;
    uint32_t count = count_instances(scene);
    free(gpu_scene->instances);
    gpu_scene->instances = calloc(count ? count : 1, sizeof(*gpu_scene->instances));
    if (!gpu_scene->instances)
        return false;
    gpu_scene->counts.instances = 0;
    for (uint32_t i = 0; i < scene->node_count; i++) {
        const struct scene_node *node = &scene->nodes[i];
        if (node->mesh == SCENE_NONE || node->removed)
            continue;
        const struct scene_mesh *mesh = &scene->meshes[node->mesh];
        for (uint32_t j = 0; j < mesh->primitive_count; j++) {
            const struct scene_primitive *primitive = &scene->primitives[mesh->primitive_first + j];
            gpu_scene->instances[gpu_scene->counts.instances++] = (struct gpu_scene_instance){
                .node = i,
                .primitive = mesh->primitive_first + j,
                .index_first = primitive->index_first,
                .index_count = primitive->index_count,
            };
        }
    }
    gpu_scene->counts.colored_primitives = 0;
    for (uint32_t i = 0; i < scene->primitive_count; i++)
        gpu_scene->counts.colored_primitives += has_colors(scene, &scene->primitives[i]);
    gpu_scene->drawable = scene->index_count > 0 && count > 0;
    uint32_t *words = pack_vertices(scene);
    bool done = words &&
                upload(gpu_scene, &gpu_scene->vertices, "geometry.vertices", GPU_TEXEL_UINT4,
                       (size_t)scene->vertex_count * VERTEX_WORDS * sizeof(*words), words) &&
                upload(gpu_scene, &gpu_scene->indices, "geometry.indices", GPU_TEXEL_UINT3,
                       scene->index_count * sizeof(uint32_t), scene->indices) &&
                upload_id_blocks(gpu_scene);
    free(words);
    return done && gpu_scene_build_clusters(gpu_scene) && gpu_scene_upload_raster_mesh(gpu_scene);
}

static void fill_instance_block(struct instance_block *block, const float matrix[16])
{
    memcpy(block->world_from_local, matrix, sizeof(block->world_from_local));
    mat3 linear;
    glm_mat4_pick3(block->world_from_local, linear);
    block->flags = glm_mat3_det(linear) < 0.0f ? INSTANCE_MIRRORED : 0;
}

static uint8_t group_of(const struct scene_material *material, bool mirrored)
{
    enum draw_kind kind = DRAW_OPAQUE;
    if (material->alpha_mode == SCENE_ALPHA_BLEND || material->transmission > 0.0f)
        kind = DRAW_TRANSPARENT;
    else if (material->alpha_mode == SCENE_ALPHA_MASK)
        kind = DRAW_MASKED;
    enum gpu_cull cull = mirrored ? GPU_CULL_FRONT : GPU_CULL_BACK;
    if (material->double_sided)
        cull = GPU_CULL_NONE;
    return (uint8_t)((int)kind * DRAW_CULL_COUNT + (int)cull);
}

static void transform_instance(struct gpu_scene *gpu_scene, struct gpu_scene_instance *instance,
                               struct instance_block *block)
{
    const struct scene *scene = gpu_scene->scene;
    const struct scene_node *node = &scene->nodes[instance->node];
    const struct scene_primitive *primitive = &scene->primitives[instance->primitive];
    memcpy(instance->world_from_local, node->world_from_local, sizeof(node->world_from_local));
    gpu_scene_from_world(gpu_scene, node->world_from_local + 12, instance->world_from_local + 12);
    fill_instance_block(block, instance->world_from_local);
    block->first_triangle = instance->index_first / 3;
    block->material = primitive->material;
    block->first_visibility_id = instance->first_id;
    instance->visible = node->world_visible && instance->index_count > 0;
    instance->group =
        group_of(&scene->materials[primitive->material], (block->flags & INSTANCE_MIRRORED) != 0);
    instance->scale = 0.0f;
    for (int column = 0; column < 3; column++)
        instance->scale =
            fmaxf(instance->scale, glm_vec3_norm2((float *)node->world_from_local + 4 * column));
    // The axes of a sheared transform can add up.
    instance->scale = sqrtf(3.0f * instance->scale);
    double low[3], high[3];
    placement_transform_box(instance->world_from_local, primitive->bounds_min,
                            primitive->bounds_max, low, high);
    for (int axis = 0; axis < 3; axis++) {
        instance->bounds_min[axis] = (float)low[axis];
        instance->bounds_max[axis] = (float)high[axis];
        if (instance->visible) {
            gpu_scene->bounds_min[axis] =
                fminf(gpu_scene->bounds_min[axis], instance->bounds_min[axis]);
            gpu_scene->bounds_max[axis] =
                fmaxf(gpu_scene->bounds_max[axis], instance->bounds_max[axis]);
        }
    }
}

// Hash of what decides whether and how instances cast shadows, except their transforms.
static uint64_t hash_casters(const struct gpu_scene *gpu_scene)
{
    const struct scene *scene = gpu_scene->scene;
    uint64_t hash = HASH_START;
    for (uint32_t i = 0; i < gpu_scene->counts.instances; i++) {
        const struct gpu_scene_instance *instance = &gpu_scene->instances[i];
        const struct scene_material *material =
            &scene->materials[scene->primitives[instance->primitive].material];
        bool masked = material->alpha_mode == SCENE_ALPHA_MASK;
        float cutoff = masked ? material->alpha_cutoff : 0.0f;
        float alpha = masked ? material->base_color[3] : 0.0f;
        uint32_t words[4] = {instance->group, instance->visible, 0, 0};
        memcpy(&words[2], &cutoff, sizeof(cutoff));
        memcpy(&words[3], &alpha, sizeof(alpha));
        for (int j = 0; j < 4; j++)
            hash = hash_word(hash, words[j]);
    }
    return hash;
}

bool gpu_scene_upload_instances(struct gpu_scene *gpu_scene)
{
    uint32_t count = gpu_scene->counts.instances;
    struct instance_block *blocks = calloc(count ? count : 1, sizeof(*blocks));
    if (!blocks)
        return false;
    for (int axis = 0; axis < 3; axis++) {
        gpu_scene->bounds_min[axis] = INFINITY;
        gpu_scene->bounds_max[axis] = -INFINITY;
    }
    for (uint32_t i = 0; i < count; i++)
        transform_instance(gpu_scene, &gpu_scene->instances[i], &blocks[i]);
    uint64_t caster_hash = hash_casters(gpu_scene);
    const struct scene_revisions *now = &gpu_scene->scene->revisions;
    if (caster_hash != gpu_scene->caster_hash || now->geometry != gpu_scene->seen.geometry ||
        now->transforms != gpu_scene->seen.transforms)
        gpu_scene->casters_changed = true;
    gpu_scene->caster_hash = caster_hash;
    float diagonal = glm_vec3_distance(gpu_scene->bounds_min, gpu_scene->bounds_max);
    gpu_scene->diagonal_m = isfinite(diagonal) && diagonal > 0.0f ? diagonal : 1.0f;
    bool done =
        scene_tables_write(&gpu_scene->tables, TABLE_INSTANCES, blocks, count * sizeof(*blocks));
    free(blocks);
    return done;
}
