"""pylibfranka 0.21 before a robot of protocol 5, which it does not speak: pylibfranka_versions.py ADDRESS

The client announces protocol 10, as the Franka Research 3 has, and reports any other one as an error.
"""

from pylibfranka import FrankaException, Gripper, RealtimeConfig, Robot

from steps import check, equal, raises, script

SERVER, LIBRARY = 5, 10


class Address:
    """A session without a connection."""

    def __init__(self, address):
        self.address = address

    def clear(self):
        pass


def refuses_a_robot_of_another_protocol(robot):
    # Twice, since a refused client must not keep the robot occupied.
    for _ in range(2):
        text = raises(FrankaException, lambda: Robot(robot.address, RealtimeConfig.kIgnore))
        versions = f"(server version: {SERVER}, library version: {LIBRARY})"
        check(text.startswith(f"libfranka: Incompatible library version {versions}."), text)
    return text[: text.index(")") + 1]


def speaks_to_its_hand(robot):
    equal("version of the hand", Gripper(robot.address).server_version(), 3)
    return "which is the same for both robots"


if __name__ == "__main__":
    script([refuses_a_robot_of_another_protocol, speaks_to_its_hand], Address)
