#include <algorithm>
#include <cstring>

#include "renderer/import/gltf_import.hpp"

static uint32_t component_bytes(int component_type)
{
    switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return 2;
    default:
        return 4;
    }
}

uint32_t gltf_accessor_components(const tinygltf::Accessor &accessor)
{
    return (uint32_t)tinygltf::GetNumComponentsInType((uint32_t)accessor.type);
}

static uint64_t element_bytes(const tinygltf::Accessor &accessor)
{
    return (uint64_t)component_bytes(accessor.componentType) * gltf_accessor_components(accessor);
}

static void check_view(const gltf_import &import, size_t index)
{
    const tinygltf::BufferView &view = import.model.bufferViews[index];
    uint64_t size = import.buffers[(size_t)view.buffer].size;
    if ((uint64_t)view.byteOffset + view.byteLength > size) {
        import_fail("bufferViews[%zu] covers bytes %zu to %zu of a buffer of %llu bytes", index,
                    view.byteOffset, view.byteOffset + view.byteLength, (unsigned long long)size);
    }
}

// Fails unless `count` elements, `stride` bytes apart from `offset` on, lie in the view.
static void check_fits(const gltf_import &import, size_t accessor, const char *part, int view_index,
                       uint64_t offset, uint64_t count, uint64_t stride, uint64_t element)
{
    const tinygltf::BufferView &view = import.model.bufferViews[(size_t)view_index];
    uint64_t end = offset + (count - 1) * stride + element;
    if (end > view.byteLength) {
        import_fail("accessors[%zu]%s needs %llu bytes; bufferViews[%d] has %zu", accessor, part,
                    (unsigned long long)end, view_index, view.byteLength);
    }
}

static uint32_t read_unsigned(const uint8_t *data, int component_type)
{
    switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return data[0];
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return (uint32_t)(data[0] | data[1] << 8);
    default:
        return data[0] | data[1] << 8 | data[2] << 16 | (uint32_t)data[3] << 24;
    }
}

static const uint8_t *view_data(const gltf_import &import, int view_index)
{
    const tinygltf::BufferView &view = import.model.bufferViews[(size_t)view_index];
    return import.buffers[(size_t)view.buffer].data + view.byteOffset;
}

static void check_sparse(const gltf_import &import, size_t index)
{
    const tinygltf::Accessor &accessor = import.model.accessors[index];
    const auto &sparse = accessor.sparse;
    uint64_t count = (uint64_t)sparse.count;
    if (count > accessor.count) {
        import_fail("accessors[%zu].sparse.count is %llu; the accessor has %zu elements", index,
                    (unsigned long long)count, accessor.count);
    }
    uint64_t index_bytes = component_bytes(sparse.indices.componentType);
    check_fits(import, index, ".sparse.indices", sparse.indices.bufferView,
               (uint64_t)sparse.indices.byteOffset, count, index_bytes, index_bytes);
    uint64_t bytes = element_bytes(accessor);
    check_fits(import, index, ".sparse.values", sparse.values.bufferView,
               (uint64_t)sparse.values.byteOffset, count, bytes, bytes);
    const uint8_t *data = view_data(import, sparse.indices.bufferView) + sparse.indices.byteOffset;
    for (uint64_t i = 0; i < count; i++) {
        uint32_t target = read_unsigned(data + i * index_bytes, sparse.indices.componentType);
        if (target >= accessor.count) {
            import_fail("accessors[%zu].sparse names element %u of %zu", index, target,
                        accessor.count);
        }
    }
}

void gltf_check_accessors(const gltf_import &import)
{
    const tinygltf::Model &model = import.model;
    for (size_t i = 0; i < model.bufferViews.size(); i++) {
        check_view(import, i);
    }
    for (size_t i = 0; i < model.accessors.size(); i++) {
        const tinygltf::Accessor &accessor = model.accessors[i];
        if (accessor.count > SCENE_MAX_INDICES) {
            import_fail("accessors[%zu].count is %zu; allowed are 1 to %u", i, accessor.count,
                        SCENE_MAX_INDICES);
        }
        if (accessor.bufferView >= 0) {
            uint64_t bytes = element_bytes(accessor);
            uint64_t stride = model.bufferViews[(size_t)accessor.bufferView].byteStride;
            check_fits(import, i, "", accessor.bufferView, accessor.byteOffset, accessor.count,
                       stride ? stride : bytes, bytes);
        } else if (accessor.count > GLTF_MAX_ZERO_ELEMENTS) {
            import_fail("accessors[%zu] has no bufferView and %zu elements; allowed are 1 to %u", i,
                        accessor.count, GLTF_MAX_ZERO_ELEMENTS);
        }
        if (accessor.sparse.isSparse) {
            check_sparse(import, i);
        }
    }
}

