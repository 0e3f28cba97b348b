// Proves the whole of ./dev bench --against on a repository of its own, whose voxcast is a script
// with known times: which runs follow which, that a commit is built once, and that images that
// differ are refused.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { fileURLToPath } from 'node:url';

import { readOptions } from '../bench/options.mjs';
import { argumentsOf } from '../bench/programs.mjs';

// Whoever runs this by a hook of git must not have that repository changed.
for (const name of Object.keys(process.env)) if (name.startsWith('GIT_')) delete process.env[name];

const BENCH = fileURLToPath(new URL('../bench', import.meta.url));

describe('options', () => {
  test('light converges, and only interactive is content with the cache', () => {
    const job = (...args) =>
      argumentsOf(readOptions(['--against', 'X', 'builtin:furnace', ...args]).scenes[0].job);
    assert.ok(job().includes('--converge-first') && job().includes('gather_mode=cache'));
    assert.ok(!job('--quality', 'high').includes('gather_mode=cache'));
    assert.ok(!job('--at-rest').includes('--frames'));
  });

  for (const args of [
    [],
    ['--against', 'X', '--runs', '0'],
    ['--against', 'X', '--cpu', 'sse'],
    ['--against', 'X', '--clock', 'sun'],
    ['--against', 'X', '--moving', '--at-rest'],
    ['--against', 'X', '--size', '9'],
    ['--against', 'X', '--unknown'],
  ])
    test(`refuses "${args.join(' ')}"`, () =>
      assert.throws(() => readOptions(args), { usage: true }));
});

const statisticsOf = (ms) => ({
  gl_renderer: 'llvmpipe',
  frames: 10,
  frame_ms: { median: ms },
  passes: [{ name: 'gbuffer', ran: true, frames: 10, ms: { median: ms / 2 } }],
});

// A voxcast that takes as long as it says, and whose image holds what it says.
const SCRIPT = (name, ms, byte) => `#!/bin/sh
printf '%s' ${name} >>"$BENCH_LOG"
while [ $# -gt 0 ]; do
    case $1 in --out) out=$2 ;; --stats) stats=$2 ;; esac
    shift
done
printf 'PF\\n1 1\\n-1.0\\n\\000\\000\\000\\${byte}\\000\\000\\000\\000\\000\\000\\000\\000' >"$out"
printf '%s' '${JSON.stringify(statisticsOf(ms))}' >"$stats"
`;

describe('./dev bench --against', () => {
  let folder, root, log;

  const git = (...args) => {
    const identity = ['-c', 'user.name=x', '-c', 'user.email=x@example.org'];
    const { status, stderr } = spawnSync('git', ['-C', root, ...identity, ...args], {
      encoding: 'utf8',
    });
    assert.equal(status, 0, stderr);
  };
  const bench = (...args) => {
    writeFileSync(log, '');
    const env = { ...process.env, XDG_CACHE_HOME: join(folder, 'cache'), BENCH_LOG: log };
    return spawnSync('node', [join(root, 'tests/bench/bench.mjs'), ...args], {
      encoding: 'utf8',
      env,
    });
  };
  const putProgram = (...what) => {
    mkdirSync(join(root, 'build/release/bin'), { recursive: true });
    writeFileSync(join(root, 'build/release/bin/voxcast'), SCRIPT(...what), { mode: 0o755 });
  };

  before(() => {
    folder = mkdtempSync(join(tmpdir(), 'voxcast-bench-test-'));
    root = join(folder, 'tree');
    log = join(folder, 'log');
    cpSync(BENCH, join(root, 'tests/bench'), { recursive: true });
    const preset = { name: 'release', generator: 'Ninja', binaryDir: '${sourceDir}/build/release' };
    writeFileSync(
      join(root, 'CMakePresets.json'),
      JSON.stringify({ version: 3, configurePresets: [preset] }),
    );
    const copy = 'COMMAND cmake -E copy ${CMAKE_SOURCE_DIR}/script bin/voxcast';
    writeFileSync(
      join(root, 'CMakeLists.txt'),
      `cmake_minimum_required(VERSION 3.25)\nproject(x NONE)\nadd_custom_target(voxcast ${copy})\n`,
    );
    writeFileSync(join(root, '.gitignore'), '/build/\n');
    writeFileSync(join(root, 'script'), SCRIPT('B', 20, '000'), { mode: 0o755 });
    git('init', '--quiet');
    git('add', '.');
    git('commit', '--quiet', '-m', 'x');
  });
  after(() => rmSync(folder, { recursive: true, force: true }));

  test('draws once, then takes turns, and builds a commit once', () => {
    putProgram('A', 10, '000');
    const args = ['--against', 'HEAD', 'builtin:x', '--runs', '2', '--json'];
    const { status, stdout, stderr } = bench(...args);
    assert.equal(status, 0, stderr);
    assert.match(stderr, /building/);
    assert.equal(readFileSync(log, 'latin1'), 'AB' + 'ABBA' + 'BAAB');
    const [{ clocks, image, unequal }] = JSON.parse(stdout).scenes;
    assert.ok(image.equal);
    assert.deepEqual(unequal, []);
    for (const clock of ['wall', 'cpu'])
      assert.deepEqual(
        clocks[clock].map(({ name, ratio }) => [name, ratio.median]),
        [
          ['frame', 0.5],
          ['gbuffer', 0.5],
        ],
      );
    const again = bench(...args);
    assert.equal(again.status, 0, again.stderr);
    assert.ok(!/building/.test(again.stderr));
  });

  test('refuses images that differ, unless they may', () => {
    putProgram('A', 10, '100');
    const refused = bench('--against=HEAD', 'builtin:x', '--runs', '1');
    assert.equal(refused.status, 1, refused.stderr);
    assert.match(refused.stdout, /images differ in 1 pixels \(100\.00 %\) within 0,0 to 0,0/);
    assert.match(refused.stdout, /not measured/);
    assert.equal(readFileSync(log, 'latin1'), 'ABA', 'no more than the images and a repetition');
    const one = ['builtin:x', '--runs', '1', '--clock', 'cpu'];
    const allowed = bench('--against', 'HEAD', ...one, '--allow-differences');
    assert.equal(allowed.status, 0, allowed.stderr);
    assert.match(allowed.stdout, /frame +10\.00 +20\.00 +0\.500 +0\.500\.\.0\.500\n/);
    assert.equal(readFileSync(log, 'latin1'), 'ABA' + 'AB');
  });

  test('tells in one line what it cannot do', () => {
    for (const [args, wanted, message] of [
      [['--against', 'nothing'], 1, /^bench: no revision nothing\n$/],
      [['--against', 'HEAD', '--runs', 'x'], 2, /^bench: --runs is "x"; 1 to 1000; see/],
      [['--cpu', 'sse'], 2, /^bench: --cpu is "sse"; one of native, avx2\n$/],
    ]) {
      const { status, stderr } = bench(...args);
      assert.equal(status, wanted, stderr);
      assert.match(stderr, message);
    }
  });
});
