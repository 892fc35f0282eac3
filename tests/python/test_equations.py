"""Compares docs/unit/equations.md with the documentation of the functions that it names, with the equations cited in the code, and with the
sections of docs/unit/model.md."""

import re

import pytest
from conftest import ROOT

PAGE = ROOT / "docs/unit/equations.md"
ITEM = r"(?:pub(?:\([a-z ]+\))? )?(?:const )?(?:fn|struct|enum|const)? ?{name}\b"


def rows():
    """Yields the first two cells of each row, and the name and the file of its item."""
    first = ""
    for line in PAGE.read_text().splitlines():
        cells = [cell.strip().replace("\\|", "|") for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        link = re.fullmatch(r"\[`(\w+)`\]\((.+)\)", cells[-1]) if cells else None
        if link:
            first = cells[0] or first
            yield first, cells[1], link[1], (PAGE.parent / link[2]).resolve()


def documentation(path, name):
    """Returns the doc comments of all items of this name, or that of the module with this name, in one line."""
    lines, found = path.read_text().splitlines(), []
    if name in (path.stem, path.parent.name):
        found.append([line.lstrip("/! ") for line in lines if line.startswith("//!")])
    for number, line in enumerate(lines):
        if re.match(ITEM.format(name=name), line.strip()) and not line.lstrip().startswith("//"):
            above = number
            while above and lines[above - 1].lstrip().startswith(("///", "#[")):
                above -= 1
            found.append([text.strip().lstrip("/ ") for text in lines[above:number] if text.lstrip().startswith("///")])
    return " ".join(" ".join(comment) for comment in found)


def numbers(text):
    """Returns the numbers of equations in a text, where (7)–(13) stands for all of them."""
    found = set()
    for first, last in re.findall(r"\((\d+)\)(?:–\((\d+)\))?", text):
        found |= set(range(int(first), int(last or first) + 1))
    return found


@pytest.mark.parametrize("row", list(rows()), ids=lambda row: f"{row[3].stem}-{row[2]}")
def test_the_item_documents_the_equation(row):
    first, content, name, path = row
    documented = documentation(path, name)
    assert documented, f"{path} has no documented `{name}`"
    for formula in re.findall(r"`([^`]+)`", content):
        assert formula in documented, f"`{formula}` is not in the documentation of `{name}` in {path}"
    if first.startswith("("):
        cited = numbers(" ".join(re.findall(r"[Ee]qs?\. [^a-z]*(?:and their mirror image \(\d+\))?[^a-z]*", documented))) | numbers(
            " ".join(re.findall(r"mirror image \(\d+\)", documented)))
        assert name == "theta_ddot" or numbers(first) <= cited, f"`{name}` cites {sorted(cited)}"


def test_the_page_has_each_equation_that_the_code_cites():
    listed = set().union(*(numbers(first) for first, *_ in rows() if first.startswith("(")))
    for path in [*ROOT.glob("src/**/*.rs"), *ROOT.glob("crates/*/src/**/*.rs"), *ROOT.glob("studies/*/src/**/*.rs")]:
        for line in path.read_text().splitlines():
            if "//" in line:
                for cited in re.findall(r"[Ee]qs?\. (\(\d+\)(?:–\(\d+\))?)", line.split("//", 1)[1]):
                    assert numbers(cited) <= listed, f"{path}: {line.strip()}"


def test_the_page_has_each_section_of_the_model_with_equations():
    listed = {match for first, *_ in rows() for match in re.findall(r"\[(.+)\]\(model\.md", first)}
    sections = re.split(r"^## ", (ROOT / "docs/unit/model.md").read_text(), flags=re.MULTILINE)[1:]
    having = {section.splitlines()[0] for section in sections if re.search(r"^    .*=", section, re.MULTILINE)}
    assert len(having) > 4
    assert having <= listed
