"""The lists of names of other packages, each of which has a row in the book's chapters for users of those packages. The lists
match the packages themselves. ``cargo xtask check --only names`` checks the chapters against the lists.
"""

from __future__ import annotations

import importlib.util
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

NAMES = Path(__file__).parents[2] / "tests" / "peers" / "names"


def listed(package: str) -> set[str]:
    return set((NAMES / f"{package}.txt").read_text().split())


@pytest.mark.parametrize("package", ["pylibfranka", "franka", "franky", "panda_py"])
def test_a_list_has_the_names_of_its_package(package: str) -> None:
    """franky and panda_py are not among the packages that the tests install. They are compared where they are installed."""
    if importlib.util.find_spec(package) is None:
        pytest.skip(f"{package} is not installed")
    printed = subprocess.run([sys.executable, NAMES / "of_module.py", package], capture_output=True, text=True, check=True)
    assert set(printed.stdout.split()) == listed(package)


def test_the_list_of_libfranka_has_the_functions_of_its_library() -> None:
    """The library is part of pylibfranka. Types without functions, fields and constants are known from its headers only."""
    package = importlib.util.find_spec("pylibfranka")
    if package is None or package.origin is None or shutil.which("nm") is None:
        pytest.skip("pylibfranka or nm is not installed")
    library = Path(package.origin).with_name("libfranka.so")
    printed = subprocess.run(["nm", "-DC", "--defined-only", library], capture_output=True, text=True, check=True).stdout
    # Functions of classes and of the namespace, without the instances of templates.
    symbols = re.findall(r" [TW] franka::([\w:]+)(?:\[abi:cxx11\])?\(", re.sub(r"<[^<>]*>", "", printed))
    found = {re.sub(r"(\w+)::\1$", r"\1", symbol) for symbol in symbols}
    found = {name for name in found if not name.startswith(INTERNAL) and name not in UNLISTED}
    assert len(found) > 60
    assert not found - listed("libfranka")


INTERNAL = ("ControlLoop", "Network", "Robot::Impl", "RobotModel::", "MobileModel::Data", "CoutLoggingSink::")
"""Prefixes of classes that no header of a program names, or whose members belong to their interface."""

UNLISTED = {
    "ActiveMotionGenerator::isTorqueControlFinished",
    "JointVelocityLimitsConfig::getJointIndex",
    "assertOwningLock",
    "combineCenterOfMass",
    "combineInertiaTensor",
    "convertRobotState",
    "isMobileRobotUrdf",
    "skewSymmetricMatrixFromVector",
}
"""Private functions, or functions that only the library's sources use."""
