"""The block in space: the program's numbers to the last bit, outcomes, values, and what is refused."""

import copy
import pickle

import numpy as np
import pytest
import scipy.linalg
from conftest import RECORDS, ROOT, same

import rocking_block as rb

X, Y = RECORDS["np01002p_4225a_a.smc"], RECORDS["0111a.smc"]
STONE = {"width": 0.5, "depth": 0.8, "height": 2.0, "eta": 60.0}
SINE = rb.Pulse("one-sine", 4.0, 0.7)
FEET = [[-0.2, -0.3, 0.0], [0.25, -0.3, 0.0], [0.0, 0.35, 0.0], [0.2, 0.3, 0.002]]


def crossed():
    """Two components of equal length, of different records."""
    x, y = (rb.read_record(path) for path in (X, Y))
    count = min(len(x), len(y))
    return rb.Record(x.acceleration[:count], 0.005, "x"), rb.Record(y.acceleration[:count], 0.005, "y")


RUNS = {
    "a rectangle under two components": (
        STONE | {"friction": 0.4},
        {"scale": 2, "azimuth": 30, "duration": 12},
        "--width=0.5 --depth=0.8 --height=2 --eta=60 --friction=0.4 --scale=2 --azimuth=30 --duration=12".split(),
    ),
    "a circle under a pulse": (
        {"base": "circle", "feet": 12, "alpha": 0.2, "p": 2.0, "kappa": 0.5, "xi_h": 0.3},
        {"pulse": SINE, "azimuth": 15},
        "--base=circle --feet=12 --alpha=0.2 --p=2 --kappa=0.5 --xi-h=0.3 --pulse=one-sine --amplitude=4 --period=0.7 --azimuth=15".split(),
    ),
    "free motion": (
        {"depth_ratio": 1.5},
        {"tilt_x": 0.05, "tilt_y": -0.02, "twist": 0.1, "omega_z": 0.2, "duration": 2},
        "--depth-ratio=1.5 --tilt-x=0.05 --tilt-y=-0.02 --twist=0.1 --omega-z=0.2 --duration=2".split(),
    ),
}


@pytest.mark.parametrize("name", RUNS)
def test_a_run_is_that_of_the_program(name, rocking, tmp_path):
    parameters, options, said = RUNS[name]
    if "components" in name:
        components = dict(zip("xy", crossed()))
        for record in components.values():
            rows = zip((np.arange(len(record)) * record.dt).tolist(), record.acceleration.tolist())
            (tmp_path / f"{record.name}.csv").write_text("t [s],a [m/s2]\n" + "".join(f"{t!r},{a!r}\n" for t, a in rows))
        said = [*said, "--record", tmp_path / "x.csv", "--record-y", tmp_path / "y.csv"]
        options = options | {name: rb.read_record(tmp_path / f"{name}.csv") for name in "xy"}
    run = rb.BlockInSpace(**parameters).run(**options)
    table = rocking("simulate", *said)
    assert [f"{name} [{run.units[name]}]" for name in run.columns] == list(table)
    for name, column in table.items():
        assert same(run[name.split(" [")[0]], column), name
    summary = rocking.json("simulate", *said)
    assert summary["outcome"] == run.outcome and summary["end_time"] == run.end_time
    assert list(summary["peak"].values()) == list(vars(run.peak).values())
    assert summary["block"]["feet"] == run.block.feet.tolist()
    assert all(summary["block"][name] == getattr(run.block, name) for name in ("alpha", "alpha_edge", "p", "K", "C_h", "friction"))


def test_outcomes_are_those_of_single_runs():
    block = rb.BlockInSpace(**STONE | {"friction": 0.5})
    x, y = crossed()
    table = block.outcomes([x, y], y=[y, x], scale=[1, 3], azimuth=[0, 60], tolerance=1e-8, threads=2)
    assert len(table["outcome"]) == 8 and table["record"][:5].tolist() == ["x"] * 4 + ["y"]
    assert table["scale"][:4].tolist() == [1, 1, 3, 3] and table["azimuth"][:4].tolist() == [0, 60, 0, 60]
    run = block.run(x, y=y, scale=3, azimuth=60)
    assert table["outcome"][3] == run.outcome and table["end_time"][3] == run.end_time
    assert table["peak.tilt"][3] == run.peak.tilt and table["peak.slip"][3] == run.peak.slip
    assert table.units["peak.slip"] == "m" and table.units["azimuth"] == "deg"


