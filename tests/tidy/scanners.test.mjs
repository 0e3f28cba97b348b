// Proves that every rule of tidy.test.mjs can fail: a small sample that breaks it is found, with
// file, line and limit; one that keeps it passes; and a list that allows more than there is fails,
// too.
import assert from 'node:assert/strict';
import { describe, test } from 'node:test';

import { readStructure } from './c_structure.mjs';
import { tokenize } from './c_tokens.mjs';
import { judgeConditionalIncludes } from './conditional_includes.mjs';
import { findUnused, judgeUnused, wordsOfAll } from './callers.mjs';
import { languageOf } from './files.mjs';
import { findBanned, judgeBanned, wordsOf } from './identifiers.mjs';
import { findForeignGlCalls, findIncludes, judgeIncludes, judgeLayers } from './includes.mjs';
import { readJsWords } from './js_words.mjs';
import { findExcesses, judgeExcesses } from './lengths.mjs';
import { findLoopsTestedFirst, judgeLoops } from './shader_loops.mjs';
import { findReadBlocks, judgeReadBlocks } from './storage_reads.mjs';

const file = (path, text) => ({ path, text, language: languageOf(path) });
const functionsOf = (text, language) => readStructure(tokenize(text), language).functions;
const namesOf = (text, language) => functionsOf(text, language).map(({ name }) => name);

/** A function of this many lines. */
const longFunction = (lines) => `int f(void)\n{\n${'    ;\n'.repeat(lines - 3)}}\n`;

describe('tokens', () => {
  test('comments are gone, strings and raw strings are one token', () => {
    const texts = tokenize('a /* b */ "c // d" // e\nR"x(f " g)x" \'"\' 1\'000').map(
      ({ text }) => text,
    );
    assert.deepEqual(texts, ['a', '"c // d"', 'R"x(f " g)x"', "'\"'", "1'000"]);
  });

  test('lines are counted through comments, strings and continued directives', () => {
    const tokens = tokenize('/* 1\n2 */ a\n#define B(x) \\\n    c // d\ne');
    assert.deepEqual(
      tokens.map(({ kind, text, line }) => [kind, text, line]),
      [
        ['word', 'a', 2],
        ['directive', 'define', 3],
        ['word', 'e', 5],
      ],
    );
    assert.deepEqual(
      tokens[1].inner.map(({ text, line }) => [text, line]),
      [['B', 3], ['(', 3], ['x', 3], [')', 3], ['c', 4]],
    );
  });
});

describe('functions', () => {
  test('are told from declarations, values and types', () => {
    const text = `
      struct s { int (*run)(void); };
      int declared(int a);
      static const struct s table[] = {{.run = declared}};
      static struct s *made(struct s *x)
      {
          if (x) { return x; }
          return 0;
      }`;
    assert.deepEqual(namesOf(text, 'C'), ['made']);
  });

  test('are found in namespaces, classes and after initialisers', () => {
    const text = `
      namespace a { namespace {
      class box : base { box() : base(1), size(2) {} ~box() {} int area() const { return 1; } };
      } }
      extern "C" { bool free_one(std::vector<int> &x) noexcept { return [] { return true; }(); } }
      box::box(int n) : base(n) {}
      bool operator==(const box &a, const box &b) { return true; }`;
    const functions = functionsOf(text, 'C++');
    assert.deepEqual(
      functions.filter(({ special }) => !special).map(({ name }) => name),
      ['area', 'free_one'],
    );
    assert.equal(functions.length, 6);
  });

  test('are found in GLSL beside blocks and layouts', () => {
    const text = `
      layout(local_size_x = 8) in;
      layout(std430, binding = 1) buffer cells { uint words[]; };
      float half_of(float x) { return x / 2.0; }
      void main() { words[0] = uint(half_of(2.0)); }`;
    assert.deepEqual(namesOf(text, 'GLSL'), ['half_of', 'main']);
  });

  test('survive branches of the preprocessor that each open a brace', () => {
    const text =
      'void f(void)\n{\n#if A\nif (a) {\n#else\nif (b) {\n#endif\n}\n}\nvoid g(void)\n{\n}\n';
    assert.deepEqual(namesOf(text, 'C'), ['f', 'g']);
  });
});

