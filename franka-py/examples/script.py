"""A script without asyncio: waits for motions, then sets a goal every 20 ms: ``python script.py [ADDRESS]``.

Ctrl-C brakes the arm. Without an address it moves a simulated robot.
"""

import sys
import time

import numpy as np
from franka_async import Sim, sync


def main(address: str) -> None:
    # "ignore" is for simulators. Leave it out for a robot, which needs a real-time kernel.
    with sync.Robot(address, realtime="ignore") as robot:
        robot.move_by([0.0, 0.0, 0.05])
        start = robot.pose()
        with robot.engage() as arm:  # held between goals
            for angle in np.linspace(0.0, 2.0 * np.pi, 101):
                goal = start.copy()
                goal[1:3, 3] += [0.05 * np.sin(angle), 0.05 - 0.05 * np.cos(angle)]
                arm.try_set(goal)  # never waits
                time.sleep(0.02)
            arm.at_rest()
            off = np.linalg.norm(robot.pose()[:3, 3] - start[:3, 3])
        print(f"back, {off * 1000:.2f} mm off")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        main(sys.argv[1])
    else:
        with Sim.fr3() as sim:
            main(sim.address)
