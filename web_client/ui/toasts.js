import { element } from './element.js';

const SHOWN_MS = 7000;
const MAX_TOASTS = 4;

/** Short messages that disappear by themselves. Screen readers announce them. */
export class Toasts {
  /** @param {HTMLElement} container with role status or log */
  constructor(container) {
    this.container = container;
  }

  /** @param {'info' | 'warn' | 'error'} level @param {string} message @param {string} [detail] */
  show(level, message, detail) {
    const close = element('button', { type: 'button', 'aria-label': 'Dismiss' }, '×');
    const toast = element(
      'div',
      { class: `toast ${level}` },
      element(
        'div',
        {},
        element('p', {}, message),
        ...(detail ? [element('small', {}, detail)] : []),
      ),
      close,
    );
    close.addEventListener('click', () => toast.remove());
    this.container.append(toast);
    while (this.container.children.length > MAX_TOASTS) this.container.firstElementChild?.remove();
    setTimeout(() => toast.remove(), SHOWN_MS);
  }

  /** @param {import('../net/rpc_error.js').RpcError} error */
  showError(error) {
    const { field, min, max, allowed } = error.data;
    const range = allowed
      ? `Allowed: ${allowed.join(', ')}`
      : min !== undefined && max !== undefined
        ? `Allowed: ${min} to ${max}`
        : '';
    const detail = [field && `Field: ${field}`, range].filter(Boolean).join(' · ');
    this.show('error', error.message, detail);
  }
}
