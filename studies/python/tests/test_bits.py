"""The same numbers as the program's and the FMU's, to the last bit."""

import json
import subprocess
from dataclasses import asdict

import numpy as np
import pytest
from conftest import numbers, same
from fmpy import simulate_fmu
from rocking import instance

import rocking_block as rb

RUNS = {
    "a record": (
        {"alpha": 0.2, "p": 1.5, "eta": 60, "xi_v": 0.1},
        {"scale": 3},
        ["--scale=3", "--alpha=0.2", "--p=1.5", "--eta=60"],
    ),
    "a record both ways, in flight": (
        {"alpha": 0.3, "p": 2.5, "eta": 80, "xi_v": 0.05, "epsilon": 0.4},
        {"scale": 5, "vertical": True, "tolerance": 1e-10},
        "--scale=5 --alpha=0.3 --p=2.5 --eta=80 --xi-v=0.05 --epsilon=0.4 --tolerance=1e-10".split(),
    ),
    "sizes": (
        {"width": 0.8, "height": 3.2, "K": 1e7, "C": 4e4, "mass": 4000},
        {"scale": 2, "duration": 30, "step": 0.01},
        "--scale=2 --width=0.8 --height=3.2 --stiffness=1e7 --damping=4e4 --mass=4000 --duration=30 --step=0.01".split(),
    ),
    "a rigid base": (
        {"alpha": 0.15, "p": 2.0, "foundation": "rigid", "restitution_factor": 0.95},
        {"scale": 2, "pulse": rb.Pulse("c1", 1.0, 1.5, 2.0)},
        "--scale=2 --alpha=0.15 --p=2 --foundation=rigid --restitution-factor=0.95 --pulse=c1 --amplitude=1 --period=1.5 "
        "--start=2".split(),
    ),
}
FREE = {
    "a pulse": ({}, {"pulse": rb.Pulse("one-cosine", 4.0, 1.0)}, "--pulse=one-cosine --amplitude=4 --period=1".split()),
    "free motion": ({"eta": 80}, {"theta": 0.2, "theta_dot": -0.1}, "--eta=80 --theta=0.2 --theta-dot=-0.1".split()),
    "a drop": ({}, {"v": 0.001, "v_dot": 0.1}, "--v=0.001 --v-dot=0.1".split()),
}


@pytest.mark.parametrize("name", [*RUNS, *FREE])
def test_a_run_is_that_of_the_program(name, rocking, record, path):
    parameters, options, said = (RUNS | FREE)[name]
    block = rb.Block(**parameters)
    said = ["simulate", "--on-separation=fly", *said]
    if name in RUNS:
        said += ["--record", path]
        if options.get("vertical"):
            said += ["--vertical", path]
            options = options | {"vertical": record}
        run = block.run(record, **options)
    else:
        run = block.run(**options)
    # Columns of the program name their units.
    table = {name.split(" [")[0]: column for name, column in rocking(*said).items()}
    assert list(table) == list(run.columns)
    for column in table:
        assert same(run[column], table[column]), column


def test_the_summary_is_that_of_the_program(rocking, record, path, tmp_path):
    block = rb.Block(alpha=0.15, p=2.5)
    run = block.run(record, scale=2)
    command = [rocking.program, "simulate", "--on-separation=fly", "--record", path, "--scale=2", "--alpha=0.15", "--p=2.5", "--json", "--events",
               "--csv", tmp_path / "run.csv"]
    summary = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    summary = summary.get("result", summary)
    assert summary["outcome"] == run.outcome
    assert summary["end_time"] == run.end_time
    assert summary["has_come_down"] == run.has_come_down
    peak = run.peak
    assert summary["peak"] == {"theta": peak.theta, "theta/alpha": peak.theta / block.alpha,
                               "theta/balance": peak.theta / block.alpha, "uplift": peak.uplift,
                               "N": peak.N, "H": peak.H, "friction_demand": peak.friction_demand}
    assert [tuple(event.values()) for event in summary["events"]["list"]] == [
        (event.t, event.event, event.corner, event.before, event.after) for event in run.events]
    assert summary["events"]["impacts"] == run.counts.impacts > 0
    assert summary["block"]["R0"] == block.R0 and summary["block"]["width"] == block.width


