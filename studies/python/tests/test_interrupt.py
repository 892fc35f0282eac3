"""Ctrl-C ends long work within a second."""

import signal
import subprocess
import sys

import pytest

WORK = {
    "a run": "rb.Block(alpha=0.25, p=1.0, eta=80, xi_v=0.0).run(theta=0.2, on_separation='fly', duration=5e5, step=1.0, tolerance=1e-13)",
    "a spectrum": "rb.spectrum(p=np.linspace(1, 4, 1_000_000), pulse=pulse)",
    "a sweep": "rb.sweep({'study': {'design': 'grid'}, 'parameters': {'pulse': {'shape': 'OneSine', 'amplitude': 6.0}, "
    "'dimensionless.p': {'from': 1.0, 'to': 4.0, 'count': 1000000}}})",
    "a search": "rb.search_overturning(rb.Block(), pulse=pulse, points=1_000_000)",
}


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGINT for another process")
@pytest.mark.parametrize("work", WORK)
def test_ctrl_c_ends_the_work(work):
    program = f"""
import contextlib, signal
import numpy as np, rocking_block as rb
from rocking_block import _block, _outcomes, _search, _studies

# A shell's background jobs ignore SIGINT.
signal.signal(signal.SIGINT, signal.default_int_handler)

@contextlib.contextmanager
def ticking(progress):
    said = []
    yield lambda done, total: said or said.append(print("under way", flush=True))

_block.ticking = _outcomes.ticking = _search.ticking = _studies.ticking = ticking
pulse = rb.Pulse("one-sine", 6.0, 1.25)
try:
    {WORK[work]}
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True) as process:
        # The work reports its progress.
        assert process.stdout.readline() == "under way\n"
        process.send_signal(signal.SIGINT)
        assert process.stdout.readline() == "interrupted\n"
        process.wait(10)
    assert process.returncode == 0


def test_a_bar_shows_how_far_the_work_is(capsys):
    pytest.importorskip("tqdm")
    import rocking_block as rb

    rb.spectrum(p=[1.0 + 0.00001 * i for i in range(60_000)], pulse=rb.Pulse("one-sine", 6.0, 1.25), progress=True)
    assert "/60000" in capsys.readouterr().err


STUDY = """[study]
design = "latin-hypercube"
samples = 1500
seed = 1
[parameters]
p = { from = 1, to = 4 }
pulse.shape = "one-sine"
pulse.amplitude = { from = 4, to = 9 }
pulse.period = 1.3
"""


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGINT for another process")
def test_ctrl_c_keeps_rows_for_the_next_call(tmp_path):
    """A call after Ctrl-C in the same process continues."""
    import rocking_block as rb

    (tmp_path / "study.toml").write_text(STUDY.replace("samples = 1500", "samples = 20000"))
    program = """
import signal
import rocking_block as rb
from rocking_block import _studies
import contextlib

signal.signal(signal.SIGINT, signal.default_int_handler)
said = []

@contextlib.contextmanager
def ticking(progress):
    yield lambda done, total: done > 500 and not said and said.append(print("under way", flush=True))

_studies.ticking = ticking
try:
    rb.sweep("study.toml", out="table.csv")
except KeyboardInterrupt:
    print(open("table.csv").read().count("\\n"), flush=True)
print(rb.sweep("study.toml", out="table.csv").rows)
"""
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True, cwd=tmp_path) as process:
        assert process.stdout.readline() == "under way\n"
        process.send_signal(signal.SIGINT)
        assert 100 < int(process.stdout.readline()) < 20000
        assert process.stdout.readline() == "20000\n"
    assert rb.sweep(tmp_path / "study.toml", out=tmp_path / "table.csv") == rb.sweep(tmp_path / "study.toml")


def test_a_table_in_a_file_is_that_of_the_program_and_of_one_study(tmp_path, rocking):
    import rocking_block as rb

    study, out = tmp_path / "study.toml", tmp_path / "table.csv"
    study.write_text(STUDY)
    whole = rb.sweep(study)
    assert rb.sweep(study, out=out) == whole
    content = out.read_bytes()
    subprocess.run([rocking.program, "sweep", study, "--csv", tmp_path / "program.csv"], check=True, capture_output=True)
    assert (tmp_path / "program.csv").read_bytes() == content
    out.write_bytes(content[: len(content) * 2 // 3])
    assert rb.sweep(study, out=out) == whole and out.read_bytes() == content
    study.write_text(STUDY.replace("seed = 1", "seed = 2"))
    with pytest.raises(ValueError, match="table.csv:.*the table is that of another study; found"):
        rb.sweep(study, out=out)
    assert out.read_bytes() == content
    study.write_text(STUDY)
    assert rb.sweep(study, out=tmp_path / "table.parquet") == whole
    read = rb.read_table(tmp_path / "table.parquet")
    assert all(list(map(str, read[name])) == list(map(str, whole[name])) for name in ("outcome", "peak.theta/alpha"))
    with pytest.raises(ValueError, match="out = table.txt; expected a name in .csv or .parquet"):
        rb.sweep(study, out="table.txt")
