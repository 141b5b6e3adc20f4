// Where the links are: `franka-model/src/geometry.rs` has the same lengths. The 0.2 mm by which those of Research 3 are longer are not
// seen.

import * as THREE from "three";

/** Of each joint's frame in that of the link before: place, `[m]`, and quarter turns about x. */
const ORIGINS = [
  [[0, 0, 0.333], 0], [[0, 0, 0], -1], [[0, -0.316, 0], 1], [[0.0825, 0, 0], 1],
  [[-0.0825, 0.384, 0], -1], [[0, 0, 0], 1], [[0.088, 0, 0], 1],
];
const FLANGE = [0, 0, 0.107];
const X = new THREE.Vector3(1, 0, 0);
const Z = new THREE.Vector3(0, 0, 1);

/** Joint frames 1 to 7 and flange, as matrices. */
function frames(q) {
  const at = new THREE.Matrix4();
  const turn = new THREE.Matrix4();
  const links = ORIGINS.map(([place, quarters], i) => {
    at.multiply(turn.makeRotationAxis(X, (quarters * Math.PI) / 2).setPosition(...place));
    return at.multiply(turn.makeRotationAxis(Z, q[i])).clone();
  });
  return [...links, at.multiply(turn.makeTranslation(...FLANGE))];
}

/** The end effector on the flange, from a pose measured with these joints. */
export function tool(q, [x, y, z, ...quaternion]) {
  const pose = new THREE.Matrix4().makeRotationFromQuaternion(new THREE.Quaternion(...quaternion)).setPosition(x, y, z);
  return frames(q)[7].invert().multiply(pose);
}

/** Joint frames 1 to 7, flange and end effector: place and quaternion, seven numbers each. */
export function poses(q, onFlange) {
  const links = frames(q);
  links.push(links[7].clone().multiply(onFlange));
  const [place, turn, scale] = [new THREE.Vector3(), new THREE.Quaternion(), new THREE.Vector3()];
  return links.flatMap((link) => {
    link.decompose(place, turn, scale);
    return [...place.toArray(), ...turn.toArray()];
  });
}
