"""Runs the commands and the Python of README.md and docs, compares output and pictures with the pages, and follows all links.

`python tests/python/test_pages.py` writes the output and the pictures of today's program into the pages.
"""

import contextlib
import io
import json
import os
import re
import shlex
import subprocess
import sys
import tomllib
from importlib.util import find_spec
from itertools import takewhile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
COMMAND_PAGES = [ROOT / page for page in (
    "README.md", "docs/studies/program.md", "docs/studies/python.md", "docs/studies/foundations.md", "docs/tutorial.md", "docs/gallery.md", "docs/studies/pulses.md",
    "docs/guides/record.md", "docs/guides/foundation.md", "docs/guides/fragility.md", "docs/guides/analysis.md")]
PYTHON_PAGES = [ROOT / page for page in ("README.md", "docs/studies/python.md", "docs/unit/importing.md", "docs/guides/fmu.md", "docs/studies/frames.md",
                                             "docs/guides/slenderness.md",
                                             "docs/guides/analysis.md",
                                             "docs/studies/floors.md")]
PROGRAM = Path(os.environ.get("ROCKING_BLOCK_PROGRAM", ROOT / "target/release/rocking"))
FMU = Path(os.environ.get("ROCKING_BLOCK_FMU", ROOT / "target/release/RockingBlock.fmu"))
# A block of indented lines after an empty one, and a fence.
SHELL = re.compile(r"(?<=\n\n)((?: {4,}\S.*\n|\n(?= {4}))+)")
PYTHON = re.compile(r"```python\n(.*?)```", re.DOTALL)
# These build the project; scripts/test has run them before it comes here.
BUILDS = ("cargo run", "scripts/test", "pip install")
PRINT = re.compile(r"^(print\(.*\))  # (.*)$", re.MULTILINE)


def shell_blocks(page):
    return [match[0] for match in SHELL.finditer(PYTHON.sub("", page.read_text()))]


def commands(block):
    """Splits a block into commands, each with the lines printed below it."""
    lines = [line.strip() if line.rstrip().endswith("\\") else line.rstrip() for line in block.splitlines()]
    indent = min(len(line) - len(line.lstrip()) for line in block.splitlines() if line)
    found, text = [], "\n".join(line[indent:] if line.startswith(" ") else line for line in lines)
    for line in text.replace("\\\n", " ").splitlines():
        if line.startswith(("target/release/", "python ", *BUILDS)):
            found.append((line, []))
        else:
            assert found, f"`{line}` stands in a block that begins without a known command"
            found[-1][1].append(line)
    return [(command, "\n".join(printed).strip("\n")) for command, printed in found]


class Workplace:
    """A folder in which the pages' commands find their files and leave their results."""

    def __init__(self, folder):
        self.folder, self.printed = folder, {}
        (folder / "target/release").mkdir(parents=True)
        (folder / "examples").mkdir()
        examples = {f"examples/{path.name}": path for path in (ROOT / "examples").iterdir() if path.name != "motions"}
        for link, path in {"target/release/rocking": PROGRAM, "target/release/RockingBlock.fmu": FMU, **examples}.items():
            (folder / link).symlink_to(path)

    def run(self, command):
        """Returns the output of a command without trailing blanks. A command on several pages runs once."""
        if command not in self.printed:
            words = [word for part in shlex.split(command)
                     for word in (map(str, sorted(self.folder.glob(part))) if "*" in part else [part])]
            words[0] = sys.executable if words[0] == "python" else str(self.folder / words[0])
            made = subprocess.run(words, cwd=self.folder, capture_output=True, text=True)
            assert made.returncode == 0, f"{command}\n{made.stderr}"
            self.printed[command] = "\n".join(line.rstrip() for line in made.stdout.splitlines())
        return self.printed[command]

    def pictures(self):
        """Returns the pictures that the commands have drawn and docs shows, each with its file in docs."""
        return {picture: ROOT / "docs/pictures" / picture.name for picture in self.folder.glob("*.png") if (ROOT / "docs/pictures" / picture.name).exists()}

    def prints(self, page):
        """Runs the Python of a page; returns pairs of expected and actual output lines."""
        names, pairs, before = {}, [], Path.cwd()
        os.chdir(self.folder)
        try:
            for code in PYTHON.findall(page.read_text()):
                if "print(" not in code:
                    continue  # a fragment, such as one call on a page about several tools
                if any(f"import {package}" in code and find_spec(package) is None for package in ("duckdb", "polars")):
                    continue  # scripts/dev/check installs them
                out = io.StringIO()
                with contextlib.redirect_stdout(out):
                    exec(compile(code, page.name, "exec"), names)
                said = [match[1] for match in PRINT.findall(code)]
                assert len(said) == code.count("print("), f"a print in {page.name} lacks its expected output"
                pairs += zip(said, out.getvalue().splitlines(), strict=True)
        finally:
            os.chdir(before)
        return pairs


