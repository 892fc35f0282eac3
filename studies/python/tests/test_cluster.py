"""Studies in parts on Dask and MPI, whose workers and clients die."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import rocking_block as rb

pytestmark = pytest.mark.check

RECORDS = Path(__file__).resolve().parents[3] / "examples/records"

STUDY = f"""
[study]
design = "latin-hypercube"
samples = 400
seed = 4
scales = [0.5, 2.0, 4.0]
[parameters]
alpha = {{ from = 0.1, to = 0.3 }}
p = {{ from = 1.0, to = 4.0 }}
[[records]]
horizontal = "{RECORDS}/*.smc"
"""


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    path = tmp_path_factory.mktemp("study") / "study.toml"
    path.write_text(STUDY)
    return path


@pytest.fixture(scope="module")
def whole(study):
    return rb.sweep(study)


def assert_whole(folder, parts, whole):
    """Tests that a folder has all parts, each once, with the rows of the study."""
    assert sorted(name for name in os.listdir(folder) if not name.startswith(".")) == [
        f"part-{number:05}-of-{parts:05}.parquet" for number in range(1, parts + 1)
    ]
    found = rb.read_table(folder)
    np.testing.assert_array_equal(found["row"], np.arange(whole.rows))
    for name in whole:
        np.testing.assert_array_equal(found[name], whole[name], err_msg=name)


def die_while_writing():
    """Makes the next part of this worker end within its file."""
    import rocking_block._parts as parts

    def write(self, name, content):
        (self.path / f".{name}.lost.tmp").write_bytes(content[: len(content) // 2])
        os.kill(os.getpid(), signal.SIGKILL)

    parts.Folder.write = write


def die_while_computing():
    import rocking_block._parts as parts

    parts._study = lambda source: os.kill(os.getpid(), signal.SIGKILL)


def test_workers_of_dask_that_die_lose_no_row(study, whole, tmp_path):
    distributed = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(n_workers=3, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        first, second, _ = client.scheduler_info()["workers"]
        client.run(die_while_writing, workers=[first])
        client.run(die_while_computing, workers=[second])
        executor = client.get_executor(retries=3, pure=False)
        rb.sweep(study, executor=executor, parts=24, out=tmp_path / "runs")
        # Both have died.
        assert not {first, second} & set(client.scheduler_info()["workers"])
        assert_whole(tmp_path / "runs", 24, whole)
        assert any(name.endswith(".tmp") for name in os.listdir(tmp_path / "runs"))
        table = rb.sweep(study, executor=executor, parts=7)
        for name in whole:
            np.testing.assert_array_equal(table[name], whole[name], err_msg=name)


CLIENT = """
import sys
from concurrent.futures import ProcessPoolExecutor

import rocking_block as rb

if __name__ == "__main__":
    with ProcessPoolExecutor(2) as pool:
        rb.sweep(sys.argv[1], executor=pool, parts=60, out=sys.argv[2])
"""


def test_a_client_that_died_makes_only_the_missing_parts(study, whole, tmp_path):
    (tmp_path / "client.py").write_text(CLIENT)
    runs = tmp_path / "runs"
    command = [sys.executable, tmp_path / "client.py", study, runs]
    client = subprocess.Popen(command, start_new_session=True)
    limit = time.monotonic() + 60
    while not runs.exists() or len(list(runs.glob("part-*"))) < 5:
        assert client.poll() is None and time.monotonic() < limit
        time.sleep(0.01)
    os.killpg(client.pid, signal.SIGKILL)
    client.wait()
    before = {file: file.stat().st_mtime_ns for file in runs.glob("part-*")}
    assert 5 <= len(before) < 60
    subprocess.run(command, check=True)
    assert_whole(runs, 60, whole)
    assert all(file.stat().st_mtime_ns == time for file, time in before.items())


def test_a_full_disk_is_one_line_and_leaves_the_other_parts(study, tmp_path):
    program = Path(os.environ.get("ROCKING", Path(__file__).resolve().parents[3] / "target/release/rocking"))
    runs = tmp_path / "runs"
    runs.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=512k", "none", runs], capture_output=True).returncode != 0:
        pytest.skip("a small file system cannot be mounted")
    try:

        def make(number, folder):
            command = [program, "sweep", study, "--part", f"{number}/8", "--out", folder, "--part-format", "csv"]
            return subprocess.run(command, capture_output=True, text=True)

        made = [make(number, runs) for number in range(1, 9)]
        complete = [number for number, run in enumerate(made, 1) if run.returncode == 0]
        assert 0 < len(complete) < 8
        for number, run in enumerate(made, 1):
            if number not in complete:
                place = re.escape(str(runs / f"part-{number:05}-of-00008.csv"))
                assert re.fullmatch(rf"rocking: {place}: cannot be written: No space left on device.*\n", run.stderr)
        assert sorted(os.listdir(runs)) == [f"part-{number:05}-of-00008.csv" for number in complete]
        # The parts that were written are those of a larger disk.
        for number in complete:
            make(number, tmp_path / "whole")
            name = f"part-{number:05}-of-00008.csv"
            assert (runs / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
    finally:
        subprocess.run(["umount", runs], check=True)


def example(engine):
    """The script of docs/studies/cluster.md for an engine, as it stands."""
    text = (Path(__file__).resolve().parents[3] / "docs/studies/cluster.md").read_text()
    return next(code for code in re.findall(r"```python\n(.*?)```", text, re.DOTALL) if f"from {engine} import" in code)


def test_ranks_of_mpi_make_the_parts_of_the_example(study, whole, tmp_path):
    pytest.importorskip("mpi4py")
    if shutil.which("mpirun") is None:
        pytest.skip("mpirun is not installed")
    shutil.copy(study, tmp_path / "study.toml")
    (tmp_path / "script.py").write_text(example("mpi4py.futures"))
    mpirun = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", "3"]
    subprocess.run([*mpirun, sys.executable, "-m", "mpi4py.futures", "script.py"], cwd=tmp_path, check=True)
    assert_whole(tmp_path / "runs", 100, whole)


def test_dask_makes_the_parts_of_the_example(study, whole, tmp_path):
    pytest.importorskip("distributed")
    shutil.copy(study, tmp_path / "study.toml")
    (tmp_path / "script.py").write_text(example("dask.distributed"))
    subprocess.run([sys.executable, "script.py"], cwd=tmp_path, check=True, timeout=600)
    assert_whole(tmp_path / "runs", 100, whole)
