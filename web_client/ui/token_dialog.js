const STORAGE_KEY = 'voxcast-token';

/** Finds the token: in the address (?token=), in this tab's storage, or by asking. */
export class TokenDialog {
  /** @param {HTMLDialogElement} dialog @param {() => void} onToken */
  constructor(dialog, onToken) {
    this.dialog = dialog;
    const input = /** @type {HTMLInputElement} */ (dialog.querySelector('input'));
    dialog.querySelector('form')?.addEventListener('submit', () => {
      this.#keep(input.value);
      input.value = '';
      onToken();
    });
    const url = new URL(location.href);
    const given = url.searchParams.get('token');
    if (given === null) return;
    this.#keep(given);
    url.searchParams.delete('token'); // secrets must not stay in the history
    history.replaceState(null, '', url);
  }

  /** @returns {string | undefined} */
  get token() {
    return sessionStorage.getItem(STORAGE_KEY) ?? undefined;
  }

  /** Asks for a token. */
  ask() {
    const message = /** @type {HTMLElement} */ (this.dialog.querySelector('[role=alert]'));
    message.textContent = this.token
      ? 'The server refused this token.'
      : 'This server wants a token.';
    if (!this.dialog.open) this.dialog.showModal();
  }

  #keep(/** @type {string} */ token) {
    sessionStorage.setItem(STORAGE_KEY, token);
  }
}
