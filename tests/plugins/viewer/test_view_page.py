"""The page of the viewer in a real headless Chromium."""

from __future__ import annotations

import urllib.error
import urllib.request
from urllib.parse import urlsplit

import numpy as np
import pytest
from browsers import asked_for, drawn, picture
from fitted import DATASETS, fitted
from orbiframe_viewer.scene import surface_scene
from orbiframe_viewer.server import address, serve
from orbiframe_viewer.session import Session

STATE = "return document.body.dataset.state"


@pytest.fixture(scope="module")
def scene():
    found = fitted("plate_genus2.off")
    return surface_scene(found.surface, found.input, "plate", faces=8000)


@pytest.fixture
def served(scene):
    session = Session("plate")
    server = serve(session)
    session.finish([scene])
    yield address(server, session)
    server.shutdown()
    server.server_close()


def status_of(url: str, **headers: str) -> int:
    try:
        with urllib.request.urlopen(urllib.request.Request(url, headers=headers), timeout=10) as answer:
            return answer.status
    except urllib.error.HTTPError as error:
        with error:
            return error.code


def ready(driver, where=None):
    from selenium.webdriver.support.ui import WebDriverWait

    if where is not None:
        driver.get(where)
    WebDriverWait(driver, 30).until(lambda each: each.execute_script(STATE) == "ready")
    drawn(driver)


def chosen(driver, name, value):
    """Set a control as a user would."""
    script = """const c = document.getElementById(arguments[0]);
        if (c.type === "checkbox") c.checked = arguments[1]; else c.value = arguments[1];
        c.dispatchEvent(new Event("input"));"""
    driver.execute_script(script, name, value)


def test_a_wrong_token_and_another_host_are_refused(served):
    port = urlsplit(served).port
    assert status_of(served) == 200
    assert status_of(served + "scenes.json") == 200
    for path in ("", "wrong/", "wrong/scenes.json", "viewer.js", urlsplit(served).path[1:-2] + "/"):
        assert status_of(f"http://127.0.0.1:{port}/{path}") == 403
    assert status_of(served, Host="evil.example") == 403
    assert status_of(served + "../../pyproject.toml") in (403, 404)
    assert status_of(served + "plugin.py") == 404


def test_the_server_listens_on_this_machine_alone(scene):
    session = Session("plate")
    server = serve(session)
    assert server.server_address[0] == "127.0.0.1"
    assert session.token != Session("plate").token
    server.shutdown()
    server.server_close()


def test_the_page_shows_surface_and_xh_without_errors_and_asks_nobody_else(served, open_browser):
    driver = open_browser()
    ready(driver, served)
    space, plane = picture(driver, "space"), picture(driver, "plane")
    for pixels in (space, plane):
        assert np.ptp(pixels.reshape(-1, 3), axis=0).min() > 0.3
    seen = {}
    for name in ("error", "distortion", "gaussian", "mean", ""):
        chosen(driver, "colour", name)
        seen[name] = picture(driver, "space"), picture(driver, "plane")
        assert driver.find_element("id", "scale").is_displayed() == bool(name)
    assert all(np.abs(seen[name][k] - seen[""][k]).max() > 0.2 for name in seen if name for k in range(2))
    for name, value in (("zebra", True), ("axis", "x"), ("input", True), ("surface", False), ("edges", False)):
        before = picture(driver)
        chosen(driver, name, value)
        assert np.abs(picture(driver) - before).max() > 0.2, name
    assert [entry for entry in driver.get_log("browser") if entry["level"] == "SEVERE"] == []
    hosts = {urlsplit(url).hostname for url in asked_for(driver) if not url.startswith(("data:", "blob:"))}
    assert hosts == {"127.0.0.1"}


