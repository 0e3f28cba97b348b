// Writes the table of test_block_offsets.c: a row for each member of the blocks that its shader
// declares, nested ones too, with the name that the driver knows it by. Of arrays of structs the
// first two elements stand for all.
//
//     node block_members.mjs SHARED_FOLDER TEST_SOURCE OUTPUT
import { readFileSync, writeFileSync } from 'node:fs';

const [folder, test, output] = process.argv.slice(2);

const source = readFileSync(test, 'utf8');
/** @type {Map<string, { type: string, name: string, isArray: boolean }[]>} */
const structs = new Map();
const reached = new Set();
for (const [, header] of source.matchAll(/^#include "shared\/(.*)"$/gm)) {
  const text = readFileSync(`${folder}/${header}`, 'utf8').replace(/\/\/.*/g, '');
  for (const [, name, body] of text.matchAll(/^struct (\w+)\s*\{(.*?)^\};/gms)) {
    const members = body.matchAll(/(?:BLOCK_STRUCT\((\w+)\)|(\w+)) (\w+)(\[[^;]*\])?;/g);
    structs.set(
      name,
      [...members].map(([, inner, plain, member, array]) => ({
        type: inner ?? plain,
        name: member,
        isArray: array !== undefined,
      })),
    );
  }
}

/** Paths of all members of a struct that hold something. */
function pathsOf(struct) {
  reached.add(struct);
  return structs.get(struct).flatMap(({ type, name, isArray }) => {
    if (/^unused/.test(name)) return [];
    if (!structs.has(type)) return [isArray ? `${name}[0]` : name];
    const elements = isArray ? [`${name}[0]`, `${name}[1]`] : [name];
    return elements.flatMap((element) => pathsOf(type).map((path) => `${element}.${path}`));
  });
}

const rows = [...source.matchAll(/\{ (\w+) (\w+)(\[\])?; \}/g)]
  .filter(([, struct]) => structs.has(struct))
  .flatMap(([, struct, instance, isArray]) => {
    const name = isArray ? `${instance}[0]` : instance;
    return pathsOf(struct).map(
      (path) => `{"${name}.${path}", offsetof(struct ${struct}, ${path})},`,
    );
  });
const missing = [...structs.keys()].filter((name) => !reached.has(name));
if (missing.length > 0) throw new Error(`the shader of ${test} declares no ${missing.join(', ')}`);
writeFileSync(output, `${rows.join('\n')}\n`);
