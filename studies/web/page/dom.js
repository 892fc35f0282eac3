// Elements of the page.

export const $ = (id) => document.getElementById(id);

export function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

/** Shows a message in an element with the class `error`; an empty one hides it. */
export function say(place, message) {
  place.hidden = !message;
  place.textContent = message;
}
