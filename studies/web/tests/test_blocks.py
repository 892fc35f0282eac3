"""Every kind of block that the page offers, in a plane and in space, has the outcome and the numbers of the program."""

import itertools
import json
import math

import pytest
from playwright.sync_api import expect
from visitor import SCREENSHOTS, downloaded, drop, fill, program, ran, runs


def words_of(run: dict) -> str:
    """The words of the page for a run of the program."""
    match run["outcome"]:
        case "overturned":
            return "overturns"
        case "separated":
            return "leaves the ground"
        case "undecided":
            return "Still undecided"
        case "completed" if run["events"]["liftoffs"] == 0:
            return "stays on both corners"
        case "completed" if run["ends_tilted"]:
            return "ends tilted"
        case "completed" if run["passed_balance"]:
            return "passes its balance"
        case "completed":
            return "stays upright"
    raise AssertionError(run["outcome"])


def kinds_of_blocks(page, body):
    """Every combination of the switches of the block, its foundation and its links that the form shows, in a plane or in space."""
    choices = page.evaluate(
        """[...document.querySelectorAll('#group-block .segments, #group-foundation .segments, #group-tie .segments')]
          .map((group) => [...group.querySelectorAll('input')].map(({ name, value }) => [name, value]))"""
    )
    assert [of[0][0] for of in choices] == ["body", "shape", "foundation", "supports", "sliding", "tie", "damper"]
    of_plane = {"foundation": "viscoelastic", "tie": "none", "damper": "none"}
    for kind in itertools.product(*choices):
        of = dict(kind)
        if of["body"] != body or body == "space" and any(of[name] != value for name, value in of_plane.items()):
            continue
        # The form shows this switch only for a block of a given size on supports.
        if of["supports"] == "ratios" or (of["shape"], of["foundation"]) == ("size", "viscoelastic"):
            yield of


def test_every_kind_of_block_has_the_outcome_of_the_program(visit, tmp_path):
    page = visit("#scale=2.5")
    ran(page)
    found = set()
    for kind in kinds_of_blocks(page, "plane"):
        before = runs(page)
        page.evaluate("hash => { location.hash = hash }", "&".join(["scale=2.5", *(f"{name}={value}" for name, value in kind.items())]))
        ran(page, before + 1)
        command = page.inner_text("#command")
        run = json.loads(program(command.replace("history.csv", f"{tmp_path}/table.csv") + " --json", "history.csv"))
        expect(page.locator("#outcome"), f"{kind}: {command}").to_contain_text(words_of(run))
        assert page.get_attribute("#verdict", "class").split()[-1] == run["outcome"], kind
        expect(page.locator("#stale")).to_be_hidden()
        count = len(run.get("ties", []) + run.get("dampers", []))
        assert page.locator("#scene .tie").count() == count, kind
        labels = page.locator("#numbers dt").all_inner_texts()
        numbers = dict(zip(labels, page.locator("#numbers dd:not(.wide)").all_inner_texts(), strict=True))
        assert float(numbers["Greatest tilt |θ|/α"]) == pytest.approx(run["peak"]["theta/alpha"], rel=1e-3), kind
        for links, name, force in [("ties", "tie", "tension"), ("dampers", "damper", "force")]:
            for number, link in enumerate(run.get(links, []), 1):
                shown = float(numbers[f"Greatest {force} of {name} {number}"].removesuffix(" N"))
                assert shown == pytest.approx(link[f"peak_{force}"], rel=1e-3), kind
        assert page.locator("#plots .uplot").count() == 4 + (kind["sliding"] == "friction") + (count > 0), kind
        found.add(words_of(run))
    assert {"overturns", "stays upright"} <= found


def test_every_kind_of_block_in_space_has_the_outcome_of_the_program(visit, tmp_path):
    page = visit()
    ran(page)
    words = {"overturned": "overturns", "completed": "stays upright", "undecided": "Still undecided", "separated": "leaves the ground"}
    found = set()
    for kind, (amplitude, azimuth) in itertools.product(kinds_of_blocks(page, "space"), [("1.4", "30"), ("6", "60")]):
        before = runs(page)
        state = kind | {"excitation": "pulse", "amplitude": amplitude, "azimuth": azimuth}
        page.evaluate("hash => { location.hash = hash }", "&".join(f"{name}={value}" for name, value in state.items()))
        ran(page, before + 1)
        command = page.inner_text("#command")
        run = json.loads(program(command.replace("history.csv", f"{tmp_path}/table.csv") + " --json", "history.csv"))
        expect(page.locator("#outcome"), f"{kind}: {command}").to_contain_text(words[run["outcome"]])
        assert page.get_attribute("#verdict", "class").split()[-1] == run["outcome"], kind
        labels = page.locator("#numbers dt").all_inner_texts()
        numbers = dict(zip(labels, page.locator("#numbers dd:not(.wide)").all_inner_texts(), strict=True))
        tilt = float(numbers["Greatest tilt over that of the balance"])
        assert tilt == pytest.approx(run["peak"]["tilt/alpha"], rel=1e-3), kind
        slip = float(numbers["Greatest slip of a foot"].removesuffix(" mm"))
        assert slip == pytest.approx(1e3 * run["peak"]["slip"], rel=1e-3), kind
        found.add(run["outcome"])
    assert found == {"overturned", "completed"}


