"""The survey page in Chromium, answered as a participant would, driven by playwright; prints one JSON line with what was seen there.

    python3 page.py CHROMIUM FOLDER WIDTHxHEIGHT ADDRESS FILMS

Watches and answers so many films, leaves questions of the first one open at first, and goes to the end where no film is left. Pictures go to FOLDER.
"""

import pathlib, sys  # noqa: E401

sys.dont_write_bytecode = True
sys.path.append(str(pathlib.Path(__file__).parent.parent))
from browser import play  # noqa: E402

chromium, folder, size, address, films = sys.argv[1:6]
CUT = "button, h1, input, fieldset, .asked, figure, .points label"


def main(visit):
    page, found, until, moment = visit.page, visit.found, visit.until, visit.moment
    page.goto(address)
    moment("consent")
    page.click("#agree")
    page.wait_for_selector("#start")
    moment("shapes")
    page.click("#start")
    found["steps"], found["gated"] = [], []
    for number in range(int(films)):
        page.wait_for_selector("#play")
        found["steps"].append(page.inner_text("#step"))
        found["gated"].append(page.is_disabled("#questions"))
        page.click("#play")
        until("() => parseFloat(document.querySelector('.played i').style.width) > 30")
        found["gated"].append(page.is_disabled("#questions"))
        if number == 0:
            moment("film")
        until("() => !document.getElementById('questions').disabled")
        page.click("#questions")
        page.wait_for_selector("#send")
        if number == 0:
            page.click("#send")
            page.wait_for_selector(".moves + .bad")
            moment("open")
            found["reminder"] = page.inner_text(".moves + .bad")
        for field in page.query_selector_all("fieldset"):
            radios = field.query_selector_all("input[type=radio]")
            if radios:
                radios[3].check()
            else:
                field.query_selector("input[type=range]").evaluate("(n) => { n.value = 70; n.dispatchEvent(new Event('input')); }")
        found["send"] = page.inner_text("#send")
        if number == 0:
            moment("answered")
        page.click("#send")
    until("() => document.getElementById('play') || document.getElementById('code')")
    found["code"] = page.inner_text("#code") if page.query_selector("#code") else ""
    moment("last")


play(main, chromium, folder, size, address, CUT)
