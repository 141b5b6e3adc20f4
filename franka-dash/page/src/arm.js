// An arm on its link frames: as it looks, as its guards see it, or both.

import * as THREE from "three";

const UP = new THREE.Vector3(0, 1, 0);
/** Of the hand on the flange, and of the fingers on the hand. */
const HAND_TURN = -Math.PI / 4;
const FINGER_HEIGHT = 0.0584;
/** Of a finger from the middle, where no width is known. */
const FINGER_OPEN = 0.02;

export class ArmView {
  #capsules = [];
  #meshes = [];
  #fingers = [];
  #tint;

  /** `links[0]` is the base, 1 to 7 the joint frames, 8 the flange, 9 the end effector. */
  constructor(capsules, { color, opacity, frames }) {
    this.group = new THREE.Group();
    this.links = Array.from({ length: 10 }, () => new THREE.Group());
    this.group.add(...this.links);
    this.hasHand = capsules.some(({ link }) => link === 8);
    const ghost = opacity < 1;
    this.#tint = ghost ? { color, opacity } : null;
    this.material = new THREE.MeshLambertMaterial({
      color, transparent: ghost, opacity, depthWrite: !ghost,
    });
    for (const { link, start, end, radius } of capsules) {
      if (ghost && link === 0) continue;
      const from = new THREE.Vector3(...start);
      const along = new THREE.Vector3(...end).sub(from);
      const mesh = new THREE.Mesh(new THREE.CapsuleGeometry(radius, along.length(), 6, 20), this.material);
      mesh.position.copy(from).addScaledVector(along, 0.5);
      if (along.length() > 1e-9) mesh.quaternion.setFromUnitVectors(UP, along.normalize());
      mesh.userData.link = link;
      this.links[link].add(mesh);
      this.#capsules.push(mesh);
    }
    if (frames) {
      for (const link of this.links.slice(1, 8)) link.add(new THREE.AxesHelper(0.08));
      this.links[9].add(new THREE.AxesHelper(0.16));
    }
  }

  /** Width between the drawn fingers, `[m]`; null without fingers. */
  get width() { return this.#fingers.length ? 2 * this.#fingers[0].position.y : null; }

  get hasMeshes() { return this.#meshes.length > 0; }

  /** Adds what the links look like: copies, in one colour for an arm that is not there. */
  addMeshes({ links, hand, finger }) {
    const add = (parent, object) => {
      const copy = object.clone();
      if (this.#tint) copy.traverse((part) => { if (part.isMesh) part.material = this.#ghost(); });
      parent.add(copy);
      this.#meshes.push(copy);
      return copy;
    };
    // The base of every arm is in the same place.
    links.forEach((link, i) => { if (i > 0 || !this.#tint) add(this.links[i], link); });
    if (!this.hasHand) return;
    add(this.links[8], hand).rotation.z = HAND_TURN;
    for (const side of [1, -1]) {
      const place = new THREE.Group();
      place.rotation.z = HAND_TURN + (side > 0 ? 0 : Math.PI);
      this.links[8].add(place);
      const copy = add(place, finger);
      copy.position.set(0, FINGER_OPEN, FINGER_HEIGHT);
      this.#fingers.push(copy);
    }
  }

  /** One layer of a colour: what is behind its own front is not seen. */
  #ghost() {
    this.ghost ??= new THREE.MeshLambertMaterial({ ...this.#tint, transparent: true });
    return this.ghost;
  }

  /** Shows `meshes`, `capsules`, or `both`: then the capsules are a haze around the links. */
  show(what) {
    const meshes = what !== "capsules" && this.hasMeshes;
    const capsules = what !== "meshes" || !this.hasMeshes;
    for (const mesh of this.#meshes) mesh.visible = meshes;
    // They are still found by a pointer.
    for (const capsule of this.#capsules) capsule.visible = capsules;
    if (this.#tint) return;
    const haze = meshes && capsules;
    this.material.transparent = haze;
    this.material.opacity = haze ? 0.25 : 1;
    this.material.depthWrite = !haze;
    this.material.needsUpdate = true;
  }

  /** The nearest capsule that a ray meets: link and point; null without one. */
  hit(ray) {
    const [hit] = ray.intersectObjects(this.#capsules, false);
    return hit ? { link: hit.object.userData.link, point: hit.point } : null;
  }

  /** Puts the fingers so that `width` is between them, `[m]`; no number for one that is unknown. */
  open(width) {
    for (const finger of this.#fingers) finger.position.y = Number.isFinite(width) ? width / 2 : FINGER_OPEN;
  }

  /** Puts the links where nine poses of a frame say. */
  place(poses) {
    for (let i = 0; i < 9; i += 1) {
      const at = 7 * i;
      const link = this.links[i + 1];
      link.position.set(poses[at], poses[at + 1], poses[at + 2]);
      link.quaternion.set(poses[at + 3], poses[at + 4], poses[at + 5], poses[at + 6]);
    }
  }
}
