/**
 * Makes an HTML element with attributes, listeners (names that begin with "on") and children.
 * @param {string} tag
 * @param {Record<string, any>} [attributes] undefined and false leave the attribute out, but aria-*
 *   attributes are written as they are
 * @param {(Node | string)[]} children
 * @returns {any}
 */
export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) made.addEventListener(name.slice(2), value);
    else if (name.startsWith('aria-') && value !== undefined)
      made.setAttribute(name, String(value));
    else if (value === true) made.setAttribute(name, '');
    else if (value !== undefined && value !== false) made.setAttribute(name, String(value));
  }
  made.append(...children);
  return made;
}
