// Writes the radiance texture, premultiplied by optical depth: rgb = radiance * depth / scale, a =
// optical depth across a voxel. Filtering then weights radiance by depth.
#include "lib/voxel.glsl"
#include "lib/clamp_half.glsl"

layout(binding = IMAGE_VOXEL_RADIANCE, rgba16f) uniform image3D voxel_image;

// Faces lie along X, levels along Y. In toroidal levels, a texel at the rim is repeated in the
// border on the opposite side, so that trilinear filtering reads across the seam.
void store_voxel_face(uint level, ivec3 address, uint face, vec4 value)
{
    ivec3 texels = voxels.levels[level].texel_origin;
    int edge = voxels.levels[level].edge;
    ivec3 base = texels + ivec3(voxels.levels[level].face_stride * int(face), 0, 0);
    value.rgb = clamp_to_half(value.rgb);
    imageStore(voxel_image, base + address, value);
    if (voxels.levels[level].wraps == 0u)
        return;
    ivec3 shift =
        ivec3(equal(address, ivec3(0))) * edge - ivec3(equal(address, ivec3(edge - 1))) * edge;
    uint copies = (shift.x != 0 ? 1u : 0u) | (shift.y != 0 ? 2u : 0u) | (shift.z != 0 ? 4u : 0u);
    uint subset = copies;
    if (subset == 0u)
        return;
    do {
        ivec3 chosen = ivec3(subset & 1u, (subset >> 1) & 1u, subset >> 2);
        imageStore(voxel_image, base + address + shift * chosen, value);
    } while ((subset = (subset - 1u) & copies) != 0u);
}
