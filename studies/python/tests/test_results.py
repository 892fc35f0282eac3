"""Frames, files and pictures of results."""

import math
import pickle
import sys

import matplotlib.pyplot as plt
import numpy as np
import pytest

import rocking_block as rb

PULSE = rb.Pulse("one-sine", 6.0, 1.25)


def test_a_run_becomes_a_frame(record):
    run = rb.Block(alpha=0.15, p=2.5).run(record)
    frame = run.to_frame()
    assert frame.index.name == "t" and np.array_equal(frame.index, run.t)
    assert np.array_equal(frame["energy.total"], run.energy.total)
    assert np.array_equal(frame["regime"], run["regime"]) and run.regime.dtype == np.int8
    with pytest.raises(ValueError, match="read-only"):
        run.theta[0] = 1.0


def test_each_column_has_an_attribute_that_says_what_it_is():
    run = rb.Block().run(theta=0.1, duration=0.1)
    for name in run.columns:
        value = getattr(run.energy, name.removeprefix("energy.")) if name.startswith("energy.") else getattr(run, name)
        assert np.array_equal(value, run[name]), name


def test_a_table_becomes_a_frame_and_a_file(tmp_path):
    import pyarrow.parquet

    table = rb.spectrum(alpha=0.25, p=[1.0, 2.0], pulse=rb.Pulse("one-sine", 6.0, 1.25))
    assert table.to_frame()["outcome"].tolist() == table["outcome"].tolist()
    file = tmp_path / "table.parquet"
    table.to_parquet(file)
    read = pyarrow.parquet.read_table(file)
    assert read.column_names == list(table)
    assert np.array_equal(read["p"].to_numpy(), table["p"])
    assert read.schema.field("p").metadata[b"unit"] == b"rad/s"
    with pytest.raises(KeyError, match="there is no column 'q'; expected one of foundation, alpha"):
        table["q"]


def test_rows_of_a_table_are_chosen_by_masks_and_numbers():
    given = np.array([1.0, 2.0, 3.0])
    table = rb.Table({"p": given, "outcome": ["completed", "overturned", "completed"]}, {"p": "rad/s"}, (3, 1))
    stood = table[table["outcome"] == "completed"]
    assert stood["p"].tolist() == [1.0, 3.0] and stood.units == table.units and stood.shape == (2,)
    assert table[[2, 0]]["p"].tolist() == [3.0, 1.0] and table[1:].rows == 2 and table[[]].rows == 0
    with pytest.raises(TypeError, match="expected a column's name, or a mask or numbers of rows"):
        table[0]
    for change in (lambda: table.update(q=given), lambda: table.__setitem__("q", given), lambda: table.pop("p")):
        with pytest.raises(TypeError, match="a Table cannot be changed"):
            change()
    given[0] = 5.0
    with pytest.raises(ValueError, match="read-only"):
        table["p"][0] = 1.0
    with pytest.raises(ValueError, match=r"column 'p' has shape \(1, 3\); expected one dimension"):
        rb.Table({"p": [given]})


def test_columns_of_one_value_take_no_memory():
    """They are as others in all else, and a table of parts has the same values."""
    study = {"study": {"design": "grid"}, "parameters": {"foundation": "rigid", "alpha": 0.25, "p": {"from": 1.0, "to": 2.0, "count": 50},
             "pulse": {"shape": "one-sine", "amplitude": 6.0, "period": 1.0}}}
    table = rb.sweep(study)
    repeated = {name for name, column in table.items() if column.strides == (0,)}
    assert repeated >= {"foundation", "pulse.shape", "pulse.amplitude", "record", "scale", "PGA"}
    assert not repeated & {"p", "outcome", "end_time", "peak.theta/alpha"}
    assert set(table["foundation"]) == {"rigid"} and np.isnan(table["PGA"]).all() and (table["pulse.amplitude"] == 6.0).all()
    assert pickle.loads(pickle.dumps(table)) == table == rb.Table({name: np.array(column) for name, column in table.items()}, table.units)
    assert table.to_arrow()["pulse.amplitude"].to_pylist() == [6.0] * 50
    assert rb.sweep(study | {"parameters": study["parameters"] | {"p": 1.0}})["foundation"].tolist() == ["rigid"]


def test_pandas_takes_a_table():
    import pandas

    table = rb.spectrum(alpha=0.25, p=[1.0, 2.0], pulse=PULSE)
    assert pandas.DataFrame(table).equals(table.to_frame()) and list(table.to_frame()) == list(table)


