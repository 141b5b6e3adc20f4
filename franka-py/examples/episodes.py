"""A policy's chunks and gripper, recorded as episodes, exported to LeRobot, and one of them replayed: ``python episodes.py [ADDRESS]``.

Without an address it moves a simulated robot.
"""

import asyncio
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from franka_async import ActionError, Arm, Deadman, Gripper, MotionError, Recorder, RecordingFile, Robot, Sim
from numpy.typing import NDArray

STEP, STEPS = 0.05, 16
"""Time between two points of a chunk, s, and points of a chunk."""


def predict(at: NDArray[np.float64], way: float) -> tuple[NDArray[np.float64], float]:
    """Poses of the next 0.8 s, 4 cm/s up or down, and the target width of the fingers. A policy would also use the state."""
    time.sleep(0.02)
    poses = np.tile(at, (STEPS, 1, 1))
    poses[:, 2, 3] += way * 0.04 * STEP * np.arange(1, STEPS + 1)
    return poses, 0.04 if way > 0.0 else 0.08


async def grip(gripper: Gripper, width: float) -> None:
    """Moves the fingers, unless the policy requests another width meanwhile."""
    try:
        await gripper.move_to(width)
    except ActionError as error:
        if error.kind != "aborted":
            raise


async def run(robot: Robot, arm: Arm, deadman: Deadman, gripper: Gripper, way: float) -> bool:
    """One episode of 2 s. Returns whether no chunk was refused."""
    done, wanted, gripping = True, None, set()
    for _ in range(20):
        seen, reference = robot.state(), arm.reference()
        if reference is None:
            await arm.ended()  # raises why: a reflex, the user stop, a lost robot
            return False
        # Relative actions continue from the target of the arm. The event loop runs while the policy computes.
        poses, width = await asyncio.to_thread(predict, reference.pose, way)
        deadman.keep_alive()
        try:
            await arm.chunk(poses, times=STEP * np.arange(1, STEPS + 1), observed_at=seen)
        except MotionError as refused:
            # A late chunk, or the first one after the deadman was silent. The policy continues after no other refusal.
            if refused.kind not in ("goal", "held"):
                raise
            print(refused)
            done = False
        if width != wanted:
            wanted = width
            gripping.add(asyncio.create_task(grip(gripper, width)))
        await asyncio.sleep(0.08)
    await arm.hold()
    await asyncio.gather(*gripping)
    return done


async def main(address: str, hand: str, folder: Path) -> None:
    file = folder / "run.mcap"
    # "ignore" is for simulators. Leave it out for a robot, which needs a real-time kernel.
    async with Robot(address, realtime="ignore") as robot, Gripper(hand) as gripper:
        await gripper.homing()
        async with Recorder.to_file(file) as recorder:
            await recorder.attach(robot)
            recorder.attach_gripper(gripper)
            for name, way in [("up", 1.0), ("down", -1.0)]:
                # The control thread brakes the arm if the deadman is silent for this time, even if Python is busy.
                deadman = Deadman(1.0)
                async with robot.engage(deadman=deadman) as arm:
                    with recorder.episode(name, task=f"move {name}") as episode:
                        episode.success = await run(robot, arm, deadman, gripper, way)

        recording = RecordingFile.open(file)
        episodes, frames = recording.to_lerobot(folder / "dataset", fps=20)
        print(f"{episodes} episodes, {frames} frames")
        first = recording.episodes()[0]
        report = await robot.replay(recording.between(first.begin, first.end), speed=0.5)
        print(f"replayed, {report.position.max * 1e3:.1f} mm off at most")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        if len(sys.argv) > 1:
            asyncio.run(main(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else sys.argv[1], Path(folder)))
        else:
            with Sim.fr3(hand=True) as sim:
                assert sim.hand_address is not None
                asyncio.run(main(sim.address, str(sim.hand_address), Path(folder)))
