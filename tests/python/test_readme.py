"""Runs the commands of README.md, and compares their output with it.

`python tests/python/test_readme.py` writes what they print today into README.md.
"""

import contextlib
import io
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
README = ROOT / "README.md"
PROGRAM = Path(os.environ.get("ROCKING_BLOCK_PROGRAM", ROOT / "target/release/rocking"))
FMU = Path(os.environ.get("ROCKING_BLOCK_FMU", ROOT / "target/release/RockingBlock.fmu"))
# A block of indented lines after an empty one, and a fence.
SHELL = re.compile(r"(?<=\n\n)((?: {4,}\S.*\n|\n(?= {4}))+)")
PYTHON = re.compile(r"```python\n(.*?)```", re.DOTALL)
# These build the project, as scripts/test has done before it comes here.
BUILDS = ("cargo run", "scripts/test", "pip install")
PRINT = re.compile(r"^(print\(.*\))  # (.*)$", re.MULTILINE)


def commands(block):
    """The commands of a block, each with the lines that stand under it."""
    lines = [line.strip() if line.rstrip().endswith("\\") else line.rstrip() for line in block.splitlines()]
    indent = min(len(line) - len(line.lstrip()) for line in block.splitlines() if line)
    found, text = [], "\n".join(line[indent:] if line.startswith(" ") else line for line in lines)
    for line in text.replace("\\\n", " ").splitlines():
        if line.startswith(("target/release/", "python ", *BUILDS)):
            found.append((line, []))
        else:
            assert found, f"`{line}` stands in a block of README.md that begins without a known command"
            found[-1][1].append(line)
    return [(command, "\n".join(printed).strip("\n")) for command, printed in found]


def run(command, folder):
    """What a command prints, without the blanks at the ends of its lines."""
    words = [word for part in shlex.split(command) for word in (map(str, sorted(folder.glob(part))) if "*" in part else [part])]
    words[0] = sys.executable if words[0] == "python" else str(folder / words[0])
    made = subprocess.run(words, cwd=folder, capture_output=True, text=True)
    assert made.returncode == 0, f"{command}\n{made.stderr}"
    return "\n".join(line.rstrip() for line in made.stdout.splitlines())


def workplace(folder):
    """A folder in which README's commands find their files and leave what they make."""
    (folder / "target/release").mkdir(parents=True)
    for link, path in {"target/release/rocking": PROGRAM, "target/release/RockingBlock.fmu": FMU,
                       "records": ROOT / "records", "examples": ROOT / "examples"}.items():
        (folder / link).symlink_to(path)
    return folder


def shell_blocks():
    return [match[0] for match in SHELL.finditer(PYTHON.sub("", README.read_text()))]


def python_prints(folder):
    """Pairs of what README says that its Python prints, and what it prints."""
    codes, names, pairs = PYTHON.findall(README.read_text()), {}, []
    before = Path.cwd()
    os.chdir(folder)
    try:
        for code in codes:
            out = io.StringIO()
            with contextlib.redirect_stdout(out):
                exec(compile(code, "README.md", "exec"), names)
            said = [match[1] for match in PRINT.findall(code)]
            assert len(said) == code.count("print("), "each print of README.md says what it prints"
            pairs += zip(said, out.getvalue().splitlines(), strict=True)
    finally:
        os.chdir(before)
    return pairs


def test_commands_print_what_readme_says(tmp_path):
    workplace(tmp_path)
    blocks = shell_blocks()
    found = [pair for block in blocks for pair in commands(block)]
    assert len(found) > 10 and any(printed for _, printed in found)
    for command, printed in found:
        if not command.startswith(BUILDS):
            told = run(command, tmp_path)
            assert not printed or told == printed, command


def test_python_prints_what_readme_says(tmp_path, monkeypatch):
    for package in ("fmpy", "rocking_block", "matplotlib"):
        pytest.importorskip(package)
    monkeypatch.setenv("MPLBACKEND", "agg")
    pairs = python_prints(workplace(tmp_path))
    assert len(pairs) > 2
    for said, printed in pairs:
        assert printed == said


if __name__ == "__main__":
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        place = workplace(Path(folder))
        text = README.read_text()
        for block in shell_blocks():
            for command, printed in commands(block):
                told = "" if command.startswith(BUILDS) else run(command, place)
                if printed:
                    text = text.replace("\n".join(f"    {line}" if line else "" for line in printed.splitlines()),
                                        "\n".join(f"    {line}" if line else "" for line in told.splitlines()))
        for said, printed in python_prints(place):
            text = text.replace(f"  # {said}\n", f"  # {printed}\n")
        README.write_text(text)
