// Proves that the clock of ./dev bench counts CPU time, and that --cpu avx2 hides AVX-512 and
// nothing else: by a look into the code that the driver has generated.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import {
  closeSync,
  existsSync,
  mkdtempSync,
  openSync,
  readFileSync,
  readSync,
  rmSync,
  writeFileSync,
} from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';
import { fileURLToPath } from 'node:url';

import { environmentOf, environmentsOf } from '../bench/programs.mjs';

const VOXCAST =
  process.env.VOXCAST ?? fileURLToPath(new URL('../../build/release/bin/voxcast', import.meta.url));

function avx512Skip() {
  if (!existsSync(VOXCAST)) return 'no voxcast is built';
  return (
    !/ avx512vl /.test(readFileSync('/proc/cpuinfo', 'utf8')) && 'this processor has no AVX-512'
  );
}

/** What a process may run that is from no file. */
function generatedCode(pid) {
  const memory = openSync(`/proc/${pid}/mem`, 'r');
  const parts = [];
  for (const line of readFileSync(`/proc/${pid}/maps`, 'utf8').split('\n')) {
    const map = /^(\w+)-(\w+) r.xp \S+ \S+ 0 *$/.exec(line);
    if (!map) continue;
    const [begin, end] = [parseInt(map[1], 16), parseInt(map[2], 16)];
    const part = Buffer.alloc(end - begin);
    parts.push(part.subarray(0, readSync(memory, part, 0, part.length, begin)));
  }
  closeSync(memory);
  return Buffer.concat(parts);
}

function countInstructions(code, path) {
  writeFileSync(path, code);
  const options = ['-D', '-b', 'binary', '-m', 'i386:x86-64', path];
  const { stdout } = spawnSync('objdump', options, { encoding: 'utf8', maxBuffer: 1 << 28 });
  const count = (pattern) => stdout.match(pattern)?.length ?? 0;
  return {
    ymm: count(/%ymm/g),
    masks: count(/%k[0-7]|%zmm/g),
    indexed: count(/vpgatherdd/g),
    fused: count(/vfn?m(add|sub)/g),
  };
}

describe('environments of ./dev bench', () => {
  let folder;
  before(() => (folder = mkdtempSync(join(tmpdir(), 'voxcast-preload-test-'))));
  after(() => rmSync(folder, { recursive: true, force: true }));

  test('the CPU clock stands still while a program sleeps', () => {
    const source = `#include <time.h>
      static double now(void) {
        struct timespec t;
        clock_gettime(CLOCK_MONOTONIC, &t);
        return t.tv_sec + t.tv_nsec * 1e-9;
      }
      int main(void) {
        double began = now();
        nanosleep(&(struct timespec){.tv_nsec = 200000000}, 0);
        return now() - began < 0.1;
      }`;
    const program = join(folder, 'sleeper');
    const built = spawnSync('cc', ['-x', 'c', '-', '-o', program], {
      input: source,
      encoding: 'utf8',
    });
    assert.equal(built.status, 0, built.stderr);
    const environment = environmentsOf('native');
    assert.equal(spawnSync(program, { env: environment('wall') }).status, 0);
    assert.equal(spawnSync(program, { env: environment('cpu') }).status, 1);
  });

  test(
    'avx2 leaves no AVX-512 in the code of the driver, but AVX2',
    { skip: avx512Skip() },
    async () => {
      for (const [cpu, masked] of [
        ['native', true],
        ['avx2', false],
      ]) {
        const args = [
          'render',
          'builtin:cornell',
          '--gi',
          'none',
          '--size',
          '64x36',
          '--gpu',
          'software',
        ];
        const env = { ...environmentOf(cpu), MESA_SHADER_CACHE_DIR: join(folder, cpu) };
        const out = ['--frames', '100000', '--out', join(folder, 'x.png')];
        const child = spawn(VOXCAST, [...args, ...out], { env, stdio: 'ignore' });
        let code = countInstructions(Buffer.alloc(0), join(folder, 'code'));
        while (code.ymm < 2000 && child.exitCode === null) {
          await sleep(1000);
          code = countInstructions(generatedCode(child.pid), join(folder, 'code'));
        }
        child.kill();
        assert.ok(code.ymm >= 2000, 'code was found');
        assert.ok(code.indexed > 0 && code.fused > 0, `${cpu}: ${JSON.stringify(code)}`);
        assert.equal(code.masks > code.ymm / 1000, masked, `${cpu}: ${JSON.stringify(code)}`);
      }
    },
  );
});
