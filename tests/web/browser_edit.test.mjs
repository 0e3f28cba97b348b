// Proves that edits in the panel change the image, here and in another browser: two Chromiums open
// the client of one daemon; the test adds and changes a light and a material and compares pixels.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import {
  difference,
  meanColor,
  openBrowser,
  openClient,
  pixels,
  setParameter,
  untilAtRest,
} from './browser.mjs';
import { startDaemon, stopDaemon } from './client.mjs';

const mean = ([r, g, b]) => (r + g + b) / 3;
const WALL = { x: 0.77, y: 0.3, width: 0.08, height: 0.2 };

describe('edits', () => {
  let daemon, ours, theirs;

  before(async () => {
    daemon = await startDaemon(['--scene', 'builtin:cornell']);
    [ours, theirs] = await Promise.all([openBrowser(), openBrowser({ width: 1000, height: 700 })]);
    await openClient(ours.page, daemon);
    await openClient(theirs.page, daemon);
  });
  after(async () => {
    await Promise.all([ours?.close(), theirs?.close()]);
    await stopDaemon(daemon);
  });

  test('a fixed exposure and an added light brighten the image', async () => {
    const { page } = ours;
    await page.locator('#tab-light').click();
    await page
      .locator('[data-parameter="settings.exposure_mode"] select')
      .selectOption({ label: 'Fixed' });
    await untilAtRest(page);
    const dark = mean(await meanColor(page));
    await page.locator('[data-add-light=point]').click();
    await page.locator('[data-parameter="light.intensity"]').waitFor();
    await untilAtRest(page);
    const lit = mean(await meanColor(page));
    assert.ok(lit > dark + 5, `${dark} became ${lit}`);
    await setParameter(page, 'light.intensity', 0.1);
    await untilAtRest(page);
    const dim = mean(await meanColor(page));
    assert.ok(dim < lit - 5, `${lit} became ${dim}`);
  });

  test('the other browser sees the same light and the image with it', async () => {
    const { page } = theirs;
    await page.locator('#tab-light').click();
    assert.equal(await page.locator('[data-light]').count(), 1);
    await page.locator('[data-light]').click();
    await untilAtRest(page);
    const before = await pixels(page);
    await setParameter(ours.page, 'light.intensity', 2);
    await untilAtRest(ours.page);
    await untilAtRest(page, 1000);
    assert.ok(difference(before, await pixels(page)) > 5);
    const shown = page.locator('[data-parameter="light.intensity"] input');
    assert.equal(await shown.inputValue(), '2');
  });

  test('a material changes its surface', async () => {
    const { page } = ours;
    await page.locator('#tab-material').click();
    await page.locator('[data-material="3"]').click();
    const before = await meanColor(page, WALL);
    assert.ok(before[1] > before[2], `the wall is ${before}`);
    const color = page.locator('[data-parameter="material.base_color"] input[type=text]');
    await color.fill('2020ff');
    await color.blur();
    await untilAtRest(page);
    const after = await meanColor(page, WALL);
    assert.ok(after[2] > 1.5 * after[1], `the wall is ${after}`);
  });

  test('undo takes the material back, redo does it again', async () => {
    const { page } = ours;
    await page.locator('#tool-undo').click();
    await untilAtRest(page);
    const undone = await meanColor(page, WALL);
    assert.ok(undone[1] > undone[2], `the wall is ${undone}`);
    await page.locator('#tool-redo').click();
    await untilAtRest(page);
    const redone = await meanColor(page, WALL);
    assert.ok(redone[2] > redone[1], `the wall is ${redone}`);
  });

  test('a refused edit tells field and range; the panel shows what holds', async () => {
    const { page } = ours;
    await page.locator('#tab-light').click();
    await page.locator('[data-light]').click();
    await setParameter(page, 'light.intensity', 99999999);
    const toast = page.locator('.toast.error');
    await toast.first().waitFor();
    assert.match(await toast.first().innerText(), /intensity[\s\S]*Allowed: 0 to 10000000/);
    const shown = page.locator('[data-parameter="light.intensity"] input');
    await page.waitForTimeout(300);
    assert.equal(await shown.inputValue(), '2');
  });

  test('a drag of the light by its icon moves it and is one undo step', async () => {
    const { page } = ours;
    const before = await pixels(page);
    const box = await page.locator('.light-icon .disc').boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 150, y + 60, { steps: 12 });
    await page.mouse.up();
    await untilAtRest(page);
    const moved = await page.locator('.light-icon .disc').boundingBox();
    assert.ok(
      Math.abs(moved.x - box.x - 150) < 3 && Math.abs(moved.y - box.y - 60) < 3,
      JSON.stringify(moved),
    );
    assert.ok(difference(before, await pixels(page)) > 2);
    await page.locator('#tool-undo').click();
    await untilAtRest(page);
    assert.ok(difference(before, await pixels(page)) < 1);
  });

  test('loading the scene anew drops the edits in both browsers', async () => {
    await ours.page.locator('#tab-scene').click();
    await ours.page.locator('#panel-scene .loader button').click();
    for (const { page } of [ours, theirs]) {
      await page.locator('[data-light]').waitFor({ state: 'detached' });
      assert.equal(await page.locator('.light-icon').count(), 0);
    }
    await untilAtRest(ours.page);
    const wall = await meanColor(ours.page, WALL);
    assert.ok(wall[1] > wall[2], `the wall is ${wall}`);
  });

  test('in another scene the handle is where the click was', async () => {
    const { page } = ours;
    const before = await page.evaluate(() => globalThis.voxcast.document.data.epoch);
    await page.locator('#scene-source').selectOption('builtin:material-grid');
    await page.locator('#panel-scene .loader button').click();
    await page.waitForFunction((epoch) => globalThis.voxcast.document.data.epoch !== epoch, before);
    await untilAtRest(page, 1000);
    await page.mouse.click(525, 455);
    await page.locator('.tree [aria-selected=true]').waitFor();
    const box = await page.locator('.plane').boundingBox();
    assert.ok(Math.abs(box.x + box.width / 2 - 525) < 3, `x is ${box.x + box.width / 2}`);
    assert.ok(Math.abs(box.y + box.height / 2 - 455) < 3, `y is ${box.y + box.height / 2}`);
  });
});
