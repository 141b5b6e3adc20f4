"""What the installed package does to other programs."""

from __future__ import annotations

import pytest

pytest_plugins = ["pytester"]


def test_plugin_loads_nothing_before_a_fixture_is_used(pytester: pytest.Pytester) -> None:
    """Tests of other programs in the same environment do not pay for the driver, and are not broken by it."""
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
