// Feeds arbitrary bytes to the OBJ importer and uses what it accepts. The input's first line may be
// "#mtl N": then the N bytes after it are the material library, which is written to a folder of its
// own as m.mtl. Run: fuzz_obj corpus/obj
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/import/importers.h"

#define HEADER "#mtl "

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const char *library_folder(void)
{
    static char folder[] = "/tmp/voxcast-fuzz-XXXXXX";
    static int made;
    if (!made) {
        made = mkdtemp(folder) != NULL;
    }
    return folder;
}

// Writes the library and returns the number of bytes of `data` that it takes, header included.
static size_t write_library(const uint8_t *data, size_t size)
{
    const uint8_t *line_end = size > 0 ? memchr(data, '\n', size < 16 ? size : 16) : NULL;
    if (!line_end || memcmp(data, HEADER, strlen(HEADER)) != 0) {
        return 0;
    }
    char path[64];
    size_t header = (size_t)(line_end - data) + 1;
    size_t length = strtoul((const char *)data + strlen(HEADER), NULL, 10);
    length = length < size - header ? length : size - header;
    snprintf(path, sizeof(path), "%s/m.mtl", library_folder());
    FILE *file = fopen(path, "wb");
    if (file) {
        fwrite(data + header, 1, length, file);
        fclose(file);
    }
    return header + length;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct error error;
    size_t used = size > strlen(HEADER) ? write_library(data, size) : 0;
    struct scene *scene =
        importer_of("fuzzed.obj")->memory(data + used, size - used, library_folder(), &error);
    for (uint32_t i = 0; scene && i < scene->index_count; i++) {
        if (scene->indices[i] >= scene->vertex_count) {
            __builtin_trap();
        }
    }
    scene_destroy(&scene);
    return 0;
}
