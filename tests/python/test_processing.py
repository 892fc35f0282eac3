"""Processing of records by `rocking record` against numpy and scipy, to round-off, and the pulse of a real record."""

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import butter, detrend, sosfiltfilt

ROOT = Path(__file__).resolve().parents[2]
RECORD = ROOT / "examples/records/0111a.smc"


@pytest.fixture
def table(program, tmp_path):
    """Returns a function: options of `rocking record` → the samples, the time step, and the summary."""

    def read(*options):
        path = tmp_path / "r.csv"
        printed = subprocess.run(
            [program, "record", RECORD, "--json", "--csv", path, *options], check=True, capture_output=True, text=True
        ).stdout
        (content,) = json.loads(printed)["records"]
        # Remarks and the heading, `t [s],a [m/s2]`, stand above the numbers.
        return np.loadtxt(path, delimiter=",", comments=["#", "t"])[:, 1], content["dt"], content

    return read


def near(found, expected, tolerance):
    assert np.abs(found - expected).max() <= tolerance * np.abs(expected).max()


def test_the_baseline_is_that_of_scipy(table):
    plain, _, content = table()
    assert "processing" not in content
    found, _, content = table("--baseline")
    near(found, detrend(plain), 1e-12)
    assert content["processing"] == "baseline removed"


@pytest.mark.parametrize("corners", [(0.1, 25.0), (0.05, 40.0), (1.0, 5.0)])
def test_the_filter_is_that_of_scipy(table, corners):
    """The tolerance is the round-off of the poles near 1, 1e-16/(f dt)², at 0.05 Hz."""
    plain, dt, _ = table()
    found, _, content = table("--band-pass", f"{corners[0]},{corners[1]}")
    zeros = int(np.ceil(6 / (corners[0] * dt)))
    padded = np.pad(plain, zeros)
    sections = butter(4, corners, "bandpass", fs=1 / dt, output="sos")
    near(found, sosfiltfilt(sections, padded, padtype=None)[zeros:-zeros], 2e-9)
    assert content["processing"] == f"band-pass {corners[0]:g} to {corners[1]:g} Hz"


def test_samples_are_interpolated_and_steps_go_in_order(table):
    plain, dt, _ = table()
    found, step, _ = table("--resample", "0.002")
    times = np.arange(len(found)) * 0.002
    assert step == 0.002 and len(found) == int((len(plain) - 1) * dt / 0.002 + 1e-9) + 1
    near(found, np.interp(times, np.arange(len(plain)) * dt, plain), 1e-12)
    found, step, content = table("--resample", "0.01", "--band-pass", "0.2,20", "--baseline")
    zeros = int(np.ceil(6 / (0.2 * dt)))
    sections = butter(4, (0.2, 20.0), "bandpass", fs=1 / dt, output="sos")
    expected = sosfiltfilt(sections, np.pad(detrend(plain), zeros), padtype=None)[zeros:-zeros][::2]
    near(found, expected, 1e-9)
    assert content["processing"] == "baseline removed, band-pass 0.2 to 20 Hz, resampled every 0.01 s"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--resample", "0.01"], "resampling from 0.005 to 0.01 s would alias; expected a band-pass"),
        (["--band-pass", "0.1,150"], "band-pass 0.1 to 150 Hz; expected 0 < lower corner < upper corner < 100 Hz"),
        (["--band-pass", "0.1"], "--band-pass without two frequencies; expected two, as in 0.1,25"),
        (["--resample", "-1"], "--resample = -1; expected a time > 0 s"),
    ],
)
def test_impossible_processing_is_refused(program, options, message):
    refused = subprocess.run([program, "record", RECORD, *options], capture_output=True, text=True)
    assert refused.returncode == 1 and message in refused.stderr


@pytest.mark.check
@pytest.mark.parametrize(
    ("name", "options", "period", "velocity"),
    [
        ("paper_derived/RRS-FN032.AT2", [], 1.25, 1.42),
        ("paper_derived/ERZ-FN032.AT2", [], 2.44, 0.67),
        ("paper/SCS052.AT2", ["--unit", "g", "--dt", "0.005"], 3.00, 0.80),
    ],
)
def test_pulses_are_those_of_the_literature(program, name, options, period, velocity):
    """T_p and v_p of Mavroeidis and Papageorgiou (2003), who fitted by trial in several steps."""
    path = ROOT.parent / "shared/records" / name
    if not path.exists():
        pytest.skip(f"the record {path.name} may not be redistributed and is not at hand")
    printed = subprocess.run([program, "pulse", path, "--json", *options], check=True, capture_output=True, text=True).stdout
    fit = json.loads(printed)
    assert fit["shape"] == "gabor" and fit["r_squared"] > 0.5
    assert fit["period"] == pytest.approx(period, rel=0.1)
    assert fit["PGV"][1] == pytest.approx(velocity, rel=0.15)


def test_rotations_are_those_of_every_direction(program, tmp_path):
    """RotD50 and RotD100 of Boore (2010) from 180 rotated records in numpy, and one rotated record."""
    generator = np.random.default_rng(7)
    times = np.arange(0, 20, 0.01)
    pair = [generator.normal(size=(5, 1)) * np.sin(generator.uniform(2, 20, (5, 1)) * times + phase) for phase in (0.3, 1.9)]
    pair = [component.sum(axis=0) for component in pair]
    for name, samples in zip("ab", pair):
        np.savetxt(tmp_path / f"{name}.csv", np.column_stack([times, samples]), delimiter=",", header="t [s],a [m/s2]", comments="")
    command = [program, "record", tmp_path / "a.csv", "--transverse", tmp_path / "b.csv"]
    printed = subprocess.run([*command, "--json"], check=True, capture_output=True, text=True).stdout
    (content,) = json.loads(printed)["records"]
    angles = np.radians(np.arange(180))[:, None]
    rotated = pair[0] * np.cos(angles) + pair[1] * np.sin(angles)
    peaks = np.abs(rotated).max(axis=1)
    velocities = np.cumsum((rotated[:, 1:] + rotated[:, :-1]) * 0.005, axis=1)
    for percentile in (50, 100):
        found = content[f"RotD{percentile}"]
        assert found["PGA"] == pytest.approx(np.percentile(peaks, percentile), rel=1e-10)
        # The peaks of the velocity are between samples.
        assert found["PGV"] == pytest.approx(np.percentile(np.abs(velocities).max(axis=1), percentile), rel=2e-3)
    table = tmp_path / "r.csv"
    subprocess.run([*command, "--rotate", "30", "--csv", table], check=True, capture_output=True)
    samples = np.loadtxt(table, delimiter=",", comments=["#", "t"])[:, 1]
    np.testing.assert_allclose(samples, rotated[30], atol=1e-12)
