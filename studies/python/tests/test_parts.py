"""Studies in parts, on executors of `concurrent.futures`."""

import os
import re
import signal
import subprocess
import sys
import time
from collections import Counter
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest
import rocking_block as rb

RECORDS = Path(__file__).resolve().parents[3] / "examples/records"

STUDY = {
    "study": {"design": "latin-hypercube", "samples": 12, "seed": 4, "scales": [0.5, 2.0, 4.0]},
    "parameters": {"alpha": {"from": 0.1, "to": 0.3}, "p": {"from": 1.0, "to": 4.0}, "foundation": ["rigid"]},
    "records": [{"horizontal": f"{RECORDS}/*.smc"}],
}


STUDY_TEXT = f"""
[study]
design = "latin-hypercube"
samples = 40
seed = 4
scales = [0.5, 2.0, 4.0]
[parameters]
alpha = {{ from = 0.1, to = 0.3 }}
p = {{ from = 1.0, to = 4.0 }}
[[records]]
horizontal = "{RECORDS}/*.smc"
"""


@pytest.fixture(scope="module")
def whole():
    return rb.sweep(STUDY)


@pytest.fixture(scope="module")
def processes():
    with ProcessPoolExecutor(2) as pool:
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
    lost = tmp_path / "runs/part-00002-of-00005.parquet"
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