def test_the_point_under_the_cursor_is_shown_in_both(served, scene, open_browser):
    from selenium.webdriver import ActionChains

    driver = open_browser()
    ready(driver, served)
    canvas = driver.find_element("css selector", "#plane canvas")
    before = picture(driver, "space")
    ActionChains(driver).move_to_element_with_offset(canvas, 10, 12).perform()
    drawn(driver)
    words = driver.find_element("id", "told").text
    assert words.startswith("(")
    assert all(value["name"] in words for value in scene["values"])
    place = np.array([float(x) for x in words[1 : words.index(")")].split(",")])
    found = fitted("plate_genus2.off").surface
    assert found.distance(place[None])[0] < 0.02 * found.scale
    red = (picture(driver, "space") - before)[..., 0].max()
    assert red > 0.2
    ActionChains(driver).move_to_element(driver.find_element("id", "bar")).perform()
    drawn(driver)
    assert driver.find_element("id", "told").text.startswith("input:")


def test_a_reload_keeps_the_session_and_two_browsers_do_not_meet(served, open_browser):
    from selenium.webdriver.common.keys import Keys

    one, other = open_browser(), open_browser()
    ready(one, served)
    ready(other, served)
    fresh = picture(other)
    chosen(one, "colour", "gaussian")
    chosen(one, "zebra", True)
    one.find_element("css selector", "#space canvas").send_keys(Keys.ARROW_LEFT * 5)
    before = picture(one)
    one.refresh()
    ready(one)
    assert np.abs(picture(one) - before).mean() < 1e-3
    assert one.find_element("id", "zebra").is_selected()
    assert np.abs(picture(other) - fresh).max() == 0
    assert not other.find_element("id", "zebra").is_selected()


def test_the_keyboard_alone_works(served, open_browser):
    from selenium.webdriver import ActionChains
    from selenium.webdriver.common.keys import Keys

    driver = open_browser()
    ready(driver, served)
    keys, reached = ActionChains(driver), []
    for _ in range(16):
        ActionChains(driver).send_keys(Keys.TAB).perform()
        focus = "const e = document.activeElement; return e.id || e.parentElement.id"
        reached.append(driver.execute_script(focus))
        if reached[-1] == "zebra":
            before = picture(driver)
            keys.send_keys(Keys.SPACE).perform()
            assert np.abs(picture(driver) - before).max() > 0.2
        if reached[-1] in ("space", "plane"):
            before = picture(driver, reached[-1])
            ActionChains(driver).send_keys(Keys.ARROW_RIGHT, Keys.ARROW_UP, "+").perform()
            assert np.abs(picture(driver, reached[-1]) - before).max() > 0.2
    controls = {"colour", "surface", "edges", "input", "zebra", "axis", "home", "shot", "space", "plane"}
    assert controls <= set(reached)


def test_an_error_of_the_fit_is_told_on_the_page_and_stages_before(open_browser):
    from selenium.webdriver.support.ui import WebDriverWait

    session = Session("open")
    server = serve(session)
    session.stage("map", None)
    driver = open_browser()
    driver.get(address(server, session))
    told = driver.find_element("id", "told")
    WebDriverWait(driver, 20).until(lambda _: "map …" in told.text)
    session.fail("the mesh has an edge; close it")
    WebDriverWait(driver, 20).until(lambda _: told.text == "the mesh has an edge; close it")
    assert session.told.is_set()
    server.shutdown()
    server.server_close()


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("size", [(1200, 760), (420, 800)])
def test_the_page_fits_two_sizes_light_and_dark(served, open_browser, tmp_path, size, dark):
    driver = open_browser(size=size, dark=dark)
    ready(driver, served)
    beyond = "const e = document.documentElement; return [e.scrollWidth - innerWidth, e.scrollHeight - innerHeight]"
    assert driver.execute_script(beyond) == [0, 0]
    assert driver.save_screenshot(str(tmp_path / "page.png"))
    corner = picture(driver)[0, -1]
    assert (corner.mean() < 0.3) == dark
    assert np.ptp(picture(driver)) > 0.3
    assert np.ptp(picture(driver, "plane")) > 0.3


