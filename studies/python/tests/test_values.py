"""Blocks, records and pulses as values; invalid arguments and their messages."""

import copy
import dataclasses
import inspect
import multiprocessing
import pickle
import re
import subprocess
import sys

import numpy as np
import pytest
from conftest import ROOT

import rocking_block as rb

VALUES = [
    rb.Block(alpha=0.2, p=1.5, eta=60, xi_v=0.1),
    rb.Block(width=0.8, height=3.2, K=1e7, C=4e4, mass=4000, epsilon=0.3),
    rb.Block(alpha=0.2, foundation="rigid", restitution_factor=0.9),
    rb.Record([0.0, 1.0, -1.0], 0.01, "name", 2.0),
    rb.Pulse("c2", 3.0, 1.2, 0.5),
]


@pytest.mark.parametrize("value", VALUES, ids=lambda value: type(value).__name__)
def test_values_are_copied_pickled_and_compared(value):
    for other in (pickle.loads(pickle.dumps(value)), copy.copy(value), copy.deepcopy(value)):
        assert type(other) is type(value)
        assert other == value and hash(other) == hash(value) and repr(other) == repr(value)
    assert sum(value == other for other in VALUES) == 1
    assert value != 1


@pytest.mark.parametrize("value", VALUES, ids=lambda value: type(value).__name__)
def test_values_cannot_be_changed(value):
    for name in ("alpha", "dt", "shape", "something"):
        with pytest.raises(AttributeError):
            setattr(value, name, 1.0)
    record = VALUES[3]
    with pytest.raises(ValueError, match="read-only"):
        record.acceleration[0] = 1.0


def peak(block):
    return block.run(pulse=rb.Pulse("one-sine", 6.0, 1.25)).peak.theta


def test_blocks_go_to_other_processes():
    blocks = rb.blocks(alpha=0.25, p=[1.0, 1.3])
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        assert pool.map(peak, blocks) == [peak(block) for block in blocks]


def test_results_are_pickled():
    run = rb.Block().run(theta=0.1, duration=1.0)
    other = pickle.loads(pickle.dumps(run))
    assert np.array_equal(other.theta, run.theta) and other.events == run.events and other.peak == run.peak
    table = rb.spectrum(alpha=0.25, p=[1, 2], pulse=rb.Pulse("one-sine", 6.0, 1.25))
    assert pickle.loads(pickle.dumps(table)) == table
    assert table != rb.spectrum(alpha=0.25, p=[1, 3], pulse=rb.Pulse("one-sine", 6.0, 1.25)) and table != 1


def test_the_version_is_that_of_the_project():
    (version,) = re.findall(r'^version = "(.*)"$', (ROOT / "Cargo.toml").read_text(), re.MULTILINE)
    assert rb.__version__ == version


def test_the_constructor_lists_the_parameters_of_the_engine():
    """An editor offers the names that the engine takes; their defaults are those of a block without any."""
    listed = inspect.signature(rb.Block).parameters
    assert set(listed) == {*rb.Block._names(), "foundation", "ties", "dampers"}
    given = {name: parameter.default for name, parameter in listed.items() if parameter.default is not None}
    assert rb.Block(**given) == rb.Block()


def test_ties_and_dampers_have_the_numbers_of_the_engine():
    numbers = dict(rb._engine.link_numbers())
    assert {field.name for field in dataclasses.fields(rb.Tie)} == set(numbers)
    assert set(numbers) - {field.name for field in dataclasses.fields(rb.Damper)} == {"pretension", "slack"}
    assert numbers["damping"] == "N.s/m"


