"""The rules of active control with pylibfranka: pylibfranka_active.py ADDRESS

The client's own loop reads a state and writes a command in turn. Exceptions report violations of the rules. A motion
ends with its last command, with `stop`, or when its control object is freed.
"""

import threading

import numpy
from pylibfranka import (
    CartesianPose,
    ControlException,
    ControllerMode,
    InvalidOperationException,
    JointPositions,
    JointVelocities,
    RobotMode,
    Torques,
)

from plans import follow, joint_positions, line
from steps import Session, check, equal, near, raises, refuses, script

BUSY = "libfranka robot: Cannot perform this operation while another control or read operation is running."
PREEMPTED = "libfranka: Move command preempted!"
TURN = numpy.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.3])


def joint_motion(session):
    return session.robot.start_joint_position_control(ControllerMode.JointImpedance)


def setpoint(state, finished=False):
    command = JointPositions(state.q_d)
    command.motion_finished = finished
    return command


def finish(session, control):
    """Ends a motion that stands still and whose last state has been answered."""
    state, _ = control.readOnce()
    control.writeOnce(setpoint(state, finished=True))
    return session.state_at_rest()


def every_read_brings_a_state_and_the_time_since_the_last(session):
    control = joint_motion(session)
    state, step = control.readOnce()
    equal("first step", step.to_sec(), 0.0)
    control.writeOnce(setpoint(state))
    for _ in range(100):
        before = state.time.to_sec()
        state, step = control.readOnce()
        control.writeOnce(setpoint(state))
        near("step", [step.to_sec()], [state.time.to_sec() - before], 1e-9)
        check(step.to_sec() > 0.0, "time goes on")
    finish(session, control)
    return "0 first, then at least a millisecond"


def one_motion_runs_at_a_time(session):
    robot = session.robot
    control = joint_motion(session)
    for start in (
        robot.start_torque_control,
        lambda: robot.start_joint_position_control(ControllerMode.JointImpedance),
        lambda: robot.start_joint_velocity_control(ControllerMode.JointImpedance),
        lambda: robot.start_cartesian_pose_control(ControllerMode.CartesianImpedance),
        lambda: robot.start_cartesian_velocity_control(ControllerMode.CartesianImpedance),
    ):
        refuses(InvalidOperationException, BUSY, start)
    equal("mode seen beside it", session.robot.read_once().robot_mode, RobotMode.Move)
    finish(session, control)
    return "five starters refused, and the first goes on"


def commands_are_of_the_kind_that_was_started(session):
    text = "Wrong writeOnce method called for currently active control!"
    kinds = [
        (session.robot.start_torque_control, Torques([0.0] * 7)),
        (lambda: joint_motion(session), JointPositions(session.state_at_rest().q_d)),
    ]
    wrong = [JointVelocities([0.0] * 7), CartesianPose(session.fresh_state().O_T_EE_c)]
    for start, command in kinds:
        control = start()
        for other in [*wrong, *(other for _, other in kinds if type(other) is not type(command))]:
            refuses(ControlException, text, lambda: control.writeOnce(other))
        control.readOnce()
        command.motion_finished = True
        control.writeOnce(command)
        session.state_at_rest()
    return text


def commands_are_numbers_and_poses_are_poses(session):
    nan = float("nan")
    no_number = "Commanding value is infinite or NaN."
    no_pose = "libfranka: Attempt to set invalid transformation in motion generator. Has to be column major!"
    robot = session.robot
    cases = [
        (robot.start_torque_control, Torques([nan] * 7), no_number),
        (lambda: joint_motion(session), JointPositions([nan] * 7), no_number),
        (
            lambda: robot.start_joint_velocity_control(ControllerMode.JointImpedance),
            JointVelocities([float("inf")] * 7),
            no_number,
        ),
        (
            lambda: robot.start_cartesian_pose_control(ControllerMode.CartesianImpedance),
            CartesianPose([1.0] * 16),
            no_pose,
        ),
    ]
    for start, command, text in cases:
        control = start()
        control.readOnce()
        refuses(ValueError, text, lambda: control.writeOnce(command))
        # The client sends none of these commands; the motion ends when the object is freed.
        del control
        state = session.state_at_rest()
        check(not state.current_errors and not state.last_motion_errors, "no reflex")
    refuses_sizes()
    return f"{no_number} {no_pose}"