@pytest.mark.long
@pytest.mark.parametrize(("name", "geometry"), [("sphere.off", "s2"), ("klein_bottle.off", "e2")])
def test_a_static_page_of_every_geometry_needs_no_server(orbiframe, tmp_path, open_browser, name, geometry):
    page = tmp_path / "page.html"
    ran = orbiframe("view", DATASETS / name, "-o", page, "--set", "basis.size=120", "--set", "data.lift=false")
    assert ran.status == 0, ran.err
    driver = open_browser()
    ready(driver, page.as_uri())
    assert driver.execute_script("return SCENES[0].xh.geometry") == geometry
    assert np.ptp(picture(driver)) > 0.3
    assert np.ptp(picture(driver, "plane")) > 0.3
    assert {urlsplit(url).scheme for url in asked_for(driver)} <= {"file", "data"}
    assert [entry for entry in driver.get_log("browser") if entry["level"] == "SEVERE"] == []


def test_a_screenshot_is_a_file_of_both_panes(served, open_browser):
    from pathlib import Path

    from matplotlib.image import imread
    from selenium.webdriver.support.ui import WebDriverWait

    driver = open_browser()
    ready(driver, served)
    saved = Path(driver.capabilities["chrome"]["userDataDir"]) / "plate.png"
    driver.find_element("id", "shot").click()
    WebDriverWait(driver, 20).until(lambda _: saved.is_file() and saved.stat().st_size > 1000)
    pixels = imread(saved)[..., :3]
    left, right = np.array_split(pixels, 2, axis=1)
    assert np.ptp(left) > 0.5
    assert np.ptp(right) > 0.5


@pytest.mark.parametrize(("milliseconds", "share"), [(100, 0.5), (1, 1)])
def test_pictures_of_a_movement_have_fewer_pixels_only_where_they_take_long(served, open_browser, milliseconds, share):
    from selenium.webdriver.support.ui import WebDriverWait

    driver = open_browser()
    ready(driver, served)
    wide = "return document.querySelector('#space canvas').width"
    full = driver.execute_script("return Math.floor(document.querySelector('#space canvas').clientWidth)")
    # At rest four for one, as no graphics card draws here.
    WebDriverWait(driver, 10).until(lambda each: abs(each.execute_script(wide) - 2 * full) <= 2)
    # A clock on which each look takes so long, and turns by the keyboard; no rest between them, however slow they are.
    turns = """const [step, done] = arguments; let now = 0, k = 0; performance.now = () => (now += step);
        const c = document.querySelector("#space canvas"), widths = [], later = window.setTimeout;
        window.setTimeout = (act, milliseconds) => later(act, 1000 * milliseconds);
        const turn = () => {
          widths.push(c.width);
          if (++k > 8) window.setTimeout = later;
          c.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft" }));
          if (k > 8) { done(widths); return; }
          requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(turn)));
        }; turn();"""
    widths = driver.execute_async_script(turns, milliseconds)
    assert min(widths) == pytest.approx(share * full, abs=1)
    assert widths == sorted(widths, reverse=True)
    WebDriverWait(driver, 10).until(lambda each: abs(each.execute_script(wide) - 2 * full) <= 2)


@pytest.mark.parametrize("size", [(800, 420), (500, 620), (420, 900)])
def test_the_surface_is_seen_whole_in_windows_of_all_shapes(served, open_browser, size):
    driver = open_browser(size=size)
    ready(driver, served)
    driver.execute_script("document.querySelector('#told').hidden = true")  # words lie over it
    pixels = picture(driver)
    inside = np.abs(pixels - pixels[0, 0]).max(axis=2) > 0.1
    assert not inside[:, :4].any()
    assert not inside[:, -4:].any()
    assert not inside[:4].any()
    assert not inside[-4:].any()
    assert max(np.ptp(np.nonzero(inside)[0]) / inside.shape[0], np.ptp(np.nonzero(inside)[1]) / inside.shape[1]) > 0.5
