"""Joint impedance as a custom control law, compiled by numba: ``python impedance_law.py [ADDRESS]``.

The law runs in the control cycle, without the interpreter. It is tried out before: one call on a state, then one cycle at a time on
a simulated arm in virtual time. Without an address it then moves a simulated robot. Needs ``pip install 'franka-async[numba]'``.
"""

import asyncio
import sys
from typing import Any

import numpy as np
from franka_async import Law, Robot, Sim, VirtualRobots, laws

STIFFNESS = np.array([600.0, 600.0, 600.0, 600.0, 250.0, 150.0, 50.0])
DAMPING = np.array([50.0, 50.0, 50.0, 50.0, 30.0, 25.0, 15.0])


def spring(cycle: Any, parameters: Any, memory: Any, output: Any) -> int:
    """A spring and a damper at each joint, for ``memory[0]`` seconds. Parameters: stiffness, target, damping."""
    for i in range(7):
        spring = parameters[i] * (parameters[7 + i] - cycle.q[i])
        output[i] = spring - parameters[14 + i] * cycle.dq[i] + cycle.coriolis[i]
    return laws.FINISH if cycle.time > memory[0] else laws.GO_ON


def law_for(q: Any, seconds: float) -> Law:
    """The law that draws the joints to ``q``."""
    return Law(laws.compiled(spring), parameters=np.concatenate([STIFFNESS, q, DAMPING]), memory=[seconds])


def try_out(cycles: int = 500) -> None:
    """Runs the law for half a second of virtual time, a cycle after the other."""
    robots = VirtualRobots("fr3", control="torque")
    target = robots.state(0).q + 0.02
    law = law_for(target, 10.0)
    for _ in range(cycles):
        torques, code = law.step(robots.state(0))
        assert code == laws.GO_ON, f"the law stopped with {code}"
        _, moving = robots.step([torques], cycles=1)
        assert moving[0], f"the robot stopped itself: {robots.errors(0)}"
    off = np.abs(robots.state(0).q - target).max()
    print(f"tried out: {off:.3f} rad from the target after {cycles} cycles")


async def main(address: str) -> None:
    # "ignore" is for simulators. Leave it out for a robot, which needs a real-time kernel.
    async with Robot(address, realtime="ignore") as robot:
        law = law_for(robot.state().q, 1.0)
        running = asyncio.create_task(robot.run_law(law))
        await asyncio.sleep(0.3)
        softer = law.parameters
        softer[:7] *= 0.5
        law.parameters = softer  # reaches the next cycle, all of them at once
        report = await running
        print(f"held for {report.duration:.2f} s by a spring that was softened on the way")


if __name__ == "__main__":
    try_out()
    if len(sys.argv) > 1:
        asyncio.run(main(sys.argv[1]))
    else:
        with Sim.fr3() as sim:
            asyncio.run(main(sim.address))
