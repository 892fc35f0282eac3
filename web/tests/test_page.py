"""The page in headless Chromium, opened from its file: actions of a visitor and the page's responses.

Skipped without Chromium; ROCKING_BLOCK_SKIPPED then names the file of skipped tests. Screenshots go to
target/web/screenshots.
"""

import os
import re
import shutil
import subprocess
from pathlib import Path
from urllib.parse import parse_qs, urlparse

import pytest
from playwright.sync_api import Browser, Page, expect, sync_playwright

ROOT = Path(__file__).resolve().parents[2]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
PAGE = ROOT / "target/web/rocking.html"
SCREENSHOTS = ROOT / "target/web/screenshots"
PROGRAM = TARGET / "release/rocking"
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


@pytest.fixture(scope="module")
def browser():
    path = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if path is None:
        if skipped := os.environ.get("ROCKING_BLOCK_SKIPPED"):
            with open(skipped, "a") as file:
                file.write("web/tests/test_page.py: chromium is not installed\n")
        pytest.skip("chromium is not installed")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture
def visit(browser: Browser):
    """Opens the page in a context of its own; any error of a script, and any request to a network, fails the test."""
    contexts, faults = [], []

    def open_page(fragment: str = "", **options) -> Page:
        context = browser.new_context(**{"viewport": {"width": 1360, "height": 900}, **options})
        contexts.append(context)
        page = context.new_page()
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("request", lambda request: None if local(request.url) else faults.append(request.url))
        page.goto(PAGE.as_uri() + fragment)
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert faults == []


def local(url: str) -> bool:
    return urlparse(url).scheme in ("file", "blob", "data")


def ran(page: Page, runs: int = 1) -> None:
    page.wait_for_function(f"Number(document.documentElement.dataset.runs ?? 0) >= {runs}")


def runs(page: Page) -> int:
    return int(page.evaluate("document.documentElement.dataset.runs"))


def fill(page: Page, field: str, text: str) -> None:
    """Types into a field and waits for the run."""
    before = runs(page)
    page.fill(f"#{field}", text)
    ran(page, before + 1)


def downloaded(page: Page, button: str) -> bytes:
    with page.expect_download() as download:
        page.click(button)
    return Path(download.value.path()).read_bytes()


def program(command: str, table: str) -> bytes:
    """Runs the command line that the page shows, with the table on standard output."""
    words = command.replace(table, "-").split()
    assert words[0] == "rocking"
    return subprocess.run([PROGRAM, *words[1:]], cwd=ROOT, check=True, capture_output=True).stdout


def test_the_first_view_is_a_run_of_the_program(visit):
    page = visit()
    ran(page)
    expect(page.locator("#outcome")).to_contain_text("stays upright")
    command = page.inner_text("#command")
    assert downloaded(page, "#save-csv") == program(command, "history.csv")
    svg = command.replace("--csv history.csv", "--plot history.svg --plot-format svg")
    assert downloaded(page, "#save-svg") == program(svg.replace("history.svg", "-"), "history.csv")


def test_a_block_that_overturns_says_so(visit):
    page = visit("#scale=5")
    ran(page)
    expect(page.locator("#outcome")).to_contain_text("overturns")
    assert re.search(r"overturned", page.get_attribute("#verdict", "class"))
    fill(page, "scale", "1")
    expect(page.locator("#outcome")).not_to_contain_text("overturns")


def test_the_address_reproduces_a_run(visit):
    page = visit()
    ran(page)
    page.click(".segments label:has-text('rigid base')")
    page.click("label:has-text('pulse') >> nth=0")
    expect(page.locator("#command")).to_contain_text("--pulse one-sine")
    fill(page, "amplitude", "5.5")
    fill(page, "friction", "0.35")
    page.wait_for_function("location.hash.includes('friction')")
    state = parse_qs(urlparse(page.url).fragment)
    assert state == {"foundation": ["rigid"], "friction": ["0.35"], "excitation": ["pulse"], "amplitude": ["5.5"]}
    again = visit("#" + urlparse(page.url).fragment)
    ran(again)
    assert again.inner_text("#command") == page.inner_text("#command")
    assert again.inner_text("#numbers") == page.inner_text("#numbers")


