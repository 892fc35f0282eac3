"""Studies in parts, on executors of `concurrent.futures`."""

import os
import re
import subprocess
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest
import rocking_block as rb

RECORDS = Path(__file__).resolve().parents[2] / "examples/records"

STUDY = {
    "study": {"design": "latin-hypercube", "samples": 12, "seed": 4, "scales": [0.5, 2.0, 4.0]},
    "parameters": {"alpha": {"from": 0.1, "to": 0.3}, "p": {"from": 1.0, "to": 4.0}, "foundation": ["rigid"]},
    "records": [{"horizontal": f"{RECORDS}/*.smc"}],
}


@pytest.fixture(scope="module")
def whole():
    return rb.sweep(STUDY)


@pytest.fixture(scope="module")
def processes():
    # The interpreter of the tests has threads, which a fork does not copy.
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        yield pool


def same(found, expected):
    columns = [name for name in found if name != "row"]
    assert columns == list(expected)
    for name in columns:
        np.testing.assert_array_equal(found[name], expected[name], err_msg=name)


def test_tables_of_processes_are_those_of_one(processes, whole):
    for parts in (None, 1, 5, 100):
        found = rb.sweep(STUDY, executor=processes, parts=parts)
        same(found, whole)
        assert found.units == whole.units


def test_workers_write_parts_that_are_read_as_one_table(processes, whole, tmp_path):
    assert rb.sweep(STUDY, executor=processes, parts=5, out=tmp_path / "runs") is None
    assert len(os.listdir(tmp_path / "runs")) == 5
    found = rb.read_table(tmp_path / "runs")
    same(found, whole)
    fit = rb.fragility(tmp_path / "runs", "PGV", limit=0.3)
    assert fit.median == rb.fragility(whole, "PGV", limit=0.3).median
    # Only the missing part is made.
    times = {file.name: file.stat().st_mtime_ns for file in (tmp_path / "runs").iterdir()}
    lost = tmp_path / "runs/part-00002-of-00005.csv"
    lost.unlink()
    with pytest.raises(ValueError, match="lacks 1 of 5 parts: 2; make these, or evaluate the others alone with partial=True"):
        rb.read_table(tmp_path / "runs")
    assert rb.read_table(tmp_path / "runs", partial=True).rows < whole.rows
    rb.sweep(STUDY, executor=processes, parts=5, out=tmp_path / "runs")
    same(rb.read_table(tmp_path / "runs"), whole)
    changed = {file.name for file in (tmp_path / "runs").iterdir() if file.stat().st_mtime_ns != times[file.name]}
    assert changed == {lost.name}
    other = STUDY | {"parameters": STUDY["parameters"] | {"epsilon": 0.1}}
    with pytest.raises(RuntimeError, match="part [1-5] of 5: .* is a part of another study"):
        rb.sweep(other, executor=processes, parts=5, out=tmp_path / "runs")


def studies_read():
    import rocking_block._parts as parts

    return parts._study.cache_info().misses


def test_a_worker_reads_a_study_and_its_records_once(whole):
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        same(rb.sweep(STUDY, executor=pool, parts=5), whole)
        assert pool.submit(studies_read).result() == 1


def test_parts_equal_those_of_the_program(processes, tmp_path):
    program = Path(os.environ.get("ROCKING", Path(__file__).resolve().parents[2] / "target/release/rocking"))
    (tmp_path / "study.toml").write_text(
        '[study]\ndesign = "grid"\n[parameters]\np = [1, 2, 3]\nfoundation = "rigid"\n'
        'pulse = { shape = "one-sine", amplitude = 6, period = 1 }\n'
    )
    rb.sweep(tmp_path / "study.toml", executor=processes, parts=2, out=tmp_path / "ours")
    for part in ("1/2", "2/2"):
        command = [program, "sweep", "study.toml", "--part", part, "--out", "its", "--part-format", "csv"]
        subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    for file in (tmp_path / "its").iterdir():
        assert file.read_bytes() == (tmp_path / "ours" / file.name).read_bytes()


class Failing(Executor):
    """Runs tasks at once, and loses one of them."""

    def __init__(self, lost):
        self.lost, self.begun = lost, []

    def submit(self, task, /, *arguments):
        future = Future()
        number = arguments[1]
        self.begun.append(number)
        if number == self.lost:
            future.set_exception(OSError("the worker is gone"))
        else:
            future.set_result(task(*arguments))
        return future


def test_a_lost_task_is_named_and_the_others_are_kept(tmp_path):
    with pytest.raises(RuntimeError, match="part 3 of 4: the worker is gone; the same call makes the missing parts"):
        rb.sweep(STUDY, executor=Failing(3), parts=4, out=tmp_path)
    assert len(list(tmp_path.iterdir())) == 3
    with pytest.raises(RuntimeError, match=r"part 2 of 4: the worker is gone$"):
        rb.sweep(STUDY, executor=Failing(2), parts=4)


def test_arguments_of_parts_say_what_they_expect(tmp_path):
    with ThreadPoolExecutor(1) as pool:
        for arguments, message in [
            ({"parts": 3}, "parts has no effect without an executor"),
            ({"executor": pool, "out": tmp_path / "table.csv"}, "expected a folder for the parts of an executor"),
            ({"executor": pool, "parts": 0}, "parts = 0; expected at least 1"),
        ]:
            with pytest.raises(ValueError, match=re.escape(message)):
                rb.sweep(STUDY, **arguments)


def test_outcomes_of_parts_are_those_of_one_call(processes):
    """Blocks with and without ties and friction; parts of some records, of some blocks, and of both."""
    blocks = rb.blocks(alpha=[0.1, 0.2, 0.3], p=2.0) + [
        rb.Block(alpha=0.2, p=2.0, friction=0.3),
        rb.Block(alpha=0.2, p=2.0, mass=1000.0, ties=[rb.Tie(block_x=0.0, block_z=2.0, ground_x=1.0, stiffness=1e4)]),
    ]
    records = [rb.read_record(file) for file in sorted(RECORDS.glob("*.smc"))]
    arguments = {"scale": [0.5, 2.0, 4.0], "periods": [0.5]}
    whole = rb.outcomes(blocks, records, **arguments)
    assert len(records) == 2 and set(whole["outcome"]) >= {"completed", "overturned"}
    for parts in (None, 1, 2, 7):
        found = rb.outcomes(blocks, records, executor=processes, parts=parts, **arguments)
        same(found, whole)
        assert (found.units, found.shape) == (whole.units, whole.shape)
    pulse = rb.Pulse("one-sine", amplitude=6.2622, period=1.2566)
    same(rb.outcomes(blocks[0], pulse=pulse, executor=processes), rb.outcomes(blocks[0], pulse=pulse))
    with pytest.raises(ValueError, match="scale has no effect without records"):
        rb.outcomes(blocks, pulse=pulse, scale=2.0, executor=processes)
    with pytest.raises(ValueError, match="friction_demand = -1"):
        rb.outcomes(blocks, pulse=pulse, friction_demand=-1.0, executor=processes)
    with pytest.raises(ValueError, match="parts has no effect without an executor"):
        rb.outcomes(blocks, pulse=pulse, parts=2)


def test_a_url_is_a_folder_of_any_storage(processes, whole, tmp_path):
    pytest.importorskip("fsspec")
    rb.sweep(STUDY, executor=processes, parts=3, out=f"file://{tmp_path}/runs")
    same(rb.read_table(tmp_path / "runs"), whole)
    assert len(os.listdir(tmp_path / "runs")) == 3
    rb.sweep(STUDY, executor=processes, parts=3, out=f"file://{tmp_path}/runs")
