// Proves the accuracy tab in every state that a daemon may bring it to. Chromium opens the client
// of a running daemon, but the measurements are made up, so that figures, failures and refusals are
// known and come when the test says so. browser_accuracy_daemon.test.mjs uses real measurements.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { after, before, describe, test } from 'node:test';

import { openScene } from './browser.mjs';

const require = createRequire(new URL('../../web_client/package.json', import.meta.url));
const axe = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');
const RED_PNG = Buffer.from(
  'iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR4nGP4z8DwHwAFAAH/' +
    'iZk9HQAAAABJRU5ErkJggg==',
  'base64',
);

const metrics = (flip) => ({ ldr_flip: flip, ssim: 1 - flip / 2, energy_red: 1 + flip });

function configuration(name, method, ms, flip) {
  return {
    name,
    method,
    settings: { preset: 'high', scale: 1, set: { gi_method: method } },
    frame_ms: { median: ms, p95: 2 * ms, frames: 9 },
    memory_bytes: 3 << 20,
    cold: { ms: 5 * ms, metrics: metrics(2 * flip) },
    converged: {
      ms: 50 * ms,
      frames: 20,
      settled: true,
      metrics: metrics(flip),
      indirect: metrics(flip),
    },
    edit: { arrived_ms: 7 * ms },
    pictures: {
      converged: `${name}-converged.png`,
      error: `${name}-error.png`,
      strip: `${name}-strip.png`,
    },
  };
}

const CONFIGURATIONS = [
  configuration('live', 'grid', 25, 0.15),
  configuration('none', 'none', 10, 0.5),
  configuration('draft', 'clipmap', 20, 0.2),
  configuration('high', 'clipmap', 80, 0.1),
  configuration('final', 'clipmap', 900, 0.05),
];

/** Puts a made-up daemon's measurements into the page. `globalThis.made` steers them. */
function fakeMeasuring() {
  const { connection } = globalThis.voxcast;
  const real = connection.call.bind(connection);
  const made = { calls: [], refusal: '', id: 0 };
  globalThis.made = made;
  connection.call = (method, params) => {
    if (!method.startsWith('accuracy.') && !(method === 'view.configure' && 'rung' in params))
      return real(method, params);
    made.calls.push({ method, params });
    if (made.refusal) return Promise.reject(Object.assign(new Error(made.refusal), { data: {} }));
    if (method !== 'accuracy.start') return Promise.resolve({});
    return real('scene.get').then(({ epoch, revision }) => {
      return {
        measurement: `m${++made.id}`,
        rung_count: 5,
        width: 64,
        height: 36,
        epoch,
        revision,
      };
    });
  };
  made.tell = (params) => {
    const detail = {
      method: 'accuracy.progress',
      params: { measurement: `m${made.id}`, rung_count: 5, done: 0, noise_wanted: 0.01, ...params },
    };
    connection.dispatchEvent(new CustomEvent('notification', { detail }));
  };
}

