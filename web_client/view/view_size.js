/**
 * The choices of render size: the maximum of pixels, as width times height; auto depends on the
 * server.
 */
export const RENDER_SIZES = /** @type {Record<string, [number, number] | null>} */ ({
  auto: null,
  '640 × 360': [640, 360],
  '1280 × 720': [1280, 720],
  '1920 × 1080': [1920, 1080],
});

/**
 * The size of the image to ask for: the stage's shape and at most its pixels, within the chosen
 * number of pixels and the server's limits.
 * @param {{width: number, height: number}} stage in CSS pixels
 * @param {number} pixelRatio
 * @param {string} choice of RENDER_SIZES
 * @param {{isSoftware: boolean, maxWidth: number, maxHeight: number}} server
 * @returns {{width: number, height: number}}
 */
export function chooseViewSize(stage, pixelRatio, choice, server) {
  const maxSize = RENDER_SIZES[choice] ?? (server.isSoftware ? [640, 360] : [1920, 1080]);
  const width = stage.width * pixelRatio;
  const height = stage.height * pixelRatio;
  const factor = Math.min(
    1,
    Math.sqrt((maxSize[0] * maxSize[1]) / (width * height)),
    server.maxWidth / width,
    server.maxHeight / height,
  );
  // Even sizes: JPEG stores colour at half the resolution.
  const even = (/** @type {number} */ size) => Math.max(2, 2 * Math.round((size * factor) / 2));
  return { width: even(width), height: even(height) };
}
