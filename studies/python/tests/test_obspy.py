"""Traces of ObsPy: units from responses, gaps, and files that ObsPy reads."""

import warnings

import numpy as np
import pytest

import rocking_block as rb

pytestmark = pytest.mark.check
obspy = pytest.importorskip("obspy")

COUNTS = np.round(1000 * np.sin(np.arange(0, 20, 0.1)) * np.exp(-0.01 * np.arange(200))).astype(np.int32)
SENSITIVITY = 2.0e5


def trace(data=COUNTS, units=None, sensitivity=SENSITIVITY, **header):
    """Returns a trace, with the response of a sensor of these units."""
    from obspy.core.inventory.response import Response

    made = obspy.Trace(np.array(data) if not isinstance(data, np.ma.MaskedArray) else data)
    made.stats.update({"network": "XX", "station": "ABC", "channel": "HNE", "delta": 0.01, **header})
    made.stats.starttime = obspy.UTCDateTime(2024, 8, 8, 16, 43, 15)
    if units:
        made.stats.response = Response.from_paz([], [], SENSITIVITY, input_units=units, output_units="COUNTS")
        made.stats.response.instrument_sensitivity.value = sensitivity
    return made


def test_a_named_unit_is_that_of_the_samples():
    for unit, factor in [("m/s2", 1.0), ("gal", 0.01), ("mm/s2", 0.001), ("g", 9.81)]:
        record = rb.Record.from_obspy(trace(COUNTS / 1000), unit=unit)
        assert np.array_equal(record.acceleration, COUNTS / 1000 * factor)
        assert (record.dt, record.start, record.name) == (0.01, 0.0, "XX.ABC..HNE 2024-08-08T16:43:15.000000Z")
    assert rb.Record.from_obspy(trace(COUNTS / 1000), unit="g", g=9.80665).pga == np.abs(COUNTS / 1000 * 9.80665).max()
    with pytest.raises(ValueError, match="no response with a sensitivity; expected unit="):
        rb.Record.from_obspy(trace())
    with pytest.raises(ValueError, match=r"no response with a sensitivity, and stats.calib = 0.25; expected unit="):
        rb.Record.from_obspy(trace(calib=0.25))
    with pytest.raises(ValueError, match="expected at most 20 g"):
        rb.Record.from_obspy(trace(), unit="m/s2")


def test_only_traces_and_streams_are_taken():
    for given in [5, None, "event.mseed", obspy.Stream([trace()])]:
        with pytest.raises(TypeError, match="expected a Trace of ObsPy; records_from takes a Stream"):
            rb.Record.from_obspy(given)
    for given in [5, None, "event.mseed"]:
        with pytest.raises(TypeError, match="expected a Stream of ObsPy or a list of traces"):
            rb.records_from(given)
    with pytest.raises(TypeError, match="expected a Trace of ObsPy"):
        rb.records_from([1, 2])


def test_a_response_states_the_unit():
    warnings.filterwarnings("ignore", "ObsPy can not map unit")
    for units, factor in [("M/S**2", 1.0), ("m/(s**2)", 1.0), ("CM/S**2", 0.01)]:
        record = rb.Record.from_obspy(trace(units=units))
        assert np.allclose(record.acceleration, COUNTS / SENSITIVITY * factor, rtol=1e-15, atol=0)
        removed = trace(units=units).remove_sensitivity()
        assert np.allclose(rb.Record.from_obspy(removed).acceleration, record.acceleration, rtol=1e-12, atol=0)
    with pytest.raises(ValueError, match=r"its sensor measures M/S; expected M/S\*\*2, or trace.remove_response\(output='ACC'\)"):
        rb.Record.from_obspy(trace(units="M/S"))
    with pytest.raises(ValueError, match="the sensitivity of its response is 0.0; expected a number other than 0"):
        rb.Record.from_obspy(trace(units="M/S**2", sensitivity=0.0))
    with pytest.raises(ValueError, match="its samples were differentiated or integrated; expected unit="):
        rb.Record.from_obspy(trace(units="M/S**2").remove_sensitivity().integrate())
    # A response from elsewhere leaves only its removal in the trace.
    removed = trace(units="M/S**2").remove_response(output="ACC")
    del removed.stats.response
    assert np.array_equal(rb.Record.from_obspy(removed).acceleration, removed.data)
    # The example of ObsPy is a velocity sensor.
    example = obspy.read()[0].detrend("demean")
    with pytest.raises(ValueError, match="its sensor measures M/S"):
        rb.Record.from_obspy(example)
    for output, refused in [("VEL", True), ("DISP", True), ("ACC", False)]:
        removed = example.copy().remove_response(output=output)
        if refused:
            with pytest.raises(ValueError, match=f"its response was removed with output='{output}'; expected output='ACC'"):
                rb.Record.from_obspy(removed)
        else:
            assert np.array_equal(rb.Record.from_obspy(removed).acceleration, removed.data)


