"""README.md: its length, its figures against their sources, and its programs in C and Modelica. test_pages.py runs its commands and its
Python, test_peers.py and test_validation.py have more of its figures."""

import json
import re
import shutil
import subprocess
import sys
from itertools import takewhile
from pathlib import Path

import pytest
from conftest import ROOT

README = (ROOT / "README.md").read_text()
TEXT = " ".join(README.split())
# Their prose has at most 120 characters in a line. Tables, pictures and output may have more.
NARROW = sorted(["README.md", "CHANGELOG.md", *(str(path.relative_to(ROOT)) for path in (ROOT / "docs").rglob("*.md"))])


def test_the_readme_is_short():
    assert README.count("\n") <= 120


@pytest.mark.parametrize("page", NARROW)
def test_lines_are_narrow(page):
    prose = re.sub(r"```.*?```", "", (ROOT / page).read_text(), flags=re.DOTALL)
    wide = [line for line in prose.splitlines() if len(line) > 120 and not line.startswith("    ") and not line.lstrip().startswith(("|", "!["))]
    assert not wide


@pytest.mark.parametrize("page", NARROW)
def test_tables_have_a_row_in_each_line(page):
    """A wrapped table is a paragraph of bars."""
    prose = re.sub(r"```.*?```", "", (ROOT / page).read_text(), flags=re.DOTALL)
    assert not [line for line in prose.splitlines() if re.search(r"\| ?:?---+", line) and not line.lstrip().startswith("|")]
    assert "| | ---" not in prose


def test_the_number_of_trajectories():
    every, restricted = 0, 0
    for folder in ("reference", "reference_more", "reference_links"):
        for case in json.loads((ROOT / f"tests/{folder}/cases.json").read_text()):
            every += 1
            # Only records that may not be redistributed are used by trajectories.
            restricted += '"kind": "record"' in json.dumps(case)
    assert f"{every} trajectories of an independent solver agree to" in TEXT
    assert f"the records for {every - restricted} of them" in TEXT


def test_the_accuracy_of_the_trajectories():
    close = re.search(r"const CLOSE: f64 = (\S+);", (ROOT / "tests/simulation/beyond/mod.rs").read_text())[1]
    bound = re.search(r'name: "theta", unit: "alpha", all: \[\S+, (\S+)\], sensitive: \[\S+, (\S+)\]', (ROOT / "tests/common/compare.rs").read_text())
    assert float(bound[1]) <= float(close)
    assert f"agree to {close} α in rotation (a sensitive one to {bound[2]} α)" in TEXT


def test_the_baselines_of_the_validation():
    """test_validation.py recomputes docs/unit/validation.md from the data."""
    lines = (ROOT / "docs/unit/validation.md").read_text().split("| SP1: accuracy")[1].splitlines()[2:]
    table = {cells[1].strip(" *"): [cells[2].strip(" *"), cells[5].strip(" *")]
             for cells in (line.split("|") for line in takewhile(lambda line: line.startswith("|"), lines))}

    def percent(row):
        return [f"{100 * float(accuracy):.0f} %" for accuracy in next(cells for name, cells in table.items() if row in name)]

    for words, row in (("predicts the outcome of", "nothing fitted"), ('"always stays" gets', "always stays"),
                       ("a fitted PGV threshold", "PGV threshold")):
        first, second = percent(row)
        assert f"{words} {first} and {second}" in TEXT


def test_the_guide_lists_variables_of_the_fmu():
    guide = (ROOT / "docs/guides/fmu.md").read_text()
    names = re.findall(r'<ScalarVariable name="([^"]+)"', (ROOT / "modelDescription.xml").read_text())
    listed = re.findall(r"^\| (\d+) \| `([^`]+)`", guide, re.MULTILINE)
    assert [int(number) for number, _ in listed] == list(range(1, 11))
    assert {name for _, name in listed} <= set(names)


def test_the_program_in_c(tmp_path, fmu):
    headers = Path(pytest.importorskip("fmpy").__file__).parent / "c-code"
    if not (shutil.which("gcc") and sys.platform == "linux"):
        pytest.skip("needs gcc on Linux")
    source = (ROOT / "examples/fmu/shake.c").read_text()
    for line in re.search(r"```c\n(.*?)```", README, re.DOTALL)[1].splitlines():
        assert line.strip() in source, line
    for link, path in {"target/release/RockingBlock.fmu": fmu, "examples": ROOT / "examples"}.items():
        (tmp_path / link).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / link).symlink_to(path)
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin/python").write_text(f'#!/bin/sh\nexec {sys.executable} "$@"\n')
    (tmp_path / "bin/python").chmod(0o755)
    page = (ROOT / "examples/fmu/README.md").read_text().split("## C")[1].split("## Modelica")[0]
    commands = "\n".join(line[4:] for line in page.splitlines() if line.startswith("    "))
    made = subprocess.run(["bash", "-euc", f"PATH=$PWD/bin:$PATH\n{commands}"], cwd=tmp_path, capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    assert headers.is_dir() and float(re.fullmatch(r"largest rotation (-?[\d.]+) rad\n", made.stdout)[1]) > 0.01


def test_the_readme_shows_the_model_in_modelica():
    source = (ROOT / "examples/fmu/Shaken.mo").read_text()
    lines = re.search(r"```modelica\n(.*?)```", README, re.DOTALL)[1].splitlines()
    assert len(lines) > 4 and all(line in source for line in lines)


@pytest.mark.check
def test_the_model_in_modelica(tmp_path, fmu):
    if not shutil.which("omc"):
        pytest.skip("OpenModelica is not installed")
    script = f'''
        loadModel(Modelica);
        importFMU("{fmu}");
        loadFile("RockingBlock_me_FMU.mo");
        loadFile("{ROOT}/examples/fmu/Shaken.mo");
        result := simulate(Shaken, stopTime = 10, tolerance = 1e-8, outputFormat = "csv");
        getErrorString();
    '''
    (tmp_path / "run.mos").write_text(script)
    made = subprocess.run(["omc", "run.mos"], cwd=tmp_path, capture_output=True, text=True)
    assert (tmp_path / "Shaken_res.csv").exists(), made.stdout


def test_links_in_the_tree_lead_to_files():
    """The licences of the Python package are links, and its wheel is built without those that lead nowhere."""
    listed = subprocess.run(["git", "ls-files", "--stage"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    links = [ROOT / line.split("\t")[1] for line in listed.splitlines() if line.startswith("120000")]
    assert links and all(link.exists() for link in links), links
