"""Drives the viewer in a browser: `browser.py BILUX CHROMIUM FOLDER`. Screenshots go to the folder. `cargo xtask viewer` runs it."""

from __future__ import annotations

import base64
import json
import math
import socket
import struct
import subprocess
import sys
from pathlib import Path

from axe_playwright_python.sync_playwright import Axe
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
        assert self.address.startswith("http://"), self.address

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


def extent(page: Page) -> list[float]:
    """Where the picture differs from its left edge: left, top, right and bottom, as fractions of it."""
    return page.locator("#picture").evaluate(
        """canvas => {
            const { width, height } = canvas;
            const { data } = canvas.getContext("2d").getImageData(0, 0, width, height);
            const box = [1, 1, 0, 0];
            for (let y = 0; y < height; y++) for (let x = 0; x < width; x++) {
                const [a, b] = [4 * (y * width), 4 * (y * width + x)];
                if (Math.abs(data[a] - data[b]) + Math.abs(data[a + 1] - data[b + 1]) + Math.abs(data[a + 2] - data[b + 2]) < 90) continue;
                [box[0], box[1]] = [Math.min(box[0], x / width), Math.min(box[1], y / height)];
                [box[2], box[3]] = [Math.max(box[2], x / width), Math.max(box[3], y / height)];
            }
            return box;
        }"""
    )


def visitors(browser: Browser, scene: Path) -> None:
    """Two have cameras of their own; the third is told to wait, and gets in when one leaves."""
    with Viewer(scene, "--visitors", "2") as viewer:
        one, two = (opened(browser, viewer, 700, 500, "light") for _ in range(2))
        one.focus("#view")
        one.keyboard.press("ArrowLeft")
        expect(one.locator("#command")).to_contain_text("--eye")
        two.wait_for_timeout(500)
        expect(two.locator("#command")).not_to_contain_text("--eye")
        three = browser.new_context(viewport={"width": 700, "height": 500}).new_page()
        three.goto(viewer.address)
        expect(three.locator("#problem")).to_contain_text("every place of this viewer is taken (2)", timeout=20_000)
        shot(three, "full")
        one.context.close()
        three.wait_for_selector("#waiting", state="hidden", timeout=30_000)
        expect(three.locator("#problem")).to_be_hidden()
        assert two.wrongs == [], two.wrongs
        three.context.close()
        two.context.close()


