"""aiofranka: an asyncio interface to a torque loop in C++, over the vendor's package."""

import asyncio
import contextlib

import aiofranka

import measure


@aiofranka.control_law
def no_torques(s, p, m, tau):
    tau[:] = 0.0


class Aiofranka(measure.Package):
    absent = {
        "hand": "no Franka Hand, a Robotiq only",
        "pose": "computes the pose of its state only",
        "inverse": "no inverse kinematics",
    }

    @contextlib.asynccontextmanager
    async def connected(self):
        self.robot = aiofranka.RobotInterface(self.robot_host, read_tool=False)
        self.controller = None
        yield

    async def motion(self):
        async with self.hold():
            target = self.controller.initial_qpos.copy()
            target[6] += measure.TURN
            await self.controller.move(target)

    @contextlib.asynccontextmanager
    async def hold(self):
        self.controller = aiofranka.NativeFrankaController(self.robot)
        await self.controller.start()
        try:
            yield
        finally:
            await self.controller.stop()

    def state(self):
        return self.robot.state if self.controller is None else self.controller.state

    async def active(self, seconds):
        # Its loop in Python, a task of the event loop.
        controller = aiofranka.FrankaController(self.robot)
        await controller.start()
        try:
            await asyncio.sleep(seconds)
        finally:
            await controller.stop()

    async def law(self, seconds):
        async with self.hold():
            self.controller.switch(no_torques)
            await asyncio.sleep(seconds)


if __name__ == "__main__":
    measure.main(Aiofranka)