static const uint8_t *resolve_sparse(gltf_import &import, int index, const uint8_t *base,
                                     size_t base_stride)
{
    const tinygltf::Accessor &accessor = import.model.accessors[(size_t)index];
    const auto &sparse = accessor.sparse;
    size_t bytes = (size_t)element_bytes(accessor);
    std::vector<uint8_t> &data = import.sparse[index];
    if (!data.empty()) {
        return data.data();
    }
    import.sparse_bytes += bytes * accessor.count;
    if (import.sparse_bytes > std::max((uint64_t)GLTF_FREE_SPARSE_BYTES, import.buffer_bytes * 8)) {
        import_fail("the sparse accessors exceed %u MiB, or 8 times the file's buffers, together",
                    GLTF_FREE_SPARSE_BYTES >> 20);
    }
    data.resize(bytes * accessor.count);
    for (size_t i = 0; base && i < accessor.count; i++) {
        memcpy(&data[i * bytes], base + i * base_stride, bytes);
    }
    size_t index_bytes = component_bytes(sparse.indices.componentType);
    const uint8_t *targets =
        view_data(import, sparse.indices.bufferView) + sparse.indices.byteOffset;
    const uint8_t *values = view_data(import, sparse.values.bufferView) + sparse.values.byteOffset;
    for (size_t i = 0; i < (size_t)sparse.count; i++) {
        size_t target = read_unsigned(targets + i * index_bytes, sparse.indices.componentType);
        memcpy(&data[target * bytes], values + i * bytes, bytes);
    }
    return data.data();
}

gltf_elements gltf_get_elements(gltf_import &import, int index)
{
    const tinygltf::Accessor &accessor = import.model.accessors[(size_t)index];
    gltf_elements elements = {};
    elements.stride = (size_t)element_bytes(accessor);
    elements.count = (uint32_t)accessor.count;
    elements.component_type = accessor.componentType;
    elements.components = gltf_accessor_components(accessor);
    elements.normalized = accessor.normalized;
    if (accessor.bufferView >= 0) {
        elements.data = view_data(import, accessor.bufferView) + accessor.byteOffset;
        size_t stride = import.model.bufferViews[(size_t)accessor.bufferView].byteStride;
        if (stride) {
            elements.stride = stride;
        }
    }
    if (accessor.sparse.isSparse) {
        elements.data = resolve_sparse(import, index, elements.data, elements.stride);
        elements.stride = (size_t)element_bytes(accessor);
    }
    return elements;
}

// One component, converted as in glTF 2.0, 3.6.2.2; signed values reach exactly -1.
static float read_component(const uint8_t *data, int component_type, bool normalized)
{
    switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: {
        float value = (float)(int8_t)data[0];
        return normalized ? std::max(value / 127.0f, -1.0f) : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return normalized ? (float)data[0] / 255.0f : (float)data[0];
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
        float value = (float)(int16_t)(uint16_t)(data[0] | data[1] << 8);
        return normalized ? std::max(value / 32767.0f, -1.0f) : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
        float value = (float)(data[0] | data[1] << 8);
        return normalized ? value / 65535.0f : value;
    }
    case TINYGLTF_COMPONENT_TYPE_FLOAT: {
        float value;
        memcpy(&value, data, sizeof(value));
        return value;
    }
    default:
        return (float)read_unsigned(data, component_type);
    }
}

void gltf_read_element(const gltf_elements &elements, uint32_t index, float *out, uint32_t count)
{
    count = std::min(count, elements.components);
    if (!elements.data) {
        std::fill(out, out + count, 0.0f);
        return;
    }
    const uint8_t *data = elements.data + (size_t)index * elements.stride;
    if (elements.component_type == TINYGLTF_COMPONENT_TYPE_FLOAT) {
        memcpy(out, data, count * sizeof(float));
        return;
    }
    uint32_t bytes = component_bytes(elements.component_type);
    for (uint32_t i = 0; i < count; i++) {
        out[i] = read_component(data + i * bytes, elements.component_type, elements.normalized);
    }
}

uint32_t gltf_read_index(const gltf_elements &elements, uint32_t index)
{
    if (!elements.data) {
        return 0;
    }
    return read_unsigned(elements.data + (size_t)index * elements.stride, elements.component_type);
}