def test_a_block_amounts_to_what_the_paper_says():
    block = rb.Block(alpha=0.25, p=1.0, eta=40, xi_v=0.1, epsilon=0.4)
    R0 = 0.75 * 9.81
    assert np.isclose(block.R0, R0, rtol=1e-15)
    assert np.isclose(block.K, 1000 * 40**2 / 2, rtol=1e-15)
    assert np.isclose(block.C, 0.1 * 1000 * 40, rtol=1e-15)
    assert np.isclose(block.delta_s, 9.81 / 40**2, rtol=1e-15)
    assert np.isclose(block.I0, 1000 * R0**2 / 3, rtol=1e-15)
    assert np.isclose(block.e_max, 1 - 1.5 * np.sin(0.25) ** 2, rtol=1e-15)
    assert np.isclose(block.e, (1 + 3 * 0.4 + 0.6 * 3 * np.cos(0.5)) / 4, rtol=1e-15)
    assert np.isclose(block.theta_separation, np.arcsin(4 / (3 * 40**2 * np.sin(0.25))), rtol=1e-14)
    sizes = {"width": block.width, "height": block.height, "K": block.K, "C": block.C}
    same = rb.Block(**sizes, mass=block.mass, epsilon=0.4)
    assert np.allclose([same.alpha, same.p, same.eta, same.xi_v], [0.25, 1.0, 40, 0.1], rtol=1e-14)
    rigid = block.replace(foundation="rigid")
    assert np.isnan([rigid.eta, rigid.xi_v, rigid.K, rigid.C]).all() and rigid.e == block.e


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"alpha": -1}, "alpha = -1 is not valid; expected 0 < alpha < pi/2 rad"),
        ({"epsilon": 2}, "epsilon = 2 is not valid; expected 0 <= epsilon <= 1"),
        ({"p": np.nan}, "p = NaN is not valid; expected a finite number > 0"),
        ({"foundation": "sand"}, 'foundation = "sand"; expected one of "viscoelastic", "rigid"'),
        ({"foundation": "rigid", "eta": 40}, "eta has no effect on a rigid base"),
        ({"restitution_factor": 1}, 'restitution_factor has no effect on viscoelastic supports; expected foundation="rigid"'),
        ({"width": 1}, "width without height; expected both, or center_height"),
        ({"width": 1, "height": 2}, 'width without eta, or K and C; expected the supports, or foundation="rigid"'),
        ({"width": 1, "height": 2, "eta": 40, "K": 1e6, "C": 1e3, "mass": 2}, "eta has no effect with K and C"),
        ({"width": 1, "alpha": 0.2}, "alpha has no effect with width"),
        ({"K": 1e6}, "K without C; expected both"),
        ({"C": 1e6}, "C without K; expected both"),
    ],
)
def test_a_block_that_is_none_is_refused(parameters, message):
    with pytest.raises(ValueError) as refused:
        rb.Block(**parameters)
    assert str(refused.value) == message


