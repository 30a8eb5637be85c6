"""A page in Chromium, driven by playwright, for the scripts of the folders beside this file: what it says, what it asks of others, what it looks like."""

import json, pathlib, sys  # noqa: E401

from playwright.sync_api import sync_playwright

# Longest time to wait for anything; a guard, never a measure.
GUARD_MS = 120_000

# What of a page is cut off, and what in it was never meant to be read; CUT names the elements that are looked at.
PROBE = """() => ({ wide: document.documentElement.scrollWidth, inner: innerWidth, tall: document.documentElement.scrollHeight, high: innerHeight,
  cut: [...document.querySelectorAll("CUT")].filter((n) => n.offsetParent && (n.getBoundingClientRect().right > innerWidth + 1 || n.getBoundingClientRect().left < -1)).map((n) => n.id || n.textContent.slice(0, 20)),
  odd: (document.body.innerText.match(/.{0,30}(undefined|NaN|\\[object).{0,10}/g) || []) })"""


class Visit:
    """One visit: `until` waits for something of the page, `moment` takes a picture of it and keeps what is cut off under a name."""

    def __init__(self, page, folder, size, cut):
        self.page, self.folder, self.size, self.cut = page, pathlib.Path(folder), size, cut
        self.found = {"console": [], "policy": [], "strangers": []}

    def until(self, script, arg=None):
        self.page.wait_for_function(script, arg=arg, timeout=GUARD_MS)

    def moment(self, name):
        self.page.screenshot(path=str(self.folder / f"{self.size}-{name}.png"))
        self.found[name] = self.page.evaluate(PROBE.replace("CUT", self.cut))


def play(main, chromium, folder, size, address, cut, meant=None):
    """Opens a browser, lets `main` visit the page, prints a JSON line with what was found, and ends the process. Lines of the console with `meant` in
    them are no fault."""
    width, height = map(int, size.split("x"))
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox", "--disable-gpu"])
        context = browser.new_context(viewport={"width": width, "height": height}, device_scale_factor=1)
        context.add_init_script("""window.__policy = []; addEventListener("securitypolicyviolation", (e) => window.__policy.push(e.violatedDirective + " " + e.blockedURI));""")
        page = context.new_page()
        page.set_default_timeout(GUARD_MS)
        visit = Visit(page, folder, size, cut)
        found, own = visit.found, address.split("/")[2]
        page.on("dialog", lambda dialog: dialog.accept())
        page.on("console", lambda said: said.type in ("error", "warning") and not (meant and meant in said.text) and found["console"].append(said.text[:200]))
        page.on("pageerror", lambda error: found["console"].append("page: " + str(error)[:200]))
        page.on("request", lambda request: request.url.split("/")[2:3] != [own] and not request.url.startswith("data:") and found["strangers"].append(request.url[:80]))
        failed = None
        try:
            main(visit)
            found["policy"] = page.evaluate("window.__policy")
        except Exception as why:  # noqa: BLE001
            failed = f"{type(why).__name__}: {why}"[:600]
            page.screenshot(path=str(visit.folder / f"{size}-failed.png"))
        browser.close()
    print(json.dumps({"failed": failed, **found}))
    sys.exit(1 if failed else 0)
