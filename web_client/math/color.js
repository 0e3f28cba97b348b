// Linear Rec.709 components, as the protocol has them, and sRGB, as colour pickers have them.

/** @param {number} value */
export const srgbFromLinear = (value) =>
  value <= 0.0031308 ? 12.92 * value : 1.055 * value ** (1 / 2.4) - 0.055;

/** @param {number} value */
export const linearFromSrgb = (value) =>
  value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
