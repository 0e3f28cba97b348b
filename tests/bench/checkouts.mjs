// Builds of other revisions: a worktree a commit below ~/.cache/voxcast/bench, kept for whoever
// asks next.
import { spawnSync } from 'node:child_process';
import {
  existsSync,
  mkdirSync,
  readdirSync,
  rmSync,
  statSync,
  utimesSync,
  writeFileSync,
} from 'node:fs';
import { homedir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

const FORGOTTEN_AFTER_MS = 30 * 86400e3;

const CACHE = join(process.env.XDG_CACHE_HOME || join(homedir(), '.cache'), 'voxcast/bench');

/** Written last, so that a checkout without it is one that an interruption left. */
const stampOf = (/** @type {string} */ checkout) => join(checkout, 'build/bench-built');

/**
 * @param {string[]} command
 * @param {import('node:child_process').SpawnSyncOptions} [options]
 * @returns {string} stdout
 */
function run([program, ...args], options = {}) {
  const done = spawnSync(program, args, { encoding: 'utf8', maxBuffer: 1 << 26, ...options });
  if (done.status === 0) return done.stdout;
  const output = `${done.stdout ?? ''}${done.stderr ?? done.error}`
    .trim()
    .split('\n')
    .slice(-20)
    .join('\n');
  throw new Error(`${[program, ...args].join(' ')} failed:\n${output}`);
}

/** @param {string} root @param {string} revision @returns {string} the commit's hash */
export function resolveCommit(root, revision) {
  const found = spawnSync('git', [
    '-C',
    root,
    'rev-parse',
    '--verify',
    '--quiet',
    `${revision}^{commit}`,
  ]);
  if (found.status !== 0) throw new Error(`no revision ${revision}`);
  return found.stdout.toString().trim();
}

/** The working tree in words: its commit, and whether it differs from that. */
export const describeCheckout = (/** @type {string} */ root) =>
  run(['git', '-C', root, 'describe', '--always', '--abbrev=7', '--exclude=*', '--dirty']).trim();

/**
 * What nobody has asked for in a month is removed. @param {string} root @param {string} checkouts
 */
function forgetOld(root, checkouts) {
  for (const name of readdirSync(checkouts)) {
    const stamp = stampOf(join(checkouts, name));
    if (existsSync(stamp) && Date.now() - statSync(stamp).mtimeMs > FORGOTTEN_AFTER_MS)
      rmSync(join(checkouts, name), { recursive: true, force: true });
  }
  run(['git', '-C', root, 'worktree', 'prune']);
}

/**
 * Objects come from the compiler's cache where other folders have compiled them.
 * @param {string} root  a repository that has the commit
 * @param {string} commit
 * @param {(what: string) => void} tell
 * @returns {string} the path of its voxcast
 */
export function buildCommit(root, commit, tell) {
  const checkouts = join(CACHE, 'checkouts');
  const checkout = join(checkouts, commit.slice(0, 12));
  const program = join(checkout, 'build/release/bin/voxcast');
  mkdirSync(checkouts, { recursive: true });
  if (!existsSync(stampOf(checkout)) || !existsSync(program)) {
    tell(`building ${commit.slice(0, 7)}`);
    rmSync(checkout, { recursive: true, force: true });
    run(['git', '-C', root, 'worktree', 'prune']);
    run(['git', '-C', root, 'worktree', 'add', '--quiet', '--detach', checkout, commit]);
    const env = { ...process.env, CCACHE_BASEDIR: checkout, CCACHE_NOHASHDIR: '1' };
    run(['cmake', '--preset', 'release'], { cwd: checkout, env });
    run(['cmake', '--build', 'build/release', '--target', 'voxcast'], { cwd: checkout, env });
    writeFileSync(stampOf(checkout), '');
  }
  utimesSync(stampOf(checkout), new Date(), new Date());
  forgetOld(root, checkouts);
  return program;
}

/** @param {string} name of a source beside this file, without .c @param {string[]} options */
function compile(name, options) {
  const source = fileURLToPath(new URL(`${name}.c`, import.meta.url));
  const built = join(CACHE, `${name}-${process.pid}.so`);
  mkdirSync(CACHE, { recursive: true });
  process.on('exit', () => rmSync(built, { force: true }));
  run([process.env.CC || 'cc', '-O2', ...options, '-o', built, source, '-ldl']);
  return built;
}

/**
 * A library to preload, from a source beside this file.
 * @param {string} name  without .c
 * @returns {string} its path
 */
export const buildPreload = (name) => compile(name, ['-shared', '-fPIC']);

/**
 * What a program says that is made from a source beside this file.
 * @param {string} name  without .c
 */
export const runTool = (name) => run([compile(name, [])]).trim();