def without_its_end(content):
    return content[: len(content) // 2]


def empty(content):
    return b""


def spoilt(content):
    return content[:50] + bytes(100) + content[150:]


@pytest.mark.parametrize("damage", [without_its_end, empty, spoilt])
@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_a_damaged_part_is_named_with_its_remedy(damage, ending, whole, tmp_path):
    with ThreadPoolExecutor(1) as pool:
        rb.sweep(STUDY, executor=pool, parts=3, part_format=ending, out=tmp_path)
    assert rb.fragility(tmp_path, "PGV", limit=0.3).rows > 0
    file = tmp_path / f"part-00002-of-00003.{ending}"
    file.write_bytes(damage(file.read_bytes()))
    message = rf"{re.escape(str(file))}: is damaged: .*; make it anew: delete it, and run part 2 of 3 again$"
    for read in (lambda: rb.read_table(tmp_path), lambda: rb.fragility(tmp_path, "PGV", limit=0.3)):
        with pytest.raises(ValueError, match=message):
            read()
    # The next call makes it anew, in the format of the others.
    with ThreadPoolExecutor(1) as pool:
        rb.sweep(STUDY, executor=pool, parts=3, out=tmp_path)
    same(rb.read_table(tmp_path), whole)
    assert len(os.listdir(tmp_path)) == 3


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_a_flipped_bit_is_named(ending, whole, tmp_path):
    with ThreadPoolExecutor(1) as pool:
        rb.sweep(STUDY, executor=pool, parts=3, part_format=ending, out=tmp_path)
    file = tmp_path / f"part-00002-of-00003.{ending}"
    content = file.read_bytes()
    for bit in np.random.default_rng(1).integers(0, 8 * len(content), 200).tolist():
        flipped = bytearray(content)
        flipped[bit // 8] ^= 1 << (bit % 8)
        file.write_bytes(flipped)
        with pytest.raises(ValueError, match=rf"{re.escape(str(file))}: is damaged: .*; make it anew: delete it, and run part 2 of 3 again$"):
            rb.read_table(tmp_path)
    file.write_bytes(content)
    same(rb.read_table(tmp_path), whole)


def test_a_table_and_parts_are_parquet(whole, tmp_path):
    """A folder keeps the format and the set with which it was begun."""
    rb.sweep(STUDY, out=tmp_path / "whole.parquet")
    same(rb.read_table(tmp_path / "whole.parquet"), whole)
    with pytest.raises(ValueError, match="exists already"):
        rb.sweep(STUDY, out=tmp_path / "whole.parquet")
    with ThreadPoolExecutor(1) as pool:
        rb.sweep(STUDY, executor=pool, parts=2, out=tmp_path / "runs")
        assert sorted(os.listdir(tmp_path / "runs")) == ["part-00001-of-00002.parquet", "part-00002-of-00002.parquet"]
        same(rb.read_table(tmp_path / "runs"), whole)
        for arguments in ({"parts": 3}, {"parts": 2, "part_format": "csv"}):
            with pytest.raises(ValueError, match="runs: has parts of another set, such as part-0000.-of-00002.parquet; expected some of"):
                rb.sweep(STUDY, executor=pool, out=tmp_path / "runs", **arguments)
        with pytest.raises(ValueError, match="part_format has no effect"):
            rb.sweep(STUDY, executor=pool, part_format="csv")


def test_the_example_of_processes_runs_as_it_stands(tmp_path):
    """The start method is that of the platform: a fork has no threads of its parent, which has read the study and its records."""
    (tmp_path / "study.toml").write_text(STUDY_TEXT)
    text = (Path(__file__).resolve().parents[3] / "docs/studies/cluster.md").read_text()
    (tmp_path / "script.py").write_text(re.search(r"```python\n(from concurrent.futures .*?)```", text, re.DOTALL)[1])
    run = subprocess.run([sys.executable, "script.py"], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert run.returncode == 0, run.stderr
    assert "PGV" in run.stdout and len(list((tmp_path / "runs").iterdir())) >= 1
    # Once more in a process that has read a study, and forks workers that read and fit.
    script = """
import rocking_block as rb
from concurrent.futures import ProcessPoolExecutor
table = rb.sweep("study.toml")
fit = rb.fragility(table, "PGV", limit=0.3)
rb.intensity(rb.read_record(RECORD))
if __name__ == "__main__":
    with ProcessPoolExecutor(2) as pool:
        assert rb.sweep("study.toml", executor=pool, parts=3).rows == table.rows
        assert pool.submit(rb.fragility, table, "PGV", limit=0.3).result().median == fit.median
"""
    (tmp_path / "script.py").write_text(script.replace("RECORD", repr(str(RECORDS / "0111a.smc"))))
    run = subprocess.run([sys.executable, "script.py"], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert run.returncode == 0, run.stderr


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_keys_of_folders_are_columns(ending, tmp_path):
    """Each folder named key=value has the parts of a study of its own, or other files."""
    studies = {"north": STUDY, "the%20south": STUDY | {"study": STUDY["study"] | {"seed": 5}}}
    with ThreadPoolExecutor(1) as pool:
        for number, (region, study) in enumerate(studies.items(), 1):
            folder = tmp_path / f"region={region}" / f"year={2010 + number}"
            rb.sweep(study, executor=pool, parts=number + 1, part_format=ending, out=folder)
    table = rb.read_table(tmp_path)
    tables = {region.replace("%20", " "): rb.sweep(study) for region, study in studies.items()}
    assert table.rows == sum(one.rows for one in tables.values())
    for region, year in (("north", 2011.0), ("the south", 2012.0)):
        one = table[table["region"] == region]
        np.testing.assert_array_equal(one["year"], np.full(tables[region].rows, year))
        np.testing.assert_array_equal(np.sort(one["p"]), np.sort(tables[region]["p"]))
    fit = rb.fragility(tmp_path, "PGV", limit=0.3)
    together = rb.Table.concat([rb.Table({name: one[name] for name in one}, one.units) for one in tables.values()])
    assert fit.rows == table.rows and np.isclose(fit.median, rb.fragility(together, "PGV", limit=0.3).median, rtol=1e-9)
    np.testing.assert_array_equal(rb.read_table(f"{tmp_path}/region=*/*/*.{ending}")["region"], table["region"])
    assert "region" not in rb.read_table(tmp_path / "region=north")
    (tmp_path / f"region=the%20south/year=2012/part-00003-of-00003.{ending}").unlink()
    with pytest.raises(ValueError, match="region=the%20south/year=2012: lacks 1 of 3 parts: 3"):
        rb.read_table(tmp_path)
    assert rb.read_table(tmp_path, partial=True).rows < table.rows


def test_keys_of_a_dataset_of_others_are_columns(tmp_path):
    """pyarrow, as Dask and Spark, leaves the key out of the files; a file with the column keeps its own."""
    pyarrow = pytest.importorskip("pyarrow")
    import pyarrow.parquet

    rows = {"PGV": [0.2, 0.3, 0.4, 0.5, 0.6, 0.8], "outcome": ["completed", "overturned"] * 3, "record": ["7", "8", "7", "8", "7", ""]}
    pyarrow.parquet.write_to_dataset(pyarrow.table(rows), tmp_path / "runs", partition_cols=["record"])
    table = rb.read_table(tmp_path / "runs")
    order = np.argsort(table["PGV"])
    assert table["record"][order].tolist() == rows["record"]
    assert rb.fragility(tmp_path / "runs", "PGV").independence == rb.fragility(rows, "PGV").independence != "rows"
    (tmp_path / "own/record=9").mkdir(parents=True)
    pyarrow.parquet.write_table(pyarrow.table(rows), tmp_path / "own/record=9/a.parquet")
    assert rb.read_table(tmp_path / "own")["record"].tolist() == rows["record"]


def test_a_worker_reads_a_study_and_its_records_once(whole):
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        same(rb.sweep(STUDY, executor=pool, parts=5), whole)
        assert pool.submit(studies_read).result() == 1


def test_parts_equal_those_of_the_program(processes, tmp_path):
    program = Path(os.environ.get("ROCKING", Path(__file__).resolve().parents[3] / "target/release/rocking"))
    (tmp_path / "study.toml").write_text(
        '[study]\ndesign = "grid"\n[parameters]\np = [1, 2, 3]\nfoundation = "rigid"\n'
        'pulse = { shape = "one-sine", amplitude = 6, period = 1 }\n'
    )
    rb.sweep(tmp_path / "study.toml", executor=processes, parts=2, part_format="csv", out=tmp_path / "ours")
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


def die_while_writing():
    """Makes the second part of this worker end within its file."""
    import rocking_block._parts as parts

    write, written = parts.Folder.write, []

    def writing(self, name, content):
        if written:
            (self.path / f".{name}.lost.tmp").write_bytes(content[: len(content) // 2])
            os.kill(os.getpid(), signal.SIGKILL)
        written.append(name)
        write(self, name, content)

    parts.Folder.write = writing


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGKILL")
def test_a_killed_worker_loses_only_its_part(processes, whole, tmp_path):
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        pool.submit(die_while_writing).result()
        with pytest.raises(RuntimeError, match=r"part [2-4] of 4: .*terminated abruptly.*; the same call makes the missing parts"):
            rb.sweep(STUDY, executor=pool, parts=4, out=tmp_path)
    assert [file.name for file in tmp_path.glob("part-*")] == ["part-00001-of-00004.parquet"]
    kept = (tmp_path / "part-00001-of-00004.parquet").stat().st_mtime_ns
    rb.sweep(STUDY, executor=processes, parts=4, out=tmp_path)
    same(rb.read_table(tmp_path), whole)
    assert (tmp_path / "part-00001-of-00004.parquet").stat().st_mtime_ns == kept


class Waiting(Executor):
    """Runs the first tasks at once; the others wait for a worker."""

    def __init__(self, begun):
        self.begun, self.waiting = begun, []

    def submit(self, task, /, *arguments):
        future = Future()
        if self.begun:
            self.begun -= 1
            future.set_result(task(*arguments))
        else:
            self.waiting.append(future)
        return future


def test_ctrl_c_cancels_the_parts_that_have_not_begun(monkeypatch, tmp_path):
    import contextlib

    import rocking_block._parts as parts

    @contextlib.contextmanager
    def ticking(progress):
        def tick(done, total):
            raise KeyboardInterrupt

        yield tick

    monkeypatch.setattr(parts, "ticking", ticking)
    executor = Waiting(2)
    with pytest.raises(KeyboardInterrupt):
        rb.sweep(STUDY, executor=executor, parts=5, out=tmp_path)
    assert len(executor.waiting) == 3 and all(future.cancelled() for future in executor.waiting)
    assert len(list(tmp_path.iterdir())) == 2


class Slow(ThreadPoolExecutor):
    """Takes longer for a task than a bar needs to show it."""

    def submit(self, task, /, *arguments):
        return super().submit(lambda: (time.sleep(0.15), task(*arguments))[1])


def test_the_bar_of_an_executor_shows_rows(capsys, whole):
    pytest.importorskip("tqdm")
    with Slow(1) as pool:
        rb.sweep(STUDY, executor=pool, parts=4, progress=True)
    assert whole.rows == 72
    assert {"18/72", "36/72", "54/72"} & set(re.findall(r"\d+/\d+", capsys.readouterr().err))


class Counting(Executor):
    """Runs tasks at once, and counts the records that they are given."""

    def __init__(self):
        self.sent = Counter()

    def submit(self, task, /, *arguments):
        self.sent.update(id(record) for pair in arguments[1] for record in pair if record is not None)
        future = Future()
        future.set_result(task(*arguments))
        return future


def test_a_record_is_sent_once_if_there_are_enough():
    """With more parts than records, each goes with as few parts as there are."""
    record = rb.read_record(sorted(RECORDS.glob("*.smc"))[0])
    records = [rb.Record(record.acceleration * factor, record.dt) for factor in (1.0, 1.1, 1.2, 1.3)]
    blocks = rb.blocks(alpha=[0.1, 0.2, 0.3], p=2.0)
    for parts, times in ((2, 1), (4, 1), (8, 2), (100, 3)):
        executor = Counting()
        rb.outcomes(blocks, records, executor=executor, parts=parts)
        assert sorted(executor.sent.values()) == [times] * 4, parts


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
    # As they are written, they are read.
    same(rb.read_table(f"file://{tmp_path}/runs"), whole)
    assert rb.fragility(f"file://{tmp_path}/runs", "PGV", limit=0.3).rows == whole.rows
    part = next((tmp_path / "runs").iterdir())
    part.write_bytes(part.read_bytes()[:-1])
    with pytest.raises(ValueError, match=f"^file://{tmp_path}/runs/{part.name}: is damaged: "):
        rb.read_table(f"file://{tmp_path}/runs")


def test_a_number_is_no_executor():
    message = r"executor = 4; expected an executor of concurrent.futures, such as ProcessPoolExecutor\(4\); threads=4"
    with pytest.raises(TypeError, match=message):
        rb.sweep("study.toml", executor=4)
    with pytest.raises(TypeError, match=message):
        rb.outcomes(rb.Block(), pulse=rb.Pulse("one-sine", 1.0, 1.0), executor=4)
