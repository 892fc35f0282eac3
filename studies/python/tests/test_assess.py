"""Reports on an object: their numbers beside those of a sweep and a curve, their files, and refusals."""

from pathlib import Path

import pytest

import rocking_block as rb

RECORDS = Path(__file__).resolve().parents[3] / "examples/records"
STUDY = f"""
[study]
design = "grid"
levels = {{ im = "PGV", values = [0.2, 0.4, 0.6, 0.9, 1.4] }}
[parameters]
foundation = "rigid"
alpha = [0.14, 0.15, 0.16]
p = 2.2
[[records]]
horizontal = "{RECORDS}/*.smc"
[assess]
title = "A block"
pulse_periods = [0.8]
variants = [{{ name = "wider", width = 1.1 }}]
sensitivity = {{ p = [2.0, 2.4] }}
"""


def test_a_report_has_the_numbers_of_a_sweep(tmp_path):
    study = tmp_path / "study.toml"
    study.write_text(STUDY)
    report = rb.assess(study, progress=False)
    table = rb.sweep(study, progress=False)
    overturned = sum(outcome == "overturned" for outcome in table["outcome"])
    state = report.numbers["states"][-1]
    assert state["runs"] == {"known": 30, "exceeded": overturned, "left_out": 0}
    assert state["curve"]["median"] == rb.fragility(table, "PGV").median
    page = report.save(tmp_path / "report")
    assert page.read_text() == report.html and "<h1>A block</h1>" in report.html
    assert (tmp_path / "report/sketch.png").read_bytes().startswith(b"\x89PNG")
    assert repr(report) == "<Assessment of A block: 30 runs>"


def test_an_error_has_its_line(tmp_path):
    study = tmp_path / "study.toml"
    study.write_text(STUDY + "years = 0\n")
    with pytest.raises(ValueError, match=r"study.toml:16: years = 0; expected a number > 0"):
        rb.assess(study)


def test_kept_rows_are_not_made_again(tmp_path):
    study, keep = tmp_path / "study.toml", tmp_path / "kept"
    study.write_text(STUDY)
    first = rb.assess(study, keep=keep)
    assert first.numbers == rb.assess(study).numbers
    study.write_text(STUDY.replace("A block", "Another title"))
    assert rb.assess(study, keep=keep).numbers["states"] == first.numbers["states"]
    # Rows that the engine would not have made come back.
    for table in keep.iterdir():
        table.write_text(table.read_text().replace(",completed,", ",overturned,"))
    runs = rb.assess(study, keep=keep).numbers["states"][-1]["runs"]
    assert runs["exceeded"] == runs["known"] > first.numbers["states"][-1]["runs"]["exceeded"]
