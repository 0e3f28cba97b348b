// Proves what ./dev does before and around a build: it names a tool that is too old before anything
// is built, recovers a build folder that a failure left half-configured, and ./dev bare leaves
// nothing behind when it is interrupted and says so where it cannot run.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import {
  chmodSync,
  cpSync,
  existsSync,
  mkdirSync,
  mkdtempSync,
  readFileSync,
  readdirSync,
  readlinkSync,
  rmSync,
  statSync,
  writeFileSync,
} from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { fileURLToPath } from 'node:url';

const ROOT = fileURLToPath(new URL('../..', import.meta.url));

describe('./dev', () => {
  let folder, checkout, bin;

  // A checkout with build folders of its own, and a folder of programs that take precedence
  // over others.
  before(() => {
    folder = mkdtempSync(join(tmpdir(), 'voxcast-dev-'));
    checkout = join(folder, 'checkout');
    bin = join(folder, 'bin');
    mkdirSync(checkout);
    mkdirSync(bin);
    const files = spawnSync('git', ['-C', ROOT, 'ls-files', '-z', '-co', '--exclude-standard'], {
      encoding: 'utf8',
    });
    for (const file of files.stdout.split('\0'))
      if (file && existsSync(join(ROOT, file))) cpSync(join(ROOT, file), join(checkout, file));
    for (const name of ['lil-gui', 'uplot', '.package-lock.json'])
      cpSync(
        join(ROOT, 'web_client/node_modules', name),
        join(checkout, 'web_client/node_modules', name),
        { recursive: true },
      );
  });
  after(() => rmSync(folder, { recursive: true, force: true }));

  function put(name, script) {
    writeFileSync(join(bin, name), `#!/bin/sh\n${script}\n`);
    chmodSync(join(bin, name), 0o755);
  }

  function dev(args, env = {}) {
    const path = `${bin}:${process.env.PATH}`;
    return spawnSync('./dev', args, {
      cwd: checkout,
      encoding: 'utf8',
      env: { ...process.env, PATH: path, ...env },
    });
  }

  for (const [name, script, message] of [
    ['cc', 'echo 9.4.0', /the C compiler cc is version 9\.4\.0; voxcast needs 12 or newer/],
    ['node', 'echo v16.20.0', /node is version 16\.20\.0; voxcast needs 18\.18 or newer/],
    [
      'cmake',
      'echo cmake version 3.18.4',
      /cmake is version 3\.18\.4; voxcast needs 3\.25 or newer/,
    ],
    [
      'dpkg-query',
      'case "$*" in *Version*libgl1-mesa-dri*) echo 20.3.5-1 ;; *) exec /usr/bin/dpkg-query ' +
        '"$@" ;; esac',
      /Mesa \(libgl1-mesa-dri\) is version 20\.3\.5-1; voxcast needs 22\.3 or newer/,
    ],
  ])
    test(`names a ${name} that is too old before it builds`, () => {
      put(name, script);
      const { status, stderr } = dev(['build']);
      rmSync(join(bin, name));
      assert.equal(status, 1);
      assert.match(stderr, message);
      assert.ok(!existsSync(join(checkout, 'build')), 'nothing was built');
    });

  test('heals a folder whose configuring failed, and builds no tests to run', () => {
    const broken = dev(['build'], { PKG_CONFIG_LIBDIR: '/nonexistent' });
    assert.notEqual(broken.status, 0);
    assert.match(broken.stderr, /epoxy/);
    assert.ok(
      existsSync(join(checkout, 'build/release/CMakeCache.txt')),
      'the folder is half-configured',
    );
    const { status, stderr } = dev(['build']);
    assert.equal(status, 0, stderr);
    assert.ok(existsSync(join(checkout, 'build/release/bin/voxcastd')));
    assert.ok(!existsSync(join(checkout, 'build/release/bin/test_options')), 'no test is built');
    const started = performance.now();
    assert.equal(dev(['build']).stderr, '', 'what is done is skipped without a word');
    assert.ok(performance.now() - started < 20000);
  });
});

describe('./dev bare', { skip: process.getuid() !== 0 && 'only root can make a bare root' }, () => {
  const BARE = join(ROOT, 'tests/bare/bare.sh');
  const gitObjects = () => {
    const { stdout } = spawnSync('git', ['-C', ROOT, 'rev-parse', '--git-path', 'objects'], {
      encoding: 'utf8',
    });
    const folder = resolve(ROOT, stdout.trim());
    return readdirSync(folder, { recursive: true }).map((name) => join(folder, name));
  };

  test('says in one line that it can do nothing', () => {
    const { status, stderr } = spawnSync(BARE, ['run'], {
      encoding: 'utf8',
      uid: 65534,
      env: { ...process.env, HOME: '/tmp' },
    });
    assert.equal(status, 77);
    assert.match(stderr, /^dev bare: skipped, no bare root can be made here: not root\n$/);
  });

  test('ends all that it began when it is interrupted', { timeout: 600000 }, async (t) => {
    const child = spawn(BARE, ['run'], { stdio: ['ignore', 'ignore', 'pipe'] });
    let log = '';
    child.stderr.on('data', (data) => (log += data));
    const ended = new Promise((done) => child.on('exit', (code, signal) => done(code ?? signal)));
    // While packages are being installed, by apt that sudo called.
    let code = await Promise.race([
      ended,
      new Promise((done) =>
        child.stderr.on('data', () => /packages: installing/.test(log) && done('begun')),
      ),
    ]);
    if (code === 77) return t.skip(log.trim());
    assert.equal(code, 'begun', log);
    child.kill('SIGINT');
    code = await ended;
    assert.equal(code, 130, log);
    const work = /root in (.+)/.exec(log)[1];
    assert.ok(!existsSync(work), 'the root is gone');
    assert.ok(!readFileSync('/proc/self/mounts', 'utf8').includes(work), 'no mount is left');
    const left = readdirSync('/proc').filter((pid) => {
      try {
        return readlinkSync(`/proc/${pid}/root`).startsWith(work);
      } catch {
        return false; // no process, or one that has just ended
      }
    });
    assert.deepEqual(left, [], 'no process is left');
    const owner = (path) => statSync(path).uid;
    assert.ok(
      gitObjects().every((path) => owner(path) === owner(ROOT)),
      'the checkout that was cloned keeps its owner',
    );
  });
});
