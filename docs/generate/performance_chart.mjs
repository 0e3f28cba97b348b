// The passes of a scene as bars: time, and within it what moving the bytes takes.
import { svgOf } from './svg.mjs';

const WIDTH = 900;
const LEFT = 170; // of the bars; names stand before
const RIGHT = 120; // after the longest bar, for its figures
const TOP = 44;
const BAR = 13;
const GAP = 10; // between passes

/** What a pass must take to move its bytes, in milliseconds of one processor. */
export const limitMs = (bytes, machine) => bytes / machine.copy_gb_per_s / 1e6;

const figure = (/** @type {number} */ ms) => (ms >= 100 ? ms.toFixed(0) : ms.toFixed(1));

function legendOf(names) {
  const entries = [
    ...names.map((name) => ({ name: `CPU time, ${name}`, kind: name })),
    { name: 'of it, what moving its bytes takes at the speed of a copy', kind: 'limit' },
  ];
  return entries.flatMap(({ name, kind }, i) => {
    const x = LEFT + i * 150;
    return [
      { tag: 'rect', attributes: { class: kind, x, y: 14, width: 12, height: 12 } },
      { tag: 'text', attributes: { x: x + 18, y: 24 }, text: name },
    ];
  });
}

/** @param {any} scene of the figures @param {any} machine @returns {string} */
export function performanceSvg(scene, machine) {
  const names = Object.keys(scene.cpus);
  const passes = [...new Set(names.flatMap((cpu) => scene.cpus[cpu].passes.map((p) => p.name)))];
  const all = names.flatMap((cpu) => scene.cpus[cpu].passes.map(({ ms }) => ms));
  const scale = (WIDTH - LEFT - RIGHT) / Math.max(...all, 1e-3);
  const pitch = names.length * BAR + GAP;
  const shapes = legendOf(names);
  passes.forEach((pass, row) => {
    const top = TOP + row * pitch;
    const middle = top + (names.length * BAR) / 2 + 4;
    const at = { class: 'name', x: LEFT - 8, y: middle, 'text-anchor': 'end' };
    shapes.push({ tag: 'text', attributes: at, text: pass });
    names.forEach((cpu, i) => {
      const found = scene.cpus[cpu].passes.find(({ name }) => name === pass);
      if (!found) return;
      const y = top + i * BAR;
      const width = found.ms * scale;
      const bar = { y, height: BAR - 2 };
      const limit = Math.min(limitMs(found.bytes, machine) * scale, width);
      shapes.push({ tag: 'rect', attributes: { class: cpu, x: LEFT, width, ...bar } });
      shapes.push({ tag: 'rect', attributes: { class: 'limit', x: LEFT, width: limit, ...bar } });
      const label = { x: LEFT + width + 6, y: y + BAR - 3 };
      shapes.push({ tag: 'text', attributes: label, text: `${figure(found.ms)} ms` });
    });
  });
  return svgOf(shapes, { width: WIDTH, height: TOP + passes.length * pitch + 6 });
}
