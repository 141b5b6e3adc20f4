// The arm in 3D, with what there is to know about it in its place; rendered when something has
// changed.

import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { ArmView } from "./arm.js";
import { COLOURS } from "./colours.js";
import { Gizmo } from "./gizmo.js";
import { Arrow, Contact, Regions, Trail } from "./marks.js";
import { load } from "./meshes.js";

const METRES_PER_NEWTON = 0.01;
const FORCE_SHOWN = 2;
/** Of half the angle of view, from top to bottom. */
const TANGENT = Math.tan((19 * Math.PI) / 180);
/** Joint positions that differ by less are the same place: equal arms only blur each other. */
const APART = 0.01;

const differs = (a, b) => a.some((q, i) => Math.abs(q - b[i]) > APART);

export class Scene extends EventTarget {
  #renderer;
  #scene = new THREE.Scene();
  #camera = new THREE.PerspectiveCamera(38, 1, 0.05, 20);
  #arms = {};
  #looks = "meshes";
  #force = new Arrow(COLOURS.force);
  #contact = new Contact();
  #pull = new Arrow(COLOURS.contact);
  #regions = new Regions();
  #behind = new Trail(COLOURS.behind, { dashed: false });
  #ahead = new Trail(COLOURS.goal, { dashed: true });
  #goal = null;
  #heading = null;
  #frame = null;
  #grid = null;
  #stale = true;