def test_a_block_in_space_has_its_fields_pictures_and_command(visit, tmp_path):
    page = visit("#excitation=pulse&amplitude=1.4")
    ran(page)
    expect(page.locator("#field-depth")).to_be_hidden()
    page.click("label:has-text('in space')")
    ran(page, 2)
    for field in ("depth", "azimuth", "kappa"):
        expect(page.locator(f"#field-{field}")).to_be_visible()
    for hidden in ("#field-foundation", "#field-epsilon", "#spectrum", "#ensemble", "#plots"):
        expect(page.locator(hidden)).to_be_hidden()
    expect(page.locator("#outcome")).to_contain_text("balance in the direction in which it leans")
    assert "Greatest twist" in page.inner_text("#numbers")
    fill(page, "azimuth", "57.5")
    command = page.inner_text("#command")
    assert "--depth 0.58" in command and "--azimuth 57.5" in command
    assert downloaded(page, "#save-csv") == program(command, "history.csv")
    pictures = page.locator("#pictures img")
    expect(pictures).to_have_count(2)
    page.wait_for_function("[...document.querySelectorAll('#pictures img')].every((img) => img.complete && img.naturalWidth > 500)")
    # The block moves with the time, and stands upright again in the plane.
    shape = "document.querySelector('#scene polygon.block').getAttribute('points')"
    before = page.evaluate(shape)
    page.locator("#time").fill("0")
    assert page.evaluate(shape) != before
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    page.screenshot(path=SCREENSHOTS / "in_space.png")
    page.fill("#depth", "0")
    expect(page.locator("#depth-error")).to_have_text("found 0; expected a length > 0 m")
    fill(page, "depth", "0.5")
    before = runs(page)
    page.click("label:has-text('in a plane')")
    ran(page, before + 1)
    expect(page.locator("#plots")).to_be_visible()
    assert "--depth" not in page.inner_text("#command") and page.locator("#scene rect.block").count() == 1


def test_a_block_in_space_takes_a_second_component_of_its_record(visit, tmp_path):
    """Files dropped together are the components in the order of their names; those of other steps or lengths are refused."""

    def record(name, rows, step=0.01, phase=0.0):
        lines = (f"{i * step:.3f},{2.5 * math.sin(7 * i * step + phase) * math.exp(-i / 300):.6f}" for i in range(rows))
        (tmp_path / name).write_text("t,a\n" + "\n".join(lines) + "\n")
        return tmp_path / name

    x, y, up = record("A-090.csv", 900), record("A-180.csv", 900, phase=1.0), record("A-UP.csv", 900, phase=2.0)
    page = visit("#body=space&unit=m%2Fs2&azimuth=20")
    ran(page)
    expect(page.locator("#field-record_y")).to_be_hidden()
    before = runs(page)
    drop(page, y, up, x)
    ran(page, before + 1)
    command = page.inner_text("#command")
    assert "--record A-090.csv --unit m/s2" in command and "--vertical A-UP.csv" in command and "--record-y A-180.csv" in command
    files = {path.name: str(path) for path in (x, y, up)}
    for name, path in files.items():
        command = command.replace(name, path)
    assert downloaded(page, "#save-csv") == program(command, "history.csv")
    expect(page.locator("#warnings")).not_to_contain_text("A-180")
    page.locator("#field-record_y_file").scroll_into_view_if_needed()
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    page.screenshot(path=SCREENSHOTS / "two_components.png")
    message = page.locator("#record_y_file-error")
    drop(page, record("short.csv", 700), on="#field-record_y_file")
    expect(message).to_have_text(
        "the record along y has 700 samples; expected the 900 samples of the record along x; cut the files to the samples that all have"
    )
    page.screenshot(path=SCREENSHOTS / "two_lengths.png")
    drop(page, record("coarse.csv", 900, step=0.02), on="#field-record_y_file")
    expect(message).to_contain_text("the record along y has a time step of 0.02 s; expected that of the record along x, 0.01 s; --resample")
    drop(page, x, on="#field-record_y_file")
    expect(message).to_have_text("the record along y has the samples of the record along x; expected each component once")
    # Without it the first component is alone, and in the plane there is none.
    before = runs(page)
    page.locator("#field-record_y label:has-text('none')").click()
    ran(page, before + 1)
    expect(message).to_be_hidden()
    assert "--record-y" not in page.inner_text("#command")
    page.locator("#field-record_y label:has-text('from a file')").click()
    expect(message).to_be_visible()
    page.click("label:has-text('in a plane')")
    ran(page, before + 2)
    expect(page.locator("#field-record_y")).to_be_hidden()
    assert "--record-y" not in page.inner_text("#command")
