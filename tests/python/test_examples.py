"""Tests the claims of the examples' pages on energy, convergence and outcomes. An example is skipped if one of its packages is
missing."""

import csv
import importlib.util
import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytestmark = pytest.mark.check
EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
for folder in ("", "coupling/roof", "coupling/bridge", "coupling/one_line", "coupling/torsion", "python"):
    sys.path.insert(0, str(EXAMPLES / folder))


def need(*packages):
    for package in packages:
        if importlib.util.find_spec(package) is None:
            pytest.skip(f"{package} has no build for this platform or is not installed")


@pytest.fixture(scope="module")
def frame(fmu, tmp_path_factory):
    """The OpenSees frame as an FMU."""
    need("pythonfmu", "openseespylinux")
    import roof

    return roof.build_frame(tmp_path_factory.mktemp("frame"))


@pytest.fixture(scope="module")
def exchanges(frame):
    """Both exchanges at two steps, through the strongest five seconds or so."""
    import roof

    return {(iterated, h): roof.couple(frame, h, 5.0, iterated) for h in (0.02, 0.01) for iterated in (False, True)}


def test_the_frame_comes_back_to_the_last_bit(frame):
    from common import instance

    names = ("a_x", "a_z", "v_x", "u_x", "u_z", "shear")

    def push(opened):
        rows = []
        for k in range(40):
            opened.set(a_base=8.0 * np.sin(0.3 * k))
            opened.slave.doStep(0.2 + 0.01 * k, 0.01)
            rows.append(opened.get(*names))
        return np.array(rows)

    with instance(frame, {"F_z": -15e3}) as opened:
        opened.set(a_base=2.0)
        opened.slave.doStep(0.0, 0.2)
        state = opened.slave.getFMUstate()
        first = push(opened)
        opened.slave.setFMUstate(state)
        assert np.array_equal(push(opened), first)
        # The columns yield: the shear at the same drift differs between loading and unloading by more than rounding.
        opened.slave.setFMUstate(state)
        opened.slave.freeFMUstate(state)
        assert np.array_equal(push(opened), first)
        stiffness = first[:, 5] / first[:, 3]
        assert stiffness.min() < 0.9 * stiffness.max()


def test_the_iterated_exchange_converges_where_the_explicit_one_does_not(exchanges):
    from roof import missing

    for h in (0.02, 0.01):
        run = exchanges[True, h]
        assert not run.diverged
        # Roof and block agree at the end of every step.
        assert run["agreement"].max() < 1e-7
        assert np.mean(run.iterations) < 6
    assert exchanges[False, 0.02].diverged or missing(exchanges[False, 0.02]) > 1
    coarse, fine = exchanges[True, 0.02]["theta"], exchanges[True, 0.01]["theta"][1::2]
    assert np.abs(fine).max() > 0.1
    assert np.abs(coarse - fine).max() < 0.05 * np.abs(fine).max()
    explicit = exchanges[False, 0.02]["theta"]
    assert np.abs(explicit - fine[: len(explicit)]).max() > 0.2 * np.abs(fine).max()


def test_the_iterated_exchange_conserves_energy(exchanges):
    from roof import missing

    assert missing(exchanges[True, 0.02]) < 0.025
    assert missing(exchanges[True, 0.01]) < 0.012
    assert missing(exchanges[False, 0.01]) > 8 * missing(exchanges[True, 0.01])


def test_the_blocks_derivatives_spare_iterations(frame):
    from roof import couple

    newton, plain = (couple(frame, 0.02, 1.0, True, derivatives=derivatives, most=60) for derivatives in (True, False))
    assert max(newton["agreement"].max(), plain["agreement"].max()) < 1e-7
    assert np.mean(newton.iterations) < 0.6 * np.mean(plain.iterations)
    # Both find the same motion.
    assert np.abs(newton["u_x"] - plain["u_x"]).max() < 1e-8


def test_the_mass_that_moves_with_the_roof_at_once(fmu):
    """In full contact a block on springs turns freely about the middle of its base: dH/da_gx = M I0/(I0 + M h^2)."""
    from common import instance
    from roof import EQUIPMENT, FORCES, MASS

    with instance(fmu, EQUIPMENT) as block:
        derivatives = block.derivatives(FORCES, ("a_gx", "a_gz"))
    b, h = 0.3, 0.9
    inertia = (b * b + h * h) / 3
    expected = np.zeros((3, 2))
    expected[0, 0] = MASS * inertia / (inertia + h * h)
    assert np.allclose(derivatives, expected, rtol=1e-12, atol=1e-9)


