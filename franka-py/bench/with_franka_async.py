"""Our package."""

import contextlib
import os
import time

import franka_async

import measure


class FrankaAsync(measure.Package):
    async def homing(self):
        async with franka_async.Gripper(self.hand_host) as hand:
            await hand.homing()

    async def fingers(self, width):
        async with franka_async.Gripper(self.hand_host) as hand:
            await hand.move_to(width, 0.05)

    @contextlib.asynccontextmanager
    async def connected(self):
        self.model = franka_async.Model.fr3()
        async with franka_async.Robot(self.robot_host, realtime="ignore") as self.robot:
            yield

    async def read(self, seconds):
        end = time.perf_counter() + seconds
        async for _ in self.robot.states():
            if time.perf_counter() > end:
                return

    async def motion(self):
        q = self.robot.state().q
        q[6] += measure.TURN
        await self.robot.move_joints(q, speed=0.5)

    @contextlib.asynccontextmanager
    async def hold(self):
        async with self.robot.engage():
            yield

    def state(self):
        return self.robot.state()

    def pose(self, q):
        return self.model.pose("ee", q)

    def inverse(self, poses):
        found = self.model.ik_from(poses, measure.READY)
        return int((found == found).all(axis=1).sum())

    async def active(self, seconds):
        passed = 0.0
        control = await self.robot.active_torques()
        # The vendor's package does that to any thread that connects; ours leaves it to the program.
        with contextlib.suppress(PermissionError):
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(99))
        while passed < seconds:
            _, step = control.read_once()
            passed += step
            control.write_once([0.0] * 7, finished=passed >= seconds)

    async def law(self, seconds):
        code = franka_async.laws.compiled(no_torques)
        await self.robot.run_law(franka_async.Law(code, parameters=[seconds]))


def no_torques(cycle, parameters, memory, output):
    """Commands no torques until the time in its parameter is over."""
    for joint in range(7):
        output[joint] = 0.0
    return 1 if cycle.time >= parameters[0] else 0


if __name__ == "__main__":
    measure.main(FrankaAsync)
