"""Commands no torques with pylibfranka, the vendor's own client, to be measured: pylibfranka_torques.py ADDRESS SECONDS"""

import sys

from pylibfranka import RealtimeConfig, Robot, Torques


def main(address, seconds):
    robot = Robot(address, RealtimeConfig.kIgnore)
    control = robot.start_torque_control()
    command = Torques([0.0] * 7)
    passed = 0.0
    while passed < seconds:
        _, step = control.readOnce()
        passed += step.to_sec()
        command.motion_finished = passed >= seconds
        control.writeOnce(command)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(sys.argv[1], float(sys.argv[2]))