@pytest.fixture
def figure():
    """A current figure, as made by a notebook's cell or plt.figure()."""
    return plt.figure(figsize=(6, 5))


def test_runs_are_drawn_on_the_current_figure_and_share_it(record, figure, tmp_path):
    block = rb.Block(alpha=0.15, p=2.5)
    panels = block.run(record, vertical=record, scale=2, duration=15).plot()
    assert [axes.figure for axes in panels] == [figure] * 3 and [len(axes.lines) for axes in panels] == [4, 2, 2]
    assert figure.get_size_inches().tolist() == [6, 5]
    block.run(record, duration=15).plot(label="weaker")
    assert plt.gcf() is figure and [len(axes.lines) for axes in panels] == [5, 4, 3]
    assert panels[0].lines[0].get_color() != panels[0].lines[-1].get_color()
    figure.savefig(tmp_path / "runs.png")


def test_a_run_is_drawn_on_the_given_axes(figure):
    """Free motion has no ground to draw; far rotations are cut, and the picture says so."""
    axes = figure.add_subplot()
    run = rb.Block(alpha=0.25, p=1, foundation="rigid").run(pulse=rb.Pulse("one-sine", 30.0, 1.0))
    assert run.plot(axes) is axes and len(figure.axes) == 1
    assert axes.get_ylim()[1] == 1.5 and "up to 6.28" in axes.texts[0].get_text()
    plt.figure()
    assert len(rb.Block().run(theta=0.1, duration=0.5).plot()) == 2 and len(figure.axes) == 1
    with pytest.raises(TypeError, match="expected one, two or three Axes of Matplotlib"):
        run.plot("axes")


def test_a_block_is_drawn_to_scale_with_its_dimensions(figure):
    block = rb.Block(width=0.8, height=3.2, K=1e7, C=4e4, mass=4000)
    axes = block.plot()
    assert axes.figure is figure and axes.get_aspect() == 1.0
    body = axes.patches[0]
    assert (body.get_x(), body.get_y(), body.get_width(), body.get_height()) == (-0.4, 0.0, 0.8, 3.2)
    texts = [text.get_text() for text in axes.texts]
    assert {"2b = 0.8 m", "2h = 3.2 m", "h = 1.6 m", "$α$ = 14.04°", "K", "C"} <= set(texts)
    assert "K = 1e+07 N/m" in texts[-1] and f"η = {block.eta:.4g}" in texts[-1]
    other = rb.Block(alpha=0.25, p=1, foundation="rigid").plot()
    assert other.figure is not figure and not {"K", "C"} & {text.get_text() for text in other.texts}
    assert "rigid base, e = 0.9082" in other.texts[-1].get_text()
    there = plt.figure().add_subplot()
    assert block.plot(ax=there) is there
    with pytest.raises(TypeError, match="expected Axes of Matplotlib"):
        block.plot("axes")


def test_a_sketch_shows_eccentricity_friction_and_ties(figure):
    """The arcs of the angles end on the lines to the centre of mass; a far anchor is broken off on its line."""
    near = rb.Tie(block_x=0.4, block_z=1.8, ground_x=1.0, stiffness=2.5e6, pretension=12e3)
    far = rb.Tie(block_x=-0.4, block_z=2.0, ground_x=-9.0, stiffness=2.5e6)
    size = {"width": 0.8, "center_height": 1.0, "mass": 500, "foundation": "rigid"}
    axes = rb.Block(**size, eccentricity=-0.1, friction=0.45, ties=[near, far]).plot()
    texts = [text.get_text() for text in axes.texts]
    assert {"$e_x$ = -0.1 m", "h = 1 m", "1", "2", r"$\alpha_L$ = 16.7°", r"$\alpha_R$ = 26.57°"} <= set(texts)
    assert "friction μ = 0.45" in texts[-1] and "tie 2: (-0.4, 2) to (-9, 0) m" in texts[-1]
    assert not any("2h" in text for text in texts), "the height of the body is not known"
    arcs = [patch for patch in axes.patches if type(patch).__name__ == "Arc"]
    angles = sorted(arc.theta2 - arc.theta1 for arc in arcs)
    assert np.allclose(angles, np.degrees([np.arctan(0.3), np.arctan(0.5)]))
    ends = [line.get_xydata()[-1] for line in axes.lines if line.get_color() == "#004488" and len(line.get_xdata()) == 2]
    assert np.allclose(ends[0], [1.0, 0.0]) and ends[1][0] > -4.0
    assert np.isclose((2.0 - ends[1][1]) / (-0.4 - ends[1][0]), 2.0 / 8.6)
    figure.canvas.draw()
    for text in axes.texts:
        box = text.get_window_extent()
        assert figure.bbox.contains(box.x0, box.y0) and figure.bbox.contains(box.x1, box.y1), text.get_text()
    outside = rb.Tie(block_x=3.0, block_z=20.0, ground_x=4.0, stiffness=2.5e6)
    axes = rb.Block(**size, ties=[outside]).plot()
    start, end = next(line.get_xydata() for line in axes.lines if line.get_color() == "#004488")
    assert axes.get_xlim()[1] > start[0] and axes.get_ylim()[1] > start[1] > 2.0, "an end outside the body is seen"


