"""Motions that scripts command cycle by cycle, and the robot's report of them.

A robot does not smooth commands, so every command here continues the setpoint that the robot reports.
"""

import numpy
from pylibfranka import CartesianPose, CartesianVelocities, JointPositions, JointVelocities, RobotMode

from steps import column_major, equal, matrix

CYCLE = 1e-3
# Rate at which a setpoint returns to its plan, 1/s, and the time that this takes at the end of a motion, s.
RETURN = 20.0
SETTLE = 0.3
# States carry setpoints in single precision; steering from them ends this close to the plan, rad or m.
SETPOINT_TOLERANCE = 5e-4


def arrive(control, command, duration):
    """Commands along a plan of ``duration`` seconds, finishes the motion once its setpoint rests, and returns the states."""
    return follow(control, command, duration + SETTLE)


def follow(control, command, duration, finish=True):
    """Runs `duration` seconds of robot time of a motion and returns the states.

    `command` maps the time since the first cycle and the state to the command of a cycle; the last one finishes the
    motion unless `finish` is false.
    """
    t, states, over = 0.0, [], False
    while not over:
        state, step = control.readOnce()
        t += step.to_sec()
        equal("mode in a motion", state.robot_mode, RobotMode.Move)
        states.append(state)
        over = t >= duration
        cycle = command(t, state)
        cycle.motion_finished = finish and over
        control.writeOnce(cycle)
    return states


def success_rate(states):
    """Returns the median of the success rates that the robot reports."""
    rates = sorted(state.control_command_success_rate for state in states)
    return rates[len(rates) // 2]


def joint_positions(plan):
    """Joint position commands along a plan."""

    def command(t, state):
        setpoint, _ = steer(state.q_d, state.dq_d, plan(t))
        return JointPositions(setpoint.tolist())

    return command


def joint_velocities(plan):
    """Joint velocity commands along a plan of positions."""

    def command(t, state):
        _, velocity = steer(state.q_d, state.dq_d, plan(t))
        return JointVelocities(velocity.tolist())

    return command


def cartesian_poses(start, translation, rotation):
    """Poses along a plan of the translation and one of the rotation vector away from the orientation of `start`."""

    def command(t, state):
        pose, twist = matrix(state.O_T_EE_c), numpy.array(state.O_dP_EE_c)
        pose[:3, 3], _ = steer(pose[:3, 3], twist[:3], translation(t))
        _, spin = steer(rotation_vector(start, pose), twist[3:], rotation(t))
        pose[:3, :3] = turn(spin * CYCLE) @ pose[:3, :3]
        return CartesianPose(column_major(pose))

    return command


def cartesian_velocities(start, translation, rotation):
    """Twists along the same plans."""

    def command(t, state):
        pose, twist = matrix(state.O_T_EE_d), numpy.array(state.O_dP_EE_c)
        _, velocity = steer(pose[:3, 3], twist[:3], translation(t))
        _, spin = steer(rotation_vector(start, pose), twist[3:], rotation(t))
        return CartesianVelocities([*velocity, *spin])

    return command


def standing_joints():
    """Joint position commands that hold the position at the start of the motion."""
    return standing(lambda state: joint_positions(line(state.q_d, numpy.zeros(7), 1.0)))


def standing_pose():
    """Poses that hold the pose at the start of the motion."""

    def begin(state):
        pose = matrix(state.O_T_EE_c)
        still = numpy.zeros(3)
        return cartesian_poses(pose, line(pose[:3, 3], still, 1.0), line(still, still, 1.0))

    return standing(begin)


def standing(begin):
    commands = []

    def command(t, state):
        if not commands:
            commands.append(begin(state))
        return commands[0](t, state)

    return command


def line(start, offset, duration):
    """A plan from `start` to `start + offset`, from rest to rest: position, velocity and acceleration over time."""
    start, offset = numpy.asarray(start), numpy.asarray(offset)

    def plan(t):
        position, velocity, acceleration = ease(t / duration)
        return (
            start + offset * position,
            offset * velocity / duration,
            offset * acceleration / duration**2,
        )

    return plan


def steer(setpoint, velocity, plan):
    """The setpoint and its velocity one cycle later: the planned acceleration, and a correction back to the plan."""
    setpoint, velocity = numpy.array(setpoint), numpy.array(velocity)
    planned_setpoint, planned_velocity, acceleration = plan
    acceleration = acceleration + 2.0 * RETURN * (planned_velocity - velocity)
    acceleration += RETURN**2 * (planned_setpoint - setpoint)
    velocity = velocity + acceleration * CYCLE
    return setpoint + velocity * CYCLE, velocity


def ease(x):
    """A function that rises from 0 to 1 for ``x`` within ``0 <= x <= 1``, at rest at both ends, and its first two derivatives."""
    x = min(max(x, 0.0), 1.0)
    return (
        x**3 * (10.0 + x * (6.0 * x - 15.0)),
        30.0 * (x * (1.0 - x)) ** 2,
        60.0 * x * (1.0 - x) * (1.0 - 2.0 * x),
    )


def skew(vector):
    x, y, z = vector
    return numpy.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def turn(vector):
    """The rotation matrix of a rotation vector."""
    angle = numpy.linalg.norm(vector)
    if angle < 1e-12:
        return numpy.eye(3) + skew(vector)
    axis = skew(vector / angle)
    return numpy.eye(3) + numpy.sin(angle) * axis + (1.0 - numpy.cos(angle)) * axis @ axis


def rotation_vector(start, end):
    """The rotation vector, in the axes of the base, from one orientation to another less than half a turn away."""
    between = end[:3, :3] @ start[:3, :3].T
    doubled_sine = numpy.array(
        [between[2, 1] - between[1, 2], between[0, 2] - between[2, 0], between[1, 0] - between[0, 1]]
    )
    sine = 0.5 * numpy.linalg.norm(doubled_sine)
    if sine < 1e-9:
        return 0.5 * doubled_sine
    angle = numpy.arctan2(sine, 0.5 * (numpy.trace(between) - 1.0))
    return 0.5 * doubled_sine * angle / sine
