// Proves that docs/performance.md is what its figures say, that each pass of frame.def has its
// sentence, and that no label of a chart covers another or leaves the chart.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';

import { limitMs, performanceSvg } from '../../docs/generate/performance_chart.mjs';
import { performancePage, readSentences } from '../../docs/generate/performance_page.mjs';

const read = (path) => readFileSync(new URL(`../../${path}`, import.meta.url), 'utf8');
const figures = JSON.parse(read('docs/performance/figures.json'));

test('each pass has one sentence', () => {
  const passes = [...read('renderer/frame/frame.def').matchAll(/^PASS\(\w+, (\w+),/gm)].map(
    ([, name]) => name,
  );
  const sentences = readSentences();
  assert.ok(passes.length > 10);
  assert.deepEqual(Object.keys(sentences).sort(), passes.sort());
  for (const [name, text] of Object.entries(sentences))
    assert.match(text, /^[A-Z][^\n|]{10,200}\.$/, `${name}: one sentence`);
});

test('the page and its charts are those of the figures', () => {
  assert.equal(read('docs/performance.md'), performancePage(figures, readSentences()));
  for (const scene of figures.scenes)
    assert.equal(
      read(`docs/performance/${scene.name}.svg`),
      performanceSvg(scene, figures.machine),
    );
});

test('labels neither meet nor leave the chart', () => {
  const passes = Array.from({ length: 20 }, (_, i) => ({
    name: `a_pass_with_long_name_${i}`,
    ms: i * 61.7,
    bytes: 1e7,
  }));
  const cpus = { native: { passes }, avx2: { passes } };
  const svg = performanceSvg({ cpus }, { copy_gb_per_s: 10 });
  const labels = [...svg.matchAll(/<text[^>]* x="([\d.]+)" y="([\d.]+)"([^>]*)>([^<]*)/g)].map(
    ([, x, y, rest, text]) => {
      const width = 6.6 * text.length;
      const left = rest.includes('end') ? Number(x) - width : Number(x);
      return { text, left, right: left + width, top: Number(y) - 10, bottom: Number(y) };
    },
  );
  assert.equal(labels.length, 3 + 20 + 40);
  labels.forEach((a, i) => {
    assert.ok(a.left >= 0 && a.right <= 900, a.text);
    for (const b of labels.slice(i + 1))
      assert.ok(
        a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top,
        `${a.text} meets ${b.text}`,
      );
  });
});

test('bytes at the speed of a copy', () => {
  assert.equal(limitMs(20e6, { copy_gb_per_s: 10 }), 2);
});
