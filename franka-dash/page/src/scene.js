// The arm in 3D: measured, reference, external force; rendered when something has changed.

import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { ArmView } from "./arm.js";

const METRES_PER_NEWTON = 0.01;
const FORCE_SHOWN = 2;

export class Scene {
  #renderer;
  #scene = new THREE.Scene();
  #camera = new THREE.PerspectiveCamera(38, 1, 0.05, 20);
  #measured = null;
  #reference = null;
  #arrow;
  #grid = null;
  #stale = true;

  constructor(canvas) {
    this.canvas = canvas;
    this.#renderer = new THREE.WebGLRenderer({ canvas, antialias: true });
    this.#renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.#camera.up.set(0, 0, 1);
    this.#camera.position.set(1.55, -1.75, 1.15);
    this.controls = new OrbitControls(this.#camera, canvas);
    this.controls.target.set(0.2, 0, 0.42);
    this.controls.addEventListener("change", () => { this.#stale = true; });
    this.controls.update();
    this.#scene.add(new THREE.HemisphereLight(0xffffff, 0x556070, 1.9));
    const sun = new THREE.DirectionalLight(0xffffff, 1.8);
    sun.position.set(1.5, -1, 3);
    this.#scene.add(sun);
    this.#arrow = new THREE.ArrowHelper(new THREE.Vector3(0, 0, 1), new THREE.Vector3(), 0.1, 0xd8433f, 0.05, 0.03);
    this.#arrow.visible = false;
    this.#scene.add(this.#arrow);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.#colour());
    this.#colour();
    new ResizeObserver(() => { this.#stale = true; }).observe(canvas);
    const draw = () => { this.#draw(); requestAnimationFrame(draw); };
    requestAnimationFrame(draw);
  }

  #colour() {
    const colour = getComputedStyle(document.documentElement).getPropertyValue("--scene").trim();
    this.#scene.background = new THREE.Color(colour);
    if (this.#grid) this.#scene.remove(this.#grid);
    const line = getComputedStyle(document.documentElement).getPropertyValue("--line").trim();
    this.#grid = new THREE.GridHelper(2.4, 24, line, line);
    this.#grid.rotation.x = Math.PI / 2;
    this.#scene.add(this.#grid);
    this.#stale = true;
  }

  describe(capsules) {
    for (const arm of [this.#measured, this.#reference]) if (arm) this.#scene.remove(arm.group);
    this.#measured = new ArmView(capsules, { color: 0x7d93b5, opacity: 1, frames: true });
    this.#reference = new ArmView(capsules, { color: 0xe09a2c, opacity: 0.28, frames: false });
    this.#scene.add(this.#measured.group, this.#reference.group);
  }

  show(frame) {
    if (!this.#measured) return;
    this.#measured.place(frame.poses);
    this.#reference.place(frame.referencePoses);
    // Equal arms in one place only blur each other.
    const apart = frame.q.some((q, i) => Math.abs(q - frame.reference[i]) > 0.01);
    this.#reference.group.visible = apart;
    // The robot's estimate is what it exerts; shown is what is exerted on it.
    const force = new THREE.Vector3(-frame.force[0], -frame.force[1], -frame.force[2]);
    const newtons = force.length();
    this.#arrow.visible = newtons > FORCE_SHOWN;
    if (this.#arrow.visible) {
      this.#arrow.position.copy(this.#measured.links[9].position);
      this.#arrow.setDirection(force.normalize());
      this.#arrow.setLength(Math.min(newtons * METRES_PER_NEWTON, 0.6), 0.05, 0.03);
    }
    this.#stale = true;
  }

  #draw() {
    if (!this.#stale) return;
    this.#stale = false;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    const size = this.#renderer.getSize(new THREE.Vector2());
    if (size.x !== width || size.y !== height) {
      this.#renderer.setSize(width, height, false);
      this.#camera.aspect = width / height;
      this.#camera.updateProjectionMatrix();
    }
    this.#renderer.render(this.#scene, this.#camera);
  }

  #ray(event) {
    const box = this.canvas.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width) * 2 - 1;
    const y = 1 - ((event.clientY - box.top) / box.height) * 2;
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2(x, y), this.#camera);
    return ray;
  }

  /** The link under a pointer, 1 to 7, and where it is touched in its axes; null if none is. */
  pick(event) {
    if (!this.#measured) return null;
    const [hit] = this.#ray(event).intersectObject(this.#measured.group, true).filter((it) => it.object.isMesh);
    if (!hit || hit.object.userData.link === 0) return null;
    // The tool is pushed at link 7.
    const link = Math.min(hit.object.userData.link, 7);
    const offset = this.#measured.links[link].worldToLocal(hit.point.clone());
    return { link, offset: offset.toArray(), point: hit.point };
  }

  /** The way from `point` to the pointer, in the plane that faces the camera, `[m]`. */
  pull(point, event) {
    const normal = this.#camera.getWorldDirection(new THREE.Vector3());
    const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(normal, point);
    const at = this.#ray(event).ray.intersectPlane(plane, new THREE.Vector3());
    return at ? at.sub(point) : new THREE.Vector3();
  }

  /** Where the scene has the end effector, `[m]`. */
  endEffector() {
    return this.#measured ? this.#measured.links[9].getWorldPosition(new THREE.Vector3()).toArray() : null;
  }

  /** Where on the page a link's frame is, for tests. */
  onPage(link) {
    const at = this.#measured.links[link].getWorldPosition(new THREE.Vector3()).project(this.#camera);
    const box = this.canvas.getBoundingClientRect();
    return [box.left + ((at.x + 1) / 2) * box.width, box.top + ((1 - at.y) / 2) * box.height];
  }

  get forceShown() { return this.#arrow.visible; }
}
