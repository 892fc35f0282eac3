"""Intensity measures against eqsig, pyrotd, and their definitions in numpy and scipy, to 1e-6.

`rocking` measures an acceleration that is linear between samples. eqsig sums over samples by the trapezoidal rule, and
pyrotd goes through the frequencies that samples can show: both get the same acceleration in denser samples, of which
each test says how many its tolerance takes. Neither has a mean period or Housner's intensity.
"""

import json
import subprocess
from pathlib import Path

import eqsig
import numpy as np
import pyrotd
import pytest
from eqsig import im, sdof
from scipy.optimize import brentq
from scipy.signal import cont2discrete, lfilter

ROOT = Path(__file__).resolve().parents[2]
EMBEDDED = ["examples/records/np01002p_4225a_a.smc", "examples/records/0111a.smc"]
SHARED = [
    "paper/NGA_no_1063_RRS228.AT2",
    "paper_derived/ERZ-NS_unrotated.AT2",
    "paper_derived/RRS-FN032.AT2",
    "fallback/IELC180.AT2",
    "formats/RSN1_HELENA.A_A-HMC180.AT2",
    "formats/RSN763_LOMAP_GIL067.AT2",
    "formats/CHICHI04-CHY039-E.at2",
]
PERIODS = [0.2, 0.5, 1.0, 3.0]
G = 9.81


@pytest.fixture(scope="module", params=EMBEDDED + [pytest.param(path, marks=pytest.mark.check) for path in SHARED])
def measured(request, program, tmp_path_factory):
    """Returns the summary of `rocking record`, and the samples."""
    path = ROOT / request.param if request.param in EMBEDDED else ROOT.parent / "shared/records" / request.param
    if not path.exists():
        pytest.skip(f"the record {path.name} may not be redistributed and is not at hand")
    table = tmp_path_factory.mktemp("record") / "r.csv"
    arguments = ["record", path, "--json", "--csv", table, "--periods", ",".join(map(str, PERIODS))]
    printed = subprocess.run([program, *arguments], check=True, capture_output=True, text=True).stdout
    (content,) = json.loads(printed)["records"]
    # Remarks and the heading, `t [s],a [m/s2]`, stand above the numbers.
    acceleration = np.loadtxt(table, delimiter=",", comments=["#", "t"])[:, 1]
    assert len(acceleration) == content["samples"]
    return content, acceleration


def denser(acceleration, parts):
    """Returns the same piecewise linear acceleration with smaller steps."""
    places = np.arange((len(acceleration) - 1) * parts + 1) / parts
    return np.interp(places, np.arange(len(acceleration)), acceleration)


def near(value, expected, tolerance=1e-6):
    assert value == pytest.approx(expected, rel=tolerance, abs=0)


def test_eqsig_finds_the_same_peaks_and_sums(measured):
    content, acceleration = measured
    # The error of the trapezoidal rule falls with the square of the step: 1e-2 of CAV at most, once.
    parts = 128
    signal = eqsig.AccSignal(denser(acceleration, parts), content["dt"] / parts)
    near(content["PGA"], signal.pga, 1e-15)
    near(content["PGV"], signal.pgv)
    near(content["PGD"], signal.pgd)
    near(content["PGV/PGA"], signal.pgv / signal.pga)
    near(content["CAV"], im.calc_cav(signal)[-1])
    # For the square of a linear function its error is a multiple of the step's square, known from two steps.
    coarse = im.calc_arias_intensity(eqsig.AccSignal(acceleration, content["dt"]))[-1]
    dense = im.calc_arias_intensity(signal)
    near(content["Arias"], dense[-1] + (dense[-1] - coarse) / (parts**2 - 1), 1e-12)
    # It counts steps.
    assert content["D5-95"] == pytest.approx(im.calc_sig_dur(signal), abs=2.01 * signal.dt)


