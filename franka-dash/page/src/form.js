// Buttons and numbers of a panel. Those that need the lease are disabled without it: `needs` is
// "command", or "motion" where the robot has to be allowed to move as well.

export function button(text, needs, act) {
  const it = document.createElement("button");
  it.type = "button";
  it.textContent = text;
  it.dataset.needs = needs;
  it.disabled = true;
  it.addEventListener("click", act);
  return it;
}

/** A labelled input; `value` of it is a number, and it shows its unit. */
export function number(text, needs, { type = "number", min, max, step, value, unit = "" }) {
  const label = document.createElement("label");
  const input = document.createElement("input");
  const shown = document.createElement("output");
  Object.assign(input, { type, min, max, step, value });
  input.dataset.needs = needs;
  input.disabled = true;
  const show = () => { shown.textContent = type === "range" ? `${input.value}${unit}` : unit; };
  input.addEventListener("input", show);
  label.append(`${text} `, input, shown);
  show();
  const set = (number) => {
    input.value = number;
    show();
  };
  return { label, input, set, get: () => Number(input.value) };
}

export function choice(text, needs, options) {
  const label = document.createElement("label");
  const select = document.createElement("select");
  for (const [value, name] of options) select.add(new Option(name, value));
  select.dataset.needs = needs;
  select.disabled = true;
  label.append(`${text} `, select);
  return { label, select };
}

export function row(...parts) {
  const it = document.createElement("div");
  it.className = "row";
  it.append(...parts);
  return it;
}
