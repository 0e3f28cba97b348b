// Finds and reads files named by a scene file, confined to the scene file's folder.
#ifndef VOXCAST_RENDERER_IMAGE_FILE_ACCESS_H
#define VOXCAST_RENDERER_IMAGE_FILE_ACCESS_H

#include <stddef.h>
#include <stdint.h>

#include "renderer/error.h"

#define FILE_MAX_BYTES (1024ull << 20) // of what importers read

// Identifies a file's content without reading it.
struct asset_stamp {
    uint64_t size_bytes;
    int64_t modified_ns; // since the epoch
};

// Canonical path of `reference` as named by a scene in the canonical folder `folder`. Refuses
// absolute paths, schemes, backslashes, control characters and anything that leaves the folder,
// including through symbolic links. The caller frees the result; NULL with a message on failure.
char *asset_path_resolve(const char *folder, const char *reference, struct error *out_error);

// Decodes %XX in `uri` in place. False for a malformed escape or an escaped NUL.
bool asset_path_decode_percent(char *uri);

// Canonical folder of a canonical file path. The caller frees it; NULL when out of memory.
char *asset_path_folder(const char *path);

// Reads a regular file of at most `max_bytes`, and appends a zero byte that `out_size` does not
// count. The caller frees *out_bytes. `out_stamp` may be NULL. On failure outputs are unchanged.
// Blocks on disk; any thread.
bool asset_read_file(const char *path, uint64_t max_bytes, uint8_t **out_bytes, size_t *out_size,
                     struct asset_stamp *out_stamp, struct error *out_error);

// Size and time of a regular file. False, with the output unchanged, if there is none.
bool asset_read_stamp(const char *path, struct asset_stamp *out_stamp);

#endif