def test_tables_and_records_are_drawn(record, figure):
    axes = rb.spectrum(p=[1.0, 1.5, 2.0], eta=[40, 80], pulse=PULSE).plot(linewidth=2)
    assert axes.get_xlabel() == r"$2\pi/p$ [s]" and axes.figure is figure
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["eta = 40", "eta = 80", "overturned"]
    table = rb.outcomes(rb.blocks(alpha=0.15, p=[2.0, 3.0]), [record], scale=[1, 2, 4])
    points = table.plot("PGV", ax=figure.add_subplot())
    assert {line.get_marker() for line in points.lines} >= {"o"} and points.get_xlabel() == "PGV [m/s]"
    assert record.plot().figure is not figure
    study = {"study": {"design": "grid"}, "parameters": {"alpha": 0.25, "p": 1.0,
             "pulse": {"shape": "OneSine", "period": [1.0, 1.5], "amplitude": [4.0, 6.0]}}}
    axes = rb.sweep(study).plot(ax=plt.figure().add_subplot())
    assert axes.get_xlabel() == "pulse.period [s]" and axes.get_legend().get_texts()[1].get_text() == "pulse.amplitude = 6"
    with pytest.raises(ValueError, match="column 'outcome' has .* values; expected numbers"):
        table.plot("outcome")


def test_curves_are_blank_for_overturned_blocks_and_lanes_mark_these():
    table = rb.Table(
        {
            "p": [1.0, 2.0, 3.0, 4.0] * 2,
            "eta": [40.0] * 4 + [80.0] * 4,
            "outcome": ["completed", "completed", "overturned", "overturned"] + ["completed", "overturned", "failed", "completed"],
            "peak.theta/alpha": [0.3, 0.8, 6.3, 6.3, 0.2, 6.3, 0.4, 0.5],
            "flights": [0, 1, 0, 0, 0, 1, 0, 0],
        }
    )
    axes = table.plot(ax=plt.figure().add_subplot())
    curves = [line.get_ydata() for line in axes.lines if line.get_label().startswith("eta")]
    assert np.array_equal(curves, [[0.3, 0.8, np.nan, np.nan], [0.2, np.nan, np.nan, 0.5]], equal_nan=True)
    assert axes.get_ylim()[1] < 1.5 and not axes.texts, "no rotation is cut"
    assert axes.get_xlim()[0] < 1.0 and axes.get_xlim()[1] > 4.0
    names = ["eta = 40", "eta = 80", "complete separation", "overturned", "run failed"]
    assert [text.get_text() for text in axes.get_legend().get_texts()] == names
    black = [lane for lane in axes.collections if lane.get_linewidth() == 6 and np.all(lane.get_color()[0][:3] == 64 / 255)]
    parts = [[segment[:, 0].tolist() for segment in lane.get_segments()] for lane in black]
    assert parts == [[[2.5, 4.0]], [[1.5, 2.5]]], "neighbours are one part, without a seam"
    # A curve without a value is not in the legend.
    missing = rb.Table({**table, "peak.uplift": [np.nan] * 4 + [0.1] * 4})
    texts = missing.plot("p", "peak.uplift", ax=plt.figure().add_subplot()).get_legend().get_texts()
    assert [text.get_text() for text in texts] == ["eta = 80"]


