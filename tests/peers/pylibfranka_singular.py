"""Motions of an arm that stands in a singularity: pylibfranka_singular.py ADDRESS

There the robot answers a Cartesian motion twice: it reports the start, and then the rejection.
"""

from pylibfranka import ControlException, ControllerMode, RobotMode

from plans import follow, standing_joints
from steps import Session, check, equal, refuses, script

TEXT = "libfranka: Move command rejected: cannot start at singular pose!"


def cartesian_motions_do_not_start(session):
    robot = session.robot
    for start in (robot.start_cartesian_pose_control, robot.start_cartesian_velocity_control):
        for controller in (ControllerMode.JointImpedance, ControllerMode.CartesianImpedance):
            refuses(ControlException, TEXT, lambda: start(controller))
            state = session.fresh_state()
            equal("mode", state.robot_mode, RobotMode.Idle)
            check(not state.current_errors and not state.last_motion_errors, "no reflex")
    return TEXT


def joint_motions_do(session):
    control = session.robot.start_joint_position_control(ControllerMode.JointImpedance)
    states = follow(control, standing_joints(), 0.1)
    session.state_at_rest()
    return f"{len(states)} cycles"


if __name__ == "__main__":
    script([cartesian_motions_do_not_start, joint_motions_do], Session)
