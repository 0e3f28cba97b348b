/** Units that end the names of parameters, and how people read them. */
const UNIT_ENDINGS = /** @type {Record<string, string>} */ ({
  _m: 'm',
  _rad: '°',
  _s: 's',
  _ms: 'ms',
  _ev: 'EV',
});

const ABBREVIATIONS = new Set(['gi', 'ggx', 'pbr', 'ior', 'fov', 'aces', 'gpu', 'jpeg']);

const SPELLINGS = /** @type {Record<string, string>} */ ({ gbuffer: 'G-buffer' });

/**
 * A parameter's label: its name in words, and its unit.
 * @param {{name: string, unit: string}} parameter
 */
export function labelOf({ name, unit }) {
  const ending = Object.keys(UNIT_ENDINGS).find((end) => name.endsWith(end));
  const words = wordsOf(ending ? name.slice(0, -ending.length) : name);
  const shown = unit === 'rad' ? '°' : unit.split(',')[0].replace('m2', 'm²');
  return shown ? `${words} (${shown})` : words;
}

/** "lights_per_tile" reads "Lights per tile". @param {string} name */
export function wordsOf(name) {
  const words = name
    .split('_')
    .map((word) => SPELLINGS[word] ?? (ABBREVIATIONS.has(word) ? word.toUpperCase() : word))
    .join(' ');
  return words.charAt(0).toUpperCase() + words.slice(1);
}
