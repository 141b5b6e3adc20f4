"""Properties of every face: ``sync``, and the layers for ``franka`` and ``pylibfranka``. A stop comes from any thread, Ctrl-C
ends every wait, no thread of the program is raised, and a process may fork or exit at any time.
"""

from __future__ import annotations

import contextlib
import gc
import signal
import socket
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any, TypeVar

import franka_async.compat.franka as franka
import franka_async.compat.pylibfranka as pylibfranka
import numpy as np
import pytest
from conftest import LOOPBACK, PATIENT, program, until

from franka_async import ActionError, ConnectError, Joints, Latest, MotionError, Sim, sync

T = TypeVar("T")

IGNORE = pylibfranka.RealtimeConfig.kIgnore


@contextlib.contextmanager
def once(condition: Callable[[], bool], act: Callable[[], Any]) -> Iterator[None]:
    """From here on, and within the block, another thread acts as soon as the condition holds."""
    errors = []

    def run() -> None:
        try:
            until(condition)
            act()
        except BaseException as error:
            errors.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield
    finally:
        thread.join()
    assert not errors, errors


def interrupt() -> None:
    signal.raise_signal(signal.SIGINT)


def moves(sim: Sim) -> Callable[[], bool]:
    return lambda: bool(abs(sim.state().dq).max() > 0.02)


def assert_stops(sim: Sim) -> None:
    """The arm stops by its own motion, far from its target."""
    until(lambda: sim.state().robot_mode != "move")
    until(lambda: bool(abs(sim.state().dq).max() < 0.02))


@pytest.fixture
def live_fr3() -> Iterator[Sim]:
    with Sim.fr3(patience=5.0, hand=True, address=f"{LOOPBACK}.1:1337") as sim:
        yield sim


# Stops of another thread.


def test_a_stop_of_another_thread_ends_targets_of_franka(live_fr3: Sim) -> None:
    robot = franka.Robot(f"{LOOPBACK}.1", realtime="ignore")
    for begin, stop in ((robot.cartesian_targets, "robot"), (robot.joint_targets, "robot"), (robot.joint_targets, "session")):
        targets = begin()
        goal = targets.target()
        goal[6 if begin == robot.joint_targets else 2] += 0.1
        with once(moves(live_fr3), robot.stop if stop == "robot" else targets.stop):
            # The thread sends targets until it is notified of the stop.
            with pytest.raises(franka.FrankaError) as ended:
                while True:
                    targets.move_to(goal)
                    time.sleep(0.001)
        assert ended.value.kind == "invalid_operation" and not targets.running
        if stop == "robot":
            with pytest.raises(franka.ControlException) as raised:
                targets.stop()
            assert (raised.value.reason, raised.value.move_status) == ("[]", "Preempted")
        targets.stop()
        assert_stops(live_fr3)


def test_a_stop_of_another_thread_ends_a_chunk_of_franka(live_fr3: Sim) -> None:
    robot = franka.Robot(f"{LOOPBACK}.1", realtime="ignore")
    targets = robot.joint_targets()
    rows = targets.target() + np.outer(np.linspace(0.0, 0.5, 5000), np.eye(7)[6])
    targets.follow(rows, dt=0.005)
    with once(moves(live_fr3), robot.stop):
        until(lambda: not targets.running)
    with pytest.raises(franka.ControlException):
        targets.stop()
    assert abs(live_fr3.state().q[6] - rows[0][6]) < 0.4


def test_a_stop_of_another_thread_ends_active_control_of_pylibfranka(live_fr3: Sim) -> None:
    robot = pylibfranka.Robot(f"{LOOPBACK}.1", IGNORE)
    control = robot.start_joint_velocity_control(pylibfranka.ControllerMode.JointImpedance)
    speed = 0.0
    with once(moves(live_fr3), robot.stop):
        with pytest.raises(pylibfranka.ControlException, match="preempted"):
            while True:
                control.readOnce()
                speed = min(speed + 0.001, 0.1)
                control.writeOnce(pylibfranka.JointVelocities([0.0] * 6 + [speed]))
    assert_stops(live_fr3)
    with pytest.raises(pylibfranka.ControlException):
        control.readOnce()


