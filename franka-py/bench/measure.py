"""Measures a package in one case, against a simulated robot: `ADAPTER.py CASE ROBOT HAND` runs an adapter's `main()`.

`ROBOT` is the host that a client connects to, a relay that notes what passes. `HAND` is the host of the simulator, whose
gripper has no relay. Each line of output is a JSON object. All have `step`, the subject of the measurement, and also

- `values`: numbers, whose names end in their unit;
- `window`: when something ran, `[begin, end]` in seconds since the epoch, for which the relay is asked;
- `absent`: why the package does not have it;
- `failed`: why it did not work.

Helper threads start before the package connects: some packages raise the thread that connects to real-time priority,
which later threads would inherit. Output that a package prints goes to the other output.
"""

import abc
import asyncio
import contextlib
import ctypes
import json
import os
import statistics
import sys
import threading
import time
import traceback

import numpy


class Absent(Exception):
    """The package does not have the requested item; the text is the reason in a few words."""


class Package(abc.ABC):
    """A package under measurement. A method that is not overridden is absent, for the reason that `absent` has under its name.

    `async with package.connected():` is around all but the methods of the hand.
    """

    absent: dict[str, str] = {}

    def __init__(self, robot, hand):
        self.robot_host, self.hand_host = robot, hand

    def missing(self, name):
        return Absent(self.absent[name])

    async def homing(self):
        """Opens and closes the fingers."""
        raise self.missing("hand")

    async def fingers(self, width):
        """Moves the fingers, at 0.05 m/s."""
        raise self.missing("hand")

    @abc.abstractmethod
    def connected(self):
        """The connection to the robot, an asynchronous context."""

    async def read(self, seconds):
        """Reads one state after the other, as `state` does where it waits for the next one."""
        end = time.perf_counter() + seconds
        while time.perf_counter() < end:
            self.state()

    @abc.abstractmethod
    async def motion(self):
        """Turns joint 7 by `TURN`, in about two seconds."""

    @abc.abstractmethod
    def hold(self):
        """Control of the arm at its present position, an asynchronous context."""

    @abc.abstractmethod
    def state(self):
        """Returns a state."""

    def pose(self, q):
        """Returns the pose of the end effector at joint positions."""
        raise self.missing("pose")

    def inverse(self, poses):
        """Computes joint positions for each of many poses. Returns the number of poses that were solved."""
        raise self.missing("inverse")

    async def active(self, seconds):
        """Answers states from Python with zero torques."""
        raise self.missing("active")

    async def law(self, seconds):
        """Controls by a compiled function that returns zero torques."""
        raise self.missing("law")


class Ticker(threading.Thread):
    """A thread that sleeps a millisecond at a time and notes when it wakes up.

    It has real-time priority where the system grants it. Other programs then delay it less, so that the interpreter remains as
    the cause.
    """

    def __init__(self):
        super().__init__(daemon=True)
        self.times = []
        self.start()

    def run(self):
        with contextlib.suppress(PermissionError):
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
        while True:
            time.sleep(0.001)
            self.times.append(time.perf_counter())

    @contextlib.asynccontextmanager
    async def watch(self, step):
        """Reports the wake-ups while the block runs."""
        begin = time.perf_counter()
        yield
        end = time.perf_counter()
        ticks = [tick for tick in self.times if begin < tick < end]
        # Both ends count, so that a thread that never woke up has one gap of the whole time.
        gaps = numpy.diff([begin, *ticks, end]) * 1e3
        report(
            step,
            values={
                "seconds": end - begin,
                "ticks": len(ticks),
                "ticks_per_s": len(ticks) / (end - begin),
                "gap_p99_ms": float(numpy.percentile(gaps, 99)),
                "gap_max_ms": float(gaps.max()),
            },
        )


class OnDemand(threading.Thread):
    """A thread that waits until it is asked to run a function, once."""

    def __init__(self, function):
        super().__init__(daemon=True)
        self.function = function
        self.asked, self.over = threading.Event(), threading.Event()
        self.start()

    def run(self):
        self.asked.wait()
        self.function()
        self.over.set()


def hold_interpreter():
    """Sleeps for `BLOCKED` without letting another thread of Python run."""
    ctypes.PyDLL(None).usleep(int(BLOCKED * 1e6))


def compute():
    """Computes in Python for a second."""
    end, total = time.perf_counter() + COMPUTING, 0
    while time.perf_counter() < end:
        total += sum(number * number for number in range(1000))


