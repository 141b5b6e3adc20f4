"""One motion with pylibfranka, for a cassette: pylibfranka_cassette.py ADDRESS

Sets an impedance, turns the last joint by a fraction of a degree and back, and prints the position of the joint that was
commanded halfway. Every command follows from the states that the robot sent, so that the same robot gets the same commands.
"""

import math
import sys

from pylibfranka import ControllerMode, JointPositions, RealtimeConfig, Robot

CYCLES = 300
AMPLITUDE = 0.005


def main(address):
    robot = Robot(address, RealtimeConfig.kIgnore)
    robot.set_joint_impedance([2000.0] * 7)
    control = robot.start_joint_position_control(ControllerMode.JointImpedance)
    state, _ = control.readOnce()
    start = list(state.q_d)
    halfway = None
    for cycle in range(CYCLES + 1):
        position = start.copy()
        position[6] += AMPLITUDE * (1.0 - math.cos(2.0 * math.pi * cycle / CYCLES)) / 2.0
        command = JointPositions(position)
        command.motion_finished = cycle == CYCLES
        control.writeOnce(command)
        if cycle == CYCLES // 2:
            halfway = state.q_d[6]
        if cycle < CYCLES:
            state, _ = control.readOnce()
    print(f"halfway {halfway:.9f}", flush=True)


main(sys.argv[1])