# Ctrl-C.


def test_ctrl_c_ends_what_waits_for_a_robot(live_fr3: Sim) -> None:
    with sync.Robot(live_fr3.address, **PATIENT) as robot:
        far = robot.pose()
        far[2, 3] += 0.2
        waits: list[Callable[[], Any]] = [
            lambda: robot.move_to(far, speed=0.1),
            lambda: robot.follow(Latest(far), speed=0.1),
            lambda: robot.move_through([far, robot.pose()], speed=0.1),
        ]
        for wait in waits:
            with pytest.raises(KeyboardInterrupt), once(moves(live_fr3), interrupt):
                wait()
            assert_stops(live_fr3)
            assert live_fr3.state().O_T_EE[2, 3] < far[2, 3] - 0.02
        with robot.engage() as arm:
            with pytest.raises(KeyboardInterrupt), once(moves(live_fr3), interrupt):
                arm.move_to(far, speed=0.1)
            until(lambda: bool(abs(live_fr3.state().dq).max() < 0.02))
            arm.set(Joints(robot.state().q))
        # Events that never come.
        events = robot.events()
        with pytest.raises(KeyboardInterrupt), once(lambda: True, interrupt):
            for _ in events:
                pass


def test_ctrl_c_ends_targets_of_franka(live_fr3: Sim) -> None:
    robot = franka.Robot(f"{LOOPBACK}.1", realtime="ignore")
    with pytest.raises(KeyboardInterrupt):
        with robot.cartesian_targets(max_velocity=0.05) as targets:
            target = targets.target()
            targets.move_by([0.0, 0.0, 0.2])
            with once(moves(live_fr3), interrupt):
                # Waits until the arm is at the target.
                targets.stop()
    del targets
    assert_stops(live_fr3)
    assert live_fr3.state().O_T_EE[2, 3] < target[2] + 0.15


def test_ctrl_c_ends_active_control_of_pylibfranka(live_fr3: Sim) -> None:
    robot = pylibfranka.Robot(f"{LOOPBACK}.1", IGNORE)
    control = robot.start_joint_velocity_control(pylibfranka.ControllerMode.JointImpedance)
    speed = 0.0
    with pytest.raises(KeyboardInterrupt), once(moves(live_fr3), interrupt):
        while True:
            control.readOnce()
            speed = min(speed + 0.001, 0.1)
            control.writeOnce(pylibfranka.JointVelocities([0.0] * 6 + [speed]))
    del control
    assert_stops(live_fr3)


def test_a_stop_of_another_thread_and_ctrl_c_end_an_action_of_the_hand(live_fr3: Sim) -> None:
    refusals = {sync: ActionError, franka: franka.FrankaError, pylibfranka: pylibfranka.CommandException}
    for face, refused in refusals.items():
        check_actions_end(face, refused, str(live_fr3.hand_address))
        gc.collect()


def check_actions_end(face: Any, refused: type[Exception], address: str) -> None:
    hand = connected(lambda: face.Gripper(address).connect() if face is sync else face.Gripper(address))
    newest, move = (hand.state, hand.move_to) if face is sync else (hand.read_once, hand.move)
    if newest().max_width == 0.0:
        hand.homing()
    for act, error in ((hand.stop, refused), (interrupt, KeyboardInterrupt)):
        begin = newest().width
        with pytest.raises(error), once(lambda: newest().width < begin - 0.001, act):
            # A minute or more.
            move(0.0, 8e-4)
        until(lambda: newest().width == newest().width)
        assert begin - 0.02 < newest().width


def connected(connect: Callable[[], T]) -> T:
    """Connects once the previous client has left: the robot has room for one."""
    made: list[T] = []

    def attempt() -> bool:
        with contextlib.suppress(ConnectError, franka.FrankaError, pylibfranka.NetworkException):
            made.append(connect())
        return bool(made)

    until(attempt)
    return made[0]