def test_a_motion_along_y_turns_the_block_along_y():
    """A square block shaken along y is one shaken along x."""
    block = rb.BlockInSpace(alpha=0.2, p=2.0)
    x, y = (block.run(pulse=SINE, azimuth=azimuth) for azimuth in (0, 90))
    assert np.abs(x["tilt_x"] - y["tilt_y"]).max() < 1e-9 < x.peak.tilt and np.abs(y["tilt_x"]).max() < 1e-9


def test_feet_and_inertia_may_be_given():
    given = {"feet": FEET, "center_height": 0.9, "mass": 500.0, "omega_v": 150.0, "inertia_tensor": [150, 160, 60, 1, 2, -3]}
    block = rb.BlockInSpace(**given)
    assert block.feet.tolist() == pytest.approx(np.array(FEET)) and block.foot_names == ["1", "2", "3", "4"]
    assert block.inertia[0].tolist() == [150, 1, 2] and np.array_equal(block.inertia, block.inertia.T)
    assert block == rb.BlockInSpace(**given | {"feet": np.array(FEET)}) != block.replace(mass=501.0)
    run = block.run(pulse=SINE)
    assert {f"N_{foot}" for foot in block.foot_names} <= set(run.columns)
    assert run.to_frame().shape == (len(run), len(run.columns) - 1)


def test_a_file_of_feet_may_be_given(tmp_path):
    (tmp_path / "feet.csv").write_text("x [m],y [m],gap [m]\n" + "".join(f"{x},{y},{gap}\n" for x, y, gap in FEET))
    given = {"center_height": 0.9, "mass": 500.0, "omega_v": 150.0, "inertia_tensor": [150, 160, 60]}
    assert rb.BlockInSpace(feet=tmp_path / "feet.csv", **given) == rb.BlockInSpace(feet=FEET, **given)


def test_blocks_are_values():
    block = rb.BlockInSpace(**STONE)
    for other in (pickle.loads(pickle.dumps(block)), copy.copy(block), copy.deepcopy(block)):
        assert type(other) is rb.BlockInSpace and other == block and hash(other) == hash(block) and repr(other) == repr(block)
    with pytest.raises(AttributeError):
        block.alpha = 0.1


@pytest.mark.parametrize(
    "given, message",
    [
        ({"foundation": "rigid"}, 'foundation="rigid" is for a block in the plane; in space a block stands on feet'),
        ({"epsilon": 0.5}, "epsilon is for a block in the plane; in space feet land on their dashpots; expected xi_v"),
        ({"depth": 0.0}, "depth = 0; expected a length > 0 m"),
        ({"feet": 12}, "feet has no effect without base=\"circle\""),
        ({"feet": [[0, 1, 2, 3]]}, "feet: found a row of 4 numbers"),
        ({"depth": 1.0, "depth_ratio": 2.0}, "depth_ratio has no effect with depth"),
        ({"base": "hexagon"}, 'base = "hexagon"; expected one of "rectangle", "circle"'),
    ],
)
def test_a_wrong_parameter_is_named(given, message):
    with pytest.raises(ValueError) as error:
        rb.BlockInSpace(**given)
    assert message in str(error.value)


def test_an_unknown_parameter_is_named():
    with pytest.raises(TypeError, match="a block has no parameter colour"):
        rb.BlockInSpace(colour=1)


