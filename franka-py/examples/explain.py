"""Records a motion that is hit, reads it back and explains why the robot stopped: ``python explain.py [ADDRESS [FOLDER]]``.

Without an address it moves a simulated robot, and pushes it until the robot stops itself. ``hit.mcap`` and ``hit.svg`` go to the
folder, or else to a temporary one.
"""

import asyncio
import sys
import tempfile
from pathlib import Path

import numpy as np
from franka_async import ControlError, Recorder, RecordingFile, Robot, Sim, explain


async def record(address: str, file: Path, sim: Sim | None = None) -> None:
    # "ignore" is for simulators. Leave it out for a robot, which needs a real-time kernel.
    async with Robot(address, realtime="ignore") as robot, Recorder.to_file(file) as recorder:
        await recorder.attach(robot)
        with recorder.episode("left-1", task="move 20 cm to the left") as episode:
            moving = asyncio.ensure_future(robot.move_by([0.0, 0.2, 0.0], speed=0.3))
            if sim is not None:
                while abs(robot.state().dq).max() < 0.01:
                    await asyncio.sleep(0.001)
                sim.push([0.0, -80.0, 0.0])
            try:
                await moving
                episode.success = True
            except ControlError as error:
                print(", ".join(error.errors))
                episode.success = False
                if sim is not None:
                    sim.let_go()  # the cause has to be gone
                await robot.recover()


def look(file: Path, figure: Path) -> None:
    recording = RecordingFile.open(file)
    external = recording.column("tau_ext_hat_filtered")  # a row for each cycle
    print(f"{recording}: up to {np.abs(external).max():.0f} N m on a joint")
    explanation = explain(recording)
    print(explanation)
    figure.write_text(explanation.svg())


def main(folder: Path, address: str | None = None) -> None:
    if address is not None:
        asyncio.run(record(address, folder / "hit.mcap"))
    else:
        with Sim.fr3() as sim:
            asyncio.run(record(sim.address, folder / "hit.mcap", sim))
    look(folder / "hit.mcap", folder / "hit.svg")
    print("explained")


if __name__ == "__main__":
    if len(sys.argv) > 2:
        main(Path(sys.argv[2]), sys.argv[1])
    else:
        with tempfile.TemporaryDirectory() as temporary:
            main(Path(temporary), *sys.argv[1:])
