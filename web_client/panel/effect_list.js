import { element } from '../ui/element.js';
import { wordsOf } from './labels.js';

/** Makes an empty list, which showEffects() fills. */
export const makeEffectList = () => element('ul', { class: 'effects', 'aria-label': 'Effects' });

/**
 * Shows which effects the newest frame needed, and why.
 * @param {HTMLElement} list @param {{name: string, on: boolean, reason: string}[]} effects
 */
export function showEffects(list, effects) {
  list.replaceChildren(
    ...effects.map(({ name, on, reason }) =>
      element(
        'li',
        { class: on ? 'on' : '', title: reason, 'data-effect': name },
        element('span', { class: 'name' }, wordsOf(name)),
        element('small', {}, on ? 'on' : 'off'),
        element('small', { class: 'reason' }, reason),
      ),
    ),
  );
}