def restarts(browser: Browser, scene: Path) -> None:
    """A page finds a viewer that was started again, and shows its picture, however many frames it has seen before."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    with Viewer(scene, "--port", port) as viewer:
        page = opened(browser, viewer, 400, 300, "light")
        page.focus("#view")
        for _ in range(12):
            page.keyboard.press("ArrowLeft")
            page.wait_for_timeout(250)
        at_least(page, 2)
        before = pixels(page)
    expect(page.locator("#problem")).to_contain_text("does not answer", timeout=20_000)
    with Viewer(scene, "--port", port):
        expect(page.locator("#problem")).to_be_hidden(timeout=20_000)
        expect(page.locator("#command")).not_to_contain_text("--eye")
        page.wait_for_function("before => document.getElementById('picture').toDataURL() !== before", arg=before, timeout=10_000)
    page.context.close()


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


def accessible(page: Page) -> None:
    """The accessibility checker axe finds nothing serious."""
    # What a canvas shows through is no background that it could judge.
    found = Axe().run(page, options={"rules": {"region": {"enabled": True}}}).response["violations"]
    serious = [it for it in found if it["impact"] in ("serious", "critical")]
    shown = [(it["id"], it["help"], [node["html"][:160] for node in it["nodes"][:4]]) for it in serious]
    assert serious == [], shown


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
    section = page.locator("#edits")
    expect(section).to_be_visible()
    page.get_by_label("What", exact=True).select_option("material 0")
    page.get_by_label("Reflectance", exact=True).evaluate(
        "input => { input.value = '#2050d0'; input.dispatchEvent(new Event('input', { bubbles: true })); }"
    )
    undo = section.get_by_role("button", name="Undo")
    expect(undo).to_be_enabled()
    at_least(page, 8)
    section.scroll_into_view_if_needed()
    shot(page, "materials")
    before_and_after(page)
    undo.click()
    expect(undo).to_be_disabled()
    # Lights: a colour, and how strong it is.
    page.get_by_label("What", exact=True).select_option("light 0")
    strength = page.get_by_label("Radiance, strength", exact=True)
    strength.fill("60")
    strength.press("Enter")
    expect(page.locator("#command")).to_contain_text("--change light:lamp:radiance=60")
    page.get_by_label("What", exact=True).select_option("camera 0")
    fov = page.get_by_label("Fov, as a number", exact=True)
    fov.fill("55")
    fov.press("Enter")
    expect(page.locator("#command")).to_contain_text("--change camera:front:fov=55")
    saved(page)
    accessible(page)
    dropped(page)
    assert page.wrongs == [], page.wrongs
    page.context.close()


def before_and_after(page: Page) -> None:
    page.get_by_label("With", exact=True).select_option("unedited")
    expect(page.locator("#divider")).to_be_visible(timeout=30_000)
    expect(page.locator("#side-other")).to_have_text("Before the edits")
    page.get_by_label("With", exact=True).select_option("")
    expect(page.locator("#divider")).to_be_hidden()


def saved(page: Page) -> None:
    """The overlay that is saved makes a picture."""
    with page.expect_download() as saved:
        page.click("#save-overlay")
    overlay = FOLDER / "edited.toml"
    overlay.write_text(Path(saved.value.path()).read_text())
    assert 'base = "cornell.toml"' in overlay.read_text(), overlay.read_text()
    rendered = [BILUX, "render", overlay, "-o", FOLDER / "edited.png", "--size", "64x64", "--spp", "1"]
    subprocess.run(rendered, check=True, capture_output=True)


def dropped(page: Page) -> None:
    page.set_input_files("#open-file", FOLDER / "edited.toml")
    expect(page.locator("#problem")).to_contain_text("cornell.toml")
    expect(page.locator("#title")).to_have_text("cornell.toml")
    triangle = FOLDER / "triangle.obj"
    triangle.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    # As when it is dropped from a folder of the desktop.
    page.evaluate(
        """text => {
            const all = new DataTransfer();
            all.items.add(new File([text], "triangle.obj"));
            document.body.dispatchEvent(new DragEvent("drop", { dataTransfer: all, bubbles: true, cancelable: true }));
        }""",
        triangle.read_text(),
    )
    expect(page.locator("#title")).to_have_text("triangle.obj")
    at_least(page, 2)
    # The browser itself reports the answer that refuses the other file.
    page.wrongs[:] = [wrong for wrong in page.wrongs if "422" not in wrong]


def compares(browser: Browser, viewer: Viewer) -> None:
    page = opened(browser, viewer, 1280, 900, "dark")
    at_least(page, 2)
    page.get_by_label("With", exact=True).select_option("integrator")
    expect(page.locator("#compare-working")).to_be_visible()
    page.get_by_label("Integrator on the right", exact=True).select_option("bdpt")
    divider = page.locator("#divider")
    expect(divider).to_be_visible(timeout=60_000)
    expect(page.locator("#side-other")).to_have_text("Integrator: bdpt")
    expect(page.locator("#compare .plot polyline.own")).to_be_attached(timeout=60_000)
    expect(page.locator("#compare .plot polyline.other")).to_be_attached(timeout=60_000)
    page.wait_for_timeout(6000)
    page.locator("#compare").scroll_into_view_if_needed()
    shot(page, "compare")
    # The divider, by the keyboard and by the mouse.
    divider.focus()
    page.keyboard.press("ArrowRight")
    expect(divider).to_have_attribute("aria-valuenow", "52")
    page.keyboard.press("Home")
    expect(divider).to_have_attribute("aria-valuenow", "0")
    box = divider.bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, 300)
    page.mouse.down()
    page.mouse.move(box["x"] + 300, 300, steps=4)
    page.mouse.up()
    assert 10 < int(divider.get_attribute("aria-valuenow")) < 60
    expect(page.locator("#command")).not_to_contain_text("--eye")
    wide = page.locator("#other").evaluate("canvas => canvas.width")
    page.get_by_label("Differences", exact=True).check()
    expect(page.locator("#side-other")).to_have_text("Differences")
    # The map has fewer pixels, and does not wait for the next sample of the other picture.
    page.wait_for_function("wide => document.getElementById('other').width < wide", arg=wide, timeout=10_000)
    shot(page, "differences")
    accessible(page)
    page.get_by_label("With", exact=True).select_option("")
    expect(divider).to_be_hidden()
    # Accelerators beside each other, and the work of the one that is chosen.
    page.get_by_role("button", name="Measure all").click()
    expect(page.locator("#accelerators tbody tr")).to_have_count(8, timeout=60_000)
    page.get_by_label("Accel", exact=True).select_option("bsp")
    page.get_by_label("Visits", exact=True).check(force=True)
    page.wait_for_timeout(1500)
    page.locator("#accelerators").scroll_into_view_if_needed()
    shot(page, "accelerators")
    assert page.wrongs == [], page.wrongs
    page.context.close()


def plays(browser: Browser) -> None:
    """A scene that moves has a time, which goes on by itself."""
    moving = FOLDER / "moving.toml"
    moving.write_text(
        '[camera]\nposition = [0, 1, 6]\n[[light]]\nkind = "environment"\n[[model]]\nshape = "box"\n'
        "keyframes = [{ time = 0 }, { time = 2, rotate = [0, 90, 0] }]\n"
    )
    with Viewer(moving, "--set", "integrator=cast") as viewer:
        page = opened(browser, viewer, 900, 700, "light")
        at_least(page, 1)
        still = pixels(page)
        page.get_by_role("button", name="Play").click()
        page.wait_for_function("() => Number(document.getElementById('time-range').value) > 0.3", timeout=20_000)
        page.get_by_role("button", name="Pause").click()
        expect(page.locator("#command")).to_contain_text("--at")
        assert pixels(page) != still
        page.get_by_label("Time, as a number of seconds", exact=True).fill("1.5")
        page.get_by_label("Time, as a number of seconds", exact=True).press("Enter")
        expect(page.locator("#command")).to_contain_text("--at 1.5")
        assert page.wrongs == [], page.wrongs
        page.context.close()


def turned(page: Page, x: float, y: float) -> list[float]:
    """The degrees to the right and up by which a drag turns the camera around the point that it looks at."""
    page.keyboard.press("h")
    expect(page.locator("#command")).not_to_contain_text("--eye")
    box = page.locator("#view").bounding_box()
    middle = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    eyes = []
    for by in ((0, 0), (x, y)):
        page.mouse.move(*middle)
        page.mouse.down()
        page.mouse.move(middle[0] + by[0] + 6, middle[1] + by[1], steps=3)
        page.mouse.move(middle[0] + by[0], middle[1] + by[1], steps=3)
        page.mouse.up()
        expect(page.locator("#command")).to_contain_text("--eye")
        page.wait_for_timeout(400)
        words = page.inner_text("#command").split()
        points = [[float(part) for part in words[words.index(name) + 1].split(",")] for name in ("--eye", "--look-at")]
        eyes.append([a - b for a, b in zip(*points)])
    places = [(math.atan2(eye[0], eye[2]), math.asin(eye[1] / math.hypot(*eye))) for eye in eyes]
    return [math.degrees(after - before) for before, after in zip(*places)]


def drags(browser: Browser) -> None:
    """A drag turns by the same angle whatever the shape of the window: half a turn for the height of the picture."""
    model = FOLDER / "triangle.obj"
    model.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\n")
    with Viewer(model) as viewer:
        for width in (390, 1280):
            page = opened(browser, viewer, width, 844, "light")
            page.focus("#view")
            high = page.locator("#picture").evaluate("canvas => canvas.clientHeight")
            for x, y in ((60, 0), (0, 60)):
                right, up = turned(page, x, y)
                assert abs(right + 180 * x / high) < 0.3 and abs(up - 180 * y / high) < 0.3, (width, x, y, right, up)
            page.context.close()


def margins(browser: Browser, scene: Path) -> None:
    """Where the picture has margins, a click hits what is under it; the page works below a folder too."""
    with Viewer(scene, "--shared", "--listen", "0.0.0.0") as viewer:
        assert len(viewer.address.split("/")[3]) == 32, viewer.address
        wide = opened(browser, viewer, 1200, 500, "light")
        tall = opened(browser, viewer, 500, 900, "light")
        # The picture has the shape of the window that came last.
        for page in (wide, tall):
            page.wait_for_timeout(500)
            at_least(page, 2)
            place = page.locator("#picture").bounding_box()
            page.mouse.click(place["x"] + place["width"] / 2, place["y"] + place["height"] / 2)
            expect(page.locator("#pick-title")).to_be_attached(timeout=20_000)
            size = page.locator("#command").inner_text().split("--size ")[1].split(" ")[0].split("x")
            pixel = page.locator("#pick-title").text_content().removeprefix("Pixel ").split(", ")
            assert all(abs(int(at) - int(side) / 2) <= 2 for at, side in zip(pixel, size)), (pixel, size)
            page.keyboard.press("Escape")
        wide.mouse.click(5, 250)
        wide.wait_for_timeout(500)
        expect(wide.locator("#pick")).to_be_hidden()
        for page in (wide, tall):
            assert page.wrongs == [], page.wrongs
            page.context.close()


def clips(browser: Browser) -> None:
    """A glTF file with two animations has a menu of them, and the light around can be chosen."""
    accessors = [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}]
    accessors += [{"bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]}]
    accessors += [{"bufferView": view, "componentType": 5126, "count": 2, "type": "VEC3"} for view in (2, 3)]
    floats = struct.pack("<23f", *(0, 0, 0, 1, 0, 0, 0, 1, 0), *(0, 1), *(0, 0, 0, 1, 0, 0), *(0, 0, 0, 0, 1, 0))
    starts = [(0, 36), (36, 8), (44, 24), (68, 24)]
    clip = {"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}
    model = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "accessors": accessors,
        "buffers": [{"byteLength": 92, "uri": "data:application/octet-stream;base64," + base64.b64encode(floats).decode()}],
        "bufferViews": [{"buffer": 0, "byteOffset": at, "byteLength": length} for at, length in starts],
        "animations": [{"name": name, "samplers": [{"input": 1, "output": output}], **clip} for name, output in (("slide", 2), ("rise", 3))],
    }
    folder = FOLDER / "clips"
    folder.mkdir(exist_ok=True)
    (folder / "clips.gltf").write_text(json.dumps(model))
    # 1 x 1 pixel of white light: Portable FloatMap.
    (folder / "white.pfm").write_bytes(b"PF\n1 1\n-1.0\n" + struct.pack("<3f", 1, 1, 1))
    with Viewer(folder / "clips.gltf") as viewer:
        page = opened(browser, viewer, 1000, 700, "light")
        page.get_by_label("Animation", exact=True).select_option("rise")
        expect(page.locator("#command")).to_contain_text("--animation rise")
        page.get_by_label("Light around", exact=True).select_option(label="white.pfm")
        expect(page.locator("#command")).to_contain_text("--env")
        expect(page.locator("#problem")).to_be_hidden()
        at_least(page, 2)
        shot(page, "clips")
        page.get_by_label("Light around", exact=True).select_option("sky")
        expect(page.locator("#command")).to_contain_text("--env sky")
        at_least(page, 2)
        shot(page, "sky")
        page.get_by_label("Animation", exact=True).select_option("")
        expect(page.locator("#command")).not_to_contain_text("--animation")
        accessible(page)
        assert page.wrongs == [], page.wrongs
        page.context.close()


def phone(browser: Browser, viewer: Viewer) -> None:
    page = opened(browser, viewer, 390, 844, "light", touch=True)
    at_least(page, 4)
    assert page.evaluate("() => document.documentElement.scrollWidth") <= 390, "nothing is wider than the screen"
    expect(page.locator("#panel")).to_be_hidden()
    shot(page, "phone")
    # A drag that ends where it began changes nothing.
    before = extent(page)
    page.mouse.move(195, 300)
    page.mouse.down()
    for x in (205, 215, 205, 195):
        page.mouse.move(x, 300)
    page.mouse.up()
    expect(page.locator("#command")).to_contain_text("--eye")
    at_least(page, 4)
    after = extent(page)
    assert all(abs(a - b) < 0.03 for a, b in zip(before, after)), (before, after)
    page.touchscreen.tap(195, 300)
    expect(page.locator("#facts")).to_be_visible(timeout=20_000)
    expect(page.locator("#facts")).to_contain_text("m away")
    shot(page, "phone-facts")
    page.get_by_role("button", name="Controls").tap()
    expect(page.locator("#panel")).to_be_visible()
    expect(page.locator("#facts")).to_be_hidden()
    at_least(page, 4)
    shot(page, "phone-controls")
    page.touchscreen.tap(120, 250)
    expect(page.locator("#pick")).to_contain_text("Pixel")
    page.locator("#pick").scroll_into_view_if_needed()
    shot(page, "phone-pick")
    page.get_by_label("With", exact=True).select_option("integrator")
    expect(page.locator("#divider")).to_be_visible(timeout=60_000)
    page.wait_for_timeout(3000)
    shot(page, "phone-compare")
    page.get_by_label("With", exact=True).select_option("")
    accessible(page)
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
    # A view that was turned is there again after a reload of the page.
    page.locator("#view").press("ArrowLeft")
    expect(page.locator("#command")).to_contain_text("--eye")
    page.wait_for_function("() => location.hash.startsWith('#view=')")
    command = page.locator("#command").inner_text()
    page.reload()
    expect(page.locator("#command")).to_have_text(command, timeout=20_000)
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
    accessible(page)
    ids = page.locator("[id]").evaluate_all("all => all.map((it) => it.id)")
    assert len(ids) == len(set(ids)), "ids occur once"
    seen = set()
    for _ in range(70):
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
        with Viewer(scene, "--set", "integrator=path") as viewer:
            compares(browser, viewer)
        plays(browser)
        visitors(browser, scene)
        restarts(browser, scene)
        drags(browser)
        margins(browser, scene)
        clips(browser)
        browser.close()
    print(f"the viewer works in the browser; screenshots are in {FOLDER}")


main()
