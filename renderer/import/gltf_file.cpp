#include <cstring>
#include <memory>

#include "renderer/import/gltf_import.hpp"

extern "C" {
#include "renderer/image/image_batch.h"
}

#define GLB_CHUNK_JSON 0x4e4f534au
#define GLB_CHUNK_BIN  0x004e4942u

using nlohmann::json;

static uint32_t read_u32(const uint8_t *bytes)
{
    return bytes[0] | bytes[1] << 8 | bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

struct byte_range {
    const uint8_t *data = nullptr;
    size_t size = 0;
};

// Ignores chunks after JSON and BIN, and bytes after the declared length, as glTF 2.0 requires.
static void split_glb(const uint8_t *bytes, size_t size, byte_range *out_json, byte_range *out_bin)
{
    if (size < 20) {
        import_fail("the file ends within the GLB header");
    }
    uint32_t version = read_u32(bytes + 4);
    uint64_t length = read_u32(bytes + 8);
    if (version != 2) {
        import_fail("GLB version %u; supported is 2", version);
    }
    if (length > size || length < 20) {
        import_fail("the GLB header says %llu bytes, the file has %zu", (unsigned long long)length,
                    size);
    }
    uint64_t offset = 12;
    for (uint32_t batch = 0; offset + 8 <= length; batch++) {
        uint64_t chunk_size = read_u32(bytes + offset);
        uint32_t kind = read_u32(bytes + offset + 4);
        if (chunk_size > length - offset - 8) {
            import_fail("GLB chunk %u of %llu bytes ends beyond the file's %llu", batch,
                        (unsigned long long)chunk_size, (unsigned long long)length);
        }
        if (batch == 0 && kind != GLB_CHUNK_JSON) {
            import_fail("the first GLB chunk is not JSON");
        }
        if (batch == 0) {
            *out_json = {bytes + offset + 8, (size_t)chunk_size};
        } else if (batch == 1 && kind == GLB_CHUNK_BIN) {
            *out_bin = {bytes + offset + 8, (size_t)chunk_size};
        }
        offset += 8 + ((chunk_size + 3) & ~3ull);
    }
    if (!out_json->data) {
        import_fail("the GLB has no JSON chunk");
    }
}

// The JSON parser keeps state for each nesting level: check the depth before it runs.
static void check_depth(const byte_range &text)
{
    uint32_t depth = 0;
    bool in_string = false;
    for (size_t i = 0; i < text.size; i++) {
        uint8_t character = text.data[i];
        if (in_string) {
            i += character == '\\';
            in_string = character != '"';
        } else if (character == '"') {
            in_string = true;
        } else if (character == '[' || character == '{') {
            if (++depth > GLTF_MAX_JSON_DEPTH) {
                import_fail("JSON nested deeper than %u levels at byte %zu", GLTF_MAX_JSON_DEPTH,
                            i);
            }
        } else if ((character == ']' || character == '}') && depth > 0) {
            depth--;
        }
    }
}

static json parse_json(byte_range text)
{
    if (text.size >= 3 && memcmp(text.data, "\xef\xbb\xbf", 3) == 0) {
        text = {text.data + 3, text.size - 3};
    }
    bool utf16 = text.size >= 2 && (text.data[0] >= 0xfe || text.data[0] == 0 || text.data[1] == 0);
    if (utf16) {
        import_fail("the JSON is not UTF-8");
    }
    check_depth(text);
    try {
        return json::parse(text.data, text.data + text.size);
    } catch (const json::exception &failure) {
        std::string cause = failure.what();
        cause = cause.substr(0, cause.find("; last read")); // may not be UTF-8
        import_fail("not valid JSON: %.300s", cause.c_str());
    }
}

static int base64_value(char digit)
{
    if (digit >= 'A' && digit <= 'Z') {
        return digit - 'A';
    }
    if (digit >= 'a' && digit <= 'z') {
        return digit - 'a' + 26;
    }
    if (digit >= '0' && digit <= '9') {
        return digit - '0' + 52;
    }
    return digit == '+' || digit == '-' ? 62 : digit == '/' || digit == '_' ? 63 : -1;
}

static bool is_data_uri(const std::string &uri)
{
    return uri.compare(0, 5, "data:") == 0;
}

static std::vector<uint8_t> decode_data_uri(const std::string &uri, const char *what)
{
    size_t comma = uri.find(',');
    if (comma == std::string::npos || comma < 7 || uri.compare(comma - 7, 7, ";base64") != 0) {
        import_fail("%s: a data URI that is not base64", what);
    }
    std::vector<uint8_t> bytes;
    bytes.reserve((uri.size() - comma) / 4 * 3 + 3);
    uint32_t bits = 0;
    uint32_t bit_count = 0;
    for (size_t i = comma + 1; i < uri.size() && uri[i] != '='; i++) {
        int value = base64_value(uri[i]);
        if (value < 0) {
            import_fail("%s: a data URI with a character that is not base64", what);
        }
        bits = bits << 6 | (uint32_t)value;
        bit_count += 6;
        if (bit_count >= 8) {
            bit_count -= 8;
            bytes.push_back((uint8_t)(bits >> bit_count));
        }
    }
    return bytes;
}

// Canonical path of a file that the scene names; fails if it must not be read.
static std::string resolve_uri(const gltf_import &import, const std::string &uri, const char *what)
{
    struct error error;
    std::string decoded = uri.c_str();
    if (decoded.size() != uri.size()) {
        import_fail("%s: a URI with a NUL character", what);
    }
    if (import.folder.empty()) {
        import_fail("%s: '%.200s' cannot be read, as this scene has no folder", what, uri.c_str());
    }
    if (!asset_path_decode_percent(decoded.data())) {
        import_fail("%s: '%.200s' has a broken %%-escape", what, uri.c_str());
    }
    std::unique_ptr<char, decltype(&free)> path(
        asset_path_resolve(import.folder.c_str(), decoded.c_str(), &error), free);
    if (!path) {
        import_fail("%s: %s", what, error.message);
    }
    return path.get();
}

static void read_buffer_file(gltf_import &import, gltf_buffer &buffer, const std::string &uri,
                             const char *what)
{
    struct error error;
    std::string path = resolve_uri(import, uri, what);
    uint8_t *bytes = nullptr;
    size_t size = 0;
    if (!asset_read_file(path.c_str(), FILE_MAX_BYTES - import.buffer_bytes, &bytes, &size, nullptr,
                         &error)) {
        import_fail("%s: %s", what, error.message);
    }
    std::unique_ptr<uint8_t, decltype(&free)> owned(bytes, free);
    buffer.owned.assign(bytes, bytes + size);
    scene_add_source_file(import.scene, path.c_str());
}

static void read_buffers(gltf_import &import, const byte_range &bin)
{
    const json &list = import.json.value("buffers", json::array());
    import.buffers.resize(list.size());
    for (size_t i = 0; i < list.size(); i++) {
        std::string what = "buffers[" + std::to_string(i) + "]";
        gltf_buffer &buffer = import.buffers[i];
        uint64_t length = list[i]["byteLength"].get<uint64_t>();
        if (list[i].contains("uri")) {
            const std::string &uri = list[i]["uri"].get_ref<const std::string &>();
            if (is_data_uri(uri)) {
                buffer.owned = decode_data_uri(uri, what.c_str());
            } else {
                read_buffer_file(import, buffer, uri, what.c_str());
            }
            buffer.data = buffer.owned.data();
            buffer.size = buffer.owned.size();
        } else if (i == 0 && bin.data) {
            buffer.data = bin.data;
            buffer.size = bin.size;
        } else {
            import_fail("%s has no uri, and the file has no binary chunk for it", what.c_str());
        }
        if (buffer.size < length) {
            import_fail("%s.byteLength is %llu, but its data has %zu bytes", what.c_str(),
                        (unsigned long long)length, buffer.size);
        }
        buffer.size = length; // the rest is padding
        import.buffer_bytes += length;
        if (import.buffer_bytes > FILE_MAX_BYTES) {
            import_fail("the buffers exceed %llu bytes together", FILE_MAX_BYTES);
        }
    }
}

void gltf_read_document(gltf_import &import, const uint8_t *bytes, size_t size)
{
    byte_range text = {bytes, size};
    byte_range bin;
    if (size == 0) {
        import_fail("the file is empty");
    }
    if (size >= 4 && memcmp(bytes, "glTF", 4) == 0) {
        split_glb(bytes, size, &text, &bin);
    }
    import.json = parse_json(text);
    gltf_check_json(import.json);
    gltf_check_extensions(import);
    read_buffers(import, bin);
    for (json &buffer : import.json["buffers"]) {
        buffer.erase("uri"); // may be large, and has been read
    }
}

// Sets the location of the image's bytes in `request`; `owned` keeps those of data URIs.
static void locate_image(gltf_import &import, const json &image, uint32_t index,
                         image_request &request, std::string &path, std::vector<uint8_t> &owned)
{
    std::string what = "images[" + std::to_string(index) + "]";
    if (image.contains("bufferView")) {
        const json &view = import.json["bufferViews"][image["bufferView"].get<size_t>()];
        const gltf_buffer &buffer = import.buffers[view["buffer"].get<size_t>()];
        request.bytes = buffer.data + view.value("byteOffset", (uint64_t)0);
        request.size = view["byteLength"].get<size_t>();
    } else if (image.contains("uri")) {
        const std::string &uri = image["uri"].get_ref<const std::string &>();
        if (!is_data_uri(uri)) {
            path = resolve_uri(import, uri, what.c_str());
            request.key.path = path.c_str();
            return;
        }
        owned = decode_data_uri(uri, what.c_str());
        owned.push_back(0); // never empty, so that `bytes` is not NULL
        request.bytes = owned.data();
        request.size = owned.size() - 1;
    } else {
        import_fail("%s has neither uri nor bufferView", what.c_str());
    }
    if (!import.path.empty()) {
        request.key = {import.path.c_str(), import.stamp, index};
    }
}

// Images that textures use; KTX2 and WebP alternatives are in extensions of these names.
static std::vector<bool> find_used_images(const gltf_import &import, size_t count)
{
    std::vector<bool> used(count);
    for (const tinygltf::Texture &texture : import.model.textures) {
        auto webp = texture.extensions.find("EXT_texture_webp");
        int source = texture.source;
        if (source < 0 && webp != texture.extensions.end()) {
            source = webp->second.Get("source").GetNumberAsInt();
        }
        if (source >= 0) {
            used[(size_t)source] = true;
        }
    }
    return used;
}

static void keep_images(gltf_import &import, std::vector<image_request> &requests)
{
    for (size_t i = 0; i < requests.size(); i++) {
        image_request &request = requests[i];
        if (request.image) {
            import.image_ids[i] = scene_add_image(import.scene, request.image);
            image_release(&request.image);
        } else if (request.error.message[0]) {
            import.scene->missing_image_count++;
            scene_add_warning(import.scene, "images[%zu] is left out: %s", i,
                              request.error.message);
        }
        if (request.key.path && !request.bytes) {
            scene_add_source_file(import.scene, request.key.path);
        }
    }
}

void gltf_read_images(gltf_import &import)
{
    const json list = import.json.value("images", json::array());
    std::vector<bool> used = find_used_images(import, list.size());
    std::vector<image_request> requests(list.size());
    std::vector<std::string> paths(list.size());
    std::vector<std::vector<uint8_t>> owned(list.size());
    std::vector<image_request> wanted;
    std::vector<size_t> wanted_index;
    import.image_ids.assign(list.size(), SCENE_NONE);
    for (size_t i = 0; i < list.size(); i++) {
        if (!used[i]) {
            continue;
        }
        try {
            locate_image(import, list[i], (uint32_t)i, requests[i], paths[i], owned[i]);
            wanted.push_back(requests[i]);
            wanted_index.push_back(i);
        } catch (const import_failure &failure) {
            error_set(&requests[i].error, "%s", failure.what());
        }
    }
    image_batch_load(wanted.data(), (uint32_t)wanted.size());
    for (size_t i = 0; i < wanted.size(); i++) {
        requests[wanted_index[i]] = wanted[i];
    }
    keep_images(import, requests);
}