def test_what_an_impact_takes_does_not_reach_the_roof(frame):
    """The README's warning: with epsilon = 0 the impulses of impacts are not in the sampled reactions."""
    from roof import WEIGHT, couple

    soft, hard = (couple(frame, 0.02, 5.0, True, start_values={"epsilon": epsilon}) for epsilon in (1.0, 0.0))
    lost = [abs(run["lost_momentum"][-1][1]) / WEIGHT for run in (soft, hard)]
    assert lost[0] < 0.02 and lost[1] > 0.05


@pytest.fixture(scope="module")
def bridge_parts(fmu, tmp_path_factory):
    need("pythonfmu")
    import bridge

    return bridge.build_parts(tmp_path_factory.mktemp("bridge"))


@pytest.mark.parametrize("package, master", [("libcosimpy", "run_libcosim"), ("ecospy", "run_ecos")])
def test_the_bridge_runs_the_same_everywhere(bridge_parts, tmp_path, package, master):
    """The masters run the SSP package unchanged; `run_fmpy` does the same exchange explicitly."""
    need(package)
    import bridge

    ssp = bridge.build_ssp(tmp_path, bridge_parts)
    result = getattr(bridge, master)(ssp, 0.002, 6.0)
    expected = bridge.run_fmpy(bridge_parts, 0.002, 6.0)
    for tower in ("tower_1", "tower_2"):
        assert np.abs(expected[f"{tower}.theta"]).max() > 0.01
        # The towers rock, and the compared outputs include the deck's loads.
        assert expected[f"{tower}.energy.impacts"][-1] > 100
    for name, values in expected.items():
        # The masters add up time in different ways; the last digits differ, and impacts amplify that.
        assert np.abs(result[name] - values).max() < 1e-9 * np.abs(values).max()


def test_the_bridges_interface_converges(bridge_parts):
    from bridge import missing, run_fmpy

    coarse, fine = (run_fmpy(bridge_parts, h, 6.0) for h in (0.004, 0.002))
    assert 1.7 < missing(coarse) / missing(fine) < 2.6
    assert missing(fine) < 0.06
    change = np.abs(coarse["tower_1.theta"] - fine["tower_1.theta"][1::2]).max()
    assert change < 0.1 * np.abs(fine["tower_1.theta"]).max()


def test_a_block_on_a_floor_that_twists(fmu):
    """The claims of its page: the exchange converges, its energies agree, and without it twist and outcome are wrong."""
    need("scipy")
    from torsion import couple, missing

    kept, coarse, fine = couple(0.005, False), couple(0.01, True), couple(0.005, True)
    assert missing(kept) < 0.002 and missing(fine) < 0.75 * missing(coarse) < 0.003
    assert 2 < np.mean(fine.iterations) < 6 and np.mean(kept.iterations) == 1
    assert np.abs(fine["tilt"].max() / coarse["tilt"].max() - 1) < 0.02
    assert np.abs(fine["twist"]).max() > 2 * np.abs(kept["twist"]).max()
    outcomes = [couple(0.005, returned, scale=1.2)["tilt"].max() for returned in (False, True)]
    assert outcomes[0] < 0.3 and outcomes[1] == pytest.approx(np.pi / 2)


def need_master(master):
    """Skips a test where a master is not installed: fmi-sim is a program, the others are packages."""
    if master != "fmi-sim":
        need(master)
    elif shutil.which(master) is None:
        pytest.skip("fmi-sim is not installed: cargo install fmi-sim --locked")


@pytest.mark.parametrize("master", ["libcosimpy", "ecospy", "fmi-sim"])
def test_the_same_block_in_every_master(fmu, master):
    need_master(master)
    import one_line

    expected, theta = one_line.with_fmpy(), one_line.MASTERS[master]()
    assert len(expected) == len(theta) == 1000
    # It rocks: the rotation changes sign and decreases with each impact.
    assert expected.min() < -0.05 and abs(expected[-1]) < 0.05
    assert np.abs(theta - expected).max() < 1e-12


def test_an_example_leaves_its_page_alone(fmu, tmp_path, monkeypatch):
    need("matplotlib")
    import one_line

    page = EXAMPLES / "coupling/one_line/result.png"
    before = page.read_bytes()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(one_line, "MASTERS", {"fmpy": one_line.with_fmpy})
    monkeypatch.setattr(sys, "argv", ["one_line.py"])
    one_line.main()
    assert page.read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["one_line.png"]
    # With --update, the page's picture is written.
    monkeypatch.setattr(one_line, "HERE", tmp_path)
    monkeypatch.setattr(sys, "argv", ["one_line.py", "--update"])
    one_line.main()
    assert (tmp_path / "result.png").exists()


