/** @param {number | null | undefined} seconds */
export function durationText(seconds) {
  if (typeof seconds !== 'number' || !Number.isFinite(seconds)) return '';
  if (seconds < 90) return `${Math.max(1, Math.round(seconds))} s`;
  if (seconds < 5400) return `${Math.round(seconds / 60)} min`;
  return `${(seconds / 3600).toFixed(1)} h`;
}

/** Milliseconds with as many digits as count. @param {number} ms */
export function msText(ms) {
  if (ms >= 10000) return `${(ms / 1000).toFixed(0)} s`;
  if (ms >= 1000) return `${(ms / 1000).toFixed(1)} s`;
  return `${ms < 10 ? ms.toFixed(1) : ms.toFixed(0)} ms`;
}

/** Of a fraction: "3.1 %". @param {number} fraction */
export const percentText = (fraction) => `${Number((100 * fraction).toPrecision(2))} %`;

/** The name of a configuration for people. @param {string} name */
export const configurationTitle = (name) => (name === 'live' ? 'own settings as measured' : name);
