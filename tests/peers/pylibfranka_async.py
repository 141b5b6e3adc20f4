"""Asynchronous joint positions with pylibfranka: pylibfranka_async.py ADDRESS

The robot plans the path to each target itself; the client sends targets at any time, so that none is late. The simulator
keeps the clock on the wall, since no answer is awaited. The arm moves on while the client is delayed. Checks on the way
therefore hold for any states that the client sees, and events in mid-motion happen in the first half second of a way that
takes five.
"""

import gc

import numpy
from pylibfranka import AsyncPositionControlHandler as Handler
from pylibfranka import InvalidOperationException, RobotMode

# The client's package exports only the values of the type, not its name.
from pylibfranka._pylibfranka import TargetStatus

from steps import Session, check, equal, near, refuses, script, spread

OFFSET = numpy.array([0.2, -0.1, 0.1, 0.2, 0.1, 0.1, 0.3])
# Takes five seconds, most of them above this velocity, rad/s.
FAR = numpy.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -3.4])
UNDER_WAY = 0.2
# The velocities of the vendor's example, rad/s.
SPEED = [0.655] * 4 + [1.315] * 3
TOLERANCE = 1e-3
# Limit for the client: no target is reached while the arm moves faster than this, rad/s.
ARRIVED = 0.01
# Robot time, s: longer than any motion, and longer than a busy machine delays the client.
TIME_MAX = 30.0
# The accelerations of the joints of the Franka Research 3, rad/s².
ACCELERATION = 10.0
ABORTED = "Control interface is in aborted state."
BUSY = "libfranka robot: Cannot perform this operation while another control or read operation is running."


def configuration(speed=SPEED):
    configuration = Handler.Configuration(SPEED, TOLERANCE)
    configuration.maximum_joint_velocities = speed
    return configuration


def configure(session, speed=SPEED):
    result = Handler.configure(session.robot, configuration(speed))
    equal("error", result.error_message, None)
    return result.handler


def command(handler, target):
    result = handler.set_joint_position_target(Handler.JointPositionTarget(target))
    equal("error of a target", result.error_message, None)
    equal("success of a target", result.was_successful, True)
    check(result.motion_uuid, "an identifier of the motion")


def feedback(handler, state=None):
    result = handler.get_target_feedback(state)
    return result.status, result.error_message


def arrival(session, handler, target):
    """Returns the states until the target is reached. The status of each matches the state."""
    states, status = [], None
    while status != TargetStatus.kTargetReached:
        state = session.robot.read_once()
        states.append(state)
        took = state.time.to_sec() - states[0].time.to_sec()
        check(took < TIME_MAX, f"{target} is reached, not {state.q_d} after {took:.1f} s")
        equal("mode on the way", state.robot_mode, RobotMode.Move)
        there = numpy.linalg.norm(numpy.subtract(state.q_d, target)) < TOLERANCE
        resting = numpy.linalg.norm(state.dq_d) < ARRIVED
        status, error = feedback(handler, state)
        expected = TargetStatus.kTargetReached if there and resting else TargetStatus.kExecuting
        equal("feedback on the way", (status, error), (expected, None))
    return states


def go(session, handler, target):
    """Goes to the target, and returns the states until it is reached."""
    command(handler, target)
    session.fresh_state()
    return arrival(session, handler, target)


def on_a_far_way(session):
    """A handler that has set the arm in motion, far from the target, and the newest state."""
    handler = configure(session)
    command(handler, session.home + FAR)
    session.fresh_state()
    while abs((state := session.robot.read_once()).dq_d[6]) < UNDER_WAY:
        equal("feedback", feedback(handler, state), (TargetStatus.kExecuting, None))
    return handler, state


def wrong_velocities_are_answered_with_an_error(session):
    out_of_range = "libfranka: Move command rejected: maximum path deviation out of range!"
    cases = [
        (None, "libfranka: Maximum velocities must be provided for variable rate."),
        ([0.5] * 6, "libfranka: Invalid size of maximum velocities vector."),
        ([0.0] * 7, out_of_range),
        ([-0.5] * 7, out_of_range),
        ([5.0] * 7, out_of_range),
    ]
    for speed, text in cases:
        result = Handler.configure(session.robot, configuration(speed))
        equal(f"handler for {speed}", result.handler, None)
        equal(f"error for {speed}", result.error_message, text)
        equal("mode after a refusal", session.fresh_state().robot_mode, RobotMode.Idle)
    return f"{len(cases)} refused"


def reaches_a_target_and_says_so(session):
    handler = configure(session)
    equal("feedback before a target", feedback(handler), (TargetStatus.kIdle, None))
    states = go(session, handler, session.home + OFFSET)
    fastest = numpy.max(numpy.abs([state.dq_d for state in states]), axis=0)
    check(numpy.all(fastest <= numpy.array(SPEED) + 1e-3), f"{fastest} keeps {SPEED}")
    near("success rate without a cycle", [state.control_command_success_rate for state in states], 0.0, 0.0)
    handler.stop_control()
    near("q", session.state_at_rest().q, session.home + OFFSET, 5e-3)
    return f"fastest joint at {numpy.max(fastest / SPEED):.2f} of what is allowed"


