"""The site builds without warnings, its links lead somewhere, and browsers show its pictures."""

import re
import shutil
import subprocess
import sys
from contextlib import contextmanager
from html.parser import HTMLParser
from io import BytesIO
from pathlib import Path
from urllib.parse import unquote, urlsplit

import numpy as np
import pytest
from PIL import Image

DOCS = Path(__file__).parents[2] / "docs"
TUTORIALS = sorted(path.stem for path in (DOCS.parent / "tutorials").glob("*.ipynb"))


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The built site."""
    for name in ("sphinx", "myst_nb", "furo", "webgui_jupyter_widgets"):
        pytest.importorskip(name)
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "-W", "-q", "-d", folder / "trees", DOCS, folder]
    result = subprocess.run(command, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    return folder


class Links(HTMLParser):
    """What a page refers to, and the anchors that it has."""

    def __init__(self, path):
        super().__init__()
        self.links, self.anchors = [], set()
        self.feed(path.read_text())

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        self.links += [attrs[name] for name in ("href", "src") if attrs.get(name)]
        self.anchors |= {attrs[name] for name in ("id", "name") if attrs.get(name)}


def test_links(site):
    """They lead somewhere; scripts, styles and pictures come without a network."""
    loaded = re.compile(r'<(?:script|link|img)[^>]+(?:src|href)="(https?:[^"]+)"')
    pages = {path: Links(path) for path in site.rglob("*.html")}
    broken = []
    for path, page in pages.items():
        broken += [(path.name, link) for link in loaded.findall(path.read_text())]
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            anchors = pages[target].anchors if target in pages else {parts.fragment}
            if not target.exists() or (parts.fragment and unquote(parts.fragment) not in anchors):
                broken.append((path.name, link))
    assert not broken
    assert len(pages) > len(TUTORIALS) + 8


@pytest.fixture(scope="module")
def browser():
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    sync_api = pytest.importorskip("playwright.sync_api")
    if chromium is None:
        pytest.skip("live scenes are looked at in Chromium, which is not installed")
    with sync_api.sync_playwright() as playwright:
        flags = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
        browser = playwright.chromium.launch(executable_path=chromium, args=flags)
        yield browser
        browser.close()


@contextmanager
def Opened(browser, width, scheme="light"):
    """A page of the browser, and a list of what goes wrong in it."""
    size, errors = {"width": width, "height": 900}, []
    page = browser.new_page(viewport=size, color_scheme=scheme)
    page.set_default_timeout(120_000)  # pictures are drawn without a graphics card
    page.on("console", lambda message: message.type == "error" and errors.append(message.text))
    page.on("pageerror", lambda error: errors.append(str(error)))
    aborted = "net::ERR_ABORTED"  # the page was left before
    page.on("requestfailed", lambda r: r.failure == aborted or errors.append(r.url))
    yield page, errors
    page.close()


@pytest.fixture
def page(browser):
    with Opened(browser, 1200) as opened:
        yield opened


def Colours(box):
    """Number of different colours of a screenshot."""
    pixels = np.asarray(Image.open(BytesIO(box.screenshot())).convert("RGB")).reshape(-1, 3)
    return len(np.unique(pixels, axis=0))


LOOKED_AT = ("01_contact_in_twenty_lines",)  # the others each week; of 03 one is on the first page


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=() if n in LOOKED_AT else pytest.mark.full) for n in TUTORIALS]
)
def test_scenes_in_a_browser(site, page, name):
    page, errors = page
    page.goto((site / "tutorials" / f"{name}.html").as_uri())
    boxes = page.locator(".webgui")
    assert boxes.count() == len(list((site / "_static" / "scenes").glob(f"{name}-*.js")))
    for k in range(boxes.count()):
        box = boxes.nth(k)
        box.scroll_into_view_if_needed()
        page.wait_for_function("box => box.dataset.drawn", arg=box.element_handle())
        page.wait_for_timeout(300)
        # An empty scene has the colours of the axes and of the legend alone.
        assert Colours(box.locator("canvas").first) > 30, f"scene {k + 1}"
    assert not errors


def test_the_first_page_has_a_scene_and_a_gallery(site, page):
    page, errors = page
    page.goto((site / "index.html").as_uri())
    box = page.locator(".webgui")
    box.scroll_into_view_if_needed()
    page.wait_for_function("box => box.dataset.drawn", arg=box.element_handle())
    page.wait_for_timeout(300)
    assert Colours(box.locator("canvas").first) > 30
    assert page.locator(".gallery img").count() >= 12
    assert page.locator(".gallery a").count() >= 12
    assert not errors


@pytest.mark.parametrize(
    "name", ["index", "theory", "api/index", "howto/seal", "benchmarks", "benchmarks_accuracy"]
)
def test_pages_in_a_browser(site, page, name):
    page, errors = page
    page.goto((site / f"{name}.html").as_uri())
    if name == "theory":
        page.locator("mjx-container").nth(20).wait_for()
        assert page.locator("mjx-merror").count() == 0
    page.wait_for_timeout(500)
    pictures = page.locator("article img")
    for k in range(pictures.count()):
        assert pictures.nth(k).evaluate("picture => picture.naturalWidth") > 100
    assert not errors


# What sticks out of the window and cannot be scrolled to; formulas for screen readers are not seen.
WIDER = """() => {
  const width = document.documentElement.clientWidth;
  const scrolled = node => { for (; node.tagName != "ARTICLE"; node = node.parentElement)
    if (["auto", "scroll"].includes(getComputedStyle(node).overflowX)) return true; };
  const wide = node => node.getBoundingClientRect().right > width + 1
    && !node.closest("mjx-assistive-mml") && !scrolled(node);
  const found = [...document.querySelectorAll("article *")].filter(wide);
  return found.map(node => node.tagName + " " + node.textContent.slice(0, 60));
}"""


# Text that is wider or higher than a box that does not show what sticks out.
CUT = """() => {
  const hides = node => ["hidden", "clip"].includes(getComputedStyle(node).overflowX);
  const cut = node => hides(node) && node.textContent.trim() && node.clientWidth > 1
    && node.scrollWidth > node.clientWidth + 1 && !node.closest("mjx-container, .webgui");
  const found = [...document.querySelectorAll("article *")].filter(cut);
  return found.map(node => node.tagName + " " + node.textContent.slice(0, 60));
}"""
SCREENS = 2700  # pixels: three screens, for the pages about benchmarks
LONGEST = 8000  # pixels; tutorials and theory are read from the beginning to the end


ALIKE = "api", "howto", "tutorials", "validation"  # folders whose pages are made like each other


# Dark pages have the same boxes in other colours: each week, as are most of the pages that are
# alike.
@pytest.mark.parametrize(
    ("scheme", "every"),
    [("light", 8), *(pytest.param(s, 1, marks=pytest.mark.full) for s in ("light", "dark"))],
)
def test_pages_fit_into_phones_and_wide_screens(site, browser, scheme, every):
    """Nothing sticks out or is cut, and pages are short on a desktop."""
    wide, cut, long = {}, {}, {}
    with Opened(browser, 390, scheme) as (page, errors):
        paths = sorted(site.rglob("*.html"))
        alike = [path for path in paths if path.relative_to(site).parts[0] in ALIKE]
        for path in sorted({*paths} - {*alike}) + alike[::every]:
            page.set_viewport_size({"width": 390, "height": 900})
            page.goto(path.as_uri())
            for width in (390, 1600):
                page.set_viewport_size({"width": width, "height": 900})
                key = path.name, width
                wide[key], cut[key] = page.evaluate(WIDER), page.evaluate(CUT)
            height = page.evaluate("document.querySelector('article').scrollHeight")
            free = path.parent.name == "tutorials" or path.stem in ("theory", "genindex")
            most = SCREENS if path.stem.startswith("benchmarks") else LONGEST
            if not free and height > most:
                long[path.name] = height
    assert not {key: found for key, found in wide.items() if found}
    assert not {key: found for key, found in cut.items() if found}
    assert not long
    assert not errors