def test_fmi_sim_takes_a_record(fmu, loma_prieta, tmp_path):
    need_master("fmi-sim")
    from fmpy import simulate_fmu

    dt, record = loma_prieta
    signal = np.array(list(zip(dt * np.arange(len(record)), record)), dtype=[("time", float), ("a_gx", float)])
    np.savetxt(tmp_path / "record.csv", signal, delimiter=",", header="time,a_gx", comments="", fmt="%.17g")
    subprocess.run(["fmi-sim", "--model", fmu, "-i", tmp_path / "record.csv", "-o", tmp_path / "out.csv", "co-simulation",
                    f"--step={dt}", f"--output-interval={dt}", "-f14"], check=True, stdout=subprocess.DEVNULL)
    theta = np.genfromtxt(tmp_path / "out.csv", delimiter=",", names=True)["theta"]
    expected = simulate_fmu(fmu, input=signal, stop_time=14.0, output_interval=dt, output=["theta"])["theta"]
    assert np.abs(expected).max() > 0.02
    assert np.abs(theta - expected).max() < 1e-10


SEPARATING = {"dimensionless.alpha": 0.25, "dimensionless.p": 1.0, "initial.theta": 0.2, "initial.theta_dot": 1.0}


@pytest.mark.parametrize("master, outcome", [("fmpy", "ends"), ("libcosimpy", "fails"), ("ecospy", "goes on"), ("fmi-sim", "ends")])
def test_what_masters_make_of_a_discard(fmu, master, outcome, monkeypatch):
    """The claims of docs/unit/importing.md on complete separation, which happens at 0.067 s here."""
    need_master(master)
    import one_line

    monkeypatch.setattr(one_line, "START", SEPARATING)
    if outcome == "fails":
        with pytest.raises(RuntimeError, match="libcosim stopped"):
            one_line.MASTERS[master]()
    else:
        theta = one_line.MASTERS[master]()
        assert len(theta) == (7 if outcome == "ends" else 1000)
        assert abs(theta[-1] - 0.26700625) < 1e-7
    # With Hold the run continues in all masters; those without Enumerations read Integers.
    monkeypatch.setattr(one_line, "START", SEPARATING | {"on_separation": 2})
    theta = one_line.MASTERS[master]()
    assert len(theta) == 1000 and abs(theta[-1] - 0.26700625) < 1e-7


@pytest.mark.parametrize("parts", [1, 2, 10])
@pytest.mark.parametrize("master", ["libcosimpy", "ecospy", "fmi-sim"])
def test_a_record_inside_in_every_master(fmu, master, parts, monkeypatch):
    """At the record's own step and at fractions of it; shorter steps change only the integration error within its tolerance."""
    need_master(master)
    import one_line

    record = EXAMPLES.parent / "examples/records/np01002p_4225a_a.smc"
    start = {"record.horizontal": str(record), "record.scale": 3.0, "dimensionless.alpha": 0.15, "dimensionless.p": 2.0}
    monkeypatch.setattr(one_line, "START", start)
    monkeypatch.setattr(one_line, "STOP", 14.0)
    monkeypatch.setattr(one_line, "STEP", 0.005)
    whole = one_line.with_fmpy()
    monkeypatch.setattr(one_line, "STEP", 0.005 / parts)
    expected, theta = one_line.with_fmpy(), one_line.MASTERS[master]()
    assert np.abs(expected).max() > 0.05
    assert len(theta) == len(expected) == 2800 * parts
    assert np.abs(theta - expected).max() < 1e-9
    assert np.abs(expected[parts - 1 :: parts] - whole).max() < 1e-7 * start["dimensionless.alpha"]


@pytest.fixture(scope="module")
def loma_prieta():
    from common import read_record

    times, record = read_record()
    dt = times[1]
    # From the record's header: 7183 samples at 200 per second, -222.5 cm/s2 at 7.55 s.
    assert (dt, len(record)) == (0.005, 7183) and np.array_equal(times, dt * np.arange(7183))
    assert abs(record.min() + 2.2252) < 1e-9 and times[np.abs(record).argmax()] == pytest.approx(7.55)
    return dt, 2 * record[:3000]


# Slendernesses [rad]; smallest p, largest p [rad/s] and their number: a few blocks that rock, fly and fall over.
GRID = (0.15, 0.3), (0.8, 3.2, 5)


DURATION = 50.0  # s


def few_blocks(fmu, fly, **options):
    import spectrum
    from common import RECORD

    alphas, ps = GRID[0], spectrum.sizes(*GRID[1])
    motion = spectrum.Motion(RECORD.name, RECORD.read_bytes(), scale=2.0)
    return spectrum.spectrum(Path(fmu).read_bytes(), motion, DURATION, fly, alphas, ps, **options)


def rocking_spectrum(table, *options):
    """The rows of a table of `rocking spectrum`, their columns by the names without units."""
    from common import ROCKING

    subprocess.run([ROCKING, "spectrum", *options, "--csv", table], check=True, stdout=subprocess.DEVNULL)
    lines = (line for line in table.read_text().splitlines() if not line.startswith("#"))
    return [{name.split(" [")[0]: value for name, value in row.items()} for row in csv.DictReader(lines)]


