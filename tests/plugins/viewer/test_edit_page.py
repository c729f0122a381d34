"""The page of the editor in a real headless Chromium: what is dragged there is what the server has and saves."""

from __future__ import annotations

import threading
import time
import urllib.error
import urllib.request
from urllib.parse import urlsplit

import numpy as np
import pytest
from browsers import asked_for, drawn, picture
from edits import REGISTRY, first, session_of
from orbiframe_viewer.server import address, serve

from orbiframe import load_surface, read


@pytest.fixture
def edited(tmp_path):
    """A session that saves into a folder, at work, and its address."""
    session = session_of(first("plate_genus2_coarse", 80), tmp_path / "plate.off")
    server = serve(session)
    thread = threading.Thread(target=session.work, daemon=True)
    thread.start()
    yield session, address(server, session)
    session.end()
    server.shutdown()
    server.server_close()
    thread.join(60)


def waited(condition, seconds=180.0):
    until = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.02)


def settled(session):
    waited(lambda: session.state["error"] or (session.state["fitted"] and not session.state["working"]))
    assert not session.state["error"], session.state["error"]


def ready(driver, where=None):
    if where is not None:
        driver.get(where)
    waited(lambda: driver.execute_script("return document.body.dataset.drawn") == "true")
    drawn(driver)


def canvas(driver):
    return driver.find_element("css selector", "#space canvas")


def place_of(driver, session, vertex):
    """Where a vertex is seen, in pixels from the middle of the canvas: by the camera that the page keeps."""
    size = driver.execute_script("const c = arguments[0]; return [c.clientWidth, c.clientHeight]", canvas(driver))
    return seen(view_of(driver), size, (session.history.now.vertices[vertex] - session._middle) / session._scale)


def view_of(driver):
    """Right, up and back of the camera, and its place."""
    script = "return JSON.parse(sessionStorage.getItem(location.pathname)).space"
    waited(lambda: driver.execute_script("return sessionStorage.getItem(location.pathname)"))
    numbers = np.array(driver.execute_script(script))
    eye, target = numbers[:3], numbers[3:6]
    back = (eye - target) / np.linalg.norm(eye - target)
    right = np.cross([0, 0, 1], back)
    right /= np.linalg.norm(right)
    return right, np.cross(back, right), back, eye


def seen(view, size, place):
    right, up, back, eye = view
    depth = -back @ (place - eye)
    unit = size[1] / 2 / np.tan(np.radians(16))
    return np.array([right @ (place - eye), -(up @ (place - eye))]) / depth * unit


