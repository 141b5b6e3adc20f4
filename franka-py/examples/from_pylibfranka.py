"""A program written for the vendor's pylibfranka: its import line is all that changes. ``python from_pylibfranka.py [ADDRESS]``."""

import sys

import numpy as np
from franka_async import Sim
from franka_async.compat import pylibfranka  # was: import pylibfranka


def main(address: str) -> None:
    robot = pylibfranka.Robot(address, pylibfranka.RealtimeConfig.kIgnore)
    robot.set_collision_behavior([20.0] * 7, [40.0] * 7, [10.0] * 6, [20.0] * 6)
    active = robot.start_joint_position_control(pylibfranka.ControllerMode.JointImpedance)
    start, elapsed = None, 0.0
    while True:
        state, duration = active.readOnce()
        elapsed += duration.to_sec()
        if start is None:
            start = np.array(state.q_d)
        delta = np.pi / 32.0 * (1.0 - np.cos(np.pi / 2.5 * min(elapsed, 5.0)))
        command = pylibfranka.JointPositions((start + np.array([0, 0, 0, delta, delta, 0, delta])).tolist())
        command.motion_finished = elapsed >= 5.0
        active.writeOnce(command)
        if command.motion_finished:
            break
    print("finished", np.abs(np.array(robot.read_once().q) - start).max().round(3), "rad from the start")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        main(sys.argv[1])
    else:
        with Sim.fr3() as sim:
            main(sim.address)
