"""The page of the author console in Chromium, driven by playwright; prints one JSON line with what was seen there.

    python3 page.py CHROMIUM FOLDER WIDTHxHEIGHT ADDRESS

Two questions wait: the first gets a faulty and then a good answer, the second a refusal. Pictures go to FOLDER.
"""

import json, pathlib, sys  # noqa: E401

from playwright.sync_api import sync_playwright

# Longest time to wait for anything; a guard, never a measure.
GUARD_MS = 120_000
chromium, folder, size, address = sys.argv[1:5]
width, height = map(int, size.split("x"))
found = {"console": [], "policy": [], "strangers": []}

PROBE = """() => ({ wide: document.documentElement.scrollWidth, inner: innerWidth,
  cut: [...document.querySelectorAll("button, h1, h2, textarea, input, img, pre")].filter((n) => n.offsetParent && (n.getBoundingClientRect().right > innerWidth + 1 || n.getBoundingClientRect().left < -1)).map((n) => n.id || n.textContent.slice(0, 20)),
  odd: (document.body.innerText.match(/.{0,30}(undefined|NaN|\\[object).{0,10}/g) || []) })"""
FAULTY = '{"title": "Ann", "human_1": {"start": "r1", "pace_mps": 9}}'


def main(page):
    def until(script, arg=None):
        page.wait_for_function(script, arg=arg, timeout=GUARD_MS)

    def moment(name):
        page.screenshot(path=str(pathlib.Path(folder) / f"{size}-{name}.png"))
        found[name] = page.evaluate(PROBE)

    page.goto(address)
    until("() => document.querySelectorAll('#turns .turn').length === 2")
    found["waiting"] = page.evaluate("document.querySelectorAll('#waiting li').length")
    until("() => document.querySelector('#turns img').naturalWidth > 0")
    found["picture"] = True
    found["markup"] = page.evaluate("document.querySelectorAll('#turns b').length")
    found["code"] = page.evaluate("document.querySelector('#turns p code').textContent")
    moment("first")
    page.click("#fill")
    found["order"] = page.evaluate("Object.keys(JSON.parse(document.getElementById('text').value))")
    page.fill("#text", FAULTY)
    until("() => document.querySelectorAll('#faults li').length > 0")
    page.click("#send")
    until("() => !document.getElementById('anyway').hidden")
    found["faults"] = page.evaluate("[...document.querySelectorAll('#faults li')].map((n) => n.textContent)")
    moment("faulty")
    page.reload()
    until("() => document.getElementById('text').value !== ''")
    found["kept"] = page.evaluate("document.getElementById('text').value")
    page.click("#tab-form")
    moment("form")
    page.click("#tab-answer")
    page.fill("#text", "Here it is: " + FAULTY.replace("9", "1"))
    until("() => !document.getElementById('strip').hidden")
    page.click("#strip")
    until("() => document.getElementById('check').className === 'good'")
    found["good"] = True
    page.keyboard.press("Control+Enter")
    until("() => document.getElementById('title').textContent.startsWith('Question 2')")
    page.click("#cannot")
    page.fill("#why", "two things exclude each other")
    page.click("#refuse")
    until("() => document.querySelectorAll('#waiting li').length === 0")
    page.click("#done li:last-child button")
    until("() => document.getElementById('title').textContent.startsWith('Question 1')")
    found["answered"] = page.evaluate("document.getElementById('text').readOnly && document.getElementById('text').value.includes('Ann')")
    moment("last")


with sync_playwright() as playwright:
    browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox", "--disable-gpu"])
    context = browser.new_context(viewport={"width": width, "height": height}, device_scale_factor=1)
    context.add_init_script("""window.__policy = []; addEventListener("securitypolicyviolation", (e) => window.__policy.push(e.violatedDirective + " " + e.blockedURI));""")
    page = context.new_page()
    page.on("dialog", lambda dialog: dialog.accept())
    # An answer with faults is answered with a status of its own.
    page.on("console", lambda said: said.type in ("error", "warning") and "422" not in said.text and found["console"].append(said.text[:200]))
    page.on("pageerror", lambda error: found["console"].append("page: " + str(error)[:200]))
    own = address.split("/")[2]
    page.on("request", lambda request: request.url.split("/")[2:3] != [own] and not request.url.startswith("data:") and found["strangers"].append(request.url[:80]))
    failed = None
    try:
        main(page)
        found["policy"] = page.evaluate("window.__policy")
    except Exception as why:  # noqa: BLE001
        failed = f"{type(why).__name__}: {why}"[:600]
        page.screenshot(path=str(pathlib.Path(folder) / f"{size}-failed.png"))
    browser.close()
print(json.dumps({"failed": failed, **found}))
sys.exit(1 if failed else 0)
