"""The page in a browser: values are read back, curves are switched, nothing is loaded, nothing goes wrong."""

import json
import os

import pytest
from program import MODELS, PENDULUM, model, run
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    options = webdriver.ChromeOptions()
    options.binary_location = os.environ["SFDAE_CHROMIUM"]
    for flag in ("headless", "no-sandbox", "disable-gpu", "disable-quic", "no-first-run", "disable-background-networking",
                 "disable-component-update", "disable-sync", "disable-dev-shm-usage", "window-size=1300,1400",
                 f"user-data-dir={tmp_path_factory.mktemp('profile')}"):
        options.add_argument("--" + flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(service=Service(os.environ["SFDAE_CHROMEDRIVER"]), options=options)
    yield driver
    driver.quit()


def opened(browser, path):
    """Opens a page and checks that it asks for nothing else and complains about nothing."""
    browser.get("about:blank")
    browser.get_log("performance")
    browser.get(path.as_uri())
    requests = [json.loads(entry["message"])["message"] for entry in browser.get_log("performance")]
    addresses = {r["params"]["request"]["url"] for r in requests if r["method"] == "Network.requestWillBeSent"}
    assert addresses == {path.as_uri()}
    assert browser.get_log("browser") == []
    return browser


@pytest.fixture
def pendulum(browser, tmp_path):
    run("solve", PENDULUM, "--html", tmp_path / "p.html", "--json", tmp_path / "p.json", "--set", "g=1.62")
    opened(browser, tmp_path / "p.html").data = json.loads((tmp_path / "p.json").read_text())
    return browser


def curves(browser):
    return [curve.get_attribute("data-name") for curve in browser.find_elements(By.CSS_SELECTOR, ".curve")]


def rows(browser, section):
    return [[cell.text for cell in row.find_elements(By.TAG_NAME, "td")]
            for row in browser.find_elements(By.CSS_SELECTOR, f"#{section} tbody tr")]


def test_texts_and_values_are_those_of_the_solution(pendulum):
    assert pendulum.title == "Pendulum - sfdae"
    assert pendulum.find_element(By.ID, "name").text == "Pendulum"
    assert pendulum.find_element(By.ID, "outcome").text == "solved"
    tiles = {tile.get_attribute("data-name"): tile.find_element(By.TAG_NAME, "b").text
             for tile in pendulum.find_elements(By.CLASS_NAME, "tile")}
    assert tiles["index"] == "3" and tiles["free initial values"] == "2"
    assert tiles["steps"] == str(pendulum.data["statistics"]["steps"])
    assert "Index 3 (strangeness index 2)." in pendulum.find_element(By.ID, "words").text
    values = {row[0]: row for row in rows(pendulum, "final")}
    for variable in pendulum.data["variables"]:
        name, unit, first, last = values[variable["name"]]
        assert unit == variable["unit"]
        for text, value in ((first, variable["values"][0]), (last, variable["values"][-1])):
            assert float(text) == pytest.approx(value, rel=1e-8, abs=1e-300)
    assert ["g", "m/s2", "1.62 (set)", "gravity"] in rows(pendulum, "parameters")
    assert not pendulum.find_element(By.ID, "warnings").is_displayed()


def test_curves_are_switched(pendulum):
    before = curves(pendulum)
    assert set(before) == {"x", "y", "vx", "vy", "F", "energy"}
    labels = {label.find_element(By.CLASS_NAME, "name").text: label
              for label in pendulum.find_elements(By.CSS_SELECTOR, "#chooser label")}
    labels["vx"].click()
    assert set(curves(pendulum)) == set(before) - {"vx"}
    labels["vx"].click()
    assert set(curves(pendulum)) == set(before)
    units = [panel.get_attribute("data-unit") for panel in pendulum.find_elements(By.CLASS_NAME, "panel")]
    assert units == ["m", "m/s", "N/m", "J"]
    pendulum.find_element(By.ID, "search").send_keys("height")
    assert [name for name, label in labels.items() if label.is_displayed()] == ["y"]
    assert pendulum.get_log("browser") == []


def test_pointer_shows_values(pendulum):
    panel = pendulum.find_element(By.CLASS_NAME, "panel")
    ActionChains(pendulum).move_to_element(panel).perform()
    box = pendulum.find_element(By.ID, "values")
    lines = [line.find_elements(By.TAG_NAME, "b")[0].text for line in box.find_elements(By.TAG_NAME, "div")]
    time = float(lines[0])
    k = min(range(501), key=lambda i: abs(pendulum.data["time"][i] - time))
    assert abs(pendulum.data["time"][k] - time) < 1e-7 and 3 < time < 7
    for text, variable in zip(lines[1:], pendulum.data["variables"]):
        assert float(text) == pytest.approx(variable["values"][k], rel=1e-7)


def test_zoom_and_back(pendulum):
    def axis():
        texts = pendulum.find_element(By.CLASS_NAME, "panel").find_elements(By.CSS_SELECTOR, "text[text-anchor=middle]")
        return [float(text.text) for text in texts]

    whole = axis()
    assert whole[0] == 0 and whole[-1] == 10
    panel = pendulum.find_element(By.CLASS_NAME, "panel")
    ActionChains(pendulum).move_to_element_with_offset(panel, -100, 0).click_and_hold().move_by_offset(200, 0).release().perform()
    zoomed = axis()
    assert 2 < zoomed[0] < zoomed[-1] < 8
    pendulum.find_element(By.ID, "all").click()
    assert axis() == whole


def test_rank_decisions_are_drawn(pendulum):
    decisions = pendulum.data["decisions"]
    groups = pendulum.find_elements(By.CSS_SELECTOR, "#picture g")
    assert len(groups) == min(16, len(decisions))

    def position(group, kind):
        return float(group.find_element(By.CLASS_NAME, kind).get_attribute("cx"))

    kept = [group for group in groups if group.find_elements(By.CLASS_NAME, "kept")]
    assert kept and all(position(group, "kept") > position(group, "dropped") for group in kept)


def test_events_and_discrete_variables(browser, tmp_path):
    run("solve", os.path.join(MODELS, "bouncing_ball.mo"), "--html", tmp_path / "b.html", "--json", tmp_path / "b.json")
    opened(browser, tmp_path / "b.html")
    events = json.loads((tmp_path / "b.json").read_text())["events"]
    shown = rows(browser, "events")
    assert len(shown) == len(events) >= 13
    assert float(shown[0][0]) == pytest.approx(events[0]["time"], rel=1e-8) and shown[0][1] == events[0]["text"].strip()


def test_strange_names_are_text(browser, tmp_path):
    name = "</script><script>document.title='broken'</script><b>"
    path = model(tmp_path, f"    Real '{name.replace(chr(39), chr(92) + chr(39))}'(start = 1.0, fixed = true);",
                 f"    der('{name.replace(chr(39), chr(92) + chr(39))}') = 1.0;", name="<i>{{data}}")
    run("solve", path, "--html", tmp_path / "s.html")
    opened(browser, tmp_path / "s.html")
    assert browser.title == "<i>{{data}} - sfdae" and browser.find_element(By.ID, "name").text == "<i>{{data}}"
    assert curves(browser) == [name]


def test_analysis_alone_has_no_curves(browser, tmp_path):
    run("analyze", PENDULUM, "--html", tmp_path / "a.html")
    opened(browser, tmp_path / "a.html")
    assert not browser.find_element(By.ID, "curves").is_displayed()
    assert browser.find_element(By.ID, "index").is_displayed() and len(rows(browser, "final")) == 6


def test_failure_says_why(browser, tmp_path):
    path = model(tmp_path, "    Real 'x'(start = 1.0, fixed = true);", "    der('x') = 'x' ^ 2;")
    run("solve", path, "--to", "2", "--html", tmp_path / "f.html", code=1)
    opened(browser, tmp_path / "f.html")
    assert browser.find_element(By.ID, "outcome").text == "not finished"
    assert browser.find_element(By.ID, "message").text != ""