describe('lengths', () => {
  test('a function of 71 lines, a line of 101 columns and a file of 601 lines are found', () => {
    const columns = `// ${'x'.repeat(98)}\n`;
    const wrong = judgeExcesses(
      findExcesses([
        file('a/function.c', `\n${longFunction(71)}`),
        file('a/shader.comp', columns),
        file('a/style.css', 'a {}\n'.repeat(601)),
      ]),
      {},
    );
    assert.deepEqual(wrong, [
      'a/function.c:2: function f has 71 lines; 70 at most',
      'a/shader.comp:1: 101 columns; 100 at most in GLSL',
      'a/style.css:1: 601 lines; 600 at most',
    ]);
  });

  test('what is as long as may be passes', () => {
    const files = [
      file('a/function.cpp', `namespace a\n{\n${longFunction(70)}}\n`),
      file('a/line.mjs', `// ${'ä'.repeat(97)}\n`),
      file('a/file.c', ';\n'.repeat(600)),
    ];
    assert.deepEqual(findExcesses(files), []);
  });

  test('a figure may fall but not rise, and falls in the list, too', () => {
    const excesses = findExcesses([file('a.c', longFunction(80))]);
    const judge = (functions) => judgeExcesses(excesses, { functions });
    assert.deepEqual(judge({ 'a.c f': 80 }), []);
    assert.deepEqual(judge({ 'a.c f': 79 }), [
      'a.c:1: function f has 80 lines; 70 at most (79 allowed until now)',
    ]);
    assert.match(
      judge({ 'a.c f': 81 })[0],
      /functions: a\.c f is down from 81: lower its figure to 80/,
    );
    assert.match(
      judge({ 'a.c f': 80, 'a.c g': 72 })[0],
      /a\.c g is down from 72: take it off the list/,
    );
  });
});

describe('callers', () => {
  const header = file(
    'a.h',
    '#ifndef A_H\n#define A_H\nvoid used(void);\nvoid unused(void);\n#endif\n',
  );
  const source = (text) =>
    findUnused([header, file('a.c', text)]).map(({ line, name }) => `${line} ${name}`);

  test('a function that is only declared and calls itself is found', () => {
    const text =
      'void unused(void)\n{\n unused();\n}\nvoid used(void)\n{\n}\n' +
      'int main(void)\n{\n used();\n}\n';
    assert.deepEqual(source(text), ['1 unused']);
  });

  test('tables, macros and #if name functions; members and comments do not', () => {
    const named = 'void used(void) {}\nconst struct pass p = {.run = used};\n';
    assert.deepEqual(source(named), []);
    assert.deepEqual(source('void used(void) {}\n#define CALL used()\n#if CALL\n#endif\n'), []);
    const member = 'void used(void) {} // used()\nvoid main(void) { p->used = q.used; "used"; }\n';
    assert.deepEqual(source(member), ['1 used']);
  });

  test('shaders and C do not call each other', () => {
    const unused = findUnused([
      file('a.c', 'int main(void) { return cube(); }'),
      file('shaders/a.glsl', 'float cube(float x) { return x; }'),
    ]);
    assert.deepEqual(
      unused.map(({ path, name }) => `${path} ${name}`),
      ['shaders/a.glsl cube'],
    );
  });

  test('a macro that nothing reads is found; guards and settings of libraries are not', () => {
    const text =
      '#define STB_IMAGE_STATIC\n#ifndef SIZE\n#define SIZE 4\n#endif\n#define USED 1\n' +
      'int a[USED];\n';
    assert.deepEqual(source(text), ['3 SIZE']);
  });

  test('a function that tests call may be allowed, and the list may only shrink', () => {
    const unused = findUnused([file('a.c', 'void f(void)\n{\n}\n')]);
    const tests = wordsOfAll([file('test.c', 'int main(void) { f(); }')]);
    assert.deepEqual(judgeUnused(unused, { f: 'for tests' }, tests), []);
    assert.deepEqual(judgeUnused(unused, {}, tests), [
      'a.c:1: the product never names the function f: delete it',
    ]);
    assert.match(
      judgeUnused(unused, { f: 'for tests' }, new Set())[0],
      /no test names f: delete the function/,
    );
    assert.match(
      judgeUnused([], { f: 'for tests' }, tests)[0],
      /f is gone or has callers: take it off/,
    );
  });
});

