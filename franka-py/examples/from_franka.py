"""A program written for ``franka`` (franka-rs): its import line is all that changes. ``python from_franka.py [ADDRESS]``."""

import sys

import numpy as np
from franka_async import Sim
from franka_async.compat import franka  # was: import franka


def main(address: str) -> None:
    robot = franka.Robot(address, realtime="ignore")
    robot.set_collision_behavior_simple([20.0] * 7, [40.0] * 7, [20.0] * 6, [40.0] * 6)
    before = robot.read_once().O_T_EE[:3, 3]
    try:
        with robot.cartesian_targets(max_velocity=0.2) as targets:
            for _ in range(5):
                targets.move_by([0.0, 0.0, 0.01])
            while np.abs(targets.state().O_T_EE[:3, 3] - targets.target()[:3]).max() > 5e-3:
                pass
    except franka.FrankaError as error:
        raise SystemExit(f"{error.kind}: {error}") from error
    print(f"{(robot.read_once().O_T_EE[:3, 3] - before)[2] * 1000:.0f} mm up")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        main(sys.argv[1])
    else:
        with Sim.fr3() as sim:
            main(sim.address)
