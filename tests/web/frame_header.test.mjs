// Proves that the client reads a frame's header as PROTOCOL.md describes it: the table of fields is
// read from that page, a header is written from the table with a different value in each field, and
// the parser must find each value under its name.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';

import { parseFrameHeader } from '../../web_client/net/frame_header.js';

const page = readFileSync(new URL('../../protocol/PROTOCOL.md', import.meta.url), 'utf8');
const HEADER_BYTES = 104;
const JPEG_BYTES = 7;

/** Rows of the page's table: offset, type and name. */
const rows = [...page.matchAll(/^\| (\d+) \| (u8|u16|u32|u64|f32) \| (\w+) \|/gm)].map(
  ([, offset, type, name]) => ({ offset: Number(offset), type, name }),
);

const WRITERS = {
  u8: (view, at, value) => view.setUint8(at, value),
  u16: (view, at, value) => view.setUint16(at, value, true),
  u32: (view, at, value) => view.setUint32(at, value, true),
  u64: (view, at, value) => view.setBigUint64(at, BigInt(value), true),
  f32: (view, at, value) => view.setFloat32(at, value, true),
};

const camel = (name) => name.replace(/_(\w)/g, (_, letter) => letter.toUpperCase());

function makeFrame() {
  const buffer = new ArrayBuffer(HEADER_BYTES + JPEG_BYTES);
  const view = new DataView(buffer);
  const values = {};
  new Uint8Array(buffer).set(new TextEncoder().encode('VXF1'));
  for (const { offset, type, name } of rows) {
    values[name] = type === 'u64' ? 2 ** 40 + offset : offset + 1;
    if (name === 'header_size') values[name] = HEADER_BYTES;
    if (name === 'jpeg_bytes') values[name] = JPEG_BYTES;
    WRITERS[type](view, offset, values[name]);
  }
  return { buffer, values };
}

test('reads every field of the documented table', () => {
  assert.ok(rows.length > 15, 'the table is not where this test looks for it');
  const { buffer, values } = makeFrame();
  const header = parseFrameHeader(buffer);
  for (const { name } of rows) {
    if (name === 'flags' || name === 'reserved') continue;
    const key = name === 'header_size' ? 'headerBytes' : camel(name);
    assert.equal(header[key], values[name], name);
  }
  assert.equal(header.converged, (values.flags & 1) !== 0);
});

test('refuses what is not a whole frame', () => {
  const { buffer } = makeFrame();
  assert.equal(parseFrameHeader(buffer.slice(0, 50)), null, 'short');
  assert.equal(parseFrameHeader(buffer.slice(0, HEADER_BYTES + JPEG_BYTES - 1)), null, 'cut off');
  new Uint8Array(buffer)[0] = 0;
  assert.equal(parseFrameHeader(buffer), null, 'magic');
});

test('skips header fields that it does not know', () => {
  const { buffer } = makeFrame();
  const longer = new ArrayBuffer(buffer.byteLength + 16);
  new Uint8Array(longer).set(new Uint8Array(buffer));
  new DataView(longer).setUint16(4, HEADER_BYTES + 16, true);
  assert.equal(parseFrameHeader(longer).headerBytes, HEADER_BYTES + 16);
});
