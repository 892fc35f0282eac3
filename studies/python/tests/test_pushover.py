"""The lateral force over a slow rotation, in Python."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

import rocking_block as rb


def damper(block, yield_force):
    return rb.Damper(block_x=-block.width / 2, ground_x=-block.width / 2, ground_z=-1.0, stiffness=1e6, yield_force=yield_force)


def test_a_rigid_base_resists_with_the_weight():
    block = rb.Block(alpha=0.25, p=1.0, foundation="rigid", mass=2000)
    found = block.pushover(points=50)
    assert [landmark.name for landmark in found.landmarks] == ["at rest", "L lifts", "greatest force", "balance"]
    weight, theta = block.mass * block.g, found.table["theta"][1:]
    assert np.allclose(found.table["moment"][1:], weight * block.R0 * np.sin(block.alpha - theta), rtol=0, atol=1e-9 * weight * block.R0)
    assert np.allclose(found.table["force/weight"][1:], np.tan(block.alpha - theta), rtol=0, atol=1e-12)
    assert found.table.units["moment"] == "N.m" and found.cycle is None
    left = block.pushover(side="left", points=50)
    assert np.allclose(left.table["force"], -found.table["force"], rtol=0, atol=1e-12 * weight)
    assert repr(found) == "<Pushover of 52 rows: L lifts at 0, greatest force at 0, balance at 0.25>"


def test_a_cycle_has_the_energy_of_its_dampers():
    free = rb.Block(alpha=0.25, p=1.0, eta=60, xi_v=0.1, mass=2000)
    block = free.replace(dampers=[damper(free, 2000.0)])
    found = block.pushover(amplitude=0.03, to=0.1)
    cycle = found.cycle
    table = cycle.table
    closed = np.flatnonzero(table["theta"] == 0.03)[0]
    work = np.trapezoid(table["force"][closed:], table["u"][closed:])
    assert work == pytest.approx(sum(cycle.energy.values()), rel=1e-3) and cycle.energy["damper_1"] > 0.0
    assert list(cycle.energy_before) == ["damper_1"] and cycle.energy_before["damper_1"] > cycle.energy["damper_1"]
    assert cycle.recentring_ratio > 1.0 > cycle.equivalent_damping > 0.0 and 0.0 < cycle.residual_theta < 0.005
    axes = found.plot()
    assert [text.get_text() for text in axes.get_legend().get_texts()][:2] == ["slow rotation", "cycle"]
    plt.close("all")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"side": "up"}, "side = 'up'; expected 'left' or 'right'"),
        ({"to": 2.0}, "to = 2 rad; expected a rotation above 0"),
        ({"amplitude": 0.0}, "amplitude = 0 rad; expected"),
        ({"points": 0}, "points = 0"),
    ],
)
def test_mistakes_are_named(arguments, words):
    with pytest.raises(ValueError, match=words):
        rb.Block().pushover(**arguments)