BLOCK = rb.Block(alpha=0.25, p=1.0)
PULSE = rb.Pulse("one-sine", 6.0, 1.25)
RECORD = rb.Record([0.0, 3.0, -3.0, 0.0], 0.5)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: BLOCK.run(), "nothing moves the block; expected a record, a pulse or an initial state"),
        (lambda: BLOCK.run(RECORD, scale=np.inf), "scale = inf; expected a finite factor"),
        (lambda: BLOCK.run(pulse=PULSE, scale=2.0), "scale has no effect without a record"),
        (lambda: BLOCK.replace(foundation="rigid").run(v=0.1), "v and v_dot have no effect on a rigid base"),
        (lambda: rb.spectrum(alpha=0.25, p=1.0, pulse=PULSE, threads=0), "threads = 0; expected a whole number from 1 to 1024"),
        (lambda: rb.search_overturning(BLOCK, pulse=PULSE, points=-1),
         "points = -1; expected a whole number from 2 to 10000000"),
        (lambda: BLOCK.run(theta=2.0), "theta = 2; expected a rotation within ±1.57 rad"),
        (lambda: BLOCK.run(RECORD, tolerance=0.0), "tolerance = 0; expected a number from 1e-14 to 0.1"),
        (lambda: rb.outcomes(BLOCK, RECORD, tolerance=5), "tolerance = 5; expected a number from 1e-14 to 0.1"),
        (lambda: BLOCK.run(RECORD, duration=-1.0), "duration = -1; expected a time > 0 s"),
        (lambda: BLOCK.run(RECORD, step=0.0), "step = 0; expected a time > 0 s"),
        (lambda: BLOCK.run(RECORD, step=1e-9, duration=1.0),
         "1 s in steps of 0.000000001 s are 1000000000 rows; expected at most 1e7, which need about 13 GB of memory"),
        (lambda: BLOCK.run(theta=0.1, step=1e-6, duration=36.0),
         "36 s in steps of 0.000001 s are 36000000 rows; expected at most 1e7, which need about 13 GB of memory"),
        (lambda: BLOCK.run(RECORD, on_separation="float"),
         'on_separation = "float"; expected one of "terminate", "hold", "fly"'),
        (lambda: BLOCK.run(pulse=rb.Pulse("c1", period=1.0)),
         "amplitude is missing; expected that of the pulse, a_p [m/s2]"),
        (lambda: rb.Pulse("square", 1.0), 'shape = "square"; expected one of "one-sine", "one-cosine", "c1", "c2", "half-sine", "rectangular", '
         '"symmetric-ricker", "antisymmetric-ricker", "gabor"'),
        (lambda: rb.Pulse("c1", 1.0, phase=0.5), 'phase has no effect without shape = "gabor"'),
        (lambda: rb.Pulse("gabor", 1.0, cycles=0.5), "cycles = 0.5; expected a number of at least 1"),
        (lambda: rb.Pulse("c1", 1.0, period=0.0), "period = 0; expected a time > 0 s"),
        (lambda: rb.Record([1.0], 0.01), "acceleration has 1 samples; expected at least two"),
        (lambda: rb.Record([1.0, np.nan], 0.01), "acceleration[1] = NaN; expected a finite number"),
        (lambda: rb.Record(np.zeros((2, 2)), 0.01), "acceleration has shape (2, 2); expected one dimension, of samples"),
        (lambda: rb.Record([0.0, 1.0], 0.0), "dt = 0; expected a time > 0 s"),
        (lambda: rb.spectrum(p=1.0), "nothing moves the ground; expected records or a pulse"),
        (lambda: rb.spectrum(p=[1.0, -1.0], pulse=PULSE), "p = -1 is not valid; expected a finite number > 0"),
        (lambda: rb.spectrum(p=1.0, eta=[40, 60], xi_v=[0.1, 0.2, 0.3], pulse=PULSE),
         "shapes do not broadcast: eta (2,), xi_v (3,)"),
        (lambda: rb.spectrum(p=1.0, eta=40, foundation="rigid", pulse=PULSE), "eta has no effect on a rigid base"),
        (lambda: rb.spectrum(p=1.0, scale=2.0, pulse=PULSE), "scale has no effect without records"),
        (lambda: rb.spectrum(p=1.0, records=[RECORD] * 2, vertical=[RECORD] * 3),
         "found 3 vertical and 2 horizontal records; expected equal numbers"),
        (lambda: rb.spectrum(p=1.0, records=[]), "records = []; expected at least one"),
        (lambda: rb.spectrum(alpha=0.25, p=1.0, pulse=PULSE, vertical=[]), "vertical = []; expected at least one"),
        (lambda: rb.spectrum(p=[], pulse=PULSE), "p = []; expected at least one"),
        (lambda: rb.spectrum(p=1.0, eta=[], pulse=PULSE), "eta = []; expected at least one"),
        (lambda: rb.outcomes([], RECORD), "blocks = []; expected at least one"),
        (lambda: rb.blocks(p=[1, 2], alpha=[0.1, 0.2, 0.3]), "shapes do not broadcast: p (2,), alpha (3,)"),
        (lambda: rb.Table({"p": [1.0, 2.0, 3.0]}, shape=(2, 2)), "shape = (2, 2) with 3 rows; expected an equal number of elements"),
        (lambda: rb.outcomes(BLOCK, RECORD, scale=[]), "scale = []; expected at least one factor"),
        (lambda: rb.spectrum(alpha=0.25, p=1.0, pulse=PULSE, step=1e-9), "step = 0.000000001; expected a time of at least 1e-6 s"),
        (lambda: rb.search_overturning(BLOCK), "expected either a pulse or a record, whose strength is searched for"),
        (lambda: rb.search_overturning(BLOCK, pulse=PULSE, from_=2.0, to=1.0), "to = 1; expected more than from_ = 2"),
        (lambda: rb.search_damping(BLOCK.replace(foundation="rigid")),
         "a rigid base has no damping; expected a block on viscoelastic supports"),
        (lambda: rb.sweep({"study": {"design": "grid"}, "parameters": {"epsilon": [0.1, 2.0]}}),
         "epsilon = 2; expected 0 to 1"),
        (lambda: rb.sweep({"study": {"design": 1j}}),
         "design = 1j in the study; expected numbers, texts, lists or dictionaries"),
    ],
)
def test_what_is_not_valid_is_refused(call, message):
    with pytest.raises(ValueError) as refused:
        call()
    assert str(refused.value) == message


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: BLOCK.run(pulse="one-sine"),
         """pulse = 'one-sine'; expected a Pulse, as in Pulse("one-sine", amplitude=3.0, period=1.2)"""),
        (lambda: rb.spectrum(p=1.0, pulse="C1"),
         """pulse = 'C1'; expected a Pulse, as in Pulse("one-sine", amplitude=3.0, period=1.2)"""),
        (lambda: BLOCK.run([0.0, 1.0]), "record has [0.0, 1.0]; expected a Record or the path of a file"),
        (lambda: rb.outcomes(BLOCK, [0.0, 1.0]), "records has 0.0; expected a Record or the path of a file"),
        (lambda: rb.search_overturning(BLOCK, record=3), "record has 3; expected a Record or the path of a file"),
        (lambda: rb.outcomes([0.2], RECORD), "blocks has 0.2; expected Blocks"),
        (lambda: BLOCK.run(RECORD, scale=[1, 2]), "scale = [1, 2]; expected a number"),
        (lambda: BLOCK.run(theta="0.1"), "theta = '0.1'; expected a number"),
        (lambda: rb.search_overturning(BLOCK, pulse=PULSE, tolerance="1e-6"), "tolerance = '1e-6'; expected a number"),
        (lambda: rb.Pulse("c1", "3"), "amplitude = '3'; expected a number"),
        (lambda: rb.Block(mass=1e3, ties=["a"]), "ties has 'a'; expected Ties"),
        (lambda: rb.Block(mass=1e3, ties=3), "ties has 3; expected Ties"),
        (lambda: rb.floor_motions(RECORD, None), "building = None; expected a Building"),
    ],
)
def test_what_is_of_another_type_is_refused(call, message):
    with pytest.raises(TypeError) as refused:
        call()
    assert str(refused.value) == message