def test_points_of_overturned_blocks_are_on_the_edge():
    table = rb.Table({"PGV": [0.1, 0.2, 0.2], "outcome": ["completed", "completed", "overturned"], "peak.theta/alpha": [0.3, 0.6, 6.3]})
    axes = table.plot("PGV", ax=plt.figure().add_subplot())
    assert [line.get_ydata().tolist() for line in axes.lines[:2]] == [[0.3, 0.6], [1.5]] and axes.get_ylim() == (0.0, 1.5)
    assert not axes.texts, "the rotation of an overturned block is no peak"


def test_outcomes_have_all_parameters_that_vary():
    pulse = rb.Pulse("one-sine", 4.0, 0.8)
    ties = [rb.Tie(block_z=3.0, ground_x=4.0, stiffness=2e5)]
    rigid = rb.blocks(alpha=0.2, p=2.0, foundation="rigid", friction=[0.1, 0.3])
    others = [rb.Block(alpha=0.2, p=2.0, mass=900, eccentricity=0.05, foundation="rigid", friction=0.3, ties=ties)]
    table = rb.outcomes([*rigid, *others], pulse=pulse)
    assert table["friction"].tolist() == [0.1, 0.3, 0.3] and table["mass"].tolist() == [1000, 1000, 900]
    assert table["eccentricity"].tolist() == [0, 0, 0.05] and table.units["eccentricity"] == "m"
    assert np.array_equal(table["tie_1.stiffness"], [np.nan, np.nan, 2e5], equal_nan=True) and table.units["tie_1.stiffness"] == "N/m"
    assert len({tuple(map(str, row)) for row in zip(*(table[name] for name in list(table)[:10]))}) == 3
    wide = [rb.Block(width=width, height=3.2, K=1e7, C=4e4, mass=4000) for width in (0.8, 0.9)]
    table = rb.outcomes(wide, pulse=pulse)
    assert table["width"].tolist() == [0.8, 0.9] and not {"height", "mass", "friction", "width"} & set(rb.outcomes(rigid[:1], pulse=pulse))
    scale = rb.outcomes(rigid, rb.Record([0.0, 1.0, -1.0, 0.0], 0.2), scale=[1.0, 2.0])
    assert scale["friction"].tolist() == [0.1, 0.3, 0.1, 0.3]
    curves = scale.plot("scale", ax=plt.figure().add_subplot()).get_legend().get_texts()
    assert [text.get_text() for text in curves] == ["friction = 0.1", "friction = 0.3"]


def test_no_limit_of_friction_is_none_and_sorts_last(rocking):
    free, low, high = blocks = rb.blocks(friction=[None, 0.05, 0.1])
    assert free == rb.Block() == rb.Block(friction=math.inf) and free.friction == math.inf and "friction" not in repr(free)
    assert pickle.loads(pickle.dumps(blocks)) == blocks and high.replace(friction=None) == free
    pulse = rb.Pulse("one-sine", 5.0, 1.0)
    table = rb.outcomes(blocks, pulse=pulse, progress=False)
    study = {"study": {"design": "grid"}, "parameters": {"friction": ["none", 0.05, 0.1], "pulse": {"shape": "one-sine", "amplitude": 5.0}}}
    for found in (table, rb.sweep(study, progress=False)):
        assert found["friction"].tolist() == [math.inf, 0.05, 0.1] and found["peak.slip"].tolist() == table["peak.slip"].tolist()
    assert table["peak.slip"][0] == 0 and table["peak.slip"][1] > table["peak.slip"][2] > 0
    assert not hasattr(free.run(pulse=pulse, duration=0.1), "slip") and hasattr(low.run(pulse=pulse, duration=0.1), "slip")
    spectra = [rb.spectrum(p=[1, 2], pulse=pulse, friction=friction, progress=False) for friction in (None, math.inf, 0.05)]
    assert spectra[0] == spectra[1] and "peak.slip" not in spectra[0] and "peak.slip" in spectra[2]
    for make in (rb.Block, rb.blocks, lambda friction: rb.spectrum(p=1, pulse=pulse, friction=friction)):
        for wrong in (0, -0.1, math.nan):
            with pytest.raises(ValueError, match="friction = .*; expected a number > 0, or None for no limit"):
                make(friction=wrong)


