"""Commands that cause a reflex, and recovery, with pylibfranka: pylibfranka_reflexes.py ADDRESS

Every violation ends in an exception with the names of the errors, in a reflex that refuses motions, and in a recovery
after which the arm moves again. Errors are named after the commanded quantity: a jump in a position
is one in its derivatives too.
"""

import numpy
from pylibfranka import (
    CartesianPose,
    CartesianVelocities,
    CommandException,
    ControlException,
    ControllerMode,
    JointPositions,
    JointVelocities,
    RobotMode,
    Torques,
)

from plans import (
    CYCLE,
    SETPOINT_TOLERANCE,
    arrive,
    follow,
    joint_positions,
    joint_velocities,
    line,
    standing_joints,
    standing_pose,
    turn,
)
from steps import Session, check, column_major, equal, matrix, near, refuses, script, spread

ABORTED = "libfranka: Move command aborted: motion aborted by reflex!"
REFUSED = 'libfranka: Move command rejected: command not possible in the current mode ("Reflex")!'
INSENSITIVE = [100.0]
# Cycles at rest before a violation, and cycles after it within which it has to be detected.
CALM, NOTICED = 20, 50
JOINT_1 = numpy.eye(7)[0]
JOINT = "joint_motion_generator_"
CARTESIAN = "cartesian_motion_generator_"


def joint_positions_have_to_begin_where_the_arm_is(session):
    errors = ["joint_position_motion_generator_start_pose_invalid"]
    return violates(session, joint_motion(session), None, by_joints(0.2), errors)


def joint_positions_may_not_jump(session):
    errors = [
        f"{JOINT}velocity_limits_violation",
        f"{JOINT}velocity_discontinuity",
        f"{JOINT}acceleration_discontinuity",
    ]
    return violates(session, joint_motion(session), standing_joints(), by_joints(0.05), errors)


def joint_positions_may_not_step_by_little(session):
    # 20 µrad in a millisecond: slow, but from nothing it is 20 rad/s².
    errors = [f"{JOINT}velocity_discontinuity", f"{JOINT}acceleration_discontinuity"]
    return violates(session, joint_motion(session), standing_joints(), by_joints(2e-5), errors)


def joint_velocities_may_not_jump(session):
    start = lambda: session.robot.start_joint_velocity_control(ControllerMode.JointImpedance)
    errors = [f"{JOINT}acceleration_discontinuity"]
    return violates(session, start, at_joint_velocity(0.0), at_joint_velocity(1.0), errors)


def joint_velocities_have_limits(session):
    start = lambda: session.robot.start_joint_velocity_control(ControllerMode.JointImpedance)
    errors = [f"{JOINT}velocity_limits_violation", f"{JOINT}acceleration_discontinuity"]
    return violates(session, start, at_joint_velocity(0.0), at_joint_velocity(3.0), errors)


def poses_have_to_begin_where_the_arm_is(session):
    errors = ["cartesian_position_motion_generator_start_pose_invalid"]
    return violates(session, pose_motion(session), None, shifted_by(10.0), errors)


def poses_may_not_jump(session):
    errors = [f"{CARTESIAN}velocity_limits_violation", f"{CARTESIAN}velocity_discontinuity"]
    return violates(session, pose_motion(session), standing_pose(), shifted_by(0.01), errors, others=CARTESIAN)


def orientations_may_not_jump(session):
    errors = [f"{CARTESIAN}velocity_limits_violation", f"{CARTESIAN}velocity_discontinuity"]
    return violates(session, pose_motion(session), standing_pose(), turned_by(0.3), errors, others=CARTESIAN)


def twists_may_not_jump(session):
    errors = [f"{CARTESIAN}acceleration_discontinuity"]
    return violates(session, twist_motion(session), at_speed(0.0), at_speed(0.5), errors, others=CARTESIAN)


def twists_have_limits(session):
    errors = [f"{CARTESIAN}velocity_limits_violation", f"{CARTESIAN}acceleration_discontinuity"]
    return violates(session, twist_motion(session), at_speed(0.0), at_speed(4.0), errors, others=CARTESIAN)


