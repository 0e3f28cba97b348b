// Proves that a person sees the scene and can move in it: Chromium opens the client of a running
// daemon, and the test looks at the canvas, uses mouse and keys, and runs axe-core on the page.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { after, before, describe, test } from 'node:test';

import { difference, meanColor, openScene, pixels, untilAtRest } from './browser.mjs';

const require = createRequire(new URL('../../web_client/package.json', import.meta.url));
const axe = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');

describe('the image', () => {
  let client, page;

  before(async () => {
    client = await openScene('builtin:cornell');
    ({ page } = client);
  });
  after(() => client?.close());

  test('shows the red and the green wall', async () => {
    const left = await meanColor(page, { x: 0.15, y: 0.3, width: 0.08, height: 0.2 });
    const right = await meanColor(page, { x: 0.77, y: 0.3, width: 0.08, height: 0.2 });
    assert.ok(left[0] > 1.3 * left[1], `left is ${left}`);
    assert.ok(right[1] > 1.3 * right[0], `right is ${right}`);
  });

  test('turns when the mouse drags', async () => {
    const first = await pixels(page);
    await page.mouse.move(500, 400);
    await page.mouse.down();
    await page.mouse.move(620, 420, { steps: 6 });
    await page.mouse.up();
    await untilAtRest(page);
    assert.ok(difference(first, await pixels(page)) > 5);
    await page.locator('#tab-scene').click();
    await page.locator('[data-camera]').first().click();
    await untilAtRest(page);
    assert.ok(difference(first, await pixels(page)) < 1, 'the scene camera brings the view back');
  });

  test('keeps the handle on the object that it moves', async () => {
    await page.mouse.click(400, 520);
    const plane = page.locator('.plane');
    await plane.waitFor();
    const box = await plane.boundingBox();
    assert.ok(Math.abs(box.x + box.width / 2 - 400) < 3, `x is ${box.x + box.width / 2}`);
    assert.ok(Math.abs(box.y + box.height / 2 - 520) < 3, `y is ${box.y + box.height / 2}`);
    assert.match(await page.locator('.tree [aria-selected=true]').innerText(), /tall block/);
  });

  test('selects, walks and hides by the keyboard alone', async () => {
    await page.keyboard.press('Escape');
    const sceneTree = page.locator('[role=tree]');
    for (let i = 0; i < 40; i++) {
      await page.keyboard.press('Tab');
      if (await sceneTree.evaluate((element) => element === document.activeElement)) break;
    }
    await page.keyboard.press('Home');
    await page.keyboard.press('End');
    const chosen = page.locator('[role=treeitem][aria-selected=true]');
    assert.match(await chosen.innerText(), /tall block/);
    assert.equal(
      await sceneTree.getAttribute('aria-activedescendant'),
      await chosen.getAttribute('id'),
    );
    const first = await pixels(page);
    await page.keyboard.press('v');
    await untilAtRest(page);
    assert.ok(difference(first, await pixels(page)) > 1, 'the block is hidden');
    await page.keyboard.press('v');
    const stage = page.locator('#controls');
    for (let i = 0; i < 40; i++) {
      await page.keyboard.press('Shift+Tab');
      if (await stage.evaluate((element) => element === document.activeElement)) break;
    }
    await page.keyboard.press('Escape');
    assert.equal(await chosen.count(), 0);
    await page.keyboard.press('Enter');
    await chosen.waitFor();
    const atRest = await pixels(page);
    await page.keyboard.down('KeyW');
    await page.waitForTimeout(400);
    await page.keyboard.up('KeyW');
    await untilAtRest(page);
    assert.ok(difference(atRest, await pixels(page)) > 3, 'W walks');
  });

  test('comes nearer when two fingers spread', async () => {
    const eye = () => page.evaluate(() => globalThis.voxcast.camera.distance);
    const before = await eye();
    const touch = await page.context().newCDPSession(page);
    const send = (type, spread) =>
      touch.send('Input.dispatchTouchEvent', {
        type,
        touchPoints:
          spread === null
            ? []
            : [
                { x: 450 - spread, y: 400, id: 1 },
                { x: 450 + spread, y: 400, id: 2 },
              ],
      });
    await send('touchStart', 50);
    for (const spread of [60, 70, 80, 90, 100]) await send('touchMove', spread);
    await send('touchEnd', null);
    const ratio = (await eye()) / before;
    assert.ok(Math.abs(ratio - 0.5) < 0.08, `the distance became ${ratio} of what it was`);
    await untilAtRest(page);
  });

  for (const [width, height] of [
    [1280, 800],
    [390, 844],
  ]) {
    test(`has no serious accessibility fault at ${width} by ${height}`, async () => {
      await page.setViewportSize({ width, height });
      await untilAtRest(page);
      await page.evaluate(axe);
      for (const name of ['scene', 'light', 'material', 'render', 'view', 'stats']) {
        await page.locator(`#tab-${name}`).click();
        await page.waitForTimeout(600);
        const { violations } = await page.evaluate(() => globalThis.axe.run());
        const bad = violations
          .filter(({ impact }) => impact === 'serious' || impact === 'critical')
          .map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html).join(' ')}`);
        assert.deepEqual(bad, [], `tab ${name}`);
      }
    });
  }

  test('a phone sees the image above the panel', async () => {
    const stage = await page.locator('#stage').boundingBox();
    const panel = await page.locator('#panel').boundingBox();
    assert.ok(stage.height > 300 && stage.width === 390);
    assert.ok(panel.y >= stage.y + stage.height - 1);
    const width = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(width <= 390, `the page is ${width} wide`);
  });

  test('threw nothing', () => assert.deepEqual(client.problems, []));
});
