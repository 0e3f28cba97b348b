// Well-known shapes for the built-in scenes.
#ifndef VOXCAST_RENDERER_IMPORT_BUILTIN_BUILTIN_SHAPES_H
#define VOXCAST_RENDERER_IMPORT_BUILTIN_BUILTIN_SHAPES_H

#include "renderer/import/builtin/mesh_builder.h"

// The Utah teapot: 6.5 x 3.15 x 4 units times `scale`, standing on y = 0 with its spout towards +X.
// Spout and lid gap are open, as Newell left them: use a double-sided material. Each of its 32
// patches becomes divisions x divisions quads.
void mesh_builder_add_teapot(struct mesh_builder *builder, float scale, uint32_t divisions);

#endif
