"""Units, processing, rotation and pulses of records."""

import pickle
import re

import numpy as np
import pytest

import rocking_block as rb
from conftest import ROOT

TIMES = np.arange(0, 20, 0.01)
A = rb.Record(np.sin(3 * TIMES) * np.sin(0.4 * TIMES) + 0.1, 0.01, "a")
B = rb.Record(2 * np.cos(5 * TIMES) * np.sin(0.4 * TIMES), 0.01, "b")


def test_samples_may_be_in_any_unit():
    samples = [0.0, 0.3, -0.2, 0.0]
    for unit, g, factor in [("g", 9.81, 9.81), ("g", 9.80665, 9.80665), ("cm/s2", 9.81, 0.01), ("gal", 9.81, 0.01), ("m/s2", 9.81, 1.0)]:
        record = rb.Record(samples, 0.01, unit=unit, g=g)
        assert np.array_equal(record.acceleration, np.array(samples) * factor)
        assert pickle.loads(pickle.dumps(record)) == record
    with pytest.raises(ValueError, match='found unit "ft", expected one of g, m/s2, cm/s2, gal'):
        rb.Record(samples, 0.01, unit="ft")
    with pytest.raises(ValueError, match="the PGA is 245.2 m/s², 25 g, with unit = 'g'; expected at most 20 g"):
        rb.Record([0.0, 25.0], 0.01, unit="g")


def test_masked_samples_are_refused():
    """numpy drops the mask of an array in silence, so that gaps become samples."""
    samples = np.ma.masked_array([0.0, 0.3, 9.0, 9.0, 0.1], mask=[0, 0, 1, 1, 0])
    with pytest.raises(ValueError, match="made up: sample 2 is masked, the first of 2: a gap; expected a value for each sample"):
        rb.Record(samples, 0.01, "made up")
    with pytest.raises(ValueError, match="acceleration: sample 2 is masked"):
        rb.Record(samples, 0.01)
    assert rb.Record(samples.filled(0.0), 0.01).pga == 0.3
    assert rb.Record(np.ma.masked_array([0.0, 0.3]), 0.01).pga == 0.3


def test_a_network_file_has_channels_by_name():
    file = ROOT / "lab/fuzz/seeds/knet.csv"
    with pytest.raises(ValueError, match=r"found 3 channels \(1: N-S, 2: E-W, 3: U-D\); expected channel 1 to 3 or a name"):
        rb.read_record(file)
    named = rb.read_record(file, channel="e-w")
    assert named == rb.read_record(file, channel=2) and named.name == "XYZ001, 2001/02/03 04:05:00, E-W"
    assert named.pga == pytest.approx(0.24, abs=1e-4)


def test_a_peak_other_than_the_header_s_is_doubtful(tmp_path):
    text = (ROOT / "lab/fuzz/seeds/knet.ew").read_text()
    (tmp_path / "a.ew").write_text(re.sub(r"(Max. Acc. \(gal\)   )\S+", r"\g<1>9.000", text))
    with pytest.warns(UserWarning, match=r"a.ew: the peak of the values is 0.2\d* cm/s², and line 15 states 9 cm/s²"):
        rb.read_record(tmp_path / "a.ew")


def test_a_layout_reads_fixed_widths(tmp_path):
    (tmp_path / "a.dat").write_text("TITLE\n   150 -1225 10000\n  -300    50\n")
    record = rb.read_record(tmp_path / "a.dat", layout="3F6.2", skip=1, value_scale=0.1, unit="m/s2", dt=0.01)
    assert np.allclose(record.acceleration, [0.15, -1.225, 10.0, -0.3, 0.05], rtol=1e-14) and record.name == "TITLE"
    with pytest.raises(ValueError, match='found layout "3Q6", expected an edit descriptor of Fortran'):
        rb.read_record(tmp_path / "a.dat", layout="3Q6")
    with pytest.raises(ValueError, match="skip = -1; expected a whole number from 0"):
        rb.read_record(tmp_path / "a.dat", layout="3F6.2", skip=-1)


def test_records_are_processed_in_order():
    scipy = pytest.importorskip("scipy.signal")
    found = A.processed(baseline=True, band_pass=(0.2, 20.0), resample=0.02)
    assert found.name == "a; baseline removed, band-pass 0.2 to 20 Hz, resampled every 0.02 s" and found.dt == 0.02
    sections = scipy.butter(4, (0.2, 20.0), "bandpass", fs=100, output="sos")
    padded = np.pad(scipy.detrend(A.acceleration), 3000)
    expected = scipy.sosfiltfilt(sections, padded, padtype=None)[3000:-3000][::2]
    assert np.abs(found.acceleration - expected).max() < 1e-9
    assert A.processed() == rb.Record(A.acceleration, 0.01, "a")
    with pytest.raises(ValueError, match="resampling from 0.01 to 0.02 s would alias; expected a band-pass"):
        A.processed(resample=0.02)


def test_components_are_rotated():
    turned = A.rotated(B, 30)
    expected = A.acceleration * np.cos(np.pi / 6) + B.acceleration * np.sin(np.pi / 6)
    np.testing.assert_allclose(turned.acceleration, expected, atol=1e-14)
    peaks = [A.rotated(B, angle).pga for angle in range(180)]
    for percentile in (0, 50, 100):
        found = rb.intensity(A, [0.5], transverse=B, percentile=percentile)
        assert found["PGA"] == pytest.approx(np.percentile(peaks, percentile), rel=1e-12)
        assert found.keys() == rb.intensity(A, [0.5]).keys()
    with pytest.raises(ValueError, match="the time step is 0.01 s and, in the transverse record, 0.02 s"):
        A.rotated(rb.Record([0.0, 1.0], 0.02), 10)


def test_a_planted_pulse_is_found():
    planted = rb.Pulse("gabor", amplitude=3.0, period=1.5, start=6.0, phase=1.0, cycles=1.8)
    noise = 0.6 * np.cos(31 * TIMES)
    fit = rb.fit_pulse(rb.Record(planted.acceleration(TIMES) + noise, 0.01))
    assert fit.r_squared > 0.98 and fit.pulse.shape == "gabor"
    for name in ("amplitude", "period", "start", "phase", "cycles"):
        assert getattr(fit.pulse, name) == pytest.approx(getattr(planted, name), rel=0.03)
    assert rb.fit_pulse(A, "C1").pulse.cycles == 2.0
    with pytest.raises(ValueError, match='shape = "rectangular"; expected one of "gabor", "one-sine"'):
        rb.fit_pulse(A, "rectangular")
    with pytest.raises(ValueError, match="no c1 pulse fits into the record of 0.01 s; expected a longer motion"):
        rb.fit_pulse(rb.Record([0.0, 1.0], 0.01), "c1")
