"""Moves down until the hand touches something, and up again: ``python guarded_move.py [ADDRESS]``.

Without an address it moves a simulated robot, with a table under its hand.
"""

import asyncio
import sys

from franka_async import Budget, Limits, Robot, Sim
from franka_async.condition import elapsed, force_z


async def main(address: str) -> None:
    # "ignore" is for simulators. Leave it out for a robot, which needs a real-time kernel.
    async with Robot(address, realtime="ignore") as robot:
        start = robot.pose()
        # Slowly, because the force of an impact grows with the velocity.
        slow = Budget(translation=Limits(velocity=0.05))
        # Friction alone shows up to 6.5 N here, more while the arm sets out.
        touched = force_z(8.0).relative() & elapsed(0.2)
        report = await robot.move_by([0.0, 0.0, -0.15], limits=slow, until=touched)
        if report.reacted is None:
            print("nothing there")
        else:
            print(f"contact at {report.reacted.pose[2, 3]:.3f} m after {report.reacted.after:.2f} s")
        await robot.move_to(start)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        asyncio.run(main(sys.argv[1]))
    else:
        with Sim.fr3() as sim:
            hand = sim.true_pose()[:3, 3]
            sim.wall(hand - [0.0, 0.0, 0.05], [0.0, 0.0, 1.0])
            asyncio.run(main(sim.address))
