// Starts Chromium for tests, and looks at the client's image.
import { createRequire } from 'node:module';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { PATIENCE_MS, startDaemon, stopDaemon } from './client.mjs';

const require = createRequire(new URL('../../web_client/package.json', import.meta.url));
const { chromium } = require('playwright-core');

// Where the release preset puts it.
process.env.VOXCASTD ??= fileURLToPath(
  new URL('../../build/release/bin/voxcastd', import.meta.url),
);

const FLAGS = [
  '--headless',
  '--no-sandbox',
  '--disable-gpu',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
];

/** A Chromium with a profile of its own; `close` ends it and removes the profile. */
export async function openBrowser(viewport = { width: 1280, height: 800 }) {
  const profile = mkdtempSync(join(tmpdir(), 'voxcast-browser-'));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: FLAGS,
    viewport,
    timeout: PATIENCE_MS,
  });
  context.setDefaultTimeout(PATIENCE_MS);
  const close = async () => {
    await context.close();
    rmSync(profile, { recursive: true, force: true });
  };
  return { page: context.pages()[0], close };
}

/**
 * Opens the client and waits for its first image, with direct light and the quickest preset: other
 * images take long to come to rest.
 */
export async function openClient(page, daemon) {
  await page.goto(`${daemon.http}/`);
  await page.locator('#stage[data-frame]').waitFor();
  await page.evaluate(() => {
    globalThis.voxcast.view.configure({ quality: 'draft' });
    return globalThis.voxcast.connection.call('settings.update', { set: { gi_method: 'none' } });
  });
  await untilAtRest(page);
}

/**
 * A daemon with `scene` and a browser that shows its client. `problems` collects what the page
 * throws; `close` ends both.
 */
export async function openScene(scene) {
  const daemon = await startDaemon(['--scene', scene]);
  let browser;
  const close = async () => {
    await browser?.close();
    await stopDaemon(daemon);
  };
  try {
    browser = await openBrowser();
    const { page } = browser;
    const problems = [];
    page.on('pageerror', (error) => problems.push(error.message));
    await openClient(page, daemon);
    return { daemon, page, problems, close };
  } catch (error) {
    await close();
    throw error;
  }
}

/**
 * Waits until this page's edits and camera are shown and the image has converged and has not
 * changed for `ms`.
 */
export async function untilAtRest(page, ms = 500) {
  await page.waitForFunction(
    () =>
      globalThis.voxcast.timer.waiting.size === 0 &&
      Number(document.getElementById('stage').dataset.cameraRevision) >=
        globalThis.voxcast.sender.revision,
  );
  const state = () =>
    page.locator('#stage').evaluate(({ dataset }) => [dataset.frame, dataset.converged].join());
  let last;
  do {
    last = await state();
    await page.waitForTimeout(ms);
  } while (last !== (await state()) || !last.endsWith('true'));
}

/** The mean colour (0 to 255) of a part of the image, which is given in fractions of its size. */
export function meanColor(page, part = { x: 0, y: 0, width: 1, height: 1 }) {
  return page.evaluate((part) => {
    const picture = document.getElementById('picture');
    const canvas = new OffscreenCanvas(picture.width, picture.height);
    const context = canvas.getContext('2d');
    context.drawImage(picture, 0, 0);
    const { data } = context.getImageData(
      Math.floor(part.x * picture.width),
      Math.floor(part.y * picture.height),
      Math.max(1, Math.floor(part.width * picture.width)),
      Math.max(1, Math.floor(part.height * picture.height)),
    );
    const sum = [0, 0, 0];
    for (let i = 0; i < data.length; i++) if (i % 4 < 3) sum[i % 4] += data[i];
    return sum.map((value) => value / (data.length / 4));
  }, part);
}

/** The image as bytes, to compare with another. */
export function pixels(page) {
  return page.evaluate(() => {
    const picture = document.getElementById('picture');
    const canvas = new OffscreenCanvas(picture.width, picture.height);
    const context = canvas.getContext('2d');
    context.drawImage(picture, 0, 0);
    return [...context.getImageData(0, 0, picture.width, picture.height).data];
  });
}

/** The mean difference (0 to 255) of two images of one size. */
export function difference(a, b) {
  if (a.length !== b.length) throw new Error('the images differ in size');
  let sum = 0;
  for (let i = 0; i < a.length; i++) sum += Math.abs(a[i] - b[i]);
  return sum / a.length;
}

/** Types a value into the input of a parameter and commits it. */
export async function setParameter(page, parameter, value) {
  const input = page.locator(
    `[data-parameter="${parameter}"] input[type=text], [data-parameter="${parameter}"] ` +
      'input[type=number]',
  );
  await input.first().fill(String(value));
  await input.first().press('Enter');
}
