/**
 * @typedef {object} FrameHeader
 * @property {number} headerBytes the image begins here
 * @property {boolean} converged
 * @property {number} codec index in the enum `view.codec`
 * @property {number} viewId
 * @property {number} jpegBytes
 * @property {number} frameId
 * @property {number} sceneRevision
 * @property {number} editId
 * @property {number} cameraRevision
 * @property {number} width
 * @property {number} height
 * @property {number} quality
 * @property {number} debugView
 * @property {number} epoch
 * @property {number} convergence
 * @property {number} queueUs
 * @property {number} drawUs
 * @property {number} readbackUs
 * @property {number} encodeUs
 * @property {number} sendWaitUs
 * @property {number} drawAtUs
 * @property {number} sentAtUs
 * @property {number} referenceSamples per pixel, of an image by the method reference; else 0
 * @property {number} referenceNoise standard error of a pixel over the mean luminance; 0: unknown
 */

const MAGIC = 0x31465856; // VXF1
const KNOWN_BYTES = 104;

/**
 * Reads the header of a binary message, as PROTOCOL.md has it; null if it is not a whole frame.
 * @param {ArrayBuffer} message
 * @returns {FrameHeader | null}
 */
export function parseFrameHeader(message) {
  const view = new DataView(message);
  if (message.byteLength < KNOWN_BYTES || view.getUint32(0, true) !== MAGIC) return null;
  const u64 = (/** @type {number} */ at) => Number(view.getBigUint64(at, true));
  const header = {
    headerBytes: view.getUint16(4, true),
    converged: (view.getUint8(6) & 1) !== 0,
    codec: view.getUint8(7),
    viewId: view.getUint32(8, true),
    jpegBytes: view.getUint32(12, true),
    frameId: u64(16),
    sceneRevision: u64(24),
    editId: u64(32),
    cameraRevision: u64(40),
    width: view.getUint16(48, true),
    height: view.getUint16(50, true),
    quality: view.getUint8(52),
    debugView: view.getUint8(53),
    epoch: view.getUint16(54, true),
    convergence: view.getFloat32(56, true),
    queueUs: view.getUint32(60, true),
    drawUs: view.getUint32(64, true),
    readbackUs: view.getUint32(68, true),
    encodeUs: view.getUint32(72, true),
    sendWaitUs: view.getUint32(76, true),
    drawAtUs: u64(80),
    sentAtUs: u64(88),
    referenceSamples: view.getUint32(96, true),
    referenceNoise: view.getFloat32(100, true),
  };
  const whole =
    header.headerBytes >= KNOWN_BYTES &&
    header.headerBytes + header.jpegBytes <= message.byteLength;
  return whole ? header : null;
}