def test_one_name_or_tie_needs_no_list():
    one, several = (BLOCK.run(pulse=PULSE, duration=1.0, gradients=names) for names in ("eta", ["eta"]))
    assert list(one.gradients) == ["eta"] and np.array_equal(one.gradients["eta"]["theta"], several.gradients["eta"]["theta"])
    tie = rb.Tie(block_z=1.0, ground_x=2.0, stiffness=1e5)
    assert rb.Block(mass=1e3, ties=tie) == rb.Block(mass=1e3, ties=[tie]) and rb.Block(ties=None).ties == ()
    assert [block.ties for block in rb.blocks(mass=1e3, p=[1.0, 2.0], ties=tie)] == [(tie,)] * 2


@pytest.mark.skipif(sys.platform != "linux", reason="limits the addresses of a process")
def test_rows_beyond_the_memory_are_a_memory_error():
    code = """
import resource, rocking_block as rb
resource.setrlimit(resource.RLIMIT_AS, (3 << 30, 3 << 30))
try:
    rb.Block().run(theta=0.1, step=1e-5, duration=36.0)
except MemoryError as error:
    print(error)
"""
    made = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    expected = "36 s in steps of 0.00001 s are 3600000 rows, for which the system does not provide about 4.7 GB of memory; expected"
    assert made.stdout.startswith(expected) and made.returncode == 0, made.stderr