def test_components_that_do_not_belong_together_are_refused():
    block = rb.BlockInSpace(**STONE)
    x, y = crossed()
    slow = rb.Record(y.acceleration, 0.01)
    for given, message in [
        ({"x": x, "y": x}, "y has the samples of x; expected each component once"),
        ({"y": y}, "y without x; expected both horizontal components"),
        ({"x": x, "y": slow}, "y has a time step of 0.01 s; expected that of x, 0.005 s; Record.processed"),
        ({"vertical": x, "azimuth": 30.0}, "azimuth has no effect without a horizontal record or a pulse, which it turns"),
        ({"x": x, "y": rb.Record(y.acceleration[:-10], y.dt)}, f"y has {len(y.acceleration) - 10} samples; expected the {len(x.acceleration)}"),
        ({}, "nothing moves the block"),
        ({"x": x, "tilt_x": 2.0}, "tilt_x = 2; expected a tilt, with tilt_y, within 1.57 rad"),
    ]:
        with pytest.raises(ValueError) as error:
            block.run(**given)
        assert message in str(error.value)
    with pytest.raises(ValueError, match="found 2 of x, 1 of y; expected equal numbers"):
        block.outcomes([x, y], y=[x])


def test_a_component_alone_is_turned():
    """A motion along one line is one along y at an azimuth of 90°, in a run, in outcomes and in a sweep."""
    square = rb.BlockInSpace(width=0.4, depth=0.4, height=1.8, eta=60.0, xi_v=0.2)
    x, _ = crossed()
    along_x, along_y = (square.run(x, scale=2, azimuth=azimuth) for azimuth in (0, 90))
    np.testing.assert_allclose(along_y["tilt_y"], along_x["tilt_x"], atol=1e-9)
    assert np.abs(along_x["tilt_x"]).max() > 1e-3 and np.abs(along_y["tilt_x"]).max() < 1e-9
    found = square.outcomes(x, scale=2, azimuth=[0, 90], tolerance=1e-8)
    assert found["peak.tilt"].tolist() == [along_x.peak.tilt, along_y.peak.tilt]


def test_a_search_in_space_brackets_a_change(tmp_path):
    """The outcomes on both sides are those of runs, along x and along y, under a pulse and under a pair."""
    block = rb.BlockInSpace(width=0.4, depth=0.8, height=2.0, eta=60.0, xi_v=0.2)
    for azimuth in (0, 90):
        found = rb.search_overturning(block, pulse=SINE, azimuth=azimuth, points=15, resolution=1e-3)
        (_, below, first), (above, _, second) = found.stretches[:2]
        assert (first, second, found.least) == ("completed", "overturned", above) and above - below <= 1e-3
        outcomes = [
            block.outcomes(pulse=rb.Pulse("one-sine", amplitude, SINE.period), azimuth=azimuth)["outcome"][0] for amplitude in (below, above)
        ]
        assert outcomes == ["completed", "overturned"]
    x, y = crossed()
    found = rb.search_overturning(block, record=x, record_y=y, azimuth=20, points=15, resolution=1e-2)
    assert found.parameter == "scale [1]" and found.stretches[0][0] == 0
    for given, message in [
        ({"record": x, "pulse": SINE}, "expected either a pulse or a record"),
        ({"record_y": y, "pulse": SINE}, "record_y without record; expected both horizontal components"),
        ({"record": x, "record_y": x}, "record_y has the samples of record; expected each component once"),
    ]:
        with pytest.raises(ValueError, match=message):
            rb.search_overturning(block, **given)
    with pytest.raises(ValueError, match="azimuth is for a block in space; expected a BlockInSpace"):
        rb.search_overturning(rb.Block(alpha=0.2, p=2.0), pulse=SINE, azimuth=30)
    with pytest.raises(TypeError, match="expected a Block or a BlockInSpace"):
        rb.search_overturning("block", pulse=SINE)


def test_lengths_in_millimetres_are_doubted():
    with pytest.warns(UserWarning, match="the block is 600 m wide, 900 m deep and 2400 m high"):
        rb.BlockInSpace(width=600, depth=900, height=2400, eta=60)
    with pytest.warns(UserWarning, match="density of 0.002315 kg/m3"):
        rb.BlockInSpace(width=0.6, depth=0.9, height=2.4, eta=60, mass=0.003)


