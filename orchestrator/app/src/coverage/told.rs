//! Coverage in words and tables: what is empty in sentences, and every cell for people, spreadsheets and programs.

use serde_json::{Value, json};
use socrates_draw::Covered;
use socrates_stream::csv::joined;

use super::{Axis, BANDS, Count, Coverage};
use crate::encounters::Sector;

/// Cells of an axis that are written out in a line; of more, how many there are.
const NAMED: usize = 60;
/// Words that pages and tables of coverage use, and what they mean.
pub(crate) const WORDS: [(&str, &str); 4] = [
    (
        "coverage",
        "What a library holds of what can be asked for: canonical scenarios, encounter angles, densities of people, places, locations, \
         contexts, planners. Counted are scenarios that repeat no earlier one and, of them, those that were realised; an empty cell is a \
         kind of scenario that nothing in the library tests. `socrates library coverage LIBRARY` prints it.",
    ),
    (
        "encounter angle",
        "The direction of the person's way less that of the robot's, each over the last 2 m before their meeting as the paths have it, in \
         sectors of 45°: frontal (157.5° to 180°), frontal_left and frontal_right (112.5° to 157.5°), crossing_left and crossing_right \
         (67.5° to 112.5°), merging_left and merging_right (22.5° to 67.5°), and below 22.5° ahead, behind or beside by how the person \
         stands to the robot's way; standing is a person without a way. Left and right are where they come from as the robot drives. The \
         angle is of the paths; whether the two met so is what the verdict says. Encounters after Francis et al. 2023.",
    ),
    (
        "density of people",
        "People within 2.5 m of the robot, the most at once, over the area of that disc, in the first run (density_2_5m_max, CrowdBot). \
         Bands: nobody near, below 0.1 per m² (one person), 0.1 to 0.31, 0.31 to 0.72, from 0.72; the last two begin where the levels of \
         service A and C of a walkway end (Fruin 1971).",
    ),
    (
        "place",
        "The class of the place where a scenario happens: corridor, narrow_passage, intersection, blind_corner, doorway, elevator, \
         elevator_lobby, room, open_area, exit or plain. The type of the node on the map says which; [expect] place of a request asks for \
         one.",
    ),
];

/// `12 / 14`: realised of scenarios; a dot where there is none.
fn shown(count: Count) -> String {
    if count.scenarios == 0 { "·".to_owned() } else { format!("{} / {}", count.realised, count.scenarios) }
}

/// A name as people read it.
fn plain(name: &str) -> String {
    name.replace('_', " ")
}

fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    let more = names.len().saturating_sub(NAMED);
    let shown = names.iter().take(NAMED).copied().collect::<Vec<_>>().join(", ");
    if more > 0 { format!("{shown} and {more} more") } else { shown }
}

/// The highest band that holds a scenario.
fn highest(counts: &[Count]) -> Option<usize> {
    counts.iter().rposition(|count| count.scenarios > 0)
}

/// The density from which on a band is.
fn from(band: usize) -> f64 {
    band.checked_sub(1).and_then(|before| BANDS.get(before)).map_or(0.0, |(_, end)| *end)
}

impl Coverage {
    fn axis(&self, name: &str) -> Option<&Axis> {
        self.axes.iter().find(|axis| axis.name == name)
    }