def goes_slower_where_told(session):
    limit, start = 0.3, session.state_at_rest()
    target = numpy.array(start.q_d) - OFFSET
    handler = configure(session, [limit] * 7)
    states = go(session, handler, target)
    handler.stop_control()
    fastest = numpy.max(numpy.abs([state.dq_d for state in states]))
    check(fastest <= limit + 1e-3, f"{fastest} keeps {limit}")
    # At full speed it takes half of this. A delayed client only sees it take longer.
    took, least = states[-1].time.to_sec() - start.time.to_sec(), numpy.max(OFFSET) / limit
    check(took > least, f"{took:.2f} s, more than {least:.2f} s")
    return f"fastest joint at {fastest:.3f} rad/s, in {took:.2f} s"


def turns_round_in_mid_motion(session):
    handler, state = on_a_far_way(session)
    states = go(session, handler, session.home)
    handler.stop_control()
    steps = numpy.max(numpy.abs(numpy.diff([state.dq_d for state in states], axis=0)), axis=1)
    # Between two states others may have been lost.
    times = numpy.diff([state.time.to_sec() for state in states])
    check(numpy.all(steps < ACCELERATION * times + 1e-4), f"velocity goes on without a step of {max(steps)} rad/s")
    near("q", session.state_at_rest().q, session.home, 5e-3)
    return f"from {state.dq_d[6]:.2f} rad/s"


def has_reached_a_target_where_it_is(session):
    handler = configure(session)
    command(handler, session.fresh_state().q_d)
    equal("feedback", feedback(handler, session.fresh_state()), (TargetStatus.kTargetReached, None))
    handler.stop_control()
    return "at once"


def stops_in_mid_motion_and_is_of_no_use_after(session):
    handler, _ = on_a_far_way(session)
    handler.stop_control()
    state = session.state_at_rest()
    check(not state.last_motion_errors, f"errors {state.last_motion_errors}")
    equal("feedback", feedback(handler), (TargetStatus.kAborted, ABORTED))
    result = handler.set_joint_position_target(Handler.JointPositionTarget(session.home))
    equal("target after the end", (result.was_successful, result.error_message), (False, ABORTED))
    travel = state.q_d[6] - session.home[6]
    check(FAR[6] < travel < 0.0, f"between start and target, after {travel:.3f} rad")
    return f"after {travel:.3f} rad"


def goes_on_at_once_after_a_stop(session):
    """The arm still brakes when the next motion is requested, which accepts its first target nevertheless."""
    turns = 3
    for _ in range(turns):
        handler, _ = on_a_far_way(session)
        handler.stop_control()
        handler = configure(session)
        go(session, handler, session.home)
        handler.stop_control()
    return f"{turns} times"


def shares_the_robot_with_no_other_motion(session):
    handler = configure(session)
    equal("a second one", Handler.configure(session.robot, configuration()).error_message, BUSY)
    refuses(InvalidOperationException, BUSY, session.robot.start_torque_control)
    go(session, handler, session.home)
    # Without stop_control: the motion ends when the handler is freed.
    del handler
    gc.collect()
    session.state_at_rest()
    return "and the first goes on"


def ends_when_the_robot_is_stopped(session):
    handler, _ = on_a_far_way(session)
    session.robot.stop()
    session.state_at_rest()
    status = feedback(handler)
    equal("feedback", status, (TargetStatus.kAborted, "libfranka: Move command preempted!"))
    return status[1]


def aborts_beyond_the_range_of_the_joints(session):
    handler = configure(session)
    command(handler, [10.0] * 7)
    session.fresh_state()
    end = session.fresh_state().time.to_sec() + TIME_MAX
    while (state := session.robot.read_once()).robot_mode == RobotMode.Move:
        check(state.time.to_sec() < end, "a reflex")
    equal("errors", str(state.current_errors), '["joint_position_limits_violation"]')
    equal("by a state", feedback(handler, state), (TargetStatus.kAborted, "Control aborted due to reflex."))
    # The second call reads the answer to the motion, of which there is only one.
    text = 'libfranka: Move command aborted: motion aborted by reflex! ["joint_position_limits_violation"]'
    equal("by the robot", feedback(handler), (TargetStatus.kAborted, text))
    busy = Handler.configure(session.robot, configuration()).error_message
    equal("while it lives", busy, BUSY)
    del handler
    gc.collect()
    refused = Handler.configure(session.robot, configuration())
    rejected = 'libfranka: Move command rejected: command not possible in the current mode ("Reflex")!'
    equal("in a reflex", refused.error_message, rejected)
    session.recover()
    reaches_a_target_and_says_so(session)
    return "and moves again after recovery"


def no_numbers_are_refused_by_the_client(session):
    handler = configure(session)
    result = handler.set_joint_position_target(Handler.JointPositionTarget([float("nan")] * 7))
    equal("target", (result.was_successful, result.error_message), (False, "Commanding value is infinite or NaN."))
    equal("feedback", feedback(handler), (TargetStatus.kAborted, ABORTED))
    del handler
    gc.collect()
    session.state_at_rest()
    return "the motion ends with its handler"


if __name__ == "__main__":
    script(
        [
            wrong_velocities_are_answered_with_an_error,
            reaches_a_target_and_says_so,
            goes_slower_where_told,
            turns_round_in_mid_motion,
            has_reached_a_target_where_it_is,
            stops_in_mid_motion_and_is_of_no_use_after,
            goes_on_at_once_after_a_stop,
            shares_the_robot_with_no_other_motion,
            ends_when_the_robot_is_stopped,
            aborts_beyond_the_range_of_the_joints,
            no_numbers_are_refused_by_the_client,
        ],
        Session,
    )
