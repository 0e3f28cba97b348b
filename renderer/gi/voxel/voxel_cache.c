#include "renderer/gi/voxel/voxel_cache.h"

#include <stdlib.h>
#include <string.h>

#include "renderer/scene/scene.h"

// Raise it when the layout of entries changes, or what is voxelized by code other than shaders.
#define VERSION 1

#define COLOR_SLOTS 3u

// Of an entry. Then for each cell its slot and level and its first surfel, the surfels, and the
// numbers of those that are free. The index follows from the cells.
struct entry_header {
    uint32_t cell_count;
    uint32_t surfel_count; // up to the highest
    uint32_t free_count;   // of them
    uint32_t unused;       // 0
};

// The parts of an entry in memory.
struct entry_parts {
    struct entry_header *header;
    uint32_t (*cells)[2];
    uint32_t (*surfels)[SURFEL_WORDS];
    uint32_t *free_surfels;
};

bool voxel_cache_applies(const struct voxel_volume *volume)
{
    return scene_cache_is_open() && volume->everything && !volume->voxelized &&
           gpu_get_info(volume->gpu)->software;
}

static void add_word(struct cache_key *key, uint32_t word)
{
    cache_key_add(key, &word, sizeof(word));
}

static void add_driver(struct cache_key *key, const struct gpu *gpu)
{
    const struct renderer_info *info = gpu_get_info(gpu);
    cache_key_add(key, info->gl_renderer, strlen(info->gl_renderer));
    cache_key_add(key, info->gl_version, strlen(info->gl_version));
}

static void add_levels(struct cache_key *key, const struct voxel_volume *volume)
{
    add_word(key, volume->params.method);
    add_word(key, volume->params.edge);
    add_word(key, volume->params.colors);
    add_word(key, volume->cell_level_count);
    cache_key_add(key, volume->anchor, sizeof(volume->anchor));
    for (uint32_t i = 0; i < volume->cell_level_count; i++) {
        const struct voxel_level *level = &volume->levels[i];
        add_word(key, level->edge);
        cache_key_add(key, &level->voxel_edge_m, sizeof(level->voxel_edge_m));
        cache_key_add(key, &level->box, sizeof(level->box));
    }
}

static void add_geometry(struct cache_key *key, const struct gpu_scene *gpu_scene)
{
    const struct scene *scene = gpu_scene->scene;
    cache_key_add(key, scene->vertices, scene->vertex_count * sizeof(*scene->vertices));
    cache_key_add(key, scene->indices, scene->index_count * sizeof(*scene->indices));
    for (uint32_t i = 0; i < gpu_scene->counts.instances; i++) {
        const struct gpu_scene_instance *instance = &gpu_scene->instances[i];
        cache_key_add(key, instance->world_from_local, sizeof(instance->world_from_local));
        const uint32_t words[] = {instance->index_first, instance->index_count, instance->visible,
                                  scene->primitives[instance->primitive].material};
        cache_key_add(key, words, sizeof(words));
    }
}

// Textures that surfels take colours from. Each image counts once, by where it is first used.
static void add_textures(struct cache_key *key, const struct gpu_scene *gpu_scene)
{
    static const enum scene_texture_slot slots[COLOR_SLOTS] = {
        SCENE_TEXTURE_BASE_COLOR, SCENE_TEXTURE_EMISSIVE, SCENE_TEXTURE_SPECULAR_COLOR};
    const struct scene *scene = gpu_scene->scene;
    bool *added = calloc(scene->image_count + 1, sizeof(*added));
    for (uint32_t i = 0; i < scene->material_count; i++)
        for (uint32_t j = 0; j < COLOR_SLOTS; j++) {
            const struct scene_texture *texture = &scene->materials[i].textures[slots[j]];
            const uint32_t words[] = {texture->image, texture->uv_set, texture->wrap_u,
                                      texture->wrap_v, texture->nearest};
            const float floats[] = {texture->offset[0], texture->offset[1], texture->scale[0],
                                    texture->scale[1], texture->rotation_rad};
            cache_key_add(key, words, sizeof(words));
            cache_key_add(key, floats, sizeof(floats));
            if (texture->image >= scene->image_count || (added && added[texture->image]))
                continue;
            image_add_to_key(scene->images[texture->image], key);
            if (added)
                added[texture->image] = true;
        }
    free(added);
}

