"""Every kind of motion that pylibfranka offers, with either controller of the robot: pylibfranka_motions.py ADDRESS

Joint motions go from the home position to another and back, Cartesian ones between their poses. The client sends no
elbow with a Cartesian motion: its binding of `CartesianPose` and `CartesianVelocities` takes none.
"""

import numpy
from pylibfranka import ControllerMode

from plans import (
    SETPOINT_TOLERANCE,
    arrive,
    cartesian_poses,
    cartesian_velocities,
    joint_positions,
    joint_velocities,
    line,
    rotation_vector,
    success_rate,
    turn,
)
from steps import Session, check, matrix, near, script, spread

OFFSET = numpy.array([0.1, -0.05, 0.1, 0.15, -0.1, 0.1, 0.2])
SHIFT, TURN = numpy.array([0.03, 0.03, 0.05]), numpy.array([0.1, -0.1, 0.2])
DURATION = 1.0
# The lag of the motors, in joint positions, rad, and of the end effector, m.
JOINT_LAG, TIP_LAG = 5e-3, 2e-3
# Twists are integrated, from the pose that the robot reports.
TURN_TOLERANCE = 1e-3


class Motions(Session):
    """A connection, and the pose of the home position."""

    def __init__(self, address):
        super().__init__(address)
        self.home_pose = matrix(self.state_at_rest().O_T_EE_d)

    def shifted(self):
        pose = self.home_pose.copy()
        pose[:3, 3] += SHIFT
        pose[:3, :3] = turn(TURN) @ pose[:3, :3]
        return pose


def joint_impedance_follows_joint_positions(session):
    return by_joint_positions(session, ControllerMode.JointImpedance, session.home + OFFSET)


def joint_impedance_follows_joint_velocities(session):
    return by_joint_velocities(session, ControllerMode.JointImpedance, session.home)


def joint_impedance_follows_cartesian_poses(session):
    return by_cartesian_poses(session, ControllerMode.JointImpedance, session.shifted())


def joint_impedance_follows_cartesian_velocities(session):
    return by_cartesian_velocities(session, ControllerMode.JointImpedance, session.home_pose)


def cartesian_impedance_follows_joint_positions(session):
    return by_joint_positions(session, ControllerMode.CartesianImpedance, session.home + OFFSET)


def cartesian_impedance_follows_joint_velocities(session):
    return by_joint_velocities(session, ControllerMode.CartesianImpedance, session.home)


def cartesian_impedance_follows_cartesian_poses(session):
    return by_cartesian_poses(session, ControllerMode.CartesianImpedance, session.shifted())


def cartesian_impedance_follows_cartesian_velocities(session):
    return by_cartesian_velocities(session, ControllerMode.CartesianImpedance, session.home_pose)


def by_joint_positions(session, controller, target):
    return to_joints(session, session.robot.start_joint_position_control, joint_positions, controller, target)


def by_joint_velocities(session, controller, target):
    return to_joints(session, session.robot.start_joint_velocity_control, joint_velocities, controller, target)


def by_cartesian_poses(session, controller, target):
    return to_pose(session, session.robot.start_cartesian_pose_control, cartesian_poses, controller, target)


def by_cartesian_velocities(session, controller, target):
    return to_pose(session, session.robot.start_cartesian_velocity_control, cartesian_velocities, controller, target)


def to_joints(session, start, commands, controller, target):
    before = numpy.array(session.state_at_rest().q_d)
    plan = line(before, target - before, DURATION)
    states = arrive(start(controller), commands(plan), DURATION)
    after = session.state_at_rest()
    near("q_d", after.q_d, target, SETPOINT_TOLERANCE)
    near("q", after.q, target, JOINT_LAG)
    lag = max(spread(state.q, state.q_d) for state in states)
    check(lag < JOINT_LAG, f"joints lag by {lag:.2e} rad")
    # At the steepest of the plan.
    peak = numpy.max(numpy.abs([state.dq_d for state in states]), axis=0)
    steepest = numpy.abs(plan(DURATION / 2)[1])
    near("fastest dq_d", peak, steepest, 0.1 * steepest.max() + 0.01)
    return f"{spread(after.q, target) * 1e3:.2f} mrad from the target, {summary(states)}"


def to_pose(session, start, commands, controller, target):
    before = session.state_at_rest()
    pose = matrix(before.O_T_EE_d)
    way, rotation = target[:3, 3] - pose[:3, 3], rotation_vector(pose, target)
    plans = (line(pose[:3, 3], way, DURATION), line(numpy.zeros(3), rotation, DURATION))
    states = arrive(start(controller), commands(pose, *plans), DURATION)
    after = session.state_at_rest()
    for what, reached in (("O_T_EE_d", matrix(after.O_T_EE_d)), ("O_T_EE", matrix(after.O_T_EE))):
        near(f"position of {what}", reached[:3, 3], target[:3, 3], TIP_LAG)
        near(f"orientation of {what}", rotation_vector(target, reached), numpy.zeros(3), TIP_LAG + TURN_TOLERANCE)
    lag = max(spread(matrix(state.O_T_EE)[:3, 3], matrix(state.O_T_EE_c)[:3, 3]) for state in states)
    check(lag < TIP_LAG, f"the end effector lags by {lag:.2e} m")
    peak = max(numpy.linalg.norm(state.O_dP_EE_c[:3]) for state in states)
    near("fastest O_dP_EE_c", peak, numpy.linalg.norm(plans[0](DURATION / 2)[1]), 0.02)
    near("elbow", after.elbow, after.elbow_d, JOINT_LAG)
    near("sign of the elbow", after.elbow[1], before.elbow[1], 0)
    distance = spread(matrix(after.O_T_EE)[:3, 3], target[:3, 3])
    return f"{distance * 1e3:.2f} mm from the target, {summary(states)}"


def summary(states):
    return f"success rate {success_rate(states):.2f}"


if __name__ == "__main__":
    script(
        [
            joint_impedance_follows_joint_positions,
            joint_impedance_follows_joint_velocities,
            joint_impedance_follows_cartesian_poses,
            joint_impedance_follows_cartesian_velocities,
            cartesian_impedance_follows_joint_positions,
            cartesian_impedance_follows_joint_velocities,
            cartesian_impedance_follows_cartesian_poses,
            cartesian_impedance_follows_cartesian_velocities,
        ],
        Motions,
    )
