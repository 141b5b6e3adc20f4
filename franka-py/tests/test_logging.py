"""The bridge from the driver's reports to Python's logging."""

import logging
import subprocess
import sys

import pytest

import franka_async
from franka_async import Robot


def collect(code: str) -> str:
    """Returns the output of a separate program: the bridge is one for the process."""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=True)
    return done.stdout


HEAD = """
import logging, threading
import franka_async

class Keep(logging.Handler):
    def __init__(self):
        super().__init__()
        self.records, self.came = [], threading.Condition()
    def emit(self, record):
        with self.came:
            self.records.append(record)
            self.came.notify_all()
    def wait(self, text):
        with self.came:
            assert self.came.wait_for(lambda: any(text in r.getMessage() for r in self.records), 60), text
            return next(r for r in self.records if text in r.getMessage())

keep = Keep()
logging.getLogger("franka_async").addHandler(keep)
logging.getLogger("franka_async").setLevel(1)
sim = franka_async.Sim.fr3(virtual_time=True)

def connect():
    franka_async.Robot(sim.address, realtime="ignore").connect().wait().shutdown().wait()
"""


def test_nothing_is_passed_on_unless_it_is_asked_for() -> None:
    assert collect(HEAD + "connect(); print(len(keep.records))").strip() == "0"


def test_reports_have_level_fields_and_the_thread_is_not_the_drivers() -> None:
    out = collect(
        HEAD
        + """
franka_async.enable_logging()
connect()
record = keep.wait("connected endpoint")
print(record.levelname, record.name, record.rust_target, record.fields["version"], type(record.fields["version"]))
print(sim.address in record.getMessage(), record.fields["address"] == sim.address, record.fields["endpoint"] == sim.address)
"""
    )
    first, second = out.splitlines()
    assert first == "INFO franka_async.connect franka_async::connect 10 <class 'int'>"
    assert second == "True True True"


def test_the_level_can_be_changed() -> None:
    out = collect(
        HEAD
        + """
franka_async.enable_logging("error")
connect()
franka_async.enable_logging(logging.INFO)
connect()
keep.wait("connected endpoint")
print(sum(r.getMessage().startswith("connected") for r in keep.records))
"""
    )
    assert out.strip() == "1"


def test_a_handler_that_hangs_holds_nothing_up_and_what_is_dropped_is_counted() -> None:
    out = collect(
        HEAD
        + """
go_on = threading.Event()
class Hang(logging.Handler):
    def emit(self, record):
        go_on.wait()
hang = Hang()
logging.getLogger("franka_async").addHandler(hang)
franka_async.enable_logging("trace", queue=2)
# Each connection makes reports: more of them than fit, while the handler hangs.
for _ in range(5):
    connect()
go_on.set()
logging.getLogger("franka_async").removeHandler(hang)
# The next report that finds a place tells.
while not any("log messages were dropped" in record.getMessage() for record in keep.records):
    connect()
print(keep.wait("log messages were dropped").levelname)
"""
    )
    assert out.strip() == "WARNING"


def test_another_level_is_refused() -> None:
    with pytest.raises(ValueError, match="level is \"loud\", expected 'trace'"):
        franka_async.enable_logging("loud")
    assert logging.getLogger("franka_async").handlers == []
    assert Robot("127.0.0.1").address == "127.0.0.1"
