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


def test_a_portfolio_ranks_the_reports_of_its_objects(tmp_path):
    (tmp_path / "hazard.csv").write_text("PGV [m/s],rate [1/year]\n0.05,2e-2\n0.1,5e-3\n0.2,1e-3\n0.5,9e-5\n1,1.2e-5\n2,9e-7\n")
    folder = tmp_path / "objects"
    folder.mkdir()
    for name, alphas in {"broad": "[0.19, 0.2, 0.21]", "tall": "[0.13, 0.14, 0.15]"}.items():
        study = STUDY.replace("A block", f"The {name} one").replace("[0.14, 0.15, 0.16]", alphas)
        (folder / f"{name}.toml").write_text(study + 'hazard = { file = "../hazard.csv" }\n')
    found = rb.portfolio(folder, keep=tmp_path / "kept", progress=False)
    assert [object["name"] for object in found.numbers["objects"]] == ["tall", "broad"]
    alone = rb.assess(folder / "tall.toml", keep=tmp_path / "kept/tall/kept", progress=False)
    assert found.reports["tall"].numbers == alone.numbers and found.reports["tall"].html == alone.html
    assert found.numbers["objects"][0]["state"] == alone.numbers["states"][-1]
    page = found.save(tmp_path / "portfolio")
    assert page.read_text() == found.html and (tmp_path / "portfolio/tall/report.html").read_text() == alone.html
    assert repr(found) == "<Portfolio of 2 objects, first The tall one>"

    (folder / "wrong.toml").write_text(STUDY + "years = 0\n")
    with pytest.warns(UserWarning, match=r"not assessed: .*wrong.toml:16: years = 0; expected a number > 0"):
        again = rb.portfolio([folder / "tall.toml", folder / "wrong.toml"], keep=tmp_path / "kept")
    assert list(again.reports) == ["tall"]
    with pytest.raises(ValueError, match=r"the hazards differ: .*broad.toml has ../hazard.csv \(6 levels of PGV\) and .*other.toml other.csv"):
        (folder / "other.csv").write_text("PGV [m/s],rate [1/year]\n0.05,2e-2\n0.1,5e-3\n")
        (folder / "other.toml").write_text(STUDY + 'hazard = { file = "other.csv" }\n')
        rb.portfolio([folder / "broad.toml", folder / "other.toml"])
