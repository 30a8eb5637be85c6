//! People who were never there: answers by a known rule, in every format that is read, to try a study before it costs anything.
//! Each line says that it is simulated, and so does everything that is made of it.

use std::collections::BTreeMap;

use rand_chacha::ChaCha8Rng;
use rand_core::{Rng as _, SeedableRng as _};
use serde_json::{Value, json};

use crate::design::{Design, williams};
use crate::instrument::Instrument;
use crate::kit::limesurvey::{PERSON, code};
use crate::rating::{Film, Origin};

/// What is true of the people who are simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// People for each scenario; where the study shows all scenarios to everybody, people in all.
    pub people: usize,
    /// Effect of each planner on a latent rating, logit, in the order of the study.
    pub effects: Vec<f64>,
    /// Effect of one place later in the order, logit.
    pub order: f64,
    /// Standard deviation between people, logit. The default of the program is 1.63, that of public ratings of robots' runs.
    pub between: f64,
    /// Standard deviation between one person's impressions of films beyond the planner, shared by all items, logit.
    pub within: f64,
    /// People who click without looking, of all.
    pub careless: usize,
    /// Share of answers that are skipped, 0 to 1.
    pub skipped: f64,
    /// Seed.
    pub seed: u64,
}

/// Answers of simulated people.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulated {
    /// What each person did.
    people: Vec<Person>,
}

#[derive(Debug, Clone, PartialEq)]
struct Person {
    id: String,
    order: usize,
    duration_s: f64,
    checks: BTreeMap<String, String>,
    films: Vec<Seen>,
    careless: bool,
}

#[derive(Debug, Clone, PartialEq)]
struct Seen {
    film: String,
    position: usize,
    watched_s: f64,
    rt_s: f64,
    answers: BTreeMap<String, Option<f64>>,
}

/// Draws of a seeded generator.
pub(crate) struct Draws(ChaCha8Rng);

impl Draws {
    pub(crate) fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Uniform between 0 and 1, both left out.
    pub(crate) fn share(&mut self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "53 bits fit")]
        let whole = (self.0.next_u64() >> 11) as f64;
        (whole + 0.5) / 9_007_199_254_740_992.0
    }

    /// Standard normal (Box and Muller 1958).
    pub(crate) fn normal(&mut self) -> f64 {
        let radius = libm::sqrt(-2.0 * libm::log(self.share()));
        radius * libm::cos(2.0 * std::f64::consts::PI * self.share())
    }

    /// Standard logistic.
    pub(crate) fn logistic(&mut self) -> f64 {
        let share = self.share();
        libm::log(share / (1.0 - share))
    }
}

/// Points of a latent value on an instrument: thresholds at equal distances between −2 and 2 logits.
fn points(of: &Instrument, latent: f64) -> f64 {
    let (low, high) = of.points;
    let steps = high - low;
    let at = (latent + 2.0) / 4.0 * (steps - 1.0);
    low + libm::floor(at + 1.0).clamp(0.0, steps)
}

/// Simulates a study.
#[must_use]
pub fn simulate(design: &Design, truth: &Truth) -> Simulated {
    let mut draws = Draws::new(truth.seed);
    let mut people = Vec::new();
    let groups: Vec<Vec<&str>> = if design.all_scenarios {
        vec![design.scenarios.iter().map(String::as_str).collect()]
    } else {
        design.scenarios.iter().map(|one| vec![one.as_str()]).collect()
    };
    let total = truth.people * groups.len();
    let orders = williams(design.planners.len());
    for number in 0..total {
        let Some(scenarios) = groups.get(number % groups.len()) else { continue };
        let order = number / groups.len() % orders.len();
        let Some(sequence) = orders.get(order) else { continue };
        // Careless people are spread over the sample.
        let careless = (number + 1) * truth.careless / total > number * truth.careless / total;
        people.push(person(design, truth, scenarios, (number, order, sequence, careless), &mut draws));
    }
    Simulated { people }
}

type Place<'p> = (usize, usize, &'p Vec<usize>, bool);

