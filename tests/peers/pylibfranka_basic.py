"""Drives a simulated robot with pylibfranka, the vendor's own client: pylibfranka_basic.py ADDRESS

The vendor's client is the judge here: whatever it reads, computes and raises has to be what it would get from a
robot. Each step prints one line; the last line counts them, and the exit code is 0 only if none failed.

Client and simulator share a machine that may be busy. A robot bridges lost commands by going on with constant
acceleration, and takes the next command as it comes, so every command here continues the setpoint that the robot
reports. Twenty lost in a row end any motion. That says nothing about the simulator: the step is then repeated, a few
times at most, and the output says so.
"""

import math
import sys
import time
import traceback

import numpy
from pylibfranka import (
    CartesianPose,
    CommandException,
    ControlException,
    ControllerMode,
    JointPositions,
    JointVelocities,
    RealtimeConfig,
    Robot,
    RobotMode,
    Torques,
)

LATE = "communication_constraints_violation"
REPEATS_MAX = 4
CYCLE = 1e-3
# How fast a setpoint returns to its plan, 1/s, and how long that may take at the end of a motion, s.
RETURN = 20.0
SETTLE = 0.3
# States carry setpoints in single precision; steering from them ends this close to the plan, rad.
SETPOINT_TOLERANCE = 5e-4


def main(address):
    steps = [
        connects_and_reads_states,
        gets_the_model,
        sets_parameters,
        moves_joints,
        moves_along_a_line,
        moves_home_at_joint_velocities,
        controls_torques_for_two_seconds,
        stops_a_motion,
        recovers_from_a_jump,
        connects_again,
    ]
    session = Session(address)
    passed = 0
    for step in steps:
        name = step.__name__.replace("_", " ")
        start = time.monotonic()
        try:
            summary = repeat_if_late(step, session)
        except Exception as error:  # Any exception of any step is a failure of that step.
            print(f"FAIL  {name}: {type(error).__name__}: {error}", flush=True)
            traceback.print_exc()
            if session.robot is None:
                print("      without a connection no other step can run")
                break
            session.clear()
        else:
            passed += 1
            seconds = time.monotonic() - start
            print(f"ok    {name} ({seconds:.1f} s): {summary}", flush=True)
    print(f"{passed} passed, {len(steps) - passed} failed")
    return 0 if passed == len(steps) else 1


def repeat_if_late(step, session):
    for _ in range(REPEATS_MAX):
        try:
            return step(session)
        except ControlException as error:
            if LATE not in str(error):
                raise
            print(f"      repeated for late commands: {error}", flush=True)
            session.robot.automatic_error_recovery()
    return step(session)


class Session:
    """The connection that the steps share."""

    def __init__(self, address):
        self.address = address
        self.robot = None
        # Joint positions to which motions are relative, so that one that is repeated ends where it would have.
        self.home = None

    def connect(self):
        self.robot = None  # A robot serves one client at a time: let the old one go first.
        self.robot = Robot(self.address, RealtimeConfig.kIgnore)

    def fresh_state(self):
        """A state of now: the first read may return one that waited in the socket since the last read."""
        self.robot.read_once()
        return self.robot.read_once()

    def state_at_rest(self):
        """The state once the arm has settled after a motion."""
        for _ in range(3000):
            state = self.robot.read_once()
            if state.robot_mode == RobotMode.Idle and max(map(abs, state.dq)) < 1e-3:
                return state
        raise AssertionError("the arm did not come to rest in 3 s")

    def clear(self):
        """Best effort after a failed step, so that the next one starts from an idle robot."""
        try:
            self.robot.automatic_error_recovery()
        except Exception as error:
            print(f"      clearing failed too: {error}")


