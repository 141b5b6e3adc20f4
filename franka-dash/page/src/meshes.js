// The links as they look, from the robot's own description. Without these files the arm is drawn as
// its guards see it.

import * as THREE from "three";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import { toCreasedNormals } from "three/examples/jsm/utils/BufferGeometryUtils.js";

const CREASE = 0.6;
const LINKS = 8;

/** The shape of an edge-rounded part: the files have no normals. */
function smoothed(object) {
  object.traverse((part) => {
    if (!part.isMesh) return;
    part.geometry = toCreasedNormals(part.geometry, CREASE);
    // Without gloss, which takes longer where there is no graphics card.
    const { color, side } = part.material;
    part.material = new THREE.MeshLambertMaterial({ color, side });
  });
  return object;
}

/** Links 0 to 7 of the arm called `name`, hand and finger, each in the axes of its frame. */
export async function load(name) {
  const loader = new GLTFLoader();
  const part = async (file) => smoothed((await loader.loadAsync(`meshes/${file}.glb`)).scene);
  const numbers = Array.from({ length: LINKS }, (_, i) => i);
  const [hand, finger, ...links] = await Promise.all(
    [part("hand"), part("finger"), ...numbers.map((i) => part(`${name}/link${i}`))],
  );
  return { links, hand, finger };
}