@pytest.mark.parametrize("separation", ["terminate", "fly"])
def test_a_spectrum_is_that_of_the_program(fmu, tmp_path, separation):
    """To the last bit: the table's digits bring the program's numbers back exactly."""
    import spectrum
    from common import RECORD

    peaks, ends = few_blocks(fmu, separation == "fly")
    alphas, (least, greatest, count) = GRID
    for alpha, row, end in zip(alphas, peaks, ends):
        expected = rocking_spectrum(
            tmp_path / f"{alpha}.csv", "--record", RECORD, "--scale=2", f"--alpha={alpha}", "--foundation=40,0.1,0.4",
            f"--p-min={least}", f"--p-max={greatest}", f"--points={count}", f"--on-separation={separation}",
            f"--duration={DURATION}")
        assert [float(block["p"]) for block in expected] == list(spectrum.sizes(*GRID[1]))
        assert [block["outcome"] for block in expected] == list(end)
        assert [float(block["peak.theta/alpha"]) for block in expected] == list(row / alpha)
    # The test needs blocks that fall, fly and rock; and size protects.
    assert (ends[0, 0], ends[1, 1]) == ("overturned", "completed" if separation == "fly" else "separated")
    assert (ends[:, 2:] == "completed").all() and (np.diff(peaks[:, 2:]) < 0).all()


def test_a_spectrum_takes_records_of_other_formats(fmu, tmp_path):
    """Columns with their own time axis, in cm/s2, give the same bits. Errors of `rocking` appear unchanged."""
    import spectrum
    from common import read_record

    file = tmp_path / "shaking.txt"
    time = 2.5 + 0.0625 * np.arange(80)
    np.savetxt(file, np.column_stack([time, 300 * np.sin(3 * time)]))
    times, record = read_record(file, "--unit", "cm/s2")
    assert np.array_equal(times, time) and np.allclose(record, 3 * np.sin(3 * time), rtol=0, atol=1e-15)
    ps = spectrum.sizes(1.0, 3.0, 3)
    motion = spectrum.Motion(file.name, file.read_bytes(), times[0], unit="cm/s2")
    peaks, ends = spectrum.spectrum(Path(fmu).read_bytes(), motion, 20.0, True, [0.25], ps)
    expected = rocking_spectrum(tmp_path / "s.csv", "--record", file, "--unit=cm/s2", "--foundation=40,0.1,0.4",
                                "--alpha=0.25", "--p-min=1", "--p-max=3", "--points=3", "--duration=20")
    assert [float(block["peak.theta/alpha"]) for block in expected] == list(peaks[0] / 0.25)
    assert peaks[0, 0] > 0.01
    with pytest.raises(ValueError, match="no unit in the file and none given; expected --unit g, m/s2 or cm/s2"):
        read_record(file)


def test_a_spectrum_is_drawn_where_it_is_started(fmu, tmp_path, monkeypatch, capsys):
    need("matplotlib")
    import spectrum

    monkeypatch.chdir(tmp_path)
    (tmp_path / "short.txt").write_text("0.3\n-0.3\n" * 50)
    arguments = ["--record", "short.txt", "--unit=g", "--dt=0.1", "--scale=1", "--duration=12"]
    monkeypatch.setattr(sys, "argv", ["spectrum.py", *arguments])
    spectrum.main()
    assert "75 blocks, 12 s each" in capsys.readouterr().out
    assert (tmp_path / "spectrum.png").read_bytes().startswith(b"\x89PNG")


def test_a_spectrum_is_the_same_on_a_cluster(fmu):
    """On two worker processes, to the last bit."""
    need("distributed")
    from dask.distributed import Client, LocalCluster

    import spectrum

    peaks, ends = few_blocks(fmu, True)
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        client.upload_file(spectrum.__file__)
        elsewhere = few_blocks(fmu, True, client=client)
        assert len(client.scheduler_info()["workers"]) == 2
    assert np.array_equal(peaks, elsewhere[0]) and np.array_equal(ends, elsewhere[1])


@pytest.mark.parametrize("notebook", [False, True])
def test_the_script_with_cells(fmu, tmp_path, monkeypatch, capsys, notebook):
    """From any folder; in a notebook, which has no `__file__`, from any folder of the project."""
    need("matplotlib")
    import matplotlib

    matplotlib.use("Agg")
    script = EXAMPLES / "python/record.py"
    if notebook:
        monkeypatch.chdir(script.parent)
        found = {}
        exec(script.read_text(), found)
    else:
        monkeypatch.chdir(tmp_path)
        found = runpy.run_path(str(script))
    assert "still standing" in capsys.readouterr().out
    result = found["result"]
    assert 0.02 < np.abs(result["theta"]).max() < 0.2
    assert np.abs(result["energy.residual"]).max() < 1e-7 * np.abs(result["energy.total"]).max()
