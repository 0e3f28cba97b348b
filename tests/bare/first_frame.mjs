// A client on another machine than the daemon's: connects, and prints the seconds until the first
// frame has come. Fails unless the frame is an image and /readyz says ready. With --page, a browser
// that opens the page must show an image, too.
// Run: node tests/bare/first_frame.mjs http://127.0.0.1:8080/ [--page]
import assert from 'node:assert/strict';

import { openBrowser } from '../web/browser.mjs';
import { Client, sleep } from '../web/client.mjs';

async function firstFrame(http) {
  const client = await Client.open(http.replace(/^http/, 'ws'));
  await client.call('session.hello', {});
  const frame = await client.until(() => client.frames[0], 'the first frame');
  assert.ok(frame.width > 0 && frame.height > 0);
  assert.equal(frame.jpeg.readUInt16BE(0), 0xffd8, 'the frame is a JPEG picture');
  await client.close();
}

async function checkPage(http) {
  const { page, close } = await openBrowser();
  const problems = [];
  page.on('pageerror', (error) => problems.push(error.message));
  page.on('requestfailed', (request) => problems.push(`${request.url()} was not loaded`));
  page.on(
    'response',
    (response) => response.ok() || problems.push(`${response.url()}: ${response.status()}`),
  );
  try {
    await page.goto(http);
    await page.locator('#stage[data-frame]').waitFor();
    assert.deepEqual(problems, []);
  } finally {
    await close();
  }
}

const [http, ...options] = process.argv.slice(2);
const began = performance.now();
await firstFrame(http);
const seconds = (performance.now() - began) / 1000;
let ready = {};
for (let i = 0; i < 100 && !ready.ready; i++) {
  ready = await (await fetch(new URL('readyz', http))).json();
  if (!ready.ready) await sleep(100);
}
assert.ok(ready.ready, '/readyz says ready');
if (options.includes('--page')) await checkPage(http);
console.log(seconds.toFixed(2));
process.exit(0);