def test_words_may_be_in_any_case():
    assert rb.Pulse("One-Sine", 6.0, 1.25) == rb.Pulse("OneSine", 6.0, 1.25) == PULSE and rb.Pulse("C2", 1.0) == rb.Pulse("c2", 1.0)
    rigid = BLOCK.replace(foundation="Rigid")
    assert rigid == rb.Block(alpha=0.25, p=1.0, foundation="RIGID") and rigid.replace(foundation="Viscoelastic").foundation == "viscoelastic"
    ends = [BLOCK.run(pulse=PULSE, on_separation=word, on_overturning="Hold", duration=2.0) for word in ("fly", "FLY")]
    assert np.array_equal(ends[0].theta, ends[1].theta)
    tables = [rb.spectrum(alpha=0.25, p=1.0, pulse=PULSE, foundation=word) for word in ("rigid", "Rigid")]
    assert tables[0] == tables[1] and tables[0]["foundation"][0] == "rigid"


def test_a_block_flies_by_default_everywhere():
    block, pulse = rb.Block(alpha=0.3, p=2.5, eta=80, epsilon=0.4), rb.Pulse("one-cosine", 14.0, 0.5)
    assert block.run(pulse=pulse, on_separation="terminate").outcome == "separated"
    run, table = block.run(pulse=pulse, tolerance=1e-6, step=1e4), rb.outcomes(block, pulse=pulse)
    assert table["flights"][0] > 0 and run.outcome == table["outcome"][0] != "separated"
    assert run.peak.theta / block.alpha == table["peak.theta/alpha"][0]


def test_supports_that_let_the_block_fall_over_are_warned_of():
    """At the smallest η the block rests at any tilt; one per cent above it stands, and below it falls."""
    least = np.sqrt(4 / 3 * np.cos(0.25)) / np.sin(0.25)
    assert rb.Block(alpha=0.25, p=1.0, eta=1.01 * least, xi_v=0.5).run(theta=1e-3, duration=30.0).peak.theta < 2e-3
    with pytest.warns(UserWarning, match="falls over by itself on supports of eta = 4.548.* expected eta > 4.594.* K > "):
        soft = rb.Block(alpha=0.25, p=1.0, eta=0.99 * least, xi_v=0.5)
    assert soft.run(theta=1e-3).outcome == "overturned"
    with pytest.warns(UserWarning, match="falls over by itself"):
        rb.spectrum(alpha=0.25, p=1.0, eta=[40, 3], pulse=PULSE)


def test_accelerations_of_no_earthquake_are_warned_of():
    with pytest.warns(UserWarning, match=r"made up: the PGA is 150 m/s², 15.3 g; expected samples in m/s²"):
        rb.Record([0.0, 150.0, 0.0], 0.01, "made up")
    with pytest.warns(UserWarning, match=r"made up: the PGA is 135 m/s², 15 g; expected samples in m/s²"):
        rb.Record([0.0, 15.0, 0.0], 0.01, "made up", unit="g", g=9.0)
    with pytest.warns(UserWarning, match=r"made up: the PGA is 50 m/s²"):
        rb.Record([0.0, 50.0, 0.0], 0.01, "made up")
    with pytest.raises(ValueError, match=r"made up: the PGA is 250 m/s², 25.5 g, with unit = 'm/s2'; expected at most 20 g"):
        rb.Record([0.0, 250.0, 0.0], 0.01, "made up")
    with pytest.warns(UserWarning, match=r"amplitude = 200 m/s² is 20.4 g; expected m/s²"):
        rb.Pulse("c1", 200.0)


def test_a_pulse_before_the_start_is_warned_of_where_nothing_else_moves_the_ground():
    early = rb.Pulse("one-sine", 6.0, period=0.5, start=-2.0)
    with pytest.warns(UserWarning, match=r"the pulse ends at -1.5 s, before the run starts at 0 s") as found:
        BLOCK.run(pulse=early, theta=0.1, duration=1.0)
    assert found[0].filename == __file__
    with pytest.warns(UserWarning, match=r"the pulse ends at -1.5 s, before the run starts at 0 s") as found:
        rb.outcomes(BLOCK, pulse=early)
    assert found[0].filename == __file__
    # A record begins with it.
    assert BLOCK.run(RECORD, pulse=early, duration=1.0)["t"][0] == -2.0