def test_notebooks_show_results_as_tables(record):
    run = rb.Block(alpha=0.15).run(theta=0.1, duration=0.5)
    table = rb.Table({"a<b": np.arange(12.0), "outcome": ["completed"] * 12}, {"a<b": "m"})
    assert "<th>a&lt;b [m]</th>" in table._repr_html_() and table._repr_html_().count("<tr>") == 11
    assert "0.6667" in run._repr_html_() and "PGA" in record._repr_html_()
    names = ["../records/" + name for name in ("a.smc", "a_name_of_a_file_that_is_too_long.AT2 (channel 2)")]
    shown = rb.Table({"record": names, "note": names})._repr_html_()
    assert '<td title="../records/a.smc">a.smc</td>' in shown and "<td>../records/a.smc</td>" in shown
    assert f'<td title="{names[1]}">…{names[1][-27:]}</td>' in shown
    shown = CABINET._repr_html_()
    assert "<td>friction</td><td>0.4</td>" in shown and "<td>α left</td><td>0.3" in shown and "<td>tie 1</td><td>Tie(block_x=-0.4" in shown
    assert "<td>K, C of a support</td>" in rb.Block()._repr_html_() and "friction" not in rb.Block()._repr_html_()
    hazard = rb.Hazard(np.geomspace(0.1, 2, 12), np.geomspace(1e-2, 1e-4, 12), im="PGV", unit="m/s")._repr_html_()
    assert "<th>PGV [m/s]</th>" in hazard and hazard.count("<tr>") == 11 and "<td>0.01</td><td>100</td>" in hazard


def test_what_is_not_installed_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ModuleNotFoundError, match="to_frame needs pandas; python -m pip install pandas"):
        rb.Block().run(theta=0.1, duration=0.1).to_frame()


def test_a_duration_that_is_too_short_leaves_a_run_undecided(record):
    block = rb.Block(alpha=0.1, p=2)
    table = rb.outcomes([block], [record], scale=[0.1, 4.0], duration=9.0, progress=False)
    assert table["outcome"].tolist() == ["undecided", "undecided"] and table["peak.theta/alpha"][1] > 3
    assert rb.outcomes(block, record, scale=4.0, progress=False)["outcome"].tolist() == ["overturned"]
    run = block.run(record, scale=4.0, duration=9.0, progress=False)
    assert (run.outcome, run.has_come_down) == ("undecided", False)
    words = ["completed"] * 3 + ["overturned", "completed", "overturned", "overturned", "undecided", "undecided"]
    rows = {"PGV": np.linspace(0.1, 0.9, 9), "outcome": words, "peak.theta/alpha": [0.5] * 8 + [3.0]}
    fit = rb.fragility(rows, im="PGV")
    assert (fit.undecided, len(fit.measures)) == (2, 7)
    # The last row has exceeded the limit already.
    rotated = rb.fragility(rows, im="PGV", limit=2.0)
    assert (rotated.undecided, len(rotated.measures)) == (1, 8)


def test_the_time_above_a_friction_is_a_column(record):
    block = rb.Block(alpha=0.2, p=2, eta=60)
    plain = rb.outcomes(block, record, scale=[1.0, 3.0], progress=False)
    table = rb.outcomes(block, record, scale=[1.0, 3.0], friction_demand=0.3, progress=False)
    assert table.units["friction_demand>0.3"] == "s" and set(table) - set(plain) == {"friction_demand>0.3"}
    assert all(np.array_equal(table[name], plain[name], equal_nan=plain[name].dtype.kind == "f") for name in plain)
    for scale, above in zip([1.0, 3.0], table["friction_demand>0.3"], strict=True):
        demand = block.run(record, scale=scale, step=1e-3, tolerance=1e-6, progress=False).friction_demand
        ends = np.flatnonzero(np.diff(np.concatenate([[0], (demand > 0.3).astype(int), [0]])))
        assert abs(above - 1e-3 * max(ends[1::2] - ends[::2], default=0)) < 5e-3
    with pytest.raises(ValueError, match="friction_demand = -1"):
        rb.outcomes(block, record, friction_demand=-1.0, progress=False)


def test_stiffness_needs_a_mass():
    sizes = {"width": 0.8, "height": 3.2, "K": 1e7, "C": 4e4}
    with pytest.raises(ValueError, match="K without mass; expected both"):
        rb.Block(**sizes)
    assert rb.Block(**sizes, mass=4000).mass == 4000


TIE = rb.Tie(block_x=-0.4, block_z=2.6, ground_x=-2.0, ground_z=2.6, stiffness=2e4, slack=0.01, strength=3e3)
CABINET = rb.Block(
    width=0.8, center_height=1.4, eccentricity=0.05, mass=600, inertia=420, foundation="rigid", friction=0.4, ties=[TIE]
)
SHAKEN = rb.Pulse("one-sine", amplitude=5.0, period=0.8)


