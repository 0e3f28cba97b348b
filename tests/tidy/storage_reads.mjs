// A storage block that a shader reads costs twenty times a texel of a buffer texture on llvmpipe,
// whose loads loop over the lanes. So shaders only write storage blocks, but for those listed here.

/** @typedef {import('./files.mjs').SourceFile} SourceFile */

/**
 * Blocks that are read, too, by file, each with the reason.
 * @type {Record<string, Record<string, string>>}
 */
export const READ_BLOCKS = {
  'shaders/debug/finite_check.comp': {
    check_storage: 'its own figures, at one address',
    checked_storage: 'any buffer of the product, when somebody asks for the check',
  },
  'shaders/gi/cache_select.comp': {
    voxel_counter_storage: 'atomics; lengths at one address, before any condition',
    queue_storage: 'atomics give the place; only written',
  },
  'shaders/gi/cache_smooth.comp': {
    voxel_counter_storage: 'a length at one address, before any condition',
  },
  'shaders/gi/cache_trace.comp': {
    voxel_counter_storage: 'atomics; lengths at one address, before any condition',
  },
  'shaders/gi/indirect_specular.comp': {
    tile_storage: 'at the number of the group, before any condition',
  },
  'shaders/gi/ray_specular.comp': {
    tile_storage: 'at the number of the group, before any condition',
  },
  'shaders/gi/specular_tiles.comp': { tile_storage: 'atomics' },
  'shaders/lib/fragments.glsl': { fragment_storage: 'atomics' },
  'shaders/lib/voxel_faces.glsl': {
    voxel_counter_storage: 'atomics',
    voxel_free_storage: 'a record that an atomic has taken from the free list',
  },
  'shaders/lib/voxel_surfels.glsl': {
    voxel_index_storage: 'atomics: lists grow while others walk them',
    surfel_storage: 'atomics: lists grow while others walk them',
  },
  'shaders/lib/voxel_work.glsl': {
    voxel_counter_storage: 'atomics',
    voxel_free_storage: 'an entry that an atomic has taken from the free list',
  },
  'shaders/post/exposure.comp': { exposure_storage: 'atomics; one invocation takes the mean' },
  'shaders/voxel/voxel_inject_bounce.comp': {
    voxel_counter_storage: 'a length at one address, before any condition',
  },
  'shaders/voxel/voxel_lists.comp': { voxel_list_storage: 'atomics' },
  'shaders/voxel/voxelize.comp': { tile_storage: 'at the number of the group' },
};

const BLOCK = /layout\s*\(\s*std430[^)]*\)([^;{]*)\bbuffer\s+(\w+)/g;

/**
 * @param {SourceFile[]} shaders
 * @returns {{ path: string, block: string }[]} storage blocks that are not writeonly
 */
export function findReadBlocks(shaders) {
  return shaders.flatMap(({ path, text }) =>
    [...text.matchAll(BLOCK)]
      .filter(([, qualifiers]) => !/\bwriteonly\b/.test(qualifiers))
      .map(([, , block]) => ({ path, block })),
  );
}

/**
 * @param {{ path: string, block: string }[]} found
 * @param {Record<string, Record<string, string>>} listed
 * @returns {string[]} what is wrong
 */
export function judgeReadBlocks(found, listed) {
  const unlisted = found
    .filter(({ path, block }) => !listed[path]?.[block])
    .map(
      ({ path, block }) =>
        `${path}: ${block} is not writeonly: read it by a buffer texture instead`,
    );
  const stale = Object.entries(listed).flatMap(([path, blocks]) =>
    Object.keys(blocks)
      .filter((block) => !found.some((it) => it.path === path && it.block === block))
      .map((block) => `${path}: ${block} is only written: take it off the list`),
  );
  return [...unlisted, ...stale];
}
