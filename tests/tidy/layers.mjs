// Which folder may include which: the one table. A folder may include itself and what its row lists: folders as they
// stand in a row of their own, without what lies in them, or single headers.

/** @typedef {{ folder: string, may: string[], why: string }} Layer */
/** @typedef {{ from: string, to: string, why: string }} Arrow  a file that includes a header against the table */

/** Made by CMake: where sources and shaders lie. */
const PATHS = 'voxcast_paths.h';

/** Plain data and small services that stand below all other rooms of the renderer. */
const ERROR = 'renderer/error.h';
const CLOCK = 'renderer/clock.h';
const SETTINGS = 'renderer/settings.h';

/** @type {Layer[]} */
export const LAYERS = [
  { folder: 'protocol', may: [], why: 'pure: parse, validate, encode; knows neither renderer nor server' },

  { folder: 'shaders/shared', may: [], why: 'read by C and GLSL alike' },
  { folder: 'shaders/lib', may: ['shaders/shared'], why: 'what shaders of several stages need' },
  ...['debug', 'gi', 'light', 'post', 'visibility', 'voxel'].map((stage) => ({
    folder: `shaders/${stage}`,
    may: ['shaders/lib', 'shaders/shared'],
    why: 'stages share by shaders/lib alone',
  })),

  { folder: 'renderer/gpu', may: ['shaders/shared', ERROR, CLOCK], why: 'the ground floor; alone calls GL and EGL' },
  { folder: 'renderer/scene', may: [ERROR], why: 'the document and its importers know of no GPU' },
  { folder: 'renderer/scene/builtin', may: ['renderer/scene'], why: 'makes scenes as importers do' },
  {
    folder: 'renderer/resident',
    may: ['renderer/gpu', 'renderer/scene', 'shaders/shared'],
    why: 'the scene as the GPU holds it',
  },
  {
    folder: 'renderer/gi',
    may: ['renderer/resident', 'renderer/gpu', 'shaders/shared', SETTINGS, 'renderer/frame/effects.h'],
    why: 'plans and keeps voxel light; passes draw it',
  },
  {
    folder: 'renderer/passes',
    may: ['renderer/gi', 'renderer/resident', 'renderer/gpu', 'renderer/frame/view.h', 'renderer/frame/effects.h'],
    why: 'a pass works on a view',
  },
  {
    folder: 'renderer/reference',
    may: ['renderer/scene', 'shaders/shared', ERROR, CLOCK, SETTINGS, 'renderer/camera.h'],
    why: 'the path tracer runs on the CPU alone',
  },
  {
    folder: 'renderer',
    may: [
      'renderer/passes',
      'renderer/gi',
      'renderer/resident',
      'renderer/reference',
      'renderer/gpu',
      'renderer/scene',
      'shaders/shared',
      PATHS,
    ],
    why: 'the whole; knows neither protocol nor server',
  },

  {
    folder: 'server',
    may: ['protocol', 'renderer/renderer.h', SETTINGS, 'renderer/log.h', 'renderer/image/image.h', PATHS],
    why: 'sees of the renderer its one header, and plain data',
  },
  {
    folder: 'tests/stability',
    may: [
      'server',
      'protocol',
      'renderer',
      'renderer/reference',
      'renderer/scene',
      'renderer/scene/builtin',
      PATHS,
    ],
    why: 'a command of voxcast that looks into all',
  },
];

/**
 * Arrows that run upward. The list may only shrink.
 * @type {Arrow[]}
 */
export const UPWARD = [
  {
    from: 'renderer/gpu/gpu.h',
    to: 'renderer/renderer.h',
    why: 'struct renderer_info and enum renderer_fault want a header below both',
  },
  { from: 'renderer/gi/gi.c', to: 'renderer/frame/view.h', why: 'struct frame and what a view has gathered are one plan' },
  { from: 'renderer/gi/gi.c', to: 'renderer/passes/pass.h', why: 'struct frame stands in the header of passes' },
  { from: 'renderer/passes/pass.h', to: 'renderer/renderer.h', why: 'struct frame_params stands in renderer.h' },
];
