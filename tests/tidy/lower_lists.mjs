// Lowers the figures of the lists to the present ones and removes entries that are no longer
// needed: node tests/tidy/lower_lists.mjs. Raises none, and does not follow files that have moved.
import { readFileSync, writeFileSync } from 'node:fs';

import { isCode, readSources } from './files.mjs';
import { findBanned } from './identifiers.mjs';
import { findExcesses } from './lengths.mjs';
import { BANNED } from './words.mjs';

/** The figures of `list` that are still needed, none higher than before. */
function lowered(list, figureOf) {
  const entries = Object.entries(list).map(([key, kept]) => [key, Math.min(kept, figureOf(key))]);
  return Object.fromEntries(entries.filter(([, figure]) => figure > 0));
}

function rewrite(name, change) {
  const path = new URL(name, import.meta.url);
  const list = change(JSON.parse(readFileSync(path, 'utf8')));
  writeFileSync(path, `${JSON.stringify(list, null, 2)}\n`);
}

const sources = readSources();
const excesses = findExcesses(sources);
const figureOf = (kind) => (key) =>
  excesses.find((excess) => excess.kind === kind && excess.key === key)?.figure ?? 0;
rewrite('lengths_allowed.json', (lists) =>
  Object.fromEntries(
    Object.entries(lists).map(([kind, list]) => [kind, lowered(list, figureOf(kind))]),
  ),
);

const named = sources.filter((source) => isCode(source) || source.language === 'JS');
const found = findBanned(named, BANNED);
rewrite('words_allowed.json', (list) => lowered(list, (word) => found.get(word)?.length ?? 0));