SPECTRUM_COLUMNS = {
    "p": "p [rad/s]", "2pi/p": "2pi/p [s]", "eta": "eta [1]", "xi_v": "xi_v [1]", "epsilon": "epsilon [1]",
    "restitution_factor": "restitution_factor [1]", "end_time": "end_time [s]", "peak.theta/alpha": "peak.theta/alpha [1]",
    "peak.uplift": "peak.uplift [m]", "peak.N": "peak.N [N]", "peak.H": "peak.H [N]",
    "peak.friction_demand": "peak.friction_demand [1]", "first_separation": "first_separation [s]", "flights": "flights [1]",
    "events.impacts": "events.impacts [1]", "events.liftoffs": "events.liftoffs [1]",
}


@pytest.mark.parametrize("rigid", [False, True])
def test_a_spectrum_is_that_of_the_program(rigid, rocking, record, path):
    bases = ["rigid,0,0.9"] if rigid else ["40,0.1,0", "80,0.4,0.2"]
    table = rocking("spectrum", "--record", path, "--scale=3", "--alpha=0.15", "--points=40",
                    *(f"--foundation={base}" for base in bases))
    p = numbers(table["p [rad/s]"])[:40]
    curves = {"foundation": "rigid", "restitution_factor": [0.9]} if rigid else {
        "eta": [40, 80], "xi_v": [0.1, 0.4], "epsilon": [0.0, 0.2]}
    made = rb.spectrum(alpha=0.15, p=p, records=record, scale=3, **curves)
    assert made.shape == (len(bases), 40)
    assert made["outcome"].tolist() == table["outcome"]
    assert {"completed", "overturned"} <= set(table["outcome"])
    for ours, theirs in SPECTRUM_COLUMNS.items():
        assert same(made[ours], table[theirs]), ours
    one = rb.spectrum(alpha=0.15, p=p, records=[record], scale=3, threads=1, **curves)
    assert one.shape == (1, len(bases), 40)
    assert rb.Table(one, one.units, made.shape) == made


def test_a_spectrum_has_the_numbers_of_single_runs(record):
    blocks = rb.blocks(alpha=[0.12, 0.2], p=[2.0, 3.0], eta=50)
    table = rb.outcomes(blocks, [record], scale=[1.0, 4.0])
    assert table.shape == (1, 2, 2)
    for row, (scale, block) in enumerate((scale, block) for scale in (1.0, 4.0) for block in blocks):
        run = block.run(record, scale=scale, tolerance=1e-6, step=1e4)
        assert table["peak.theta/alpha"][row] == run.peak.theta / block.alpha
        assert table["outcome"][row] == run.outcome
        assert (table["alpha"][row], table["p"][row], table["scale"][row]) == (block.alpha, block.p, scale)
        assert table["PGA"][row] == record.pga * scale and table["PGV"][row] == record.pgv * scale


def test_a_sweep_is_that_of_the_program(rocking, path, tmp_path):
    study = {
        "study": {"design": "latin-hypercube", "samples": 8, "seed": 3, "scales": [1, 3], "periods": [0.5]},
        "parameters": {
            "dimensionless": {"alpha": {"from": 0.1, "to": 0.2}, "p": {"from": 1.5, "to": 4.0, "spacing": "log"}},
            "foundation": ["Viscoelastic", "Rigid"],
            "initial.settled": True,
        },
        "records": [path],
    }
    from rocking_block import _toml

    file = tmp_path / "study.toml"
    file.write_text(_toml.text(study))
    table = rocking("sweep", file)
    del table["row"]
    for made in (rb.sweep(study), rb.sweep(file)):
        assert made.rows == 16 and len(made) == len(table)
        for name, (heading, column) in zip(made, table.items()):
            assert heading in (name, f"{name} [{made.units.get(name)}]")
            if made[name].dtype.kind in "fi":
                assert same(made[name], column), name
            elif made[name].dtype.kind == "b":
                assert [str(value).lower() for value in made[name]] == column
            else:
                assert made[name].tolist() == column
    assert made["Sa(0.5 s)"].min() > 0 and made.units["Sa(0.5 s)"] == "m/s2"


