// Looks a scene's textures up on the CPU.
#ifndef VOXCAST_RENDERER_SCENE_TEXTURE_SAMPLE_H
#define VOXCAST_RENDERER_SCENE_TEXTURE_SAMPLE_H

#include "renderer/scene/scene.h"

// The bilinear sample (nearest, if the texture says so) at `uv` as the vertices give it, with the
// texture's transform and wrapping applied: four values 0..1 as stored, sRGB not decoded. White
// where there is no picture. Any thread, as long as nobody edits the scene.
void texture_sample(const struct scene *scene, const struct scene_texture *texture,
                    const float uv[2], float out_rgba[4]);

#endif
