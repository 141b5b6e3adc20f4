"""The policy, events and health of supervised robots."""

import asyncio
import pickle
import threading
from typing import Any

import pytest

from conftest import PATIENT
import franka_async
from franka_async import Backoff, Event, Policy, Reflex, Robot, Sim


async def until(events: franka_async.Stream[Event], kind: str) -> Event:
    """The next event of this kind."""
    async for event in events:
        if event.kind == kind:
            return event
    raise AssertionError(f"no {kind}")


def test_events_of_a_reflex_and_the_recovery_by_policy(franka_sim: Sim) -> None:
    async def main() -> None:
        policy = Policy(recover=(3, 60.0), reconnect=None)
        async with Robot(franka_sim.address, **PATIENT, supervise=policy) as robot:
            assert robot.health().is_ready
            events = robot.events()
            franka_sim.trip("cartesian_reflex")
            reflex = await until(events, "reflex")
            assert reflex.reflex == Reflex(1, ["cartesian_reflex"], None)
            assert reflex.lost == 0 and reflex.robot_time is not None
            assert str(reflex) == 'reflex 1: ["cartesian_reflex"]'
            recovered = await until(events, "recovered")
            assert recovered.number == 1 and recovered.by_supervisor and recovered.after > 0
            health = robot.health()
            assert health.is_ready and health.recoveries == 1
            assert health.last_recovery == pytest.approx(recovered.after)
        closed = await until(events, "closed")
        assert (closed.reason.kind, closed.reason.party) == ("closed_by_us", "caller")
        assert [event async for event in events] == []

    asyncio.run(main())


def test_the_reflex_of_a_motion_comes_with_its_error(fr3: Robot, sim_fr3: Sim) -> None:
    async def main() -> None:
        events = fr3.events()
        target = fr3.pose()
        target[2, 3] += 0.1
        motion = asyncio.ensure_future(fr3.move_to(target, speed=0.1))
        while fr3.state().robot_mode != "move":
            await asyncio.sleep(0)
        sim_fr3.trip("cartesian_reflex")
        # The reflex is reported once its motion has ended.
        ended = await until(events, "motion_ended")
        reflex = (await until(events, "reflex")).reflex
        with pytest.raises(franka_async.ControlError) as raised:
            await motion
        assert isinstance(ended.error, franka_async.ControlError)
        for error in (reflex.error, ended.error):
            assert str(error) == str(raised.value)
            assert len(error.log) > 0 and error.errors == raised.value.errors
        assert fr3.health().condition == "reflex" and fr3.health().reflex == reflex.number
        await fr3.recover()

    asyncio.run(main())


def asking(sim: Sim, answers: list[Any]) -> tuple[Robot, list[Reflex], list[int]]:
    asked: list[Reflex] = []
    threads: list[int] = []

    def agrees(reflex: Reflex) -> Any:
        asked.append(reflex)
        threads.append(threading.get_ident())
        answer = answers.pop(0)
        if isinstance(answer, Exception):
            raise answer
        return answer

    policy = Policy(recover=(9, 60.0))
    robot = Robot(sim.address, **PATIENT, supervise=policy, ask_before_recovery=agrees)
    return robot, asked, threads


def test_a_function_agrees_to_a_recovery(franka_sim: Sim) -> None:
    async def main() -> None:
        robot, asked, threads = asking(franka_sim, [True, False])
        async with robot:
            events = robot.events()
            franka_sim.trip("joint_reflex")
            await until(events, "recovered")
            franka_sim.trip("joint_reflex")
            left = await until(events, "not_recovered")
            assert (left.number, left.why) == (2, "declined")
            assert [reflex.number for reflex in asked] == [1, 2]
            assert threading.get_ident() not in threads

    asyncio.run(main())


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_a_function_that_raises_does_not_agree(sim_fr3: Sim) -> None:
    async def main() -> None:
        robot, _, _ = asking(sim_fr3, [RuntimeError("nobody there")])
        async with robot:
            events = robot.events()
            sim_fr3.trip("joint_reflex")
            assert (await until(events, "not_recovered")).why == "declined"

    asyncio.run(main())


