// The handle that places a target for the end effector. It moves nothing but itself.

import * as THREE from "three";
import { TransformControls } from "three/examples/jsm/controls/TransformControls.js";

export class Gizmo extends EventTarget {
  #controls;
  #target = new THREE.Group();

  constructor(camera, orbit, canvas) {
    super();
    this.canvas = canvas;
    this.group = new THREE.Group();
    this.#target.add(new THREE.AxesHelper(0.12));
    this.group.add(this.#target);
    this.#target.visible = false;
    this.#controls = new TransformControls(camera, canvas);
    this.#controls.setSize(0.8);
    this.#controls.addEventListener("dragging-changed", ({ value }) => { orbit.enabled = !value; });
    this.#controls.addEventListener("change", () => this.dispatchEvent(new Event("redraw")));
    this.#controls.addEventListener("objectChange", () => this.dispatchEvent(new Event("moved")));
    this.group.add(this.#controls.getHelper());
  }

  get placed() { return this.#target.visible; }

  get position() { return this.placed ? this.#target.position : null; }

  /** Position, `[m]`, and quaternion x y z w. */
  get pose() {
    return { position: this.#target.position.toArray(), orientation: this.#target.quaternion.toArray() };
  }

  place({ position, orientation }) {
    this.#target.position.set(...position);
    this.#target.quaternion.set(...orientation).normalize();
    this.#target.visible = true;
    this.#controls.attach(this.#target);
    this.dispatchEvent(new Event("redraw"));
  }

  remove() {
    this.#target.visible = false;
    this.#controls.detach();
    this.dispatchEvent(new Event("redraw"));
  }

  /** `translate` or `rotate`. */
  set mode(mode) { this.#controls.setMode(mode); }

  /** `base` or `tool`. */
  set axes(axes) { this.#controls.setSpace(axes === "tool" ? "local" : "world"); }

  /** Whether a pointer is on the handle, and would drag it. */
  isUnder(event) {
    if (!this.placed) return false;
    const box = this.canvas.getBoundingClientRect();
    this.#controls.pointerHover({
      x: ((event.clientX - box.left) / box.width) * 2 - 1,
      y: 1 - ((event.clientY - box.top) / box.height) * 2,
      button: event.button,
    });
    return this.#controls.axis !== null;
  }
}
