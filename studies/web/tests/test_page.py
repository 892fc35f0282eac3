"""The page in headless Chromium, opened from its file: actions of a visitor and the page's responses."""

import csv
import os
import re
import shutil
from urllib.parse import parse_qs, urlparse

import pytest
from playwright.sync_api import expect
from visitor import ROOT, downloaded, drop, fill, program, ran, runs


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
    page.click("label:has-text('slide with friction')")
    fill(page, "friction", "0.35")
    page.wait_for_function("location.hash.includes('friction=0.35')")
    state = parse_qs(urlparse(page.url).fragment)
    sliding = {"sliding": ["friction"], "friction": ["0.35"]}
    assert state == sliding | {"foundation": ["rigid"], "excitation": ["pulse"], "amplitude": ["5.5"]}
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
    path = ROOT / "examples/records/0111a.smc"
    # A drop as the browser makes it.
    transfer = page.evaluate_handle(
        "text => { const t = new DataTransfer(); t.items.add(new File([text], '0111a.smc')); return t; }",
        path.read_text("latin-1"),
    )
    page.dispatch_event("#field-record .drop", "drop", {"dataTransfer": transfer})
    ran(page, 2)
    assert "--record 0111a.smc" in page.inner_text("#command")
    command = page.inner_text("#command").replace("0111a.smc", "examples/records/0111a.smc")
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
    page.set_input_files("#record", ROOT / "docs/pictures/sketch.png")
    expect(page.locator("#record-error")).to_contain_text("sketch.png")


def test_a_folder_and_several_files_are_taken_or_refused_with_a_message(visit, tmp_path):
    page = visit()
    ran(page)
    message = page.locator("#file-error")
    drop(page, ROOT / "examples/records")
    expect(message).to_have_text("found the folder records; expected a file")
    expect(message).to_be_in_viewport()
    horizontal, vertical, other = (tmp_path / name for name in ("RSN1_A-090.smc", "RSN1_A-UP.smc", "RSN1_A-180.smc"))
    for copy in (horizontal, vertical, other):
        shutil.copy(ROOT / "examples/records/0111a.smc", copy)
    drop(page, horizontal, other)
    expect(message).to_contain_text("found 2 files, RSN1_A-090.smc, RSN1_A-180.smc; expected one, or a horizontal and")
    drop(page, horizontal, vertical, other)
    expect(message).to_contain_text("found 3 files")
    assert "--record" not in page.inner_text("#command")
    before = runs(page)
    drop(page, vertical, horizontal)
    ran(page, before + 1)
    expect(message).to_be_hidden()
    assert "--record RSN1_A-090.smc --vertical RSN1_A-UP.smc" in page.inner_text("#command")
    page.click("summary:has-text('Vertical motion')")
    drop(page, other, on="#field-vertical_file")
    ran(page, before + 2)
    assert "--record RSN1_A-090.smc --vertical RSN1_A-180.smc" in page.inner_text("#command")
    # A file that is gone cannot be read.
    other.unlink()
    chooser = """const file = new File(['a'], 'gone.at2'); file.arrayBuffer = () => Promise.reject(new Error('it is gone'));
      const input = document.getElementById('record');
      Object.defineProperty(input, 'files', { value: [file] });
      input.dispatchEvent(new Event('change'));"""
    page.evaluate(chooser)
    expect(message).to_have_text("gone.at2 cannot be read: it is gone")


@pytest.mark.parametrize(
    "link, place, found",
    [
        ("shape=sphere", "#shape-error", "found sphere; expected one of size, ratios"),
        ("tie=three", "#tie-error", "found three; expected one of none, one, two"),
        ("supports=sand", "#supports-error", "found sand; expected one of ratios, stiffness"),
        ("sliding=ice", "#sliding-error", "found ice; expected one of none, friction"),
        ("vertical=up", "#vertical-error", "found up; expected one of none, file"),
        ("preset=soft", "#run-error", "link: found preset; expected the name of a field, as eta"),
        ("heigth=3", "#run-error", "link: found heigth; expected the name of a field, as eta"),
    ],
)
def test_a_link_that_is_not_understood_is_refused(visit, link, place, found):
    page = visit(f"#{link}")
    expect(page.locator(place)).to_have_text(found)
    expect(page.locator(place)).to_be_visible()
    expect(page.locator("#outcome")).to_contain_text("No run yet")
    # It stands until the user decides.
    page.click("#reset")
    ran(page)
    assert page.locator(".error:visible").count() == 0
    page.wait_for_function("location.hash === ''")