def torques_may_not_begin_with_a_jump(session):
    errors = ["controller_torque_discontinuity"]
    return violates(session, session.robot.start_torque_control, None, at_torque(5.0), errors)


def torques_may_not_jump(session):
    errors = ["controller_torque_discontinuity"]
    return violates(session, session.robot.start_torque_control, at_torque(0.0), at_torque(5.0), errors)


def torques_may_not_make_a_joint_too_fast(session):
    def ramp(t, state):
        return at_torque(min(3.0, state.tau_J_d[6] + 0.1))(t, state)

    errors = ["joint_velocity_violation"]
    summary = violates(session, session.robot.start_torque_control, at_torque(0.0), ramp, errors, noticed=3000)
    moves_home(session)
    return summary


def a_moving_arm_cannot_finish(session):
    start = numpy.array(session.state_at_rest().q_d)
    control = session.robot.start_joint_velocity_control(ControllerMode.JointImpedance)
    plan = line(start, 0.2 * JOINT_1, 1.0)
    text = f'Motion finished commanded, but the robot is still moving! ["{JOINT}acceleration_discontinuity"]'
    try:
        follow(control, joint_velocities(plan), 0.5)
    except ControlException as error:
        equal("text", first_line(error), text)
    else:
        raise AssertionError("the motion finished")
    del control
    equal("mode", session.fresh_state().robot_mode, RobotMode.Reflex)
    session.recover()
    moves_home(session)
    return text


def a_push_is_a_contact_and_then_a_collision(session):
    """A load that is declared but not there feels like a push from below."""
    robot = session.robot
    try:
        robot.set_collision_behavior([100.0] * 7, [100.0] * 7, [5.0] * 6, [10.0] * 6)
        robot.set_load(2.0, [0.0] * 3, [0.0] * 9)
        session.state_at_rest()
        state = settled(session)
        pushed = numpy.abs(state.K_F_ext_hat_K) >= 5.0
        check(pushed[:3].any(), f"a force of {state.K_F_ext_hat_K[:3]} N")
        near("contact", state.cartesian_contact, pushed, 0)
        near("no collision without a motion", state.cartesian_collision, numpy.zeros(6), 0)
        refuses(ControlException, ABORTED, joint_motion(session))
        state = session.fresh_state()
        equal("errors", str(state.current_errors), '["cartesian_reflex"]')
        collided = numpy.abs(state.K_F_ext_hat_K) >= 10.0
        near("collision", state.cartesian_collision, collided, 0)
        session.recover()
        near("collision after recovery", session.fresh_state().cartesian_collision, numpy.zeros(6), 0)

        robot.set_collision_behavior([2.0] * 7, [3.0] * 7, [100.0] * 6, [100.0] * 6)
        state = settled(session)
        touched = numpy.abs(state.tau_ext_hat_filtered) >= 2.0
        check(touched.any(), f"torques of {state.tau_ext_hat_filtered} Nm")
        near("contact of joints", state.joint_contact, touched, 0)
        refuses(ControlException, ABORTED, joint_motion(session))
        state = session.fresh_state()
        equal("errors", str(state.current_errors), '["joint_reflex"]')
        near("collision of joints", state.joint_collision, touched, 0)
    finally:
        robot.set_load(0.0, [0.0] * 3, [0.0] * 9)
        robot.set_collision_behavior(INSENSITIVE * 7, INSENSITIVE * 7, INSENSITIVE * 6, INSENSITIVE * 6)
        session.recover()
    near("contact without a load", settled(session).joint_contact, numpy.zeros(7), 0)
    moves_home(session)
    return "cartesian_reflex, joint_reflex"


def recovery_without_a_reflex_does_nothing(session):
    before = session.state_at_rest()
    after = session.recover()
    near("q_d", after.q_d, before.q_d, 1e-6)
    return "and succeeds"


