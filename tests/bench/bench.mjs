// ./dev bench: voxcast bench of this tree; with --against, this tree's program compared with
// another revision's; with --report, docs/performance.md.
import { spawnSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { benchAgainst } from './against.mjs';
import { CPUS, environmentOf } from './programs.mjs';

const ROOT = fileURLToPath(new URL('../..', import.meta.url));
const PROGRAM = join(ROOT, 'build/release/bin/voxcast');

const HELP = `
./dev bench takes these, too:
  --cpu native|avx2     avx2: the driver generates no AVX-512, as where there is none
  --report              write docs/performance.md; see ./dev bench --report --help
  --against REVISION    compare with another revision; see ./dev bench --against REVISION --help
`;

/** @param {string} message @param {number} status @returns {never} */
function fail(message, status) {
  process.stderr.write(`bench: ${message}\n`);
  process.exit(status);
}

/** Takes "--cpu NAME" or "--cpu=NAME" out of the arguments. @param {string[]} args */
function takeCpu(args) {
  const at = args.findIndex((arg) => /^--cpu(=|$)/.test(arg));
  if (at < 0) return { cpu: 'native', rest: args };
  const joined = args[at].includes('=');
  const cpu = joined ? args[at].slice('--cpu='.length) : (args[at + 1] ?? '');
  if (!CPUS.includes(cpu)) fail(`--cpu is "${cpu}"; one of ${CPUS.join(', ')}`, 2);
  return { cpu, rest: [...args.slice(0, at), ...args.slice(at + (joined ? 1 : 2))] };
}

/** @param {string[]} args */
function benchAlone(args) {
  const { cpu, rest } = takeCpu(args);
  if (cpu !== 'native') process.stderr.write(`bench: code for ${cpu} alone\n`);
  const { status } = spawnSync(PROGRAM, ['bench', ...rest], {
    stdio: 'inherit',
    env: environmentOf(cpu),
  });
  if (rest.includes('--help')) process.stdout.write(HELP);
  process.exitCode = status ?? 1;
}

/** The page has modules of its own, which nothing else needs. @param {string[]} args */
async function writeReport(args) {
  const { benchReport } = await import('./report.mjs');
  await benchReport(ROOT, PROGRAM, args);
}

const args = process.argv.slice(2);
if (!existsSync(PROGRAM)) fail('build/release is not built; run ./dev bench', 1);
const refuse = (/** @type {any} */ error) => fail(error.message, error.usage ? 2 : 1);
if (args.includes('--report')) writeReport(args).catch(refuse);
else if (args.some((arg) => /^--against(=|$)/.test(arg)))
  benchAgainst(ROOT, PROGRAM, args).catch(refuse);
else benchAlone(args);
