"""Shared code of the scripts in this directory: steps that are run and counted, and checks of results.

A step is a function named after its claim, and its return value is printed. Each prints one line, the last line
counts them, and the exit code of a script is 0 only if none failed.

Client and simulator share a machine that may be busy, and no result depends on that. Where the client commands in cycles,
the simulator is in virtual time: the next millisecond begins with the command. Limits of time are in robot time.
"""

import sys
import time
import traceback

import numpy
from pylibfranka import RealtimeConfig, Robot, RobotMode

# Beyond this the arm still moves, rad/s; the robot's own motions and reflexes end within this, s.
REST = 1e-3
REST_TIME_MAX = 3.0


def script(steps, connect):
    """Runs a script and exits. `connect` turns the address from the command line into the argument of the steps."""
    if len(sys.argv) != 2:
        sys.exit(f"usage: {sys.argv[0]} ADDRESS")
    sys.exit(run(steps, connect(sys.argv[1])))


def run(steps, session):
    passed = 0
    begin = time.monotonic()
    for step in steps:
        name = step.__name__.replace("_", " ")
        start = time.monotonic()
        try:
            summary = step(session)
        except Exception as error:  # Any exception of any step is a failure of that step.
            text = " ".join(str(error).split())  # In one line, which is repeated at the end of all scripts.
            print(f"FAIL  {name} ({time.monotonic() - start:.1f} s): {type(error).__name__}: {text}", flush=True)
            traceback.print_exc()
        else:
            passed += 1
            print(f"ok    {name} ({time.monotonic() - start:.1f} s): {summary}", flush=True)
            continue
        # Not in the handler above: objects of the step are freed only once nothing refers to the exception any more.
        session.clear()
    failed = len(steps) - passed
    print(f"{passed} passed, {failed} failed in {time.monotonic() - begin:.1f} s", flush=True)
    return 1 if failed else 0


class Session:
    """A connection to the robot that the steps share."""

    def __init__(self, address):
        self.address = address
        self.connect()
        # Joint positions to which motions are relative.
        self.home = numpy.array(self.fresh_state().q_d)

    def connect(self):
        self.robot = None  # A robot serves one client at a time: let the old one go first.
        self.robot = Robot(self.address, RealtimeConfig.kIgnore)

    def fresh_state(self):
        """Returns a current state: the first read may return an old state that was waiting in the socket."""
        self.robot.read_once()
        return self.robot.read_once()

    def state_at_rest(self):
        """The state once the arm has settled after a motion."""
        start = self.fresh_state().time.to_sec()
        while True:
            state = self.robot.read_once()
            if state.robot_mode == RobotMode.Idle and max(map(abs, state.dq)) < REST:
                return state
            check(state.time.to_sec() < start + REST_TIME_MAX, f"the arm rests: {state.robot_mode}, {state.dq}")

    def recover(self):
        """Clears a reflex and returns the state after it."""
        self.robot.automatic_error_recovery()
        state = self.state_at_rest()
        check(not state.current_errors, f"errors after recovery: {state.current_errors}")
        return state

    def clear(self):
        """Connects again after a failed step and recovers the robot, so that the next step starts from an idle one.

        The client shuts its connection for good when no state has come for a second, as on a machine that stood still.
        Over the same connection every step after that would fail too.
        """
        try:
            self.connect()
            self.robot.automatic_error_recovery()
        except Exception as error:
            print(f"      clearing failed too: {error}", flush=True)


def matrix(values):
    """The matrix of a transform, which the client stores in column-major order."""
    return numpy.array(values).reshape(4, 4, order="F")


def column_major(transform):
    return numpy.asarray(transform).flatten(order="F").tolist()


def check(condition, what):
    if not condition:
        raise AssertionError(what)


def equal(what, got, want):
    check(got == want, f"{what}: {got!r} instead of {want!r}")


def spread(got, want):
    return float(numpy.max(numpy.abs(numpy.asarray(got) - numpy.asarray(want))))


def near(what, got, want, tolerance):
    error = spread(got, want)
    check(error <= tolerance, f"{what}: off by {error:.3e}, allowed {tolerance:g}")


def raises(kind, action):
    """Returns the text of the exception that `action` raises, which has exactly this type, not a subclass."""
    try:
        action()
    except kind as error:
        equal("type of the exception", type(error), kind)
        return str(error).strip()
    raise AssertionError(f"no {kind.__name__}")


def refuses(kind, text, action):
    """Checks that `action` raises an exception of this type and text."""
    equal(f"text of the {kind.__name__}", raises(kind, action), text)
