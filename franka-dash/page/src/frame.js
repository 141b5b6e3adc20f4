// The binary state frame; `frame.rs` has its layout.

export const MODES = ["Not ready", "Idle", "Moving", "Guiding", "Reflex", "User stop", "Recovering"];
export const MODE_CLASSES = ["", "idle", "move", "guiding", "reflex", "stopped", ""];
/** What computes the torques, by its number. */
export const LAWS = ["none", "target control", "client's torques", "joint impedance", "Cartesian imp."];
const MAGIC = 0x4446;
const VERSION = 3;
const LENGTH = 736;
export const POSES = 9;

const last = (poses) => poses.subarray(7 * (POSES - 1), 7 * POSES);

/** The end effector in the poses of a frame: position and quaternion. */
export const endEffector = ({ poses }) => last(poses);

/** Where the reference has the end effector: position and quaternion. */
export const reference = ({ referencePoses }) => last(referencePoses);

/** The frame in `buffer`; throws if it is none of this version. */
export function parse(buffer) {
  const view = new DataView(buffer);
  if (buffer.byteLength !== LENGTH || view.getUint16(0, true) !== MAGIC || view.getUint8(2) !== VERSION) {
    throw new Error(`got a frame of ${buffer.byteLength} bytes, expected version ${VERSION} with ${LENGTH}`);
  }
  const flags = view.getUint32(24, true);
  const floats = (offset, count) => new Float32Array(buffer, offset, count);
  return {
    serverMs: Number(view.getBigUint64(8, true)),
    robotMs: Number(view.getBigUint64(16, true)),
    mode: view.getUint8(3),
    running: (flags & 1) !== 0,
    ours: (flags & 2) !== 0,
    holding: (flags & 4) !== 0,
    law: (flags >> 3) & 7,
    success: view.getFloat32(28, true),
    q: floats(32, 7),
    dq: floats(60, 7),
    tau: floats(88, 7),
    tauExt: floats(116, 7),
    force: floats(144, 6),
    reference: floats(168, 7),
    poses: floats(196, 7 * POSES),
    referencePoses: floats(448, 7 * POSES),
    guards: view.getUint32(700, true),
    // Not a number where no gripper is known.
    width: view.getFloat32(704, true),
    // Of the velocity that the joint may have there, -1 to 1.
    pace: floats(708, 7),
  };
}