fn person(design: &Design, truth: &Truth, scenarios: &[&str], place: Place<'_>, draws: &mut Draws) -> Person {
    let (number, order, sequence, careless) = place;
    let own = draws.normal() * truth.between;
    let mut films = Vec::new();
    let mut duration_s = 60.0;
    for scenario in scenarios {
        for at in sequence {
            let Some(planner) = design.planners.get(*at) else { continue };
            let shown: Vec<&Film> =
                design.films.iter().filter(|film| film.scenario == *scenario && &film.planner == planner).collect();
            for film in shown {
                let position = films.len() + 1;
                let effect = truth.effects.get(*at).copied().unwrap_or(0.0);
                let later = truth.order * crate::stats::float(position - 1);
                let impression = own + effect + later + draws.normal() * truth.within;
                let length = film.length_s.unwrap_or(20.0);
                let answers = answers(design, truth, (impression, careless), draws);
                let (watched_s, rt_s) =
                    if careless { (length * 0.3, 3.0) } else { (length, 20.0 + 20.0 * draws.share()) };
                let rt_s = libm::round(rt_s * 10.0) / 10.0;
                duration_s += watched_s + rt_s;
                films.push(Seen { film: film.id.clone(), position, watched_s, rt_s, answers });
            }
        }
    }
    let told = |right: &String| if careless { "2".to_owned() } else { right.clone() };
    let checks = design.checks.iter().map(|(name, right)| (name.clone(), told(right))).collect();
    let duration_s = libm::round(if careless { duration_s * 0.3 } else { duration_s });
    Person { id: format!("sim{:04}", number + 1), order: order + 1, duration_s, checks, films, careless }
}

fn answers(design: &Design, truth: &Truth, of: (f64, bool), draws: &mut Draws) -> BTreeMap<String, Option<f64>> {
    let (impression, careless) = of;
    let mut found = BTreeMap::new();
    for dimension in design.dimensions() {
        let (low, high) = dimension.instrument.points;
        for item in &dimension.scale.items {
            let good = points(dimension.instrument, impression + draws.logistic());
            let clicked = if careless {
                low + libm::floor((high - low) / 2.0)
            } else if item.reversed {
                low + high - good
            } else {
                good
            };
            let skipped = draws.share() < truth.skipped;
            found.insert(item.code.clone(), (!skipped).then_some(clicked));
        }
    }
    found
}

impl Simulated {
    /// Ids of the people who clicked without looking.
    #[must_use]
    pub fn careless(&self) -> Vec<&str> {
        self.people.iter().filter(|person| person.careless).map(|person| person.id.as_str()).collect()
    }

    /// As lines of JSON.
    #[must_use]
    pub fn own(&self) -> String {
        let mut out = String::new();
        for person in &self.people {
            for seen in &person.films {
                let line = json!({ "kind": "film", "participant": person.id, "film": seen.film, "position": seen.position,
                    "watched_s": seen.watched_s, "rt_s": seen.rt_s, "answers": seen.answers, "simulated": true });
                out.push_str(&format!("{line}\n"));
            }
            let line = json!({ "kind": "person", "participant": person.id, "order": person.order.to_string(),
                "duration_s": person.duration_s, "checks": person.checks, "simulated": true });
            out.push_str(&format!("{line}\n"));
        }
        out
    }

