// Pushing the arm: a spring from where its hand is pressed to the pointer.

import { Vector3 } from "three";

const NEWTONS_PER_METRE = 300;
/** More than a robot takes without stopping. */
const NEWTONS_MAX = 120;

export class Push {
  #scene;
  #pointer = null;
  /** Of the place that is pressed, from the end effector. */
  #offset = null;
  #endEffector = new Vector3();

  constructor(scene) {
    this.#scene = scene;
    const { canvas } = scene;
    // Before the handle and the camera's controls see it.
    canvas.addEventListener("pointerdown", (event) => {
      // A first pointer goes down: that of the push before was lost.
      if (event.isPrimary) this.#end();
      if (event.button !== 0 || this.#offset) return;
      const hit = scene.pick(event, { before: true });
      if (!hit) return;
      event.stopImmediatePropagation();
      scene.controls.enabled = false;
      this.#offset = hit.point.clone().sub(this.#endEffector);
      this.#pointer = event;
    }, { capture: true });
    addEventListener("pointermove", (event) => {
      if (!this.#offset) {
        const isOver = event.target === canvas && event.buttons === 0 && scene.pick(event, { before: true });
        canvas.style.cursor = isOver ? "grab" : "";
      } else if (event.pointerId === this.#pointer.pointerId) {
        event.stopImmediatePropagation();
        this.#pointer = event;
      }
    }, { capture: true });
    const end = ({ pointerId }) => { if (pointerId === this.#pointer?.pointerId) this.#end(); };
    for (const name of ["pointerup", "pointercancel"]) addEventListener(name, end);
    addEventListener("blur", () => this.#end());
  }

  #end() {
    if (!this.#offset) return;
    this.#offset = null;
    this.#scene.controls.enabled = true;
    this.#scene.showPull(null);
  }

  get active() { return this.#offset !== null; }

  /** The force with the end effector where it is now, `[N]`. */
  force([x, y, z]) {
    this.#endEffector.set(x, y, z);
    if (!this.#offset) return [0, 0, 0];
    const place = this.#endEffector.clone().add(this.#offset);
    const way = this.#scene.pull(place, this.#pointer).clampLength(0, NEWTONS_MAX / NEWTONS_PER_METRE);
    this.#scene.showPull(place, way);
    return way.multiplyScalar(NEWTONS_PER_METRE).toArray();
  }
}
