"""franka-rs: sessions with targets, on a thread of Rust."""

import asyncio
import contextlib

import franka

import measure


class FrankaRs(measure.Package):
    absent = {
        "inverse": "no inverse kinematics",
        "active": "no control in cycles from Python",
        "law": "no laws of one's own from Python",
    }

    async def homing(self):
        franka.Gripper(self.hand_host).homing()

    async def fingers(self, width):
        franka.Gripper(self.hand_host).move(width, 0.05)

    @contextlib.asynccontextmanager
    async def connected(self):
        self.robot = franka.Robot(self.robot_host, realtime="ignore")
        self.model, self.session = self.robot.model(), None
        yield

    async def motion(self):
        with self.robot.joint_targets() as session:
            target = session.target()
            target[6] += measure.TURN
            session.move_to(target)
            # A session does not report when it has arrived.
            await asyncio.sleep(2.0)

    @contextlib.asynccontextmanager
    async def hold(self):
        with self.robot.joint_targets() as self.session:
            yield

    def state(self):
        return self.robot.read_once() if self.session is None else self.session.state()

    def pose(self, q):
        return self.model.pose("ee", q)


if __name__ == "__main__":
    measure.main(FrankaRs)
