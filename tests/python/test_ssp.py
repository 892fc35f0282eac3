"""Compares the SSP example with SciPy's solution of block and storey as one system."""

import math
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

pytestmark = pytest.mark.check
ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / folder) for folder in ("lab/benches/peers", "examples", "examples/ssp", "examples/coupling/bridge")]
STOP = 6.0  # s


def need(package):
    # Ecos cannot be imported before its library TBB is loaded.
    if find_spec(package) is None:
        pytest.skip(f"{package} has no build for this platform or is not installed")


def parameters(name):
    from fmpy.ssp.ssd import read_ssv

    return {parameter.name: float(parameter.value) for parameter in read_ssv(ROOT / f"examples/ssp/{name}.ssv").parameters}


def together(samples, dt, rows, heavy=1.0):
    """Returns the rotation at multiples of `rows` [s], with a storey `heavy` times as heavy and as stiff.

    State: that of scipy_peer.py, then the displacement of the floor relative to the ground and its rate.
    """
    import scipy_peer

    block, storey = parameters("block"), parameters("storey")
    m, k = heavy * storey["mass"], heavy * storey["stiffness"]
    c = 2 * storey["damping"] * math.sqrt(k * m)
    b, h, mass = block["physical.width"] / 2, block["physical.height"] / 2, block["mass"]
    r0 = math.hypot(b, h)
    p = math.sqrt(0.75 * 9.81 / r0)
    omega = math.sqrt(2 * block["physical.K"] / mass)
    values = dict(alpha=math.atan(b / h), p=p, eta=omega / p, xi_v=block["physical.C"] / (mass * omega), epsilon=block["epsilon"],
                  gamma=3.0, gravity=9.81, rigid=0, shape=0, settled=0, theta=0.0, theta_dot=0.0, t_end=STOP, dt=rows,
                  record_dt=dt, record_samples=len(samples))

    class Together(scipy_peer.Run):
        def start(self):
            t, y = super().start()
            self.atol = np.append(self.atol, self.tolerance * np.array([0.1, 1.0]))
            return t, [*y, 0.0, 0.0]

        def equations(self, ground):
            """Solves the equations of motion of both: all accelerations are linear in the floor's."""
            corner = {(True, True): None, (True, False): 0, (False, True): 1}[tuple(self.touching)]
            parent = super().equations

            def rates(t, y):
                def under(a):
                    """Returns the rates of the block on a floor accelerating with `a`, and its H."""
                    found = parent(lambda t: a)(t, y[:4])
                    if corner is None:
                        height, reach = h * math.cos(y[0]), h * math.sin(y[0])
                    else:
                        reach, height = self.arms(corner, y[0])
                        reach *= scipy_peer.SIGNS[corner]
                    return found, mass * (height * found[1] - reach * y[1] ** 2 + a)

                (_, still), (_, moved) = under(0.0), under(1.0)
                a = (-c * y[5] - k * y[4] - still) / (m + moved - still)
                return [*under(a)[0], y[5], a - ground(t)]

            return rates

    run = Together(scipy_peer.make_block(values), list(samples), "DOP853-restart", 1e-9, trace=True)
    run.go()
    return np.array(run.theta[1:])


@pytest.fixture(scope="module")
def package(fmu, program, tmp_path_factory):
    need("pythonfmu")
    import floor

    return floor.build(tmp_path_factory.mktemp("ssp"))


def record():
    """Returns the samples of the earthquake in the package, and their time step."""
    import bridge
    import floor

    time, samples = bridge.earthquake(floor.SCALE, floor.BEGIN)
    return samples, time[1]


def test_the_coupling_converges_to_the_motion_of_the_whole(package):
    import floor

    rows = 0.004
    whole = together(*record(), rows)
    # The block rocks, and its feedback is no small part of the motion.
    assert 0.1 < np.abs(whole).max() < 0.3
    assert np.abs(together(*record(), rows, heavy=1e6) - whole).max() > 0.02
    runs = [floor.run_fmpy(package, rows / k, STOP)["block.theta"][k - 1 :: k] for k in (2, 4, 8)]
    coarse, fine, finest = (np.abs(run - whole).max() for run in runs)
    # Of first order, since each FMU receives the outputs of the step before.
    assert 1.9 < coarse / fine < 2.1 and 1.9 < fine / finest < 2.1
    assert finest < 1e-3
    # Extrapolation removes the first order.
    assert np.abs(2 * runs[2] - runs[1] - whole).max() < 0.1 * finest


@pytest.mark.parametrize("master, needed", [("libcosim", "libcosimpy"), ("Ecos", "ecospy")])
def test_every_master_reads_the_parameters_of_the_package(package, master, needed):
    need(needed)
    import floor

    expected, result = (floor.MASTERS[name](package, 0.002, STOP) for name in ("fmpy", master))
    for name, values in expected.items():
        assert np.abs(result[name] - values).max() < 1e-9 * np.abs(values).max(), name
