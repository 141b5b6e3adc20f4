"""franky-control: motions on a thread of C++."""

import contextlib

from franky import Frame, Gripper, JointImpedanceTracker, JointMotion, RealtimeConfig, ReferenceType, Robot

import measure


class Franky(measure.Package):
    absent = {
        "inverse": "no inverse kinematics",
        "active": "no control in cycles from Python",
        "law": "no laws of one's own",
    }

    async def homing(self):
        Gripper(self.hand_host).homing()

    async def fingers(self, width):
        Gripper(self.hand_host).move(width, 0.05)

    @contextlib.asynccontextmanager
    async def connected(self):
        self.robot = Robot(self.robot_host, relative_dynamics_factor=0.1, realtime_config=RealtimeConfig.Ignore)
        state = self.robot.state
        self.frames = state.F_T_EE, state.EE_T_K
        yield

    async def motion(self):
        self.robot.move(JointMotion([0.0] * 6 + [measure.TURN], ReferenceType.Relative))

    @contextlib.asynccontextmanager
    async def hold(self):
        with JointImpedanceTracker(self.robot):
            yield

    def state(self):
        return self.robot.state

    def pose(self, q):
        return self.robot.model.pose(Frame.EndEffector, q, *self.frames).matrix


if __name__ == "__main__":
    measure.main(Franky)
