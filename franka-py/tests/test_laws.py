"""Control laws without the interpreter: from numba and from C, on both robots in virtual time."""

from __future__ import annotations

import asyncio
import ctypes
import gc
import shutil
import subprocess
import sys
import weakref
from collections.abc import Callable, Coroutine
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import PATIENT
from franka_async import Law, Model, MotionError, Robot, Sim, laws
from franka_async._native import _law_layout

ROBOTS = pytest.mark.parametrize("start", [Sim.fr3, Sim.fer])
Start = Callable[..., Sim]

STIFFNESS = np.array([600.0, 600.0, 600.0, 600.0, 250.0, 150.0, 50.0])
DAMPING = np.array([50.0, 50.0, 50.0, 50.0, 30.0, 25.0, 15.0])

LAWS_IN_C = """
#include "franka_async_law.h"

/* Stiffness, target, damping; the memory counts the cycles. Finishes after half a second. */
int32_t spring(const franka_async_law_cycle *cycle, const double *p, double *memory, double *output) {
    if (cycle->version != FRANKA_ASYNC_LAW_VERSION || cycle->size < sizeof *cycle) return -100;
    if (cycle->parameters_len != 21 || cycle->memory_len != 1) return -101;
    for (int i = 0; i < 7; ++i)
        output[i] = p[i] * (p[7 + i] - cycle->q[i]) - p[14 + i] * cycle->dq[i] + cycle->coriolis[i];
    memory[0] += 1.0;
    return cycle->time > 0.4995 ? FRANKA_ASYNC_LAW_FINISH : FRANKA_ASYNC_LAW_GO_ON;
}

/* Stands still by each kind of command, and after as many cycles as the parameter says finishes, or gives up with the code of the
   second one. */
static int32_t counted(const double *p, double *memory) { return ++memory[0] < p[0] ? 0 : p[1] < 0.0 ? (int32_t)p[1] : 1; }

int32_t hold_joints(const franka_async_law_cycle *cycle, const double *p, double *memory, double *output) {
    if (memory[0] == 0.0) for (int i = 0; i < 7; ++i) memory[1 + i] = cycle->q_d[i];
    for (int i = 0; i < 7; ++i) output[i] = memory[1 + i];
    return counted(p, memory);
}

int32_t hold_pose(const franka_async_law_cycle *cycle, const double *p, double *memory, double *output) {
    if (memory[0] == 0.0) for (int i = 0; i < 16; ++i) memory[1 + i] = (&cycle->O_T_EE_c[0][0])[i];
    for (int i = 0; i < 16; ++i) output[i] = memory[1 + i];
    return counted(p, memory);
}

int32_t no_velocity(const franka_async_law_cycle *cycle, const double *p, double *memory, double *output) {
    for (int i = 0; i < 7; ++i) output[i] = 0.0;
    return counted(p, memory);
}

int32_t hold_pose_and_elbow(const franka_async_law_cycle *cycle, const double *p, double *memory, double *output) {
    if (memory[0] == 0.0) for (int i = 0; i < 2; ++i) memory[17 + i] = cycle->elbow_c[i];
    for (int i = 0; i < 2; ++i) output[16 + i] = memory[17 + i];
    return hold_pose(cycle, p, memory, output);
}

int32_t no_twist_and_no_elbow(const franka_async_law_cycle *cycle, const double *p, double *memory, double *output) {
    for (int i = 0; i < 6; ++i) output[i] = 0.0;
    return 0;
}

int32_t give_up(const franka_async_law_cycle *cycle, const double *p, double *memory, double *output) {
    for (int i = 0; i < 7; ++i) output[i] = 0.0;
    return cycle->time > 0.0505 ? -42 : 0;
}

int32_t forgets_its_output(const franka_async_law_cycle *cycle, const double *p, double *memory, double *output) {
    output[0] = 0.0;
    return 0;
}

/* Runs until the program says so. */
int32_t until_told(const franka_async_law_cycle *cycle, const double *p, double *memory, double *output) {
    for (int i = 0; i < 7; ++i) output[i] = 0.0;
    memory[0] = p[0];
    memory[1] += p[0] != p[255];
    return p[0] < 0.0;
}

/* The terms of the model, which a robot is not sent. */
int32_t tell_jacobian(const franka_async_law_cycle *cycle, const double *p, double *memory, double *output) {
    for (int i = 0; i < 42; ++i) memory[i] = (&cycle->jacobian[0][0])[i];
    for (int i = 0; i < 49; ++i) memory[42 + i] = (&cycle->mass[0][0])[i];
    for (int i = 0; i < 7; ++i) memory[91 + i] = cycle->gravity[i];
    for (int i = 0; i < 16; ++i) memory[98 + i] = (&cycle->O_T_EE[0][0])[i];
    return 7;
}
"""

