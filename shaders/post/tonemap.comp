// Radiance to output pixels. In: radiance, exposure. Out, by OUTPUT:
//   0: planar full-range YCbCr 4:2:0 (ITU-R BT.601 as JFIF has it); an invocation does 8 x 2 pixels
//   1: RGBA8, 2: four floats, linear and unexposed; an invocation does 1 pixel
// SCALED: bilinearly from the rendered size to the output's. DISPLAY_READY: shows values as
// they are (debug views). BLANK: plain grey, for debug views that have nothing to show.
// TONE_CURVE and POWER_TRANSFER: see lib/display.glsl.
#include "lib/display.glsl"
#include "lib/radiance_buffer.glsl"
#include "shared/display.h"

layout(local_size_x = PIXEL_GROUP_WIDTH, local_size_y = PIXEL_GROUP_HEIGHT) in;

layout(std430, binding = BIND_OUTPUT) writeonly buffer output_storage
{
#if OUTPUT == OUTPUT_LINEAR
    vec4 pixels[]; // a CPU driver stores a vector in half the time of its words
#else
    uint words[];
#endif
};

layout(binding = UNIT_EXPOSURE) uniform usamplerBuffer exposure_words; // the first is the scale

vec3 radiance_at(uvec2 shown)
{
#if BLANK
    return vec3(0.5);
#elif SCALED
    vec2 size = vec2(frame.render_size);
    vec2 at =
        clamp((vec2(shown) + 0.5) * size / vec2(frame.output_size) - 0.5, vec2(0.0), size - 1.0);
    uvec2 low = uvec2(at);
    uvec2 high = min(low + 1u, frame.render_size - 1u);
    vec2 part = at - vec2(low);
    vec3 top = mix(former_radiance(low.y * frame.render_size.x + low.x),
                   former_radiance(low.y * frame.render_size.x + high.x), part.x);
    vec3 bottom = mix(former_radiance(high.y * frame.render_size.x + low.x),
                      former_radiance(high.y * frame.render_size.x + high.x), part.x);
    return mix(top, bottom, part.y);
#else
    return former_radiance(shown.y * frame.render_size.x + shown.x);
#endif
}

vec3 displayed(uvec2 shown)
{
    vec3 color = radiance_at(min(shown, frame.output_size - 1u));
#if DISPLAY_READY
    return clamp(color, 0.0, 1.0);
#else
    float automatic = uintBitsToFloat(texelFetch(exposure_words, 0).x) * frame.exposure_bias;
    float scale = frame.exposure_scale > 0.0 ? frame.exposure_scale : automatic;
    return transfer(tonemap(max(color, 0.0) * scale));
#endif
}

#if OUTPUT == OUTPUT_YCBCR
uint pack4(vec4 bytes)
{
    uvec4 b = uvec4(clamp(bytes, 0.0, 255.0) + 0.5);
    return b.x | (b.y << 8) | (b.z << 16) | (b.w << 24);
}

void main()
{
    uvec2 block = gl_GlobalInvocationID.xy;
    uvec2 first = block * uvec2(8u, 2u);
    if (any(greaterThanEqual(first, frame.output_size)))
        return;
    vec4 cb, cr;
    vec4 luma[4]; // two words for each of two rows
    uint i = 0u;
    do {
        vec3 sum = vec3(0.0);
        uint j = 0u;
        do {
            uint x = 2u * i + (j & 1u);
            uint row = j >> 1;
            vec3 rgb = displayed(first + uvec2(x, row)) * 255.0;
            sum += rgb;
            luma[2u * row + (x >> 2)][x & 3u] = dot(rgb, vec3(0.299, 0.587, 0.114));
        } while (++j < 4u);
        sum *= 0.25;
        cb[i] = dot(sum, vec3(-0.168735892, -0.331264108, 0.5)) + 128.0;
        cr[i] = dot(sum, vec3(0.5, -0.418687589, -0.081312411)) + 128.0;
    } while (++i < 4u);
    uint pitch = frame.luma_pitch_bytes / 4u;
    uint chroma_pitch = frame.chroma_pitch_bytes / 4u;
    uint rows = (frame.output_size.y + 1u) & ~1u;
    uint at = first.y * pitch + block.x * 2u;
    words[at] = pack4(luma[0]);
    words[at + 1u] = pack4(luma[1]);
    words[at + pitch] = pack4(luma[2]);
    words[at + pitch + 1u] = pack4(luma[3]);
    uint chroma = rows * pitch + block.y * chroma_pitch + block.x;
    words[chroma] = pack4(cb);
    words[chroma + (rows / 2u) * chroma_pitch] = pack4(cr);
}
#else
void main()
{
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, frame.output_size)))
        return;
    uint at = pixel.y * frame.output_size.x + pixel.x;
#if OUTPUT == OUTPUT_RGBA8
    words[at] = packUnorm4x8(vec4(displayed(pixel), 1.0));
#else
    pixels[at] = vec4(radiance_at(pixel), 1.0);
#endif
}
#endif
