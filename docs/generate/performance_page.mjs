// docs/performance.md from the figures of ./dev bench --report.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { limitMs, performanceSvg } from './performance_chart.mjs';

const PASSES = fileURLToPath(new URL('../performance/passes.json', import.meta.url));

const CPU_NAMES = { native: 'all that the processor has', avx2: 'AVX2, no AVX-512' };

const fixed = (/** @type {number} */ value) => (value >= 100 ? value.toFixed(0) : value.toFixed(1));

/** @param {any} scene @param {string} cpu @param {any} machine */
function tableOf(scene, cpu, machine) {
  const [width, height] = scene.size.split('x').map(Number);
  const rows = scene.cpus[cpu].passes.map(({ name, ms, bytes }) => {
    const limit = limitMs(bytes, machine);
    const cycles = (ms * machine.clock_ghz * 1e6) / (width * height);
    return `| ${[
      `\`${name}\``,
      fixed(ms),
      (bytes / (width * height)).toFixed(0),
      (bytes / 1e6).toFixed(1),
      limit.toFixed(2),
      bytes > 0 ? fixed(ms / limit) : '–',
      cycles.toFixed(0),
    ].join(' | ')} |`;
  });
  return [
    `${CPU_NAMES[cpu]}: a frame takes ${fixed(scene.cpus[cpu].frame_ms)} ms of CPU time.`,
    '',
    '| pass | CPU ms | bytes a pixel | MB | ms to copy them | times that | cycles a pixel |',
    '|---|--:|--:|--:|--:|--:|--:|',
    ...rows,
    '',
  ].join('\n');
}

function sceneText(scene, machine) {
  return [
    `## ${scene.name}`,
    '',
    `Method ${scene.gi}.`,
    '',
    `![Bars of the passes of ${scene.name}](performance/${scene.name}.svg)`,
    '',
    ...Object.keys(scene.cpus).map((cpu) => tableOf(scene, cpu, machine)),
  ].join('\n');
}

/** The page's text. @param {any} figures @param {Record<string, string>} sentences of passes */
export function performancePage({ revision, machine, scenes }, sentences) {
  const renderer = Object.values(scenes[0].cpus)[0].renderer;
  const reported = new Set(
    scenes.flatMap(({ cpus }) =>
      Object.values(cpus).flatMap(({ passes }) => passes.map(({ name }) => name)),
    ),
  );
  return `# Performance

Where the time of a moving frame goes, at 640x360 and \`interactive\`. \`./dev bench --report\`
measures and writes this page. Revision ${revision}, ${renderer}.

- **CPU ms**: CPU time of all threads, per frame, once light has converged; the median of runs.
- **Bytes**: what the pass reads and writes of the view's own resources, each once as a whole, by
  the declarations of passes and the rows of \`frame.def\`. What it reads of the scene, of voxels
  and of shadow maps depends on the content and does not count.
- **ms to copy them**: at ${machine.copy_gb_per_s} GB/s, read and written bytes together, which one
  of this machine's ${machine.processors} processors gets while all of them copy. **Times that**:
  CPU time over it; 1 is the limit of memory.
- **Cycles a pixel**: CPU time at the clock of ${machine.clock_ghz} GHz. It stands for instructions,
  which can't be counted where a virtual machine hides the processor's counters (\`perf stat -e
  instructions\`): a core begins two or three vector instructions of 8 or 16 lanes a cycle at most.

Where the dark part of a bar is short, memory's speed is not what the pass waits for.

## What takes the rest

| pass | what its time goes into, beyond moving bytes |
|---|---|
${Object.entries(sentences)
  .filter(([name]) => reported.has(name))
  .map(([name, text]) => `| \`${name}\` | ${text} |`)
  .join('\n')}

${scenes.map((scene) => sceneText(scene, machine)).join('\n')}`;
}

export const readSentences = () => JSON.parse(readFileSync(PASSES, 'utf8'));

/** @param {string} docs the folder @param {any} figures */
export function writePerformancePage(docs, figures) {
  for (const scene of figures.scenes)
    writeFileSync(
      join(docs, `performance/${scene.name}.svg`),
      performanceSvg(scene, figures.machine),
    );
  writeFileSync(join(docs, 'performance.md'), performancePage(figures, readSentences()));
}
