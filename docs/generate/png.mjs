// Images of 3 bytes a pixel, as PNG files: enough of the format for what voxcast writes.
import { readFileSync, writeFileSync } from 'node:fs';
import { crc32 as zlibCrc32, deflateSync, inflateSync } from 'node:zlib';

/** @typedef {{ width: number, height: number, rgb: Uint8Array }} Picture row 0 is the top */

const SIGNATURE = Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]);
const CHANNELS = /** @type {Record<number, number>} */ ({ 2: 3, 6: 4 }); // by colour type

/** @param {number} width @param {number} height @returns {Picture} black */
export const makePicture = (width, height) => ({
  width,
  height,
  rgb: new Uint8Array(3 * width * height),
});

/** Paeth's predictor: of left, above and above left the one nearest to their plane. */
function paeth(a, b, c) {
  const [pa, pb, pc] = [Math.abs(b - c), Math.abs(a - c), Math.abs(a + b - 2 * c)];
  return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
}

/** What the five filters of PNG foretell of a byte by those left, above and above left. */
const PREDICTORS = [() => 0, (a) => a, (_a, b) => b, (a, b) => (a + b) >> 1, paeth];

/** @param {string} path @returns {Picture} alpha is dropped */
export function readPng(path) {
  const file = readFileSync(path);
  if (!file.subarray(0, 8).equals(SIGNATURE)) throw new Error(`${path} is no PNG file`);
  const data = [];
  let header;
  for (let at = 8; at < file.length; ) {
    const length = file.readUInt32BE(at);
    const type = file.toString('latin1', at + 4, at + 8);
    const body = file.subarray(at + 8, at + 8 + length);
    if (type === 'IHDR') header = body;
    if (type === 'IDAT') data.push(body);
    at += 12 + length;
  }
  const channels = header && CHANNELS[header[9]];
  if (!channels || header[8] !== 8 || header[12] !== 0)
    throw new Error(`${path}: only plain PNG files of 8 bits and 3 or 4 channels are read`);
  const picture = makePicture(header.readUInt32BE(0), header.readUInt32BE(4));
  unfilter(inflateSync(Buffer.concat(data)), picture, channels);
  return picture;
}

function unfilter(bytes, { width, height, rgb }, channels) {
  const row = width * channels;
  let above = new Uint8Array(row);
  for (let y = 0; y < height; y++) {
    const at = y * (row + 1);
    const predict = PREDICTORS[bytes[at]];
    const line = new Uint8Array(row);
    for (let i = 0; i < row; i++) {
      const [a, c] = i < channels ? [0, 0] : [line[i - channels], above[i - channels]];
      line[i] = bytes[at + 1 + i] + predict(a, above[i], c);
    }
    for (let x = 0; x < width; x++)
      for (let k = 0; k < 3; k++) rgb[3 * (y * width + x) + k] = line[x * channels + k];
    above = line;
  }
}

/** Each row by the filter that leaves the least, as libpng chooses it. */
function filter({ width, height, rgb }) {
  const row = 3 * width;
  const out = Buffer.alloc(height * (row + 1));
  for (let y = 0; y < height; y++) {
    const at = y * row;
    let minSum = Infinity;
    for (const [kind, predict] of PREDICTORS.entries()) {
      const line = new Uint8Array(row);
      let sum = 0;
      for (let i = 0; i < row; i++) {
        const a = i < 3 ? 0 : rgb[at + i - 3];
        const b = y === 0 ? 0 : rgb[at + i - row];
        const c = i < 3 || y === 0 ? 0 : rgb[at + i - row - 3];
        line[i] = rgb[at + i] - predict(a, b, c);
        sum += Math.min(line[i], 256 - line[i]);
      }
      if (sum >= minSum) continue;
      minSum = sum;
      out[y * (row + 1)] = kind;
      out.set(line, y * (row + 1) + 1);
    }
  }
  return out;
}

function chunk(type, body) {
  const out = Buffer.alloc(12 + body.length);
  out.writeUInt32BE(body.length, 0);
  out.write(type, 4, 'latin1');
  body.copy(out, 8);
  out.writeUInt32BE(crc32(out.subarray(4, 8 + body.length)), 8 + body.length);
  return out;
}

/** Node 18, Debian 12's, has none. */
function crc32(bytes) {
  if (zlibCrc32) return zlibCrc32(bytes);
  let crc = ~0;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; bit++) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc >>> 0;
}

/** @param {string} path @param {Picture} picture */
export function writePng(path, picture) {
  const header = Buffer.alloc(13);
  header.writeUInt32BE(picture.width, 0);
  header.writeUInt32BE(picture.height, 4);
  header.set([8, 2, 0, 0, 0], 8);
  const data = deflateSync(filter(picture), { level: 9 });
  writeFileSync(
    path,
    Buffer.concat([
      SIGNATURE,
      chunk('IHDR', header),
      chunk('IDAT', data),
      chunk('IEND', Buffer.alloc(0)),
    ]),
  );
}

/** A part of an image. @param {Picture} picture @returns {Picture} */
export function cropped(picture, { x, y, width, height }) {
  const out = makePicture(width, height);
  for (let row = 0; row < height; row++) {
    const from = 3 * ((y + row) * picture.width + x);
    out.rgb.set(picture.rgb.subarray(from, from + 3 * width), 3 * row * width);
  }
  return out;
}

/**
 * Made `width` wide: pixels are means where it becomes smaller, and repeated where it grows.
 * @returns {Picture}
 */
export function resized(picture, width) {
  const step = picture.width / width;
  const out = makePicture(width, Math.max(1, Math.round(picture.height / step)));
  const span = (at, max) => {
    const first = Math.min(Math.floor(at * step), max - 1);
    return [first, Math.min(Math.max(first + 1, Math.floor((at + 1) * step)), max)];
  };
  for (let y = 0; y < out.height; y++)
    for (let x = 0; x < out.width; x++) {
      const [left, right] = span(x, picture.width);
      const [top, bottom] = span(y, picture.height);
      for (let k = 0; k < 3; k++) {
        let sum = 0;
        for (let j = top; j < bottom; j++)
          for (let i = left; i < right; i++) sum += picture.rgb[3 * (j * picture.width + i) + k];
        out.rgb[3 * (y * out.width + x) + k] = Math.round(sum / ((right - left) * (bottom - top)));
      }
    }
  return out;
}

/** Rows of images of one size, with gaps. @param {Picture[][]} rows @returns {Picture} */
export function tiled(rows, gap = 4) {
  const [{ width, height }] = rows[0];
  const columns = Math.max(...rows.map((row) => row.length));
  const out = makePicture(columns * (width + gap) - gap, rows.length * (height + gap) - gap);
  out.rgb.fill(128);
  rows.forEach((row, j) =>
    row.forEach((picture, i) => {
      for (let y = 0; y < height; y++) {
        const to = 3 * ((j * (height + gap) + y) * out.width + i * (width + gap));
        out.rgb.set(picture.rgb.subarray(3 * y * width, 3 * (y + 1) * width), to);
      }
    }),
  );
  return out;
}
