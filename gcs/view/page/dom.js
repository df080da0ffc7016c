/** Elements of the page. */

/**
 * @param {string} tag with classes: `div.card.wide`
 * @param {Record<string, any>} [properties] of the element; `on...` are listeners, `aria-...` and `data-...` attributes
 * @param {(Node|string|null|undefined|false)[]} children
 * @returns {any}
 */
export function h(tag, properties = {}, ...children) {
  const [name, ...classes] = tag.split('.');
  const element = document.createElement(name);
  if (classes.length) element.className = classes.join(' ');
  for (const [key, value] of Object.entries(properties)) {
    if (key.startsWith('on')) element.addEventListener(key.slice(2), value);
    else if (key.includes('-')) element.setAttribute(key, value);
    else if (key === 'style') Object.assign(element.style, value);
    else /** @type {any} */ (element)[key] = value;
  }
  element.append(...children.filter((child) => child !== null && child !== undefined && child !== false));
  return element;
}

/** The colour of a token of tokens.css, such as `flown`. @param {string} name */
export function token(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

/** A number in words: `12.35`; `none` if it is not known. @param {number|null|undefined} value @param {number} digits */
export function number(value, digits = 2) {
  return value === null || value === undefined || !Number.isFinite(value) ? 'not known' : value.toFixed(digits);
}

/** A button that copies a text. @param {string} text @param {string} label */
export function copyable(text, label) {
  const button = h('button', { type: 'button', title: text }, label);
  button.addEventListener('click', async () => {
    try {
      await navigator.clipboard.writeText(text);
    } catch {
      // Without a secure context there is no clipboard: the old way.
      const area = h('textarea', { value: text });
      document.body.append(area);
      area.select();
      document.execCommand('copy');
      area.remove();
    }
    button.textContent = 'copied';
    setTimeout(() => {
      button.textContent = label;
    }, 1500);
  });
  return button;
}
