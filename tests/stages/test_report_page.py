"""The report in a browser: it draws, plays and can be used without a mouse and on a phone."""

import json
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from slidepipe.stages import report

webdriver = pytest.importorskip("selenium.webdriver", reason="selenium is not installed (make test installs it)")
from selenium.webdriver.chrome.service import Service  # noqa: E402
from selenium.webdriver.common.action_chains import ActionChains  # noqa: E402
from selenium.webdriver.common.keys import Keys  # noqa: E402

BROWSER, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
pytestmark = pytest.mark.skipif(BROWSER is None or DRIVER is None, reason="no chromium and chromedriver: make browser")
OPTIONS = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--window-size=1200,900")


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    options = webdriver.ChromeOptions()
    options.binary_location = BROWSER
    for option in (*OPTIONS, f"--user-data-dir={tmp_path_factory.mktemp('browser')}"):
        options.add_argument(option)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service(DRIVER))
    yield driver
    driver.quit()


@pytest.fixture
def page(browser: Any, regrasp_report: report.ReportResult) -> Any:
    browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    browser.get(regrasp_report.path.as_uri())
    return browser


def frame(page: Any) -> int:
    return int(page.find_element("id", "scrub").get_attribute("value"))


def picture(page: Any, name: str) -> str:
    return str(page.execute_script("return document.getElementById(arguments[0]).toDataURL()", name))


def press(page: Any, *keys: str) -> None:
    ActionChains(page).send_keys(*keys).perform()


def test_it_loads_without_a_word_of_complaint_and_asks_for_nothing_else(page):
    asked = [entry["message"] for entry in page.get_log("performance") if "requestWillBeSent" in entry["message"]]
    assert asked
    assert [one for one in asked if '"url":"http' in one] == []
    assert page.get_log("browser") == []
    assert page.title == "Report: regrasp"
    assert page.execute_script("return [...document.images].every((one) => one.complete && one.naturalWidth > 300)")


def test_the_keyboard_plays_steps_and_jumps(page):
    assert frame(page) == 0
    press(page, Keys.ARROW_RIGHT, Keys.ARROW_RIGHT, Keys.ARROW_LEFT)
    assert frame(page) == 1
    press(page, Keys.END)
    last = frame(page)
    assert last == int(page.find_element("id", "scrub").get_attribute("max")) > 20
    press(page, Keys.HOME)
    press(page, " ")
    assert page.find_element("id", "play").text == "Pause"
    page.execute_script("document.getElementById('speed').value = '1'")
    page.set_script_timeout(60)
    page.execute_async_script(
        "const done = arguments[0], button = document.getElementById('play');"
        "(function wait() { button.textContent === 'Play' ? done() : requestAnimationFrame(wait); })();"
    )
    assert frame(page) == last, "it stops by itself at the end"


def test_the_pictures_follow_the_time(page):
    begin = [picture(page, name) for name in ("plane", "surface")]
    page.execute_script(
        "const scrub = document.getElementById('scrub');"
        "scrub.value = Math.round(scrub.max / 2); scrub.dispatchEvent(new Event('input'));"
    )
    assert [picture(page, name) != before for name, before in zip(("plane", "surface"), begin, strict=True)] == [
        True
    ] * 2
    assert "Friction" in page.find_element("id", "now").text
    before = picture(page, "surface")
    ActionChains(page).drag_and_drop_by_offset(page.find_element("id", "surface"), 60, 20).perform()
    assert picture(page, "surface") != before, "dragging turns the surface"


def test_another_trial_can_be_chosen(page):
    choice = page.find_element("id", "trial")
    assert [one.text.split()[0] for one in choice.find_elements("tag name", "option")] == ["1", "2", "3"]
    page.find_element("css selector", "#trial option").click()
    press(page, Keys.TAB)
    assert frame(page) == 0
    assert page.find_element("id", "now").text.startswith("-0.")


def test_it_fits_a_phone_and_can_be_reached_by_tab(page):
    phone = {"width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": True}
    page.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", phone)
    page.refresh()
    assert page.execute_script("return document.documentElement.scrollWidth") <= 390
    for name in ("play", "scrub", "speed", "trial"):
        box = page.find_element("id", name).rect
        assert box["height"] >= 35
        assert 0 <= box["x"] <= box["x"] + box["width"] <= 390
    reached = set()
    for _ in range(20):
        press(page, Keys.TAB)
        reached.add(page.switch_to.active_element.get_attribute("id"))
    assert {"play", "scrub", "speed", "trial"} <= reached


def test_an_object_that_flew_off_does_not_shrink_the_picture(page, regrasp_report: report.ReportResult, tmp_path: Path):
    held = picture(page, "plane")
    text = regrasp_report.path.read_text(encoding="utf-8")
    scenes = re.search(r'id="scenes">(.*?)</script>', text, re.DOTALL)
    told = json.loads(scenes[1])
    for scene in told:
        scene["object"][-1] = [15.0, -15.0, 0.0]
    lost = tmp_path / "lost.html"
    lost.write_text(text.replace(scenes[1], json.dumps(told)), encoding="utf-8")
    page.get(lost.as_uri())
    assert picture(page, "plane") == held