    /// What the library lacks, a sentence each, the widest gaps first.
    pub(crate) fn gaps(&self) -> Vec<String> {
        let mut gaps = Vec::new();
        for axis in self.axes.iter().filter(|axis| axis.known > 0 && axis.untold < self.distinct.scenarios) {
            let empty: Vec<&str> = axis.empty().collect();
            if !empty.is_empty() {
                gaps.push(format!(
                    "{} of {} {} have no scenario: {}",
                    empty.len(),
                    axis.known,
                    axis.plural,
                    listed(empty.iter().copied())
                ));
            }
            let never: Vec<&str> = axis.never_realised().collect();
            if !never.is_empty() {
                gaps.push(format!("never realised of the {}: {}", axis.plural, listed(never.iter().copied())));
            }
        }
        // Of a density that no scenario has it is said already that there is none.
        let top = self.crossed.iter().filter_map(|counts| highest(counts)).max().unwrap_or(0);
        for (sector, counts) in Sector::ALL.iter().zip(&self.crossed) {
            let Some(highest) = highest(counts) else { continue };
            let without = format!("no scenario with an encounter {} at a density", sector.phrase());
            if highest < top {
                gaps.push(format!("{without} of {} people per m² or more", from(highest + 1)));
            }
            // That nobody is near at an encounter lacks to no library.
            for band in (1..highest).filter(|band| counts.get(*band).is_some_and(|count| count.scenarios == 0)) {
                let low = if band == 1 { "below".to_owned() } else { format!("of {} to", from(band)) };
                gaps.push(format!("{without} {low} {} people per m²", from(band + 1)));
            }
        }
        let idle = self.planners.iter().filter(|(_, verdicts)| verdicts.is_empty()).map(|(name, _)| name.as_str());
        let idle = listed(idle);
        if !idle.is_empty() {
            gaps.push(format!("no run of these planners: {idle}"));
        }
        gaps
    }

    /// One line of what there is.
    pub(crate) fn summary(&self) -> String {
        let repeats = self.scenarios - self.distinct.scenarios;
        let of_them = if repeats > 0 { format!(", {repeats} repeat one of them") } else { String::new() };
        let failed = if self.failed > 0 { format!(" · {} without a run", self.failed) } else { String::new() };
        format!("{} distinct scenarios{of_them} · {} realised{failed}", self.distinct.scenarios, self.distinct.realised)
    }

    /// `12 of 45 canonical scenarios`, for each axis that has cells to be asked for.
    pub(crate) fn shares(&self) -> Vec<String> {
        let asked = self.axes.iter().filter(|axis| axis.known > 0);
        asked.map(|axis| format!("{} of {} {}", axis.held(), axis.known, axis.plural)).collect()
    }