  constructor(canvas) {
    super();
    this.canvas = canvas;
    this.#renderer = new THREE.WebGLRenderer({ canvas, antialias: true });
    this.#renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.#camera.up.set(0, 0, 1);
    this.#camera.position.set(1.55, -1.75, 1.15);
    this.controls = new OrbitControls(this.#camera, canvas);
    this.controls.target.set(0.2, 0, 0.42);
    this.controls.addEventListener("change", () => this.redraw());
    this.controls.update();
    this.gizmo = new Gizmo(this.#camera, this.controls, canvas);
    this.gizmo.addEventListener("redraw", () => this.redraw());
    this.#scene.add(new THREE.HemisphereLight(0xffffff, 0x556070, 1.9));
    const sun = new THREE.DirectionalLight(0xffffff, 1.8);
    sun.position.set(1.5, -1, 3);
    this.#scene.add(sun, this.gizmo.group);
    for (const mark of [this.#force, this.#contact, this.#pull, this.#regions, this.#behind, this.#ahead]) {
      this.#scene.add(mark.group);
    }
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.#colour());
    this.#colour();
    new ResizeObserver(() => this.redraw()).observe(canvas);
    const draw = () => { this.#draw(); requestAnimationFrame(draw); };
    requestAnimationFrame(draw);
  }

  redraw() { this.#stale = true; }

  #colour() {
    const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    this.#scene.background = new THREE.Color(colour("--scene"));
    if (this.#grid) this.#scene.remove(this.#grid);
    this.#grid = new THREE.GridHelper(2.4, 24, colour("--line"), colour("--line"));
    this.#grid.rotation.x = Math.PI / 2;
    this.#scene.add(this.#grid);
    this.redraw();
  }

  /** Takes what does not change; resolves when the links look as they do. */
  async describe({ capsules, meshes, keep_out: regions }) {
    for (const arm of Object.values(this.#arms)) this.#scene.remove(arm.group);
    this.#arms = {
      measured: new ArmView(capsules, { color: COLOURS.measured, opacity: 1, frames: true }),
      reference: new ArmView(capsules, { color: COLOURS.reference, opacity: 0.3, frames: false }),
      goal: new ArmView(capsules, { color: COLOURS.goal, opacity: 0.45, frames: false }),
    };
    const arms = Object.values(this.#arms);
    for (const arm of arms) this.#scene.add(arm.group);
    this.#arms.goal.group.visible = false;
    this.#regions.set(regions);
    this.#frame = null;
    // First something to look at: the files take a while.
    await new Promise((done) => this.addEventListener("drawn", done, { once: true }));
    try {
      const set = await load(meshes);
      for (const arm of arms) arm.addMeshes(set);
    } catch (error) {
      // The capsules do.
      console.warn("no meshes", error);
    }
    this.show3d(this.#looks);
  }

  /** Shows `meshes`, `capsules` or `both`. */
  show3d(what) {
    this.#looks = what;
    for (const [name, arm] of Object.entries(this.#arms)) {
      arm.show(name === "measured" || what === "capsules" ? what : "meshes");
    }
    this.redraw();
  }

  /** Shows a frame, with the end effector's places before it, `[x, y, z]` each. */
  show(frame, behind, guards) {
    const { measured, reference } = this.#arms;
    if (!measured) return;
    this.#frame = frame;
    measured.place(frame.poses);
    reference.place(frame.referencePoses);
    for (const arm of Object.values(this.#arms)) arm.open(frame.width);
    reference.group.visible = differs(frame.q, frame.reference);
    // The robot's estimate is what it exerts; shown is what is exerted on it.
    const force = new THREE.Vector3(-frame.force[0], -frame.force[1], -frame.force[2]);
    const newtons = force.length();
    this.#force.set(newtons > FORCE_SHOWN ? measured.links[9].position : null, force, newtons * METRES_PER_NEWTON);
    this.#behind.set(behind);
    this.#regions.light(guards.has("clearance"));
    this.#showGoal();
    this.redraw();
  }

  showContact(contact) {
    this.#contact.set(contact);
    this.redraw();
  }

  /** Shows how the arm is pulled: from a place to where the pointer has it; nothing for null. */
  showPull(place, way) {
    this.#pull.set(place, way, way?.length() ?? 0);
    this.redraw();
  }

  /** Shows what a motion would do; nothing for null. */
  preview(way) {
    this.#goal = way;
    this.#showGoal();
  }

  /** Shows what the motion that goes on does; nothing for null. */
  heading(way) {
    this.#heading = way;
    this.#showGoal();
  }

  #showGoal() {
    const { goal } = this.#arms;
    if (!goal) return;
    const way = this.#heading ?? this.#goal;
    if (way) goal.place(way.poses);
    goal.group.visible = way !== null && this.#frame !== null && differs(way.q, this.#frame.q);
    this.#ahead.set(goal.group.visible ? way.line : []);
    this.redraw();
  }

  #draw() {
    // Before the first frame there is nothing to see, and even that takes time.
    if (!this.#stale || !this.#frame) return;
    this.#stale = false;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    const size = this.#renderer.getSize(new THREE.Vector2());
    if (size.x !== width || size.y !== height) {
      this.#renderer.setSize(width, height, false);
      this.#camera.aspect = width / height;
      // A high window shows as much from left to right as a square one.
      this.#camera.fov = 2 * Math.atan(TANGENT / Math.min(1, this.#camera.aspect)) * (180 / Math.PI);
      this.#camera.updateProjectionMatrix();
    }
    this.#renderer.render(this.#scene, this.#camera);
    this.dispatchEvent(new Event("drawn"));
  }

  #ray(event) {
    const box = this.canvas.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width) * 2 - 1;
    const y = 1 - ((event.clientY - box.top) / box.height) * 2;
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2(x, y), this.#camera);
    return ray;
  }

  /**
   * The link under a pointer, 1 to 7, and where it is touched in its axes; null if none is. A handle
   * under the pointer goes first, unless it is `before` it.
   */
  pick(event, { before = false } = {}) {
    const { measured } = this.#arms;
    if (!measured || (!before && this.gizmo.isUnder(event))) return null;
    const hit = measured.hit(this.#ray(event));
    if (!hit || hit.link === 0) return null;
    // The tool is pushed at link 7.
    const link = Math.min(hit.link, 7);
    const offset = measured.links[link].worldToLocal(hit.point.clone());
    return { link, offset: offset.toArray(), point: hit.point };
  }

  /** The way from `point` to the pointer, in the plane that faces the camera, `[m]`. */
  pull(point, event) {
    const normal = this.#camera.getWorldDirection(new THREE.Vector3());
    const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(normal, point);
    const at = this.#ray(event).ray.intersectPlane(plane, new THREE.Vector3());
    return at ? at.sub(point) : new THREE.Vector3();
  }

  /** What is drawn, for tests. */
  state() {
    const { measured, reference, goal } = this.#arms;
    const at = (object) => object.getWorldPosition(new THREE.Vector3());
    return {
      endEffector: measured ? at(measured.links[9]).toArray() : null,
      links: [1, 2, 3, 4, 5, 6, 7].map((link) => (measured ? this.onPage(at(measured.links[link])) : null)),
      forceShown: this.#force.group.visible,
      pullShown: this.#pull.group.visible,
      contactShown: this.#contact.group.visible,
      meshes: measured?.hasMeshes ?? false,
      width: measured?.width ?? null,
      reference: reference?.group.visible ? at(reference.links[9]).toArray() : null,
      ghost: goal?.group.visible ? at(goal.links[9]).toArray() : null,
      ahead: this.#ahead.count,
      behind: this.#behind.count,
      regions: this.#regions.count,
      gizmo: this.gizmo.position ? this.onPage(this.gizmo.position) : null,
    };
  }

  /** Where on the page a place is. */
  onPage(place) {
    const at = place.clone().project(this.#camera);
    const box = this.canvas.getBoundingClientRect();
    return [box.left + ((at.x + 1) / 2) * box.width, box.top + ((1 - at.y) / 2) * box.height];
  }
}