def test_an_object_in_space_is_assessed(tmp_path):
    """The numbers are those of a sweep and its curve."""
    study = pair(tmp_path)
    study["study"]["scales"] = [0.5, 1.0, 1.5, 2.0, 3.0]
    table = rb.sweep(study)
    lines = [
        "[study]\ndesign = 'grid'\nazimuths = [0, 40]\nscales = [0.5, 1.0, 1.5, 2.0, 3.0]\n[parameters]",
        *(f"{name} = {value}" for name, value in study["parameters"].items()),
        "[[records]]\nx = 'x.csv'\ny = 'y.csv'\n[assess]\ntitle = 'Stone'\npulse_periods = [0.5]",
        "states = [{ name = 'rocks', limit = 0.3 }]",
    ]
    (tmp_path / "study.toml").write_text("\n".join(lines))
    report = rb.assess(tmp_path / "study.toml")
    exceeded = (table["outcome"] == "overturned") | (table["peak.tilt/alpha"] > 0.3)
    assert report.numbers["states"][0]["runs"]["exceeded"] == exceeded.sum() > 0
    assert [direction["azimuth"] for direction in report.numbers["directions"]] == [0, 40]
    assert "directions.png" in report.files and "rolls over corners" in report.html


def pair(folder):
    """Files of two components, and a study of a block under them."""
    for record in crossed():
        rows = zip((np.arange(3000) * record.dt).tolist(), record.acceleration.tolist())
        (folder / f"{record.name}.csv").write_text("t [s],a [m/s2]\n" + "".join(f"{t!r},{a!r}\n" for t, a in rows))
    return {
        "study": {"design": "grid", "azimuths": [0, 40], "scales": [1.5, 3.0], "periods": [0.3, 1.0]},
        "parameters": {"width": 0.4, "depth": 0.6, "height": 1.8, "eta": 60.0, "friction": 0.5},
        "records": [{"x": str(folder / "x.csv"), "y": str(folder / "y.csv")}],
    }


def test_a_sweep_has_the_outcomes_of_the_block(tmp_path):
    """Both have the columns of measures and of runs, with the same units, and the same bits."""
    table = rb.sweep(pair(tmp_path))
    block = rb.BlockInSpace(width=0.4, depth=0.6, height=1.8, eta=60.0, friction=0.5)
    x, y = (rb.read_record(tmp_path / f"{name}.csv") for name in "xy")
    outcomes = block.outcomes(x, y=y, scale=[1.5, 3.0], azimuth=[0, 40], periods=[0.3, 1.0])
    of_runs = list(table)[list(table).index("PGA.larger") :]
    assert of_runs == list(outcomes)[list(outcomes).index("PGA.larger") :] and len(of_runs) == 32 + 18
    assert {"record", "record_y", "azimuth", "scale"} <= set(table) & set(outcomes)
    # A study changes its strength faster than its direction.
    order = [0, 2, 1, 3]
    assert table["scale"].tolist() == outcomes["scale"][order].tolist() and table["azimuth"].tolist() == outcomes["azimuth"][order].tolist()
    for name in of_runs:
        assert table[name].tolist() == outcomes[name][order].tolist(), name
        assert table.units.get(name) == outcomes.units.get(name), name


def oscillator(acceleration, dt, period):
    """Peak pseudo-acceleration and velocity of an oscillator with 5 % damping, by the exact transition over a step of a linear input."""
    frequency = 2 * np.pi / period
    # Displacement, velocity, input and its rate.
    system = np.array([[0, 1, 0, 0], [-(frequency**2), -0.1 * frequency, -1, 0], [0, 0, 0, 1], [0, 0, 0, 0]])
    fine = 10
    step = scipy.linalg.expm(system * dt / fine)
    displacement = velocity = 0.0
    state = np.zeros(4)
    padded = np.append(acceleration, np.zeros(int(2 * period / dt)))
    for now, after in zip(padded[:-1], padded[1:]):
        state[2:] = now, (after - now) / dt
        for _ in range(fine):
            state = step @ state
            displacement, velocity = max(displacement, abs(state[0])), max(velocity, abs(state[1]))
    return frequency**2 * displacement, velocity