def connects_and_reads_states(session):
    session.connect()
    session.home = numpy.array(session.fresh_state().q_d)
    states = [session.fresh_state()] + [session.robot.read_once() for _ in range(500)]
    times = [state.time.to_sec() for state in states]
    gaps = [after - before for before, after in zip(times, times[1:])]
    check(min(gaps) > 0, "time runs forwards")
    check(max(gaps) < 0.5, f"no gap of {max(gaps):.3f} s")
    near("median gap", [sorted(gaps)[len(gaps) // 2]], [0.001], 1e-9)
    state = states[-1]
    check(state.robot_mode == RobotMode.Idle, f"mode {state.robot_mode}")
    check(not state.current_errors, f"errors {state.current_errors}")
    check_transform(state.O_T_EE)
    near("F_T_EE = F_T_NE * NE_T_EE", matrix(state.F_T_NE) @ matrix(state.NE_T_EE), matrix(state.F_T_EE), 1e-6)
    near("gravity", state.O_ddP_O, [0, 0, -9.81], 1e-3)
    near("q_d of a resting arm", state.q, state.q_d, 5e-3)
    check(numpy.all(numpy.isfinite(state.tau_J)), "finite torques")
    return f"{len(states)} states over {times[-1] - times[0]:.3f} s of robot time"


def gets_the_model(session):
    model = session.robot.load_model()
    state = session.fresh_state()
    mass = numpy.array(model.mass(state)).reshape(7, 7)
    near("symmetry of the mass matrix", mass, mass.T, 1e-9)
    eigenvalues = numpy.linalg.eigvalsh(mass)
    check(eigenvalues.min() > 0, f"positive definite mass matrix, least eigenvalue {eigenvalues.min()}")
    jacobian = numpy.array(model.zero_jacobian(state)).reshape(6, 7, order="F")
    check(numpy.linalg.matrix_rank(jacobian, 1e-3) == 6, "full rank of the Jacobian")
    near("Coriolis at rest", model.coriolis(state), numpy.zeros(7), 1e-2)
    # At rest the joints carry the weight of the arm, up to what friction holds.
    gravity = numpy.array(model.gravity(state))
    near("measured torque against gravity", state.tau_J, gravity, 1.5)
    return f"least eigenvalue of the mass matrix {eigenvalues.min():.4f}, gravity of joint 2 {gravity[1]:.2f} Nm"


def sets_parameters(session):
    robot = session.robot
    robot.set_collision_behavior([100.0] * 7, [100.0] * 7, [100.0] * 6, [100.0] * 6)
    robot.set_joint_impedance([3000, 3000, 3000, 2500, 2500, 2000, 2000])
    robot.set_cartesian_impedance([3000, 3000, 3000, 300, 300, 300])
    inertia = numpy.diag([0.001, 0.002, 0.003])
    robot.set_load(0.5, [0.01, 0.02, 0.03], inertia.flatten().tolist())
    lever = numpy.eye(4)
    lever[:3, 3] = [0.0, 0.0, 0.1]
    robot.set_EE(lever.flatten(order="F").tolist())
    robot.set_K(lever.flatten(order="F").tolist())
    state = session.fresh_state()
    near("m_load", [state.m_load], [0.5], 1e-6)
    near("F_x_Cload", state.F_x_Cload, [0.01, 0.02, 0.03], 1e-6)
    near("I_load", state.I_load, inertia.flatten(), 1e-6)
    near("NE_T_EE", matrix(state.NE_T_EE), lever, 1e-6)
    near("EE_T_K", matrix(state.EE_T_K), lever, 1e-6)
    near("m_total", [state.m_total], [state.m_ee + 0.5], 1e-6)
    text = raises(CommandException, lambda: robot.set_joint_impedance([-1.0] * 7))
    # The load is not really there: leave it set and every torque would be wrong.
    robot.set_load(0.0, [0.0] * 3, [0.0] * 9)
    for reset in (robot.set_EE, robot.set_K):
        reset(numpy.eye(4).flatten().tolist())
    near("NE_T_EE", matrix(session.fresh_state().NE_T_EE), numpy.eye(4), 1e-6)
    return f"echoed in the state; refused: {text}"


def moves_joints(session):
    start = numpy.array(session.state_at_rest().q_d)
    target = session.home + numpy.array([0.1, -0.05, 0.1, 0.15, -0.1, 0.1, 0.2])
    duration = 2.0
    control = session.robot.start_joint_position_control(ControllerMode.JointImpedance)
    command = joint_positions(line(start, target - start, duration))
    rate = follow(control, command, duration + SETTLE)
    state = session.state_at_rest()
    near("q_d", state.q_d, target, SETPOINT_TOLERANCE)
    near("q", state.q, target, 1e-2)
    return f"{spread(state.q, target) * 1e3:.2f} mrad from the target, success rate {rate:.2f}"


def moves_along_a_line(session):
    start = matrix(session.state_at_rest().O_T_EE_c)
    offset, duration = numpy.array([0.0, 0.03, 0.05]), 2.0

    plan = line(start[:3, 3], offset, duration)

    at_rest = (numpy.zeros(3),) * 3

    def command(t, state):
        pose, twist = matrix(state.O_T_EE_c), numpy.array(state.O_dP_EE_c)
        pose[:3, 3], _ = steer(pose[:3, 3], twist[:3], plan(t))
        _, spin = steer(small_turn(start, pose), twist[3:], at_rest)
        pose[:3, :3] += numpy.cross(spin * CYCLE, pose[:3, :3], axisb=0, axisc=0)
        return CartesianPose(pose.flatten(order="F").tolist())

    control = session.robot.start_cartesian_pose_control(ControllerMode.CartesianImpedance)
    rate = follow(control, command, duration + SETTLE)
    pose = matrix(session.state_at_rest().O_T_EE)
    near("position", pose[:3, 3], start[:3, 3] + offset, 5e-3)
    near("orientation", pose[:3, :3], start[:3, :3], 2e-2)
    distance = spread(pose[:3, 3], start[:3, 3] + offset)
    return f"{distance * 1e3:.2f} mm from the target, success rate {rate:.2f}"


def moves_home_at_joint_velocities(session):
    start, duration = numpy.array(session.state_at_rest().q_d), 2.0
    plan = line(start, session.home - start, duration)

    def command(t, state):
        _, velocity = steer(state.q_d, state.dq_d, plan(t))
        return JointVelocities(velocity.tolist())

    control = session.robot.start_joint_velocity_control(ControllerMode.JointImpedance)
    rate = follow(control, command, duration + SETTLE)
    state = session.state_at_rest()
    near("q_d", state.q_d, session.home, SETPOINT_TOLERANCE)
    near("q", state.q, session.home, 1e-2)
    return f"{spread(state.q, session.home) * 1e3:.2f} mrad from the target, success rate {rate:.2f}"


def controls_torques_for_two_seconds(session):
    start = numpy.array(session.state_at_rest().q)
    stiffness = numpy.array([100.0, 100.0, 100.0, 100.0, 50.0, 40.0, 30.0])
    damping = numpy.sqrt(stiffness)
    duration, swing = 2.0, 0.1
    reached = []

    def command(t, state):
        # Joint 1 swings out and back: torques that do nothing would not move it.
        goal = start.copy()
        goal[0] += swing * 0.5 * (1.0 - math.cos(2.0 * math.pi * min(t / duration, 1.0)))
        reached.append(state.q[0] - start[0])
        torques = stiffness * (goal - numpy.array(state.q)) - damping * numpy.array(state.dq)
        # Enters from zero and leaves to zero, as the robot asks.
        fade = ease(min(t, duration - t) / 0.2)[0]
        return Torques((fade * torques).tolist())

    rate = follow(session.robot.start_torque_control(), command, duration)
    state = session.state_at_rest()
    check(max(reached) > 0.3 * swing, f"joint 1 swung by {max(reached):.4f} rad only")
    near("q after the swing", state.q, start, 5e-2)
    near("tau_J_d afterwards", state.tau_J_d, numpy.zeros(7), 1e-6)
    return f"joint 1 swung {max(reached):.3f} of {swing} rad, success rate {rate:.2f}"


def stops_a_motion(session):
    session.robot.stop()  # Without a motion there is nothing to stop, and no complaint.
    start = numpy.array(session.state_at_rest().q_d)
    control = session.robot.start_joint_position_control(ControllerMode.JointImpedance)
    offset = numpy.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.3])

    follow(control, joint_positions(line(start, offset, 3.0)), 0.8, finish=False)
    session.robot.stop()
    text = raises(ControlException, lambda: continue_motion(control, start))
    check("preempted" in text, text)
    del control
    state = session.state_at_rest()
    travel = state.q[6] - start[6]
    check(0.0 < travel < 0.29, f"stopped between start and target, after {travel:.3f} rad")
    check(not state.current_errors, f"errors {state.current_errors}")
    return f"stopped after {travel:.3f} rad: {text}"


def recovers_from_a_jump(session):
    start = numpy.array(session.state_at_rest().q_d)
    control = session.robot.start_joint_position_control(ControllerMode.JointImpedance)
    text = raises(ControlException, lambda: continue_motion(control, start + 0.05))
    check("discontinuity" in text or "start_pose_invalid" in text, text)
    del control
    state = session.fresh_state()
    check(state.robot_mode == RobotMode.Reflex, f"mode {state.robot_mode}")
    check(bool(state.current_errors), "current errors")
    check(bool(state.last_motion_errors), "last motion errors")
    refused = raises(
        CommandException,
        lambda: session.robot.start_joint_position_control(ControllerMode.JointImpedance),
    )
    check("Reflex" in refused, refused)
    session.robot.automatic_error_recovery()
    state = session.state_at_rest()
    check(not state.current_errors, f"errors after recovery: {state.current_errors}")
    check(bool(state.last_motion_errors), "the reason of the reflex outlives the recovery")
    moves_joints(session)
    return f"{text.splitlines()[0]}; moves again after recovery"


def connects_again(session):
    q = numpy.array(session.state_at_rest().q)
    session.connect()
    near("q in the new session", session.fresh_state().q, q, 5e-3)
    return moves_home_at_joint_velocities(session)


def follow(control, command, duration, finish=True):
    """Runs `duration` seconds of robot time of a motion and returns the median success rate that the robot reports.

    `command` maps the time since the first cycle and the state to the command of a cycle; the last one finishes the
    motion unless `finish` is false.
    """
    t, rates = 0.0, []
    while t < duration:
        state, step = control.readOnce()
        t += step.to_sec()
        rates.append(state.control_command_success_rate)
        cycle = command(t, state)
        cycle.motion_finished = finish and t >= duration
        control.writeOnce(cycle)
    return sorted(rates)[len(rates) // 2]


def joint_positions(plan):
    """Joint position commands along a plan."""

    def command(t, state):
        setpoint, _ = steer(state.q_d, state.dq_d, plan(t))
        return JointPositions(setpoint.tolist())

    return command


def line(start, offset, duration):
    """A plan from `start` to `start + offset`, from rest to rest: position, velocity and acceleration over time."""

    def plan(t):
        position, velocity, acceleration = ease(t / duration)
        return (
            start + offset * position,
            offset * velocity / duration,
            offset * acceleration / duration**2,
        )

    return plan


def steer(setpoint, velocity, plan):
    """The setpoint and its velocity one cycle later: accelerating as planned, and back to the plan where they left it."""
    setpoint, velocity = numpy.array(setpoint), numpy.array(velocity)
    planned_setpoint, planned_velocity, acceleration = plan
    acceleration = acceleration + 2.0 * RETURN * (planned_velocity - velocity)
    acceleration += RETURN**2 * (planned_setpoint - setpoint)
    velocity = velocity + acceleration * CYCLE
    return setpoint + velocity * CYCLE, velocity


def continue_motion(control, q):
    """Commands `q` until the motion ends, which it has to by an exception."""
    for _ in range(1000):
        control.readOnce()
        control.writeOnce(JointPositions(list(q)))


def ease(x):
    """Rises from 0 to 1 over 0 <= x <= 1, at rest at both ends; with its first and second derivative."""
    x = min(max(x, 0.0), 1.0)
    return (
        x**3 * (10.0 + x * (6.0 * x - 15.0)),
        30.0 * (x * (1.0 - x)) ** 2,
        60.0 * x * (1.0 - x) * (1.0 - 2.0 * x),
    )


def matrix(values):
    return numpy.array(values).reshape(4, 4, order="F")


def small_turn(start, end):
    """Rotation vector between two orientations that are nearly the same."""
    turn = end[:3, :3] @ start[:3, :3].T
    return 0.5 * numpy.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])


def check(condition, what):
    if not condition:
        raise AssertionError(what)


def check_transform(values):
    pose = matrix(values)
    near("rotation", pose[:3, :3] @ pose[:3, :3].T, numpy.eye(3), 1e-6)
    near("last row", pose[3], [0, 0, 0, 1], 0)


def spread(got, want):
    return float(numpy.max(numpy.abs(numpy.asarray(got) - numpy.asarray(want))))


def near(what, got, want, tolerance):
    error = spread(got, want)
    check(error <= tolerance, f"{what}: off by {error:.3e}, allowed {tolerance:g}")


def raises(kind, action):
    try:
        action()
    except kind as error:
        return str(error).strip()
    raise AssertionError(f"no {kind.__name__}")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__.splitlines()[0])
    sys.exit(main(sys.argv[1]))
