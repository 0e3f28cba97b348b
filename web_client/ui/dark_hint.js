/** A plain sky: what the button adds. */
const SKY = {
  type: 'gradient',
  intensity: 1,
  color: [0.35, 0.55, 0.9],
  horizon_color: [0.85, 0.9, 0.95],
  ground_color: [0.2, 0.18, 0.16],
};

/** Many files come without light: says so over the black image, and offers lights. */
export class DarkHint {
  /** @param {HTMLElement} root @param {import('../panel/app_context.js').AppContext} app */
  constructor(root, app) {
    this.root = root;
    this.app = app;
    root.querySelector('#dark-sky')?.addEventListener('click', () => {
      app.editor.update('environment', undefined, SKY, false);
    });
    root.querySelector('#dark-light')?.addEventListener('click', () => app.addLight('point'));
  }

  refresh() {
    const { data } = this.app.document;
    if (!data) return;
    const isEmissive = (/** @type {any} */ { emissive, shading }) =>
      shading === 'unlit' || emissive.some((/** @type {number} */ part) => part > 0);
    this.root.hidden =
      data.lights.some((/** @type {any} */ light) => light.enabled) ||
      data.environment.type !== 'none' ||
      data.materials.some(isEmissive);
  }
}
