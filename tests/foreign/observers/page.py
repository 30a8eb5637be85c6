"""The page for observers in Chromium, answered as an observer would, driven by playwright; prints one JSON line with what was seen there.

    python3 page.py CHROMIUM FOLDER WIDTHxHEIGHT ADDRESS

The time of the page is wound on, so that films end. Pictures go to FOLDER, and the table as observer-SIZE.csv.
"""

import pathlib, sys  # noqa: E401

sys.dont_write_bytecode = True
sys.path.append(str(pathlib.Path(__file__).parent.parent))
from browser import play  # noqa: E402

chromium, folder, size, address = sys.argv[1:5]
CUT = "button, h1, h2, input, figure, .ends span"
MOVE = "(n, to) => { n.value = to; n.dispatchEvent(new Event('input')); }"


def main(visit):
    page, found, moment = visit.page, visit.found, visit.moment
    page.clock.install()
    page.goto(address)
    found["unnamed"] = page.is_disabled("#play")
    page.fill("#rater", "Ann, O")
    page.dispatch_event("#rater", "change")
    seen, gated, open_early = set(), [], []
    while page.is_visible("#stage"):
        kind = "belief" if page.query_selector("#belief") else "pair" if page.query_selector(".choices") else "rate"
        page.click("#play")
        page.clock.run_for(2000)
        gated.append(page.is_disabled("#next"))
        if kind == "belief":
            page.query_selector("#belief").evaluate(MOVE, 90)
        elif kind == "rate":
            open_early.append(not page.is_disabled("#rate"))
        if kind not in seen:
            moment(kind)
        page.clock.run_for(120000)
        if kind == "rate":
            gated.append(page.is_disabled("#next"))
            page.query_selector("#rate").evaluate(MOVE, 20 + 15 * (len(gated) % 5))
        elif kind == "pair":
            gated.append(page.is_disabled("#next"))
            page.click(".choices [data-answer=left]")
        if kind not in seen:
            moment(kind + "-answered")
        seen.add(kind)
        page.click("#next")
    moment("end")
    found.update(kinds=sorted(seen), gated=all(gated), early=any(open_early), progress=page.inner_text("#progress"))
    (pathlib.Path(folder) / f"observer-{size}.csv").write_text(page.evaluate("observed()"))


play(main, chromium, folder, size, address, CUT)
