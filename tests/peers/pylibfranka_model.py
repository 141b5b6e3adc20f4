"""The model that pylibfranka computes from the robot's description: pylibfranka_model.py ADDRESS

The binding has mass matrix, Coriolis and gravity torques, and the Jacobian of the end effector. It declares one of a
frame of choice too, which cannot be called: the type of frames is not exported. There is no pose of a frame, and no
body Jacobian. The available quantities have to be consistent with each other in any state, and with the motion of the
simulated arm.
"""

import numpy
from pylibfranka import ControllerMode

from plans import arrive, joint_positions, line
from steps import Session, check, column_major, matrix, near, raises, script, spread

GRAVITY = 9.81
# Within the joints' limits of the Franka Research 3, rad.
MIDDLE = numpy.array([0.0, 0.0, 0.0, -1.6, 0.0, 2.5, 0.0])
RANGE = numpy.array([2.5, 1.5, 2.5, 1.2, 2.5, 1.7, 2.5])
POSES = 20
SEED = 11
# Half of a central difference, rad.
STEP = 1e-5
# Joint friction at rest and in motion, Nm.
FRICTION = 1.5
# The distance of states for finite differences in motion, ms.
HALF_WINDOW = 10
OFFSET = numpy.array([0.3, -0.2, 0.2, 0.3, -0.3, 0.3, 0.4])
DURATION = 1.2


class Arm(Session):
    """A connection with its model."""

    def connect(self):
        super().connect()
        self.model = self.robot.load_model()

    def mass(self, state):
        return numpy.array(self.model.mass(state)).reshape(7, 7, order="F")

    def jacobian(self, state):
        return numpy.array(self.model.zero_jacobian(state)).reshape(6, 7, order="F")

    def coriolis(self, state):
        return numpy.array(self.model.coriolis(state))

    def gravity(self, state):
        return numpy.array(self.model.gravity(state))

    def states_anywhere(self):
        """States of the robot with random joint positions and velocities, together with these two."""
        random = numpy.random.default_rng(SEED)
        for _ in range(POSES):
            q = MIDDLE + RANGE * random.uniform(-1.0, 1.0, 7)
            dq = random.uniform(-1.0, 1.0, 7)
            yield with_joints(self.fresh_state(), q, dq), q, dq


def with_joints(state, q, dq):
    state.q, state.dq = q.tolist(), dq.tolist()
    return state


def the_mass_matrix_is_one(arm):
    least, greatest = numpy.inf, 0.0
    for state, _, _ in arm.states_anywhere():
        mass = arm.mass(state)
        near("symmetry", mass, mass.T, 1e-9)
        eigenvalues = numpy.linalg.eigvalsh(mass)
        least, greatest = min(least, eigenvalues[0]), max(greatest, eigenvalues[-1])
    check(least > 0.0, f"positive definite, least eigenvalue {least}")
    return f"eigenvalues from {least:.1e} to {greatest:.1f} kg m²"


def coriolis_torques_do_no_work_of_their_own(arm):
    """Their power is half the power of the changing mass matrix, and they grow with the square of the velocities."""
    worst = 0.0
    for state, q, dq in arm.states_anywhere():
        torques = arm.coriolis(state)
        near("none at rest", arm.coriolis(with_joints(state, q, 0.0 * dq)), numpy.zeros(7), 1e-9)
        near("at twice the speed", arm.coriolis(with_joints(state, q, 2.0 * dq)), 4.0 * torques, 1e-6)
        after = arm.mass(with_joints(state, q + STEP * dq, dq))
        before = arm.mass(with_joints(state, q - STEP * dq, dq))
        gained = dq @ (after - before) @ dq / (2.0 * STEP)
        worst = max(worst, abs(gained - 2.0 * dq @ torques))
    check(worst < 1e-4, f"power balance is off by {worst:.1e} W")
    return f"power balance off by {worst:.1e} W at most"