    /// As Qualtrics exports it, with an address and a place that reading has to drop; in words where an instrument has them.
    #[must_use]
    pub fn qualtrics(&self, design: &Design, words: bool) -> String {
        let mut head: Vec<String> =
            ["IPAddress", "LocationLatitude", "Status", "Duration (in seconds)", "PROLIFIC_PID", "order"]
                .map(str::to_owned)
                .to_vec();
        let mut ids: Vec<String> = ["ipAddress", "locationLatitude", "status", "duration", "PROLIFIC_PID", "order"]
            .map(str::to_owned)
            .to_vec();
        for name in design.checks.keys() {
            head.push(name.clone());
            ids.push(format!("QID9000_{name}"));
        }
        for (at, film) in design.films.iter().enumerate() {
            for code in design.codes().chain(["time", "watched", "position"]) {
                head.push(format!("{}_{code}", film.id));
                ids.push(format!("QID{}_{code}", at + 1));
            }
        }
        let ids: Vec<String> = ids.iter().map(|id| json!({ "ImportId": id }).to_string()).collect();
        let mut lines = vec![head.clone(), head.clone(), ids];
        for person in &self.people {
            let mut line: Vec<String> = vec![
                "192.0.2.7".to_owned(),
                "51.5".to_owned(),
                "0".to_owned(),
                person.duration_s.to_string(),
                person.id.clone(),
                person.order.to_string(),
            ];
            line.extend(design.checks.keys().map(|name| person.checks.get(name).cloned().unwrap_or_default()));
            for film in &design.films {
                let seen = person.films.iter().find(|seen| seen.film == film.id);
                for code in design.codes() {
                    let points = seen.and_then(|seen| seen.answers.get(code).copied().flatten());
                    let anchor = |points: f64| {
                        let anchors = &design.item(code)?.0.instrument.anchors;
                        anchors.iter().find(|(at, _)| (at - points).abs() < 1e-9).map(|(_, words)| words.clone())
                    };
                    let told = |points: f64| anchor(points).filter(|_| words).unwrap_or_else(|| points.to_string());
                    line.push(points.map_or_else(String::new, told));
                }
                line.extend(times(seen));
            }
            lines.push(line);
        }
        text(3, &lines)
    }

    /// As jsPsych writes it: a trial of `survey-likert` for each film, answers counted from 0.
    #[must_use]
    pub fn jspsych(&self, design: &Design) -> String {
        let mut lines = vec![
            ["trial_type", "PROLIFIC_PID", "film", "rt", "watched_s", "check", "response"].map(str::to_owned).to_vec(),
        ];
        for person in &self.people {
            for (name, told) in &person.checks {
                let step = told.parse::<f64>().unwrap_or(1.0) - 1.0;
                let response = json!({ "Q0": step }).to_string();
                let line = ["survey-likert", &person.id, "", "4000", "", name, &response];
                lines.push(line.map(str::to_owned).to_vec());
            }
            for seen in &person.films {
                let step = |code: &String, points: &Option<f64>| {
                    let low = design.item(code).map_or(1.0, |(dimension, _)| dimension.instrument.points.0);
                    points.map_or(Value::Null, |points| json!(points - low))
                };
                let response: BTreeMap<&String, Value> =
                    seen.answers.iter().map(|(code, points)| (code, step(code, points))).collect();
                let (rt, watched) = (libm::round(seen.rt_s * 1000.0).to_string(), seen.watched_s.to_string());
                let response = serde_json::to_string(&response).unwrap_or_default();
                let line = ["survey-likert", &person.id, &seen.film, &rt, &watched, "", &response];
                lines.push(line.map(str::to_owned).to_vec());
            }
        }
        text(1, &lines)
    }

    /// As LimeSurvey exports it with codes, with an address that reading has to drop.
    #[must_use]
    pub fn limesurvey(&self, design: &Design) -> String {
        let mut head: Vec<String> =
            ["id", "submitdate", "ipaddr", PERSON, "order", "interviewtime"].map(str::to_owned).to_vec();
        head.extend(design.checks.keys().map(|name| code(name)));
        for film in &design.films {
            let film = code(&film.id);
            for dimension in design.dimensions() {
                let name = code(&dimension.instrument.id);
                head.extend(dimension.scale.items.iter().map(|item| format!("{film}{name}[{}]", item.code)));
            }
            head.extend(["time", "watched", "position"].map(|what| format!("{film}{what}")));
        }
        let mut lines = vec![head];
        for (number, person) in self.people.iter().enumerate() {
            let mut line = vec![(number + 1).to_string(), "2024-01-01 00:00:00".to_owned(), "192.0.2.7".to_owned()];
            line.extend([person.id.clone(), person.order.to_string(), person.duration_s.to_string()]);
            line.extend(design.checks.keys().map(|name| person.checks.get(name).cloned().unwrap_or_default()));
            for film in &design.films {
                let seen = person.films.iter().find(|seen| seen.film == film.id);
                let points = |code: &str| seen.and_then(|seen| seen.answers.get(code).copied().flatten());
                line.extend(
                    design.codes().map(|code| points(code).map_or_else(String::new, |points| points.to_string())),
                );
                line.extend(times(seen));
            }
            lines.push(line);
        }
        text(1, &lines)
    }

