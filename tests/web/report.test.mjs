// Proves the page of voxcast accuracy: Chromium opens it from a folder with made-up results, as a
// person does after a run; the test looks at points, front, tip and table, and runs axe-core.
import assert from 'node:assert/strict';
import { copyFileSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { fileURLToPath } from 'node:url';

import { openBrowser } from './browser.mjs';

const require = createRequire(new URL('../../web_client/package.json', import.meta.url));
const axe = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');
const source = (name) => fileURLToPath(new URL(`../../web_client/report/${name}`, import.meta.url));

const metrics = (flip, ssim, red) => ({ rmse: flip / 2, energy_red: red, ssim, ldr_flip: flip });

/** An entry of results.json. */
function configuration(name, method, ms, flip, ssim, red) {
  return {
    name,
    method,
    settings: { preset: 'high', scale: 1, set: { gi_method: method } },
    frame_ms: { median: ms, p95: 2 * ms, frames: 9 },
    pass_ms: { gbuffer: 0.2 * ms, voxelize: 0.7 * ms },
    memory_bytes: 3 << 20,
    cold: { ms: 5 * ms, metrics: metrics(2 * flip, ssim / 2, red) },
    converged: {
      ms: 50 * ms,
      frames: 20,
      settled: true,
      metrics: metrics(flip, ssim, red),
      indirect: metrics(flip, ssim, red),
    },
    edit: { arrived_ms: 7 * ms },
    pictures: { converged: `${name}.png`, strip: `${name}-strip.png` },
  };
}

const results = {
  setup: {
    scene: { source: 'builtin:cornell', width: 64, height: 36 },
    gl_renderer: 'a renderer',
    reference: { source: 'traced', noise: 0.01, direct: true },
    tonemap: 'hable',
    exposure: 2,
  },
  metrics: [
    { name: 'rmse', title: 'RMSE', unit: 'cd/m^2' },
    { name: 'energy_red', title: 'energy ratio, red', unit: '' },
    { name: 'ssim', title: 'SSIM', unit: '' },
    { name: 'ldr_flip', title: 'LDR-FLIP', unit: '' },
    { name: 'not_finite', title: 'pixels not finite', unit: '' },
  ],
  rungs: [
    configuration('none', 'none', 1, 0.5, 0.5, 0.7),
    configuration('good', 'grid', 10, 0.1, 0.9, 1.2),
    configuration('worse', 'grid', 20, 0.2, 0.95, 0.9),
    configuration('best', 'clipmap', 100, 0.05, 0.99, 1),
  ],
  noise: {
    metrics: { ldr_flip: { reference: 0.07, smallest: 0.05, enough: false } },
    indirect: {},
  },
};

describe('the report of an accuracy run', () => {
  let folder, browser, page;
  const problems = [];

  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'voxcast-report-'));
    for (const name of ['index.html', 'report.js', 'error_chart.js', 'chart_view.js'])
      copyFileSync(source(name), join(folder, name));
    writeFileSync(join(folder, 'results.js'), `globalThis.results = ${JSON.stringify(results)};\n`);
    browser = await openBrowser();
    page = browser.page;
    page.on('pageerror', (error) => problems.push(error.message));
    await page.goto(`file://${folder}/index.html`);
    await page.locator('.point').first().waitFor();
  });
  after(async () => {
    await browser?.close();
    rmSync(folder, { recursive: true, force: true });
  });

  const onFront = () => page.locator('tr.on-front td:first-child').allInnerTexts();

  test('draws each configuration where its time and error are', async () => {
    assert.equal(await page.locator('.point').count(), 4);
    const positions = await page
      .locator('.point')
      .evaluateAll((marks) =>
        marks.map((mark) => [Number(mark.getAttribute('cx')), Number(mark.getAttribute('cy'))]),
      );
    const [none, good, worse, best] = positions;
    assert.ok(none[0] < good[0] && good[0] < worse[0] && worse[0] < best[0]);
    assert.ok(none[1] < worse[1] && worse[1] < good[1] && good[1] < best[1]);
    // Ten times the time is the same distance anywhere on the axis.
    assert.ok(Math.abs(good[0] - none[0] - (best[0] - good[0])) < 0.01);
  });

  test('marks the front of the chosen metric', async () => {
    assert.deepEqual(await onFront(), ['none', 'good', 'best']);
    await page.locator('select[name=metric]').selectOption({ label: 'SSIM' });
    assert.deepEqual(await onFront(), ['none', 'good', 'worse', 'best']);
    // Too dark and too bright are equally wrong; an error of 0 has no position on the chart.
    await page.locator('select[name=metric]').selectOption({ label: 'energy ratio, red' });
    assert.deepEqual(await onFront(), ['none', 'good', 'worse']);
    assert.equal(await page.locator('.point').count(), 3);
    await page.locator('select[name=metric]').selectOption({ label: 'LDR-FLIP' });
  });

  test('shows setting and image of a point', async () => {
    await page.locator('.point').nth(1).hover();
    const tip = page.locator('#tip');
    assert.match(
      await tip.innerText(),
      /good\s+preset high, gi_method grid\. 10 ms; LDR-FLIP 0\.1; 3 MiB/,
    );
    assert.match(await tip.locator('img').getAttribute('src'), /good\.png/);
    await page.locator('.point').nth(3).focus();
    assert.match(await tip.innerText(), /^best/);
    await page.locator('.point').nth(3).press('ArrowLeft');
    assert.match(await tip.innerText(), /^worse/);
    await page.keyboard.press('Home');
    assert.match(await tip.innerText(), /^none/);
    await page.keyboard.press('Tab');
    assert.equal(await tip.isVisible(), false);
  });

  test('opens the images of a point, with the times of its passes', async () => {
    await page.locator('.point').nth(1).click();
    const strip = page.locator('#strip-good');
    assert.match(await strip.locator('img').getAttribute('src'), /good-strip\.png/);
    assert.match(await strip.innerText(), /voxelize 7, gbuffer 2\./);
  });

  test('tells what the reference errs by itself', async () => {
    assert.match(
      await page.locator('#noise').innerText(),
      /errs by 0\.07; .* 0\.05\. .*more samples/,
    );
    assert.equal(await page.locator('.noise').count(), 1);
    await page.locator('select[name=metric]').selectOption({ label: 'SSIM' });
    assert.match(await page.locator('#noise').innerText(), /not known/);
  });

  test('changes to first images and to other times', async () => {
    await page.locator('select[name=metric]').selectOption({ label: 'LDR-FLIP' });
    await page.locator('select[name=state]').selectOption({ label: 'first image' });
    const row = page.locator('tr', { hasText: 'good' });
    assert.match(await row.innerText(), /0\.2/);
    await page.locator('select[name=part]').selectOption({ label: 'indirect light alone' });
    assert.match(await page.locator('#chart').innerHTML(), /No setting has values/);
    await page.locator('select[name=state]').selectOption({ label: 'final image' });
    await page.locator('select[name=time]').selectOption({ index: 3 });
    assert.match(await page.locator('#chart').innerHTML(), /from an edit of a light/);
  });

  test('has no serious accessibility fault', async () => {
    await page.evaluate(axe);
    const { violations } = await page.evaluate(() => globalThis.axe.run());
    const bad = violations
      .filter(({ impact }) => impact === 'serious' || impact === 'critical')
      .map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html).join(' ')}`);
    assert.deepEqual(bad, []);
  });

  test('threw nothing', () => assert.deepEqual(problems, []));
});