def test_a_function_that_waits_for_a_person_holds_up_no_shutdown(sim_fr3: Sim) -> None:
    asked, answered = threading.Event(), threading.Event()

    def agrees(_: Reflex) -> bool:
        asked.set()
        return answered.wait(60)

    robot = Robot(sim_fr3.address, **PATIENT, supervise=Policy(recover=(1, 60.0)), ask_before_recovery=agrees)
    robot.connect().wait()
    events = robot.events()
    sim_fr3.trip("joint_reflex")
    assert asked.wait(60)
    assert robot.health().condition == "agreement_awaited"
    # Ends while the function still waits.
    robot.shutdown().wait()
    assert list(events)[-1].kind == "closed"
    answered.set()


def test_an_agreement_by_number(sim_fr3: Sim) -> None:
    async def main() -> None:
        policy = Policy(recover=(1, 60.0), ask_first=True)
        async with Robot(sim_fr3.address, **PATIENT, supervise=policy) as robot:
            events = robot.events()
            sim_fr3.trip("joint_reflex")
            await until(events, "reflex")
            async for health in robot.health_changes():
                if health.condition == "agreement_awaited":
                    break
            assert health.reflex == 1
            assert not robot.agree(2)
            assert robot.agree(1)
            assert (await until(events, "recovered")).by_supervisor

    asyncio.run(main())


def test_a_user_stop_is_told(franka_robot: Robot, franka_sim: Sim) -> None:
    async def main() -> None:
        events = franka_robot.events()
        franka_sim.press_user_stop()
        assert (await until(events, "user_stop")).pressed
        assert franka_robot.health().condition == "user_stopped"
        franka_sim.press_user_stop(False)
        assert not (await until(events, "user_stop")).pressed

    asyncio.run(main())


def test_a_lost_connection_has_a_reason(sim_fr3: Sim) -> None:
    async def main() -> None:
        robot = await Robot(sim_fr3.address, **PATIENT).connect()
        closed = asyncio.ensure_future(robot.closed())
        await asyncio.sleep(0)
        sim_fr3.stop()
        reason = await closed
        assert (reason.kind, reason.party) == ("closed_by_peer", "link")
        assert reason.text == "libfranka: server closed connection"

    asyncio.run(main())


def test_a_supervisor_gives_up_when_told_to(sim_fr3: Sim) -> None:
    policy = Policy(reconnect=Backoff(first=0.01, most=0.01, jitter=0.0), give_up_after=0.1, seed=7)
    robot = Robot(sim_fr3.address, **PATIENT, supervise=policy).connect().wait()
    events = robot.events()
    sim_fr3.stop()
    kinds = [event.kind for event in events]
    assert kinds[0] == "lost" and kinds[-1] == "closed"
    assert robot.closed().wait().kind == "given_up"


def test_policies_are_values() -> None:
    policy = Policy(recover=(3, 60.0), only=["joint_reflex"], motions_wait=2.0, seed=1)
    assert policy == Policy(recover=(3, 60.0), only=("joint_reflex",), motions_wait=2.0, seed=1)
    assert policy != Policy()
    assert pickle.loads(pickle.dumps(policy)) == policy
    assert hash(policy) == hash(pickle.loads(pickle.dumps(policy)))


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"recover": (1, -1.0)}, "the window of recover is -1 s, expected a number of 0 or more"),
        ({"only": ["joint_reflex"]}, r"got `only` \(the errors to recover from\) without `recover`, expected both"),
        ({"recover": (1, 1.0), "only": ["bump"]}, '"bump", expected one of joint_position_limits_violation'),
        ({"reconnect": Backoff(jitter=1.5)}, "jitter is 1.5, expected a number from 0 to 1"),
        ({"silence": float("inf")}, "silence is inf"),
    ],
)
def test_policies_that_make_no_sense_are_refused(fields: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Policy(**fields)


def test_a_function_needs_a_supervisor() -> None:
    with pytest.raises(ValueError, match="without supervision, expected a Policy"):
        Robot("127.0.0.1", ask_before_recovery=lambda reflex: True)


def test_fields_of_events_are_attributes() -> None:
    event = Event("user_stop", 1.0, 2.0, 0, {"pressed": True}, "user stop pressed")
    assert event.pressed
    assert pickle.loads(pickle.dumps(event)) == event
    with pytest.raises(AttributeError, match="of the kind 'user_stop' has no 'reflex'"):
        event.reflex  # noqa: B018