def test_a_measured_body_keeps_its_parameters():
    assert np.isclose(CABINET.alpha_L, np.arctan(0.45 / 1.4), rtol=1e-14) and np.isclose(CABINET.I0, 420.0, rtol=1e-14)
    assert CABINET.ties == (TIE,) and pickle.loads(pickle.dumps(CABINET)) == CABINET
    assert hash(CABINET.replace()) == hash(CABINET) and CABINET.replace(ties=()) != CABINET
    assert CABINET.replace(gamma=3.0).gamma == 3.0 and CABINET.replace(height=3.0).height == 3.0
    assert "friction=0.4, 1 tie" in repr(CABINET)


def test_slip_and_tensions_are_those_of_the_program(rocking):
    run = CABINET.run(pulse=SHAKEN, progress=False)
    options = "--width 0.8 --center-height 1.4 --eccentricity 0.05 --mass 600 --inertia 420 --foundation rigid --friction 0.4"
    tie = "block_x=-0.4,block_z=2.6,ground_x=-2,ground_z=2.6,stiffness=2e4,slack=0.01,strength=3e3"
    pulse = "--pulse one-sine --amplitude 5 --period 0.8 --on-separation fly"
    table = rocking("simulate", *options.split(), *pulse.split(), "--tie", tie)
    for name, column in (("slip", run.slip), ("tie_1.tension", run.tensions[0]), ("energy.ties", run.energy.ties)):
        heading = next(heading for heading in table if heading.split(" [")[0] == name)
        assert np.array_equal(column, np.array(table[heading], dtype=float))
    # The spring of a tie that breaks holds T²/(2 k).
    assert run.broken == (True,) and np.isclose(run.energy.ties[-1], 3e3**2 / 4e4, rtol=1e-9)
    assert run.peak.slip == np.abs(run.slip).max() > 1e-3 and np.isclose(run.peak.tensions[0], 3e3)
    assert len(run.plot()) == 5


def test_outcomes_have_slip_and_limits_on_it():
    table = rb.outcomes([CABINET, CABINET.replace(friction=0.3)], pulse=SHAKEN, progress=False)
    assert table.units["peak.slip"] == "m" and table.units["peak.tie_1.tension"] == "N"
    assert table["peak.slip"][1] > 10 * table["peak.slip"][0]
    assert "peak.slip" not in rb.outcomes(rb.Block(alpha=0.25, p=1.0), pulse=SHAKEN, progress=False)
    slips = [0, 0.01, 0.2, 0.05, 0.3, 0.4, 0.02, 0]
    rows = {"PGV": np.arange(2, 10) / 10, "outcome": ["completed"] * 7 + ["overturned"], "peak.slip": slips}
    fit = rb.fragility(rows, im="PGV", limit="slip:0.1", progress=False)
    assert fit.limit == "slip>0.1" and fit.fractions.tolist() == [0, 0, 1, 0, 1, 1, 0, 1]
    rows |= {"peak.tie_1.plastic": np.full(len(rows["outcome"]), np.nan), "peak.damper_1.plastic": rows["peak.slip"]}
    yielded = rb.fragility(rows, im="PGV", limit="Plastic>0.1", progress=False)
    assert yielded.limit == "plastic>0.1" and np.array_equal(yielded.fractions, fit.fractions)
    with pytest.raises(ValueError, match="found limit `slip:no`; expected overturned"):
        rb.fragility(rows, im="PGV", limit="slip:no")


def test_a_block_on_ties_says_what_happened_to_it():
    ties = [rb.Tie(block_z=1.8, ground_x=x, ground_z=1.8, stiffness=6e4, slack=0.6, damping=2e4) for x in (-1.5, 1.5)]
    block = rb.Block(alpha=0.2, p=2.0, mass=1000.0, foundation="rigid", ties=ties)
    pulse = rb.Pulse("one-sine", amplitude=4.0, period=1.5)
    run = block.run(pulse=pulse, progress=False)
    assert run.passed_balance and run.ends_tilted and run.outcome == "completed"
    table = rb.outcomes(block, pulse=pulse, progress=False)
    assert np.isclose(table["peak.theta/balance"][0], run.peak.theta / 0.2, rtol=1e-5)
    assert np.isclose(table["end.theta/alpha"][0], run.theta[-1] / 0.2, rtol=1e-3)
    assert table["ties.broken"][0] == 0 and np.isnan(table["first_break"][0]) and table.units["first_break"] == "s"
    calm = rb.Block(alpha=0.2, p=2.0, foundation="rigid").run(theta=0.1, progress=False)
    assert not calm.passed_balance and not calm.ends_tilted