def test_sums_are_those_of_numpy(measured):
    content, acceleration = measured
    dt, a, b = content["dt"], acceleration[:-1], acceleration[1:]
    energy = np.concatenate([[0], np.cumsum(dt * (a**2 + a * b + b**2) / 3)])
    near(content["Arias"], np.pi / (2 * G) * energy[-1], 1e-12)

    def time_of(part):
        step = np.searchsorted(energy, part * energy[-1]) - 1
        slope = (b[step] - a[step]) / dt

        def excess(t):
            cubic = np.polyint(np.polymul([slope, a[step]], [slope, a[step]]))
            return energy[step] + np.polyval(cubic, t) - part * energy[-1]

        return step * dt + brentq(excess, 0, dt, xtol=1e-14)

    near(content["D5-95"], time_of(0.95) - time_of(0.05), 1e-10)
    count = 1 << int(np.ceil(np.log2(max(len(acceleration), 20 / dt))))
    power = np.abs(np.fft.rfft(acceleration, count)) ** 2
    frequency = np.fft.rfftfreq(count, dt)
    band = (frequency >= 0.25) & (frequency <= 20)
    near(content["T_m"], (power[band] / frequency[band]).sum() / power[band].sum(), 1e-10)


@pytest.mark.parametrize("period", PERIODS)
def test_spectral_values_are_those_of_pyrotd(measured, period):
    content, acceleration = measured
    # Frequencies above the highest of the samples are missing; this many samples lose less than 1e-6.
    parts = max(128, 1 << int(np.ceil(np.log2(1300 * content["dt"] / period))))
    dense = denser(acceleration, parts)
    # A jump counts half. The record repeats: zeros until the oscillator has come to rest.
    dense[[0, -1]] *= 0.5
    dt = content["dt"] / parts
    zeros = 1 << int(np.ceil(np.log2(len(dense) + 60 * period / dt)))
    padded = np.pad(dense, (0, zeros - len(dense)))

    def peak(kind):
        # No more frequencies than there are.
        answer = pyrotd.calc_spec_accels(dt, padded, [1 / period], 0.05, max_freq_ratio=0, osc_type=kind)
        return answer["spec_accel"][0]

    near(content[f"Sa({period:g} s)"], peak("psa"))
    near(content[f"Sv({period:g} s)"], peak("sv"))


def test_spectral_accelerations_are_those_of_eqsig(measured):
    content, acceleration = measured
    parts = 8
    dt = content["dt"] / parts
    _, _, sa = sdof.pseudo_response_spectra(denser(acceleration, parts), dt, np.array(PERIODS), 0.05)
    for period, expected in zip(PERIODS, sa):
        # It takes the greatest value at a step: below a peak between two by an eighth of ü dt² at most.
        stiffness = (2 * np.pi / period) ** 2
        missed = dt**2 / 8 * stiffness * (1 + content["PGA"] / expected) * 1.1
        assert -1e-6 <= content[f"Sa({period:g} s)"] / expected - 1 <= 1e-6 + missed


def peaks_of(acceleration, dt, period, least=64):
    """Greatest displacement and velocity of an oscillator while the ground moves: scipy's exact discretization for linear
    inputs, which begin at zero; a closed form adds the effect of a sudden acceleration."""
    omega, damping = 2 * np.pi / period, 0.05
    # Peaks between steps are 1e-6 higher at most, those of the velocity if steps are short beside the record's too.
    parts = max(least, int(np.ceil(omega * dt / 1.4e-3)))
    ground = denser(acceleration, parts)
    t = np.arange(len(ground)) * dt / parts
    root = np.sqrt(1 - damping**2)
    decay, angle = np.exp(-damping * omega * t), root * omega * t
    sudden = (
        (1 - decay * (np.cos(angle) + damping / root * np.sin(angle))) / omega**2,
        decay * np.sin(angle) / (root * omega),
    )
    for numerator, step in zip(([-1.0], [-1.0, 0.0]), sudden):
        system = (numerator, [1, 2 * damping * omega, omega**2])
        (b,), a, _ = cont2discrete(system, dt / parts, method="foh")
        yield np.abs(lfilter(b, a, ground - ground[0]) - ground[0] * step).max()


def test_spectral_values_and_housners_intensity_are_those_of_scipy(measured):
    content, acceleration = measured
    periods = 0.1 + 0.02 * np.arange(121)
    displacements = [next(peaks_of(acceleration, content["dt"], period, least=8)) for period in periods]
    near(content["SI"], np.trapezoid(2 * np.pi / periods * displacements, periods))
    for period in PERIODS:
        displacement, velocity = peaks_of(acceleration, content["dt"], period)
        near(content[f"Sa({period:g} s)"], (2 * np.pi / period) ** 2 * displacement)
        near(content[f"Sv({period:g} s)"], velocity)