def report(step, **content):
    print(json.dumps({"step": step} | content), file=REPORT, flush=True)


@contextlib.asynccontextmanager
async def attempt(step):
    """Reports an exception of the block, and continues after it."""
    try:
        yield
    except Absent as reason:
        report(step, absent=str(reason))
    except Exception as error:
        traceback.print_exc()
        report(step, failed=" ".join(f"{type(error).__name__}: {error}".split())[:300])


@contextlib.asynccontextmanager
async def window(step):
    """Reports when the block ran."""
    begin = time.time()
    try:
        yield
    finally:
        report(step, window=[begin, time.time()])


async def hand(package):
    ticker = Ticker()
    async with ticker.watch("idle"):
        await asyncio.sleep(0.5)
    async with attempt("homing"), ticker.watch("homing"):
        await package.homing()
    async with attempt("fingers"), ticker.watch("fingers"):
        await package.fingers(0.02)
        await package.fingers(0.07)


async def robot(package):
    ticker = Ticker()
    async with package.connected():
        async with attempt("reading"), ticker.watch("reading"):
            await package.read(1.0)
        await calls(package)
        async with attempt("motion"), ticker.watch("motion"):
            await package.motion()
        async with attempt("state_held"), package.hold():
            await asyncio.sleep(0.2)
            report("state_held", values=timed(package.state, 300))


async def calls(package):
    async with attempt("state"):
        report("state", values=timed(package.state, 300))
    async with attempt("pose"):
        report("pose", values=timed(lambda: package.pose(READY), 2000))
    async with attempt("inverse"):
        if "inverse" in package.absent:
            raise package.missing("inverse")
        generator = numpy.random.default_rng(1)
        joints = READY + generator.uniform(-0.3, 0.3, (1000, 7))
        poses = numpy.array([package.pose(q) for q in joints])
        found = package.inverse(poses)
        if found < 990:
            raise RuntimeError(f"{found} of 1000 were found")
        report("inverse", values=timed(lambda: package.inverse(poses), 5) | {"found": found})


def timed(function, times):
    """Returns the median of the durations of a call."""
    durations = []
    for _ in range(times):
        begin = time.perf_counter()
        function()
        durations.append(time.perf_counter() - begin)
    return {"p50_us": statistics.median(durations) * 1e6}


async def active(package):
    await controlled(package, "active", package.active)


async def law(package):
    await controlled(package, "law", package.law)


async def controlled(package, step, control):
    async with attempt(step), package.connected():
        begin = time.time()
        await control(3.0)
        # Less the time in which control begins and ends, which may include a compiler's.
        end = time.time() - 0.2
        report(step, window=[max(begin, end - 2.5), end])


async def event_loop(package):
    await disturbed(package, "event_loop", lambda: time.sleep(BLOCKED))


async def interpreter(package):
    holder = OnDemand(hold_interpreter)

    def disturb():
        holder.asked.set()
        holder.over.wait()

    await disturbed(package, "interpreter", disturb)


async def threads(package):
    computing = [OnDemand(compute) for _ in range(4)]

    async def disturb():
        for thread in computing:
            thread.asked.set()
        await asyncio.sleep(COMPUTING)

    await disturbed(package, "threads", disturb)


async def disturbed(package, step, disturb):
    """Notes an undisturbed second of control, and then a second that begins with the disturbance."""
    async with attempt(step), package.connected(), package.hold():
        await asyncio.sleep(0.3)
        async with window(f"{step}_before"):
            await asyncio.sleep(1.0)
        async with window(step):
            begin = time.time()
            disturbance = disturb()
            if disturbance is not None:
                await disturbance
            await asyncio.sleep(max(0.0, begin + 1.0 - time.time()))


CASES = {function.__name__: function for function in (hand, robot, active, law, event_loop, interpreter, threads)}


def main(package):
    """Runs the case that the command line names."""
    _, case, *hosts = sys.argv
    asyncio.run(CASES[case](package(*hosts)))


REPORT = os.fdopen(os.dup(sys.stdout.fileno()), "w")
os.dup2(sys.stderr.fileno(), sys.stdout.fileno())

BLOCKED = 0.3
COMPUTING = 1.0
TURN = 0.4
READY = numpy.array([0.0, -numpy.pi / 4, 0.0, -3 * numpy.pi / 4, 0.0, numpy.pi / 2, numpy.pi / 4])
