import { GUI } from './lil_gui.js';

/**
 * A titled group of controls.
 * @param {HTMLElement} container @param {string} title @param {boolean} [isOpen]
 */
export function makeSection(container, title, isOpen = true) {
  const gui = new GUI({ container, title, injectStyles: false });
  if (!isOpen) gui.close();
  return gui;
}