describe('layers', () => {
  const layers = [
    { folder: 'low', may: [], why: 'knows nobody' },
    { folder: 'high', may: ['low', 'high/inner/plain.h'], why: 'stands on low' },
    { folder: 'high/inner', may: ['low'], why: 'is a room of its own' },
  ];
  const judge = (path, header, upward = []) => {
    const files = [file(path, `// first\n#include "${header}"\n#include <stdio.h>\n`)];
    return judgeIncludes(findIncludes(files), layers, upward);
  };

  test('an include that runs upward is found, and one into a room that is not listed', () => {
    assert.deepEqual(judge('low/a.c', 'high/b.h'), [
      'low/a.c:2: includes high/b.h, but low (knows nobody) may include itself and nothing else',
    ]);
    assert.match(
      judge('high/a.c', 'high/inner/b.h')[0],
      /may include itself and low, high\/inner\/plain\.h$/,
    );
    assert.match(judge('new/a.c', 'low/b.h')[0], /no row for this folder/);
  });

  test('a folder includes itself, what lies below, and single headers', () => {
    const kept = [
      ['low/a.c', 'low/b.h'],
      ['high/a.c', 'low/b.h'],
      ['high/a.c', 'high/inner/plain.h'],
    ];
    for (const [path, header] of kept)
      assert.deepEqual(judge(path, header), [], `${path} ${header}`);
  });

  test('an arrow may be allowed as long as it is there', () => {
    const arrow = { from: 'low/a.c', to: 'high/b.h', why: 'for now' };
    assert.deepEqual(judge('low/a.c', 'high/b.h', [arrow]), []);
    assert.match(
      judge('low/a.c', 'low/b.h', [arrow])[0],
      /no longer includes high\/b\.h: take it off/,
    );
  });

  test('shaders are included from their own root', () => {
    const files = [file('low/a.c', '#include "shared/b.h"\n'), file('shaders/shared/b.h', '')];
    assert.equal(findIncludes(files)[0].header, 'shaders/shared/b.h');
  });

  test('a table with a circle is found', () => {
    const circle = [
      ...layers,
      { folder: 'other', may: ['odd'], why: '' },
      { folder: 'odd', may: ['other'], why: '' },
    ];
    assert.deepEqual(judgeLayers(layers), []);
    assert.deepEqual(judgeLayers(circle), [
      'layers.mjs: other stands below itself',
      'layers.mjs: odd stands below itself',
    ]);
  });

  test('a call of GL or EGL outside of renderer/gpu is found', () => {
    const text =
      '// glFlush();\nvoid f(void)\n{\n    glFlush();\n    eglInitialize(0);\n    globe();\n}\n';
    assert.deepEqual(
      findForeignGlCalls([file('renderer/frame/view.c', text), file('renderer/gpu/gpu.c', text)]),
      [
        'renderer/frame/view.c:4: calls glFlush, which renderer/gpu/ alone may',
        'renderer/frame/view.c:5: calls eglInitialize, which renderer/gpu/ alone may',
      ],
    );
  });
});

describe('words', () => {
  const banned = [
    { word: 'lamp', instead: 'light' },
    { word: 'tree', instead: 'bvh', except: /^SceneTree$/ },
  ];
  const judge = (files, allowed = {}) => judgeBanned(findBanned(files, banned), banned, allowed);

  test('names fall into words', () => {
    assert.deepEqual(wordsOf('find_nearLamp2_MAX'), ['find', 'near', 'lamp', 'max']);
    assert.deepEqual(wordsOf('GLTexture'), ['gl', 'texture']);
  });

  test('banned words are found in C, in GLSL with its macros, and in JS', () => {
    const files = [
      file('a.c', 'int clamp;\nint spot_lamps; // a lamp\n'),
      file('a.comp', '#define MAX_LAMP 4\nfloat lamplight;\n'),
      file('a.js', 'const a = "lamp";\nthis.spotLamp = `lamp ${tree}`;\nnew SceneTree();\n'),
    ];
    assert.deepEqual(judge(files), [
      'a.c:2: spot_lamps: say light (3 identifiers say "lamp"; 0 at most)',
      'a.comp:1: MAX_LAMP: say light (3 identifiers say "lamp"; 0 at most)',
      'a.js:2: spotLamp: say light (3 identifiers say "lamp"; 0 at most)',
      'a.js:2: tree: say bvh (1 identifiers say "tree"; 0 at most)',
    ]);
  });

  test('a name counts once, and the figure may only fall', () => {
    const files = [file('a.c', 'int lamp, lamp_x; int y = lamp;'), file('b.c', 'int lamp;')];
    assert.deepEqual(judge(files, { 'lamp': 2 }), []);
    assert.equal(judge(files, { 'lamp': 1 }).length, 2);
    assert.match(
      judge(files, { 'lamp': 3 })[0],
      /lower the figure: 2 identifiers say "lamp"; 3 at most/,
    );
    assert.match(judge([], { lantern: 1 })[0], /lantern is no banned word/);
  });

  test('strings, comments and regular expressions of JS hold no names', () => {
    const text =
      'const a = b / c / d; // e\nf(/g"[/]h/i, `j${k({ l: "m" })}n`);\n' +
      '/* o */ return /p/.test(q);\n';
    const names = readJsWords(text).map((word) => word.text);
    assert.deepEqual(names, ['const', 'a', 'b', 'c', 'd', 'f', 'k', 'l', 'return', 'test', 'q']);
  });
});

