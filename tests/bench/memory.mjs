// How many bytes a second all processors together copy, reading and writing counted.
import { availableParallelism } from 'node:os';
import { Worker, isMainThread, parentPort } from 'node:worker_threads';
import { fileURLToPath } from 'node:url';

const BLOCK_BYTES = 1 << 28; // far larger than caches
const TRIES = 8;

function copyBlocks() {
  const [from, to] = [Buffer.alloc(BLOCK_BYTES, 1), Buffer.alloc(BLOCK_BYTES, 2)];
  let best = Infinity;
  for (let i = 0; i < TRIES; i++) {
    const began = performance.now();
    from.copy(to);
    best = Math.min(best, performance.now() - began);
  }
  return (2 * BLOCK_BYTES) / best / 1e-3;
}

/** @returns {Promise<number>} bytes a second a processor, while all of them copy */
export async function measureBandwidth() {
  const workers = Array.from(
    { length: availableParallelism() },
    () => new Worker(fileURLToPath(import.meta.url)),
  );
  const rates = await Promise.all(
    workers.map(
      (worker) =>
        new Promise((resolve, reject) => {
          worker.once('message', resolve);
          worker.once('error', reject);
        }),
    ),
  );
  return rates.reduce((sum, rate) => sum + rate, 0) / rates.length;
}

if (!isMainThread) parentPort?.postMessage(copyBlocks());
