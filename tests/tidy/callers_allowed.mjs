// Functions that only tests call, each with the reason for keeping it. The list may only shrink.

/** @type {Record<string, string>} */
export const CALLED_BY_TESTS = {
  frame_header_decode: 'reads back what frame_header_encode() has written',
  parameter_write_markdown_row:
    'a row of PROTOCOL.md, which is compared with the table of parameters',
  voxel_box_contains: 'whether one box of voxels holds another, as regions must',
  gpu_program_find_member: 'offsets of blocks as the driver has them, which C must share',
  gpu_texture_read: 'looks into textures that no pass reads back',
  gpu_texture_size_bytes: 'the length of what gpu_texture_read() gives',
  sampler_get_2d: 'one path at a time: what sampler_batch.c must equal for many',
  asset_cache_set_budget: 'fills the cache by few small pictures',
  asset_cache_get_statistics: 'shows hits, which a result does not tell from misses',
};
