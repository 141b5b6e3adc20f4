"""Explains a reflex, keeps the log of the motion, and recovers: ``python recover.py [ADDRESS]``.

Without an address it moves a simulated robot, and pushes it until the robot stops itself.
"""

import asyncio
import sys
from pathlib import Path

from franka_async import ControlError, Robot, Sim


async def main(address: str, sim: Sim | None = None, file: Path | None = None) -> None:
    # "ignore" is for simulators. Leave it out for a robot, which needs a real-time kernel.
    async with Robot(address, realtime="ignore") as robot:
        moving = asyncio.ensure_future(robot.move_by([0.0, 0.2, 0.0], speed=0.3))
        if sim is not None:
            while abs(robot.state().dq).max() < 0.01:
                await asyncio.sleep(0.001)
            sim.push([0.0, -80.0, 0.0])
        try:
            await moving
            print("arrived")
        except ControlError as error:
            print(", ".join(error.errors))
            print(error.diagnosis)
            assert error.log is not None
            print(f"the last {len(error.log)} cycles: up to {abs(error.log.O_F_ext_hat_K[:, 1]).max():.0f} N along y")
            if file is not None:
                file.write_text(error.to_csv())
            if sim is not None:
                sim.let_go()  # the cause has to be gone
            await robot.recover()  # moves nothing
            print("recovered")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        asyncio.run(main(sys.argv[1]))
    else:
        with Sim.fr3() as sim:
            asyncio.run(main(sim.address, sim))
