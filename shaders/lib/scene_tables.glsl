// The scene's small tables: records of whole texels of four words, behind one another.
#include "lib/frame.glsl"

layout(binding = UNIT_SCENE_TABLES) uniform usamplerBuffer scene_tables;

uvec4 table_words(uint texel)
{
    return texelFetch(scene_tables, int(texel));
}

vec4 table_floats(uint texel)
{
    return uintBitsToFloat(table_words(texel));
}

mat4 table_matrix(uint texel)
{
    return mat4(table_floats(texel), table_floats(texel + 1u), table_floats(texel + 2u),
                table_floats(texel + 3u));
}