struct cache_key voxel_cache_key(const struct voxel_volume *volume,
                                 const struct gpu_scene *gpu_scene, uint64_t programs)
{
    struct cache_key key = cache_key_start("voxels", VERSION);
    cache_key_add(&key, &programs, sizeof(programs));
    add_driver(&key, volume->gpu);
    add_levels(&key, volume);
    cache_key_add(&key, &volume->surfaces_hash, sizeof(volume->surfaces_hash));
    add_geometry(&key, gpu_scene);
    add_textures(&key, gpu_scene);
    return key;
}

static size_t entry_bytes(const struct entry_header *header)
{
    return sizeof(*header) + (size_t)header->cell_count * 2 * sizeof(uint32_t) +
           ((size_t)header->surfel_count * SURFEL_WORDS + header->free_count) * sizeof(uint32_t);
}

static struct entry_parts parts_of(void *entry)
{
    struct entry_parts parts = {.header = entry};
    parts.cells = (uint32_t(*)[2])(parts.header + 1);
    parts.surfels = (uint32_t(*)[SURFEL_WORDS])(parts.cells + parts.header->cell_count);
    parts.free_surfels = (uint32_t *)(parts.surfels + parts.header->surfel_count);
    return parts;
}

static bool header_fits(const struct voxel_volume *volume, const void *entry, size_t size)
{
    const struct entry_header *header = entry;
    return size >= sizeof(*header) && header->cell_count < volume->cell_capacity &&
           header->surfel_count < volume->surfel_capacity &&
           header->free_count <= header->surfel_count && size == entry_bytes(header);
}

// Words of the index of one level.
static size_t level_words(const struct voxel_volume *volume)
{
    size_t edge = volume->params.edge;
    return edge * edge * edge;
}

// Marks a surfel as used; false if there is none of this number, or it is used already.
static bool use_surfel(bool used[], uint32_t count, uint32_t surfel)
{
    if (surfel >= count || used[surfel])
        return false;
    used[surfel] = true;
    return true;
}

// Writes the index from the cells. False unless every cell has a voxel and surfels of its own: what
// shaders follow must stay within the pools and come to an end.
static bool make_index(const struct voxel_volume *volume, const struct entry_parts *parts,
                       uint32_t *index, bool *used)
{
    uint32_t surfels = parts->header->surfel_count;
    for (uint32_t i = 0; i < parts->header->cell_count; i++) {
        uint32_t slot = parts->cells[i][0] & CELL_SLOT_MASK;
        uint32_t level = parts->cells[i][0] >> CELL_LEVEL_BIT;
        if (level >= volume->cell_level_count || slot >= level_words(volume))
            return false;
        uint32_t *word = index + level * level_words(volume) + slot;
        if (*word != 0)
            return false;
        *word = i + 1;
        for (uint32_t at = parts->cells[i][1]; at != VOXEL_NONE;
             at = parts->surfels[at][SURFEL_NEXT])
            if (!use_surfel(used, surfels, at))
                return false;
    }
    for (uint32_t i = 0; i < parts->header->free_count; i++)
        if (!use_surfel(used, surfels, parts->free_surfels[i]))
            return false;
    return true;
}

// Cells as shaders have them, from the two words of each that are kept. From malloc().
static uint32_t *expand_cells(const struct entry_parts *parts)
{
    uint32_t count = parts->header->cell_count;
    uint32_t *cells = calloc((size_t)count * CELL_WORDS + 1, sizeof(*cells));
    for (uint32_t i = 0; cells && i < count; i++) {
        cells[(size_t)i * CELL_WORDS] = parts->cells[i][0];
        cells[(size_t)i * CELL_WORDS + CELL_SURFEL] = parts->cells[i][1];
    }
    return cells;
}