def test_gaps_are_refused_with_their_place():
    values = np.ma.masked_array(COUNTS / 1000, mask=np.arange(200) // 3 == 20)
    place = "sample 60 at 2024-08-08T16:43:15.600000Z is masked, the first of 3: a gap"
    with pytest.raises(ValueError, match=place):
        rb.Record.from_obspy(trace(values), unit="m/s2")
    assert len(rb.Record.from_obspy(trace(np.ma.masked_array(COUNTS / 1000)), unit="m/s2")) == 200
    with pytest.raises(ValueError, match=r"acceleration\[7\] = NaN; expected a finite number"):
        rb.Record.from_obspy(trace(np.where(np.arange(200) == 7, np.nan, 0.1)), unit="m/s2")

    whole = trace(COUNTS / 1000)
    start = whole.stats.starttime
    parts = obspy.Stream([whole.slice(endtime=start + 0.5), whole.slice(starttime=start + 0.7)])
    with pytest.raises(ValueError, match=r"XX.ABC..HNE: a gap of 0.19 s from 2024-08-08T16:43:15.5\d+Z to 2024-08-08T16:43:15.7"):
        rb.records_from(parts, unit="m/s2")
    # ObsPy fills the gap with masked samples.
    with pytest.raises(ValueError, match="sample 51 at .* is masked, the first of 19: a gap"):
        rb.records_from(parts.copy().merge(), unit="m/s2")
    meeting = obspy.Stream([whole.slice(endtime=start + 0.5), whole.slice(starttime=start + 0.51)])
    with pytest.raises(ValueError, match=r"two traces meet at .*; expected one, as stream.merge\(\) makes it"):
        rb.records_from(meeting, unit="m/s2")
    assert rb.records_from(meeting.merge(), unit="m/s2")[0] == rb.Record.from_obspy(whole, unit="m/s2")
    overlap = obspy.Stream([whole.slice(endtime=start + 0.5), whole.slice(starttime=start + 0.4)])
    with pytest.raises(ValueError, match=r"an overlap of 0.11 s from .*15.4\d+Z to .*15.5"):
        rb.records_from(overlap, unit="m/s2")


@pytest.mark.parametrize("format", ["MSEED", "SAC", "GSE2"])
def test_files_that_obspy_reads(format, tmp_path):
    other = trace(2 * COUNTS, channel="HNN")
    stream = obspy.Stream([trace(), other])
    if format == "SAC":
        stream = stream[:1]
    stream.write(str(tmp_path / "file"), format=format)
    found = rb.records_from(obspy.read(str(tmp_path / "file")), unit="mm/s2")
    assert [len(record) for record in found] == [200] * len(stream)
    for record, written in zip(found, stream):
        assert np.array_equal(record.acceleration, written.data * 0.001)
        assert record.dt == pytest.approx(0.01, rel=1e-6)
        assert written.stats.channel in record.name
