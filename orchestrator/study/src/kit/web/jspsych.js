// The survey for jsPsych 8. Its CSV has a line for each set of questions, with film, place and seen seconds; answers count from 0.
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const query = new URLSearchParams(location.search);
  const told = (text) => { const node = document.createElement("p"); node.textContent = text; node.setAttribute("role", "alert"); node.style = "margin:3em auto;max-width:44em;padding:0 1em;font-family:sans-serif"; document.body.replaceChildren(node); };
  if (["initJsPsych", "jsPsychHtmlButtonResponse", "jsPsychSurveyLikert", "jsPsychHtmlSliderResponse"].some((part) => !globalThis[part])) {
    told("This survey could not be loaded. Please look whether you are connected, and load the page again.");
    return;
  }
  const jsPsych = initJsPsych({
    on_finish: async () => {
      const csv = jsPsych.data.get().csv();
      // A server that takes answers is named by whoever serves this page: ?post=/save. Otherwise, and where it does not take them, the file is
      // saved here.
      const to = query.get("post");
      if (to && to.startsWith("/") && !to.startsWith("//")) {
        told("One moment: your answers are on their way.");
        const taken = await fetch(to, { method: "POST", headers: { "Content-Type": "text/csv" }, body: csv }).then((answer) => answer.ok, () => false);
        if (taken) { told("Your answers have arrived. You can close this page."); return; }
      }
      jsPsych.data.get().localSave("csv", "answers.csv");
      told("Your answers were saved as the file answers.csv. Please send it to whoever invited you.");
    },
  });
  const safe = (text) => { const node = document.createElement("p"); node.textContent = text; return node.innerHTML; };
  const paragraphs = (text) => text.split(/\n\s*\n/).map((part) => `<p style="max-width:44em;text-align:left">${safe(part)}</p>`).join("");
  const person = query.get("PROLIFIC_PID") || query.get("participant") || jsPsych.randomization.randomID(12);
  const order = data.orders.find((one) => one.name === query.get("order")) || jsPsych.randomization.sampleWithoutReplacement(data.orders, 1)[0];
  jsPsych.data.addProperties({ PROLIFIC_PID: person, order: order.name });
  const steps = [{ type: jsPsychHtmlButtonResponse, stimulus: data.consent.map(paragraphs).join("") + "<p>If you do not agree, please close this page.</p>", choices: ["I agree and take part"], data: { film: "" } }];
  const seen = [`You will watch ${order.films.length} short films of robots that move among people. ${data.about}`, ...data.shapes.map(([, words]) => words)];
  steps.push({ type: jsPsychHtmlButtonResponse, stimulus: seen.map(paragraphs).join(""), choices: ["Continue"], data: { film: "" } });
  if (data.instructions) steps.push({ type: jsPsychHtmlButtonResponse, stimulus: paragraphs(data.instructions), choices: ["Continue"], data: { film: "" } });
  const likert = (block, items, more) => ({
    type: jsPsychSurveyLikert, preamble: safe(block.stem), button_label: "Continue", data: more,
    questions: items.map(([code, text]) => ({ name: code, prompt: safe(text), labels: block.points.map(([, words]) => safe(String(words))) })),
  });
  order.films.forEach((film, index) => {
    let watched = 0;
    steps.push({
      type: jsPsychHtmlButtonResponse, choices: ["Continue to the questions"], data: { film },
      stimulus: `<p style="max-width:44em">${safe(data.contexts[film] || "")}</p><video id="shown" src="../clips/${film}.mp4" controls controlslist="nodownload noplaybackrate" disablepictureinpicture playsinline muted preload="auto" style="max-width:96vw;max-height:65vh"></video><p id="lost" role="alert" hidden>The film could not be loaded. <button class="jspsych-btn" type="button">Try again</button></p>`,
      on_load: () => {
        const shown = document.getElementById("shown"), go = document.querySelector("#jspsych-html-button-response-btngroup button"), lost = document.getElementById("lost");
        go.disabled = true;
        gate(shown, (seconds) => { watched = seconds; go.disabled = false; });
        shown.addEventListener("error", () => { lost.hidden = false; });
        lost.querySelector("button").addEventListener("click", () => { lost.hidden = true; shown.load(); });
      },
    });
    for (const block of data.blocks) {
      const more = { film, position: index + 1 }, note = (of) => { of.watched_s = watched; };
      if (block.points.length) steps.push({ ...likert(block, block.items, more), on_finish: note });
      else for (const [code, text] of block.items) steps.push({
        type: jsPsychHtmlSliderResponse, stimulus: `<p>${safe(block.stem)}</p><p>${safe(text)}</p>`, labels: block.anchors.map(([, words]) => safe(words)),
        min: block.range[0], max: block.range[1], require_movement: true, button_label: "Continue", data: { ...more, item: code }, on_finish: note,
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