# Prints name and offset of each field, and the size.
LAYOUT_IN_C = """
#include <stddef.h>
#include <stdio.h>
#include "franka_async_law.h"
int main(void) {
%s
    printf("%%zu\\n", sizeof(franka_async_law_cycle));
    return 0;
}
"""


def compile_c(source: str, directory: Path, *options: str) -> Path:
    """Compiles a C source with strict warnings; returns the library."""
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler: there is no program called cc")
    (directory / "laws.c").write_text(source)
    result = directory / "laws.out"
    include = ["-I", str(laws.header().parent)]
    strict = ["-std=c11", "-Wall", "-Wextra", "-Werror", "-Wno-unused-parameter", "-pedantic"]
    command = [compiler, *strict, *options, *include, "-o", str(result), str(directory / "laws.c")]
    subprocess.run(command, check=True)
    return result


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    directory = tmp_path_factory.mktemp("laws")
    return ctypes.CDLL(str(compile_c(LAWS_IN_C, directory, "-shared", "-fPIC", "-O2")))


def numba_spring() -> Any:
    """The law ``spring`` of the C source."""
    pytest.importorskip("numba", reason="numba is not installed")

    @laws.compiled
    def spring(cycle: Any, p: Any, memory: Any, output: Any) -> int:
        for i in range(7):
            output[i] = p[i] * (p[7 + i] - cycle.q[i]) - p[14 + i] * cycle.dq[i] + cycle.coriolis[i]
        memory[0] += 1.0
        return laws.FINISH if cycle.time > 0.4995 else laws.GO_ON

    return spring


def on(start: Start, program: Callable[[Robot], Coroutine[Any, Any, None]]) -> None:
    """Runs ``program`` with a robot that is connected to a simulated one in virtual time."""

    async def main() -> None:
        with start(virtual_time=True) as sim:
            async with Robot(sim.address, **PATIENT) as robot:
                await program(robot)

    asyncio.run(main())


def spring_of(code: object, target: np.ndarray[Any, np.dtype[np.float64]]) -> Law:
    return Law(code, parameters=np.concatenate([STIFFNESS, target, DAMPING]), memory=[0.0])


async def held_by(law: Law, robot: Robot) -> None:
    before = robot.state().q
    await robot.run_law(law)
    assert law.memory == pytest.approx([501.0]), "a cycle per millisecond, the first at time 0"
    assert robot.state().q == pytest.approx(before, abs=0.01)


@ROBOTS
def test_a_law_in_c_holds_the_arm(start: Start, library: ctypes.CDLL) -> None:
    async def program(robot: Robot) -> None:
        await held_by(spring_of(library.spring, robot.state().q), robot)

    on(start, program)


@ROBOTS
def test_a_law_of_cffi_holds_the_arm(start: Start, library: ctypes.CDLL) -> None:
    cffi = pytest.importorskip("cffi", reason="cffi is not installed")
    ffi = cffi.FFI()
    address = ctypes.cast(library.spring, ctypes.c_void_p).value
    pointer = ffi.cast("int32_t (*)(const void *, const double *, double *, double *)", address)

    async def program(robot: Robot) -> None:
        await held_by(spring_of(pointer, robot.state().q), robot)

    on(start, program)


