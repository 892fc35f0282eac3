"""The scripts of validation/ on their data; skipped where the data are missing."""

import csv
import json
import re
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import ROOT

FOLDER = ROOT / "lab/validation"
DATA = ROOT.parent / "shared/validation"
sys.path.insert(0, str(FOLDER))
shaking_table = pytest.importorskip("shaking_table", reason="the package rocking_block is not installed")


def data(name):
    path = DATA / name
    if not path.exists():
        pytest.skip(f"the data of {name} may not be redistributed and are not at hand")
    return path


def documented(row):
    """Returns accuracy, AUC and Brier score of both rocks as printed in the first table of docs/unit/validation.md."""
    lines = (ROOT / "docs/unit/validation.md").read_text().splitlines()
    line = next(line for line in lines if line.startswith("| ") and line.strip("| *").startswith(row))
    numbers = [cell.strip(" *") for cell in line.split("|")[2:-1]]
    return {"SP1": numbers[:3], "SP2": numbers[3:]}


def printed(judge):
    return ["–" if np.isnan(judge[name]) else f"{judge[name]:.3f}" for name in ("accuracy", "AUC", "Brier")]


@pytest.mark.check
def test_without_a_fit_the_rocks_match_the_documentation():
    """To the last digit; the README rounds the accuracies."""
    folder = shaking_table.Folder(data("shaking_table"))
    readme = (ROOT / "README.md").read_text()
    for rock in ("SP1", "SP2"):
        happened = folder.overturned(rock)
        probability = shaking_table.probabilities(folder, rock, shaking_table.rule(folder, rock), 9)
        judge = shaking_table.judged(happened, probability)
        assert printed(judge) == documented("this model, nothing fitted")[rock], rock
        assert re.search(rf"predicts .*{100 * judge['accuracy']:.0f} %", readme), (rock, judge)
        assert printed(shaking_table.judged(happened, np.zeros(len(happened)))) == documented("always stays")[rock]


@pytest.mark.check
def test_what_is_fitted_to_some_tests_holds_for_others(tmp_path):
    """Runs the documented command with few samples, fitted to a third of the tests with motions and judged on another third."""
    source = data("shaking_table")
    with open(source / "tests.csv", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["motion_present"] == "1"]
    for part, name in enumerate(("fit", "test")):
        folder = tmp_path / name
        folder.mkdir()
        for file in ("motions.npz", "rocks.json"):
            (folder / file).symlink_to(source / file)
        with open(folder / "tests.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, rows[0])
            writer.writeheader()
            writer.writerows(rows[part::3])
    command = [sys.executable, str(FOLDER / "shaking_table.py"), "--fit", str(tmp_path / "fit"),
               "--test", str(tmp_path / "test"), "--samples", "3", "--json"]
    found = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    for rock in ("SP1", "SP2"):
        predictions = found[rock]["predictions"]
        fitted = next(judge for name, judge in predictions.items() if "(fitted)" in name)
        assert fitted["accuracy"] > predictions["always stays"]["accuracy"] + 0.1
        alpha = found[rock]["alpha"]
        assert 0.08 <= alpha["fitted"] < alpha["naive"]


@pytest.mark.check
def test_first_impacts_of_limestone_blocks():
    command = [sys.executable, str(FOLDER / "limestone.py"), str(data("limestone")), "--json"]
    found = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    errors = found["RMSE on groups that were not fitted"]
    floor = found["spread within groups"]
    for name in ("Housner", "restitution factor", "supports"):
        assert floor <= errors[name] <= 0.041, name
    assert found["ratios above 1"] == 22


def test_metrics_are_those_of_their_definitions():
    happened = np.array([True, True, False, False])
    assert shaking_table.auc(happened, np.array([0.9, 0.4, 0.4, 0.1])) == 0.875
    judge = shaking_table.judged(happened, np.array([0.9, 0.4, 0.6, 0.1]))
    assert judge["accuracy"] == judge["precision"] == judge["recall"] == 0.5
    assert shaking_table.mcnemar(happened, np.array([1.0, 1, 0, 0]), np.array([1.0, 0, 1, 1])) == (3, 0, 0.25)


def test_the_unsymmetric_block_is_housners_where_its_sides_are_equal():
    """Under one-sine pulses of rising strength; mirrored, the block and the ground give the mirrored outcomes."""
    import rocking_block as rb
    import variants

    time = np.arange(0, 6, 0.005)
    pulse = np.where(time < 0.5, np.sin(4 * np.pi * time), 0.0)
    strengths = np.linspace(1.0, 9.0, 12)
    rocks = {"SP1": {"h": 0.29, "i_y": 0.052}}
    folder, mirrored = (
        SimpleNamespace(rocks=rocks, records=[rb.Record(sign * a * pulse, 0.005) for a in strengths]) for sign in (1, -1)
    )
    ours = shaking_table.probabilities(folder, "SP1", 0.15, 3)
    equal, wider = variants.unsymmetric(folder, "SP1", [(0.15, 0.15), (0.3, 0.15)], 3)
    assert {ours.min(), ours.max()} == {0.125, 0.875}
    assert np.abs(equal - ours).max() <= 0.25 and np.abs(equal - ours).mean() < 0.05
    assert np.abs(wider - equal).max() > 0.5
    assert np.array_equal(variants.unsymmetric(mirrored, "SP1", [(0.15, 0.3)], 3)[0], wider)


def test_a_body_on_scanned_feet_settles_on_those_that_carry_it():
    """A body that stands, turned a little, settles as it stood; a foot that is lower takes the place of one of three."""
    in_space = pytest.importorskip("shaking_table_in_space", reason="the package rocking_block is not installed")
    feet = np.array([[-0.2, -0.1, 0.0], [0.2, -0.2, 0.0], [0.05, 0.3, 0.0], [0.3, 0.3, 0.004], [-0.3, 0.2, 0.01]])
    inertia = np.array([[2.0, 0.1, -0.3], [0.1, 1.5, 0.2], [-0.3, 0.2, 1.0]])
    places = feet - [0, 0, 0.4]
    sin, cos = np.sin(0.02), np.cos(0.02)
    for axis, turned in enumerate((np.array([[1, 0, 0], [0, cos, -sin], [0, sin, cos]]), np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]]))):
        found, height, tensor = in_space.settled(places @ turned.T, turned @ inertia @ turned.T)
        assert np.abs(found - feet).max() < 1e-15 and abs(height - 0.4) < 1e-15 and np.abs(tensor - inertia).max() < 1e-14, axis
    places[3, 2] -= 0.006
    found, height, tensor = in_space.settled(places, inertia)
    assert (found[:, 2] >= 0).all() and (found[:, 2] == 0).sum() == 3 and found[3, 2] == 0 and height != 0.4
    assert np.allclose(np.linalg.eigvalsh(tensor), np.linalg.eigvalsh(inertia))


def test_the_ensemble_in_space_has_equal_parts():
    in_space = pytest.importorskip("shaking_table_in_space", reason="the package rocking_block is not installed")
    draw = in_space.ensemble(12)
    for name, least, greatest in (("eta", 60, 200), ("xi_v", 0.05, 0.5), ("kappa", 0.5, 2)):
        parts = 12 * np.log(draw[name] / least) / np.log(greatest / least)
        assert np.allclose(np.sort(parts), np.arange(12) + 0.5), name
    assert all((draw["yaw"] == yaw).sum() == 2 for yaw in in_space.YAWS)