def test_a_block_beyond_reason_is_warned_of():
    with pytest.warns(UserWarning, match=r"the block is 600 m wide and 2400 m high .* expected 0.001 to 200 m"):
        rb.Block(width=600.0, height=2400.0, foundation="rigid")


def test_records_may_be_files_and_come_one_by_one(path):
    read = rb.read_record(path)
    assert BLOCK.run(path, duration=1.0).peak == BLOCK.run(read, duration=1.0).peak
    assert rb.outcomes(BLOCK, (record for record in (RECORD, read)), duration=1.0).shape == (2,)


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(FileNotFoundError, match="missing.AT2: cannot be read"):
        rb.read_record(tmp_path / "missing.AT2")
    with pytest.raises(OSError, match="cannot be read"):
        rb.read_record(tmp_path)
    with pytest.raises(FileNotFoundError):
        rb.sweep(tmp_path / "missing.toml")
    file = tmp_path / "two.csv"
    file.write_text("0.1\n0.2\n0.3\n")
    with pytest.raises(ValueError, match="expected dt "):
        rb.read_record(file, unit="g")
    with pytest.raises(ValueError, match=r'found unit "furlong", expected one of g, m/s2'):
        rb.read_record(file, dt=0.01, unit="furlong")
    with pytest.raises(ValueError, match="channel = -1; expected a whole number from 1"):
        rb.read_record(file, dt=0.01, unit="g", channel=-1)
    with pytest.raises(ValueError, match="channel has no effect without a file of several channels"):
        rb.read_record(file, dt=0.01, unit="g", channel=1)
    read = rb.read_record(file, dt=0.01, unit="g", g=10.0)
    assert np.array_equal(read.acceleration, 10.0 * np.array([0.1, 0.2, 0.3])) and read.dt == 0.01


def test_arguments_broadcast():
    made = rb.spectrum(p=[[1.0, 2.0, 3.0]], eta=[[40], [80]], xi_v=[0.1, 0.4], pulse=PULSE)
    assert made.shape == (2, 2, 1, 3)
    assert made["eta"].reshape(made.shape)[1, 0, 0, 2] == 80 and made["xi_v"].reshape(made.shape)[1, 0, 0, 2] == 0.1
    assert rb.spectrum(alpha=0.25, p=1.0, pulse=PULSE).shape == ()
    assert rb.spectrum(p=[1.0], records=[RECORD, RECORD], vertical=[RECORD, RECORD], scale=[1, 2, 3]).shape == (2, 3, 1)
    blocks = rb.blocks(alpha=[[0.1], [0.2]], p=[1.0, 2.0, 3.0], foundation=["viscoelastic", "rigid", "rigid"])
    assert [(block.alpha, block.p, block.foundation) for block in blocks[2:5]] == [
        (0.1, 3.0, "rigid"), (0.2, 1.0, "viscoelastic"), (0.2, 2.0, "rigid")]
    table = rb.outcomes(blocks, pulse=PULSE)
    assert table["foundation"].tolist() == ["viscoelastic", "rigid", "rigid"] * 2
    assert np.isnan(table["eta"][1]) and table["eta"][0] == 40


def test_records_are_distinguished():
    named = rb.Record(RECORD.acceleration, RECORD.dt, "quake")
    table = rb.outcomes(BLOCK, [RECORD, named, RECORD, named], scale=[1, 2])
    unnamed = table["record"][0]
    # Equal contents are one record, in this table and in others.
    assert unnamed.startswith("record ") and table["record"].tolist() == [unnamed, unnamed, "quake", "quake"] * 2
    assert table["scale"].tolist() == [1, 2] * 4
    other = rb.Record(2 * RECORD.acceleration, RECORD.dt, "quake")
    names = rb.outcomes(BLOCK, [rb.Record(other.acceleration, RECORD.dt), RECORD, named, other])["record"].tolist()
    assert len(set(names)) == 4 and names[1] == unnamed and names[0] != unnamed
    assert all(name.startswith("quake (") for name in names[2:])


