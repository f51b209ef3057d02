"""Headless Chromium, as the tests of report pages use it."""

import base64
import contextlib
import io
import json
import shutil
import sys
import tempfile
import time

SKIPPED = 77

try:
    from PIL import Image
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
except ImportError:
    webdriver = None

WEBGL = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist")
NO_WEBGL = ("--disable-gpu", "--disable-3d-apis")
CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")


def require():
    """Ends the test program as skipped where there is no browser to drive."""
    if webdriver is None or not CHROMIUM or not DRIVER:
        print("skipped: needs chromium, chromium-driver, python3-selenium and python3-pil")
        sys.exit(SKIPPED)


class Browser:
    """One window on one page. WebGL is drawn by the processor, so that it works anywhere, and takes
    seconds a page: without it the viewer says that it is missing."""

    def __init__(self, width=1280, height=1700, webgl=True):
        self.profile = tempfile.mkdtemp(prefix="adaptiso-chromium-")
        options = Options()
        for argument in ("--headless=new", "--no-sandbox", "--no-first-run", "--disable-quic",
                         "--disable-background-networking", "--disable-component-update",
                         "--disable-sync", "--hide-scrollbars", "--force-device-scale-factor=1",
                         f"--user-data-dir={self.profile}", f"--window-size={width},{height}",
                         *(WEBGL if webgl else NO_WEBGL)):
            options.add_argument(argument)
        options.binary_location = CHROMIUM
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        self.driver = webdriver.Chrome(options=options, service=Service(DRIVER))
        self.driver.set_script_timeout(240)
        self.driver.set_page_load_timeout(240)

    def close(self):
        self.driver.quit()
        shutil.rmtree(self.profile, ignore_errors=True)

    def open(self, path):
        """Opens a file from disk and waits for its viewer: "ready", "missing", or None."""
        self.driver.get(path.as_uri())
        end = time.monotonic() + 240
        while time.monotonic() < end:
            state = self.run("return document.body.dataset.viewer || null")
            if state or not self.find("#viewer"):
                return state
            time.sleep(0.2)
        raise TimeoutError("the viewer is neither ready nor missing after 240 s")

    def resize(self, width, height=1200):
        """The page's own width; windows of Chromium are never as narrow as a phone."""
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600})

    @contextlib.contextmanager
    def dark(self):
        """The page as a system in dark colours shows it."""
        def prefer(scheme):
            self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {
                "features": [{"name": "prefers-color-scheme", "value": scheme}]})
        prefer("dark")
        try:
            yield
        finally:
            prefer("")

    def violations(self, axe):
        """What axe-core (its script) finds wrong: rule and the first element, for each."""
        self.run(axe)
        return self.driver.execute_async_script("""
            const done = arguments[0];
            axe.run(document, { resultTypes: ["violations"] }).then((result) => done(
                result.violations.map((v) => `${v.id}: ${v.nodes[0].html.slice(0, 200)}`)));""")

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def find(self, selector):
        return self.driver.find_elements("css selector", selector)

    def crosshair(self):
        return self.run("return adaptisoViewer.crosshair()")

    def console(self):
        """What was written to the console since the last time."""
        return [entry["message"] for entry in self.driver.get_log("browser")]

    def requests(self):
        """Addresses that the page asked for, but for what it holds itself."""
        messages = [json.loads(entry["message"])["message"]
                    for entry in self.driver.get_log("performance")]
        asked = [m["params"]["request"]["url"] for m in messages
                 if m["method"] == "Network.requestWillBeSent"]
        # Chromium's own first page is made of chrome: addresses
        return [url for url in asked if not url.startswith(("data:", "blob:", "chrome:"))]

    def screenshot(self, selector):
        """PNG bytes of the element, as it is seen."""
        self.run("document.querySelector(arguments[0]).scrollIntoView()", selector)
        return base64.b64decode(self.find(selector)[0].screenshot_as_base64)


def grey(png, columns, rows):
    """Means (0 to 255) of columns x rows equal parts of a picture, row by row."""
    picture = Image.open(io.BytesIO(png)).convert("RGB").resize((columns, rows), Image.BOX)
    return [sum(pixel) / 3 for pixel in picture.getdata()]
