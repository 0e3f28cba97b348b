// By how much and where two images differ: PFM files, as voxcast writes them.

/**
 * @typedef {{ width: number, height: number, values: Float32Array }} FloatImage  RGB, from the
 * bottom row
 */
/** @typedef {{ x: number, y: number }} Position  row 0 is the top */
/**
 * @typedef {{ equal: boolean, pixels: number, differing: number, rmse: number, largest: number, at:
 * Position | null,
 *    from: Position | null, to: Position | null }} Difference  `from` and `to` bound the pixels
 *    that differ */

/** @param {Buffer} file @returns {FloatImage} */
export function readPfm(file) {
  const head = /^PF\n(\d+) (\d+)\n(-[\d.]+)\n/.exec(file.subarray(0, 64).toString('latin1'));
  if (!head) throw new Error('no PFM of three little-endian channels');
  const [width, height] = [Number(head[1]), Number(head[2])];
  const data = file.subarray(head[0].length);
  if (data.length !== width * height * 12) throw new Error('the PFM ends too early or too late');
  const values = new Float32Array(data.length / 4);
  for (let i = 0; i < values.length; i++) values[i] = data.readFloatLE(4 * i);
  return { width, height, values };
}

/** @param {FloatImage} image @param {number} pixel */
const positionOf = (image, pixel) => ({
  x: pixel % image.width,
  y: image.height - 1 - Math.floor(pixel / image.width),
});

/**
 * Not finite on one side alone counts as an infinite difference.
 * @param {number} a @param {number} b
 */
function distance(a, b) {
  if (Object.is(a, b) || a === b) return 0;
  return Number.isFinite(a - b) ? Math.abs(a - b) : Infinity;
}

/** @param {FloatImage} a @param {FloatImage} b @returns {Difference} */
export function compareImages(a, b) {
  if (a.width !== b.width || a.height !== b.height)
    throw new Error(`images of ${a.width}x${a.height} and ${b.width}x${b.height}`);
  const pixels = a.width * a.height;
  const differing = [];
  let largest = 0;
  let farthest = -1;
  let squares = 0;
  for (let pixel = 0; pixel < pixels; pixel++) {
    const distances = [0, 1, 2].map((i) =>
      distance(a.values[3 * pixel + i], b.values[3 * pixel + i]),
    );
    const apart = Math.max(...distances);
    if (apart === 0) continue;
    differing.push(positionOf(a, pixel));
    squares += distances.reduce((sum, value) => sum + value * value, 0);
    if (apart > largest) [largest, farthest] = [apart, pixel];
  }
  const bound = (choose, key) =>
    differing.reduce((value, at) => choose(value, at[key]), differing[0][key]);
  const corner = (choose) =>
    differing.length > 0 ? { x: bound(choose, 'x'), y: bound(choose, 'y') } : null;
  return {
    equal: differing.length === 0,
    pixels,
    differing: differing.length,
    rmse: Math.sqrt(squares / (3 * pixels)),
    largest,
    at: farthest >= 0 ? positionOf(a, farthest) : null,
    from: corner((p, q) => Math.min(p, q)),
    to: corner((p, q) => Math.max(p, q)),
  };
}

/** @param {Difference} difference */
export function describeDifference({ equal, pixels, differing, rmse, largest, at, from, to }) {
  if (equal) return 'equal images';
  const part = Math.max((100 * differing) / pixels, 0.01).toFixed(2);
  return (
    `images differ in ${differing} pixels (${part} %) ` +
    `within ${from.x},${from.y} to ${to.x},${to.y}: ` +
    `RMSE ${rmse.toPrecision(3)} cd/m², most ${largest.toPrecision(3)} at ${at.x},${at.y}`
  );
}
