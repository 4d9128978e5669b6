"""Opens every page in Chromium and complains: check_pages.py PAGES SCREENSHOTS.

A page is DIR/report.html below PAGES. First the checks themselves are checked: on copies of a page with a fault each must complain.
"""
import contextlib
import pathlib
import shutil
import sys
import time

from faults import faults
from hostile import NAMES
from playwright.sync_api import sync_playwright

HERE = pathlib.Path(__file__).parent
IN_PAGE = (HERE / "in_page.js").read_text()
WIDTHS = {"phone": (390, 844), "desk": (1280, 900)}
# what must be found somewhere, so that no check is of nothing
KINDS = ["canvas", ".player", "tr[data-point]", "details", ".u-legend", "a[href^='#']"]


# canvases that are read often are better drawn without the graphics card: a choice of the browser's, not of the page
READ_OFTEN = """const get = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind) { return get.call(this, kind, { willReadFrequently: true }); };"""


@contextlib.contextmanager
def opened(browser, path, size, **options):
    """The page, and a list to which everything that it should not do is added."""
    width, height = WIDTHS[size]
    context = browser.new_context(viewport={"width": width, "height": height}, **options)
    context.add_init_script(READ_OFTEN)
    page, heard = context.new_page(), []
    url = path.absolute().as_uri()
    page.on("console", lambda m: m.type in ("error", "warning") and heard.append(f"console: {m.text}"))
    page.on("pageerror", lambda e: heard.append(f"error: {e}"))
    page.on("request", lambda r: r.url.split("#")[0] == url or heard.append(f"request: {r.url}"))
    page.on("websocket", lambda w: heard.append(f"request: {w.url}"))
    page.on("popup", lambda p: heard.append(f"a window: {p.url}"))

    def dialog(d):
        heard.append(f"dialog: {d.message}")
        d.dismiss()

    page.on("dialog", dialog)
    page.goto(url)
    page.evaluate(IN_PAGE)
    yield page, heard
    context.close()


def asked(page, *checks):
    """The complaints of the named checks of in_page.js."""
    return [wrong for check in checks for wrong in page.evaluate(f"() => check.{check}()")]


def look(page, name, size, shots):
    """What is wrong at one width, seen by day and by night, before and after every control was used."""
    wrong = asked(page, "open", "drawn", "layout", "foreign")
    page.emulate_media(color_scheme="dark")
    wrong += asked(page, "layout", "drawn")
    page.emulate_media(color_scheme="light")
    page.screenshot(path=shots / f"{name}-{size}.png", full_page=True)
    wrong += asked(page, "motion", "controls", "points")
    wrong += asked(page, "legends") if size == "desk" else []
    return wrong + asked(page, "drawn", "layout")


def check_checks(browser, good, work):
    """A check that finds nothing on a page with its fault is no check."""
    failures = []
    for name, check, text, expected in faults(good.read_text()):
        path = work / name / "report.html"
        path.parent.mkdir(parents=True)
        path.write_text(text)
        with opened(browser, path, "phone") as (page, heard):
            found = asked(page, check) + heard
        if not any(expected in f for f in found):
            failures.append(f"the fault `{name}` is not found: expected `{expected}`, heard {found}")
    return failures


def hostile_names(page):
    """Names that want to be markup stand in the page as they are."""
    text = page.evaluate("document.documentElement.textContent")
    return [f"the name {name} is not in the page" for name in NAMES if name not in text]


def main(pages, shots):
    shots.mkdir(parents=True)
    failures, seen, began = [], dict.fromkeys(KINDS, 0), time.monotonic()
    with sync_playwright() as playwright:
        # a container's root has no sandbox; the pages are our own
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        paths = sorted(pages.glob("*/report.html"))
        failures += check_checks(browser, pages / "identify" / "report.html", pages / "faults")
        for path in paths:
            name = path.parent.name
            for size in WIDTHS:
                with opened(browser, path, size) as (page, heard):
                    wrong = look(page, name, size, shots) + heard
                    if name.startswith("hostile"):
                        wrong += hostile_names(page)
                    for kind in KINDS:
                        seen[kind] += page.locator(kind).count()
                failures += [f"{name}, {size}: {w}" for w in wrong]
            with opened(browser, path, "desk", reduced_motion="reduce") as (page, heard):
                wrong = asked(page, "stillness") + heard
                failures += [f"{name}, without motion: {w}" for w in wrong]
        browser.close()
    failures += [f"no page has {kind}" for kind, n in seen.items() if n == 0]
    for failure in failures:
        print(failure, file=sys.stderr)
    print(f"{len(paths)} pages in {time.monotonic() - began:.0f} s, {len(failures)} complaints; screenshots in {shots}")
    return 1 if failures or not paths else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])))