def test_a_sweep_for_least_levels_is_that_of_the_program(rocking, path, tmp_path):
    """Overturning ranges are text, though their heading has a unit."""
    study = {
        "study": {"design": "grid", "least": {"im": "PGV", "from": 0.1, "to": 2.0, "points": 20, "resolution": 0.01}},
        "parameters": {"foundation": "rigid", "alpha": 0.15, "p": [2.0, 3.0]},
        "records": [path],
    }
    from rocking_block import _toml

    file = tmp_path / "study.toml"
    file.write_text(_toml.text(study))
    table = rocking("sweep", file, csv=tmp_path / "table.csv")
    made = rb.sweep(study)
    assert made["overturning.PGV"].tolist() == table["overturning.PGV [m/s]"] and made.units["overturning.PGV"] == "m/s"
    assert " to " in made["overturning.PGV"][0]
    assert same(made["least.PGV"], table["least.PGV [m/s]"]) and same(made["overturning_ranges"], table["overturning_ranges [1]"])
    assert made["least.bound"].tolist() == ["none", "none"] and len(made.to_frame()) == 2
    assert made.plot("p", "least.PGV").get_ylabel() == "least.PGV [m/s]"
    for table in (made, tmp_path / "table.csv"):
        with pytest.raises(ValueError, match="found the least levels of searches, least.PGV.*; expected an outcome at one level in each row"):
            rb.fragility(table, im="PGV")


def test_columns_have_one_name_and_words_one_spelling(path):
    """A study of block parameters has the columns of `outcomes`, except those that `outcomes` derives."""
    parameters = {"alpha": [0.2], "p": [2.0], "eta": [50], "xi_v": [0.1], "epsilon": [0.1], "foundation": ["viscoelastic"]}
    made = rb.sweep({"study": {"design": "grid"}, "parameters": parameters, "records": [{"horizontal": path, "vertical": path}]})
    outcomes = rb.outcomes(rb.blocks(alpha=0.2, p=[2.0], eta=50, xi_v=0.1, epsilon=0.1), path, vertical=path)
    assert set(outcomes) - set(made) == {"2pi/p", "restitution_factor"} and set(made) <= set(outcomes)
    assert made.units.items() <= outcomes.units.items()
    for name in set(made) - {"record", "vertical"}:
        assert np.array_equal(made[name], outcomes[name], equal_nan=made[name].dtype.kind == "f"), name


def test_foundations_are_those_of_the_program(rocking):
    report = rocking.json("foundations")["pairs"]
    found = [asdict(pair) for pair in rb.foundations.pairs()]
    for pair in report:
        source = pair.pop("source")
        pair |= {"source": source["name"], "citation": source["citation"], "doi": source["doi"]}
    assert found == report
    only = rb.foundations.pairs("friction", "Granite")
    assert len(only) == 3 and all(pair.surfaces == "granite on granite" for pair in only)
    pad = rb.foundations.pad(0.5, 12, 0.9e6, bulk_modulus=2e9)
    command = "foundations pad --diameter=0.5 --shape-factor=12 --shear-modulus=0.9e6 --bulk-modulus=2e9"
    values = rocking.json(*command.split())
    assert (pad.K, pad.K_rocking) == (values["K"], values["K_rocking"]) and np.isnan(pad.C) and values["C"] is None
    soil = rb.foundations.soil(2, 3, shear_wave_velocity=200, density=1800, poisson=0.3)
    command = "foundations soil --width=2 --length=3 --shear-wave-velocity=200 --density=1800 --poisson=0.3"
    values = rocking.json(*command.split())
    assert asdict(soil) == {name: values[name] for name in ("K", "C", "K_rocking")}
    for call, message in [
        (lambda: rb.foundations.pairs("colour"), 'quantity = "colour"; expected one of "friction", "restitution_factor"'),
        (lambda: rb.foundations.pad(1, 5, -1), "shear_modulus = -1 is not valid; expected a number > 0"),
    ]:
        with pytest.raises(ValueError, match=message):
            call()


def test_a_search_is_that_of_the_program(rocking, record, path, tmp_path):
    block = rb.Block(alpha=0.2, p=2.0, foundation="rigid")
    found = rb.search_overturning(block, pulse=rb.Pulse("one-sine", period=1.0), points=41)
    command = "search overturning --pulse=one-sine --period=1 --alpha=0.2 --p=2 --foundation=rigid --points=41".split()
    table = rocking(*command)
    assert same([stretch[0] for stretch in found.stretches], table["from"])
    assert same([stretch[1] for stretch in found.stretches], table["to"])
    assert [stretch[2] for stretch in found.stretches] == table["outcome"]
    assert found.least in [stretch[0] for stretch in found.stretches if stretch[2] == "overturned"]
    found = rb.search_overturning(block, record=record, points=21, resolution=1e-3)
    command = f"search overturning --record={path} --alpha=0.2 --p=2 --foundation=rigid --points=21 --resolution=1e-3".split()
    assert same([stretch[0] for stretch in found.stretches], rocking(*command)["from"])
    found = rb.search_damping(rb.Block(alpha=0.25, eta=80, epsilon=0.4), points=21)
    table = rocking(*"search damping --alpha=0.25 --eta=80 --epsilon=0.4 --points=21".split())
    assert same([stretch[0] for stretch in found.stretches], table["from"])
    assert found.least > 0.1