def test_equal_records_and_great_scales_are_warned_of():
    twins = [rb.Record(RECORD.acceleration, RECORD.dt, name) for name in ("a", "b")]
    with pytest.warns(UserWarning, match="a and b hold the same samples: intervals count them as one motion"):
        table = rb.outcomes(BLOCK, twins, scale=[1, 2])
    assert table["record"].tolist() == ["a", "a", "b", "b"] and table["motion"].tolist() == ["a"] * 4
    titles = [f"Quake-01, 1/17/1994, Station {station}, {component}" for station, component in (("A", "090"), ("A", "UP"), ("B", "090"))]
    named = [rb.Record((1 + i) * RECORD.acceleration, RECORD.dt, title) for i, title in enumerate(titles)]
    # The names tell these motions.
    assert "motion" not in rb.outcomes(BLOCK, named)
    with pytest.warns(UserWarning, match="a is given more than once: its rows are made and counted as often"):
        rb.outcomes(BLOCK, [twins[0]] * 3)
    with pytest.raises(ValueError, match=r"scale = \[1, 2, 1\]; expected each factor once"):
        rb.outcomes(BLOCK, RECORD, scale=[1, 2, 1])
    with pytest.warns(UserWarning, match="each record is scaled by up to 30.0; expected at most 20, beyond which noise is amplified"):
        rb.outcomes(BLOCK, RECORD, scale=[1, -30])


def test_files_of_velocities_are_warned_of(tmp_path):
    velocities = tmp_path / "v.txt"
    velocities.write_text("".join(f"{np.sin(0.02 * i):.4f}\n" for i in range(1000)))
    with pytest.warns(UserWarning, match=r"v.txt: its columns have no names, and the mean frequency is 0.32 Hz"):
        rb.read_record(velocities, dt=0.01, unit="m/s2")
    (tmp_path / "study.toml").write_text('[study]\ndesign = "grid"\n[[records]]\nhorizontal = "v.txt"\ndt = 0.01\nunit = "m/s2"\n')
    with pytest.warns(UserWarning, match=r"v.txt: its columns have no names, and the mean frequency is 0.32 Hz"):
        rb.sweep(tmp_path / "study.toml")


def test_a_run_that_fails_is_named():
    wild = rb.Record(np.array([0.0, 1.0, -1.0, 1.0]), 0.01)
    with pytest.raises(ValueError, match="the motion is not finite after t = "):
        BLOCK.run(wild, scale=1e300)
    with pytest.warns(RuntimeWarning, match=r"2 of 2 runs failed, the first in row 0: the motion is not finite"):
        table = rb.spectrum(p=[1.0, 2.0], records=wild, scale=1e300)
    assert set(table["outcome"]) == {"failed"}


def test_a_record_has_its_measures():
    """A sine of one period of 2 s and amplitude 3: PGA 3, PGV = 2 · 3/π by the trapezoidal rule to 1e-5."""
    t = np.arange(0, 2.0005, 0.001)
    record = rb.Record(3 * np.sin(np.pi * t), 0.001)
    assert np.isclose(record.pga, 3.0, rtol=1e-6) and np.isclose(record.pgv, 6 / np.pi, rtol=1e-5)
    measures = rb.intensity(record, [0.005])
    assert measures["PGA"] == record.pga and measures["PGV"] == record.pgv
    assert np.isclose(measures["Sa(0.005 s)"], 3.0, rtol=1e-3)
    assert np.isclose(measures["Arias"], np.pi / (2 * 9.81) * 9.0, rtol=1e-5)
    assert np.array_equal(record.t, 0.001 * np.arange(2001)) and record.duration == 2000 * 0.001
    assert record.scaled(-2).pga == 2 * record.pga
