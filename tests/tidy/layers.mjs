// Which folder may include which: the one table. A folder may include itself and what its row
// lists: single headers, or folders. A listed folder does not stand for folders inside it that have
// rows of their own.

import { readdirSync } from 'node:fs';

/** @typedef {{ folder: string, may: string[], why: string }} Layer */
/**
 * @typedef {{ from: string, to: string, why: string }} Arrow a file that includes a header against
 *   the table
 */

/** Made by CMake: where sources and shaders lie. */
const PATHS = 'voxcast_paths.h';

/** Plain data and small services below all folders of the renderer. */
const BASE = ['renderer/error.h', 'renderer/log.h', 'renderer/clock.h', 'renderer/hash.h'];
const SETTINGS = ['renderer/settings.h', 'renderer/parameter_types.h'];

/** What users of the renderer may include besides renderer.h: plain data and pure functions. */
const API = [
  'renderer/renderer.h',
  'renderer/process_memory.h',
  'renderer/camera.h',
  'renderer/metrics',
  ...BASE,
  ...SETTINGS,
];

/** The methods of global illumination: each folder of renderer/gi. */
const METHODS = readdirSync(new URL('../../renderer/gi', import.meta.url), { withFileTypes: true })
  .filter((entry) => entry.isDirectory())
  .map(({ name }) => `renderer/gi/${name}`);

/** @type {Layer[]} */
export const LAYERS = [
  { folder: 'protocol/parameters', may: [], why: 'data, which both protocol and renderer read' },
  { folder: 'protocol', may: ['protocol/parameters'], why: 'pure: parse, validate, encode' },

  { folder: 'shaders/shared', may: [], why: 'read by C and GLSL alike' },
  { folder: 'shaders/lib', may: ['shaders/shared'], why: 'what shaders of several stages need' },
  ...['debug', 'gi', 'light', 'post', 'visibility', 'voxel'].map((stage) => ({
    folder: `shaders/${stage}`,
    may: ['shaders/lib', 'shaders/shared'],
    why: 'stages share by shaders/lib alone',
  })),

  {
    folder: 'renderer/gpu',
    may: ['shaders/shared', ...BASE],
    why: 'the ground floor; alone calls GL and EGL',
  },
  {
    folder: 'renderer/scene',
    may: ['renderer/image', 'protocol/parameters', ...BASE, ...SETTINGS],
    why: 'the document alone: no GPU, no files',
  },
  { folder: 'renderer/cache', may: BASE, why: 'bytes on disk; knows no scene' },
  {
    folder: 'renderer/image',
    may: ['renderer/cache', ...BASE],
    why: 'pixels of textures: decoded and cached',
  },
  {
    folder: 'renderer/import',
    may: ['renderer/scene', 'renderer/image', ...BASE],
    why: 'files to documents',
  },
  {
    folder: 'renderer/import/builtin',
    may: ['renderer/import', 'renderer/scene'],
    why: 'scenes made by code',
  },
  {
    folder: 'renderer/gpu_scene',
    may: [
      'renderer/gpu',
      'renderer/scene',
      'renderer/image',
      'renderer/cache',
      'shaders/shared',
      ...BASE,
      ...SETTINGS,
    ],
    why: 'the scene as the GPU holds it',
  },
  {
    folder: 'renderer/metrics',
    may: ['shaders/shared', ...BASE, ...SETTINGS],
    why: 'compares images; knows no scene',
  },
  {
    folder: 'renderer/path_tracer',
    may: [
      'renderer/scene',
      'renderer/image',
      'shaders/shared',
      'renderer/camera.h',
      ...BASE,
      ...SETTINGS,
    ],
    why: 'runs on the CPU alone',
  },
  {
    folder: 'renderer/frame',
    may: [
      'renderer/gpu_scene',
      'renderer/gpu',
      'renderer/scene',
      'renderer/path_tracer',
      'protocol/parameters',
      'shaders/shared',
      'renderer/camera.h',
      ...BASE,
      ...SETTINGS,
    ],
    why: 'a frame and its view: plain data and targets, which GI and passes work on',
  },
  {
    folder: 'renderer/gi',
    may: ['renderer/frame', 'renderer/scene', ...BASE, ...SETTINGS],
    why: 'the seam: the methods, and what a renderer keeps for them',
  },
  ...METHODS.map((folder) => ({
    folder,
    may: [
      'renderer/gi',
      'renderer/frame',
      'renderer/gpu_scene',
      'renderer/path_tracer',
      'renderer/gpu',
      'renderer/scene',
      'renderer/image',
      'renderer/cache',
      'shaders/shared',
      ...BASE,
      ...SETTINGS,
    ],
    why: 'a method: plans and keeps indirect light; passes draw it',
  })),
  {
    folder: 'renderer/passes',
    may: [
      'renderer/gi',
      ...METHODS,
      'renderer/frame',
      'renderer/gpu_scene',
      'renderer/gpu',
      'renderer/scene',
      'renderer/cache',
      'shaders/shared',
      ...BASE,
      ...SETTINGS,
    ],
    why: 'one file a pass',
  },
  {
    folder: 'renderer',
    may: [
      'renderer/passes',
      'renderer/gi',
      'renderer/frame',
      'renderer/gpu_scene',
      'renderer/path_tracer',
      'renderer/metrics',
      'renderer/gpu',
      'renderer/import',
      'renderer/image',
      'renderer/cache',
      'renderer/scene',
      'shaders/shared',
      'protocol/parameters',
      PATHS,
    ],
    why: 'the whole; of the protocol it knows the table of parameters alone',
  },

  {
    folder: 'server/document',
    may: ['protocol', 'protocol/parameters', 'renderer/image', 'renderer/scene', ...API],
    why: 'the scene as clients edit it',
  },
  {
    folder: 'server/accuracy',
    may: ['server/document', 'protocol', 'renderer/scene', 'renderer/path_tracer', PATHS, ...API],
    why: 'measuring, below both programs',
  },
  {
    folder: 'server/stream',
    may: ['protocol', ...API],
    why: 'queues between threads, and encoders',
  },
  {
    folder: 'server/render',
    may: [
      'server/document',
      'server/accuracy',
      'server/stream',
      'protocol',
      'renderer/scene',
      ...API,
    ],
    why: 'the render thread',
  },
  {
    folder: 'server/network',
    may: ['server/render', 'server/stream', 'protocol', ...API],
    why: 'sockets and sessions: parse, validate, post',
  },
  {
    folder: 'server/tool',
    may: [
      'server/document',
      'server/accuracy',
      'server/options.h',
      'protocol',
      'renderer/import',
      'renderer/path_tracer',
      'renderer/scene',
      PATHS,
      ...API,
    ],
    why: 'the command line; the daemon knows nothing of it',
  },
  {
    folder: 'server/tool/stability',
    may: [
      'server/tool',
      'server/document',
      'server/accuracy',
      'protocol',
      'renderer/import',
      'renderer/import/builtin',
      'renderer/image',
      'renderer/path_tracer',
      'renderer/scene',
      PATHS,
      ...API,
    ],
    why: 'a command of voxcast that looks into all',
  },
  {
    folder: 'server',
    may: [
      'server/network',
      'server/render',
      'server/stream',
      'server/tool',
      'protocol',
      PATHS,
      ...API,
    ],
    why: 'the two programs',
  },
];

/**
 * Arrows that run upward. The list may only shrink.
 * @type {Arrow[]}
 */
export const UPWARD = [];
