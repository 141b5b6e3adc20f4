"""The pytest plugin, by pytest's own tester."""

import pytest

pytest_plugins = ["pytester"]


def test_the_fixtures_are_connected_robots_of_both_kinds(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        """
        def test_fr3(fr3, sim_fr3):
            assert fr3.fci_version == 10 and fr3.address == sim_fr3.address

        def test_fer(fer, sim_fer):
            assert fer.fci_version == 5 and fer.address == sim_fer.address

        versions = []

        def test_each(franka_robot, franka_sim):
            versions.append(franka_robot.fci_version)
            assert franka_robot.address == franka_sim.address

        def test_both_have_been():
            assert versions == [10, 5]

        def test_no_connection_is_left(fr3, sim_fr3):
            assert fr3.health().is_ready
        """
    )
    pytester.runpytest().assert_outcomes(passed=6)


def test_markers_and_parameters_choose_the_simulation(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        """
        import pytest

        pytestmark = pytest.mark.franka(seed=3, ideal=True)

        @pytest.mark.franka(hand=True, seed=4)
        def test_nearest_marker(franka_options, sim_fr3):
            assert franka_options == {"virtual_time": True, "seed": 4, "ideal": True, "hand": True}
            assert sim_fr3.hand_address is not None

        @pytest.mark.parametrize("franka_options", ["realistic", {"seed": 5}], indirect=True)
        def test_parameter(franka_options, sim_fr3):
            assert (franka_options["ideal"], franka_options["seed"]) in [(False, 3), (True, 5)]
        """
    )
    result = pytester.runpytest("--strict-markers")
    result.assert_outcomes(passed=3)


def test_a_wrong_parameter_says_what_was_expected(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        """
        import pytest

        @pytest.mark.parametrize("franka_options", ["perfect"], indirect=True)
        def test_it(fr3):
            pass
        """
    )
    result = pytester.runpytest()
    result.assert_outcomes(errors=1)
    result.stdout.fnmatch_lines(["*franka_options is 'perfect', expected 'ideal', 'realistic' or a dict*"])


def test_what_waited_in_vain_for_a_motion_fails_the_test(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        """
        def test_moves_nothing(sim_fr3, fr3):
            sim_fr3.push([0.0, 0.0, -200.0], once_moving=True).release()
            sim_fr3.trip("joint_reflex", once_moving=True)

        def test_takes_it_back(sim_fr3):
            sim_fr3.trip("joint_reflex", once_moving=True)
            sim_fr3.let_go()
        """
    )
    result = pytester.runpytest()
    result.assert_outcomes(passed=2, errors=1)
    result.stdout.fnmatch_lines(["*1 of once_moving=True still wait*"])


def test_a_failing_test_still_shuts_the_robot_down(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        """
        kept = []

        def test_fails(fr3):
            kept.append(fr3)
            assert False

        def test_after():
            assert not kept[0].is_connected
        """
    )
    pytester.runpytest().assert_outcomes(passed=1, failed=1)
