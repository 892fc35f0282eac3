"""The lists of files in docs/code/design.md, "How to add", are those that the code shows.

A file that names every pulse is one that a further pulse touches: it must be in the list of pulses. A file in the list that names none is out
of date.
"""

import pathlib
import re
import xml.etree.ElementTree

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PRODUCT = [
    "modelDescription.xml",
    "docs/**/*.md",
    "src/**/*.rs",
    "crates/*/src/**/*.rs",
    "lab/wasm/src/**/*.rs",
    "studies/*/src/**/*.rs",
    "studies/python/rocking_block/*.py*",
    "studies/web/engine/src/*.rs",
    "studies/web/page/*.js",
]


def text(path: str) -> str:
    """The text of a file without its unit tests."""
    return re.split(r"#\[cfg\(test\)\]\nmod \w+ \{", (ROOT / path).read_text(encoding="utf-8"))[0]


def product() -> dict[str, str]:
    """The texts of all product files except docs/code/design.md."""
    paths = {str(path.relative_to(ROOT)) for pattern in PRODUCT for path in ROOT.glob(pattern) if path.name != "tests.rs"}
    return {path: text(path) for path in sorted(paths - {"docs/code/design.md"})}


def items() -> dict[str, str]:
    """The items of "How to add", by the words in bold."""
    section = text("docs/code/design.md").split("## How to add", 1)[1]
    return dict(re.findall(r"^- \*\*(.+?)\*\*(.*?)(?=^- \*\*|\Z)", section, re.M | re.S))


def lists() -> dict[str, set[str]]:
    """The paths in each item."""
    path = re.compile(r"[\w.-]+(?:/[\w.-]+)*\.(?:rs|py|pyi|js|md|toml|xml)\b")
    return {kind: set(path.findall(item)) for kind, item in items().items()}


def members(path: str, declaration: str, member: str = r"^    (\w+)\b") -> list[str]:
    """The members of a type: the variants of an enum, or the fields of a struct."""
    return re.findall(member, re.search(declaration + r"[^{]*\{(.*?)^\}", text(path), re.M | re.S)[1], re.M)


def variants(path: str, enum: str) -> list[str]:
    return [name for name in members(path, f"pub enum {enum}\\b") if name != "None"]


def parameters(causality: str) -> list[str]:
    """The names of the variables of the FMU with this causality."""
    tree = xml.etree.ElementTree.parse(ROOT / "modelDescription.xml")
    return [variable.get("name") for variable in tree.iter("ScalarVariable") if variable.get("causality") == causality]


def block_parameters() -> list[str]:
    """The numbers that users give of a block under their names in the FMU."""
    of_fmu = {name.split(".")[-1] for name in parameters("parameter") if re.match(r"(dimensionless\.|physical\.|\w+$)", name)}
    return [name for name in members("studies/engine/src/spec/block.rs", "pub struct BlockSpec", r"^    pub (\w+): Option<f64>") if name in of_fmu]


def link_parameters() -> list[str]:
    """The numbers that users give of ties and dampers."""
    table = re.search(r"pub const NUMBERS.*?^};", text("src/block/restraints/tie/mod.rs"), re.M | re.S)[0]
    return re.findall(r'number\("(\w+)"', table)


def names(code: str, name: str) -> bool:
    """Whether a text has a name, written as in Rust, in words or in a path of the FMU."""
    words = [word.lower() for word in re.findall(r"[A-Z]?[a-z0-9]+|[A-Z]+(?![a-z])", name)]
    forms = {name, "".join(map(str.capitalize, words)), "-".join(words), "_".join(words)}
    return any(re.search(rf"(?<![\w-]){re.escape(form)}(?![\w-])", code) for form in forms)


def declares(code: str, name: str) -> bool:
    """Whether a text has a name in quotes, as a field or variant, or as an argument: `p` and `g` occur in any formula."""
    variant = "".join(map(str.capitalize, name.split("_")))
    return bool(re.search(rf"""["'.`]{name}["'`]|\b{name}: (?:Option<|float|_Floats|T\b)|\b{name}=|Variable::{variant}\b""", code))


KINDS = {
    "a pulse": (variants("src/excitation/pulse.rs", "PulseShape"), names),
    "an output": (parameters("output"), names),
    "a parameter of the block": (block_parameters(), declares),
    "a parameter of ties and dampers": (link_parameters(), names),
    "an event": (variants("src/system/events/mod.rs", "EventFunction"), names),
    "an event reported under its own name": (variants("src/system/events/event.rs", "EventKind"), names),
    "a record format": (variants("crates/records/src/format.rs", "Format"), names),
    "an intensity measure": (variants("studies/engine/src/intensity/mod.rs", "Measure"), names),
    "a figure": ([path.stem for path in ROOT.glob("lab/paper/src/*.rs") if path.stem not in ("lib", "main")], names),
    "a column of outcomes": (re.findall(r'TableColumn::\w+\(\s*"([\w./]+)"', text("studies/engine/src/run/outcome.rs")), names),
}


@pytest.mark.check
@pytest.mark.parametrize("kind", KINDS)
def test_a_list_has_the_files_that_name_all_of_a_kind(kind: str) -> None:
    known, is_named = KINDS[kind]
    assert len(known) > 4, known
    listed = lists()[kind]
    files = product()
    missing = [path for path, code in files.items() if path not in listed and all(is_named(code, name) for name in known)]
    superfluous = [path for path in sorted(listed & files.keys()) if not any(is_named(files[path], name) for name in known)]
    assert (missing, superfluous) == ([], []), f"docs/code/design.md, {kind}: missing and superfluous"


@pytest.mark.check
@pytest.mark.parametrize(("kind", "listed"), lists().items(), ids=lists())
def test_listed_files_exist(kind: str, listed: set[str]) -> None:
    assert [path for path in sorted(listed) if not (ROOT / path).is_file()] == [], kind


@pytest.mark.check
@pytest.mark.parametrize("kind", lists())
def test_names_in_a_list_occur_in_its_files(kind: str) -> None:
    code = "\n".join(text(path) for path in lists()[kind])
    unknown = [name for name in re.findall(r"`([A-Z]\w+)`", items()[kind]) if not re.search(rf"\b{name}\b", code)]
    assert unknown == [], f"docs/code/design.md, {kind}"
