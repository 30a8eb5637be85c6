"use strict";
// The survey for jsPsych 8. Its CSV has a line for each set of questions, with film, place and seen seconds; answers count from 0.
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const query = new URLSearchParams(location.search);
  const jsPsych = initJsPsych({
    on_finish: () => {
      const csv = jsPsych.data.get().csv();
      // A server that takes answers is named by whoever serves this page: ?post=/save. Otherwise the file is saved here.
      const to = query.get("post");
      if (to && to.startsWith("/") && !to.startsWith("//")) { fetch(to, { method: "POST", headers: { "Content-Type": "text/csv" }, body: csv }); return; }
      jsPsych.data.get().localSave("csv", "answers.csv");
    },
  });
  const safe = (text) => { const node = document.createElement("p"); node.textContent = text; return node.innerHTML; };
  const paragraphs = (text) => text.split(/\n\s*\n/).map((part) => `<p style="max-width:44em;text-align:left">${safe(part)}</p>`).join("");
  const person = query.get("PROLIFIC_PID") || query.get("participant") || jsPsych.randomization.randomID(12);
  const order = data.orders.find((one) => one.name === query.get("order")) || jsPsych.randomization.sampleWithoutReplacement(data.orders, 1)[0];
  jsPsych.data.addProperties({ PROLIFIC_PID: person, order: order.name });
  const steps = [{ type: jsPsychHtmlButtonResponse, stimulus: data.consent.map(paragraphs).join("") + "<p>If you do not agree, please close this page.</p>", choices: ["I agree and take part"], data: { film: "" } }];
  if (data.instructions) steps.push({ type: jsPsychHtmlButtonResponse, stimulus: paragraphs(data.instructions), choices: ["Continue"], data: { film: "" } });
  const likert = (block, items, more) => ({
    type: jsPsychSurveyLikert, preamble: safe(block.stem), button_label: "Continue", data: more,
    questions: items.map(([code, text]) => ({ name: code, prompt: safe(text), labels: block.points.map(([, words]) => safe(String(words))) })),
  });
  order.films.forEach((film, index) => {
    let watched = 0;
    steps.push({
      type: jsPsychHtmlButtonResponse, choices: ["Continue to the questions"], data: { film }, enable_button_after: 0,
      stimulus: `<p style="max-width:44em">${safe(data.contexts[film] || "")}</p><video id="shown" src="../clips/${film}.mp4" controls playsinline muted style="max-width:96vw;max-height:65vh"></video>`,
      on_load: () => {
        const shown = document.getElementById("shown"), go = document.querySelector("#jspsych-html-button-response-btngroup button");
        go.disabled = true;
        let far = 0;
        shown.addEventListener("timeupdate", () => { if (shown.currentTime - far < 1.5) far = Math.max(far, shown.currentTime); else shown.currentTime = far; });
        shown.addEventListener("ended", () => { watched = Math.round(shown.duration * 10) / 10; go.disabled = false; });
      },
    });
    for (const block of data.blocks) {
      const more = { film, position: index + 1 }, seen = (of) => { of.watched_s = watched; };
      if (block.points.length) steps.push({ ...likert(block, block.items, more), on_finish: seen });
      else for (const [code, text] of block.items) steps.push({
        type: jsPsychHtmlSliderResponse, stimulus: `<p>${safe(block.stem)}</p><p>${safe(text)}</p>`, labels: block.anchors.map(([, words]) => safe(words)),
        min: block.range[0], max: block.range[1], require_movement: true, button_label: "Continue", data: { ...more, item: code }, on_finish: seen,
      });
    }
    for (const check of data.checks.filter((one) => one.position === index + 1)) {
      const block = data.blocks.find((one) => one.id === check.block);
      steps.push(likert(block, [[check.name, check.text]], { film: "", check: check.name }));
    }
  });
  steps.push({ type: jsPsychHtmlButtonResponse, stimulus: "<p>Thank you.</p>", choices: ["Finish"], data: { film: "" } });
  jsPsych.run(steps);
})();
