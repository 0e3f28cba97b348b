// Proves that the accuracy tab and the daemon work together: Chromium measures a small view of the
// Cornell box, draws with what it found, lays reference image and errors over the image, and
// cancels a second measurement.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import { difference, openScene, pixels } from './browser.mjs';

const WIDTH = 96;

describe('the tab of accuracy and the daemon', () => {
  let client, page;

  before(async () => {
    client = await openScene('builtin:cornell');
    ({ page } = client);
    // The stage keeps its size; only the image is small, so that the path tracer finishes soon.
    await page.evaluate(async (width) => {
      const { connection, view } = globalThis.voxcast;
      const height = Math.round((width * view.size.height) / view.size.width);
      await connection.call('view.configure', { width, height });
      await connection.call('settings.update', {
        set: { gi_method: 'clipmap', voxel_resolution: '64' },
      });
    }, WIDTH);
    await page.waitForFunction(
      (width) => document.getElementById('picture').width === width,
      WIDTH,
    );
    await page.locator('#tab-accuracy').click();
  });
  after(async () => {
    await client?.close();
  });

  const panel = () => page.locator('#panel-accuracy');
  const button = (name) => panel().getByRole('button', { name, exact: true });
  const setNoise = async (percent) => {
    const noise = panel().locator('.lil-controller', { hasText: 'Noise' }).locator('input');
    await noise.fill(String(percent));
    await noise.press('Enter');
  };
  const untilText = (pattern) =>
    page.waitForFunction(
      (source) => new RegExp(source).test(document.getElementById('panel-accuracy').innerText),
      pattern.source,
    );
  const point = (name) => page.locator(`.error-chart .point[data-configuration=${name}]`);
  const isLoaded = (index) =>
    page.waitForFunction(
      (at) => document.querySelectorAll('#comparison-pictures img')[at].naturalWidth > 0,
      index,
    );
  const untilDrawnWith = async (name) => {
    await untilText(new RegExp(`Drawn with ${name}`));
    await page.waitForFunction(
      (wanted) =>
        document.getElementById('stage').dataset.converged === 'true' &&
        document.getElementById('badge').innerText.startsWith(wanted),
      name,
    );
  };

  test('measures this view: the reference, then points, and the live one is marked', async () => {
    await setNoise(8);
    await button('Measure this view').click();
    await untilText(/samples a pixel|Measured \d of 6 settings/);
    await untilText(/Measured 6 of 6 settings\./);
    await page.waitForFunction(() => document.querySelectorAll('.error-chart .point').length === 6);
    assert.equal(await page.locator('.error-chart .point.live').count(), 1);
    assert.ok((await page.locator('.error-chart .front').getAttribute('d')).length > 10);
    const setup = await page.evaluate(() => globalThis.voxcast.measurement.results.setup.scene);
    assert.equal(setup.width, WIDTH);
  });

  test('a point shows its image, and a click draws with it', async () => {
    await point('none').hover();
    await page.waitForFunction(() => document.querySelector('.error-tip img').naturalWidth > 0);
    const before = await pixels(page);
    await point('none').click();
    await untilDrawnWith('none');
    assert.ok(difference(before, await pixels(page)) > 2); // indirect light is missing
    await button('Back to own settings').click();
    await untilText(/Drawn with your own settings/);
  });

  test('the budget for images at rest draws with the least error', async () => {
    await panel().locator('.budget input').focus();
    await page.keyboard.press('End');
    await untilText(/When time does not matter: .*LDR-FLIP/);
    await page.waitForFunction(() => globalThis.voxcast.view.configuration !== '');
    const [drawn, errors] = await page.evaluate(() => {
      const { measurement, view } = globalThis.voxcast;
      const errorOf = (configuration) => configuration.converged.metrics.ldr_flip;
      return [
        errorOf(measurement.configuration(view.configuration)),
        measurement.configurations.map(errorOf),
      ];
    });
    assert.equal(drawn, Math.min(...errors));
  });

  test('reference and errors lie over the image while the camera is the measured one', async () => {
    await page.locator('input[value=split]').check();
    await isLoaded(0);
    assert.ok(
      await page
        .getByRole('slider', { name: 'Line between live image and reference image' })
        .isVisible(),
    );
    await page.locator('input[value=error]').check();
    await isLoaded(1);
    assert.ok(await page.locator('.heat-legend').isVisible());
    await page.evaluate(() => globalThis.voxcast.camera.orbit(0.3, 0));
    const back = page.getByRole('button', { name: 'Back to the measured view' });
    await back.click();
    assert.ok(!(await back.isVisible()));
    assert.ok(await page.locator('.heat-legend').isVisible());
    await page.locator('input[value=none]').check();
  });

  test('a refusal of the daemon is told', async () => {
    const message = await page.evaluate(() =>
      globalThis.voxcast.view.chooseConfiguration('nonesuch').catch((error) => error.message),
    );
    assert.match(message, /nonesuch.*live/);
  });

  test('cancelling ends a measurement at once', async () => {
    await setNoise(0.05);
    await button('Measure this view').click();
    await untilText(/samples a pixel/);
    await button('Cancel').click();
    await untilText(/Cancelled after 0 of 6 settings/);
    assert.ok(await button('Measure this view').isEnabled());
    assert.ok(!(await button('Cancel').isVisible()));
    assert.equal(await page.evaluate(() => globalThis.voxcast.view.configuration), '');
  });

  test('threw nothing', () => assert.deepEqual(client.problems, []));
});