def test_commands_print_what_the_pages_say(tmp_path):
    place = Workplace(tmp_path)
    for page in COMMAND_PAGES:
        found = [pair for block in shell_blocks(page) for pair in commands(block)]
        assert found, page
        for command, expected in found:
            if not command.startswith(BUILDS):
                printed = place.run(command)
                assert not expected or printed == expected, command
    assert len(place.printed) > 10
    pictures = place.pictures()
    assert len(pictures) == 15
    for drawn, shown in pictures.items():
        assert drawn.read_bytes() == shown.read_bytes(), f"{shown} is not what the commands of the pages draw"


def test_python_prints_what_the_pages_say(tmp_path, monkeypatch):
    for package in ("fmpy", "rocking_block", "matplotlib"):
        pytest.importorskip(package)
    monkeypatch.setenv("MPLBACKEND", "agg")
    place = Workplace(tmp_path)
    for page in PYTHON_PAGES:
        pairs = place.prints(page)
        assert pairs, page
        for said, printed in pairs:
            assert printed == said


def anchor(heading):
    """The anchor that GitHub gives a heading."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def links(page):
    """Yields the links of a page to files, with their anchors."""
    text = re.sub(r"```.*?```", "", page.read_text(), flags=re.DOTALL)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if "://" not in target:
            path, _, name = target.partition("#")
            yield target, (page.parent / path if path else page), name


def pages():
    listed = subprocess.run(["git", "ls-files", "*.md"], cwd=ROOT, capture_output=True, text=True, check=True)
    return [ROOT / line for line in listed.stdout.splitlines()]


def test_links_lead_somewhere():
    lost = []
    for page in pages():
        for target, path, name in links(page):
            if not path.exists() or name and path.suffix == ".md" and name not in [
                    anchor(line.lstrip("#")) for line in path.read_text().splitlines() if line.startswith("#")]:
                lost.append(f"{page.relative_to(ROOT)}: {target}")
    assert not lost


def test_all_files_have_the_version_of_cargo_toml():
    version = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]["version"]
    for name, expected in {
        "Cargo.toml": f'version = "={version}"',
        "modelDescription.xml": f'\n  version="{version}"',
        "modelDescriptionInSpace.xml": f'\n  version="{version}"',
        "CITATION.cff": f"\nversion: {version}\n",
        "codemeta.json": f'"version": "{version}"',
        "lab/conda/recipe/recipe.yaml": f"\n  version: {version.replace('-rc.', 'rc')}\n",
        "CHANGELOG.md": f"\n## [{version}] - ",
    }.items():
        found = (ROOT / name).read_text().count(expected)
        assert found == (6 if name == "Cargo.toml" else 1), f"{name}: {found} times {expected!r}"
    of_workspace = re.compile(r'name = "(rocking-(?:block|records|studies))"\nversion = "([^"]+)"')
    for name in ("Cargo.lock", "lab/fuzz/Cargo.lock", "lab/benches/peers/rust/Cargo.lock"):
        found = dict(of_workspace.findall((ROOT / name).read_text()))
        assert "rocking-block" in found and set(found.values()) == {version}, f"{name}: {found}"


def test_the_program_embeds_the_record_of_the_repository():
    name = "np01002p_4225a_a.smc"
    assert (ROOT / "studies/program/records" / name).read_bytes() == (ROOT / "examples/records" / name).read_bytes()


def test_examples_and_benchmarks_are_where_cargo_looks_for_them():
    """Cargo finds targets of the default packages alone unless a command names a package."""
    made = subprocess.run(["cargo", "metadata", "--no-deps", "--format-version=1", "--offline"], cwd=ROOT, capture_output=True, text=True,
                          check=True)
    metadata = json.loads(made.stdout)
    packages = {package["name"]: package for package in metadata["packages"]}
    default = [package["name"] for package in metadata["packages"] if package["id"] in metadata["workspace_default_members"]]
    listed = subprocess.run(["git", "ls-files", "*.md", "*.rs", "*.py", "scripts"], cwd=ROOT, capture_output=True, text=True, check=True)
    found, lost = 0, []
    for name in listed.stdout.splitlines():
        for words, kind, target in re.findall(r"cargo (?:run|bench)([^`\n]*?) --(example|bench) (\w+)", (ROOT / name).read_text()):
            found += 1
            named = re.search(r"(?:-p|--package) ([\w-]+)", words)
            if not any(target == each["name"] and kind in each["kind"]
                       for package in ([named[1]] if named else default) for each in packages[package]["targets"]):
                lost.append(f"{name}: cargo{words} --{kind} {target}")
    assert found > 5
    assert not lost


def test_a_fence_has_one_formula():
    """GitHub runs the lines of a fence together."""
    found = [(page, fence) for page in pages() for fence in re.findall(r"```math\n(.*?)```", page.read_text(), re.DOTALL)]
    assert len(found) > 5
    assert not [(page.name, fence) for page, fence in found if len(fence.strip().splitlines()) > 1 and "aligned" not in fence]


def test_the_index_lists_every_page():
    listed = {path.resolve() for _, path, _ in links(ROOT / "docs/README.md")}
    assert {page for page in (ROOT / "docs").rglob("*.md") if page.name != "README.md"} <= listed


def first_column(page):
    """Returns the words in code font in the first column of the first table of a page."""
    rows = page.read_text().split("\n| ---")[1].splitlines()[1:]
    return {word.split()[0] for row in takewhile(lambda row: row.startswith("|"), rows) for word in re.findall("`(.*?)`", row.split("|")[1])}


def test_tables_list_every_choice_of_the_program():
    def told(*words):
        return subprocess.run([PROGRAM, *words], capture_output=True, text=True, check=True).stdout

    overview = told("--help").split("Commands:")[1].split("Options:")[0]
    assert first_column(ROOT / "docs/studies/program.md") == set(re.findall(r"^  (\w+) ", overview, re.MULTILINE)) - {"help"}
    formats = " ".join(told("record", "--help").split("Format, if the content leaves it open:")[1].split("--channel")[0].split())
    # The layout of lines of fixed width is an option of its own.
    assert first_column(ROOT / "docs/studies/records.md") == set(re.findall(r"\w+", formats)) - {"or"} | {"fixed"}
    shapes = json.loads(told("schema", "study"))["$defs"]["pulse.shape"]["enum"]
    assert first_column(ROOT / "docs/studies/pulses.md") == set(shapes) - {"none"}


if __name__ == "__main__":
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        place = Workplace(Path(folder))
        for page in dict.fromkeys(COMMAND_PAGES + PYTHON_PAGES):
            text = page.read_text()
            for block in shell_blocks(page) if page in COMMAND_PAGES else []:
                for command, expected in commands(block):
                    printed = "" if command.startswith(BUILDS) else place.run(command)
                    if expected:
                        text = text.replace("\n".join(f"    {line}" if line else "" for line in expected.splitlines()),
                                            "\n".join(f"    {line}" if line else "" for line in printed.splitlines()))
            for said, printed in place.prints(page):
                text = text.replace(f"  # {said}\n", f"  # {printed}\n")
            page.write_text(text)
        for drawn, shown in place.pictures().items():
            shown.write_bytes(drawn.read_bytes())
