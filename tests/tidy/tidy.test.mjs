// Proves that the sources keep the project's rules: lengths, no code without callers, layers, and
// the field's words in names. What breaks a rule today is in a list beside this file, with a figure
// or a reason. A list may only shrink: entries that are no longer needed fail, too.
// scanners.test.mjs shows that each rule can fail.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';

import { findUnused, judgeUnused, wordsOfAll } from './callers.mjs';
import { CALLED_BY_TESTS } from './callers_allowed.mjs';
import { judgeConditionalIncludes } from './conditional_includes.mjs';
import { isCode, isProduct, readSources } from './files.mjs';
import { findBanned, judgeBanned } from './identifiers.mjs';
import { findForeignGlCalls, findIncludes, judgeIncludes, judgeLayers } from './includes.mjs';
import { LAYERS, UPWARD } from './layers.mjs';
import { findExcesses, judgeExcesses } from './lengths.mjs';
import { LOOPS_TESTED_FIRST, findLoopsTestedFirst, judgeLoops } from './shader_loops.mjs';
import { READ_BLOCKS, findReadBlocks, judgeReadBlocks } from './storage_reads.mjs';
import { BANNED } from './words.mjs';

const sources = readSources();
const code = sources.filter(isCode);
const product = code.filter(isProduct);

const readList = (name) => JSON.parse(readFileSync(new URL(name, import.meta.url), 'utf8'));

/** @param {string[]} wrong */
const assertNone = (wrong) => assert.ok(wrong.length === 0, `\n${wrong.join('\n')}`);

test('finds the sources', () => {
  for (const path of ['dev', 'renderer/renderer.h', 'shaders/lib/frame.glsl', 'web_client/app.js'])
    assert.ok(
      sources.some((source) => source.path === path),
      path,
    );
});

test('files, lines and functions are short', () => {
  assertNone(judgeExcesses(findExcesses(sources), readList('lengths_allowed.json')));
});

test('every function and every macro of the product is used there', () => {
  const named = wordsOfAll(code.filter((file) => !isProduct(file)));
  assertNone(judgeUnused(findUnused(product), CALLED_BY_TESTS, named));
});

test('folders include what lies below them', () => {
  assertNone([...judgeLayers(LAYERS), ...judgeIncludes(findIncludes(product), LAYERS, UPWARD)]);
});

test('shaders include nothing under a condition that others would miss', () => {
  assertNone(judgeConditionalIncludes(sources.filter(({ language }) => language === 'GLSL')));
});

test('shaders read storage blocks only where they must', () => {
  const shaders = sources.filter(({ language }) => language === 'GLSL');
  assertNone(judgeReadBlocks(findReadBlocks(shaders), READ_BLOCKS));
});

test('loops of shaders test at their end', () => {
  const shaders = sources.filter(({ language }) => language === 'GLSL');
  assertNone(judgeLoops(findLoopsTestedFirst(shaders), LOOPS_TESTED_FIRST));
});

test('renderer/gpu alone calls GL and EGL', () => {
  assertNone(findForeignGlCalls(product));
});

test("names use the field's words", () => {
  const named = sources.filter((source) => isCode(source) || source.language === 'JS');
  assertNone(judgeBanned(findBanned(named, BANNED), BANNED, readList('words_allowed.json')));
});
