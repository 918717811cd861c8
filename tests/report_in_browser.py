#!/usr/bin/env python3
"""Opens a report in headless Chromium and uses it: python3 tests/report_in_browser.py REPORT.html [--shots DIR]

Needs chromium and chromedriver (Debian: chromium chromium-driver) and nothing else: it speaks WebDriver by itself.
Exit code 0: all that was tried works; 1: something does not, which is said; 77: there is no Chromium that starts.
"""

import argparse
import base64
import contextlib
import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request

FLAGS = [
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-dev-shm-usage", "--disable-sync", "--hide-scrollbars",
]
SECONDS = 120
# No proxy, whatever the environment says.
OPENER = urllib.request.build_opener(urllib.request.ProxyHandler({}))


class NoSession(Exception):
    """Chromium or its driver does not start."""


class Browser:
    """A WebDriver session."""

    def __init__(self, port, profile):
        self.base = f"http://127.0.0.1:{port}"
        options = {"args": [*FLAGS, f"--user-data-dir={profile}"], "binary": shutil.which("chromium")}
        wanted = {"browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}
        session = self.call("POST", "/session", {"capabilities": {"alwaysMatch": wanted}})
        self.session = f"/session/{session['sessionId']}"

    def call(self, method, path, body=None, seconds=SECONDS):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.base + path, data, {"Content-Type": "application/json"}, method=method)
        try:
            with OPENER.open(request, timeout=seconds) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)["value"]["message"].split("\n")[0]) from None

    def post(self, path, **body):
        return self.call("POST", self.session + path, body)

    def open(self, url):
        self.post("/url", url=url)

    def run(self, script, *args):
        """The value of a JavaScript function's body."""
        return self.post("/execute/sync", script=script, args=args)

    def errors(self):
        return [entry["message"] for entry in self.post("/se/log", type="browser") if entry["level"] == "SEVERE"]

    def devtools(self, command, **parameters):
        return self.post("/goog/cdp/execute", cmd=command, params=parameters)

    def resize(self, width, height, touch=False):
        self.devtools("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=touch)

    def shot(self, path):
        path.write_bytes(base64.b64decode(self.call("GET", self.session + "/screenshot")))

    def printed(self, path):
        path.write_bytes(base64.b64decode(self.post("/print", background=True)))

    def close(self):
        self.call("DELETE", self.session, seconds=10)


@contextlib.contextmanager
def browser():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        driver = subprocess.Popen(["chromedriver", f"--port={port}"], start_new_session=True, **quiet)
        try:
            try:
                wait_for(port)
                session = Browser(port, profile)
            except (OSError, RuntimeError) as error:
                raise NoSession(error) from error
            try:
                yield session
            finally:
                with contextlib.suppress(OSError, RuntimeError):
                    session.close()
        finally:
            driver.terminate()
            with contextlib.suppress(subprocess.TimeoutExpired):
                driver.wait(10)
            with contextlib.suppress(ProcessLookupError):
                os.killpg(driver.pid, signal.SIGKILL)
            driver.wait()


def wait_for(port):
    end = time.monotonic() + SECONDS
    while True:
        try:
            return socket.create_connection(("127.0.0.1", port), 1).close()
        except OSError:
            if time.monotonic() > end:
                raise
            time.sleep(0.1)


# Each check is the body of a function that returns a text where something is wrong, else nothing.
HELPERS = """
const all = (selector, root = document) => [...root.querySelectorAll(selector)];
const shown = (selector) => all(selector).filter((one) => one.offsetParent !== null);
const set = (selector, value) => {
  const field = document.querySelector(selector);
  field.value = value;
  field.dispatchEvent(new Event(field.tagName === "SELECT" ? "change" : "input"));
};
const column = (table, i) => [...table.tBodies[0].rows].map((row) => Number(row.cells[i].dataset.value));
const sorted = (values, sign) => values.every((value, i) => i === 0 || sign * (value - values[i - 1]) >= 0);
"""
CHECKS = {
    "it stands by itself": """
        const outside = all("[src], link[href]").map((one) => one.getAttribute("src") ?? one.getAttribute("href"));
        const bad = outside.filter((address) => !address.startsWith("data:"));
        if (bad.length) return `it loads ${bad}`;""",
    "tables end with chance and ceiling": """
        const names = all("#measures table:first-of-type tbody th").map((th) => th.textContent);
        if (!names.includes("chance") || !names.includes("ceiling")) return names.join();""",
    "a click sorts, another turns it around": """
        for (const table of all("#measures table, #significance table")) {
          const heading = table.tHead.rows[0].cells[table.tHead.rows[0].cells.length - 1];
          const at = heading.cellIndex;
          heading.click();
          if (!sorted(column(table, at), -1)) return `not falling: ${column(table, at)}`;
          heading.click();
          if (!sorted(column(table, at), 1)) return `not rising: ${column(table, at)}`;
        }""",
    "methods are shown and hidden": """
        const boxes = all("[data-hide]");
        const lines = (i) => all(`.chart:first-of-type [stroke="var(--m${i})"]`).filter((line) => getComputedStyle(line).display !== "none");
        if (!boxes[0].checked || !lines(0).length) return "the first method has no curve";
        boxes[0].click();
        if (lines(0).length) return "its curve is still there";
        boxes[0].click();
        if (!lines(0).length) return "its curve does not come back";
        const every = document.querySelector("[data-show=all]");
        if (every) {
          every.click();
          if (boxes.some((box) => !box.checked)) return "`all` does not show all";
          document.querySelector("[data-show=first]").click();
        }""",
    "the curves tell their values": """
        for (const chart of all(".chart")) {
          const box = chart.querySelector("svg").getBoundingClientRect();
          const at = { clientX: box.left + box.width * 0.6, clientY: box.top + box.height * 0.4, bubbles: true };
          chart.querySelector("svg").dispatchEvent(new PointerEvent("pointermove", at));
          const tip = document.getElementById("tip");
          if (tip.hidden || !/recall 0\\.[4-7]/.test(tip.textContent) || !/0\\.\\d{3}/.test(tip.textContent)) return `tip: ${tip.textContent}`;
          chart.querySelector("svg").dispatchEvent(new PointerEvent("pointerleave"));
          if (!tip.hidden) return "the tip stays";
        }""",
    "classes are filtered and put in order": """
        const names = () => shown(".class").map((one) => one.dataset.name);
        const first = names()[0];
        set("#class-name", first);
        if (!names().length || names().some((name) => !name.includes(first))) return names().join();
        set("#class-name", "");
        set("#class-order", "size");
        if (!sorted(shown(".class").map((one) => Number(one.dataset.size)), -1)) return "not by size";
        set("#class-order", "worst");
        const bar = (one) => parseFloat(one.querySelector(".bar i").style.width);
        if (!sorted(shown(".class").map(bar), 1)) return "not the worst first";
        set("#class-order", "name");""",
    "the confusion of another method": """
        const select = document.querySelector("[data-shows=confusion]");
        if (!select) return;
        select.selectedIndex = select.options.length - 1;
        select.dispatchEvent(new Event("change"));
        const blocks = shown("[data-of=confusion]");
        if (select.options.length > 1 && (blocks.length > 1 || all("[data-of=confusion]").at(-1).hidden)) return "not shown alone";""",
    "the gallery filters": """
        if (!document.getElementById("gallery")) return;
        const total = all("[data-query]").length;
        const options = [...document.getElementById("class").options];
        set("#class", options.at(-1).value);
        const few = all("[data-query]").length;
        if (!few || (options.length > 2 && few >= total)) return `${few} of ${total} by class`;
        set("#class", "");
        set("#name", all("[data-query] .one-line")[0].textContent);
        if (!all("[data-query]").length || all("[data-query]").length >= total) return "not filtered by name";
        set("#name", "");
        set("#order", "worst");
        const precisions = all("[data-query]").map((one) => Number(one.textContent.match(/AP ([\\d.]+)/)[1]));
        if (!sorted(precisions, 1)) return "not the worst first";
        set("#order", "");""",
    "a click shows the neighbours of a query": """
        if (!document.getElementById("gallery")) return;
        all("[data-query]")[0].click();
        const cards = shown("#hits .row > .model");
        if (cards.length < 2) return `${cards.length} cards`;
        if (!cards[1].classList.contains("relevant") && !cards[1].classList.contains("wrong")) return "a neighbour is neither right nor wrong";
        if (!/1\\. [\\d.e-]+/.test(cards[1].textContent)) return `no distance: ${cards[1].textContent}`;
        const parts = cards[1].textContent.match(/([\\d.]+) \\+ ([\\d.]+) \\+ ([\\d.]+)/);
        if (all(".parts i", cards[1]).length !== 3 || !parts) return "the three views are not told";
        if (!/symmetry/.test(cards[1].textContent)) return "the symmetry is not told";
        const before = document.querySelector("#hits h3").textContent;
        const next = shown("#hits button.model").find((one) => !before.startsWith(one.title.split("\\n")[0]));
        next?.click();
        if (next && document.querySelector("#hits h3").textContent === before) return "a neighbour does not become the query";""",
    "failures are filtered": """
        const input = document.querySelector("[data-filters=failures]");
        if (!input) return;
        const first = document.querySelector("#failures tbody th").textContent;
        set("[data-filters=failures]", first);
        if (!shown("#failures tbody tr").length) return "a name finds nothing";
        set("[data-filters=failures]", "\\u0000");
        if (shown("#failures tbody tr").length) return "nonsense finds something";
        set("[data-filters=failures]", "");""",
    "light and dark": """
        const colour = () => getComputedStyle(document.body).backgroundColor;
        const before = colour();
        document.getElementById("theme").click();
        if (colour() === before) return `both ${before}`;
        document.getElementById("theme").click();
        if (colour() !== before) return "not back";""",
}
PICTURES = """
const done = arguments[arguments.length - 1];
const pictures = [...document.images];
pictures.forEach((one) => { one.loading = "eager"; });
Promise.all(pictures.map((one) => one.decode().then(() => null, () => one.alt))).then((bad) =>
  done({ pictures: pictures.length, bad: bad.filter(Boolean), flat: pictures.filter((one) => one.naturalWidth < 8).length }));
"""
WIDE = """
const room = document.documentElement.clientWidth;
const inside = (one) => one.closest(".scroll, pre, #queries, .one-line, #tip");
const wide = [...document.querySelectorAll("body *")].filter((one) => one.getBoundingClientRect().right > room + 1 && !inside(one));
return [document.documentElement.scrollWidth, room, wide.slice(0, 5).map((one) => `${one.tagName} ${one.id} ${one.className}`)];
"""


def check(session, page):
    """What is wrong with the page."""
    session.resize(1280, 900)
    session.open(page.as_uri())
    wrong = [f"console: {message}" for message in session.errors()]
    for name, script in CHECKS.items():
        try:
            answer = session.run(f"{HELPERS}\n{script}")
        except RuntimeError as error:
            answer = error
        if answer:
            wrong.append(f"{name}: {answer}")
    seen = session.post("/execute/async", script=PICTURES, args=[])
    if seen["bad"] or seen["flat"]:
        wrong.append(f"{len(seen['bad'])} broken and {seen['flat']} empty of {seen['pictures']} pictures")
    if session.run("return Boolean(document.getElementById('gallery'))") and not seen["pictures"]:
        wrong.append("a gallery without pictures")
    session.resize(360, 740, touch=True)
    session.open(page.as_uri())
    session.run("document.querySelector('[data-query]')?.click()")
    width, room, wide = session.run(WIDE)
    if width > room or wide:
        wrong.append(f"a telephone of {room} px sees {width}: {wide}")
    wrong += [f"console: {message}" for message in session.errors()]
    return wrong, seen["pictures"]


def shots(session, page, folder):
    """Pictures to look at: the top, a query, a telephone, in the dark, and printed."""
    folder.mkdir(parents=True, exist_ok=True)
    query = "document.querySelectorAll('[data-query]')[arguments[0]]?.click(); document.getElementById('hits')?.scrollIntoView({block: 'center'})"
    session.resize(1280, 1000)
    session.open(page.as_uri())
    session.shot(folder / "top.png")
    session.run("document.getElementById('classes').scrollIntoView()")
    session.shot(folder / "classes.png")
    session.run("document.getElementById('confusion').scrollIntoView()")
    session.shot(folder / "confusion.png")
    session.run(query, 3)
    session.shot(folder / "query.png")
    session.printed(folder / "printed.pdf")
    session.run("document.getElementById('theme').click()")
    session.shot(folder / "query-dark.png")
    session.run("scrollTo(0, 0)")
    session.shot(folder / "top-dark.png")
    session.resize(360, 740, touch=True)
    session.open(page.as_uri())
    session.shot(folder / "telephone.png")
    session.run("document.getElementById('measures').scrollIntoView()")
    session.shot(folder / "telephone-measures.png")
    session.run(query, 3)
    session.shot(folder / "telephone-query.png")


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("report", type=pathlib.Path)
    arguments.add_argument("--shots", type=pathlib.Path, metavar="DIR", help="write pictures of the page into this folder")
    args = arguments.parse_args()
    if not shutil.which("chromium") or not shutil.which("chromedriver"):
        print("skipped: there is no chromium with its chromedriver")
        return 77
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # so that the browser ends too
    page = args.report.resolve(strict=True)
    try:
        with browser() as session:
            wrong, pictures = check(session, page)
            if args.shots:
                shots(session, page, args.shots)
    except NoSession as error:
        print(f"skipped: Chromium does not start: {error}")
        return 77
    for text in wrong:
        print(f"{args.report}: {text}")
    if not wrong:
        print(f"{args.report}: {len(CHECKS) + 3} checks in Chromium, {pictures} pictures, no error")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
