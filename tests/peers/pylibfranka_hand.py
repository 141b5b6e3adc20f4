"""Drives a simulated Franka Hand with pylibfranka: pylibfranka_hand.py ADDRESS

The simulator has an object of 5 cm between the fingers. The client holds the interpreter lock until a movement is over,
and a hand serves one client. So no movement can be interrupted from here, and `stop` only releases a held object. This
client has no vacuum gripper.
"""

import math

from pylibfranka import CommandException, Gripper, NetworkException

from steps import check, equal, near, raises, refuses, script

OBJECT = 0.05
SPEED = 0.1
FORCE = 40.0
FAILED = "libfranka gripper: Command failed!"
REFUSED = "libfranka: Connection to FCI refused. Please install FCI feature or enable FCI mode in Desk."


class Hand:
    """The connection that the steps share."""

    def __init__(self, address):
        self.address = address
        self.connect()

    def connect(self):
        self.gripper = None  # A hand serves one client at a time.
        self.gripper = Gripper(self.address)

    def clear(self):
        """Connects again after a failed step, as `Session.clear` does, and stops the hand."""
        try:
            self.connect()
            self.gripper.stop()
        except Exception as error:
            print(f"      clearing failed too: {error}", flush=True)

    def width(self):
        return self.gripper.read_once().width

    def time(self):
        return self.gripper.read_once().time.to_sec()


def speaks_version_3(hand):
    equal("version", hand.gripper.server_version(), 3)
    return "3"


def sends_states(hand):
    states = [hand.gripper.read_once() for _ in range(10)]
    times = [state.time.to_sec() for state in states]
    check(all(before < after for before, after in zip(times, times[1:])), f"time runs forwards: {times}")
    equal("temperature", states[-1].temperature, 25)
    equal("nothing held", states[-1].is_grasped, False)
    return f"{len(states)} over {times[-1] - times[0]:.2f} s"


def refuses_widths_before_homing(hand):
    near("max_width", hand.gripper.read_once().max_width, 0.0, 0.0)
    refuses(CommandException, FAILED, lambda: hand.gripper.move(OBJECT, SPEED))
    return FAILED


def finds_its_width(hand):
    equal("homing", hand.gripper.homing(), True)
    state = hand.gripper.read_once()
    near("max_width", state.max_width, 0.08, 1e-9)
    near("width", state.width, 0.08, 1e-6)
    return f"{state.max_width} m"


def moves_at_the_speed_commanded(hand):
    start = hand.time()
    equal("move", hand.gripper.move(0.06, 0.04), True)
    took = hand.time() - start
    # 2 cm at 4 cm/s; a client that is slow to ask sees a later time.
    check(took > 0.45, f"{took:.2f} s")
    near("width", hand.width(), 0.06, 1e-6)
    equal("opening", hand.gripper.move(0.08, SPEED), True)
    near("width", hand.width(), 0.08, 1e-6)
    return f"2 cm in {took:.2f} s"


def refuses_what_it_cannot_do(hand):
    before = hand.width()
    cases = [(0.081, SPEED), (-0.001, SPEED), (0.06, -SPEED), (0.06, 0.0), (math.nan, SPEED), (0.06, math.nan)]
    for width, speed in cases:
        refuses(CommandException, FAILED, lambda: hand.gripper.move(width, speed))
    refuses(CommandException, FAILED, lambda: hand.gripper.grasp(0.081, SPEED, FORCE))
    raises(TypeError, lambda: hand.gripper.move("wide", SPEED))
    near("width", hand.width(), before, 1e-9)
    return f"{len(cases) + 1} refused"


def grasps_the_object(hand):
    equal("grasp", hand.gripper.grasp(OBJECT, SPEED, FORCE), True)
    state = hand.gripper.read_once()
    near("width", state.width, OBJECT, 1e-6)
    equal("is_grasped", state.is_grasped, True)
    # A held object cannot be grasped again.
    equal("a second grasp", hand.gripper.grasp(OBJECT, SPEED, FORCE), False)
    return f"{state.width} m"


def lets_go_of_it(hand):
    equal("stop", hand.gripper.stop(), True)
    equal("is_grasped", hand.gripper.read_once().is_grasped, False)
    near("width", hand.width(), OBJECT, 1e-6)
    equal("stop without a movement", hand.gripper.stop(), True)
    return "and stays where it is"


def finds_nothing_of_another_width(hand):
    """The grasp holds any object, and reports whether its width is within the tolerance."""
    inner, outer = {"epsilon_inner": 0.03, "epsilon_outer": 0.0}, {"epsilon_inner": 0.0, "epsilon_outer": 0.03}
    cases = [
        (OBJECT - 0.02, {}, False),
        (OBJECT - 0.02, inner, False),
        (OBJECT - 0.02, outer, True),
        (OBJECT + 0.02, {}, False),
        (OBJECT + 0.02, outer, False),
        (OBJECT + 0.02, inner, True),
        (OBJECT - 0.004, {}, True),
        (OBJECT - 0.006, {}, False),
    ]
    for width, tolerances, found in cases:
        equal("opening", hand.gripper.move(0.08, SPEED), True)
        what = f"{width:.3f} m, {tolerances}"
        equal(f"grasp of {what}", hand.gripper.grasp(width, SPEED, FORCE, **tolerances), found)
        equal(f"is_grasped of {what}", hand.gripper.read_once().is_grasped, found)
        near(f"width of {what}", hand.width(), OBJECT, 1e-6)
    equal("opening", hand.gripper.move(0.08, SPEED), True)
    return f"{len(cases)} grasps"


def serves_one_client_at_a_time(hand):
    text = raises(NetworkException, lambda: Gripper(hand.address))
    check(text.startswith("libfranka: "), text)
    sends_states(hand)
    return f"the second gets: {text}"


def connects_again(hand):
    before = hand.width()
    hand.connect()
    state = hand.gripper.read_once()
    near("width", state.width, before, 1e-9)
    near("max_width, without homing again", state.max_width, 0.08, 1e-9)
    return f"at {state.width:.3f} m"


def a_closed_port_refuses(_hand):
    refuses(NetworkException, REFUSED, lambda: Gripper("127.255.255.254"))
    return REFUSED


if __name__ == "__main__":
    script(
        [
            speaks_version_3,
            sends_states,
            refuses_widths_before_homing,
            finds_its_width,
            moves_at_the_speed_commanded,
            refuses_what_it_cannot_do,
            grasps_the_object,
            lets_go_of_it,
            finds_nothing_of_another_width,
            serves_one_client_at_a_time,
            connects_again,
            a_closed_port_refuses,
        ],
        Hand,
    )
