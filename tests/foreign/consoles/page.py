"""The page of the author console in Chromium, driven by playwright; prints one JSON line with what was seen there.

    python3 page.py CHROMIUM FOLDER WIDTHxHEIGHT ADDRESS

Two questions wait: the first gets a faulty and then a good answer, the second a refusal. Pictures go to FOLDER.
"""

import pathlib, sys  # noqa: E401

sys.dont_write_bytecode = True
sys.path.append(str(pathlib.Path(__file__).parent.parent))
from browser import play  # noqa: E402

chromium, folder, size, address = sys.argv[1:5]
CUT = "button, h1, h2, textarea, input, img, pre"
FAULTY = '{"title": "Ann", "human_1": {"start": "r1", "pace_mps": 9}}'


def main(visit):
    page, found, until, moment = visit.page, visit.found, visit.until, visit.moment
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


# An answer with faults is answered with a status of its own.
play(main, chromium, folder, size, address, CUT, meant="422")