    /// Everything in lines for people.
    pub(crate) fn lines(&self) -> Vec<String> {
        let mut lines = vec![format!("scenarios  {}", self.summary())];
        lines.push("counted    distinct scenarios: realised / all; a dot is an empty cell".to_owned());
        for axis in &self.axes {
            lines.push(String::new());
            let of = if axis.known > 0 {
                format!("{} of {} {}", axis.held(), axis.known, axis.plural)
            } else {
                axis.plural.to_owned()
            };
            lines.push(of);
            let wide = axis.cells.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0).min(60);
            let full = axis.cells.iter().filter(|(_, count)| count.scenarios > 0);
            lines.extend(full.map(|(name, count)| format!("  {name:wide$}  {:>11}", shown(*count))));
            let empty = listed(axis.empty());
            if !empty.is_empty() {
                lines.push(format!("  none       {empty}"));
            }
            if axis.untold > 0 {
                lines.push(format!("  not known  {}", axis.untold));
            }
        }
        lines.push(String::new());
        lines.extend(self.crossed_lines());
        lines.push(String::new());
        lines.extend(self.planner_lines());
        let gaps = self.gaps();
        if !gaps.is_empty() {
            lines.push(String::new());
            lines.push("gaps".to_owned());
            lines.extend(gaps.into_iter().map(|gap| format!("  {gap}")));
        }
        lines
    }

    fn crossed_lines(&self) -> Vec<String> {
        let head: String = BANDS.iter().map(|(name, _)| format!("{name:>15}")).collect();
        let rows = Sector::ALL.iter().zip(&self.crossed).map(|(sector, counts)| {
            let cells: String = counts.iter().map(|count| format!("{:>15}", shown(*count))).collect();
            format!("  {:<16}{cells}", sector.name())
        });
        ["encounter angles by density, people per m²".to_owned(), format!("  {:<16}{head}", "")]
            .into_iter()
            .chain(rows)
            .collect()
    }

    /// Verdicts that some run has, in the order of their names.
    fn verdicts(&self) -> Vec<&str> {
        let mut verdicts: Vec<&str> =
            self.planners.iter().flat_map(|(_, verdicts)| verdicts.keys()).map(String::as_str).collect();
        verdicts.sort_unstable();
        verdicts.dedup();
        verdicts
    }

    fn planner_lines(&self) -> Vec<String> {
        let verdicts = self.verdicts();
        let head: String = verdicts.iter().map(|name| format!("{name:>17}")).collect();
        let ran = self.planners.iter().filter(|(_, found)| !found.is_empty());
        let rows = ran.map(|(planner, found)| {
            let cell = |name: &&str| found.get(*name).map_or_else(|| "·".to_owned(), usize::to_string);
            let cells: String = verdicts.iter().map(|name| format!("{:>17}", cell(name))).collect();
            format!("  {planner:<16}{cells}")
        });
        ["runs by planner and verdict".to_owned(), format!("  {:<16}{head}", "")].into_iter().chain(rows).collect()
    }

    /// Every cell in a row of its own: `axis,cell,by,scenarios,realised`. Of planners the cells are runs.
    pub(crate) fn csv(&self) -> String {
        let mut text = joined(["axis", "cell", "by", "scenarios", "realised"]) + "\n";
        let mut row = |axis: &str, cell: &str, by: &str, count: Count| {
            text.push_str(&joined([axis, cell, by, &count.scenarios.to_string(), &count.realised.to_string()]));
            text.push('\n');
        };
        for axis in &self.axes {
            axis.cells.iter().for_each(|(cell, count)| row(axis.name, cell, "", *count));
        }
        for (sector, counts) in Sector::ALL.iter().zip(&self.crossed) {
            BANDS.iter().zip(counts).for_each(|((band, _), count)| row("encounter", sector.name(), band, *count));
        }
        for (planner, verdicts) in &self.planners {
            let runs = |is: fn(&str) -> bool| verdicts.iter().filter(|(name, _)| is(name)).map(|(_, n)| n).sum();
            let all = Count { scenarios: runs(|_| true), realised: runs(|name| name.starts_with("realised")) };
            row("planner_runs", planner, "", all);
            for (verdict, runs) in verdicts {
                let realised = if verdict.starts_with("realised") { *runs } else { 0 };
                row("planner_runs", planner, verdict, Count { scenarios: *runs, realised });
            }
        }
        text
    }

    /// The same for programs.
    pub(crate) fn object(&self) -> Value {
        let count = |count: &Count| json!({ "scenarios": count.scenarios, "realised": count.realised });
        let axis = |axis: &Axis| {
            let cells = axis
                .cells
                .iter()
                .map(|(cell, found)| json!({ "cell": cell, "scenarios": found.scenarios, "realised": found.realised }));
            json!({
                "axis": axis.name, "held": axis.held(), "known": axis.known, "not_known_of": axis.untold,
                "empty": axis.empty().collect::<Vec<_>>(), "cells": cells.collect::<Vec<_>>(),
            })
        };
        let crossed = Sector::ALL.iter().zip(&self.crossed).map(|(sector, counts)| {
            let cells = BANDS.iter().zip(counts).map(|((band, _), found)| ((*band).to_owned(), count(found)));
            (sector.name().to_owned(), Value::Object(cells.collect()))
        });
        let planners = self.planners.iter().map(|(name, verdicts)| (name.clone(), json!(verdicts)));
        json!({
            "scenarios": self.scenarios, "distinct": self.distinct.scenarios, "realised": self.distinct.realised, "failed": self.failed,
            "axes": self.axes.iter().map(axis).collect::<Vec<_>>(), "encounter_by_density": Value::Object(crossed.collect()),
            "planners": Value::Object(planners.collect()), "gaps": self.gaps(),
        })
    }

    /// The same for the page of a library.
    pub(crate) fn told(&self) -> Covered {
        let table = |name: &str| -> Vec<Vec<String>> {
            let cells = self.axis(name).into_iter().flat_map(|axis| &axis.cells);
            cells.map(|(cell, count)| vec![plain(cell), shown(*count)]).collect()
        };
        let head = std::iter::once(String::new()).chain(BANDS.iter().map(|(name, _)| plain(name))).collect();
        let crossed = Sector::ALL.iter().zip(&self.crossed).map(|(sector, counts)| {
            std::iter::once(plain(sector.name())).chain(counts.iter().map(|count| shown(*count))).collect()
        });
        Covered {
            shares: self.shares(),
            scenarios: table("scenario"),
            places: table("place"),
            head,
            encounters: crossed.collect(),
            gaps: self.gaps(),
        }
    }
}
