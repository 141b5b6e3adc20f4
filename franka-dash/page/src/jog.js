// Jog buttons for the end effector, and the ready pose. All act while they are held.

const LINEAR = [["X", [1, 0, 0]], ["Y", [0, 1, 0]], ["Z", [0, 0, 1]]];

export function jog(hold, speed) {
  const place = document.getElementById("jog");
  const axes = document.getElementById("axes");
  const add = (text, label, motion, wide) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = text;
    button.setAttribute("aria-label", label);
    button.dataset.jog = text;
    if (wide) button.className = "wide";
    place.append(button);
    hold.bind(button, () => ({ motion: motion(), speed: speed() }));
  };
  for (const [kind, prefix, word] of [["translate", "", "move"], ["rotate", "R", "turn"]]) {
    for (const [name, direction] of LINEAR) {
      for (const [sign, factor] of [["−", -1], ["+", 1]]) {
        const along = direction.map((x) => x * factor);
        add(`${prefix}${name}${sign}`, `${word} ${name} ${sign}`, () => ({ kind, direction: along, axes: axes.value }));
      }
    }
  }
  add("Ready pose", "move to the ready pose", () => ({ kind: "ready" }), true);
  add("Hold here", "hold the arm where it is", () => ({ kind: "stay" }), true);
}
