(() => {
  const { View, controls, word, words, plain, secs, seconds } = player;
  const data = JSON.parse(document.getElementById("data").textContent);
  const at = (id) => document.getElementById(id);
  const run = data.run, view = new View(at("map"), data.place);
  let focused = data.focus[2] < data.place.whole[2] - 1 || data.focus[3] < data.place.whole[3] - 1;
  at("zoom").hidden = !focused;

  const { clock, go, until } = controls((now) => {
    view.show(now);
    const past = story.filter(([t]) => t <= now + 0.05 && now - t < 2.5), newest = past[past.length - 1];
    at("caption").textContent = newest ? newest[2] : "";
    for (const [t, item] of story) item.className = t <= now + 0.05 ? "" : "later";
  });
  function lay() {
    at("zoom").textContent = focused ? "whole map" : "where it happens";
    view.lay(focused ? data.focus : data.place.whole); view.show(clock.now);
  }
  const story = data.story.map(([t, text]) => {
    const item = word("li", "", at("story")), button = word("button", secs(t), item);
    button.type = "button"; button.addEventListener("click", () => go(t));
    words("span", text, item);
    return [t, item, text];
  });
  for (const figure of data.key) {
    const row = word("tr", "", at("top").tBodies[0]);
    word("th", plain(figure.name), row).scope = "row";
    word("td", figure.value, row, "n"); word("td", figure.note || figure.better, row, "quiet");
  }
  const table = at("metrics"), head = word("tr", "", word("thead", "", table)), body = word("tbody", "", table);
  for (const name of ["metric", "value", "note"]) word("th", name, head).scope = "col";
  for (const figure of data.all) {
    const row = word("tr", "", body);
    word("th", plain(figure.name), row).scope = "row";
    word("td", figure.value, row); word("td", figure.note || figure.better, row, "quiet");
  }
  for (const line of data.told) words("li", line, at("told"));
  at("doubts").hidden = !data.told.length;
  at("thresholds").textContent = data.thresholds;

  view.load(run);
  until(seconds(run));
  at("length").textContent = secs(clock.end);
  at("people").textContent = String(run.agents.filter((agent) => agent.number !== 0).length);
  at("zoom").addEventListener("click", () => { focused = !focused; lay(); });
  at("time").style.width = "100%";
  addEventListener("resize", lay);
  lay(); clock.set(0);
  if (!matchMedia("(prefers-reduced-motion: reduce)").matches) clock.play(true);
})();
