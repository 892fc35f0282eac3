"""Modules of a crate do not import each other in a circle, a type name has one meaning in a crate, and few files name a kind of restraint."""

import graphlib
import pathlib
import re

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SOURCES = sorted(folder for depth in ("src", "*/*/src", "studies/web/engine/src") for folder in ROOT.glob(depth))


def modules(source: pathlib.Path) -> dict[str, str]:
    """The code of each module by its path, as in `run::table`, without unit tests, comments and the crate's root."""
    found = {}
    for file in source.rglob("*.rs"):
        parts = file.relative_to(source).with_suffix("").parts
        name = "::".join(parts[:-1] if parts[-1] == "mod" else parts)
        code = re.split(r"#\[cfg\(test\)\]\nmod \w+ \{", re.sub(r"//.*", "", file.read_text(encoding="utf-8")))[0]
        found[name] = code
    return {name: code for name, code in found.items() if name not in ("lib", "main")}


def flat(tree: str) -> list[str]:
    """The paths of a use tree: those of `a::{b, c::{d, e}}` are a::b, a::c::d and a::c::e."""
    group = re.search(r"\{([^{}]*)\}", tree)
    if not group:
        return [tree]
    items = [item.strip() for item in group[1].split(",") if item.strip()]
    return [path for item in items for path in flat(tree[: group.start()] + item + tree[group.end() :])]


def imports(name: str, code: str, names: set[str]) -> set[str]:
    """The other modules that a module imports. Its own parts belong to it."""
    found = set()
    used = [path for use in re.findall(r"\buse ([^;]+);", code) for path in flat(re.sub(r"\s+", " ", use))]
    for path in used + re.findall(r"\bcrate(?:::\w+)+", code):
        parts = path.split(" as ")[0].split("::")
        at = [] if parts[0] == "crate" else name.split("::")
        while parts and parts[0] in ("crate", "self", "super"):
            at = at[:-1] if parts.pop(0) == "super" else at
        parts = at + parts
        known = ["::".join(parts[:n]) for n in range(len(parts), 0, -1) if "::".join(parts[:n]) in names]
        found.update(known[:1])
    return {other for other in found if not f"{other}::".startswith(f"{name}::")}


@pytest.mark.check
@pytest.mark.parametrize("source", SOURCES, ids=lambda source: str(source.relative_to(ROOT)))
def test_modules_import_in_one_direction(source: pathlib.Path) -> None:
    code = modules(source)
    graph = {name: imports(name, text, set(code)) for name, text in code.items()}
    try:
        graphlib.TopologicalSorter(graph).prepare()
    except graphlib.CycleError as error:
        pytest.fail(f"{source}: modules import each other: {' -> '.join(reversed(error.args[1]))}")


PLANE, SPACE = ("system::", "simulation::"), ("space::",)


@pytest.mark.check
@pytest.mark.parametrize(("body", "other"), [(PLANE, SPACE), (SPACE, PLANE)], ids=["plane", "space"])
def test_bodies_share_only_modules_below_both(body: tuple[str, ...], other: tuple[str, ...]) -> None:
    code = modules(ROOT / "src")
    own = [name for name in code if f"{name}::".startswith(body)]
    found = {(name, used) for name in own for used in imports(name, code[name], set(code)) if f"{used}::".startswith(other)}
    assert not found


# Variants of one thing; a build or a caller chooses one: the two C interfaces, the vectors of a processor, and a program with or without Parquet.
VARIANTS = [re.compile(pattern) for pattern in (r"^fmi(::\w+)*$", r"^numerics::wide::(portable|x86)$", r"^output::(no_)?parquet$", r"^unit::(in_space::)?variables$")]


@pytest.mark.check
@pytest.mark.parametrize("source", SOURCES, ids=lambda source: str(source.relative_to(ROOT)))
def test_a_type_name_has_one_meaning_in_a_crate(source: pathlib.Path) -> None:
    declared: dict[str, list[str]] = {}
    for name, code in modules(source).items():
        for found in re.findall(r"^ *pub(?:\([\w :]+\))? (?:struct|enum|trait|type) (\w+)", code, re.M):
            declared.setdefault(found, []).append(name)
    shared = {
        found: sorted(names)
        for found, names in declared.items()
        if len(names) > 1 and not any(all(map(variant.match, names)) for variant in VARIANTS)
    }
    assert not shared, f"{source}: declared in more than one module: {shared}"


@pytest.mark.check
def test_few_files_of_the_unit_name_ties() -> None:
    """Ties are known to their folder, to the list of kinds, and to the variables of the FMU (docs/code/design.md, "How to add")."""
    tie = re.compile(r"(?<![A-Za-z])(?:un)?[Tt]ie[sd]?(?![a-z])|(?<![A-Z])TIES?(?![A-Z])|[a-z]Ties?(?![a-z])")
    naming = {path.relative_to(ROOT) for path in (ROOT / "src").rglob("*.rs") if tie.search(path.read_text(encoding="utf-8"))}
    beside = {path for path in naming if not path.is_relative_to("src/block/restraints/tie")}
    expected = ["src/block/restraints/mod.rs", "src/unit/links.rs", "src/unit/outputs.rs", "src/unit/values.rs"]
    assert sorted(map(str, beside)) == expected
