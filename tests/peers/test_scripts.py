"""Runs the scripts of this directory, each beside a separate simulator, and our clients beside other ones.

The tests marked `smoke` are a part of `cargo xtask test`, the others of the step `peers`. The programs have been built before,
in the directory that FRANKA_PROGRAMS names.
"""

import itertools
import os
import pathlib
import subprocess
import sys

import pytest

HERE = pathlib.Path(__file__).parent
PROGRAMS = pathlib.Path(os.environ["FRANKA_PROGRAMS"])

# The port of every FCI server; the vendor's client uses no other.
PORT = "1337"

# Options of the simulator of each script. Scripts run in virtual time, in which no answer is late, unless they depend on the
# robot's clock.
SMOKE = {
    "hand": ["--virtual-time", "--gripper-object-width", "0.05"],
    "setup": ["--virtual-time"],
    "motions": ["--virtual-time"],
    "torque_control": ["--virtual-time"],
    "reflexes": ["--virtual-time"],
}
REST = {
    "async": [],
    "model": ["--virtual-time", "--hand"],
    "modes": ["--virtual-time"],
    "active": ["--virtual-time"],
    "late": [],
    # The Jacobian of the end effector nearly loses a rank there.
    "singular": ["--virtual-time", "--q", "0,1.28,0,-0.5415,0,2.74,0"],
    "versions": ["--robot", "fer"],
}

_numbers = itertools.count()


@pytest.fixture
def new_address():
    """Returns loopback addresses that no other simulator of this machine uses: the vendor's client knows only one port.

    127.0.0.1 may have a simulator of the user. The scripts use the networks between for relays.
    """
    process = os.getpid()
    return lambda: f"127.{2 * next(_numbers) % 254 + 1}.{process // 254 % 256}.{process % 254 + 1}"


@pytest.fixture
def simulator(new_address):
    """Returns a function that starts a simulator with these options and returns its address."""
    started = []

    def start(options):
        address = new_address()
        command = [PROGRAMS / "franka-sim", "--bind", address, "--port", PORT, "--arm", "ideal", *options]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        started.append(process)
        output = iter(process.stdout.readline, "")
        assert any("listening on " in line for line in output), "the simulator ended"
        return address

    yield start
    for process in started:
        process.kill()
        process.communicate()


def run(*command):
    """Runs a program that prints a line for each of its steps. At least one step must pass, and none fail."""
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    with process:
        try:
            steps = [line for line in process.stdout if not print(line, end="") and line.startswith("ok    ")]
        finally:
            process.kill()
    assert process.returncode == 0
    assert steps, "no step passed"


def run_script(name, simulator, options):
    run(sys.executable, HERE / f"pylibfranka_{name}.py", simulator(options))


@pytest.mark.smoke
@pytest.mark.parametrize("name", SMOKE)
def test_script(name, simulator):
    run_script(name, simulator, SMOKE[name])


@pytest.mark.parametrize("name", REST)
def test_further_script(name, simulator):
    run_script(name, simulator, REST[name])


def test_cassette_that_the_client_has_recorded(new_address):
    # Simulator, tap and cassette.
    addresses = [new_address() for _ in range(3)]
    run(PROGRAMS / "cassette_peer", sys.executable, HERE / "pylibfranka_cassette.py", *addresses)


def test_target_control_beside_other_clients(new_address):
    script = HERE / "pylibfranka_positions.py"
    run(PROGRAMS / "beside_franka_rs", PROGRAMS / "franka-rs-peer", "--pylibfranka", sys.executable, script, new_address())