def gravity_is_the_slope_of_the_height(arm):
    """A load at the end effector adds its weight to the joints, through the Jacobian, and its mass to the matrix."""
    mass = 0.7
    bare = [(q, arm.gravity(state), arm.mass(state)) for state, q, _ in arm.states_anywhere()]
    tool = matrix(arm.fresh_state().F_T_EE)[:3, 3]
    arm.robot.set_load(mass, tool.tolist(), [0.0] * 9)
    try:
        laden = [(arm.gravity(state), arm.mass(state), arm.jacobian(state)[:3]) for state, _, _ in arm.states_anywhere()]
    finally:
        arm.robot.set_load(0.0, [0.0] * 3, [0.0] * 9)
    for (q, gravity, inertia), (gravity_laden, inertia_laden, jacobian) in zip(bare, laden):
        near(f"torques of the load at {q}", gravity_laden - gravity, mass * GRAVITY * jacobian[2], 1e-4)
        near(f"inertia of the load at {q}", inertia_laden - inertia, mass * jacobian.T @ jacobian, 1e-4)
    return f"in {len(bare)} poses"


def a_longer_tool_has_a_longer_lever(arm):
    """The Jacobian of a point fixed to the end effector follows from the rotational part."""
    state = arm.state_at_rest()
    short = arm.jacobian(state)
    lever = numpy.eye(4)
    lever[:3, 3] = [0.02, -0.03, 0.1]
    arm.robot.set_EE(column_major(lever))
    try:
        state = arm.state_at_rest()
        long = arm.jacobian(state)
    finally:
        arm.robot.set_EE(column_major(numpy.eye(4)))
    offset = matrix(state.O_T_EE)[:3, :3] @ lever[:3, 3]
    # The arm has settled by some microradians between the two states.
    near("turns", long[3:], short[3:], 1e-4)
    near("shifts", long[:3], short[:3] + numpy.cross(short[3:], offset, axis=0), 1e-4)
    return f"lever of {numpy.linalg.norm(offset):.3f} m"


def only_the_end_effector_has_a_jacobian(arm):
    text = raises(TypeError, lambda: arm.model.zero_jacobian(0, arm.fresh_state()))
    check("franka::Frame" in text, text)
    return "frames are not exported"


def the_resting_arm_carries_its_weight(arm):
    residues = []
    for target in (arm.home + OFFSET, arm.home):
        move(arm, target)
        state = arm.state_at_rest()
        gravity = arm.gravity(state)
        near("measured torques", state.tau_J, gravity, FRICTION)
        residues.append(spread(state.tau_J, gravity))
    return f"up to {max(residues):.2f} Nm, of {numpy.max(numpy.abs(gravity)):.1f} Nm"


def the_moving_arm_moves_as_the_model_says(arm):
    """Twists by the Jacobian, and measured torques by the equations of motion."""
    states = move(arm, arm.home + OFFSET)
    states += move(arm, arm.home)
    twist, torque, without = 0.0, 0.0, 0.0
    by_time = {round(state.time.to_sec() * 1e3): state for state in states}
    for ms, state in by_time.items():
        before, after = by_time.get(ms - HALF_WINDOW), by_time.get(ms + HALF_WINDOW)
        if before is None or after is None:
            continue  # A lost state, or one after the motion.
        time = 2e-3 * HALF_WINDOW
        shift = (matrix(after.O_T_EE) - matrix(before.O_T_EE))[:3, 3] / time
        expected = arm.jacobian(state)[:3] @ (numpy.array(after.q) - before.q) / time
        twist = max(twist, spread(shift, expected))
        inertia = arm.mass(state) @ (numpy.array(after.dq) - before.dq) / time
        motion = inertia + arm.coriolis(state)
        torque = max(torque, spread(state.tau_J, motion + arm.gravity(state)))
        without = max(without, numpy.max(numpy.abs(motion)))
    check(0.0 < twist < 2e-3, f"velocity of the end effector is off by {twist:.1e} m/s")
    check(0.0 < torque < FRICTION, f"torques are off by {torque:.2f} Nm")
    check(without > 1.5 * FRICTION, f"the motion takes {without:.2f} Nm, enough to be seen")
    return f"{twist * 1e3:.2f} mm/s and {torque:.2f} Nm off, of {without:.1f} Nm that the motion takes"


def move(arm, target):
    start = numpy.array(arm.state_at_rest().q_d)
    control = arm.robot.start_joint_position_control(ControllerMode.JointImpedance)
    return arrive(control, joint_positions(line(start, target - start, DURATION)), DURATION)


if __name__ == "__main__":
    script(
        [
            the_mass_matrix_is_one,
            coriolis_torques_do_no_work_of_their_own,
            gravity_is_the_slope_of_the_height,
            a_longer_tool_has_a_longer_lever,
            only_the_end_effector_has_a_jacobian,
            the_resting_arm_carries_its_weight,
            the_moving_arm_moves_as_the_model_says,
        ],
        Arm,
    )
