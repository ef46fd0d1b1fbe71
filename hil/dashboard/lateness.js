// How late the messages of one device left: how many in each class, on a scale of powers of ten.

const SVG = "http://www.w3.org/2000/svg";
const BAR = { width: 44, height: 70, text: 14 };

const edge = (us) => (us === null ? "more" : us < 1000 ? `${us} µs` : us < 1e6 ? `${us / 1000} ms` : `${us / 1e6} s`);

function part(name, attributes, text = "") {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.textContent = text;
  return element;
}

// `classes`: [upper edge in µs or null, count], as `read` has them.
export function drawLateness(figure, device, classes) {
  const [svg, caption] = [figure.querySelector("svg"), figure.querySelector("figcaption")];
  const total = classes.reduce((sum, [, count]) => sum + count, 0);
  const last = classes.reduce((most, [, count], at) => (count > 0 ? at : most), 0);
  const shown = classes.slice(0, Math.max(last + 1, 6));
  const most = Math.log10(1 + Math.max(...shown.map(([, count]) => count)));
  const height = BAR.height + 2 * BAR.text;
  svg.setAttribute("viewBox", `0 0 ${BAR.width * shown.length} ${height}`);
  svg.style.width = `${BAR.width * shown.length}px`;
  svg.replaceChildren(...shown.flatMap(([us, count], at) => {
    const tall = most > 0 ? (BAR.height * Math.log10(1 + count)) / most : 0;
    const [left, middle] = [at * BAR.width, (at + 0.5) * BAR.width];
    const foot = BAR.height + BAR.text;
    return [
      part("rect", { x: left + 4, y: foot - tall, width: BAR.width - 8, height: tall }),
      part("text", { x: middle, y: foot - tall - 3, "text-anchor": "middle" }, count > 0 ? count.toLocaleString("en") : ""),
      part("text", { x: middle, y: height - 2, "text-anchor": "middle" }, edge(us)),
    ];
  }));
  caption.textContent = `${device}: lateness of ${total.toLocaleString("en")} messages, up to each edge`;
  figure.hidden = total === 0;
}
