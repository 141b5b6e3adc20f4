"""The vendor's package. Its control is a loop in Python that reads and writes."""

import contextlib
import math
import threading

from pylibfranka import ControllerMode, Gripper, JointPositions, RealtimeConfig, Robot, Torques

import measure


class Pylibfranka(measure.Package):
    absent = {
        "pose": "its Model has no pose",
        "inverse": "no inverse kinematics",
        "law": "no laws without the interpreter",
    }

    def gripper(self):
        return Gripper(self.hand_host)

    async def homing(self):
        self.gripper().homing()

    async def fingers(self, width):
        self.gripper().move(width, 0.05)

    @contextlib.asynccontextmanager
    async def connected(self):
        self.robot = Robot(self.robot_host, RealtimeConfig.kIgnore)
        self.control = None
        yield

    async def motion(self):
        control = self.robot.start_joint_position_control(ControllerMode.JointImpedance)
        state, _ = control.readOnce()
        start, passed, finished = list(state.q_d), 0.0, False
        while not finished:
            passed, finished = min(passed, DURATION), passed >= DURATION
            turned = measure.TURN * (1.0 - math.cos(math.pi * passed / DURATION)) / 2.0
            command = JointPositions(start[:6] + [start[6] + turned])
            command.motion_finished = finished
            control.writeOnce(command)
            if not finished:
                _, step = control.readOnce()
                passed += step.to_sec()

    @contextlib.asynccontextmanager
    async def hold(self):
        self.control = self.robot.start_torque_control()
        self.held, self.newest = True, None
        thread = threading.Thread(target=self.cycles)
        thread.start()
        try:
            yield
        finally:
            self.held = False
            thread.join()
            self.control = None

    def cycles(self):
        command = Torques([0.0] * 7)
        while not command.motion_finished:
            self.newest, _ = self.control.readOnce()
            command.motion_finished = not self.held
            self.control.writeOnce(command)

    def state(self):
        if self.control is not None:
            raise measure.Absent("a thread that controls reads all states")
        return self.robot.read_once()

    async def active(self, seconds):
        control = self.robot.start_torque_control()
        command, passed = Torques([0.0] * 7), 0.0
        while passed < seconds:
            _, step = control.readOnce()
            passed += step.to_sec()
            command.motion_finished = passed >= seconds
            control.writeOnce(command)


DURATION = 2.0


if __name__ == "__main__":
    measure.main(Pylibfranka)