@ROBOTS
def test_a_law_of_numba_holds_the_arm(start: Start) -> None:
    async def program(robot: Robot) -> None:
        await held_by(spring_of(numba_spring(), robot.state().q), robot)

    on(start, program)


@ROBOTS
def test_numba_and_c_compute_the_same_in_a_dry_run(start: Start, library: ctypes.CDLL) -> None:
    async def program(robot: Robot) -> None:
        state = robot.state()
        both = [spring_of(code, state.q) for code in (library.spring, numba_spring())]
        for law in both:
            law.parameters = law.parameters + np.repeat([0.0, 0.1, 0.0], 7)
        for millisecond in range(1, 502):
            (torques, code), (same, also) = (law.step(state, 0.001) for law in both)
            np.testing.assert_allclose(torques, same, rtol=1e-12, atol=1e-12)
            assert code == also == int(millisecond >= 500)
        assert torques == pytest.approx(STIFFNESS * 0.1, abs=0.5), "a spring of a tenth of a radian"
        assert both[0].memory == pytest.approx([501.0])
        both[0].reset()
        both[0].step(state)
        assert both[0].memory == pytest.approx([1.0])

    on(start, program)


@ROBOTS
def test_every_kind_of_command_can_come_from_a_law(start: Start, library: ctypes.CDLL) -> None:
    async def program(robot: Robot) -> None:
        for command, code in [
            ("joint_positions", library.hold_joints),
            ("joint_velocities", library.no_velocity),
            ("cartesian_pose", library.hold_pose),
            ("cartesian_velocities", library.no_velocity),
        ]:
            law = Law(code, command=command, parameters=[50.0, 0.0], memory=np.zeros(17))  # type: ignore[arg-type]
            await robot.run_law(law, controller="cartesian_impedance")
            assert law.memory[0] == 50.0, command
            # Giving up stops the robot, which then takes the next motion.
            law.parameters = [30.0, -7.0]
            with pytest.raises(MotionError) as given_up:
                await robot.run_law(law, controller="joint_impedance")
            assert (given_up.value.kind, given_up.value.code) == ("given_up", -7), command
            assert law.memory[0] == 30.0, command

    on(start, program)


@ROBOTS
def test_a_law_may_say_where_the_elbow_is(start: Start, library: ctypes.CDLL) -> None:
    async def program(robot: Robot) -> None:
        law = Law(library.hold_pose_and_elbow, command="cartesian_pose", elbow=True, parameters=[50.0], memory=np.zeros(19))
        output, _ = law.step(robot.state())
        assert output.shape == (18,) and output[16:] == pytest.approx(robot.state().elbow_c)
        await robot.run_law(law, controller="cartesian_impedance")
        assert law.memory[0] == 50.0
        with pytest.raises(MotionError) as invalid:
            await robot.run_law(library.no_twist_and_no_elbow, command="cartesian_velocities", elbow=True)
        assert invalid.value.kind == "invalid", "one that is not written is not a number"
        with pytest.raises(ValueError, match="elbow is True, expected False for \"torques\""):
            Law(library.hold_pose, elbow=True)

    on(start, program)


@ROBOTS
def test_a_dry_run_sees_the_model_and_shapes_its_output(start: Start, library: ctypes.CDLL) -> None:
    async def program(robot: Robot) -> None:
        state = robot.state()
        law = Law(library.tell_jacobian, command="cartesian_pose", memory=np.zeros(114))
        output, code = law.step(state)
        assert (output.shape, code) == ((4, 4), 7)
        assert np.isnan(output).all(), "it has written none"
        assert law.memory[98:] == pytest.approx(state.O_T_EE.ravel())
        # A dry run has the vendor's constants.
        model = Model.fr3() if robot.fci_version == 10 else Model.fer()
        tool = (state.F_T_EE, state.EE_T_K)
        jacobian = model.zero_jacobian("ee", state.q, F_T_EE=tool[0], EE_T_K=tool[1])
        assert law.memory[:42] == pytest.approx(jacobian.ravel())
        load = (state.I_total, state.m_total, state.F_x_Ctotal)
        assert law.memory[42:91] == pytest.approx(model.mass(state.q, *load).ravel())
        gravity = model.gravity(state.q, state.m_total, state.F_x_Ctotal)
        assert law.memory[91:98] == pytest.approx(gravity)

    on(start, program)


