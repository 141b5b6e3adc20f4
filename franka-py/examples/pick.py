"""Picks a block up and puts it back, with arm and hand: ``python pick.py [ADDRESS]``, with the block between the fingers.

Without an address it moves a simulated robot.
"""

import asyncio
import sys

from franka_async import Gripper, Robot, Sim

BLOCK = 0.03
"""Width of the block, m."""


async def main(address: str, hand: str) -> None:
    # "ignore" is for simulators. Leave it out for a robot, which needs a real-time kernel.
    async with Robot(address, realtime="ignore") as robot, Gripper(hand) as gripper:
        table = robot.pose()
        above = table.copy()
        above[2, 3] += 0.08

        # Homing measures how far the fingers open; the arm may move meanwhile.
        homed, _ = await asyncio.gather(gripper.homing(), robot.move_to(above))
        assert homed, "the fingers did not find their ends"
        await robot.move_to(table, speed=0.5)

        if not await gripper.grasp(BLOCK, speed=0.05, force=40.0):
            raise SystemExit(f"nothing of {BLOCK} m there: the fingers closed to {gripper.state().width:.4f} m")
        print(f"holding {gripper.state().width * 1000:.1f} mm")

        await robot.move_to(above)
        await robot.move_to(table, speed=0.5)
        assert gripper.state().is_grasped, "the block was lost on the way"
        await gripper.move_to(0.08)
        print("put down")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        asyncio.run(main(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else sys.argv[1]))
    else:
        with Sim.fr3(hand=True) as sim:
            sim.place_object(BLOCK)
            assert sim.hand_address is not None
            asyncio.run(main(sim.address, sim.hand_address))
