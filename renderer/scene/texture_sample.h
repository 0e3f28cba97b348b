// Looks a scene's textures up on the CPU.
#ifndef VOXCAST_RENDERER_SCENE_TEXTURE_SAMPLE_H
#define VOXCAST_RENDERER_SCENE_TEXTURE_SAMPLE_H

#include "renderer/scene/scene.h"

// Bilinear sample (or nearest, if the texture says so) at the vertices' `uv`, with the texture's
// transform and wrap modes: four values 0..1 as stored, sRGB not decoded. White without an
// image, and where nobody has pinned it.
// Any thread, as long as nobody edits the scene.
void texture_sample(const struct scene *scene, const struct scene_texture *texture,
                    const float uv[2], float out_rgba[4]);

#endif
