// Feeds arbitrary bytes to the glTF importer and uses what it accepts. Run: fuzz_gltf corpus/gltf
#include <stddef.h>
#include <stdint.h>

#include "renderer/import/importers.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct error error;
    struct scene *scene = importer_of("fuzzed.gltf")->memory(data, size, NULL, &error);
    if (scene) {
        double box_min[3], box_max[3];
        scene_bounds(scene, box_min, box_max);
        for (uint32_t i = 0; i < scene->animation_count; i++) {
            scene_animate(scene, i, 0.5f * scene->animations[i].duration_s);
        }
        for (uint32_t i = 0; i < scene->index_count; i++) {
            if (scene->indices[i] >= scene->vertex_count) {
                __builtin_trap();
            }
        }
    }
    scene_destroy(&scene);
    return 0;
}
