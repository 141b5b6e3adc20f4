"""The modes on the wire while pylibfranka controls the arm: pylibfranka_modes.py ADDRESS

The client waits for the modes when it starts and ends a motion, and does not show them. A relay between client and
robot records them: for each kind of motion, the states have to show the requested modes, from idle to idle.
"""

from pylibfranka import (
    AsyncPositionControlHandler,
    CartesianVelocities,
    ControlException,
    ControllerMode,
    JointVelocities,
    Torques,
)

from plans import follow, standing_joints, standing_pose
from steps import Session, equal, refuses, script
from tap import Tap

# Robot modes, and the modes of generators and controllers in a state.
IDLE, MOVE, REFLEX, RECOVERY = 1, 2, 4, 6
NO_GENERATOR, JOINT_POSITION, JOINT_VELOCITY, CARTESIAN_POSITION, CARTESIAN_VELOCITY, NONE = range(6)
JOINT_IMPEDANCE, CARTESIAN_IMPEDANCE, EXTERNAL, OTHER = range(4)
AT_REST = (IDLE, NO_GENERATOR, OTHER)
CONTROLLERS = [
    (ControllerMode.JointImpedance, JOINT_IMPEDANCE),
    (ControllerMode.CartesianImpedance, CARTESIAN_IMPEDANCE),
]
DURATION = 0.1


class Tapped(Session):
    """A connection by way of a relay, at an address next to the robot's address."""

    def __init__(self, address):
        network, subnet, *host = address.split(".")
        here = ".".join([network, str(int(subnet) + 1), *host])
        # Before the client, which gives its thread, and threads started by it, the highest priority.
        self.tap = Tap(address, here)
        super().__init__(here)


def joint_positions_show(session):
    starter = session.robot.start_joint_position_control
    return shows(session, starter, standing_joints, JOINT_POSITION)


def joint_velocities_show(session):
    starter = session.robot.start_joint_velocity_control
    return shows(session, starter, lambda: lambda t, state: JointVelocities([0.0] * 7), JOINT_VELOCITY)


def cartesian_poses_show(session):
    starter = session.robot.start_cartesian_pose_control
    return shows(session, starter, standing_pose, CARTESIAN_POSITION)


def cartesian_velocities_show(session):
    starter = session.robot.start_cartesian_velocity_control
    return shows(session, starter, lambda: lambda t, state: CartesianVelocities([0.0] * 6), CARTESIAN_VELOCITY)


def torques_show(session):
    def move():
        follow(session.robot.start_torque_control(), lambda t, state: Torques([0.0] * 7), DURATION)

    return sequence(session, move, NONE, EXTERNAL)


def asynchronous_joint_positions_show(session):
    def move():
        configuration = AsyncPositionControlHandler.Configuration([0.5] * 7, 1e-3)
        handler = AsyncPositionControlHandler.configure(session.robot, configuration).handler
        handler.set_joint_position_target(AsyncPositionControlHandler.JointPositionTarget(session.home))
        for _ in range(100):
            session.robot.read_once()
        handler.stop_control()

    return sequence(session, move, JOINT_POSITION, JOINT_IMPEDANCE)


def a_stop_shows(session):
    def move():
        control = session.robot.start_joint_velocity_control(ControllerMode.JointImpedance)
        follow(control, lambda t, state: JointVelocities([0.0] * 7), DURATION, finish=False)
        session.robot.stop()

    return sequence(session, move, JOINT_VELOCITY, JOINT_IMPEDANCE)


def a_reflex_and_its_recovery_show(session):
    def move():
        control = session.robot.start_joint_velocity_control(ControllerMode.CartesianImpedance)
        text = (
            "libfranka: Move command aborted: motion aborted by reflex! "
            '["joint_motion_generator_acceleration_discontinuity"]'
        )
        fast = lambda t, state: JointVelocities([0.0] * 6 + [0.5])
        refuses(ControlException, text, lambda: follow(control, fast, DURATION))
        del control
        session.recover()

    after = [(REFLEX, NO_GENERATOR, OTHER), (RECOVERY, NO_GENERATOR, OTHER)]
    return sequence(session, move, JOINT_VELOCITY, CARTESIAN_IMPEDANCE, after, optional=after[1:])


def shows(session, starter, standing, generator):
    """Runs both controllers, one after the other; `standing` makes commands that do not move the arm."""
    summaries = []
    for controller, number in CONTROLLERS:

        def move():
            follow(starter(controller), standing(), DURATION)

        summaries.append(sequence(session, move, generator, number))
    return "; ".join(summaries)


def sequence(session, move, generator, controller, after=(), optional=()):
    """Checks what `move` requests and shows; `optional` modes may be over before a state shows them."""
    session.state_at_rest()
    session.tap.seen()
    move()
    session.state_at_rest()
    modes, motions = session.tap.seen()
    # In a request, generators are numbered from the first one; in a state, 0 means none.
    equal("motions requested", motions, [(controller, generator - 1)])
    modes = [mode for mode in modes if mode not in optional]
    want = [AT_REST, (MOVE, generator, controller), *after, AT_REST]
    equal("modes of robot, generator and controller", modes, [mode for mode in want if mode not in optional])
    return f"generator {generator}, controller {controller}"


if __name__ == "__main__":
    script(
        [
            joint_positions_show,
            joint_velocities_show,
            cartesian_poses_show,
            cartesian_velocities_show,
            torques_show,
            asynchronous_joint_positions_show,
            a_stop_shows,
            a_reflex_and_its_recovery_show,
        ],
        Tapped,
    )
