// Draws the shapes of error_chart.js into an SVG element and makes its points reachable by mouse,
// touch and keyboard. A plain script, as error_chart.js is; panel/error_chart.js names it for
// modules.

globalThis.ErrorChartView = class {
  #svg;
  #options;
  /** @type {{ mark: SVGElement, point: any }[]} from fast to slow */
  #marks = [];
  /** Name of the configuration whose mark the Tab key reaches. */
  #current = '';

  /**
   * @param {SVGSVGElement} svg
   * @param {{ label: string, onShow: (point: any, mark: SVGElement) => void, onHide: () => void,
   *   onChoose: (point: any) => void }} options onShow hears the point that is pointed at or has
   *   the focus
   */
  constructor(svg, options) {
    this.#svg = svg;
    this.#options = options;
  }

  /** @param {any} params of shapesOf() */
  draw(params) {
    const focused = this.#svg.contains(document.activeElement) ? this.#current : '';
    const group = this.#make(null, {
      tag: 'g',
      attributes: { role: 'listbox', 'aria-label': this.#options.label },
    });
    this.#svg.setAttribute('viewBox', `0 0 ${params.width} ${params.height}`);
    this.#svg.replaceChildren();
    this.#marks = [];
    for (const shape of globalThis.errorChart.shapesOf(params)) {
      if (shape.point && this.#marks.length === 0) this.#svg.append(group);
      if (shape.point) this.#addMark(group, shape, params.chosen);
      else this.#make(this.#svg, shape).setAttribute('aria-hidden', 'true');
    }
    this.#marks.sort((a, b) => a.point.ms - b.point.ms);
    const current =
      this.#marks.find(({ point }) => point.configuration.name === this.#current) ?? this.#marks[0];
    if (current)
      this.#moveTo(current, focused !== '' && focused === current.point.configuration.name);
  }

  #make(parent, { tag, attributes, text }) {
    const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
    if (text !== undefined) made.textContent = text;
    parent?.append(made);
    return made;
  }

  #addMark(group, shape, chosen) {
    const { point } = shape;
    const mark = this.#make(group, shape);
    mark.setAttribute('role', 'option');
    mark.setAttribute('tabindex', '-1');
    mark.setAttribute('aria-selected', String(point.configuration.name === chosen));
    const entry = { mark, point };
    mark.addEventListener('pointerenter', () => this.#options.onShow(point, mark));
    mark.addEventListener('focus', () => {
      this.#moveTo(entry, false);
      this.#options.onShow(point, mark);
    });
    for (const event of ['pointerleave', 'blur'])
      mark.addEventListener(event, () => this.#options.onHide());
    mark.addEventListener('click', () => this.#options.onChoose(point));
    mark.addEventListener('keydown', (event) => this.#key(event, entry));
    this.#marks.push(entry);
  }

  #moveTo(entry, takesFocus) {
    for (const { mark } of this.#marks)
      mark.setAttribute('tabindex', mark === entry.mark ? '0' : '-1');
    this.#current = entry.point.configuration.name;
    if (takesFocus) entry.mark.focus();
  }

  #key(event, entry) {
    const at = this.#marks.indexOf(entry);
    const target = {
      ArrowRight: at + 1,
      ArrowDown: at + 1,
      ArrowLeft: at - 1,
      ArrowUp: at - 1,
      Home: 0,
      End: this.#marks.length - 1,
    }[event.key];
    if (target !== undefined)
      this.#moveTo(this.#marks[Math.min(Math.max(target, 0), this.#marks.length - 1)], true);
    else if (event.key === 'Enter' || event.key === ' ') this.#options.onChoose(entry.point);
    else return;
    event.preventDefault();
  }
};