describe('the tab of accuracy', () => {
  let client, page, results;

  before(async () => {
    client = await openScene('builtin:cornell');
    ({ page } = client);
    await page.evaluate(axe);
    await page.evaluate(fakeMeasuring);
    const view = await page.evaluate(() => ({
      ...globalThis.voxcast.camera.pose,
      ...globalThis.voxcast.view.size,
    }));
    results = {
      setup: {
        scene: { source: 'builtin:cornell', ...view },
        reference: { noise: 0.01, direct: true },
      },
      metrics: [
        { name: 'energy_red', title: 'energy ratio, red', unit: '' },
        { name: 'ssim', title: 'SSIM', unit: '' },
        { name: 'ldr_flip', title: 'LDR-FLIP', unit: '' },
        { name: 'not_finite', title: 'pixels not finite', unit: '' },
      ],
      rungs: [],
      noise: {
        metrics: { ldr_flip: { reference: 0.02, smallest: 0.05, enough: false } },
        indirect: {},
      },
    };
    await page.route('**/accuracy/**', (route) => {
      const isJson = route.request().url().endsWith('results.json');
      if (!isJson) return route.fulfill({ body: RED_PNG, contentType: 'image/png' });
      return results.rungs.length > 0
        ? route.fulfill({ json: results })
        : route.fulfill({ status: 404, body: 'not found' });
    });
    await page.locator('#tab-accuracy').click();
  });
  after(async () => {
    await client?.close();
  });

  const panel = () => page.locator('#panel-accuracy');
  const button = (name) => panel().getByRole('button', { name, exact: true });
  const text = () => panel().innerText();
  const tell = (params) => page.evaluate((given) => globalThis.made.tell(given), params);
  const calls = () => page.evaluate(() => globalThis.made.calls.splice(0));
  const point = (name) => page.locator(`.error-chart .point[data-configuration=${name}]`);
  const mode = (name) => page.locator(`input[value=${name}]`);
  const slider = () => page.locator('.budget input');
  const setBudget = async (index) => {
    await slider().focus();
    await page.keyboard.press('Home');
    for (let i = 0; i < index; i++) await page.keyboard.press('ArrowRight');
  };
  const untilText = (pattern) =>
    page.waitForFunction(
      (source) => new RegExp(source).test(document.getElementById('panel-accuracy').innerText),
      pattern.source,
    );
  const measured = async (count, progress) => {
    results.rungs = CONFIGURATIONS.slice(0, count);
    await tell(progress);
    await page.waitForFunction(
      (wanted) => document.querySelectorAll('.error-chart .point').length === wanted,
      count,
    );
  };
  const seriousFaults = async () => {
    const { violations } = await page.evaluate(() => globalThis.axe.run());
    return violations
      .filter(({ impact }) => impact === 'serious' || impact === 'critical')
      .map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html).join(' ')}`);
  };

  test('nothing can be chosen before something is measured, and the tab says so', async () => {
    assert.match(await text(), /Nothing has been measured yet/);
    assert.match(await text(), /Measure the view first: then this finds/);
    assert.ok(await slider().isDisabled());
    for (const name of ['split', 'error']) assert.ok(await mode(name).isDisabled());
    assert.ok(!(await button('Cancel').isVisible()));
    assert.deepEqual(await seriousFaults(), []);
  });

  test('a refusal is told and the form stays', async () => {
    await page.evaluate(
      () => (globalThis.made.refusal = 'noise: 2 is out of range; allowed are 0.0005 to 0.1'),
    );
    await button('Measure this view').click();
    await page.locator('.toast.error', { hasText: 'noise: 2 is out of range' }).waitFor();
    await page.evaluate(() => (globalThis.made.refusal = ''));
    assert.ok(await button('Measure this view').isEnabled());
    await calls();
  });

  test('measures by the chosen sweep and noise, and shows how the reference comes', async () => {
    await panel()
      .locator('.lil-controller', { hasText: 'Settings' })
      .locator('select')
      .selectOption({ label: 'Full: each setting' });
    const noise = panel().locator('.lil-controller', { hasText: 'Noise' }).locator('input');
    await noise.fill('0.5');
    await noise.press('Enter');
    await panel()
      .locator('.lil-controller', { hasText: 'At most for' })
      .locator('select')
      .selectOption({ label: '5 min' });
    await button('Measure this view').click();
    await untilText(/Waits until another measurement has ended/);
    assert.deepEqual(await calls(), [
      { method: 'accuracy.start', params: { ladder: 'full', noise: 0.005, seconds: 300 } },
    ]);
    await tell({ state: 'reference', samples: 64, noise: null, seconds_left: null });
    assert.match(await text(), /64 samples a pixel, noise not known yet \(wanted: 1 %\)\./);
    assert.equal(await panel().locator('progress').getAttribute('value'), null);
    await tell({ state: 'reference', samples: 256, noise: 0.02, seconds_left: 42 });
    assert.match(await text(), /256 samples a pixel, noise 2 % \(wanted: 1 %\)\. About 42 s left/);
    assert.equal(await panel().locator('progress').evaluate((bar) => bar.value), 0.25);
    assert.ok(await button('Measure this view').isDisabled());
    assert.ok(await slider().isDisabled());
  });

  test('points come as they are measured', async () => {
    await measured(1, { state: 'rungs', done: 1, rung: 'none', seconds_left: 100 });
    assert.match(await text(), /Measured 1 of 5 settings; now none\. About 2 min left/);
    assert.equal(
      await panel().locator('.visually-hidden[role=status]').innerText(),
      'The settings are being measured.',
    );
    await measured(3, { state: 'rungs', done: 3, rung: 'high' });
    assert.equal(await page.locator('.error-chart .ring.live').count(), 1);
  });

  test('cancelling keeps what there is', async () => {
    await button('Cancel').click();
    assert.deepEqual(await calls(), [{ method: 'accuracy.cancel', params: {} }]);
    await tell({ state: 'cancelled', done: 3 });
    assert.match(await text(), /Cancelled after 3 of 5 settings; these stay/);
    assert.equal(await page.locator('.error-chart .point').count(), 3);
    assert.ok(await button('Measure this view').isEnabled());
  });

  test('a failure says why, and the next measurement starts afresh', async () => {
    results.rungs = [];
    await button('Measure this view').click();
    await untilText(/Waits until another measurement has ended/);
    assert.match(await text(), /Nothing has been measured yet/);
    await tell({ state: 'failed', message: 'no memory for the reference' });
    assert.match(await text(), /Failed: no memory for the reference/);
    await button('Measure this view').click();
    await untilText(/Waits until another measurement has ended/);
    await measured(5, { state: 'done', done: 5 });
    assert.match(await text(), /Measured 5 of 5 settings/);
    assert.match(
      await text(),
      /reference image itself errs by 0\.02, more than a tenth of the least error \(0\.05\)/,
    );
    await calls();
  });

  test('a point shows its setting, figures and image, by mouse and by keys', async () => {
    const tip = page.locator('.error-tip');
    await point('draft').hover();
    assert.match(
      await tip.innerText(),
      /draft\s+preset high, gi_method clipmap\s+LDR-FLIP\s+0\.2\s+frame\s+20 ms\s+memory\s+3 MiB/,
    );
    assert.match(
      await tip.locator('img').getAttribute('src'),
      /accuracy\/m3\/draft-converged\.png$/,
    );
    await page.mouse.move(200, 300);
    assert.ok(!(await tip.isVisible()));
    // The Tab key reaches one of all points.
    assert.equal(await page.locator('.error-chart .point[tabindex="0"]').count(), 1);
    await page.locator('.error-chart .point[tabindex="0"]').focus();
    await page.keyboard.press('Home');
    assert.match(await tip.innerText(), /^none/);
    await page.keyboard.press('ArrowRight');
    await page.keyboard.press('ArrowRight');
    assert.match(await tip.innerText(), /^own settings as measured/);
    await page.keyboard.press('End');
    assert.match(await tip.innerText(), /^final/);
    assert.deepEqual(await calls(), []);
    await page.keyboard.press('Enter');
    assert.deepEqual(await calls(), [{ method: 'view.configure', params: { rung: 'final' } }]);
    await untilText(/Drawn with final/);
    assert.equal(await point('final').getAttribute('aria-selected'), 'true');
    // The tab of settings says that they have no effect now.
    assert.match(await page.locator('#panel-render .note').textContent(), /drawn with final/);
    assert.ok(!(await page.locator('#panel-view').innerText()).includes('Rung'));
  });

  test('goes back to the own settings', async () => {
    await button('Back to own settings').click();
    await untilText(/Drawn with your own settings/);
    assert.deepEqual(await calls(), [{ method: 'view.configure', params: { rung: '' } }]);
    assert.equal(await page.locator('.error-chart .ring.chosen').count(), 0);
    assert.equal(await page.locator('#panel-render .note').getAttribute('hidden'), '');
  });

  test('the measure of error can be another', async () => {
    const section = panel().locator('.lil-gui', { hasText: 'What the chart shows' });
    await section.locator('.lil-title').click();
    await section.locator('select').first().selectOption('SSIM');
    await point('draft').hover();
    assert.match(await page.locator('.error-tip').innerText(), /SSIM\s+0\.9/);
    await section.locator('select').first().selectOption('LDR-FLIP');
    await section.locator('.lil-title').click();
  });

  test('a budget picks the most accurate setting, or says that nothing fits', async () => {
    await setBudget(0);
    assert.match(
      await text(),
      /Within 16 ms: none, LDR-FLIP 0\.5, 10 ms a frame, 500 ms to the final image/,
    );
    await setBudget(1);
    assert.match(
      await text(),
      /Within 33 ms: own settings as measured, LDR-FLIP 0\.15, 25 ms a frame/,
    );
    await setBudget(2);
    assert.match(await text(), /Within 100 ms: high/);
    await setBudget(3);
    assert.match(await text(), /When time does not matter: final/);
    assert.equal(await slider().getAttribute('aria-valuetext'), 'still: final');
    const configurations = (await calls()).map(({ params }) => params.rung);
    assert.equal(configurations.at(-1), 'final');
    results.rungs = CONFIGURATIONS.map((entry) => ({
      ...entry,
      frame_ms: { median: entry.frame_ms.median + 40 },
    }));
    await tell({ state: 'done', done: 4 });
    await setBudget(1);
    await untilText(
      /Nothing measured keeps 33 ms: the fastest, none, takes 50 ms a frame \(LDR-FLIP 0\.5\)/,
    );
    assert.ok(!(await button('Draw with it').isVisible()));
    results.rungs = CONFIGURATIONS;
    await tell({ state: 'done', done: 5 });
    await untilText(/Within 33 ms/);
    await calls();
    await button('Draw with it').click();
    await untilText(/Drawn with live/);
    assert.deepEqual(await calls(), [{ method: 'view.configure', params: { rung: 'live' } }]);
  });

  test('the reference lies right of a line that mouse and keys move', async () => {
    await mode('split').check();
    const divider = page.getByRole('slider', {
      name: 'Line between live image and reference image',
    });
    const reference = page.locator('#comparison-pictures img').first();
    assert.match(await reference.getAttribute('src'), /accuracy\/m3\/reference\.png$/);
    await page.waitForFunction(
      () => document.querySelector('#comparison-pictures img').naturalWidth > 0,
    );
    assert.equal(await divider.getAttribute('aria-valuenow'), '50');
    const stage = await page.locator('#stage').boundingBox();
    await page.mouse.move(stage.x + stage.width / 2, stage.y + 200);
    await page.mouse.down();
    await page.mouse.move(stage.x + stage.width / 4, stage.y + 220, { steps: 4 });
    await page.mouse.up();
    assert.equal(await divider.getAttribute('aria-valuetext'), '25 % live, 75 % reference');
    assert.match(await reference.evaluate(({ style }) => style.clipPath), /25%\)$/);
    await page.keyboard.press('ArrowRight');
    assert.equal(await divider.getAttribute('aria-valuenow'), '27');
    await page.keyboard.press('PageUp');
    assert.equal(await divider.getAttribute('aria-valuenow'), '37');
    await page.keyboard.press('End');
    assert.equal(await divider.getAttribute('aria-valuenow'), '100');
    await page.keyboard.press('Home');
    assert.equal(await divider.getAttribute('aria-valuenow'), '0');
    assert.deepEqual(await seriousFaults(), []);
  });

  test('the error map is that of the setting that draws, with its scale', async () => {
    await mode('error').check();
    const map = page.locator('#comparison-pictures img').last();
    assert.match(await map.getAttribute('src'), /live-error\.png$/);
    await point('draft').click();
    await page.waitForFunction(() =>
      /draft-error\.png$/.test(document.querySelectorAll('#comparison-pictures img')[1].src),
    );
    assert.ok(await page.locator('.heat-legend').isVisible());
    assert.match(await page.locator('#badge').innerText(), /draft|final/);
    assert.deepEqual(await seriousFaults(), []);
  });

  test('says so where the camera is another, and goes back to the measured one', async () => {
    const pose = await page.evaluate(() => globalThis.voxcast.camera.pose);
    await page.evaluate(() => globalThis.voxcast.camera.orbit(0.2, 0));
    const hint = page.locator('#comparison .stage-hint');
    assert.match(await hint.innerText(), /The camera is not where the image was measured/);
    assert.ok(!(await page.locator('.heat-legend').isVisible()));
    await hint.getByRole('button', { name: 'Back to the measured view' }).click();
    assert.ok(!(await hint.isVisible()));
    assert.deepEqual(await page.evaluate(() => globalThis.voxcast.camera.pose), pose);
    assert.ok(await page.locator('.heat-legend').isVisible());
  });

  test('tells that the scene has been edited since', async () => {
    assert.ok(!(await panel().locator('.note').isVisible()));
    await page.evaluate(() =>
      globalThis.voxcast.connection.call('settings.update', { set: { exposure_ev: 0.1 } }),
    );
    await untilText(/The settings have changed since/);
    await page.evaluate(() =>
      globalThis.voxcast.connection.call('material.update', { id: 0, set: { roughness: 0.5 } }),
    );
    await untilText(/The scene has been edited since it was measured/);
  });

  test('fits a phone, where the tip stands above the panel', async () => {
    await page.setViewportSize({ width: 390, height: 844 });
    await page.waitForFunction(
      () =>
        document.querySelector('.error-chart').viewBox.baseVal.width ===
        document.querySelector('.error-figure').clientWidth,
    );
    const widths = await page.evaluate(() => [
      document.documentElement.scrollWidth,
      document.getElementById('panel-accuracy').scrollWidth -
        document.getElementById('panel-accuracy').clientWidth,
    ]);
    assert.deepEqual(widths, [390, 0]);
    await untilText(/./);
    await page.locator('#comparison .stage-hint', { hasText: 'another shape' }).waitFor();
    await point('high').scrollIntoViewIfNeeded();
    await point('high').hover();
    const [tip, sheet] = await Promise.all(
      ['.error-tip', '.panel'].map((name) => page.locator(name).boundingBox()),
    );
    assert.ok(
      tip.y >= 0 && tip.y + tip.height <= sheet.y,
      `${JSON.stringify(tip)} ${JSON.stringify(sheet)}`,
    );
    await page.setViewportSize({ width: 1280, height: 800 });
  });

  test('another scene forgets it all', async () => {
    await page.evaluate(() =>
      globalThis.voxcast.connection.call('scene.load', { source: 'builtin:furnace' }),
    );
    await untilText(/Nothing has been measured yet/);
    assert.equal(await page.evaluate(() => globalThis.voxcast.view.configuration), '');
    assert.ok(!(await page.locator('#comparison').isVisible()));
  });

  test('threw nothing', () => assert.deepEqual(client.problems, []));
});