def test_the_link_to_the_result_keeps_the_block(visit):
    page = visit("#scale=3")
    ran(page)
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.id") == "result"
    assert "--scale 3" in page.inner_text("#command")
    assert urlparse(page.url).fragment == "scale=3"


def test_a_table_of_a_million_rows_is_saved(visit):
    # Only its ends are read: the whole is near a gigabyte.
    keep = "const make = URL.createObjectURL; URL.createObjectURL = (blob) => ((window.saved = blob), make.call(URL, blob));"
    page = visit("#step=2e-5", script=keep, accept_downloads=False)
    page.set_default_timeout(180_000)
    ran(page)
    page.evaluate("window.saved = undefined")
    page.click("#save-csv")
    page.wait_for_function("window.saved || !document.getElementById('save-error').hidden")
    expect(page.locator("#save-error")).to_be_hidden()
    first, last = page.evaluate("Promise.all([saved.slice(0, 2000).text(), saved.slice(-2000).text()])")
    assert first.startswith("t [s],theta [rad],")
    rows = float(last.splitlines()[-1].split(",")[0]) / 2e-5
    assert rows > 1.5e6
    # A part that is missing or doubled would show in the size.
    assert 300 * rows < page.evaluate("saved.size") < 900 * rows


def test_the_run_that_is_saved_is_the_one_that_is_shown(visit):
    """A run whose plots fail is said to be missing, and the last one stays, with its exports."""
    fail = """const make = Float64Array.from;
      Float64Array.from = function (...a) { if (window.failing) throw new Error('no plots'); return make.apply(this, a); };"""
    page = visit(script=fail)
    ran(page)
    shown = {part: page.inner_text(part) for part in ("#outcome", "#numbers", "#command")}
    window = page.get_attribute("#scene", "viewBox")
    page.evaluate("window.failing = true")
    page.fill("#height", "3")
    expect(page.locator("#run-error")).to_have_text("this run cannot be shown: no plots")
    expect(page.locator("#stale")).to_be_visible()
    assert "stale" in page.get_attribute("body", "class")
    page.evaluate("window.failing = false")
    assert {part: page.inner_text(part) for part in shown} == shown
    # The engine has made another run since.
    page.click("#save-csv")
    expect(page.locator("#save-error")).to_contain_text("history.csv cannot be made: another run took the place of this one")
    ran(page, 2)
    expect(page.locator("#stale")).to_be_hidden()
    assert page.get_attribute("#scene", "viewBox") != window
    assert downloaded(page, "#save-csv") == program(page.inner_text("#command"), "history.csv")
    # The first run of a visit, too.
    page = visit(script=fail + "window.failing = true;")
    expect(page.locator("#outcome")).to_have_text("No run yet: this run cannot be shown: no plots.")


def test_a_dropped_record_keeps_the_scale(visit):
    page = visit()
    ran(page)
    assert page.input_value("#scale") == "1"
    assert "--scale" not in page.inner_text("#command")
    fill(page, "scale", "3")
    before = runs(page)
    drop(page, ROOT / "examples/records/0111a.smc")
    ran(page, before + 1)
    assert page.input_value("#scale") == "3"
    page.click("#reset")
    expect(page.locator("#scale")).to_have_value("1")


def test_a_failure_of_the_engine_is_said_and_mended(visit):
    break_start = "const make = WebAssembly.compile; WebAssembly.compile = () => ((WebAssembly.compile = make), Promise.reject(new Error('no memory')));"
    page = visit(script=break_start)
    expect(page.locator("#run-error")).to_have_text("the engine does not start: no memory; the next change tries again")
    expect(page.locator("#outcome")).to_contain_text("the engine does not start: no memory")
    page.fill("#height", "2.5")
    ran(page)
    expect(page.locator("#run-error")).to_be_hidden()
    expect(page.locator("#outcome")).to_contain_text("The block")
    # A message that the worker cannot read is as a trap in the middle of a call, and as a worker that does not start.
    for match, broken in [("request?.op === window.failing", "{ ...message, bytes: null }"), ("module && window.failing", "{ module: 1 }")]:
        page = visit(
            script=f"""const post = Worker.prototype.postMessage;
            Worker.prototype.postMessage = function (message) {{ return post.call(this, message.{match} ? {broken} : message); }};
            {'window.failing = true;' if 'module' in match else ''}"""
        )
        if "module" not in match:
            ran(page)
            page.evaluate("window.failing = 'run'")
            page.fill("#height", "2.5")
            expect(page.locator("#stale")).to_be_visible()
        expect(page.locator("#run-error")).to_contain_text("the engine stopped: ")
        before = int(page.evaluate("document.documentElement.dataset.runs ?? 0"))
        page.evaluate("window.failing = undefined")
        page.fill("#height", "2.6")
        ran(page, before + 1)
        expect(page.locator("#run-error")).to_be_hidden()