def violates(session, start, calm, violation, errors, others=None, noticed=NOTICED):
    """Commands a violation, and checks the reaction of client and robot, and that a recovery clears it.

    `calm` is commanded before, if given. The errors have to be `errors`; further ones are allowed if their names begin
    with `others`, since a motion of the end effector is checked in the joints too.
    """
    session.state_at_rest()
    control = start()
    text = None
    try:
        for cycle in range((CALM if calm else 0) + noticed):
            state, _ = control.readOnce()
            control.writeOnce(calm(cycle * CYCLE, state) if calm and cycle < CALM else violation(0.0, state))
    except ControlException as error:
        text = first_line(error)
    check(text is not None, "no exception")
    del control
    state = session.fresh_state()
    equal("mode", state.robot_mode, RobotMode.Reflex)
    equal("text", text, f"{ABORTED} {state.current_errors}")
    equal("last motion errors", str(state.last_motion_errors), str(state.current_errors))
    named = str(state.current_errors).strip("[]").replace('"', "").split(", ")
    if others is None:
        equal("errors", named, errors)
    else:
        check(set(errors) <= set(named), f"{named} contain {errors}")
        check(all(name.startswith(others) for name in named), f"all of {named} begin with {others}")
    check(all(getattr(state.current_errors, name) for name in named), "the errors by their attributes")
    refuses(CommandException, REFUSED, joint_motion(session))
    reason = str(state.last_motion_errors)
    state = session.recover()
    equal("reason after the recovery", str(state.last_motion_errors), reason)
    return ", ".join(named)


def first_line(error):
    """The text without statistics of the connection, which may follow."""
    return str(error).splitlines()[0]


def settled(session):
    """A state after the filters of the estimates have settled."""
    for _ in range(300):
        session.robot.read_once()
    return session.fresh_state()


def moves_home(session):
    start = numpy.array(session.state_at_rest().q_d)
    duration = max(1.0, 2.0 * spread(start, session.home))
    plan = line(start, session.home - start, duration)
    arrive(joint_motion(session)(), joint_positions(plan), duration)
    near("q_d", session.state_at_rest().q_d, session.home, SETPOINT_TOLERANCE)


def joint_motion(session):
    return lambda: session.robot.start_joint_position_control(ControllerMode.JointImpedance)


def pose_motion(session):
    return lambda: session.robot.start_cartesian_pose_control(ControllerMode.CartesianImpedance)


def twist_motion(session):
    return lambda: session.robot.start_cartesian_velocity_control(ControllerMode.CartesianImpedance)


def by_joints(offset):
    return lambda t, state: JointPositions((numpy.array(state.q_d) + offset * JOINT_1).tolist())


def at_joint_velocity(velocity):
    return lambda t, state: JointVelocities((velocity * JOINT_1).tolist())


def shifted_by(offset):
    def command(t, state):
        pose = matrix(state.O_T_EE_c)
        pose[0, 3] += offset
        return CartesianPose(column_major(pose))

    return command


def turned_by(angle):
    def command(t, state):
        pose = matrix(state.O_T_EE_c)
        pose[:3, :3] = turn(numpy.array([0.0, 0.0, angle])) @ pose[:3, :3]
        return CartesianPose(column_major(pose))

    return command


def at_speed(velocity):
    return lambda t, state: CartesianVelocities([velocity, 0.0, 0.0, 0.0, 0.0, 0.0])


def at_torque(torque):
    return lambda t, state: Torques([0.0] * 6 + [torque])


if __name__ == "__main__":
    script(
        [
            joint_positions_have_to_begin_where_the_arm_is,
            joint_positions_may_not_jump,
            joint_positions_may_not_step_by_little,
            joint_velocities_may_not_jump,
            joint_velocities_have_limits,
            poses_have_to_begin_where_the_arm_is,
            poses_may_not_jump,
            orientations_may_not_jump,
            twists_may_not_jump,
            twists_have_limits,
            torques_may_not_begin_with_a_jump,
            torques_may_not_jump,
            torques_may_not_make_a_joint_too_fast,
            a_moving_arm_cannot_finish,
            a_push_is_a_contact_and_then_a_collision,
            recovery_without_a_reflex_does_nothing,
        ],
        Session,
    )
