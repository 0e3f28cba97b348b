// Proves what the client does when the server goes away, refuses a token or refuses a foreign page:
// the test stops and starts daemons under a running Chromium, and speaks to them with the ws
// package.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';

import { difference, openBrowser, openClient, pixels, untilAtRest } from './browser.mjs';
import { Client, PATIENCE_MS, startDaemon, stopDaemon } from './client.mjs';

describe('a server that goes away', () => {
  let daemon, browser;
  before(async () => {
    daemon = await startDaemon(['--scene', 'builtin:cornell']);
    browser = await openBrowser();
  });
  after(async () => {
    await browser?.close();
    await stopDaemon(daemon);
  });

  test('is found again, with the image from the same camera', async () => {
    const { page } = browser;
    await openClient(page, daemon);
    await page.mouse.move(500, 400);
    await page.mouse.down();
    await page.mouse.move(600, 400, { steps: 5 });
    await page.mouse.up();
    await untilAtRest(page);
    const turned = await pixels(page);
    await page.locator('#tab-light').click();
    await page.locator('[data-add-light=point]').click();
    await page.locator('[data-light]').waitFor();
    await stopDaemon(daemon);
    const state = page.locator('#connection');
    await page.waitForFunction(
      () => document.getElementById('connection').dataset.state !== 'open',
    );
    daemon = await startDaemon(['--scene', 'builtin:cornell', '--port', String(daemon.port)]);
    await page.locator('#connection[data-state=open]').waitFor();
    assert.equal(await state.innerText(), 'Connected');
    // As openClient() does: the new server has indirect light again.
    await page.evaluate(() =>
      globalThis.voxcast.connection.call('settings.update', { set: { gi_method: 'none' } }),
    );
    await untilAtRest(page, 1000);
    assert.equal(await page.locator('[data-light]').count(), 0, 'the new server has no such light');
    // Nothing shows which image at rest is the first without indirect light.
    for (
      const end = Date.now() + PATIENCE_MS;
      difference(turned, await pixels(page)) >= 1;
      await untilAtRest(page, 1000)
    )
      assert.ok(Date.now() < end, 'the camera stays where it was');
  });
});

describe('a server with a token', () => {
  let daemon, browser, folder;
  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'voxcast-token-'));
    const file = join(folder, 'token');
    writeFileSync(file, 'open sesame\n', { mode: 0o600 });
    daemon = await startDaemon(['--scene', 'builtin:cornell', '--token-file', file]);
    browser = await openBrowser();
  });
  after(async () => {
    await browser?.close();
    await stopDaemon(daemon);
    rmSync(folder, { recursive: true });
  });

  test('asks for it, refuses a wrong one and takes the right one', async () => {
    const { page } = browser;
    await page.goto(`${daemon.http}/?token=wrong`);
    const dialog = page.locator('#token-dialog[open]');
    await dialog.waitFor();
    assert.match(await dialog.innerText(), /refused/);
    assert.doesNotMatch(page.url(), /token/);
    assert.equal(await page.locator('#stage[data-frame]').count(), 0);
    await dialog.locator('input').fill('also wrong');
    await dialog.locator('button').click();
    await dialog.waitFor();
    await dialog.locator('input').fill('open sesame');
    await dialog.locator('button').click();
    await page.locator('#stage[data-frame]').waitFor();
    await page.reload();
    await page.locator('#stage[data-frame]').waitFor();
    assert.equal(await dialog.count(), 0, 'kept for this tab');
  });

  test('refuses a page from elsewhere', async () => {
    await assert.rejects(Client.open(daemon.url, { origin: 'http://elsewhere.example' }), {
      status: 403,
    });
    const client = await Client.open(daemon.url, { origin: daemon.http });
    await client.close();
  });
});
