// The list of runs: live ones first, asked for again while the page can be seen.
import { NO_TOKEN, at, plain, runUrl, runs, say, secs, word } from "./words.js";

const EVERY_MS = 2000;
const STATES = { live: ["● live", 0], ended: ["ended", 1], kept: ["kept", 2] };
const sign = (verdict) => (!verdict ? ["", "verdict"] : verdict.startsWith("realised") ? ["✔ ", "verdict good"] : ["✘ ", "verdict bad"]);

const order = (run) => (STATES[run.state] || ["", 3])[1];

function fill(all) {
  const body = at("runs").tBodies[0], rows = new Map([...body.rows].map((row) => [row.dataset.run, row]));
  all.forEach((run, i) => {
    let row = rows.get(run.run);
    if (!row) {
      row = word("tr", "");
      row.dataset.run = run.run;
      const link = word("a", "", word("td", "", row));
      link.href = runUrl(run.run).href;
      // A name may be broken after its dots, as on a phone, and nowhere else.
      run.run.split(/(?<=\.)/).forEach((part) => link.append(part, document.createElement("wbr")));
      word("span", "", word("td", "", row), "badge");
      for (const look of ["", "", "n", "n", "n", ""]) word("td", "", row, look);
    }
    rows.delete(run.run);
    if (body.rows[i] !== row) body.insertBefore(row, body.rows[i] || null);
    const cells = row.cells, state = cells[1].firstChild, [mark, look] = sign(run.verdict);
    state.className = "badge" + (run.state === "live" ? " live" : "");
    say(state, run.state === "live" ? "LIVE" : (STATES[run.state] || [plain(run.state)])[0]);
    [run.location, run.planner, run.seed, run.time_s === null ? "–" : secs(run.time_s), run.agents].forEach((text, k) => say(cells[k + 2], plain(text ?? "–")));
    cells[7].className = look;
    say(cells[7], run.verdict ? mark + plain(run.verdict) : "–");
  });
  for (const row of rows.values()) row.remove();
}

/** Shows the list. With `open` the only live run is opened by itself, also one that begins later. */
export function showList(open) {
  at("list-page").hidden = false;
  document.title = "Runs · SocRATES";
  let pause = 0;
  const ask = async () => {
    clearTimeout(pause);
    if (document.hidden) return;
    try {
      const all = (await runs()).sort((a, b) => order(a) - order(b) || a.run.localeCompare(b.run, "en", { numeric: true }));
      const live = all.filter((run) => run.state === "live");
      // Replaced, not added: the way back from the run must not open it again.
      if (open && live.length === 1) { location.replace(runUrl(live[0].run)); return; }
      fill(all);
      at("list-section").hidden = all.length === 0;
      at("list-state").className = "quiet";
      say(at("list-state"), all.length === 0 ? "There is no run yet. One that begins is shown here." : `${live.length || "none"} live, ${all.length} in all`);
    } catch (fault) {
      at("list-state").className = "bad";
      say(at("list-state"), fault.status === 401 ? NO_TOKEN : "⚠ The gateway does not answer. The page keeps what it has and asks again every 2 s.");
    }
    pause = setTimeout(ask, EVERY_MS);
  };
  document.addEventListener("visibilitychange", ask);
  ask();
}