def test_wrong_input_is_answered_beside_its_field_and_kept(visit):
    page = visit()
    ran(page)
    before = page.inner_text("#numbers")
    page.fill("#height", "tall")
    expect(page.locator("#height-error")).to_have_text("found tall; expected a length > 0 m")
    assert page.get_attribute("#height", "aria-invalid") == "true"
    assert page.input_value("#height") == "tall"
    expect(page.locator("#stale")).to_be_visible()
    assert page.inner_text("#numbers") == before
    # A hidden field is brought into view.
    page.click("text=Eccentricity, centre of mass, mass, gravity")
    page.fill("#eccentricity", "3")
    page.fill("#height", "2.4")
    expect(page.locator("#eccentricity-error")).to_contain_text("expected less than half the width")
    fill(page, "eccentricity", "0.05")
    expect(page.locator("#stale")).to_be_hidden()
    assert page.locator(".error:visible").count() == 0


def test_a_dropped_record_is_read(visit, tmp_path):
    page = visit()
    ran(page)
    page.click("label:has-text('own record')")
    expect(page.locator("#record-error")).to_contain_text("no file yet")
    path = ROOT / "records/0111a.smc"
    # A drop as the browser makes it.
    transfer = page.evaluate_handle(
        "text => { const t = new DataTransfer(); t.items.add(new File([text], '0111a.smc')); return t; }",
        path.read_text("latin-1"),
    )
    page.dispatch_event("#field-record .drop", "drop", {"dataTransfer": transfer})
    ran(page, 2)
    assert "--record 0111a.smc" in page.inner_text("#command")
    command = page.inner_text("#command").replace("0111a.smc", "records/0111a.smc")
    assert downloaded(page, "#save-csv") == program(command, "history.csv")
    # Without a unit the message appears beside the unit, which is visible.
    table = tmp_path / "sway.csv"
    table.write_text("t,a\n" + "".join(f"{i / 100},{3 if i // 40 % 2 else -3}\n" for i in range(400)))
    page.set_input_files("#record", table)
    expect(page.locator("#unit-error")).to_contain_text("sway.csv")
    expect(page.locator("#unit-error")).to_be_visible()
    page.select_option("#unit", "m/s2")
    expect(page.locator("#unit-error")).to_be_hidden()
    ran(page, 3)
    assert "sway.csv" in page.inner_text("#numbers")
    # A picture is not an accelerogram.
    page.set_input_files("#record", ROOT / "docs/sketch.png")
    expect(page.locator("#record-error")).to_contain_text("sketch.png")


def test_surfaces_and_ties_are_chosen_and_shown(visit):
    page = visit("#foundation=rigid&scale=4")
    ran(page)
    plots = page.locator("#plots .uplot").count()
    page.wait_for_function("document.getElementById('surfaces_friction').options.length > 10")
    before = runs(page)
    steel = page.locator("#surfaces_friction option", has_text="steel on concrete or grout").first
    page.select_option("#surfaces_friction", steel.get_attribute("value"))
    ran(page, before + 1)
    assert page.input_value("#friction") == "0.635"
    assert "--friction 0.635" in page.inner_text("#command")
    # Any other value than the pair's is the user's own.
    fill(page, "friction", "0.2")
    assert page.input_value("#surfaces_friction") == ""
    assert page.locator("#plots .uplot").count() == plots + 1
    page.click("summary:has-text('Ties')")
    page.click("label:has-text('by two')")
    fill(page, "tie_2_strength", "200")
    assert page.inner_text("#command").count("--tie ") == 2
    assert page.locator("#plots .uplot").count() == plots + 2
    assert page.locator("#scene .tie").count() == 2
    # A broken tie is not drawn.
    assert page.locator("#scene .tie[visibility=visible]").count() == 1
    expect(page.locator("#outcome")).to_contain_text("tie breaks")
    expect(page.locator("#outcome")).to_contain_text("slips")
    page.fill("#tie_1_stiffness", "-1")
    expect(page.locator("#tie_1_stiffness-error")).to_have_text("found -1; expected a stiffness > 0 N/m")