def test_ctrl_c_ends_connecting() -> None:
    """The robot accepts the connection and sends nothing."""
    with socket.create_server((f"{LOOPBACK}.2", 1337)) as silent:
        address = f"{LOOPBACK}.2:{silent.getsockname()[1]}"
        connecting: list[Callable[[], Any]] = [
            lambda: sync.Robot(address, connect_timeout=100.0, **PATIENT).connect(),
            lambda: franka.Robot(address, realtime="ignore"),
            lambda: pylibfranka.Robot(address, IGNORE),
        ]
        for connect in connecting:
            accepted: list[socket.socket] = []

            def heard(accepted: list[socket.socket] = accepted) -> bool:
                accepted.append(silent.accept()[0])
                return bool(accepted[-1].recv(1))

            with pytest.raises(KeyboardInterrupt), once(heard, interrupt):
                connect()
            for one in accepted:
                one.close()


# Threads, processes.

THREADS = f'HOST = "{LOOPBACK}.3"' + """
import asyncio, os, sys, threading, time
import franka_async, franka_async.compat.franka as franka, franka_async.compat.pylibfranka as pylibfranka
from franka_async import Policy, Robot, Sim, sync

def how(where):
    # Of each thread that Python knows: policy, priority, processors.
    return {(os.sched_getscheduler(t.native_id), os.sched_getparam(t.native_id).sched_priority,
             tuple(sorted(os.sched_getaffinity(t.native_id)))) for t in threading.enumerate()} | where

before = how(set())
assert len(before) == 1 and next(iter(before))[:2] == (os.SCHED_OTHER, 0), before
with Sim.fr3(virtual_time=True, hand=True, address=HOST + ":1337") as sim:
    seen = []
    def asked(reflex):
        seen.append(how(set()))
        return True
    robot = Robot(sim.address, realtime="ignore", priority=60, cpu=0, supervise=Policy(recover=(3, 60.0)), ask_before_recovery=asked)
    robot.connect().wait()
    seen.append(how(set()))
    def cycle(control):
        for number in range(100):
            control.read_once()
            if number == 50:
                seen.append(how(set()))
            control.write_once([0.0] * 7, finished=number == 99)
        seen.append(how(set()))
    cycle(robot.active_torques().wait())
    thread = threading.Thread(target=cycle, args=(robot.active_torques().wait(),))
    thread.start()
    thread.join()
    recovered = (event for event in robot.events() if event.kind == "recovered")
    sim.trip("joint_reflex")
    next(recovered)
    def targets():
        for _ in range(3):
            seen.append(how(set()))
            yield robot.pose()
    robot.follow(targets()).wait()
    robot.shutdown().wait()
    robot = franka.Robot(HOST, realtime="ignore")
    with robot.cartesian_targets(realtime_priority=60) as session:
        session.follow([session.target()] * 3, dt=0.001)
        seen.append(how(set()))
        session.state()
    robot.gripper().homing()
    del robot, session
    for attempt in range(1000):
        try:
            robot = pylibfranka.Robot(HOST, pylibfranka.RealtimeConfig.kIgnore)
            break
        except pylibfranka.NetworkException:
            time.sleep(0.01)  # The client before is leaving.
    control = robot.start_torque_control()
    for number in range(10):
        control.readOnce()
        command = pylibfranka.Torques([0.0] * 7)
        command.motion_finished = number == 9
        control.writeOnce(command)
        seen.append(how(set()))
    assert len(seen) > 15 and all(one == before for one in seen), (before, seen)
print("unchanged")
"""


def test_no_thread_of_the_program_is_raised_or_pinned() -> None:
    """The control thread itself is raised if the system grants the right."""
    assert "unchanged" in program(THREADS)