@ROBOTS
def test_a_negative_number_stops_the_robot_and_is_the_error(start: Start, library: ctypes.CDLL) -> None:
    async def program(robot: Robot) -> None:
        with pytest.raises(MotionError, match="gave up with code -42") as given_up:
            await robot.run_law(library.give_up)
        assert (given_up.value.kind, given_up.value.code, given_up.value.party) == ("given_up", -42, "caller")
        # The robot takes the next motion.
        await robot.run_law(library.no_velocity, parameters=[5.0, 0.0], memory=[0.0])

    on(start, program)


@ROBOTS
def test_output_that_is_not_written_stops_the_robot(start: Start, library: ctypes.CDLL) -> None:
    async def program(robot: Robot) -> None:
        with pytest.raises(MotionError) as invalid:
            await robot.run_law(library.forgets_its_output)
        assert invalid.value.kind == "invalid"

    on(start, program)


@ROBOTS
def test_parameters_reach_a_law_that_runs_whole(start: Start, library: ctypes.CDLL) -> None:
    async def program(robot: Robot) -> None:
        law = Law(library.until_told, parameters=np.zeros(256), memory=[0.0, 0.0])
        running = asyncio.ensure_future(asyncio.to_thread(robot.run_law(law).wait))
        for value in [1.0, 2.0, 3.0]:
            law.parameters = np.full(256, value)
            while law.memory[0] != value:
                await asyncio.sleep(0.001)
        law.parameters = np.full(256, -1.0)
        await running
        assert law.memory == pytest.approx([-1.0, 0.0]), "no cycle has seen a mix"

    on(start, program)


@ROBOTS
def test_cancelling_has_the_robot_stop(start: Start, library: ctypes.CDLL) -> None:
    async def program(robot: Robot) -> None:
        # Often: the next law must find the arm braking each time, however soon it comes.
        for _ in range(20):
            law = Law(library.until_told, parameters=np.full(256, 1.0), memory=[0.0, 0.0])
            running = asyncio.ensure_future(robot.run_law(law))
            while law.memory[0] != 1.0:
                await asyncio.sleep(0.001)
            running.cancel()
            with pytest.raises(asyncio.CancelledError):
                await running
            await robot.run_law(library.no_velocity, parameters=[5.0, 0.0], memory=[0.0])

    on(start, program)


@ROBOTS
def test_the_code_lives_as_long_as_it_may_be_called(start: Start, library: ctypes.CDLL) -> None:
    class Owned:
        """Code that is freed with this object."""

        address = ctypes.cast(library.until_told, ctypes.c_void_p).value

    async def program(robot: Robot) -> None:
        code = Owned()
        freed = weakref.ref(code)
        law = Law(code, parameters=np.full(256, 1.0), memory=[0.0, 0.0])
        running = asyncio.ensure_future(robot.run_law(law))
        while law.memory[0] != 1.0:
            await asyncio.sleep(0.001)
        del code
        gc.collect()
        assert freed() is not None
        law.parameters = np.full(256, -1.0)
        await running
        del law, running
        # The control thread has given the law back before or does so now.
        for _ in range(20_000):
            gc.collect(0)
            if freed() is None:
                return
            await asyncio.sleep(0.001)
        pytest.fail("the code outlives the law")

    on(start, program)


