"""Torque control with pylibfranka: pylibfranka_torque_control.py ADDRESS

The client commands torques, and the robot adds the gravity compensation.
"""

import math

import numpy
from pylibfranka import Torques

from plans import CYCLE, ease, follow, success_rate
from steps import Session, check, near, script, spread

STIFFNESS = numpy.array([100.0, 100.0, 100.0, 100.0, 50.0, 40.0, 30.0])
DAMPING = numpy.sqrt(STIFFNESS)
NOTHING = Torques([0.0] * 7)


def nothing_commanded_holds_the_arm(session):
    before = session.state_at_rest()
    states = follow(session.robot.start_torque_control(), lambda t, state: NOTHING, 0.5)
    after = session.state_at_rest()
    near("tau_J_d", [state.tau_J_d for state in states], 0.0, 0.0)
    near("q", after.q, before.q, 1e-3)
    return f"{spread(after.q, before.q) * 1e3:.3f} mrad in half a second"


def torques_show_in_the_state(session):
    sent = []

    def command(t, state):
        wave = math.sin(2.0 * math.pi * min(t / 0.5, 1.0))
        torques = [0.0, 0.0, 0.0, 0.0, 0.3 * wave, -0.3 * wave, 0.2 * wave]
        sent.append(torques)
        return Torques(torques)

    states = follow(session.robot.start_torque_control(), command, 0.6)
    session.state_at_rest()
    # In single precision. If a command is late, the previous torques stay, which are zero at first.
    last = 0
    for state in states[1:]:
        echoes = [n for n in range(last, len(sent)) if spread(state.tau_J_d, sent[n]) < 1e-6]
        check(echoes or last == 0 and not any(state.tau_J_d), f"{state.tau_J_d} have been commanded")
        last = echoes[0] if echoes else 0
    strongest = max(state.tau_J_d[4] for state in states)
    near("strongest", strongest, 0.3, 0.02)
    return f"{len(set(tuple(state.tau_J_d) for state in states))} different ones"


def an_impedance_leads_a_joint_out_and_back(session):
    start = numpy.array(session.state_at_rest().q)
    duration, swing = 2.0, 0.1
    reached = []

    def command(t, state):
        # Joint 1 swings out and back, which proves that the torques have an effect.
        goal = start.copy()
        goal[0] += swing * 0.5 * (1.0 - math.cos(2.0 * math.pi * min(t / duration, 1.0)))
        reached.append(state.q[0] - start[0])
        torques = STIFFNESS * (goal - numpy.array(state.q)) - DAMPING * numpy.array(state.dq)
        # Begins and ends at zero, as the robot requires.
        fade = ease(min(t, duration - t) / 0.2)[0]
        return Torques((fade * torques).tolist())

    states = follow(session.robot.start_torque_control(), command, duration)
    after = session.state_at_rest()
    check(max(reached) > 0.3 * swing, f"joint 1 swung by {max(reached):.4f} rad only")
    near("q after the swing", after.q, start, 5e-2)
    near("tau_J_d afterwards", after.tau_J_d, numpy.zeros(7), 1e-6)
    return f"joint 1 swung {max(reached):.3f} of {swing} rad, success rate {success_rate(states):.2f}"


def an_arm_that_is_led_desires_to_be_where_it_is(session):
    def command(t, state):
        return Torques([0.0] * 6 + [0.6 * math.sin(2.0 * math.pi * min(t / 0.3, 1.0))])

    states = follow(session.robot.start_torque_control(), command, 0.5)
    after = session.state_at_rest()
    travel = max(state.q[6] for state in states) - states[0].q[6]
    check(travel > 1e-2, f"joint 7 moved by {travel:.4f} rad only")
    # The state belongs to the end of a millisecond, the setpoint may belong to its beginning.
    fastest = max(max(map(abs, state.dq)) for state in states)
    near("q_d on the way", [state.q_d for state in states[1:]], [state.q for state in states[1:]], 2 * CYCLE * fastest)
    near("q_d afterwards", after.q_d, after.q, 5e-3)
    return f"joint 7 moved by {travel:.3f} rad"


if __name__ == "__main__":
    script(
        [
            nothing_commanded_holds_the_arm,
            torques_show_in_the_state,
            an_impedance_leads_a_joint_out_and_back,
            an_arm_that_is_led_desires_to_be_where_it_is,
        ],
        Session,
    )
