//! The report page of a bundle: one self-contained HTML file that needs no network.

use serde_json::{Value, json};
use socrates_model::{ClauseRole, EventKind, Location, Paths, Proposal, Reading, Recording, Report, Request};

use crate::map_layer::{Frame, draw_doors, draw_floor, draw_graph, draw_scale};
use crate::palette;
use crate::svg::{Svg, escape};

const TEMPLATE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// Samples per second of the animation.
const SAMPLE_HZ: usize = 10;

/// One line of the stage table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StageRow {
    /// Stage name, with planner and seed where there are several.
    pub stage: String,
    /// `succeeded`, `superseded`, …
    pub state: String,
    /// Attempts.
    pub attempts: u32,
    /// Working time, ms.
    pub wall_ms: u64,
    /// What happened: remark and faults.
    pub remark: String,
}

/// One line of the provenance table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProvenanceRow {
    /// Name.
    pub name: String,
    /// Value.
    pub value: String,
}

/// Everything the page shows.
#[derive(Debug, Clone)]
pub struct Page<'a> {
    /// Heading.
    pub title: &'a str,
    /// What the user gave.
    pub request: &'a Request,
    /// What was read.
    pub reading: &'a Reading,
    /// The reading in one line.
    pub reading_line: &'a str,
    /// The place.
    pub location: &'a Location,
    /// The proposal.
    pub proposal: &'a Proposal,
    /// The paths.
    pub paths: &'a Paths,
    /// Runs, the reference first.
    pub runs: &'a [(Recording, Report)],
    /// Stages.
    pub stages: &'a [StageRow],
    /// Provenance.
    pub provenance: &'a [ProvenanceRow],
}

impl Page<'_> {
    /// The page.
    #[must_use]
    pub fn html(&self) -> String {
        let frame = Frame::around(self.location, 1120.0, 720.0, (0.0, 0.0));
        let (w, h) = frame.size();
        let mut map = Svg::new(w, h + 30.0);
        draw_floor(&mut map, self.location, &frame);
        draw_graph(&mut map, self.location, &frame, palette::UNKNOWN, 1.5);
        let robot: Vec<(f64, f64)> =
            self.location.graph.polyline(&self.paths.robot).iter().map(|p| frame.px(self.location, p)).collect();
        map.polyline(
            &robot,
            &format!("stroke=\"{}\" stroke-width=\"1.4\" stroke-dasharray=\"3 5\" opacity=\"0.55\"", palette::ROBOT),
        );
        draw_doors(&mut map, self.location, &frame);
        draw_scale(&mut map, self.location, &frame, 16.0);
        map.raw("<g id=\"trails\"></g><g id=\"agents\"></g>");
        let map =
            map.finish().replacen("<svg ", "<svg id=\"map\" role=\"img\" aria-label=\"animation of the run\" ", 1);
        let runs: Vec<Value> =
            self.runs.iter().map(|(recording, report)| run_data(self.location, &frame, recording, report)).collect();
        // `</` must not end the script early, whatever a user wrote in a request.
        let data = json!({ "runs": runs, "height": h }).to_string().replace("</", "<\\/");
        let verdict = self.runs.first().map_or("not run", |(_, report)| report.verdict.name());
        TEMPLATE
            .replace("{{style}}", STYLE)
            .replace("{{title}}", &escape(self.title))
            .replace("{{verdict}}", &escape(verdict))
            .replace("{{verdict_class}}", if verdict == "realised" { "good" } else { "bad" })
            .replace("{{author}}", &escape(&self.proposal.author))
            .replace("{{location}}", &escape(&self.location.name))
            .replace("{{description}}", &escape(&self.proposal.description))
            .replace("{{reading}}", &self.reading_html())
            .replace("{{people}}", &self.people_html())
            .replace("{{stages}}", &self.stages_html())
            .replace("{{provenance}}", &self.provenance_html())
            .replace("{{map}}", &map)
            .replace("{{script}}", SCRIPT)
            .replace("{{data}}", &data)
    }

    fn reading_html(&self) -> String {
        let mut out = format!("<p class=\"lead\">{}</p><dl>", escape(self.reading_line));
        let request = [
            ("Social context", Some(self.request.social_context.as_str())),
            ("Task", Some(self.request.task.as_str())),
            ("Rough scenario", Some(self.request.rough_scenario.as_deref().unwrap_or("(none: unguided)"))),
        ];
        for (name, text) in request {
            let text = text.unwrap_or_default();
            out.push_str(&format!("<dt>{name}</dt><dd>{}</dd>", escape(text)));
        }
        let ignored =
            if self.reading.ignored.is_empty() { "nothing".to_owned() } else { self.reading.ignored.join(", ") };
        out.push_str(&format!("<dt>Ignored words</dt><dd>{}</dd>", escape(&ignored)));
        for note in self.reading.notes.iter().chain(&self.proposal.notes) {
            out.push_str(&format!("<dt>Assumed</dt><dd>{}</dd>", escape(note)));
        }
        for problem in &self.reading.problems {
            out.push_str(&format!("<dt>Problem</dt><dd class=\"bad\">{}</dd>", escape(&problem.to_string())));
        }
        out.push_str("</dl>");
        out
    }

    fn people_html(&self) -> String {
        let mut out = String::new();
        out.push_str(&format!(
            "<tr><td><i style=\"background:{}\"></i>robot</td><td>{}</td><td>{}</td></tr>",
            palette::ROBOT,
            escape(&self.proposal.robot.task),
            escape(&self.proposal.robot.expected_behavior)
        ));
        for human in &self.proposal.humans {
            let group = human.group.map(|group| format!(" · {group}")).unwrap_or_default();
            out.push_str(&format!(
                "<tr><td><i style=\"background:{}\"></i>{}</td><td>{}{}</td><td>{}</td></tr>",
                palette::human(human.id.number()),
                human.id,
                escape(&human.role),
                escape(&group),
                escape(&human.behavior)
            ));
        }
        out
    }

    fn stages_html(&self) -> String {
        self.stages
            .iter()
            .map(|row| {
                format!(
                    "<tr><td>{}</td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{} ms</td><td>{}</td></tr>",
                    escape(&row.stage),
                    escape(&row.state),
                    row.attempts,
                    row.wall_ms,
                    escape(&row.remark)
                )
            })
            .collect()
    }

    fn provenance_html(&self) -> String {
        self.provenance
            .iter()
            .map(|row| format!("<tr><td>{}</td><td><code>{}</code></td></tr>", escape(&row.name), escape(&row.value)))
            .collect()
    }
}

