// Elements of drawings.

// Makes an element of a drawing; every page holds one drawing from the start.
function drawn(tag, attributes) {
  const element = document.createElementNS(document.querySelector("svg").namespaceURI, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  return element;
}
