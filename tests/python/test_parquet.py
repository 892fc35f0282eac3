"""Tables of the program as Parquet, read by pyarrow and by the program itself."""

import json
import subprocess

import numpy as np
import pyarrow.csv
import pyarrow.parquet
import pytest
from conftest import ROOT

pytestmark = pytest.mark.check

SPECTRUM = ["spectrum", "--alpha", "0.15,0.3", "--p-from", "1", "--p-to", "4", "--points", "7", "--foundation", "rigid"]
PULSE = ["--pulse", "one-sine", "--amplitude", "4", "--period", "0.8"]
RECORD = str(ROOT / "examples/records/np01002p_4225a_a.smc")
SWEEP = f"""
[study]
design = "grid"
levels = {{ im = "PGV", values = [0.4, 0.8, 1.2, 1.6, 2.4] }}
[parameters]
foundation = "rigid"
alpha = {{ from = 0.1, to = 0.3, count = 10 }}
friction = ["none", 0.3]
[[records]]
horizontal = "{RECORD}"
"""


def run(program, *words):
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def tables(program, folder, *command):
    """Returns the tables that a command writes as CSV and as Parquet."""
    for name in ("table.csv", "table.parquet"):
        run(program, *command, "--csv", folder / name)
    read = pyarrow.csv.read_csv
    lines = (folder / "table.csv").read_text().splitlines()
    skipped = sum(line.startswith("#") for line in lines)
    csv = read(folder / "table.csv", read_options=pyarrow.csv.ReadOptions(skip_rows=skipped))
    return csv, pyarrow.parquet.read_table(folder / "table.parquet"), [line[2:] for line in lines[:skipped]]


@pytest.mark.parametrize("command", [
    ["simulate", *PULSE],
    ["record", RECORD],
    ["pulse", RECORD],
    ["search", "overturning", "--foundation", "rigid", "--period", "0.8"],
    ["sweep", "study.toml"],
], ids=lambda command: command[0])
def test_both_formats_have_the_same_values(program, command, tmp_path):
    (tmp_path / "study.toml").write_text(SWEEP)
    command = [str(tmp_path / word) if word == "study.toml" else word for word in command]
    csv, parquet, study = tables(program, tmp_path, *command)
    units = json.loads(parquet.schema.metadata[b"units"])
    assert parquet.schema.metadata[b"study"].decode().splitlines() == study
    headings = [f"{name} [{units[name]}]" if name in units else name for name in parquet.column_names]
    assert headings == csv.column_names
    for heading, name in zip(headings, parquet.column_names, strict=True):
        found, expected = parquet[name], csv[heading]
        if pyarrow.types.is_floating(found.type):
            # pyarrow reads a column of CSV without a fraction as whole numbers.
            numbers = [column.cast("float64").fill_null(np.nan).to_numpy() for column in (found, expected)]
            np.testing.assert_array_equal(*numbers, heading)
        else:
            assert texts(found) == texts(expected), heading


def texts(column):
    """Returns the values of a column as texts, empty for missing ones, and true and false as the program writes them."""
    values = ["" if value is None else value for value in column.to_pylist()]
    return [str(value).lower() if isinstance(value, bool) else str(value) for value in values]


def test_the_program_fits_the_same_curve_to_both(program, tmp_path):
    (tmp_path / "study.toml").write_text(SWEEP)
    tables(program, tmp_path, "sweep", tmp_path / "study.toml")
    fits = [run(program, "fragility", tmp_path / name, "--im", "PGV", "--limit", "0.1") for name in ("table.csv", "table.parquet")]
    assert fits[0].replace("table.csv", "table.parquet") == fits[1]


def test_a_table_is_written_whole_and_replaced_only_by_force(program, tmp_path):
    (tmp_path / "study.toml").write_text(SWEEP)
    command = [program, "sweep", tmp_path / "study.toml", "--csv", tmp_path / "table.parquet"]
    for words, message in [
        (["--resume"], "a Parquet table is written whole; expected a table in .csv for --resume"),
        ([], None),
        ([], "exists already; expected --force to replace it, or another name"),
        (["--force"], None),
    ]:
        done = subprocess.run([*command, *words], capture_output=True, text=True)
        assert (message is None) == (done.returncode == 0) and (message or "") in done.stderr, done.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["study.toml", "table.parquet"]


def test_broken_parts_are_made_anew_and_named_by_readers(program, tmp_path):
    (tmp_path / "study.toml").write_text(SWEEP)
    runs = tmp_path / "runs"

    def make(number):
        return run(program, "sweep", tmp_path / "study.toml", "--part", f"{number}/2", "--out", runs, "--part-format", "parquet")

    def fit():
        command = [program, "fragility", runs, "--im", "PGV", "--limit", "0.1"]
        return subprocess.run(command, capture_output=True, text=True)

    make(1), make(2)
    expected = fit()
    assert expected.returncode == 0, expected.stderr
    file = runs / "part-00002-of-00002.parquet"
    content = file.read_bytes()
    for cut in (0, 3, 100, len(content) // 2, len(content) - 1):
        file.write_bytes(content[:cut])
        message = fit().stderr
        assert message.startswith(f"rocking: {file}: is damaged: "), message
        assert message.endswith("; make it anew: delete it, and run part 2 of 2 again\n"), message
        make(2)
        assert file.read_bytes() == content, cut
    # The checksum in the end knows what is before it.
    file.write_bytes(content[:10] + bytes(100) + content[110:])
    assert "make it anew: delete it" in fit().stderr and "complete before" not in make(2)
    assert file.read_bytes() == content and fit().stdout == expected.stdout
