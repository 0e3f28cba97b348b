import { element } from '../ui/element.js';
import { srgbFromLinear } from '../math/color.js';
import { addParameterControls } from './parameter_controls.js';
import { wordsOf } from './labels.js';
import { makeSection } from './sections.js';

/** Materials: a choice by name, every property, the textures. */
export class MaterialTab {
  /** @param {HTMLElement} root @param {import('./app_context.js').AppContext} app */
  constructor(root, app) {
    this.app = app;
    this.list = element('div', { class: 'choices', role: 'group', 'aria-label': 'Materials' });
    this.chosen = element('div', {});
    this.textures = element('div', { class: 'textures' });
    root.append(element('h2', {}, 'Materials'), this.list, this.chosen, this.textures);
    /** @type {{refresh: () => void} | null} */
    this.controls = null;
    /** @type {number | null} */
    this.shownId = null;
    /** @type {Map<number, Promise<string>>} */
    this.thumbnails = new Map();
  }

  /** The scene is another one. */
  rebuild() {
    this.thumbnails.clear();
    this.shownId = null;
    this.chooseMaterial();
  }

  /** Shows the controls of the chosen material. */
  chooseMaterial() {
    const { app } = this;
    const id = app.selection.materialId;
    this.#drawList();
    if (id !== null && id === this.shownId) return;
    this.shownId = id;
    const material = app.document.find('material', id ?? undefined);
    this.chosen.replaceChildren();
    this.textures.replaceChildren();
    this.controls = null;
    if (id === null || !material) {
      this.chosen.append(
        element(
          'p',
          { class: 'hint' },
          'Click a surface in the image, or choose a material above.',
        ),
      );
      return;
    }
    const gui = makeSection(this.chosen, material.name || `Material ${id}`);
    this.controls = addParameterControls(
      gui,
      app.parameters('material'),
      app.target('material', id),
    );
    this.#showTextures(material.textures);
  }

  /** @param {number} [id] */
  refresh(id) {
    this.#drawList();
    if (id === this.shownId) this.controls?.refresh();
  }

  #drawList() {
    const { app } = this;
    const items = (app.document.data?.materials ?? []).map((/** @type {any} */ material) => {
      const [r, g, b] = material.base_color.map(
        (/** @type {number} */ c) => 255 * srgbFromLinear(c),
      );
      return element(
        'button',
        {
          type: 'button',
          'aria-pressed': material.id === app.selection.materialId,
          'data-material': material.id,
          onclick: () => app.selection.chooseMaterial(material.id),
        },
        element('span', { class: 'swatch', style: `background:rgb(${r},${g},${b})` }),
        element('span', { class: 'name' }, material.name || `Material ${material.id}`),
      );
    });
    const focused = /** @type {HTMLElement | null} */ (document.activeElement)?.dataset?.material;
    this.list.replaceChildren(...items);
    if (focused !== undefined) this.list.querySelector(`[data-material="${focused}"]`)?.focus();
    const pressed = this.list.querySelector('[aria-pressed=true]');
    if (pressed && app.selection.materialId !== this.shownId)
      pressed.scrollIntoView({ block: 'nearest' });
  }

  async #showTextures(
    /** @type {Record<string, {image: number, width: number, height: number}>} */ textures,
  ) {
    const shownId = this.shownId;
    for (const [slot, { image, width, height }] of Object.entries(textures)) {
      const source = await this.#thumbnail(image).catch(() => '');
      if (this.shownId !== shownId) return;
      this.textures.append(
        element(
          'figure',
          {},
          source
            ? element('img', {
                src: source,
                alt: `${wordsOf(slot)} texture`,
                width: 64,
                height: 64,
              })
            : '',
          element('figcaption', {}, wordsOf(slot), element('small', {}, `${width} × ${height}`)),
        ),
      );
    }
  }

  #thumbnail(/** @type {number} */ image) {
    const known = this.thumbnails.get(image);
    if (known) return known;
    const asked = this.app.connection
      .call('texture.get', { image })
      .then((result) => `data:image/jpeg;base64,${result.thumbnail.jpeg}`);
    this.thumbnails.set(image, asked);
    return asked;
  }
}
