"""The installed package: its metadata, and its effect on other programs."""

from __future__ import annotations

import sys
from importlib import metadata

import pytest

import franka_async

pytest_plugins = ["pytester"]


def test_metadata_is_complete() -> None:
    about = metadata.metadata("franka-async")
    assert about["Version"] == franka_async.__version__
    assert about["Author"] == "The authors of franka-async"
    assert about["License-Expression"] == "Apache-2.0"
    assert set(about.get_all("License-File") or []) == {"LICENSE", "NOTICE"}
    files = {str(file).rsplit("/", 1)[-1] for file in metadata.files("franka-async") or []}
    assert {"LICENSE", "NOTICE", "py.typed"} <= files
    versions = {line.split(" :: ")[-1] for line in about.get_all("Classifier") or [] if line.startswith("Programming Language :: Python :: 3.")}
    assert f"{sys.version_info[0]}.{sys.version_info[1]}" in versions
    oldest = (about["Requires-Python"] or "").removeprefix(">=")
    assert oldest in versions and not any(int(version[2:]) < int(oldest[2:]) for version in versions)


def test_plugin_loads_nothing_before_a_fixture_is_used(pytester: pytest.Pytester) -> None:
    """Tests of other programs in the same environment do not pay for the driver, and the driver does not break them."""
    pytester.makepyfile(
        """
        import sys

        def loaded():
            return {"numpy", "franka_async", "franka_async._native"} & set(sys.modules)

        def test_of_another_program():
            assert "franka_async_pytest" in sys.modules and loaded() == set()

        def test_with_a_robot(sim_fr3):
            assert len(loaded()) == 3
        """
    )
    pytester.runpytest_subprocess("-p", "no:xdist").assert_outcomes(passed=2)


def test_fixture_of_another_program_is_its_own(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        """
        import pytest

        @pytest.fixture
        def fr3():
            return "mine"

        def test_it(fr3):
            assert fr3 == "mine"
        """
    )
    pytester.runpytest().assert_outcomes(passed=1)