COLUMNS = ["theta", "theta_dot", "theta_ddot", "v", "v_dot", "u", "N_L", "N_R", "H", "M_base", "uplift_L", "uplift_R",
           "friction_demand", "energy.total", "energy.input", "energy.dashpots", "energy.impacts", "energy.residual"]


def test_a_run_under_a_record_is_that_of_the_fmu(record):
    """In steps from sample to sample. The record's samples are at multiples of its time step, to the last bit."""
    short = rb.Record(record.acceleration[1000:3001], 2.0**-7)
    run = rb.Block(alpha=0.2, p=2.5, eta=60).run(short, duration=2000 * short.dt)
    start = {"dimensionless.alpha": 0.2, "dimensionless.p": 2.5, "dimensionless.eta": 60.0, "on_separation": 3,
             "a_gx": short.acceleration[0]}
    with instance(str(rb.fmu_path()), start) as (slave, references):
        wanted, ground = [references[column] for column in COLUMNS], [references["a_gx"]]
        rows = []
        for k, (a, b) in enumerate(zip(short.acceleration[:-1], short.acceleration[1:])):
            slave.setReal(ground, [a])
            slave.setRealInputDerivatives(ground, [1], [(b - a) / short.dt])
            rows.append(slave.getReal(wanted))
            slave.doStep(k * short.dt, short.dt)
    assert run.counts.impacts > 4 and len(run) == len(rows) + 1
    for column, values in zip(COLUMNS, np.array(rows).T):
        assert np.array_equal(run[column][:-1], values), column


@pytest.mark.parametrize(
    ("in_space", "own", "tilt", "columns"),
    [(False, {"epsilon": 0.3}, "theta", COLUMNS),
     (True, {"pulse.azimuth": 0.5}, "tilt", ["tilt_x", "tilt_y", "twist", "u_dot", "N_SW", "uplift_NE", "slip_SE", "energy.residual"])],
)
def test_both_units_of_the_package_give_the_same_bits(in_space, own, tilt, columns):
    start = own | {"dimensionless.alpha": 0.2, "dimensionless.p": 1.0, "dimensionless.eta": 60.0, "on_separation": 3, "pulse.shape": 2,
                   "pulse.amplitude": 5.0, "pulse.period": 1.2}
    of_fmi2, of_fmi3 = (
        simulate_fmu(str(rb.fmu_path(version, in_space=in_space)), start_values=start, stop_time=5.0, output_interval=0.05,
                     output=[tilt, *columns])
        for version in (2, 3)
    )
    assert of_fmi2[tilt].max() > 0.05
    for column in columns:
        assert np.array_equal(of_fmi2[column], of_fmi3[column]), column
    with pytest.raises(ValueError, match="version = 1; expected 2 or 3"):
        rb.fmu_path(1, in_space=in_space)


@pytest.mark.parametrize("end", ["on_separation", "on_overturning"])
def test_a_block_that_is_held_is_that_of_the_fmu(end):
    """With Hold = 2 the block stays still from the end of its motion to the requested duration."""
    step = 2.0**-6
    rigid = end == "on_overturning"
    parameters = {"alpha": 0.15, "p": 2.0, "foundation": "rigid"} if rigid else {"alpha": 0.25, "p": 2.0, "eta": 80.0, "epsilon": 0.8}
    block, pulse = rb.Block(**parameters), rb.Pulse("one-sine", 9.0, 1.0)
    run = block.run(pulse=pulse, duration=300 * step, step=step, **{end: "hold"})
    start = {"dimensionless.alpha": block.alpha, "dimensionless.p": block.p, "pulse.shape": 2, "pulse.amplitude": 9.0,
             "pulse.period": 1.0, end: 2} | ({"foundation": 2} if rigid else {"dimensionless.eta": 80.0, "epsilon": 0.8})
    with instance(str(rb.fmu_path()), start) as (slave, references):
        wanted = [references[column] for column in COLUMNS]
        rows = [slave.getReal(wanted)]
        for k in range(300):
            slave.doStep(k * step, step)
            rows.append(slave.getReal(wanted))
    assert len(run) == 301 and run.end_time < 250 * step
    assert run.outcome == ("overturned" if rigid else "separated")
    for column, values in zip(COLUMNS, np.array(rows).T):
        assert np.array_equal(run[column], values), column
    assert run.theta_dot[-1] == 0
