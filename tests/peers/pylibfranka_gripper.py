"""Drives a simulated Franka Hand with pylibfranka, the vendor's own client: pylibfranka_gripper.py ADDRESS

The simulator has an object of 5 cm between the fingers. Each step prints one line; the last line counts them, and the
exit code is 0 only if none failed.
"""

import sys
import time
import traceback

from pylibfranka import CommandException, Gripper

OBJECT = 0.05
SPEED = 0.1
FORCE = 40.0
FAILED = "libfranka gripper: Command failed!"


def main(address):
    gripper = Gripper(address)
    steps = [
        speaks_version_3,
        refuses_widths_before_homing,
        finds_its_width,
        moves,
        fails_beyond_its_width,
        grasps_the_object,
        lets_go_of_it,
        finds_nothing_of_another_width,
        sends_states,
    ]
    passed = 0
    for step in steps:
        name = step.__name__.replace("_", " ")
        start = time.monotonic()
        try:
            step(gripper)
        except Exception:
            traceback.print_exc()
            print(f"FAILED  {name}")
        else:
            passed += 1
            print(f"passed  {name} ({time.monotonic() - start:.1f} s)")
    print(f"{passed} of {len(steps)} steps passed")
    return 0 if passed == len(steps) else 1


def speaks_version_3(gripper):
    equal(gripper.server_version(), 3)


def refuses_widths_before_homing(gripper):
    equal(gripper.read_once().max_width, 0.0)
    fails(lambda: gripper.move(OBJECT, SPEED))


def finds_its_width(gripper):
    equal(gripper.homing(), True)
    equal(gripper.read_once().max_width, 0.08)


def moves(gripper):
    start = time.monotonic()
    equal(gripper.move(0.06, 0.04), True)
    took = time.monotonic() - start
    # 2 cm at 4 cm/s; a busy machine takes longer.
    assert took > 0.45, took
    equal(gripper.read_once().width, 0.06)


def fails_beyond_its_width(gripper):
    fails(lambda: gripper.move(0.081, SPEED))
    fails(lambda: gripper.move(0.06, -SPEED))


def grasps_the_object(gripper):
    equal(gripper.grasp(OBJECT, SPEED, FORCE), True)
    state = gripper.read_once()
    equal(state.width, OBJECT)
    equal(state.is_grasped, True)
    # What is held cannot be grasped again.
    equal(gripper.grasp(OBJECT, SPEED, FORCE), False)


def lets_go_of_it(gripper):
    equal(gripper.stop(), True)
    equal(gripper.read_once().is_grasped, False)


def finds_nothing_of_another_width(gripper):
    equal(gripper.grasp(OBJECT - 0.02, SPEED, FORCE), False)
    equal(gripper.grasp(OBJECT - 0.02, SPEED, FORCE, epsilon_outer=0.03), True)
    equal(gripper.move(0.08, SPEED), True)


def sends_states(gripper):
    first, second = gripper.read_once(), gripper.read_once()
    assert second.time.to_sec() > first.time.to_sec()
    equal(second.temperature, 25)


def fails(call):
    try:
        call()
    except CommandException as error:
        equal(str(error), FAILED)
    else:
        raise AssertionError("no failure")


def equal(got, expected):
    close = isinstance(expected, float) and abs(got - expected) < 1e-9
    if not close and got != expected:
        raise AssertionError(f"{got} instead of {expected}")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