def dragged(driver, session, vertex, by):
    """Drag a vertex with the mouse by so many pixels."""
    from selenium.webdriver import ActionChains

    x, y = place_of(driver, session, vertex)
    hand = ActionChains(driver).move_to_element_with_offset(canvas(driver), round(x), round(y)).pause(0.3)
    hand.click_and_hold()
    for _ in range(4):
        hand.move_by_offset(by[0] // 4, by[1] // 4).pause(0.05)
    hand.release().perform()


def foremost(driver, session):
    """A vertex that is seen apart from the others."""
    places = np.array([place_of(driver, session, k) for k in range(len(session.mesh.vertices))])
    apart = np.linalg.norm(places[:, None] - places[None], axis=2) + 1e9 * np.eye(len(places))
    return int(apart.min(axis=1).argmax())


def test_a_drag_changes_the_picture_and_the_saved_mesh_as_computed(edited, open_browser, tmp_path):
    session, where = edited
    driver = open_browser()
    ready(driver, where)
    vertex = foremost(driver, session)
    before, old = picture(driver), session.history.now.vertices.copy()
    size = driver.execute_script("const c = arguments[0]; return [c.clientWidth, c.clientHeight]", canvas(driver))
    right, up, back, eye = view_of(driver)
    dragged(driver, session, vertex, (40, -24))
    waited(lambda: session.history.undoable == 1)
    new = session.history.now.vertices
    assert (np.delete(new, vertex, axis=0) == np.delete(old, vertex, axis=0)).all()
    # In the plane through the vertex that faces the eye, so many pixels to the right and up.
    depth = -back @ ((old[vertex] - session._middle) / session._scale - eye)
    pixel = session._scale * depth * np.tan(np.radians(16)) / (size[1] / 2)
    assert np.abs(new[vertex] - old[vertex] - pixel * (40 * right + 24 * up)).max() < 0.1 * pixel
    assert np.abs(picture(driver) - before).max() > 0.2
    assert float(driver.execute_script("return document.body.dataset.ours")) > 0
    settled(session)
    fit = session.fit.result.report
    assert fit["map"]["like"]["same_triangles"]
    driver.find_element("id", "save").click()
    waited(lambda: not session.state["unsaved"])
    assert np.array_equal(read(tmp_path / "plate.off", REGISTRY).vertices, new)
    saved = load_surface(tmp_path / "plate.npz", REGISTRY)
    assert np.array_equal(saved.coefficients, session.fit.surface.coefficients)
    waited(lambda: "saved: plate.off, plate.npz, plate.toml" in driver.find_element("id", "told").text)


def test_the_page_has_no_errors_and_asks_nobody_else(edited, open_browser):
    from selenium.webdriver import ActionChains

    session, where = edited
    driver = open_browser()
    ready(driver, where)
    plain, plane = picture(driver), picture(driver, "plane")
    for pixels in (plain, plane):
        assert np.ptp(pixels.reshape(-1, 3), axis=0).min() > 0.3
    # Influence is shown before one drags, in both panes.
    vertex = foremost(driver, session)
    x, y = place_of(driver, session, vertex)
    ActionChains(driver).move_to_element_with_offset(canvas(driver), round(x), round(y)).perform()
    waited(lambda: driver.execute_script("return document.body.dataset.influence") == f"vertex {vertex}")
    assert driver.find_element("id", "scale").is_displayed()
    assert np.abs(picture(driver) - plain).max() > 0.2
    assert np.abs(picture(driver, "plane") - plane).max() > 0.2
    assert session.history.undoable == 0
    for name in ("zebra", "surface", "edges", "input"):
        before = picture(driver)
        driver.find_element("id", name).click()
        assert np.abs(picture(driver) - before).max() > 0.1, name
    assert [entry for entry in driver.get_log("browser") if entry["level"] == "SEVERE"] == []
    hosts = {urlsplit(url).hostname for url in asked_for(driver) if not url.startswith(("data:", "blob:"))}
    assert hosts == {"127.0.0.1"}


def test_two_browsers_see_one_state_and_a_reload_keeps_it(edited, open_browser):
    session, where = edited
    one, other = open_browser(), open_browser()
    ready(one, where)
    ready(other, where)
    before = picture(other)
    dragged(one, session, foremost(one, session), (40, -24))
    waited(lambda: session.history.undoable == 1)
    settled(session)
    shown = "return document.body.dataset.picture"
    for driver in (one, other):
        waited(lambda driver=driver: driver.execute_script(shown) == str(session.state["picture"]))
        waited(lambda driver=driver: driver.execute_script("return document.body.dataset.fitted") == "true")
    assert np.abs(picture(other) - before).max() > 0.2
    assert other.find_element("id", "undo").is_enabled()
    other.find_element("id", "undo").click()
    waited(lambda: session.history.undoable == 0)
    other.find_element("id", "redo").click()
    waited(lambda: session.history.undoable == 1)
    moved = session.history.now
    one.refresh()
    ready(one)
    assert session.history.now is moved
    assert one.find_element("id", "undo").is_enabled()
    settled(session)
    assert session.state["unsaved"]


def test_a_tab_with_unsaved_changes_asks_before_it_closes(edited, open_browser):
    session, where = edited
    driver = open_browser()
    ready(driver, where)
    asked = """const event = new Event("beforeunload", { cancelable: true }); dispatchEvent(event);
        return event.defaultPrevented"""
    assert not driver.execute_script(asked)
    dragged(driver, session, foremost(driver, session), (30, 10))
    waited(lambda: driver.execute_script("return document.body.dataset.unsaved") == "true")
    assert driver.execute_script(asked)


def test_the_keyboard_alone_works(edited, open_browser, tmp_path):
    from selenium.webdriver import ActionChains
    from selenium.webdriver.common.keys import Keys

    session, where = edited
    driver = open_browser()
    ready(driver, where)
    focus = "const e = document.activeElement; return e.id || e.parentElement.id"
    reached = []
    for _ in range(24):
        ActionChains(driver).send_keys(Keys.TAB).perform()
        reached.append(driver.execute_script(focus))
        if reached[-1] == "space":
            break
    assert {"what", "step", "zebra", "influence", "basis", "fitter", "home"} <= set(reached)
    assert reached[-1] == "space"
    old = session.history.now.vertices.copy()
    ActionChains(driver).send_keys(Keys.TAB * 3, Keys.ARROW_RIGHT * 3, Keys.ARROW_UP, Keys.PAGE_UP).perform()
    waited(lambda: session.history.undoable == 1)
    right, up, back, _ = view_of(driver)
    way = session.history.now.vertices - old
    assert np.allclose(way[2], 0.01 * session._scale * (3 * right + up - back), atol=1e-6 * session._scale)
    assert np.abs(np.delete(way, 2, axis=0)).max() == 0
    waited(driver.find_element("id", "undo").is_enabled)
    ActionChains(driver).key_down(Keys.CONTROL).send_keys("z").key_up(Keys.CONTROL).perform()
    waited(lambda: session.history.undoable == 0)
    assert np.array_equal(session.history.now.vertices, old)
    waited(driver.find_element("id", "redo").is_enabled)
    hand = ActionChains(driver).key_down(Keys.CONTROL).key_down(Keys.SHIFT).send_keys("z")
    hand.key_up(Keys.SHIFT).key_up(Keys.CONTROL).perform()
    waited(lambda: session.history.undoable == 1)
    waited(driver.find_element("id", "save").is_enabled)
    ActionChains(driver).key_down(Keys.CONTROL).send_keys("s").key_up(Keys.CONTROL).perform()
    waited(lambda: not session.state["unsaved"])
    assert np.array_equal(read(tmp_path / "plate.off", REGISTRY).vertices, session.history.now.vertices)
    # Escape lets the vertex go, and then Tab leaves the pane.
    ActionChains(driver).send_keys(Keys.ESCAPE, Keys.TAB).perform()
    assert driver.execute_script(focus) == "plane"


def test_control_points_functions_and_fairing_are_set_on_the_page(edited, open_browser):
    from selenium.webdriver import ActionChains
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.support.ui import Select

    session, where = edited
    driver = open_browser()
    ready(driver, where)
    Select(driver.find_element("id", "what")).select_by_value("control")
    driver.execute_script("arguments[0].focus()", canvas(driver))
    before = session.fit.shown(session.history.now)[0]
    ActionChains(driver).send_keys(Keys.TAB * 6, Keys.ARROW_RIGHT * 2).perform()
    waited(lambda: session.history.undoable == 1)
    ((number, *_),) = session.history.now.moved
    assert number == 5
    # The point where the function is largest goes with the key.
    handle = session.fit.controls[5]
    way = (session.fit.shown(session.history.now)[0] - before)[handle]
    assert np.allclose(way, 0.02 * session._scale * view_of(driver)[0], atol=1e-5 * session._scale)
    driver.find_element("id", "auto").click()
    waited(lambda: session.history.undoable == 2)
    assert session.history.now.fitter["fairing"] == pytest.approx(1e-3)
    settled(session)
    assert session.fit.draft.fitter["fairing"] == pytest.approx(1e-3)
    size = driver.find_element("id", "size")
    size.send_keys(Keys.ARROW_RIGHT * 30)
    waited(lambda: session.history.now.basis["size"] > 80)
    settled(session)
    assert len(session.fit.controls) == session.history.now.basis["size"]
    waited(lambda: "functions of gaussian" in driver.find_element("id", "told").text)
    assert [entry for entry in driver.get_log("browser") if entry["level"] == "SEVERE"] == []


def test_a_wrong_token_another_host_and_another_page_are_refused(edited):
    session, where = edited
    port = urlsplit(where).port

    def status(url, data=None, **headers):
        try:
            with urllib.request.urlopen(urllib.request.Request(url, data, headers), timeout=10) as answer:
                return answer.status
        except urllib.error.HTTPError as error:
            with error:
                return error.code

    body = b'{"vertex": 1, "by": [1, 0, 0]}'
    assert status(f"{where}state.json") == 200
    assert status(f"http://127.0.0.1:{port}/wrong/state.json") == 403
    assert status(f"http://127.0.0.1:{port}/wrong/move", body) == 403
    assert status(f"{where}move", body, Host="evil.example") == 403
    assert status(f"{where}move", body, Origin="http://evil.example") == 403
    for wrong in (b"{", b"[]", b'{"vertex": 999, "by": [1, 0, 0]}', b'{"vertex": 1, "by": [1, 0]}', b'{"by": 1}'):
        assert status(f"{where}move", wrong) in (400, 404)
    assert status(f"{where}move", b'{"vertex": 1, "by": [1e999, NaN, 0]}') == 400
    assert status(f"{where}influence.bin?vertex=999") == 404
    assert status(f"{where}set", b'{"basis": "gausian"}') == 400
    assert session.history.undoable == 0
    assert status(f"{where}move", body, Origin=f"http://127.0.0.1:{port}") == 200
    assert session.history.undoable == 1


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("size", [(1200, 760), (420, 800)])
def test_the_page_fits_two_sizes_light_and_dark(edited, open_browser, tmp_path, size, dark):
    driver = open_browser(size=size, dark=dark)
    ready(driver, edited[1])
    beyond = "const e = document.documentElement; return [e.scrollWidth - innerWidth, e.scrollHeight - innerHeight]"
    assert driver.execute_script(beyond) == [0, 0]
    corner = picture(driver)[0, -1]
    assert (corner.mean() < 0.3) == dark
    assert np.ptp(picture(driver)) > 0.3
    assert np.ptp(picture(driver, "plane")) > 0.3
