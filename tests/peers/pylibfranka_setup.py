"""Connections, states and parameters with pylibfranka: pylibfranka_setup.py ADDRESS

The client's constructor takes one of two real-time configurations. Enforcing needs a kernel that reports to be a
real-time one. Elsewhere the client fails after it has connected, and the script checks that.
"""

import os
from pathlib import Path

import numpy
from pylibfranka import (
    CommandException,
    ControllerMode,
    NetworkException,
    RealtimeConfig,
    RealtimeException,
    Robot,
    RobotMode,
)

from plans import follow, standing_joints
from steps import Session, check, column_major, equal, matrix, near, raises, refuses, script, spread

NOWHERE = "127.255.255.254"
STIFF = ([3000, 3000, 3000, 2500, 2500, 2000, 2000], [3000, 3000, 3000, 300, 300, 300])
INSENSITIVE = ([100.0] * 7, [100.0] * 7, [100.0] * 6, [100.0] * 6)
GRAVITY = 9.81


def reads_states_of_every_millisecond(session):
    """Reads every state in a motion; at rest a slow client misses some."""
    at_rest = [session.fresh_state(), *(session.robot.read_once() for _ in range(500))]
    check(min(gaps(at_rest)) > 0, "time runs forwards")
    control = session.robot.start_joint_position_control(ControllerMode.JointImpedance)
    in_motion = follow(control, standing_joints(), 0.5)
    session.state_at_rest()
    near("median gap in a motion", [sorted(gaps(in_motion))[len(in_motion) // 2]], [0.001], 1e-9)
    return f"{len(in_motion)} states over {sum(gaps(in_motion)):.3f} s of robot time"


def gaps(states):
    """Robot time from each state to the next, s."""
    return numpy.diff([state.time.to_sec() for state in states])


def states_of_a_resting_arm_are_consistent(session):
    state = session.state_at_rest()
    equal("mode", state.robot_mode, RobotMode.Idle)
    equal("errors", (str(state.current_errors), str(state.last_motion_errors)), ("[]", "[]"))
    pose = matrix(state.O_T_EE)
    near("rotation", pose[:3, :3] @ pose[:3, :3].T, numpy.eye(3), 1e-6)
    near("last row", pose[3], [0, 0, 0, 1], 0)
    near("F_T_EE = F_T_NE * NE_T_EE", matrix(state.F_T_NE) @ matrix(state.NE_T_EE), matrix(state.F_T_EE), 1e-6)
    near("gravity", state.O_ddP_O, [0, 0, -GRAVITY], 1e-3)
    near("q_d", state.q, state.q_d, 5e-3)
    near("theta", state.theta, state.q, 2e-2)
    near("O_T_EE_d", matrix(state.O_T_EE), matrix(state.O_T_EE_d), 5e-3)
    near("O_T_EE_c", state.O_T_EE_c, state.O_T_EE_d, 1e-6)
    near("elbow", [state.elbow[0], state.elbow[1]], [state.q[2], -1.0], 1e-6)
    near("tau_J_d", state.tau_J_d, numpy.zeros(7), 1e-6)
    near("external torques", state.tau_ext_hat_filtered, numpy.zeros(7), 0.5)
    near("external wrench", state.O_F_ext_hat_K, numpy.zeros(6), 2.0)
    for flags in (state.joint_contact, state.joint_collision, state.cartesian_contact, state.cartesian_collision):
        near("contact", flags, numpy.zeros(len(flags)), 0)
    equal("success rate", state.control_command_success_rate, 0.0)
    return f"mass of the end effector {state.m_ee:.2f} kg"


def echoes_what_is_set(session):
    robot = session.robot
    robot.set_collision_behavior(*INSENSITIVE)
    robot.set_joint_impedance(STIFF[0])
    robot.set_cartesian_impedance(STIFF[1])
    inertia = numpy.diag([0.001, 0.002, 0.003])
    lever = numpy.eye(4)
    lever[:3, 3] = [0.0, 0.0, 0.1]
    before = matrix(session.state_at_rest().O_T_EE)
    # This load does not exist, so that it lifts the arm by some tenths of a millimetre.
    robot.set_load(0.05, [0.01, 0.02, 0.03], column_major(inertia))
    robot.set_EE(column_major(lever))
    robot.set_K(column_major(lever))
    state = session.fresh_state()
    robot.set_load(0.0, [0.0] * 3, [0.0] * 9)
    for reset in (robot.set_EE, robot.set_K):
        reset(column_major(numpy.eye(4)))
    near("m_load", [state.m_load], [0.05], 1e-6)
    near("F_x_Cload", state.F_x_Cload, [0.01, 0.02, 0.03], 1e-6)
    near("I_load", state.I_load, column_major(inertia), 1e-6)
    near("m_total", [state.m_total], [state.m_ee + 0.05], 1e-6)
    near("NE_T_EE", matrix(state.NE_T_EE), lever, 1e-6)
    near("EE_T_K", matrix(state.EE_T_K), lever, 1e-6)
    near("O_T_EE", matrix(state.O_T_EE), before @ lever, 1e-3)
    near("NE_T_EE, set back", matrix(session.fresh_state().NE_T_EE), numpy.eye(4), 1e-6)
    return "and applies it"


def refuses_what_is_out_of_range(session):
    robot = session.robot
    skewed = numpy.eye(4)
    skewed[0, 0] = 2.0
    nothing, negative = [0.0] * 3, column_major(numpy.diag([-1.0, 1.0, 1.0]))
    cases = [
        ("Set Joint Impedance", lambda: robot.set_joint_impedance([-1.0] * 7)),
        ("Set Joint Impedance", lambda: robot.set_joint_impedance([14251.0] * 7)),
        ("Set Cartesian Impedance", lambda: robot.set_cartesian_impedance([9.0] * 3 + [300.0] * 3)),
        ("Set Cartesian Impedance", lambda: robot.set_cartesian_impedance([3000.0] * 3 + [301.0] * 3)),
        ("Set Collision Behavior", lambda: robot.set_collision_behavior([-1.0] * 7, *INSENSITIVE[1:])),
        ("Set NE to EE", lambda: robot.set_EE(column_major(skewed))),
        ("Set EE to K", lambda: robot.set_K(column_major(skewed))),
        ("Set Load", lambda: robot.set_load(-1.0, nothing, [0.0] * 9)),
        ("Set Load", lambda: robot.set_load(1.0, nothing, negative)),
        ("Set Load", lambda: robot.set_load(float("nan"), nothing, [0.0] * 9)),
    ]
    before = session.fresh_state()
    for name, call in cases:
        refuses(CommandException, f"libfranka: {name} command rejected: invalid argument!", call)
    after = session.fresh_state()
    near("NE_T_EE", after.NE_T_EE, before.NE_T_EE, 0)
    near("m_load", after.m_load, before.m_load, 0)
    return f"{len(cases)} refused"


def refuses_parameters_in_a_motion(session):
    robot = session.robot
    control = robot.start_joint_position_control(ControllerMode.JointImpedance)
    cases = [
        ("Set Joint Impedance", lambda: robot.set_joint_impedance(STIFF[0])),
        ("Set Cartesian Impedance", lambda: robot.set_cartesian_impedance(STIFF[1])),
        ("Set Collision Behavior", lambda: robot.set_collision_behavior(*INSENSITIVE)),
        ("Set Load", lambda: robot.set_load(0.0, [0.0] * 3, [0.0] * 9)),
        ("Set EE to K", lambda: robot.set_K(column_major(numpy.eye(4)))),
        ("Set NE to EE", lambda: robot.set_EE(column_major(numpy.eye(4)))),
    ]
    for name, call in cases:
        text = f'libfranka: {name} command rejected: command not possible in the current mode ("Move")!'
        refuses(CommandException, text, call)
    hold(control, 0.01)
    session.state_at_rest()
    return f"{len(cases)} refused"


def joints_give_way_as_their_stiffness_says(session):
    """A load that is declared but not there lifts the arm by the amount that the controller allows."""
    mass, gives = 0.4, {}
    for stiffness in (500.0, 2500.0):
        state = under_a_load(session, mass, ControllerMode.JointImpedance, [stiffness] * 7, STIFF[1])
        jacobian = numpy.array(session.robot.load_model().zero_jacobian(state)).reshape(6, 7, order="F")
        lifted = numpy.array(state.q) - state.q_d
        expected = jacobian[2] * mass * GRAVITY / stiffness
        near(f"joints at {stiffness} Nm/rad", lifted, expected, 0.1 * numpy.max(numpy.abs(expected)))
        near("external force", state.O_F_ext_hat_K[2], -mass * GRAVITY, 0.2)
        gives[stiffness] = numpy.max(numpy.abs(lifted))
    return ", ".join(f"{give * 1e3:.2f} mrad at {stiffness:g} Nm/rad" for stiffness, give in gives.items())


def the_end_effector_gives_way_as_its_stiffness_says(session):
    mass, gives = 0.4, {}
    for stiffness in (400.0, 2000.0):
        state = under_a_load(
            session, mass, ControllerMode.CartesianImpedance, STIFF[0], [stiffness] * 3 + [300.0] * 3
        )
        lifted = (matrix(state.O_T_EE) - matrix(state.O_T_EE_d))[:3, 3]
        expected = mass * GRAVITY / stiffness
        near(f"end effector at {stiffness} N/m", lifted, [0, 0, expected], 0.15 * expected)
        gives[stiffness] = lifted[2]
    return ", ".join(f"{give * 1e3:.2f} mm at {stiffness:g} N/m" for stiffness, give in gives.items())


def under_a_load(session, mass, controller, joint_stiffness, cartesian_stiffness):
    """The last state of a motion that stands still under a load that is declared but not there."""
    robot = session.robot
    robot.set_collision_behavior(*INSENSITIVE)
    robot.set_joint_impedance(joint_stiffness)
    robot.set_cartesian_impedance(cartesian_stiffness)
    robot.set_load(mass, [0.0] * 3, [0.0] * 9)
    try:
        return hold(robot.start_joint_position_control(controller), 0.7)
    finally:
        session.state_at_rest()
        robot.set_load(0.0, [0.0] * 3, [0.0] * 9)
        robot.set_joint_impedance(STIFF[0])
        robot.set_cartesian_impedance(STIFF[1])


def hold(control, duration):
    """Stands still, and returns the last state of the motion."""
    return follow(control, standing_joints(), duration)[-1]


def connects_again(session):
    before = session.state_at_rest()
    session.connect()
    state = session.fresh_state()
    near("q in the new session", state.q, before.q, 5e-3)
    check(state.time.to_sec() > before.time.to_sec(), "the clock goes on")
    return f"{spread(state.q, before.q) * 1e3:.2f} mrad from where it was"


def serves_one_client_at_a_time(session):
    text = raises(NetworkException, lambda: Robot(session.address, RealtimeConfig.kIgnore))
    check(text.startswith("libfranka: "), text)
    before = session.fresh_state().time.to_sec()
    check(session.fresh_state().time.to_sec() > before, "the first goes on")
    return f"the second gets: {text}"


def a_closed_port_refuses(_session):
    text = "libfranka: Connection to FCI refused. Please install FCI feature or enable FCI mode in Desk."
    refuses(NetworkException, text, lambda: Robot(NOWHERE, RealtimeConfig.kIgnore))
    return text


def enforcing_depends_on_this_host(session):
    session.robot = None
    try:
        if is_realtime_kernel() and may_be_realtime():
            equal("mode", Robot(session.address, RealtimeConfig.kEnforce).read_once().robot_mode, RobotMode.Idle)
            equal("mode by default", Robot(session.address).read_once().robot_mode, RobotMode.Idle)
            return "a real-time kernel: connected"
        text = raises(RealtimeException, lambda: Robot(session.address, RealtimeConfig.kEnforce))
        refuses(RealtimeException, text, lambda: Robot(session.address))
        if may_be_realtime():
            equal("text", text, "libfranka: Running kernel does not have realtime capabilities.")
        else:
            check(text.startswith("libfranka: unable to set realtime scheduling: "), text)
        return text
    finally:
        session.connect()


def is_realtime_kernel():
    try:
        return Path("/sys/kernel/realtime").read_text().strip() == "1"
    except OSError:
        return False


def may_be_realtime():
    """True if this thread may have the highest priority; its priority does not change."""
    policy, priority = os.sched_getscheduler(0), os.sched_getparam(0)
    try:
        highest = os.sched_param(os.sched_get_priority_max(os.SCHED_FIFO))
        os.sched_setscheduler(0, os.SCHED_FIFO, highest)
    except OSError:
        return False
    os.sched_setscheduler(0, policy, priority)
    return True


if __name__ == "__main__":
    script(
        [
            reads_states_of_every_millisecond,
            states_of_a_resting_arm_are_consistent,
            echoes_what_is_set,
            refuses_what_is_out_of_range,
            refuses_parameters_in_a_motion,
            joints_give_way_as_their_stiffness_says,
            the_end_effector_gives_way_as_its_stiffness_says,
            connects_again,
            serves_one_client_at_a_time,
            a_closed_port_refuses,
            enforcing_depends_on_this_host,
        ],
        Session,
    )
