"""Records chosen columns of every cycle of a motion: ``python record.py [ADDRESS [FILE.npz]]``.

Without an address it moves a simulated robot.
"""

import asyncio
import sys

import numpy as np
from franka_async import Robot, Sim


async def main(address: str, file: str | None = None) -> None:
    # "ignore" is for simulators. Leave it out for a robot, which needs a real-time kernel.
    async with Robot(address, realtime="ignore") as robot:
        # franka_async.record_columns() has all names, with their units.
        async with robot.record(["goal", "q", "q_ref", "turnaround"]) as recording:
            await robot.move_by([0.0, 0.0, 0.1])
        moving = recording["goal"] > 0  # there is no reference before and after the motion
        behind = np.abs(recording["q_ref"] - recording["q"])[moving].max(axis=0)
        print(f"{len(recording)} cycles, {recording.lost} lost")
        print(f"each joint was behind its reference by at most {behind.round(4)} rad")
        if file is not None:
            recording.save(file)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        asyncio.run(main(*sys.argv[1:]))
    else:
        with Sim.fr3() as sim:
            asyncio.run(main(sim.address))
