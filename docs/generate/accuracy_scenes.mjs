// The scenes of docs/accuracy.md. A path is below the folder of scenes that are not shipped.

// In a scene of `hasCaustics` few bright paths keep the noise of the reference image high however
// long it is traced. There the number of samples decides, not the noise.

/**
 * @typedef {{ name: string, title: string, source?: string, path?: string, hasCaustics?: boolean,
 *   about: string }} Scene
 */

/** @type {Scene[]} */
export const SCENES = [
  {
    name: 'cornell',
    title: 'Cornell box',
    source: 'builtin:cornell',
    about: 'The published box: one light, diffuse walls, strong colour bleeding.',
  },
  {
    name: 'cornell-objects',
    hasCaustics: true,
    title: 'Objects in the Cornell box',
    source: 'builtin:cornell-objects',
    about:
      'A copper pot, a glass ball, a lacquered ring, a rough stone, and a small light of low ' +
      'power.',
  },
  {
    name: 'cornell-objects-diffuse',
    title: 'The objects, diffuse only',
    source: 'builtin:cornell-objects-diffuse',
    about: 'No specular reflection at all: errors are those of diffuse light and of shadows.',
  },
  {
    name: 'cornell-objects-glossy',
    title: 'The objects, glossy only',
    source: 'builtin:cornell-objects-glossy',
    about: 'Lacquer of roughness 0.15 over diffuse colour.',
  },
  {
    name: 'cornell-objects-glass',
    hasCaustics: true,
    title: 'The objects, glass only',
    source: 'builtin:cornell-objects-glass',
    about: 'Clear glass: refraction, and caustics, which only the reference image has.',
  },
  {
    name: 'cornell-objects-emissive',
    title: 'The objects, emissive only',
    source: 'builtin:cornell-objects-emissive',
    about: 'The objects shine, and nothing else does: curved area lights.',
  },
  {
    name: 'atrium',
    title: 'Atrium',
    source: 'builtin:atrium',
    about: 'A court in the sun: one strong light, sky, arcades in the shade, plants.',
  },
  {
    name: 'sponza',
    title: 'Sponza',
    path: 'sponza/sponza.glb',
    about: 'Crytek Sponza, CC BY 3.0: the sun, long colonnades, masked leaves.',
  },
  {
    name: 'natus-cornell',
    hasCaustics: true,
    title: 'Natus’ Cornell box',
    path: 'natus-cornell/natus-cornell.glb',
    about: 'A box of 2 m with a metal dragon, a glass Buddha, a teapot and a point light.',
  },
];