describe('conditional includes', () => {
  const glsl = (/** @type {string} */ path, /** @type {string} */ text) => ({
    path,
    language: 'GLSL',
    text,
  });
  const lib = [
    glsl('shaders/lib/a.glsl', '#include "lib/b.glsl"\n'),
    glsl('shaders/lib/b.glsl', ''),
  ];

  test('of a file that includes another are found', () => {
    const file = glsl(
      'shaders/x/x.comp',
      '#if A\n#include "lib/a.glsl"\n#endif\n#include "lib/b.glsl"\n',
    );
    assert.deepEqual(judgeConditionalIncludes([...lib, file]), [
      'shaders/x/x.comp:2: includes shaders/lib/a.glsl under a condition: include ' +
        'shaders/lib/b.glsl before',
    ]);
  });

  test('are fine where that is there before', () => {
    const file = glsl(
      'shaders/x/x.comp',
      '#include "lib/b.glsl"\n#if A\n#include "lib/a.glsl"\n#endif\n',
    );
    assert.deepEqual(judgeConditionalIncludes([...lib, file]), []);
  });
});

describe('storage blocks', () => {
  const shader = {
    path: 'shaders/x/x.comp',
    language: 'GLSL',
    text:
      'layout(std430, binding = BIND_A) writeonly buffer a_storage\n{\n    uint a[];\n};\n' +
      'layout(std430, binding = BIND_B) readonly buffer b_storage\n{\n    uint b[];\n};\n',
  };

  test('that are read are found', () => {
    const found = findReadBlocks([shader]);
    assert.deepEqual(found, [{ path: 'shaders/x/x.comp', block: 'b_storage' }]);
    assert.deepEqual(judgeReadBlocks(found, {}), [
      'shaders/x/x.comp: b_storage is not writeonly: read it by a buffer texture instead',
    ]);
  });

  test('may be listed, and the list may only shrink', () => {
    const found = findReadBlocks([shader]);
    const listed = { 'shaders/x/x.comp': { b_storage: 'atomics', a_storage: 'no longer' } };
    assert.deepEqual(judgeReadBlocks(found, listed), [
      'shaders/x/x.comp: a_storage is only written: take it off the list',
    ]);
  });
});

describe('loops of shaders', () => {
  const text = `
    for (uint i = 0u; i < frame.light_count; i++) {}
    while (at != 0u) {}
    for (int i = 0; i < 8; i++) {}
    for (uint i = 0u; i < uint(STEP * STEP); i++) {}
    for (;;) {}
    do {
    } while (++i < count);
    // while (true)`;
  const found = findLoopsTestedFirst([{ path: 'shaders/x/x.comp', language: 'GLSL', text }]);

  test('that test at their start are found', () => {
    assert.deepEqual([...found], [['shaders/x/x.comp', 2]]);
    assert.deepEqual(judgeLoops(found, {}), [
      'shaders/x/x.comp: 2 loops test at their start: use do ... while',
    ]);
  });

  test('may be listed, and the list may only shrink', () => {
    assert.deepEqual(judgeLoops(found, { 'shaders/x/x.comp': { loops: 2, reason: '' } }), []);
    assert.deepEqual(judgeLoops(found, { 'shaders/x/x.comp': { loops: 3, reason: '' } }), [
      'shaders/x/x.comp: fewer loops test at their start: correct the list',
    ]);
  });
});