def test_a_table_that_fails_says_so_and_the_next_is_saved(visit):
    page = visit(
        script="""const post = Worker.prototype.postMessage;
        Worker.prototype.postMessage = function (message) { return post.call(this, message.request?.op === window.failing ? { ...message, bytes: null } : message); };"""
    )
    ran(page)
    page.evaluate("window.failing = 'csv'")
    page.click("#save-csv")
    expect(page.locator("#save-error")).to_contain_text("history.csv cannot be made: the engine stopped")
    ran(page, 2)
    page.evaluate("window.failing = undefined")
    assert downloaded(page, "#save-csv") == program(page.inner_text("#command"), "history.csv")
    # A study says so, too, and runs when it is started again.
    page.evaluate("window.failing = 'rows'")
    page.fill("#points", "4")
    page.click("#spectrum .start")
    expect(page.locator("#spectrum .state")).to_contain_text("stopped: the engine stopped")
    page.evaluate("window.failing = undefined")
    page.click("#spectrum .start")
    expect(page.locator("#spectrum .after")).to_be_visible(timeout=60_000)


def test_studies_leave_no_plot_behind(visit):
    count = """window.live = 0;
      const { observe, disconnect } = ResizeObserver.prototype;
      ResizeObserver.prototype.observe = function (...a) { window.live += 1; return observe.apply(this, a); };
      ResizeObserver.prototype.disconnect = function () { window.live -= 1; return disconnect.call(this); };
      window.plots = 0;
      for (const [name, by] of [['addEventListener', 1], ['removeEventListener', -1]]) {
        const original = window[name];
        window[name] = function (type, ...a) { if (type === 'dppxchange') window.plots += by; return original.call(this, type, ...a); };
      }"""
    page = visit("#points=3&scale_count=2&samples=2", script=count)
    ran(page)
    before = page.evaluate("[live, plots]")
    for _ in range(3):
        for study in ("spectrum", "ensemble"):
            page.click(f"#{study} .start")
            expect(page.locator(f"#{study} .after")).to_be_visible(timeout=60_000)
    assert page.evaluate("[live, plots]") == [before[0] + 2, before[1] + 2]
    assert page.locator(".study .uplot").count() == 2


def test_surfaces_and_ties_are_chosen_and_shown(visit):
    page = visit("#foundation=rigid&scale=4")
    ran(page)
    plots = page.locator("#plots .uplot").count()
    page.wait_for_function("document.getElementById('surfaces_friction').options.length > 10")
    page.click("label:has-text('slide with friction')")
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


def test_an_ensemble_shows_what_undecided_runs_leave_open(visit):
    page = visit("#duration=9&scale_from=1&scale_to=3&scale_count=2&samples=8&spread=0.5")
    ran(page)
    page.click("#ensemble .start")
    expect(page.locator("#ensemble .after")).to_be_visible(timeout=60_000)
    lines = [line for line in downloaded(page, "#ensemble .save").decode().splitlines() if not line.startswith("#")]
    first = {name.split(" [")[0]: value for name, value in next(csv.DictReader(lines)).items()}
    count = {name: int(first[f"ensemble.{name}"]) for name in ("samples", "overturned", "unknown(overturned)")}
    assert count["unknown(overturned)"] > 0
    page.hover("#ensemble .plot .u-over", position={"x": 2, "y": 50})
    shown = [float(page.locator("#ensemble .u-legend .u-value").nth(series).inner_text()) for series in (2, 3)]
    bounds = [count["overturned"], count["overturned"] + count["unknown(overturned)"]]
    assert shown == pytest.approx([bound / count["samples"] for bound in bounds], abs=1e-3)


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
