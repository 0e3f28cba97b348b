import { element } from '../ui/element.js';
import { icon } from '../ui/icon.js';
import { addParameterControls } from './parameter_controls.js';
import { makeSection } from './sections.js';

const DRAW_MS = 100;

/** For each animation: play and pause, the time, and the properties of the table. */
export class AnimationControls {
  /** @param {import('./app_context.js').AppContext} app */
  constructor(app) {
    this.app = app;
    this.root = element('section', { hidden: true });
    /** @type {{id: number, draw: () => void, refresh: () => void}[]} */
    this.players = [];
    /**
     * @type {Map<number, {timeS: number, at: number}>} when the time of a playing animation was
     *   last known
     */
    this.known = new Map();
    setInterval(() => this.players.forEach((player) => player.draw()), DRAW_MS);
  }

  rebuild() {
    const animations = this.app.document.data.animations;
    this.root.hidden = animations.length === 0;
    this.root.replaceChildren(element('h2', {}, 'Animations'));
    this.known.clear();
    this.players = animations.map((/** @type {any} */ animation) => this.#makePlayer(animation));
  }

  /** @param {number} id */
  refresh(id) {
    const player = this.players.find((other) => other.id === id);
    this.known.delete(id);
    player?.refresh();
    player?.draw();
  }

  /** The server plays. Between its messages the time is extrapolated. */
  #timeOf(/** @type {any} */ animation) {
    const now = performance.now();
    const known = this.known.get(animation.id) ?? { timeS: animation.time_s, at: now };
    this.known.set(animation.id, known);
    if (!animation.playing) return animation.time_s;
    const time = known.timeS + ((now - known.at) / 1000) * animation.speed;
    const { duration_s } = animation;
    if (!animation.loop || duration_s <= 0) return Math.min(Math.max(time, 0), duration_s);
    return ((time % duration_s) + duration_s) % duration_s;
  }

  #makePlayer(/** @type {any} */ animation) {
    const { app } = this;
    const { id, duration_s } = animation;
    const name = animation.name || `Animation ${id}`;
    const target = app.target('animation', id);
    const play = element('button', {
      type: 'button',
      class: 'play',
      onclick: () => {
        const now = app.document.find('animation', id);
        app.editor.update(
          'animation',
          id,
          { playing: !now.playing, time_s: this.#timeOf(now) },
          false,
        );
      },
    });
    const seek = element('input', {
      type: 'range',
      min: 0,
      max: duration_s,
      step: 'any',
      'aria-label': `Time in ${name}`,
    });
    seek.addEventListener('input', () => target.set('time_s', seek.valueAsNumber, true));
    seek.addEventListener('change', () => target.set('time_s', seek.valueAsNumber, false));
    const clock = element('output', {});
    this.root.append(element('div', { class: 'player' }, play, seek, clock));
    const gui = makeSection(this.root, name, false);
    const controls = addParameterControls(gui, app.parameters('animation'), target);
    const draw = () => {
      const now = app.document.find('animation', id);
      if (!now) return;
      const time = this.#timeOf(now);
      if (document.activeElement !== seek || now.playing) seek.value = String(time);
      clock.textContent = `${time.toFixed(2)} / ${duration_s.toFixed(2)} s`;
      const verb = now.playing ? 'Pause' : 'Play';
      if (play.dataset.verb === verb) return;
      play.dataset.verb = verb;
      play.setAttribute('aria-label', `${verb} ${name}`);
      play.replaceChildren(icon(now.playing ? 'pause' : 'play'));
    };
    draw();
    return { id, draw, refresh: controls.refresh };
  }
}
