"""What a visitor does on the page: opens it, waits for runs, types, drops and saves."""

import os
import shutil
import subprocess
from pathlib import Path
from urllib.parse import urlparse

from playwright.sync_api import Page

ROOT = Path(__file__).resolve().parents[3]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
PAGE = ROOT / "target/web/rocking.html"
SCREENSHOTS = ROOT / "target/web/screenshots"
AXE = ROOT / "studies/web/node_modules/axe-core/axe.min.js"
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

# A block on supports with two ties.
TIED = "tie=two&tie_1_stiffness=3e4&tie_2_strength=2000"


def chromium() -> str | None:
    return shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


def local(url: str) -> bool:
    return urlparse(url).scheme in ("file", "blob", "data")


def ran(page: Page, runs: int = 1) -> None:
    """Waits until the page has shown at least this number of runs and is idle."""
    page.wait_for_function(
        f"Number(document.documentElement.dataset.runs ?? 0) >= {runs} && !document.getElementById('result').hasAttribute('aria-busy')"
    )


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


def drop(page: Page, *paths: Path, on: str = "#scene") -> None:
    """Drops files as the desktop does."""
    page.locator(on).scroll_into_view_if_needed()
    box = page.locator(on).bounding_box()
    at = {"x": box["x"] + box["width"] / 2, "y": box["y"] + box["height"] / 2}
    data = {"items": [], "files": [str(path) for path in paths], "dragOperationsMask": 1}
    session = page.context.new_cdp_session(page)
    for kind in ("dragEnter", "dragOver", "drop"):
        session.send("Input.dispatchDragEvent", {"type": kind, "data": data, **at})