    /// As Qualtrics exports the survey of a kit, whose codebook tells its columns by ImportId: `column,role,film,item`.
    #[must_use]
    pub fn by_codebook(&self, design: &Design, codebook: &str) -> String {
        let columns: Vec<Vec<&str>> = codebook.lines().skip(1).map(|line| line.split(',').collect()).collect();
        let cell = |column: &[&str], at: usize| column.get(at).copied().unwrap_or_default().to_owned();
        let mut head: Vec<String> =
            ["IPAddress", "Duration (in seconds)", "PROLIFIC_PID", "order"].map(str::to_owned).to_vec();
        let mut ids: Vec<String> = ["ipAddress", "duration", "PROLIFIC_PID", "order"].map(str::to_owned).to_vec();
        for column in &columns {
            head.push(format!("Q{}", head.len()));
            ids.push(cell(column, 0));
        }
        for film in &design.films {
            for what in ["watched", "position"] {
                head.push(format!("{}_{what}", film.id));
                ids.push(format!("{}_{what}", film.id));
            }
        }
        let ids: Vec<String> = ids.iter().map(|id| json!({ "ImportId": id }).to_string()).collect();
        let mut lines = vec![head.clone(), head, ids];
        for person in &self.people {
            let of = |film: &str| person.films.iter().find(|seen| seen.film == film);
            let mut line: Vec<String> = vec![
                "192.0.2.7".to_owned(),
                person.duration_s.to_string(),
                person.id.clone(),
                person.order.to_string(),
            ];
            for column in &columns {
                let (role, film, item) = (cell(column, 1), cell(column, 2), cell(column, 3));
                line.push(match role.as_str() {
                    "item" => {
                        let points = of(&film).and_then(|seen| seen.answers.get(&item).copied().flatten());
                        points.map_or_else(String::new, |points| points.to_string())
                    }
                    "time" => of(&film).map_or_else(String::new, |seen| seen.rt_s.to_string()),
                    "check" => person.checks.get(&item).cloned().unwrap_or_default(),
                    _other => String::new(),
                });
            }
            for film in &design.films {
                line.push(of(&film.id).map_or_else(String::new, |seen| seen.watched_s.to_string()));
                line.push(of(&film.id).map_or_else(String::new, |seen| seen.position.to_string()));
            }
            lines.push(line);
        }
        text(3, &lines)
    }

    /// As Prolific exports its submissions.
    #[must_use]
    pub fn prolific(&self) -> String {
        let head = ["Submission id", "Participant id", "Status", "Time taken", "Age", "Sex", "Country of residence"];
        let mut lines = vec![head.map(str::to_owned).to_vec()];
        for (number, person) in self.people.iter().enumerate() {
            let (taken, age) = (person.duration_s.to_string(), (20 + number * 7 % 45).to_string());
            let sex = if number % 2 == 0 { "Female" } else { "Male" };
            let line = [&format!("s{number}"), &person.id, "APPROVED", &taken, &age, sex, "Nowhere"];
            lines.push(line.map(str::to_owned).to_vec());
        }
        text(1, &lines)
    }
}

/// Cells of what was measured while a film was seen, and of its place; empty where it was not.
fn times(seen: Option<&Seen>) -> [String; 3] {
    seen.map_or_else(Default::default, |seen| {
        [seen.rt_s.to_string(), seen.watched_s.to_string(), seen.position.to_string()]
    })
}

/// Lines as CSV, each with a mark that its answers are simulated: the name of the column in the head lines, 1 below.
fn text(head_lines: usize, lines: &[Vec<String>]) -> String {
    let cell = |cell: &String| {
        if cell.contains([',', '"', '\n']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell.clone() }
    };
    let line = |(at, line): (usize, &Vec<String>)| {
        // The last head line of Qualtrics holds an ImportId for each column.
        let mark = match at {
            2 if head_lines == 3 => json!({ "ImportId": Origin::KEY }).to_string(),
            _ if at < head_lines => Origin::KEY.to_owned(),
            _ => "1".to_owned(),
        };
        line.iter().chain([&mark]).map(cell).collect::<Vec<_>>().join(",") + "\n"
    };
    lines.iter().enumerate().map(line).collect()
}