def test_undecided_blocks_on_ties_count_by_their_balance_or_give_a_range():
    rows = {
        "PGV": np.arange(2, 10) / 10,
        "outcome": ["completed"] * 4 + ["undecided", "completed", "undecided", "undecided"],
        "peak.theta/alpha": [0.1, 0.2, 1.1, 0.4, 1.4, 0.6, 1.3, 1.8],
    }
    rows["peak.theta/balance"] = rows["peak.theta/alpha"]
    fit = rb.fragility(rows, im="PGV", progress=False)
    assert fit.limit == "balance" and fit.fraction_range == (0.5, 0.5)
    rows["peak.theta/alpha"] = [0.1, 1.5, 1.1, 0.4, 1.2, 0.6, 1.3, 1.3]
    with pytest.warns(UserWarning, match=r"1 undecided rows may exceed the limit.* 37\.5 % to 50\.0 %"):
        higher = rb.fragility(rows, im="PGV", limit=1.25, progress=False)
    assert higher.fraction_range == (0.375, 0.5)


def test_blocks_that_hang_at_rest_on_ties_count_by_their_balance():
    rows = {
        "PGV": np.arange(2, 10) / 10,
        "outcome": ["completed"] * 8,
        "peak.theta/alpha": [0.1, 0.2, 1.1, 0.4, 1.4, 0.6, 1.3, 1.8],
    }
    rows["peak.theta/balance"] = rows["peak.theta/alpha"]
    fit = rb.fragility(rows, im="PGV", progress=False)
    assert fit.limit == "balance" and fit.fraction_range == (0.5, 0.5)


@pytest.mark.parametrize(
    ("study", "parameters"),
    [
        ({}, {"alpha": [0.15, 0.2], "friction": 0.4}),
        ({"ensemble": {"alpha": 0.05, "samples": 3, "limits": [0.5]}}, {"alpha": 0.15, "foundation": "rigid"}),
        ({"azimuths": [0.0, 30.0]}, {"width": 0.4, "height": 1.6, "depth_ratio": [1, 2], "eta": 60, "xi_v": 0.2, "friction": 0.5}),
    ],
)
def test_the_file_of_a_table_has_its_types(study, parameters, tmp_path):
    """Counts are whole numbers, true and false booleans, whatever was written to CSV."""
    pulse = {"pulse": {"shape": "one-sine", "amplitude": 4.0, "period": 0.9}}
    given = {"study": {"design": "grid", **study}, "parameters": {**parameters, **pulse}}
    made = rb.sweep(given, out=tmp_path / "runs.csv", progress=False)
    kinds = {name: column.dtype.kind for name, column in made.items()}
    read = rb.read_table(tmp_path / "runs.csv")
    assert {name: column.dtype.kind for name, column in read.items()} == {"row": "i", **kinds}
    assert "i" in kinds.values()


def test_unknown_samples_of_ensembles_give_a_range():
    exceeded, unknown = np.array([0, 1, 3, 0, 4, 7]), np.array([0, 4, 0, 8, 2, 0])
    known = 8 - unknown
    rows = {
        "PGV": np.arange(1, 7) / 10,
        "outcome": ["completed"] * 3 + ["undecided"] + ["completed"] * 2,
        "peak.theta/alpha": [0.5] * 6,
        "ensemble.samples": [8] * 6,
        "ensemble.unknown(overturned)": unknown,
        "P(overturned)": np.where(known > 0, exceeded / np.maximum(known, 1), np.nan),
    }
    words = r"1 undecided rows .*; in 2 rows, samples without a known outcome .* 31\.2 % to 60\.4 %"
    with pytest.warns(UserWarning, match=words):
        fit = rb.fragility(rows, im="PGV", progress=False)
    assert fit.fraction_range == (15 / 48, 29 / 48) and fit.undecided == 1
    assert pickle.loads(pickle.dumps(fit)).fraction_range == fit.fraction_range


