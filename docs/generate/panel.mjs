// Takes the README's image of the control panel: the atrium, a built-in scene, at rest.
// Run: node docs/generate/panel.mjs
import { fileURLToPath } from 'node:url';

import { openBrowser } from '../../tests/web/browser.mjs';
import { startDaemon, stopDaemon } from '../../tests/web/client.mjs';

// On two cores without a GPU the image comes to rest within a few minutes.
const LIMIT_MS = 1200000;

const daemon = await startDaemon(['--scene', 'builtin:atrium']);
const { page, close } = await openBrowser({ width: 1440, height: 900 });
await page.goto(daemon.http);
await page.locator('#tab-light').click();
await page.locator('#stage[data-converged=true]').waitFor({ timeout: LIMIT_MS });
await page.screenshot({
  path: fileURLToPath(new URL('../panel.jpg', import.meta.url)),
  type: 'jpeg',
  quality: 85,
});
await close();
await stopDaemon(daemon);
