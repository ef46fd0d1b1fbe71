// Choices on this page, kept in this tab of the browser from one run to the next at the same
// address: a recording after a seek backward, a rig that is started again.

export const keep = (name, value) => sessionStorage.setItem(name, JSON.stringify(value));

export const kept = (name, otherwise) => JSON.parse(sessionStorage.getItem(name)) ?? otherwise;

// Keeps the value of a control and restores it.
export function keepChoice(control) {
  const property = control.type === "checkbox" ? "checked" : "value";
  control[property] = kept(control.id, control[property]);
  control.addEventListener("change", () => keep(control.id, control[property]));
}