def test_the_block_plays_and_follows_clicks(visit):
    page = visit()
    ran(page)
    pose = "document.querySelector('#scene rect.block').parentElement.getAttribute('transform')"
    tilted = page.evaluate(pose)
    page.click("#play")
    expect(page.locator("#play")).to_have_text("Pause")
    page.wait_for_function("Number(document.getElementById('time').value) > 0.3")
    page.keyboard.press("Space")
    expect(page.locator("#play")).to_have_text("Play")
    assert page.evaluate(pose) != tilted
    box = page.locator("#plots .u-over").first.bounding_box()
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + 40)
    limits = [float(page.get_attribute("#time", name)) for name in ("min", "max")]
    time = float(page.input_value("#time"))
    assert abs(time - sum(limits) / 2) < 0.01 * limits[1]
    heads = page.evaluate("[...document.querySelectorAll('.playhead')].map(e => e.getBoundingClientRect().x)")
    assert len(heads) == 4
    assert max(abs(x - box["x"] - box["width"] / 2) for x in heads) < 3


def test_studies_run_in_the_background_and_can_be_cancelled(visit):
    page = visit("#points=400")
    ran(page)
    page.click("#spectrum .start")
    page.wait_for_function("document.querySelector('#spectrum progress').value > 0")
    page.click("#spectrum .cancel")
    expect(page.locator("#spectrum .state")).to_have_text("cancelled")
    page.fill("#points", "12")
    page.click("#spectrum .start")
    expect(page.locator("#spectrum .after")).to_be_visible(timeout=60_000)
    command = page.inner_text("#spectrum pre")
    assert downloaded(page, "#spectrum .save") == program(command, "spectrum.csv")
    page.fill("#scale_count", "many")
    page.click("#ensemble .start")
    expect(page.locator("#scale_count-error")).to_have_text("found many; expected a whole number from 2 to 200")
    page.fill("#scale_count", "8")
    page.click("#ensemble .start")
    expect(page.locator("#ensemble .after")).to_be_visible(timeout=60_000)
    study = ROOT / f".study-{os.getpid()}.toml"
    try:
        study.write_bytes(downloaded(page, "#ensemble .save-study"))
        command = page.inner_text("#ensemble pre").replace("study.toml", study.name)
        assert downloaded(page, "#ensemble .save") == program(command, "ensemble.csv")
    finally:
        study.unlink(missing_ok=True)


def test_everything_can_be_reached_by_keyboard(visit):
    page = visit()
    ran(page)
    seen = []
    for _ in range(60):
        page.keyboard.press("Tab")
        seen.append(page.evaluate("document.activeElement.id || document.activeElement.name || document.activeElement.tagName"))
    for name in ["shape", "width", "foundation", "eta", "excitation", "scale", "play", "time", "save-csv", "copy-link"]:
        assert name in seen, f"{name} is not among {seen}"
    # Arrow keys move a slider and make a run.
    before = runs(page)
    page.focus("#field-height input[type=range]")
    page.keyboard.press("ArrowRight")
    ran(page, before + 1)
    assert float(page.input_value("#height")) > 2.4
    unnamed = page.evaluate(
        """[...document.querySelectorAll('input, select, button, [role=img], progress')].filter(e => e.offsetParent
          && !(e.labels?.length || e.getAttribute('aria-label') || e.textContent.trim())).map(e => e.outerHTML)"""
    )
    assert unnamed == []


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [1360, 390])
def test_the_page_fits_its_window(visit, scheme, width):
    page = visit(viewport={"width": width, "height": 844}, color_scheme=scheme)
    ran(page)
    page.wait_for_timeout(300)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    page.screenshot(path=SCREENSHOTS / f"{scheme}-{width}.png", full_page=True)


def test_times_are_printed(visit, capsys):
    """From a slider to drawn plots: measured and printed, without a bound."""
    for name, fragment, field in [("record", "", "height"), ("pulse", "#excitation=pulse", "amplitude")]:
        page = visit(fragment)
        ran(page)
        times = []
        for step in range(20):
            before = runs(page)
            page.focus(f"#field-{field} input[type=range]")
            page.keyboard.press("ArrowRight" if step % 2 else "ArrowLeft")
            ran(page, before + 1)
            times.append(float(page.evaluate("document.documentElement.dataset.latency")))
        times.sort()
        with capsys.disabled():
            print(f"\n{name}: slider to plots {times[10]:.0f} ms in the median, {times[-1]:.0f} ms at most")
