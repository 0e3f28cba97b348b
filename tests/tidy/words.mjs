// Words that identifiers do not use, since the field has others for them. docs/GLOSSARY.md explains
// the words to use.

/**
 * @typedef {object} BannedWord
 * @property {string} word  as well with an s at its end
 * @property {string} instead
 * @property {RegExp} [except] identifiers that mean something else by it, or that are others' to
 *   name
 */

/** @type {BannedWord[]} */
export const BANNED = [
  { word: 'lamp', instead: 'light' },
  { word: 'tree', instead: 'bvh', except: /^[Ss]ceneTree$/ },
  { word: 'least', instead: 'min', except: /least_recently_used/ },
  { word: 'most', instead: 'max' },
  // "Final gather" is the field's.
  {
    word: 'gather',
    instead: 'accumulate',
    except: /^(final_|frame_)?gather(_modes?|_mode_names|_step)?$|^GATHER_/,
  },
  { word: 'gathered', instead: 'accumulated' },
  { word: 'share', instead: 'visibility or fraction', except: /^VOXCAST_INSTALL_SHARE_DIR$/ },
  { word: 'quiet', instead: 'accumulate_only' },
  { word: 'place', instead: 'position' },
  { word: 'resident', instead: 'gpu_scene' },
  { word: 'gloss', instead: 'specular' },
  { word: 'mend', instead: 'rebuild or repair' },
  // What is left of these three is named so by the protocol, by recorded files and by an option of
  // voxcast.
  { word: 'rung', instead: 'configuration', except: /^(rungs?|rung_count)$/ },
  { word: 'truth', instead: 'reference', except: /^truth$/ },
  { word: 'ladder', instead: 'sweep', except: /^ladder$/ },
  { word: 'sight', instead: 'camera_ray' },
  { word: 'openness', instead: 'ambient_visibility' },
  { word: 'still', instead: 'accumulation' },
  { word: 'way', instead: 'direction', except: /give_way|under_?way/i },
];
