import { App } from './app.js';

const app = new App();
// For the browser's console and for measurements.
Object.assign(globalThis, { voxcast: app });
app.start();
