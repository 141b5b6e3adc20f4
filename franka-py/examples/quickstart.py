"""Connects, looks at the state, moves the hand and the joints: ``python quickstart.py [ADDRESS]``.

Without an address it moves a simulated robot.
"""

import asyncio
import sys

from franka_async import Robot, Sim


async def main(address: str) -> None:
    # "ignore" is for simulators. Leave it out for a robot, which needs a real-time kernel.
    async with Robot(address, realtime="ignore") as robot:
        state = robot.state()
        print(f"connected to {robot.address}, mode {state.robot_mode}, joints {state.q.round(3)} rad")

        pose = robot.pose()  # (4, 4), in the frame of the base
        pose[2, 3] += 0.05
        report = await robot.move_to(pose)
        assert report.final_error is not None
        print(f"5 cm up after {report.duration:.2f} s, {report.final_error.translation * 1000:.2f} mm off")

        await robot.move_by([0.0, 0.0, -0.05])
        q = robot.state().q
        q[[0, 6]] += [0.2, -0.3]
        await robot.move_joints(q, speed=0.5)
        try:
            await asyncio.wait_for(robot.move_by([0.0, 0.2, 0.0], speed=0.2), 0.5)
        except asyncio.TimeoutError:
            print("cancelled: the arm brakes")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        asyncio.run(main(sys.argv[1]))
    else:
        with Sim.fr3() as sim:
            asyncio.run(main(sim.address))
