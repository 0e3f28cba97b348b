// Proves that the render tab shows and changes how images are made: Chromium opens the client of a
// running daemon; a second client without a browser watches and edits the same settings.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import { openScene, setParameter, untilAtRest } from './browser.mjs';
import { Client } from './client.mjs';

describe('the tab of rendering', () => {
  let client, page, other;

  before(async () => {
    client = await openScene('builtin:cornell');
    ({ page } = client);
    await page.locator('#tab-render').click();
    other = await Client.open(client.daemon.url);
    await other.call('session.hello', { name: 'other' });
  });
  after(async () => {
    await other?.close();
    await client?.close();
  });

  const parameter = (name) => page.locator(`[data-parameter="${name}"]`);
  const setting = async (name) => (await other.call('scene.get')).result.settings[name];

  test('tells the quality of the image and that it is done', async () => {
    await page.evaluate(() => globalThis.voxcast.view.configure({ quality: 'final' }));
    await page.waitForFunction(() =>
      /final\s+done/.test(document.getElementById('badge').innerText),
    );
    await page.evaluate(() => {
      const badge = document.getElementById('badge');
      globalThis.seenTexts = [];
      const watcher = new MutationObserver(() => globalThis.seenTexts.push(badge.innerText));
      watcher.observe(badge, { attributes: true, subtree: true, childList: true });
    });
    await page.locator('#controls').focus();
    await page.keyboard.down('ArrowLeft');
    await page.waitForTimeout(400);
    await page.keyboard.up('ArrowLeft');
    await page.waitForFunction(() =>
      globalThis.seenTexts.some((text) => /(interactive|draft)\s+\d+ %/.test(text)),
    );
    await page.locator('#badge.done').waitFor();
  });

  test('a chosen method reaches the server, and another client changes it back', async () => {
    await parameter('settings.gi_method').locator('select').selectOption({ label: 'Clipmap' });
    await other.until(
      () => other.notifications.some((n) => n.params?.edits?.[0].set.gi_method === 'clipmap'),
      'the edit',
    );
    assert.equal(await setting('gi_method'), 'clipmap');
    await other.call('settings.update', { set: { gi_method: 'grid' } });
    await page.waitForFunction(
      () =>
        document.querySelector('[data-parameter="settings.gi_method"] .lil-display').textContent ===
        'Grid',
    );
    await parameter('settings.cone_set').locator('select').selectOption('16\u00a0');
    await setParameter(page, 'settings.bounces', 3);
    await other.until(
      () => other.notifications.some((n) => n.params?.edits?.[0].set.bounces === 3),
      'the edit',
    );
    assert.equal(await setting('cone_set'), '16');
  });

  test('what does not belong to the method rests and says why', async () => {
    const rests = async (name) => {
      const why = await parameter(name).getAttribute('data-why');
      const inputs = parameter(name).locator('input, select');
      assert.equal(await inputs.first().isDisabled(), why !== '', name);
      return why;
    };
    assert.equal(await rests('settings.clip_levels'), 'clipmap only');
    assert.equal(await rests('settings.levels_per_frame'), 'clipmap only');
    assert.equal(await rests('settings.voxelize_every_frame'), '');
    assert.equal(await rests('view.debug_level'), 'voxel views only');
    await parameter('view.debug_view').locator('select').selectOption({ label: 'Voxel opacity' });
    assert.equal(await rests('view.debug_level'), '');
    await parameter('view.debug_view').locator('select').selectOption({ label: 'Final' });
    await parameter('settings.gi_method').locator('select').selectOption({ label: 'None' });
    assert.equal(await rests('settings.bounces'), 'needs a method');
    assert.equal(await rests('settings.voxelize_every_frame'), 'needs a method');
    assert.ok(await page.locator('#panel-render .hint').first().isVisible());
    await untilAtRest(page);
  });

  test('a refused step is told and taken back', async () => {
    await parameter('settings.gi_method').locator('select').selectOption({ label: 'Grid' });
    await setParameter(page, 'settings.cone_step', 0.1);
    const toast = page.locator('.toast.error', { hasText: 'cone_step' });
    await toast.waitFor();
    assert.match(await toast.innerText(), /0\.25/);
    assert.equal(await setting('cone_step'), 0);
  });

  test('lists each effect with the reason for its state', async () => {
    await page.locator('#panel-render [data-effect]').first().waitFor();
    const effects = await page.locator('#panel-render [data-effect]').evaluateAll((items) =>
      items.map((item) => ({
        name: item.dataset.effect,
        on: item.classList.contains('on'),
        reason: item.querySelector('.reason').textContent,
      })),
    );
    assert.ok(effects.length > 10);
    for (const { name, reason } of effects) assert.ok(reason.length > 3, name);
    assert.equal(effects.find(({ name }) => name === 'auto_exposure').on, true);
    assert.equal(effects.find(({ name }) => name === 'transparency').on, false);
  });

  test('a chosen quality is the one the image rests at', async () => {
    await parameter('settings.gi_method').locator('select').selectOption({ label: 'None' });
    await parameter('view.quality').locator('select').selectOption({ label: 'High' });
    await page.waitForFunction(() =>
      /high\s+done/.test(document.getElementById('badge').innerText),
    );
    await parameter('view.adaptive').locator('input').uncheck();
    assert.equal(await parameter('view.target_frame_ms').getAttribute('data-why'), 'adaptive only');
  });

  test('threw nothing', () => assert.deepEqual(client.problems, []));
});
