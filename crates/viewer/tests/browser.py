"""Drives the viewer in a browser: `browser.py BILUX CHROMIUM FOLDER`. Screenshots go to the folder. `cargo xtask viewer` runs it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from playwright.sync_api import Browser, Page, expect, sync_playwright

BILUX, CHROMIUM, FOLDER = sys.argv[1], sys.argv[2], Path(sys.argv[3])


def generated(name: str) -> Path:
    path = FOLDER / f"{name}.toml"
    subprocess.run([BILUX, "generate", name, "-o", path], check=True, capture_output=True)
    return path


class Viewer:
    """A viewer of a scene, until the end of the block."""

    def __init__(self, scene: Path, *options: str) -> None:
        command = [BILUX, "serve", str(scene), *options]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.address = (self.process.stdout.readline() if self.process.stdout else "").strip()
        assert self.address.startswith("http://127.0.0.1:"), self.address

    def __enter__(self) -> Viewer:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.terminate()
        assert self.process.wait(20) == 0, "SIGTERM ends it cleanly"


def opened(browser: Browser, viewer: Viewer, width: int, height: int, scheme: str, touch: bool = False) -> Page:
    context = browser.new_context(
        viewport={"width": width, "height": height}, color_scheme=scheme, has_touch=touch, reduced_motion="reduce"
    )
    page = context.new_page()
    page.wrongs = []
    page.on("pageerror", lambda error: page.wrongs.append(str(error)))
    page.on("console", lambda said: said.type in ("error", "warning") and page.wrongs.append(said.text))
    page.goto(viewer.address)
    page.wait_for_selector("#waiting", state="hidden", timeout=60_000)
    return page


def at_least(page: Page, samples: int) -> None:
    """Waits until the picture has so many samples."""
    for _ in range(600):
        words = page.inner_text("#samples").split()
        if words and words[0].isdigit() and int(words[0]) >= samples:
            return
        page.wait_for_timeout(100)
    raise AssertionError(f"the picture does not get better: {page.inner_text('#status')}")


def shot(page: Page, name: str) -> None:
    page.screenshot(path=FOLDER / f"{name}.png")


def pixels(page: Page) -> str:
    return page.locator("#picture").evaluate("canvas => canvas.toDataURL()")


def desktop(browser: Browser, viewer: Viewer) -> None:
    page = opened(browser, viewer, 1280, 800, "dark")
    expect(page).to_have_title("cornell.toml – Bilux")
    at_least(page, 8)
    shot(page, "desktop")
    before = page.inner_text("#command")
    # Orbit by the mouse, and go home.
    page.mouse.move(500, 400)
    page.mouse.down()
    page.mouse.move(620, 370, steps=6)
    page.mouse.up()
    expect(page.locator("#command")).to_contain_text("--eye")
    page.click("#home")
    expect(page.locator("#command")).not_to_contain_text("--eye")
    # Keys do the same.
    page.focus("#view")
    page.keyboard.press("ArrowLeft")
    expect(page.locator("#command")).to_contain_text("--eye")
    page.keyboard.press("h")
    expect(page.locator("#command")).not_to_contain_text("--eye")
    # Integrator and accelerator.
    at_least(page, 2)
    page.get_by_label("Integrator", exact=True).select_option("whitted")
    expect(page.locator("#command")).to_contain_text("--integrator whitted")
    page.get_by_label("Accel", exact=True).select_option("bsp")
    expect(page.locator("#command")).to_contain_text("--accel bsp")
    page.get_by_label("Integrator", exact=True).select_option("path")
    at_least(page, 4)
    # Exposure, by the keyboard.
    slider = page.get_by_label("Exposure", exact=True)
    slider.focus()
    for _ in range(5):
        page.keyboard.press("ArrowRight")
    expect(page.locator("#command")).to_contain_text("--exposure 0.5")
    # Layers.
    light = pixels(page)
    page.get_by_label("Normal", exact=True).check(force=True)
    page.wait_for_timeout(1500)
    assert pixels(page) != light
    shot(page, "normals")
    page.get_by_label("Picture", exact=True).check(force=True)
    at_least(page, 4)
    assert before != page.inner_text("#command")
    pick(page)
    with page.expect_download() as saved:
        page.click("#save-png")
    assert Path(saved.value.path()).read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    with page.expect_download() as saved:
        page.click("#save-exr")
    assert Path(saved.value.path()).read_bytes()[:4] == b"\x76\x2f\x31\x01"
    assert page.wrongs == [], page.wrongs
    page.context.close()


def pick(page: Page) -> None:
    page.mouse.click(330, 560)
    expect(page.locator("#pick")).to_contain_text("95% interval")
    expect(page.locator("#overlay line").first).to_be_attached()
    assert page.locator("#overlay line").count() > 8
    page.wait_for_timeout(500)
    shot(page, "paths")
    page.get_by_label("Shown", exact=True).select_option("0")
    expect(page.locator(".events li").first).to_be_visible()
    page.focus("#view")
    page.keyboard.press("Escape")
    expect(page.locator("#pick")).to_be_hidden()
    assert page.locator("#overlay *").count() == 0


def edits(browser: Browser, viewer: Viewer) -> None:
    page = opened(browser, viewer, 1280, 1000, "light")
    at_least(page, 4)
    section = page.locator("#materials")
    expect(section).to_be_visible()
    page.get_by_label("Reflectance", exact=True).evaluate(
        "input => { input.value = '#2050d0'; input.dispatchEvent(new Event('input', { bubbles: true })); }"
    )
    undo = section.get_by_role("button", name="Undo")
    expect(undo).to_be_enabled()
    at_least(page, 8)
    section.scroll_into_view_if_needed()
    shot(page, "materials")
    undo.click()
    expect(undo).to_be_disabled()
    assert page.wrongs == [], page.wrongs
    page.context.close()


def phone(browser: Browser, viewer: Viewer) -> None:
    page = opened(browser, viewer, 390, 844, "light", touch=True)
    at_least(page, 4)
    assert page.evaluate("() => document.documentElement.scrollWidth") <= 390, "nothing is wider than the screen"
    expect(page.locator("#panel")).to_be_hidden()
    shot(page, "phone")
    page.get_by_role("button", name="Controls").tap()
    expect(page.locator("#panel")).to_be_visible()
    at_least(page, 4)
    shot(page, "phone-controls")
    page.touchscreen.tap(120, 250)
    expect(page.locator("#pick")).to_contain_text("Pixel")
    page.locator("#pick").scroll_into_view_if_needed()
    shot(page, "phone-pick")
    assert page.wrongs == [], page.wrongs
    page.context.close()


def reload(browser: Browser, viewer: Viewer, scene: Path) -> None:
    page = opened(browser, viewer, 1000, 700, "dark")
    at_least(page, 2)
    text, shown = scene.read_text(), pixels(page)
    page.wait_for_timeout(900)
    scene.write_text("this is no scene [")
    expect(page.locator("#problem")).to_be_visible(timeout=20_000)
    shot(page, "broken")
    assert shown and page.locator("#picture").is_visible(), "the old picture stays"
    scene.write_text(text)
    expect(page.locator("#problem")).to_be_hidden(timeout=20_000)
    at_least(page, 2)
    page.context.close()


def names(browser: Browser, viewer: Viewer) -> None:
    """Everything that can be used has a name, and the focus reaches it."""
    page = opened(browser, viewer, 1280, 800, "light")
    page.wait_for_selector("#controls select")
    nameless = page.locator("input, select, button, a[href], summary").evaluate_all(
        "all => all.filter((it) => !(it.labels?.[0] ?? it).textContent.trim() && !it.ariaLabel && !it.value)"
        ".map((it) => it.outerHTML)"
    )
    assert nameless == [], nameless
    ids = page.locator("[id]").evaluate_all("all => all.map((it) => it.id)")
    assert len(ids) == len(set(ids)), "ids occur once"
    seen = set()
    for _ in range(60):
        page.keyboard.press("Tab")
        seen.add(page.evaluate("() => document.activeElement.id || document.activeElement.textContent"))
    for wanted in ("view", "fold", "save-png", "save-exr", "copy", "command"):
        assert wanted in seen, f"the keyboard does not reach {wanted}: {seen}"
    shot(page, "desktop-light")
    page.context.close()


def main() -> None:
    scene = generated("cornell")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        with Viewer(scene, "--set", "integrator=path") as viewer:
            desktop(browser, viewer)
        with Viewer(scene) as viewer:
            names(browser, viewer)
            phone(browser, viewer)
            reload(browser, viewer, scene)
        with Viewer(scene, "--edit", "--set", "integrator=path") as viewer:
            edits(browser, viewer)
        browser.close()
    print(f"the viewer works in the browser; screenshots are in {FOLDER}")


main()