def test_what_is_no_code_is_refused() -> None:
    with pytest.raises(TypeError, match="a Python function, expected a C function"):
        Law(lambda cycle, parameters, memory, output: 0)
    callback = ctypes.CFUNCTYPE(ctypes.c_int32)(lambda: 0)
    with pytest.raises(TypeError, match="a callback into Python, expected a C function"):
        Law(callback)
    with pytest.raises(TypeError, match="code is str"):
        Law("spring")
    with pytest.raises(ValueError, match="null pointer"):
        Law(0)


def test_wrong_arguments_are_named(library: ctypes.CDLL) -> None:
    with pytest.raises(ValueError, match="command is \"forces\", expected one of 'torques'"):
        Law(library.spring, command="forces")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"parameters has the shape \[257\], expected \(n,\) with n up to 256"):
        Law(library.spring, parameters=np.zeros(257))
    with pytest.raises(ValueError, match="memory holds NaN"):
        Law(library.spring, memory=[np.nan])
    law = Law(library.spring, parameters=[1.0, 2.0])
    with pytest.raises(ValueError, match=r"parameters has the shape \[3\], expected \(2,\)"):
        law.parameters = [1.0, 2.0, 3.0]
    assert law.parameters == pytest.approx([1.0, 2.0])


def test_the_header_has_the_layout_of_the_driver(tmp_path: Path) -> None:
    fields, size = _law_layout()
    line = '    printf("%s %zu\\n", "{0}", offsetof(franka_async_law_cycle, {0}));'
    source = LAYOUT_IN_C % "\n".join(line.format(name) for name, *_ in fields)
    printed = subprocess.run([compile_c(source, tmp_path)], check=True, capture_output=True, text=True).stdout.split()
    assert printed == [str(part) for name, offset, *_ in fields for part in (name, offset)] + [str(size)]
    assert laws.CYCLE.itemsize == size
    assert laws.CYCLE["jacobian"].shape == (6, 7)


def test_numba_refuses_a_law_that_allocates() -> None:
    pytest.importorskip("numba", reason="numba is not installed")

    def makes_zeros(cycle: Any, parameters: Any, memory: Any, output: Any) -> int:
        output[:7] = np.zeros(7)
        return 0

    def subtracts(cycle: Any, parameters: Any, memory: Any, output: Any) -> int:
        output[:7] = parameters[:7] - cycle.q
        return 0

    def multiplies(cycle: Any, parameters: Any, memory: Any, output: Any) -> int:
        output[:7] = np.dot(cycle.mass, cycle.dq)
        return 0

    for law in (makes_zeros, subtracts, multiplies):
        with pytest.raises(TypeError, match=f"{law.__name__} is not a law that numba can compile: it allocates"):
            laws.compiled(law)


def test_an_exception_in_a_law_of_numba_is_a_code() -> None:
    pytest.importorskip("numba", reason="numba is not installed")

    @laws.compiled
    def raises(cycle: Any, parameters: Any, memory: Any, output: Any) -> int:
        if cycle.time > 0.05:
            raise ValueError("no more ideas")
        for i in range(7):
            output[i] = 0.0
        return 0

    async def program(robot: Robot) -> None:
        with pytest.raises(MotionError) as given_up:
            await robot.run_law(raises)
        assert given_up.value.code == laws.RAISED

    on(Sim.fr3, program)


def test_a_law_can_be_tried_out_as_a_python_function() -> None:
    cycle = laws.make_cycle(q=np.arange(7.0), time=2.0)
    assert cycle.q == pytest.approx(np.arange(7.0))
    assert (cycle.time, cycle.dt) == (2.0, 0.0)


def test_the_package_is_imported_without_numba() -> None:
    program = "import sys; sys.modules['numba'] = None; import franka_async.laws as laws\ntry:\n    laws.compiled(print)\nexcept ImportError as error:\n    print(error)"
    printed = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True).stdout
    assert printed == "laws are compiled by numba: pip install 'franka-async[numba]'\n"
