"""Dampers, and ties that yield, in Python."""

import pickle

import matplotlib.pyplot as plt
import numpy as np
import pytest

import rocking_block as rb

PULSE = rb.Pulse("one-sine", amplitude=5.5, period=1.2, start=0.1)


def damper(side, **numbers):
    return rb.Damper(block_x=side * 0.3, ground_x=side * 0.3, ground_z=-0.6, **({"stiffness": 2e5, "yield_force": 900.0, "hardening": 0.05} | numbers))


def block(**more):
    return rb.Block(alpha=0.25, p=2.0, eta=40, xi_v=0.1, mass=1000, **more)


def test_forces_stay_between_the_yield_lines_and_energy_balances():
    tied = block(dampers=[damper(-1), damper(1)], ties=rb.Tie(block_z=2.0, ground_x=2.0, stiffness=2e4, slack=0.01, yield_force=150.0))
    run = tied.run(pulse=PULSE, duration=6.0, on_separation="fly", tolerance=1e-10)
    assert [event.event for event in run.events if event.corner == "damper 1"][:2] == ["yield", "unload"]
    for number, force in enumerate(run.damper_forces, 1):
        elongation, plastic = (run[f"damper_{number}.{name}"] for name in ("elongation", "plastic"))
        assert np.allclose(force, 2e5 * (elongation - plastic), atol=1e-6)
        assert np.all(np.abs(force - 0.05 * 2e5 * elongation) <= 0.95 * 900.0 * (1 + 1e-9))
        assert run.peak.damper_forces[number - 1] == pytest.approx(np.abs(force).max(), rel=1e-2)
        assert run.peak.plastic_elongations[number] == pytest.approx(np.abs(plastic).max(), rel=1e-3)
        assert run.peak.damper_strokes[number - 1] == pytest.approx(np.abs(elongation).max(), rel=1e-3)
    # Without dashpots a damper loses its yield force times the path of its plastic elongation.
    assert run.energy.dampers[-1] == pytest.approx(sum(run.yield_energies[1:]), rel=1e-8)
    assert run.energy.ties[-1] == pytest.approx(run.yield_energies[0], rel=1e-8) and run.yield_energies[0] > 0.0
    assert np.abs(run.energy.residual).max() < 1e-8 * run.energy.input.max()


def test_a_block_keeps_its_dampers():
    first = block(dampers=damper(1, damping=50.0, strength=2000.0))
    for copy in (pickle.loads(pickle.dumps(first)), first.replace(eta=40)):
        assert copy.dampers == first.dampers and copy.ties == ()
    assert "1 damper" in repr(first) and first.replace(dampers=[]).dampers == ()


def test_damping_alone_makes_a_dashpot():
    dashpot = rb.Damper(block_x=0.3, ground_x=0.3, ground_z=-0.6, damping=500.0)
    assert dashpot.stiffness == 0.0 and block(dampers=dashpot).dampers == (dashpot,)
    for numbers, words in [({}, "stiffness = 0.0 and damping = 0.0; expected one of the damper > 0"), ({"stiffness": -1.0, "damping": 1.0}, "stiffness = -1")]:
        with pytest.raises(ValueError, match=words):
            rb.Damper(ground_z=-1.0, **numbers)
    with pytest.raises(ValueError, match="stiffness = 0.0; expected a stiffness of the tie > 0"):
        rb.Tie(ground_z=-1.0, damping=500.0)
    with pytest.raises(ValueError, match="yield_force = 1 without stiffness"):
        block(dampers=rb.Damper(ground_z=-1.0, damping=500.0, yield_force=1.0))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"dampers": rb.Tie(stiffness=1e5, block_z=1.0)}, "dampers has Tie"),
        ({"ties": [damper(1)]}, "ties has Damper"),
        ({"dampers": damper(1, hardening=1.0)}, "hardening of a damper = 1"),
        ({"dampers": damper(1, yield_force=0.0)}, "hardening = 0.05 without yield_force"),
        ({"dampers": [damper(1)] * 9}, "at most 8 ties and dampers"),
    ],
)
def test_mistakes_are_named(arguments, words):
    with pytest.raises((TypeError, ValueError), match=words):
        block(**arguments)


def test_derivatives_match_differences():
    names = ["damper_1.yield_force", "damper_1.stiffness"]
    of = lambda number: block(epsilon=0.3, dampers=damper(-1, yield_force=number)).run(  # noqa: E731
        pulse=PULSE, duration=1.5, on_separation="fly", tolerance=1e-12
    )
    run = block(epsilon=0.3, dampers=damper(-1)).run(pulse=PULSE, duration=1.5, on_separation="fly", tolerance=1e-12, gradients=names)
    difference = (of(900.01).theta - of(899.99).theta) / 0.02
    exact = run.gradients[names[0]]["theta"]
    assert np.abs(exact - difference[: len(exact)]).max() < 1e-5 * np.abs(exact).max() > 0.0


def test_loops_are_drawn_and_tables_have_their_columns():
    tied = block(dampers=damper(-1))
    axes = tied.run(pulse=PULSE, duration=2.0).plot_loops()
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["damper 1"]
    plt.close("all")
    with pytest.raises(ValueError, match="no damper"):
        block().run(pulse=PULSE, duration=0.1).plot_loops()
    table = rb.outcomes([tied, block()], pulse=PULSE)
    assert table.units["peak.damper_1.force"] == "N" and table.units["peak.damper_1.plastic"] == "m"
    assert table["peak.damper_1.plastic"][0] > 0.0 and table["peak.damper_1.plastic"][1] == 0.0
