// Jog buttons for the end effector, and the ready pose. All act while they are held; a step ends
// where it leads.

import { Quaternion, Vector3 } from "three";

const DEGREES = 180 / Math.PI;

const LINEAR = [["X", [1, 0, 0]], ["Y", [0, 1, 0]], ["Z", [0, 0, 1]]];

/** Where so many millimetres or degrees along or about an axis lead from a pose, seven numbers. */
function stepped(pose, { kind, direction, axes }, size) {
  const position = new Vector3(...pose.slice(0, 3));
  const turn = new Quaternion(...pose.slice(3));
  const axis = new Vector3(...direction);
  if (axes === "tool") axis.applyQuaternion(turn);
  if (kind === "translate") position.addScaledVector(axis, size / 1000);
  else turn.premultiply(new Quaternion().setFromAxisAngle(axis, size / DEGREES));
  return { kind: "pose", position: position.toArray(), orientation: turn.toArray() };
}

/** `reference` gives the pose that steps begin at: an arm that sticks is not where it was sent. */
export function jog(hold, speed, reference) {
  const step = document.getElementById("step");
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
        add(`${prefix}${name}${sign}`, `${word} ${name} ${sign}`, () => {
          const motion = { kind, direction: along, axes: axes.value };
          return step.value === "" ? motion : stepped(reference(), motion, Number(step.value));
        });
      }
    }
  }
  add("Ready pose", "move to the ready pose", () => ({ kind: "ready" }), true);
  add("Hold here", "hold the arm where it is", () => ({ kind: "stay" }), true);
}
