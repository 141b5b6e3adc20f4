"""Begins, cancels, drops and interrupts motions in random order: `churn.py [--motions N] [--seed S]`.

The simulator is in the process, in virtual time. Prints what became of the motions, and the memory of the process
after the first tenth and at the end. It works in a child process, which ends with a motion under way: how that exits is
printed, too. A thousand motions that take more than `DEADLOCK` seconds print the threads and count as a deadlock. Exits
with 1 if anything failed.
"""

import argparse
import asyncio
import collections
import contextlib
import faulthandler
import gc
import os
import random
import resource
import subprocess
import sys
import threading
import time
import warnings

import franka_async


class Churn:
    """The robot, and the outcomes of its motions."""

    def __init__(self, robot, seed):
        self.robot, self.random = robot, random.Random(seed)
        self.home = robot.state().q
        self.outcomes = collections.Counter()

    def motion(self):
        """Returns a motion of one of the kinds, never far from home."""
        q = [joint + self.random.uniform(-0.05, 0.05) for joint in self.home]
        kind = self.random.randrange(3)
        if kind == 0:
            return self.robot.move_joints(q)
        if kind == 1:
            return self.robot.move_by([self.random.uniform(-0.01, 0.01) for _ in range(3)])
        return self.robot.move_to(self.robot.pose_at(q))

    async def one(self):
        """Runs one motion in one of the ways."""
        ways = [self.drop, self.cancel, self.time_out, self.close, self.wait, self.crowd, self.supersede, self.abandon]
        way = self.random.choice(ways) if self.random.random() > 0.01 else self.arrive
        try:
            outcome = await way()
        except franka_async.MotionError as error:
            outcome = error.kind
        self.outcomes[f"{way.__name__}: {outcome}"] += 1

    async def drop(self):
        self.motion()
        return "not begun"

    async def cancel(self):
        task = asyncio.ensure_future(self.motion())
        await self.pause()
        task.cancel()
        return await ended(task)

    async def abandon(self):
        """Cancels a task and releases it at once."""
        task = asyncio.ensure_future(self.motion())
        await self.pause()
        task.cancel()
        return "abandoned"

    async def time_out(self):
        try:
            await asyncio.wait_for(self.motion(), self.random.uniform(0.0, 0.003))
        except asyncio.TimeoutError:
            return "timeout"
        return "arrived"

    async def close(self):
        motion = self.motion()
        try:
            motion.send(None)
        except StopIteration:
            return "arrived"
        motion.close()
        return "closed"

    async def wait(self):
        """Waits on a separate thread, not for long."""
        return await asyncio.to_thread(blocking, self.motion(), self.random.uniform(0.0, 0.003))

    async def crowd(self):
        """Three threads that wait, each for a motion that supersedes another's."""
        motions = [self.motion() for _ in range(3)]
        timeouts = [self.random.uniform(0.0, 0.003) for _ in motions]
        outcomes = await asyncio.gather(*map(asyncio.to_thread, [blocking] * 3, motions, timeouts))
        return ", ".join(sorted(outcomes))

    async def supersede(self):
        first = asyncio.ensure_future(self.motion())
        await self.pause()
        second = asyncio.ensure_future(self.motion())
        await self.pause()
        second.cancel()
        return f"{await ended(first)}, {await ended(second)}"

    async def arrive(self):
        await self.motion()
        return "arrived"

    async def pause(self):
        """Lets the event loop run for some rounds, or sleeps a little."""
        for _ in range(self.random.randrange(4)):
            await asyncio.sleep(0)
        if self.random.random() < 0.3:
            await asyncio.sleep(self.random.uniform(0.0, 0.002))


def blocking(motion, timeout):
    try:
        motion.wait(timeout=timeout)
    except TimeoutError:
        return "timeout"
    except franka_async.MotionError as error:
        return error.kind
    return "arrived"


async def ended(task):
    try:
        await task
    except asyncio.CancelledError:
        return "cancelled"
    except franka_async.MotionError as error:
        return error.kind
    return "arrived"


def fork(robot):
    """Forks: in the child the robot is refused, and the interpreter exits. Returns the child's exit code."""
    child = os.fork()
    if child == 0:
        try:
            robot.state()
        except RuntimeError:
            os._exit(0)
        os._exit(1)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def memory():
    """Returns the resident memory of the process, MB, after unreferenced objects are freed."""
    gc.collect()
    with open("/proc/self/statm") as statm:
        return int(statm.read().split()[1]) * resource.getpagesize() / 1e6


async def churn(robot, motions, seed):
    churn = Churn(robot, seed)
    begun = time.monotonic()
    for number in range(motions):
        if number % 1000 == 0:
            faulthandler.dump_traceback_later(DEADLOCK, exit=True)
            if fork(robot) != 0:
                sys.exit("a forked child was not refused")
        if number == motions // 10:
            print(f"memory after {number} motions: {memory():.1f} MB", flush=True)
        await churn.one()
    faulthandler.dump_traceback_later(DEADLOCK, exit=True)
    await robot.stop()
    print(f"memory after {motions} motions: {memory():.1f} MB, in {time.monotonic() - begun:.0f} s")
    print(f"threads: {threading.active_count()} of Python, {len(os.listdir('/proc/self/task'))} in all")
    for outcome, count in sorted(churn.outcomes.items()):
        print(f"{count:8} {outcome}")


def work(motions, seed):
    """The child process: returns with a motion under way, on a thread that the interpreter does not wait for."""
    # Of motions that are dropped before they begin.
    warnings.simplefilter("ignore", RuntimeWarning)
    sim = franka_async.Sim.fr3(virtual_time=True)
    robot = franka_async.Robot(sim.address, realtime="ignore").connect().wait()
    asyncio.run(churn(robot, motions, seed))
    last = robot.move_joints(robot.state().q + 0.5)
    threading.Thread(target=stopped, args=(last,), daemon=True).start()
    while robot.state().robot_mode != "move":
        time.sleep(0.0001)
    print(f"the interpreter exits while the robot is in mode {robot.state().robot_mode}", flush=True)


def stopped(motion):
    """Waits until the exit has stopped the motion."""
    with contextlib.suppress(franka_async.MotionError):
        motion.wait()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--motions", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=random.randrange(2**32))
    parser.add_argument("--child", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.child:
        work(arguments.motions, arguments.seed)
        return
    print(f"{arguments.motions} motions, seed {arguments.seed}", flush=True)
    command = [sys.executable, __file__, "--child", f"--motions={arguments.motions}", f"--seed={arguments.seed}"]
    ended = subprocess.run(command, check=False, stderr=subprocess.PIPE, text=True)
    print(f"exit code {ended.returncode}, {len(ended.stderr)} characters of errors")
    print(ended.stderr, end="", file=sys.stderr)
    sys.exit(ended.returncode != 0 or bool(ended.stderr))


# Seconds without an end of a thousand motions.
DEADLOCK = 300


if __name__ == "__main__":
    main()
