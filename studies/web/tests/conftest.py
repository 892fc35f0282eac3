"""Chromium, if it is installed. ROCKING_BLOCK_SKIPPED names the file of skipped tests."""

import os

import pytest
from playwright.sync_api import Browser, Page, sync_playwright
from visitor import FLAGS, PAGE, chromium, local


@pytest.fixture(scope="module")
def browser():
    path = chromium()
    if path is None:
        if skipped := os.environ.get("ROCKING_BLOCK_SKIPPED"):
            with open(skipped, "a") as file:
                file.write("studies/web/tests: chromium is not installed\n")
        pytest.skip("chromium is not installed")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def large_text(browser: Browser):
    """A browser whose user has doubled the size of text."""
    flags = [*FLAGS, "--blink-settings=defaultFontSize=32"]
    browser = browser.browser_type.launch(executable_path=chromium(), args=flags)
    yield browser
    browser.close()


@pytest.fixture
def visit(browser: Browser):
    """Opens the page in a context of its own; any error of a script, and any request to a network, fails the test."""
    contexts, faults = [], []

    def open_page(fragment: str = "", script: str = "", browser: Browser = browser, **options) -> Page:
        context = browser.new_context(**{"viewport": {"width": 1360, "height": 900}, **options})
        contexts.append(context)
        context.add_init_script(script)
        page = context.new_page()
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("request", lambda request: None if local(request.url) else faults.append(request.url))
        page.goto(PAGE.as_uri() + fragment)
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert faults == []
