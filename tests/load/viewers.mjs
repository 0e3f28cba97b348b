// Measures how fairly and how fast a daemon serves many viewers: each moves its camera all the time
// and acknowledges every frame at once. Prints JSON and ends by itself. Only for a daemon on this
// machine.
// Run: node tests/load/viewers.mjs --url ws://127.0.0.1:8080 --viewers 8 --seconds 10
import { parseArgs } from 'node:util';

import { Client, sleep } from '../web/client.mjs';

const MAX_VIEWERS = 64;
const MAX_SECONDS = 120;

const { values } = parseArgs({
  options: {
    url: { type: 'string', default: 'ws://127.0.0.1:8080' },
    viewers: { type: 'string', default: '8' },
    seconds: { type: 'string', default: '10' },
    width: { type: 'string', default: '640' },
    height: { type: 'string', default: '360' },
    quality: { type: 'string', default: 'interactive' },
  },
});
const viewers = Math.min(Number(values.viewers), MAX_VIEWERS);
const seconds = Math.min(Number(values.seconds), MAX_SECONDS);
if (!['127.0.0.1', 'localhost', '[::1]'].includes(new URL(values.url).hostname))
  throw new Error('only a daemon on this machine may be loaded');

async function view(index) {
  const client = await Client.open(values.url);
  const { result } = await client.call('session.hello', { name: `viewer-${index}` });
  await client.call('view.configure', {
    width: Number(values.width),
    height: Number(values.height),
    quality: values.quality,
  });
  const { eye, target } = result.camera;
  const sentAt = new Map();
  const delays = [];
  const arrivals = [];
  const takeFrame = client.takeFrame.bind(client);
  client.takeFrame = (data) => {
    takeFrame(data);
    const { cameraRevision } = client.frames.at(-1);
    client.frames.length = 0;
    arrivals.push(performance.now());
    if (sentAt.has(cameraRevision)) delays.push(performance.now() - sentAt.get(cameraRevision));
  };
  const end = performance.now() + seconds * 1000;
  for (let revision = 1; performance.now() < end; revision++) {
    const angle = revision / 30 + index;
    const moved = [eye[0] + 0.2 * Math.sin(angle), eye[1] + 0.1 * Math.cos(angle), eye[2]];
    sentAt.set(revision, performance.now());
    client.notify('camera.set', { eye: moved, target, revision });
    await sleep(33);
  }
  await client.close();
  return { arrivals: arrivals.filter((at) => at <= end), delays };
}

function quantile(sorted, q) {
  return sorted.length ? sorted[Math.min(sorted.length - 1, Math.floor(q * sorted.length))] : null;
}

const results = await Promise.all(Array.from({ length: viewers }, (_, i) => view(i)));
const rates = results.map((r) => r.arrivals.length / seconds);
const gaps = results.flatMap((r) => r.arrivals.slice(1).map((at, i) => at - r.arrivals[i]));
const delays = results.flatMap((r) => r.delays).sort((a, b) => a - b);
console.log(
  JSON.stringify({
    viewers,
    seconds,
    size: `${values.width}x${values.height}`,
    frames_per_second: {
      each: rates,
      min: Math.min(...rates),
      sum: rates.reduce((a, b) => a + b, 0),
    },
    longest_gap_ms: Math.max(0, ...gaps),
    camera_to_frame_ms: { median: quantile(delays, 0.5), p95: quantile(delays, 0.95) },
  }),
);
