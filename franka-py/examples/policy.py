"""A policy sets targets at 10 Hz, and the arm follows smoothly at 1 kHz: ``python policy.py [ADDRESS]``.

Without an address it moves a simulated robot.
"""

import asyncio
import sys

import numpy as np
from franka_async import Latest, Robot, Sim
from numpy.typing import NDArray


async def policy(targets: Latest, start: NDArray[np.float64]) -> None:
    """Sets a target every 100 ms: here along a circle of 10 cm. A policy would look at ``robot.state().flat()``."""
    for angle in np.linspace(0.0, 2.0 * np.pi, 41):
        target = start.copy()
        target[1:3, 3] += [0.05 * np.sin(angle), 0.05 - 0.05 * np.cos(angle)]
        targets.set(target)
        await asyncio.sleep(0.1)
    targets.close()  # the motion then ends at the last target


async def main(address: str) -> None:
    # "ignore" is for simulators. Leave it out for a robot, which needs a real-time kernel.
    async with Robot(address, realtime="ignore") as robot:
        start = robot.pose()
        targets = Latest(start)
        deciding = asyncio.create_task(policy(targets, start))
        # The control thread brakes the arm if no target comes for a second, even if Python is busy.
        report = await robot.follow(targets, watchdog=(1.0, "brake"))
        await deciding
        print(f"followed for {report.duration:.1f} s, {report.lost_states} states were lost")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        asyncio.run(main(sys.argv[1]))
    else:
        with Sim.fr3() as sim:
            asyncio.run(main(sim.address))
