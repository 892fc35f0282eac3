"""The layout of the page in headless Chromium: access, windows, sizes of text. Screenshots go to target/web/screenshots."""

import pytest
from playwright.sync_api import Page, expect
from visitor import AXE, SCREENSHOTS, TIED, ran, runs


STATES = {
    "record": "",
    "pulse": "#excitation=pulse",
    "rigid": "#foundation=rigid&sliding=friction",
    "tied": f"#{TIED}",
    "file": "#excitation=file&record_name=lost.at2&vertical=file",
    "error": "#height=tall",
    "link": "#preset=soft",
    "study": "#points=3",
}


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("state", STATES)
def test_axe_finds_no_violation(visit, state, scheme):
    page = visit(STATES[state], color_scheme=scheme)
    if state in ("file", "error", "link"):
        expect(page.locator(".error:visible").first).to_be_visible()
    else:
        ran(page)
    page.evaluate("document.querySelectorAll('details').forEach(details => details.open = true)")
    if state == "study":
        page.click("#spectrum .start")
        expect(page.locator("#spectrum .after")).to_be_visible(timeout=60_000)
    page.add_script_tag(path=AXE)
    found = page.evaluate("axe.run().then(({ violations }) => violations)")
    assert [f"{one['id']}: {[node['html'][:120] for node in one['nodes']]}" for one in found] == []


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
    assert float(page.input_value("#height")) > 1.914
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
    assert overflowing(page) == []
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    page.screenshot(path=SCREENSHOTS / f"{scheme}-{width}.png", full_page=True)


def overflowing(page: Page) -> list[str]:
    """Visible elements that reach beyond the window, or whose text is cut off or reaches beyond them."""
    return page.evaluate(
        """[...document.querySelectorAll('body *')].filter(e => {
          if (!e.offsetParent || e.closest('.u-wrap, svg, .skip')) return false;
          const { left, right } = e.getBoundingClientRect();
          const wide = e.scrollWidth > e.clientWidth + 1 && e.clientWidth > 0 && !e.matches('input, select, progress');
          return right > innerWidth + 1 || left < -1 || wide;
        }).map(e => `${e.tagName} ${e.id} ${e.className}: ${e.textContent.slice(0, 40)}`)"""
    )


@pytest.mark.parametrize("width", [1360, 1280, 800, 390])
def test_doubled_text_fits_the_window(visit, large_text, width):
    page = visit(f"#{TIED}&sliding=friction&damper=two", browser=large_text, viewport={"width": width, "height": 844})
    ran(page)
    check_all_sections(page, f"large-text-{width}")


def test_text_that_a_style_doubles_fits_the_window(visit):
    page = visit(f"#{TIED}&sliding=friction&damper=two", viewport={"width": 1280, "height": 844})
    page.add_style_tag(content="html { font-size: 200% }")
    ran(page)
    check_all_sections(page, "style-text-1280")


def check_all_sections(page: Page, name: str) -> None:
    """Opens all of the page, makes a study, and looks for elements that do not fit."""
    page.evaluate("document.querySelectorAll('details').forEach(details => details.open = true)")
    page.fill("#points", "3")
    page.click("#spectrum .start")
    expect(page.locator("#spectrum .after")).to_be_visible(timeout=60_000)
    page.wait_for_timeout(300)
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    page.screenshot(path=SCREENSHOTS / f"{name}.png", full_page=True)
    assert overflowing(page) == []


def test_the_page_fits_at_a_zoom_of_200_per_cent(visit):
    page = visit(viewport={"width": 640, "height": 450}, device_scale_factor=2)
    ran(page)
    page.evaluate("document.querySelectorAll('details').forEach(details => details.open = true)")
    page.wait_for_timeout(300)
    page.screenshot(path=SCREENSHOTS / "zoom-640.png", full_page=True)
    assert overflowing(page) == []