EXITING = f'HOST = "{LOOPBACK}.4"' + """
import threading, time
import franka_async, franka_async.compat.franka as franka, franka_async.compat.pylibfranka as pylibfranka
from franka_async import MotionError, Sim, sync
sim = Sim.fr3(patience=5.0, hand=True, address=HOST + ":1337")
def moving():
    end = time.monotonic() + 30
    while abs(sim.state().dq).max() < 0.02:
        assert time.monotonic() < end
        time.sleep(0.001)
def beside(work):
    threading.Thread(target=work, daemon=True).start()
"""

EXITS = {
    "sync": """
robot = sync.Robot(sim.address, realtime="ignore", link_timeout=10.0).connect()
beside(lambda: robot.move_by([0.0, 0.0, 0.2], speed=0.1))
moving()
""",
    "a session of sync": """
robot = sync.Robot(sim.address, realtime="ignore", link_timeout=10.0).connect()
arm = robot.engage()
beside(lambda: arm.move_by([0.0, 0.0, 0.2], speed=0.1))
moving()
""",
    "franka": """
robot = franka.Robot(HOST, realtime="ignore")
targets = robot.cartesian_targets(max_velocity=0.05)
targets.follow([targets.target()[:3] + [0.0, 0.0, 0.0001 * i] for i in range(2000)], dt=0.01)
moving()
""",
    "pylibfranka": """
robot = pylibfranka.Robot(HOST, pylibfranka.RealtimeConfig.kIgnore)
control = robot.start_joint_velocity_control(pylibfranka.ControllerMode.JointImpedance)
def cycle():
    speed = 0.0
    while True:
        control.readOnce()
        speed = min(speed + 0.001, 0.1)
        control.writeOnce(pylibfranka.JointVelocities([0.0] * 6 + [speed]))
beside(cycle)
moving()
""",
    "a hand": """
hand = pylibfranka.Gripper(HOST)
hand.homing()
beside(lambda: hand.move(0.0, 8e-4))
while hand.read_once().width > 0.079:
    pass
""",
}


@pytest.mark.parametrize("face", EXITS)
def test_the_interpreter_exits_with_a_motion_under_way(face: str) -> None:
    text = program(EXITING + EXITS[face] + 'print("left", flush=True)\n')
    assert "left" in text and "Fatal" not in text and "panicked" not in text, text


FORKING = """
import os, sys
robot = franka.Robot(HOST, realtime="ignore")
inner = sync.Robot(sim.address, realtime="ignore")
targets = robot.joint_targets()
hand = pylibfranka.Gripper(HOST)
reading = threading.Event()
def read():
    while not reading.is_set():
        robot.read_once(), hand.read_once(), targets.state(), targets.move_by([0.0] * 7)
threads = [threading.Thread(target=read) for _ in range(3)]
for thread in threads:
    thread.start()
for n in range(20):
    child = os.fork()
    if child == 0:
        refused = 0
        for use in (robot.read_once, targets.state, targets.stop, robot.stop, hand.homing, inner.connect, sim.state):
            try:
                use()
            except RuntimeError as error:
                refused += "forked" in str(error)
        os._exit(refused)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
reading.set()
for thread in threads:
    thread.join()
targets.stop()
print("forked", robot.read_once().robot_mode)
"""


def test_a_process_forks_while_its_threads_use_the_robot() -> None:
    assert "forked idle" in program(EXITING + FORKING)


# Errors of the program itself.


def test_an_iterator_that_raises_brakes_the_arm(live_fr3: Sim) -> None:
    with sync.Robot(live_fr3.address, **PATIENT) as robot:
        far = robot.pose()
        far[2, 3] += 0.2

        def targets() -> Iterator[Any]:
            yield far
            until(moves(live_fr3))
            raise KeyError("of the program")

        with pytest.raises(KeyError, match="of the program"):
            robot.follow(targets(), speed=0.1)
        assert_stops(live_fr3)
        # The robot takes the next motion.
        with robot.engage() as arm, pytest.raises(KeyError):
            arm.follow(targets(), speed=0.1)
        with pytest.raises(MotionError):
            robot.move_to([5.0, 0.0, 0.0])
        robot.move_by([0.0, 0.0, 0.01], from_arm=True)