fn run_data(location: &Location, frame: &Frame, recording: &Recording, report: &Report) -> Value {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number of ticks")]
    let every = ((1.0 / recording.header.step_s.max(1e-4)).round() as usize / SAMPLE_HZ).max(1);
    let round = |x: f64| (x * 10.0).round() / 10.0;
    let agents: Vec<Value> = recording
        .header
        .agents
        .iter()
        .map(|info| {
            let track: Vec<Value> = recording
                .track(info.agent)
                .step_by(every)
                .map(|state| {
                    let (x, y) = frame.px(location, &state.point());
                    json!([round(x), round(y), (state.yaw * 100.0).round() / 100.0, state.gesture().code()])
                })
                .collect();
            json!({
                "name": info.agent.to_string(), "role": info.role, "color": palette::agent(info.agent.number()),
                "radius": frame.len(location, info.radius_m).max(4.0), "track": track,
            })
        })
        .collect();
    let doors: Vec<Value> = location
        .doors
        .iter()
        .map(|door| {
            let times: Vec<Value> = recording
                .events
                .iter()
                .filter_map(|event| {
                    let EventKind::Door { door: id, open } = &event.kind else { return None };
                    (*id == door.id).then(|| json!([event.time.secs(), open]))
                })
                .collect();
            let (from, to) = (frame.px(location, &door.from), frame.px(location, &door.to));
            json!({ "id": door.id, "line": [from.0, from.1, to.0, to.1], "times": times })
        })
        .collect();
    let events: Vec<Value> =
        recording.events.iter().filter_map(|event| timeline_mark(event.time.secs(), &event.kind)).collect();
    let clauses: Vec<Value> = report
        .clauses
        .iter()
        .map(|clause| {
            json!({
                "id": clause.id, "text": clause.text, "setup": clause.role == ClauseRole::Setup, "must": clause.must,
                "standing": clause.standing, "times": clause.times_s, "evidence": clause.evidence, "source": clause.source,
            })
        })
        .collect();
    json!({
        "name": format!("{} · seed {}", report.planner, report.seed), "verdict": report.verdict.name(),
        "verdict_text": report.verdict_text, "robot_text": report.robot_text, "hz": SAMPLE_HZ, "agents": agents,
        "doors": doors, "events": events, "clauses": clauses, "metrics": report.metrics, "story": report.story,
        "simulated": report.simulated_s,
    })
}

/// A mark on the time line: time, lane (agent number), kind and words.
fn timeline_mark(secs: f64, kind: &EventKind) -> Option<Value> {
    let mark = |lane: u32, what: &str, words: String| Some(json!([secs, lane, what, words]));
    match kind {
        EventKind::Gesture { agent, gesture } if gesture.code() > 0 => {
            mark(agent.number(), "gesture", format!("{agent} says {gesture}"))
        }
        EventKind::Leaf { human, leaf } => mark(human.number(), "leaf", format!("{human}: {leaf}")),
        EventKind::Sees { human, distance_m } => {
            mark(human.number(), "sees", format!("{human} sees the robot at {distance_m:.1} m"))
        }
        EventKind::Encounter { human, gap_s, .. } => {
            mark(human.number(), "encounter", format!("encounter of {human} and the robot, gap {gap_s:.1} s"))
        }
        EventKind::Contact { a, b, .. } => mark(b.number(), "contact", format!("{a} touches {b}")),
        EventKind::WallContact { agent, .. } => mark(agent.number(), "contact", format!("{agent} touches a wall")),
        EventKind::Door { door, open } => mark(0, "door", format!("{door} {}", if *open { "opens" } else { "closes" })),
        EventKind::RobotArrived => mark(0, "goal", "the robot is at its goal".to_owned()),
        EventKind::Stuck { agent } => mark(agent.number(), "contact", format!("{agent} is stuck")),
        EventKind::Gesture { .. } | EventKind::Node { .. } | EventKind::End { .. } => None,
    }
}
