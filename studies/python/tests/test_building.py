"""Floor motions against SciPy's state-space simulation, and blocks on floors through study files."""

import copy
import pickle

import numpy as np
import pytest
from conftest import RECORDS
from scipy import signal

import rocking_block as rb

MASSES = np.array([3e5, 2e5, 2e5, 1e5])
STIFFNESSES = np.array([4e8, 3e8, 2e8, 1e8])


def matrices(ratio, modes):
    """Mass, stiffness and Rayleigh damping of the shear building in its floor displacements."""
    stiffness = np.diag(STIFFNESSES + np.append(STIFFNESSES[1:], 0)) - np.diag(STIFFNESSES[1:], 1) - np.diag(STIFFNESSES[1:], -1)
    omega = np.sqrt(np.sort(np.linalg.eigvals(stiffness / MASSES[:, None])))
    low, high = omega[[mode - 1 for mode in modes]]
    damping = 2 * ratio / (low + high) * (low * high * np.diag(MASSES) + stiffness)
    return np.diag(MASSES), stiffness, damping, omega


def test_floors_move_as_in_a_state_space_simulation():
    """SciPy integrates the floor displacements, without modes, by the exponential of the whole matrix."""
    mass, stiffness, damping, omega = matrices(0.04, (1, 3))
    building = rb.Building(floor_masses=MASSES, storey_stiffnesses=STIFFNESSES, rayleigh=(0.04, (1, 3)))
    assert np.allclose(2 * np.pi * building.frequencies, omega, rtol=1e-12)
    record = rb.read_record(RECORDS["0111a.smc"])
    spring, dashpot = (np.linalg.solve(mass, matrix) for matrix in (stiffness, damping))
    zero, one = np.zeros((4, 4)), np.eye(4)
    # Outputs: absolute accelerations, relative velocities.
    system = (np.block([[zero, one], [-spring, -dashpot]]), np.vstack([np.zeros((4, 1)), -np.ones((4, 1))]),
              np.block([[-spring, -dashpot], [zero, one]]), np.zeros((8, 1)))
    _, exact, _ = signal.lsim(system, record.acceleration, record.t - record.t[0])
    motions = rb.floor_motions(record, building)
    n = len(record)
    for floor, (motion, pfa, pfv) in enumerate(zip(motions.records, motions.PFA, motions.PFV)):
        assert np.abs(motion.acceleration[:n] - exact[:, floor]).max() < 1e-9 * pfa
        ground = np.concatenate([[0.0], np.cumsum(0.5 * (record.acceleration[1:] + record.acceleration[:-1]) * record.dt)])
        # Peaks between samples are a little higher.
        assert 0 <= pfv - np.abs(ground + exact[:, 4 + floor]).max() < 1e-3 * pfv
        assert pfa == motion.pga and len(motion) > n and abs(motion.acceleration[-1]) < 2e-3 * record.pga


def test_a_sine_gives_the_steady_amplification():
    omega, zeta = 2 * np.pi, 0.05
    oscillator = rb.Building(frequencies=[1.0], participation=[1.0], shapes=[[1.0]], damping=zeta)
    t = np.arange(0, 60, 0.002)
    for ratio in (0.5, 1.0, 2.0):
        motion = rb.floor_motions(rb.Record(np.sin(ratio * omega * t), 0.002), oscillator).records[0]
        steady = np.abs(motion.acceleration[len(t) - 5000 : len(t)]).max()
        exact = np.sqrt((1 + (2 * zeta * ratio) ** 2) / ((1 - ratio**2) ** 2 + (2 * zeta * ratio) ** 2))
        assert steady == pytest.approx(exact, rel=1e-4)


