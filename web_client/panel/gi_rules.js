/** @typedef {Record<string, any>} Values of the group settings */

const needsMethod = (/** @type {Values} */ { gi_method }) => (gi_method === 'none' ? 'needs a method' : '');

const needsVoxels = (/** @type {Values} */ values) =>
  needsMethod(values) || (values.gi_method === 'reference' ? 'voxels only' : '');

const onlyFor = (/** @type {string} */ method) => (/** @type {Values} */ values) =>
  needsMethod(values) || (values.gi_method === method ? '' : `${method} only`);

/**
 * The settings of global illumination, and why each has no effect beside the others; "" if it has.
 * @type {Record<string, (values: Values) => string>}
 */
const RULES = {
  gi_method: () => '',
  voxel_resolution: needsVoxels,
  voxel_directions: needsVoxels,
  clip_levels: onlyFor('clipmap'),
  levels_per_frame: onlyFor('clipmap'),
  voxelize_every_frame: onlyFor('grid'),
  cone_set: needsVoxels,
  cone_step: needsVoxels,
  gather_mode: needsVoxels,
  bounces: needsMethod,
  indirect_intensity: needsVoxels,
  ambient_occlusion: needsVoxels,
  soft_shadows: needsVoxels,
  indirect_specular: needsVoxels,
  refraction: needsVoxels,
  environment_light: needsVoxels,
};

/** Whether a setting is one of global illumination. @param {string} name */
export const isGiSetting = (name) => name in RULES;

/** Why a setting has no effect now; "" if it has. @param {string} name @param {Values} values */
export const whyGiSettingRests = (name, values) => RULES[name]?.(values) ?? '';

/**
 * Why an option of the view has no effect beside the others; "" if it has.
 * @param {string} name @param {Record<string, any>} options of the group view
 */
export function whyViewOptionRests(name, { adaptive, debug_view }) {
  if (name === 'target_frame_ms' && !adaptive) return 'adaptive only';
  const showsVoxels = /^voxel_/.test(debug_view ?? '');
  if ((name === 'debug_level' || name === 'debug_face') && !showsVoxels) return 'voxel views only';
  return '';
}