@pytest.mark.parametrize(
    "wrong, words",
    [
        ({"ties": [TIE]}, "ties without mass"),
        ({"friction": 2.0, "foundation": "rigid"}, "friction = 2 lets a corner jam"),
        ({"eccentricity": 9.0}, "eccentricity = 9 m is not valid"),
        ({"inertia": 9.0}, "inertia has no effect without width"),
        ({"width": 1, "height": 4, "center_height": 2, "foundation": "rigid"}, "height has no effect with center_height"),
        ({"width": 1, "height": 4, "inertia": 3, "mass": 2, "gamma": 2, "foundation": "rigid"}, "gamma has no effect"),
        ({"width": 1, "height": 4, "inertia": 3, "mass": 2, "gamma": 3, "foundation": "rigid"}, "gamma has no effect"),
    ],
)
def test_what_makes_no_block_is_refused(wrong, words):
    with pytest.raises(ValueError, match=words):
        rb.Block(**wrong)


def test_a_missing_parameter_is_named():
    run = rb.Block().run(theta=0.1, duration=0.1, progress=False)
    assert run.tensions == () and not hasattr(run, "slip") and not run.energy.friction.any()
    with pytest.raises(ValueError, match="stiffness = 0"):
        rb.Tie(stiffness=0)


def test_gradients_are_those_of_neighbouring_runs() -> None:
    """Derivatives through impacts, of columns, peaks and times of events, against central differences."""
    h, names = 2e-5, ["pulse.period", "alpha"]

    def run(period: float, gradients: list[str]) -> rb.Run:
        pulse = rb.Pulse("one-sine", 6.2622, period)
        return rb.Block(alpha=0.25, eta=40).run(pulse=pulse, duration=5.0, tolerance=1e-13, gradients=gradients)

    found, up, down = run(1.2566, names), run(1.2566 + h, []), run(1.2566 - h, [])
    assert list(found.gradients) == names and found.grazing is None and not up.gradients
    of = found.gradients["pulse.period"]
    assert repr(of).startswith("<Gradient of ") and len(repr(of)) < 120
    assert of.peak.theta == pytest.approx((up.peak.theta - down.peak.theta) / (2 * h), rel=1e-6)
    times = [(a.t - b.t) / (2 * h) for a, b in zip(up.events, down.events, strict=True)]
    np.testing.assert_allclose(of.event_times, times, rtol=1e-6, atol=1e-7)
    # An event between the three runs lies within a few h of its time.
    away = np.abs(np.subtract.outer(found.t, [event.t for event in found.events])).min(axis=1) > 10 * h
    theta = (up.theta - down.theta) / (2 * h)
    np.testing.assert_allclose(of["theta"][away], theta[away], atol=1e-6 * np.abs(theta).max())
    assert "energy.input" not in of.columns
    with pytest.raises(ValueError, match="gradients: scale is no real parameter of this run"):
        run(1.2566, ["scale"])


def test_both_polarities_are_one_motion():
    """The reversed run of a block is that of its mirror image."""
    record = rb.Record(np.sin(np.linspace(0, 12, 600)) * np.linspace(3, 0, 600), 0.01, "a")
    other = rb.Record(np.sin(np.linspace(0, 20, 800)) * np.linspace(0, 4, 800), 0.01, "a")
    blocks = {sign: [rb.Block(alpha=alpha, p=2.0, foundation="rigid", eccentricity=sign * 0.05) for alpha in (0.12, 0.2)] for sign in (1, -1)}
    both = rb.outcomes(blocks[1], [record, other], scale=[0.4, 2], polarity="both", progress=False)
    plain, mirrored = (rb.outcomes(blocks[sign], [record, other], scale=[0.4, 2], progress=False) for sign in (1, -1))
    assert both.shape == (4, 2, 2)
    reversed_ = np.char.endswith(both["record"].astype(str), " (reversed)")
    for of, expected in ((~reversed_, plain), (reversed_, mirrored)):
        assert both["outcome"][of].tolist() == expected["outcome"].tolist()
        np.testing.assert_array_equal(both["peak.theta/alpha"][of], expected["peak.theta/alpha"])
        np.testing.assert_array_equal(both["PGV"][of], plain["PGV"])
    assert both["record"][~reversed_].tolist() == plain["record"].tolist()
    assert rb.fragility(both, "PGV", limit=0.5).independence == rb.fragility(plain, "PGV", limit=0.5).independence
    with pytest.raises(ValueError, match="polarity has no effect without horizontal records"):
        rb.outcomes(blocks[1], vertical=record, polarity="both")
    with pytest.raises(ValueError, match='polarity = "up"; expected one of "as-recorded", "both"'):
        rb.outcomes(blocks[1], record, polarity="up")