def test_studies_put_blocks_on_floors():
    """The rows of a study with a building are the outcomes under its floor motions, scaled to a peak floor velocity."""
    building = {"floor_masses": MASSES.tolist(), "storey_stiffnesses": STIFFNESSES.tolist(), "rayleigh": {"damping": 0.04, "modes": [1, 3]}}
    study = {
        "study": {"design": "grid", "levels": {"im": "PFV", "values": [0.3, 0.6]}},
        "parameters": {"p": [3.0, 4.0], "alpha": 0.2, "eta": 60.0, "foundation": "viscoelastic"},
        "records": [{"horizontal": str(RECORDS["0111a.smc"])}],
        "building": building | {"floors": [0, 2, 4]},
    }
    table = rb.sweep(study)
    assert table["floor"].tolist() == [0, 0, 2, 2, 4, 4] * 2
    assert table["PFV"].tolist() == [0.3, 0.6] * 6
    shear = rb.Building(floor_masses=MASSES, storey_stiffnesses=STIFFNESSES, rayleigh=(0.04, (1, 3)))
    motions = rb.floor_motions(RECORDS["0111a.smc"], shear, [0, 2, 4])
    expected = [
        rb.outcomes([rb.Block(alpha=0.2, p=p, eta=60)], [record], scale=level / pfv)["peak.theta/alpha"][0]
        for p in (3.0, 4.0)
        for record, pfv in zip(motions.records, motions.PFV)
        for level in (0.3, 0.6)
    ]
    assert table["peak.theta/alpha"].tolist() == expected
    assert np.allclose(table["PFA"], [level / pfv * pfa for pfa, pfv in zip(motions.PFA, motions.PFV) for level in (0.3, 0.6)] * 2)
    for change, message in [
        ({"floors": [5]}, r"floors = \[5\]|floors = 5"),
        ({"floors": [2, 2]}, "floors names 2 twice"),
        ({"damping": 0.05}, "expected none beside rayleigh"),
        ({"shapes": [[1.0]]}, "none beside floor_masses"),
    ]:
        with pytest.raises(ValueError, match=message):
            rb.sweep(study | {"building": building | change})
    without = {name: value for name, value in study.items() if name != "building"}
    with pytest.raises(ValueError, match=r"PFV is that of a floor; expected a \[building\]"):
        rb.sweep(without)
    with pytest.raises(ValueError, match="building has no effect without a horizontal record"):
        rb.sweep({"study": {"design": "grid"}, "parameters": {"initial.theta": 0.1}, "building": building})


def test_invalid_buildings_are_refused():
    with pytest.raises(ValueError, match="storey_stiffnesses has 1 values; expected 2"):
        rb.Building(floor_masses=[1.0, 1.0], storey_stiffnesses=[1.0], damping=0.05)
    with pytest.raises(ValueError, match="expected damping or rayleigh"):
        rb.Building(floor_masses=[1.0], storey_stiffnesses=[1.0])
    with pytest.raises(ValueError, match="floors has 3; expected floors from 0"):
        rb.floor_motions(rb.Record([0.0, 1.0], 0.1), rb.Building(floor_masses=[1.0], storey_stiffnesses=[1.0], damping=0.1), [3])


@pytest.mark.parametrize(
    "building",
    [
        rb.Building(floor_masses=MASSES, storey_stiffnesses=STIFFNESSES, rayleigh=(0.04, (1, 3))),
        rb.Building(frequencies=[1.0, 3.0], participation=[1.2, -0.2], shapes=[[0.5, 1.0], [1.0, -0.5]], damping=[0.02, 0.03]),
    ],
)
def test_a_copy_of_a_building_moves_to_the_last_bit(building):
    record = rb.Record([0.0, 3.0, -3.0, 1.0, 0.0], 0.1)
    motions = [rb.floor_motions(record, one) for one in (building, pickle.loads(pickle.dumps(building)), copy.deepcopy(building))]
    for other in motions[1:]:
        assert all(np.array_equal(a.acceleration, b.acceleration) for a, b in zip(motions[0].records, other.records, strict=True))


def test_a_period_beyond_reason_is_doubted():
    with pytest.warns(UserWarning, match="the building of 2 floors has a first period of 7.96 s; .*stiffnesses in N/m"):
        rb.Building(floor_masses=[3e5, 2e5], storey_stiffnesses=[4e5, 3e5], damping=0.05)
