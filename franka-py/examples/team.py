"""Two arms as one: both begin together, and the fault of one stops the other: ``python team.py [LEFT RIGHT [SILENCE]]``.

A robot without a state for SILENCE, s, is at fault. Simulators on a busy machine need more than the usual 0.02. Without addresses it
moves two simulated robots.
"""

import asyncio
import sys

import numpy as np
from franka_async import Robot, Sim, Team, TeamError


async def main(left_address: str, right_address: str, silence: float = 0.02) -> None:
    # "ignore" is for simulators. Leave it out for robots, which need a real-time kernel.
    left, right = (Robot(address, realtime="ignore") for address in (left_address, right_address))
    async with left, right, await Team.engage(left, right, silence=silence) as team:
        up = np.eye(4)
        up[2, 3] = 0.05
        try:
            reports = await team.move_to([up @ left.pose(), up @ right.pose()])
        except TeamError as error:
            raise SystemExit(f"arm {error.member} is at fault: {error.__cause__}") from error
        print("arrived after", " and ".join(f"{report.duration:.2f} s" for report in reports))

        # To each its own motion, begun together.
        one, other = team.arms
        await team.run([one.move_by([0.0, 0.05, -0.05]), other.move_by([0.0, -0.05, -0.05])])
        print("back on the table")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        asyncio.run(main(sys.argv[1], sys.argv[2], *map(float, sys.argv[3:])))
    else:
        one, other = Sim.in_step("fr3", "fer")
        with one, other:
            asyncio.run(main(one.address, other.address, 1.0))
