"""The Franka Hand and the vacuum gripper."""

import asyncio
import threading

import pytest

import franka_async
from franka_async import ActionError, FrankaError, Gripper, GripperState, VacuumGripper

pytestmark = pytest.mark.franka(hand=True, vacuum_gripper=True)


def hand_of(sim: franka_async.Sim) -> Gripper:
    assert sim.hand_address is not None
    return Gripper(sim.hand_address)


def test_actions_are_awaited_and_the_state_is_there_without_waiting(franka_sim: franka_async.Sim) -> None:
    async def main() -> None:
        async with hand_of(franka_sim) as gripper:
            assert gripper.is_connected
            assert gripper.state().max_width == 0.0
            assert await gripper.homing() is True
            assert gripper.state().max_width == pytest.approx(0.08)
            assert await gripper.move_to(0.03, speed=0.1) is True
            assert gripper.state().width == pytest.approx(0.03, abs=1e-3)
            franka_sim.place_object(0.02)
            assert await gripper.grasp(0.02, 0.1, 30.0, epsilon_inner=0.002, epsilon_outer=0.002) is True
            assert gripper.state().is_grasped
            assert await gripper.stop() is True
        assert not gripper.is_connected

    asyncio.run(main())


def test_a_grasp_without_an_object_is_false(sim_fr3: franka_async.Sim) -> None:
    gripper = hand_of(sim_fr3).connect().wait()
    gripper.homing().wait()
    assert gripper.grasp(0.05).wait() is False
    gripper.disconnect()


def test_a_stop_ends_the_action_that_runs(franka_sim: franka_async.Sim) -> None:
    async def main() -> None:
        async with hand_of(franka_sim) as gripper:
            await gripper.homing()
            # A minute of the Hand, if nothing stopped it.
            moving = asyncio.create_task(gripper.move_to(0.0, speed=1e-3))
            await moves(gripper)
            assert await gripper.stop()
            with pytest.raises(ActionError) as raised:
                await moving
            assert raised.value.kind == "aborted"
            assert "aborted" in str(raised.value)

    asyncio.run(main())


def test_cancelling_an_action_stops_the_fingers(sim_fr3: franka_async.Sim) -> None:
    async def main() -> None:
        async with hand_of(sim_fr3) as gripper:
            await gripper.homing()
            moving = asyncio.create_task(gripper.move_to(0.0, speed=1e-3))
            await moves(gripper)
            moving.cancel()
            with pytest.raises(asyncio.CancelledError):
                await moving
            # At rest, far from its target: ten states, in which it would have moved on.
            rest = await at_rest(gripper)
            assert rest.width > 0.03

    asyncio.run(main())


async def moves(gripper: Gripper) -> None:
    """Waits until the fingers are on their way."""
    begin = gripper.state().width
    async for state in gripper.states():
        if abs(state.width - begin) > 1e-3:
            return


async def at_rest(gripper: Gripper) -> GripperState:
    """Waits until ten states in a row show the same width."""
    same, newest = 0, gripper.state()
    async for state in gripper.states():
        same = same + 1 if state.width == newest.width else 0
        newest = state
        if same == 10:
            break
    return newest


def test_another_thread_keeps_running_while_a_thread_waits_for_an_action(sim_fr3: franka_async.Sim) -> None:
    gripper = hand_of(sim_fr3).connect().wait()
    gripper.homing().wait()
    begun, enough = threading.Event(), threading.Event()

    def tick() -> None:
        # Begins once the fingers move: all ticks come while the move is waited for, which lasts until the stop.
        for state in gripper.states():
            if state.width < 0.0799:
                break
        begun.set()
        for _ in range(10_000):
            pass
        enough.set()
        gripper.stop().wait()

    ticking = threading.Thread(target=tick, daemon=True)
    ticking.start()
    with pytest.raises(ActionError, match="aborted"):
        # A hundred seconds of the Hand, if nothing stopped it.
        gripper.move_to(0.0, speed=8e-4).wait()
    assert begun.is_set() and enough.is_set()
    ticking.join()
    gripper.disconnect()


def test_states_end_with_the_connection(sim_fr3: franka_async.Sim) -> None:
    async def main() -> None:
        async with hand_of(sim_fr3) as gripper:
            states = gripper.states()
            first = await anext(states)
            second = await anext(states)
            assert second.time > first.time
        async for _ in states:
            pass

    asyncio.run(main())


def test_a_state_that_came_while_nobody_waited_is_not_lost(sim_fr3: franka_async.Sim) -> None:
    gripper = hand_of(sim_fr3).connect().wait()
    states = gripper.states()

    async def main() -> None:
        waiting = asyncio.ensure_future(anext(states))
        await asyncio.sleep(0)
        waiting.cancel()
        with pytest.raises(asyncio.CancelledError):
            await waiting
        state = await asyncio.wait_for(anext(states), 60)
        assert isinstance(state, GripperState)

    asyncio.run(main())
    assert next(states).time > 0
    gripper.disconnect()


def test_without_a_connection_it_says_what_to_do() -> None:
    gripper = Gripper("127.0.0.1:1")
    with pytest.raises(FrankaError, match="not connected to the Gripper at 127.0.0.1:1") as raised:
        gripper.state()
    assert (raised.value.kind, raised.value.party) == ("not_connected", "caller")
    with pytest.raises(franka_async.ConnectError):
        gripper.connect().wait()
    assert repr(gripper) == "<Gripper at 127.0.0.1:1, not connected>"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((float("nan"), 0.1), "width is NaN, expected a finite number of 0 or more"),
        ((0.03, -0.1), "speed is -0.1, expected a finite number of 0 or more"),
    ],
)
def test_arguments_that_make_no_sense_are_refused(arguments: tuple[float, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Gripper("127.0.0.1:1").move_to(*arguments)


def test_the_hand_of_a_robot_is_at_its_host(sim_fr3: franka_async.Sim, fr3: franka_async.Robot) -> None:
    port = int(sim_fr3.address.rpartition(":")[2])
    assert fr3.gripper().address == f"127.0.0.1:{port + 1}"
    assert fr3.vacuum_gripper().address == f"127.0.0.1:{port + 2}"
    assert franka_async.Robot("robot.lan").gripper().address == "robot.lan:1338"


def test_the_vacuum_gripper_takes_and_drops(franka_sim: franka_async.Sim) -> None:
    async def main() -> None:
        assert franka_sim.vacuum_gripper_address is not None
        async with VacuumGripper(franka_sim.vacuum_gripper_address) as gripper:
            assert not gripper.state().part_present
            franka_sim.place_part()
            assert await gripper.vacuum(60, timeout=5.0) is True
            state = gripper.state()
            assert state.part_present and state.vacuum > 0 and state.device_status == "green"
            assert await gripper.drop_off(timeout=5.0) is True
            assert not gripper.state().part_present
            with pytest.raises(ValueError, match="profile is 4, expected 0 to 3"):
                gripper.vacuum(60, 5.0, profile=4)

    asyncio.run(main())