def refuses_sizes():
    for kind, size in ((Torques, 6), (JointPositions, 8), (JointVelocities, 6), (CartesianPose, 12)):
        raises(TypeError, lambda: kind([0.0] * size))


def nothing_follows_the_last_command(session):
    text = "writeOnce must not be called after the motion has finished."
    control = joint_motion(session)
    state = finish(session, control)
    refuses(ControlException, text, lambda: control.writeOnce(setpoint(state)))
    # The next motion may start although the object still exists.
    finish(session, joint_motion(session))
    return text


def motions_follow_each_other_at_once(session):
    for start in (joint_motion, joint_motion, joint_motion):
        control = start(session)
        state, _ = control.readOnce()
        control.writeOnce(setpoint(state, finished=True))
    session.state_at_rest()
    return "three"


def a_motion_ends_with_its_object(session):
    start = numpy.array(session.state_at_rest().q_d)
    control = joint_motion(session)
    follow(control, joint_positions(line(start, TURN, 1.0)), 0.5, finish=False)
    check(session.robot.read_once().dq_d[6] > 0.2, "moving")
    del control
    state = session.state_at_rest()
    travel = state.q_d[6] - start[6]
    check(0.0 < travel < TURN[6], f"between start and target, after {travel:.3f} rad")
    check(not state.current_errors and not state.last_motion_errors, "no reflex")
    return f"after {travel:.3f} rad"


def stop_without_a_motion_does_nothing(session):
    before = session.state_at_rest()
    session.robot.stop()
    near("q_d", session.state_at_rest().q_d, before.q_d, 1e-6)
    return "and succeeds"


def stop_ends_a_motion(session):
    start = numpy.array(session.state_at_rest().q_d)
    control = joint_motion(session)
    follow(control, joint_positions(line(start, -TURN, 1.0)), 0.5, finish=False)
    session.robot.stop()
    stopped = stop_shows(session, start, control.readOnce, repeat=True)
    del control
    return stopped


def stop_ends_a_motion_of_another_thread(session):
    start = numpy.array(session.state_at_rest().q_d)
    moving, outcome = threading.Event(), []

    def move():
        control = joint_motion(session)
        # Takes seconds on the wall, so that even a delayed thread stops it in mid-motion.
        duration = 20.0
        command = joint_positions(line(start, TURN, duration))

        def announced(t, state):
            if t > 1.0:
                moving.set()
            return command(t, state)

        try:
            follow(control, announced, duration)
        except Exception as error:
            outcome.append(error)
        finally:
            moving.set()

    mover = threading.Thread(target=move)
    mover.start()
    moving.wait()
    session.robot.stop()
    mover.join()
    check(len(outcome) == 1, "by an exception")
    error = outcome.pop()

    def raise_it():
        raise error

    return stop_shows(session, start, raise_it)


def stop_shows(session, start, action, repeat=False):
    """Checks that the error of `action` reports a stopped motion, and that the arm rests on the way."""

    def until_it_ends():
        # States from before the stop may still be waiting in the socket.
        for _ in range(1000 if repeat else 1):
            action()

    refuses(ControlException, PREEMPTED, until_it_ends)
    state = session.state_at_rest()
    travel = abs(state.q_d[6] - start[6])
    check(0.0 < travel < TURN[6], f"between start and target, after {travel:.3f} rad")
    check(not state.current_errors and not state.last_motion_errors, "no reflex")
    near("q", state.q, state.q_d, 5e-3)
    return f"after {travel:.3f} rad: {PREEMPTED}"


if __name__ == "__main__":
    script(
        [
            every_read_brings_a_state_and_the_time_since_the_last,
            one_motion_runs_at_a_time,
            commands_are_of_the_kind_that_was_started,
            commands_are_numbers_and_poses_are_poses,
            nothing_follows_the_last_command,
            motions_follow_each_other_at_once,
            a_motion_ends_with_its_object,
            stop_without_a_motion_does_nothing,
            stop_ends_a_motion,
            stop_ends_a_motion_of_another_thread,
        ],
        Session,
    )
