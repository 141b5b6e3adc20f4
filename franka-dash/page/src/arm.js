// An arm of guard capsules on link frames.

import * as THREE from "three";

const UP = new THREE.Vector3(0, 1, 0);

export class ArmView {
  /** `links[0]` is the base, 1 to 7 the joint frames, 8 the flange, 9 the end effector. */
  constructor(capsules, { color, opacity, frames }) {
    this.group = new THREE.Group();
    this.links = Array.from({ length: 10 }, () => new THREE.Group());
    this.group.add(...this.links);
    const ghost = opacity < 1;
    this.material = new THREE.MeshStandardMaterial({
      color, roughness: 0.55, metalness: 0.1, transparent: ghost, opacity, depthWrite: !ghost,
    });
    for (const { link, start, end, radius } of capsules) {
      const from = new THREE.Vector3(...start);
      const along = new THREE.Vector3(...end).sub(from);
      const mesh = new THREE.Mesh(new THREE.CapsuleGeometry(radius, along.length(), 6, 20), this.material);
      mesh.position.copy(from).addScaledVector(along, 0.5);
      if (along.length() > 1e-9) mesh.quaternion.setFromUnitVectors(UP, along.normalize());
      mesh.userData.link = link;
      this.links[link].add(mesh);
    }
    if (frames) {
      for (const link of this.links.slice(1, 8)) link.add(new THREE.AxesHelper(0.08));
      this.links[9].add(new THREE.AxesHelper(0.16));
    }
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