def test_spectral_measures_of_pairs_are_those_of_their_definition(tmp_path):
    table = rb.sweep(pair(tmp_path))
    x, y = (rb.read_record(tmp_path / f"{name}.csv") for name in "xy")
    for period in (0.3, 1.0):
        # Directions in steps of 15 degrees bound the median, and nearly have the greatest.
        angles = np.radians(np.arange(0, 180, 15))
        found = [oscillator(x.acceleration * np.cos(angle) + y.acceleration * np.sin(angle), x.dt, period) for angle in angles]
        for place, name in enumerate(("Sa", "Sv")):
            values = 1.5 * np.array([peaks[place] for peaks in found])
            along, across = values[0], values[6]
            measure = f"{name}({period:g} s)"
            assert table[f"{measure}.larger"][0] == pytest.approx(max(along, across), rel=2e-3)
            assert table[f"{measure}.geomean"][0] == pytest.approx(np.sqrt(along * across), rel=2e-3)
            assert table[f"{measure}.RotD100"][0] == pytest.approx(values.max(), rel=0.03)
            assert table[f"{measure}.RotD50"][0] == pytest.approx(np.median(values), rel=0.03)
    # All grow with the factor on the records.
    assert table["Sa(1 s).RotD50"][1] == pytest.approx(2 * table["Sa(1 s).RotD50"][0], rel=1e-12)


def test_fragility_in_space_has_its_own_limits():
    table = rb.sweep(ROOT / "examples/space/study.toml")
    for limit, word in ((0.7, "tilt/alpha>0.7"), ("tilt:0.7", "tilt/alpha>0.7"), ("balance", "tilt/alpha>1"), ("twist:0.02", "twist>0.02"), ("drift:0.1", "drift>0.1")):
        fit = rb.fragility(table, "PGV.RotD50", limit=limit)
        column = {"tilt/alpha": "peak.tilt/alpha", "twist": "peak.twist", "drift": "peak.drift"}[word.split(">")[0]]
        exceeded = (table[column] > float(word.split(">")[1])) | (table["outcome"] == "overturned")
        assert fit.limit == word and word in repr(fit) and fit.exceeded == exceeded.sum()
        assert "the only motion" in fit.independence
    former = {name: table[name] for name in table} | {"peak.tilt/alpha_edge": table["peak.tilt/alpha"]}
    for evaluate in (rb.fragility, rb.ida):
        with pytest.raises(ValueError, match="found the column peak.tilt/alpha_edge, of a former release; expected only peak.tilt/alpha"):
            evaluate(former, "PGV.RotD50")
    found = rb.ida(table, "PGV.RotD50")
    assert found.rotation == "tilt over that of the balance" and len(found.curves) == 12


def test_a_run_is_drawn(tmp_path):
    """Curves of each of four feet, the range of more, and no ground where none moves."""
    pyplot = pytest.importorskip("matplotlib.pyplot")
    run = rb.BlockInSpace(**STONE).run(pulse=SINE, azimuth=30, duration=2)
    panels = run.plot()
    assert [panel.get_ylabel().partition(" ")[0] for panel in panels] == ["tilt", "twist", "N/(M", "slip", "ground"]
    tilt, _, forces, *_ = panels
    assert np.array_equal(tilt.lines[0].get_ydata(), run["tilt/alpha"])
    assert [line.get_label() for line in forces.lines[:4]] == run.block.foot_names
    assert sum(line.get_ydata()[0] for line in forces.lines[:4]) == pytest.approx(1.0)
    panels = rb.BlockInSpace(base="circle", feet=6, alpha=0.2, p=2.0, eta=60).run(tilt_x=0.05, duration=1).plot()
    assert len(panels) == 4 and len(panels[2].collections) == 1
    panels[0].figure.savefig(tmp_path / "run.png")
    pyplot.close("all")


def test_notebooks_show_a_block_as_its_sketch():
    sketch = rb.BlockInSpace(**STONE)._repr_svg_()
    assert sketch.startswith("<svg") and "depth = 0.8 m" in sketch and "2h = 2 m" in sketch
    assert "2h" not in rb.BlockInSpace(width=0.5, center_height=0.9, eta=60.0)._repr_svg_()
