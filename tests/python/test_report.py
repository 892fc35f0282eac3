"""The pages of `rocking assess` and `rocking portfolio` as Chromium prints them."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).resolve().parents[2] / "examples/assess"


def printed(page):
    """The pages of a printed file, and its size in mm."""
    pypdf = pytest.importorskip("pypdf")
    chromium = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if not chromium:
        pytest.skip("chromium is not installed")
    file = page.with_suffix(".pdf")
    subprocess.run([chromium, "--headless", "--no-sandbox", "--disable-gpu", f"--print-to-pdf={file}", page.as_uri()], check=True,
                   capture_output=True)
    pages = pypdf.PdfReader(file).pages
    return pages, tuple(round(float(side) / 72 * 25.4) for side in pages[0].mediabox[2:])


@pytest.mark.check
@pytest.mark.parametrize("study", ["pier", "statue", "cabinet", "pillar"])
def test_the_first_page_has_the_summary_and_its_pictures(program, study, tmp_path):
    subprocess.run([program, "assess", f"{study}.toml", "--out", tmp_path], check=True, cwd=EXAMPLES, capture_output=True)
    pages, size = printed(tmp_path / "report.html")
    assert size == (210, 297)
    first, second = (page.extract_text() for page in pages[:2])
    # The page is the one that docs/studies/assess.md describes, and the others are few.
    assert first.index("The object") < first.index("Summary") and "2026-11-29" in first
    assert "Words and symbols" in second and len(pages) <= 10
    # The sketch and what helps; the rate if the study has a hazard curve. Curves beside it would leave neither legible.
    for words in ["each parameter in the middle", "the variants", "Remarks"]:
        assert words in first, words
    curves = [number for number, page in enumerate(pages) if "Fragility curves of all states" in page.extract_text()]
    assert len(curves) == 1 and curves[0] > 0
    assert ("annual rate" in first) == (study == "statue")
    assert "The object" in second.split("Quantity")[0]


@pytest.mark.check
def test_the_museum_is_ranked_on_one_page(program, tmp_path):
    made = subprocess.run([program, "portfolio", EXAMPLES.parent / "museum", "--out", tmp_path, "--json"], check=True, capture_output=True)
    pages, size = printed(tmp_path / "portfolio.html")
    assert (len(pages), size) == (1, (297, 210))
    text = " ".join(pages[0].extract_text().split())
    objects = json.loads(made.stdout)["objects"]
    assert [object["rank"] for object in objects] == list(range(1, 9))
    places = [text.index(object["title"], text.index("What is not known")) for object in objects]
    assert places == sorted(places)
    assert all((tmp_path / object["name"] / "report.html").exists() for object in objects)