static void upload(struct voxel_volume *volume, const struct entry_parts *parts,
                   const uint32_t *index, const uint32_t *cells)
{
    const struct entry_header *header = parts->header;
    uint32_t counters[COUNTER_CACHE_LEFT] = {[COUNTER_CELLS] = header->cell_count,
                                             [COUNTER_SURFELS] = header->surfel_count,
                                             [COUNTER_FREE_SURFELS] = header->free_count};
    gpu_buffer_write(volume->index, 0, level_words(volume) * volume->cell_level_count * 4, index);
    gpu_buffer_write(volume->cells, 0, (size_t)header->cell_count * CELL_WORDS * 4, cells);
    gpu_buffer_write(volume->surfels, 0, (size_t)header->surfel_count * SURFEL_WORDS * 4,
                     parts->surfels);
    gpu_buffer_write(volume->free_list, (size_t)volume->cell_capacity * 4,
                     (size_t)header->free_count * 4, parts->free_surfels);
    gpu_buffer_write(volume->counters, 0, sizeof(counters), counters);
}

bool voxel_cache_restore(struct voxel_volume *volume, const struct cache_key *key)
{
    const struct entry_header largest = {volume->cell_capacity, volume->surfel_capacity,
                                         volume->surfel_capacity, 0};
    size_t size = 0;
    void *entry = scene_cache_read(key, entry_bytes(&largest), &size);
    if (!entry || !header_fits(volume, entry, size)) {
        free(entry);
        return false;
    }
    struct entry_parts parts = parts_of(entry);
    uint32_t *index = calloc(level_words(volume) * volume->cell_level_count, sizeof(*index));
    bool *used = calloc(parts.header->surfel_count + 1, sizeof(*used));
    uint32_t *cells = expand_cells(&parts);
    bool fine = index && used && cells && make_index(volume, &parts, index, used);
    if (fine)
        upload(volume, &parts, index, cells);
    free(cells);
    free(used);
    free(index);
    free(entry);
    return fine;
}

void voxel_cache_keep(const struct voxel_volume *volume, const struct cache_key *key)
{
    uint32_t counters[COUNTER_CACHE_LEFT];
    gpu_buffer_read(volume->counters, 0, sizeof(counters), counters);
    // A first voxelization frees no cells.
    if (counters[COUNTER_OVERFLOW] || counters[COUNTER_FREE_CELLS])
        return;
    const struct entry_header header = {counters[COUNTER_CELLS], counters[COUNTER_SURFELS],
                                        counters[COUNTER_FREE_SURFELS], 0};
    void *entry = malloc(entry_bytes(&header));
    uint32_t *cells = malloc((size_t)header.cell_count * CELL_WORDS * 4 + 1);
    if (entry && cells) {
        *(struct entry_header *)entry = header;
        struct entry_parts parts = parts_of(entry);
        gpu_buffer_read(volume->cells, 0, (size_t)header.cell_count * CELL_WORDS * 4, cells);
        for (uint32_t i = 0; i < header.cell_count; i++) {
            parts.cells[i][0] = cells[(size_t)i * CELL_WORDS];
            parts.cells[i][1] = cells[(size_t)i * CELL_WORDS + CELL_SURFEL];
        }
        gpu_buffer_read(volume->surfels, 0, (size_t)header.surfel_count * SURFEL_WORDS * 4,
                        parts.surfels);
        gpu_buffer_read(volume->free_list, (size_t)volume->cell_capacity * 4,
                        (size_t)header.free_count * 4, parts.free_surfels);
        scene_cache_write(key, entry, entry_bytes(&header));
    }
    free(cells);
    free(entry);
}
