// What is drawn around the arm: arrows, ways, regions, contacts.

import * as THREE from "three";
import { Line2 } from "three/examples/jsm/lines/Line2.js";
import { LineGeometry } from "three/examples/jsm/lines/LineGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { COLOURS } from "./colours.js";

const ARROW_MAX = 0.6;
const PLANE_SIZE = 2.4;
const Z = new THREE.Vector3(0, 0, 1);

/** An arrow from a place. */
export class Arrow {
  constructor(colour) {
    this.group = new THREE.ArrowHelper(Z, new THREE.Vector3(), 0.1, colour, 0.05, 0.03);
    this.group.visible = false;
  }

  /** From `place`, nowhere for null, along a direction of any length. */
  set(place, direction, length) {
    this.group.visible = place !== null;
    if (!place) return;
    this.group.position.copy(place);
    this.group.setDirection(direction.clone().normalize());
    this.group.setLength(Math.min(length, ARROW_MAX), 0.05, 0.03);
  }
}

/** A line through places. */
export class Trail {
  count = 0;

  constructor(colour, { dashed }) {
    this.material = new LineMaterial({ color: colour, linewidth: 3, dashed, dashSize: 0.02, gapSize: 0.012 });
    this.group = new THREE.Group();
  }

  set(places) {
    // Its geometry cannot grow.
    for (const line of [...this.group.children]) {
      line.geometry.dispose();
      this.group.remove(line);
    }
    this.count = places.length;
    if (places.length < 2) return;
    const geometry = new LineGeometry();
    geometry.setPositions(places.flat());
    const line = new Line2(geometry, this.material);
    line.computeLineDistances();
    this.group.add(line);
  }
}

/** Where something touches the arm: a ball as large as the place is uncertain, and the force. */
export class Contact {
  #arrow = new Arrow(COLOURS.contact);
  #ball;

  constructor() {
    const material = new THREE.MeshBasicMaterial({ color: COLOURS.contact, transparent: true, opacity: 0.35, depthTest: false });
    this.#ball = new THREE.Mesh(new THREE.SphereGeometry(1, 20, 14), material);
    this.group = new THREE.Group();
    this.group.add(this.#ball, this.#arrow.group);
    this.group.visible = false;
  }

  set(contact) {
    this.group.visible = contact !== null;
    if (!contact) return;
    this.#ball.position.set(...contact.point);
    this.#ball.scale.setScalar(Math.min(0.12, Math.max(0.02, contact.spread)));
    const force = new THREE.Vector3(...contact.force);
    const length = force.length() * 0.01;
    // It ends at the place.
    const start = this.#ball.position.clone().addScaledVector(force.clone().normalize(), -Math.min(length, ARROW_MAX));
    this.#arrow.set(start, force, length);
  }
}

/** Regions to keep out of. */
export class Regions {
  count = 0;

  constructor() {
    this.group = new THREE.Group();
    const material = () => new THREE.MeshLambertMaterial({
      color: COLOURS.region, transparent: true, side: THREE.DoubleSide, depthWrite: false,
    });
    // A plane fills the picture: it is fainter.
    this.materials = { box: material(), plane: material() };
    this.light(false);
    this.edges = new THREE.LineBasicMaterial({ color: COLOURS.region });
  }

  set(regions) {
    this.group.clear();
    this.count = regions.length;
    for (const region of regions) {
      const mesh = region.kind === "box" ? this.#box(region) : this.#plane(region);
      mesh.add(new THREE.LineSegments(new THREE.EdgesGeometry(mesh.geometry), this.edges));
      this.group.add(mesh);
    }
  }

  #box({ position, orientation, half }) {
    const mesh = new THREE.Mesh(new THREE.BoxGeometry(...half.map((side) => 2 * side)), this.materials.box);
    mesh.position.set(...position);
    mesh.quaternion.set(...orientation);
    return mesh;
  }

  /** Its surface, about the place of it that is nearest to the arm. */
  #plane({ normal, offset }) {
    const mesh = new THREE.Mesh(new THREE.PlaneGeometry(PLANE_SIZE, PLANE_SIZE), this.materials.plane);
    const out = new THREE.Vector3(...normal);
    const middle = new THREE.Vector3(0, 0, 0.4);
    mesh.position.copy(middle).addScaledVector(out, offset - middle.dot(out));
    mesh.quaternion.setFromUnitVectors(Z, out);
    return mesh;
  }

  /** Brighter while the arm is held back from them. */
  light(bright) {
    this.materials.box.opacity = bright ? 0.6 : 0.22;
    this.materials.plane.opacity = bright ? 0.3 : 0.09;
  }
}
