// Measures edit to photon in Chromium on this machine: opens the client at 640 by 360, drags the
// intensity of a light step by step, and takes the time from each edit to the animation frame after
// the image that shows it. Prints JSON; stops by itself.
// Run: VOXCASTD=build/release/bin/voxcastd node tests/load/edit_to_photon.mjs [--edits 50]
import { parseArgs } from 'node:util';

import { openBrowser, openClient } from '../web/browser.mjs';
import { startDaemon, stopDaemon } from '../web/client.mjs';

const MAX_EDITS = 500;
const WARM_UP = 5;
const STAGE = { width: 640, height: 360 };
const LONGEST_MS = 60000;

const { values } = parseArgs({
  options: {
    edits: { type: 'string', default: '50' },
    scene: { type: 'string', default: 'builtin:cornell' },
  },
});
const edits = Math.min(Number(values.edits), MAX_EDITS);

const timeout = setTimeout(() => {
  console.error(`not done in ${LONGEST_MS} ms`);
  process.exit(1);
}, LONGEST_MS);

/** Runs in the page: makes the edits one after the other. */
async function measure(count) {
  const app = globalThis.voxcast;
  const light = app.document.data.lights[0];
  const frame = () => new Promise((resolve) => requestAnimationFrame(resolve));
  const parts = [];
  app.picture.addEventListener('presented', ({ detail: { header, decodeMs } }) =>
    parts.push({
      draw: (header.drawUs + header.readbackUs) / 1000,
      encode: header.encodeUs / 1000,
      decode: decodeMs,
    }),
  );
  app.timer.times.length = 0;
  for (let i = 0; i < count; i++) {
    const done = app.timer.times.length;
    app.editor.update('light', light.id, { intensity: 0.5 + 0.02 * i }, true);
    while (app.timer.times.length === done) await frame();
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
  const { width, height } = app.picture.canvas;
  return { times: app.timer.times, parts, width, height };
}

const daemon = await startDaemon([values.scene]);
// The image fills what the bar leaves when the panel is closed.
const browser = await openBrowser({ width: STAGE.width, height: STAGE.height + 44 });
try {
  const { page } = browser;
  await openClient(page, daemon);
  await page.locator('#tool-panel').click();
  await page.waitForTimeout(500);
  await page.evaluate(() => globalThis.voxcast.addLight('point'));
  await page.waitForTimeout(2000);
  const { times, parts, width, height } = await page.evaluate(measure, edits + WARM_UP);
  const sorted = times.slice(WARM_UP).sort((a, b) => a - b);
  const at = (fraction) => Number(sorted[Math.floor(fraction * (sorted.length - 1))].toFixed(1));
  const median = (name) => {
    const list = parts.slice(WARM_UP).map((part) => part[name]).sort((a, b) => a - b);
    return Number(list[list.length >> 1].toFixed(1));
  };
  console.log(
    JSON.stringify({
      scene: values.scene,
      width,
      height,
      edits: sorted.length,
      edit_to_photon_ms: { median: at(0.5), p95: at(0.95), min: at(0), max: at(1) },
      median_ms: { draw: median('draw'), encode: median('encode'), decode: median('decode') },
    }),
  );
} finally {
  clearTimeout(timeout);
  await browser.close();
  await stopDaemon(daemon);
}
