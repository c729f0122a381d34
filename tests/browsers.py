"""Headless Chromium for tests, driven by Selenium; what lacks is said."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import pytest

_FLAGS = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--hide-scrollbars"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync", "--mute-audio"),
    *("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--force-device-scale-factor=1"),
)


def require_browser() -> tuple[str, str]:
    """The programs, or the test is skipped with a reason."""
    pytest.importorskip("selenium", reason="Selenium is not installed: pip install selenium")
    found = shutil.which("chromium"), shutil.which("chromedriver")
    if not all(found):
        pytest.skip("chromium and chromedriver are not installed: apt-get install chromium chromium-driver")
    return str(found[0]), str(found[1])


@contextmanager
def browser(folder: Path, *, size: tuple[int, int] = (1200, 760), dark: bool = False) -> Iterator[Any]:
    """A browser with a profile of its own, that logs what it asks for and what the console says."""
    chromium, driver = require_browser()
    from selenium.webdriver import Chrome, ChromeOptions, ChromeService

    options = ChromeOptions()
    options.binary_location = chromium
    for flag in (*_FLAGS, f"--window-size={size[0]},{size[1]}", f"--user-data-dir={folder}"):
        options.add_argument(flag)
    options.add_experimental_option("prefs", {"download.default_directory": str(folder)})
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    found = Chrome(options=options, service=ChromeService(executable_path=driver))
    try:
        found.set_page_load_timeout(60)
        scheme = {"features": [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]}
        found.execute_cdp_cmd("Emulation.setEmulatedMedia", scheme)
        yield found
    finally:
        found.quit()


@pytest.fixture
def open_browser(tmp_path) -> Iterator[Callable[..., Any]]:
    with ExitStack() as stack:
        count = iter(range(100))

        def opened(**options: Any) -> Any:
            return stack.enter_context(browser(tmp_path / f"profile{next(count)}", **options))

        yield opened


def asked_for(driver: Any) -> list[str]:
    """The addresses of all requests so far, without those of Chromium's own empty page."""
    messages = [json.loads(entry["message"])["message"] for entry in driver.get_log("performance")]
    found = [each["params"]["request"]["url"] for each in messages if each["method"] == "Network.requestWillBeSent"]
    return [url for url in found if not url.startswith("chrome:")]


def drawn(driver) -> None:
    """Wait until the panes show what they have, at rest: with all their pixels."""
    script = """const done = arguments[0], all = [...document.querySelectorAll(".pane canvas")];
        const look = () => requestAnimationFrame(() => requestAnimationFrame(() => resting() ? done() : look()));
        const resting = () => all.every((canvas) => canvas.dataset.rest === "true");
        look();"""
    driver.execute_async_script(script)


def picture(driver, pane: str = "space"):
    """The pixels of a pane, (h, w, 3)."""
    import io

    from matplotlib.image import imread

    drawn(driver)
    element = driver.find_element("css selector", f"#{pane} canvas")
    return imread(io.BytesIO(element.screenshot_as_png))[..., :3]
