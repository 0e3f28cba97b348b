// Proves that the panel offers the server's environment images if there are any, loads one, and
// says why one could not be loaded: Chromium opens the client of a daemon with a folder of small
// images.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';

import { meanColor, openBrowser, openClient, untilAtRest } from './browser.mjs';
import { startDaemon, stopDaemon } from './client.mjs';

/** A red Radiance image of 4 x 2 texels. */
const RED = Buffer.concat([
  Buffer.from('#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n'),
  ...Array.from({ length: 8 }, () => Buffer.from([200, 10, 10, 129])),
]);

describe('environment images', () => {
  let daemon, folder, browser, page;

  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'voxcast-environment-'));
    writeFileSync(join(folder, 'red.hdr'), RED);
    writeFileSync(join(folder, 'broken.hdr'), RED.subarray(0, 60));
    daemon = await startDaemon(['--scene', 'builtin:cornell', '--scene-dir', folder]);
    browser = await openBrowser();
    ({ page } = browser);
    await openClient(page, daemon);
    await page.locator('#tab-light').click();
  });
  after(async () => {
    await browser?.close();
    await stopDaemon(daemon);
    rmSync(folder, { recursive: true });
  });

  const loader = () => page.locator('.loader', { has: page.locator('#environment-image') });

  test('a loaded environment colours the image and is shown as chosen', async () => {
    assert.deepEqual(await page.locator('#environment-image option').allTextContents(), [
      'broken.hdr',
      'red.hdr',
    ]);
    const [red, green] = await meanColor(page);
    const frame = await page.locator('#stage').getAttribute('data-frame');
    await page.locator('#environment-image').selectOption('red.hdr');
    await loader().locator('button').click();
    await loader().locator('button:has-text("Reload")').waitFor();
    // Shaders may have to be compiled first.
    await page.locator(`#stage:not([data-frame="${frame}"])`).waitFor();
    await untilAtRest(page);
    const [redder, greener] = await meanColor(page);
    assert.ok(
      redder / greener > 1.2 * (red / green),
      `${red} / ${green} became ${redder} / ${greener}`,
    );
    const type = page.locator('[data-parameter="environment.type"] select');
    assert.match(
      await type.evaluate((select) => select.selectedOptions[0].textContent),
      /equirect/i,
    );
    assert.ok(await loader().locator('progress').isHidden());
  });

  test('a broken image is refused with its reason, and the former stays', async () => {
    await page.locator('#environment-image').selectOption('broken.hdr');
    await loader().locator('button').click();
    await page.getByText(/truncated or damaged/).first().waitFor();
    assert.ok(await loader().locator('button').isEnabled());
    assert.equal(
      await page.evaluate(() => globalThis.voxcast.document.data.environment.image),
      'red.hdr',
    );
  });

  test('without a folder there is no list', async () => {
    const bare = await startDaemon(['--scene', 'builtin:cornell']);
    await openClient(page, bare);
    await page.locator('#tab-light').click();
    await page.locator('[data-parameter="environment.type"]').waitFor();
    assert.ok(await loader().isHidden());
    await stopDaemon(bare);
  });
});
