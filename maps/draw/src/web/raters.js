// For pages that people answer on: the name of whoever answers, what they said, an order of their own, and the table that they save.
const raters = (() => {
  const has = (object, key) => Object.prototype.hasOwnProperty.call(object, key);
  // Nothing in a name that would need quotes in a table.
  const clean = (name) => name.replace(/[",;\r\n\t]/g, " ").replace(/^[=+@-]+/, "").replace(/\s+/g, " ").trim();
  // Answers by rater, and whoever answered last. A browser that keeps nothing still answers; the table can be saved all the same.
  function kept(key) {
    let found = {};
    try { found = JSON.parse(localStorage.getItem(key)) || {}; } catch { found = {}; }
    if (typeof found !== "object" || Array.isArray(found)) found = {};
    const answers = found.answers && typeof found.answers === "object" ? found.answers : {};
    return {
      rater: typeof found.rater === "string" ? found.rater : "",
      of: (rater) => (has(answers, rater) ? answers[rater] : {}),
      own: (rater) => { if (!has(answers, rater)) answers[rater] = {}; return answers[rater]; },
      keep: (rater) => { try { localStorage.setItem(key, JSON.stringify({ rater, answers })); } catch { /* nothing is kept */ } },
    };
  }
  // Orders lists by a text alone: the same text, the same orders.
  function shuffler(text) {
    let state = 2166136261;
    for (const c of text) state = Math.imul(state ^ c.codePointAt(0), 16777619) >>> 0;
    const draw = () => { state = (Math.imul(state, 1664525) + 1013904223) >>> 0; return state / 4294967296; };
    return (list) => {
      const all = [...list];
      for (let i = all.length - 1; i > 0; i--) { const j = Math.floor(draw() * (i + 1)); [all[i], all[j]] = [all[j], all[i]]; }
      return all;
    };
  }
  // A field for a remark in free words; `heard` gets them while they are typed.
  function remark(box, words, heard) {
    const part = player.word("label", "comment, if you like ", box, "remark"), field = document.createElement("textarea");
    field.rows = 2; field.maxLength = 500; field.value = words; part.appendChild(field);
    field.addEventListener("input", () => heard(field.value.replace(/\s+/g, " ").trim()));
  }
  // Cells of a table; a program that computes with tables must not take words for a formula.
  const cell = (text) => (/[",\r\n]/.test(text) ? '"' + text.replace(/"/g, '""') + '"' : text);
  const row = (cells) => cells.map((text) => cell(String(text))).join(",");
  const plain = (text) => text.replace(/^[=+@-]+\s*/, "");
  function save(table, of, rater) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([table], { type: "text/csv" }));
    link.download = of + "-" + (rater.replace(/[^\w-]+/g, "_") || "nobody") + ".csv";
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }
  return { has, clean, kept, shuffler, remark, row, plain, save };
})();
