//! Ratings to results.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::cell::{Cell, cell};
use crate::design::Design;
use crate::exclude::excluded;
use crate::rating::{Origin, Ratings, Row, is_by_people};
use crate::stats::holm;

/// Whether the study was declared before its answers were seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Declared {
    /// A preregistration with the digest of this very study was given.
    Before,
    /// A preregistration of another state of the study was given: everything is exploratory.
    Changed,
    /// None was given: everything is exploratory.
    Never,
}

/// Results of a study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Results {
    /// Title of the study.
    pub title: String,
    /// Digest of the study file.
    pub digest: String,
    /// Whether it was declared before.
    pub declared: Declared,
    /// Origin of the answers; a mark `"simulated": true` where no person gave them, else nothing.
    #[serde(rename = "simulated", skip_serializing_if = "is_by_people")]
    pub origin: Origin,
    /// People who answered.
    pub people: usize,
    /// Those left out, with the rules that they broke.
    pub excluded: BTreeMap<String, Vec<&'static str>>,
    /// Ratings that were given, and that are missing, of everybody.
    pub ratings: (usize, usize),
    /// Each scale in each scenario.
    pub cells: Vec<Cell>,
    /// What the tests say, in sentences: planners that differ.
    pub findings: Vec<Finding>,
}

/// A difference of two planners that the tests of its family bear out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// Scenario.
    pub scenario: String,
    /// Scale.
    pub dimension: String,
    /// The planner that was rated higher.
    pub higher: String,
    /// The planner that was rated lower.
    pub lower: String,
    /// By how many points, at least 0.
    pub points: f64,
    /// p by Holm.
    pub p: f64,
    /// Whether it was declared.
    pub declared: bool,
}

/// Computes everything. `declared` says whether the study was registered before; where it was not, no cell counts as declared.
#[must_use]
pub fn analyze(ratings: &Ratings, design: &Design, declared: Declared) -> Results {
    let excluded = excluded(ratings, design);
    let mut by_scenario: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    for row in &ratings.rows {
        if let Some(film) = design.film(&row.film) {
            by_scenario.entry(&film.scenario).or_default().push(row);
        }
    }
    let mut cells = Vec::new();
    for scenario in &design.scenarios {
        let here = by_scenario.get(scenario.as_str()).map_or(&[][..], Vec::as_slice);
        for dimension in design.dimensions() {
            let asked = |row: &&&Row| dimension.scale.items.iter().any(|item| item.code == row.item);
            let all: Vec<&Row> = here.iter().filter(asked).copied().collect();
            if all.is_empty() {
                continue;
            }
            let kept: Vec<&Row> = all.iter().filter(|row| !excluded.contains_key(&row.participant)).copied().collect();
            let mut found = cell(design, scenario, dimension, &kept, &all);
            found.declared &= declared == Declared::Before;
            cells.push(found);
        }
    }
    for scenario in &design.scenarios {
        for family in [true, false] {
            adjust(&mut cells, scenario, family);
        }
    }
    let given = ratings.rows.iter().filter(|row| row.rating.points().is_some()).count();
    Results {
        title: design.title.clone(),
        digest: design.digest.clone(),
        declared,
        origin: ratings.origin,
        people: ratings.participants.len(),
        excluded,
        ratings: (given, ratings.rows.len() - given),
        findings: findings(&cells, design.alpha),
        cells,
    }
}

/// Holm's adjustment over the pairs and dimensions of a scenario, declared ones and others apart.
fn adjust(cells: &mut [Cell], scenario: &str, declared: bool) {
    let family = || |cell: &&mut Cell| cell.scenario == scenario && cell.declared == declared;
    let mut tests: Vec<_> = cells
        .iter_mut()
        .filter(family())
        .flat_map(|cell| cell.pairs.iter_mut().filter_map(|pair| pair.test.as_mut().ok()))
        .collect();
    let raw: Vec<f64> = tests.iter().map(|test| test.p).collect();
    tests.iter_mut().zip(holm(&raw)).for_each(|(test, p)| test.p_holm = p);
}

fn findings(cells: &[Cell], alpha: f64) -> Vec<Finding> {
    let mut found = Vec::new();
    for cell in cells {
        for pair in &cell.pairs {
            let Ok(test) = &pair.test else { continue };
            if test.p_holm >= alpha {
                continue;
            }
            let up = test.rank_biserial > 0.0;
            let (higher, lower) = if up { (&pair.first, &pair.against) } else { (&pair.against, &pair.first) };
            found.push(Finding {
                scenario: cell.scenario.clone(),
                dimension: cell.dimension.clone(),
                higher: higher.clone(),
                lower: lower.clone(),
                points: libm::fabs(test.shift.0),
                p: test.p_holm,
                declared: cell.declared,
            });
        }
    }
    found
}

/// The figures in one flat table for the scripts: `scenario,dimension,statistic,which,value`, and [`Origin::KEY`] where the answers are
/// simulated; what has no value has no line.
#[must_use]
pub fn results_csv(results: &Results) -> String {
    let (column, mark) =
        if results.origin.is_simulated() { (format!(",{}", Origin::KEY), ",1") } else { Default::default() };
    let mut out = format!("scenario,dimension,statistic,which,value{column}\n");
    for cell in &results.cells {
        let mut add = |statistic: &str, which: &str, value: f64| {
            let name = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
            let (scenario, dimension) = (name(&cell.scenario), name(&cell.dimension));
            out.push_str(&format!("{scenario},{dimension},{statistic},{},{value}{mark}\n", name(which)));
        };
        if let Ok(of) = &cell.friedman {
            add("friedman_chi2", "", of.chi2);
            add("friedman_p", "", of.p);
            add("kendall_w", "", of.w);
        }
        for pair in &cell.pairs {
            let which = format!("{} - {}", pair.first, pair.against);
            if let Ok((conover, nemenyi)) = &pair.posthoc {
                conover.iter().for_each(|p| add("conover_p", &which, *p));
                add("nemenyi_p", &which, *nemenyi);
            }
            let Ok(of) = &pair.test else { continue };
            add("wilcoxon_p_dropped", &which, of.p_dropped);
            add("wilcoxon_p_pratt", &which, of.p);
        }
        if let Ok(of) = &cell.alpha {
            add("alpha", "", of.0);
        }
        if let Ok(of) = &cell.omega {
            add("omega", "", *of);
        }
        if let Ok(of) = &cell.icc {
            add("icc_c1", "", of.0);
            add("icc_ck", "", of.1);
        }
        if let Ok(of) = &cell.krippendorff {
            add("krippendorff_ordinal", "", *of);
        }
        if let Ok(of) = &cell.linear {
            add("linear_f", "", of.0);
        }
        if let Ok(of) = &cell.ordinal {
            for (planner, effect, error, _) in &of.effects {
                add("clmm_effect", planner, *effect);
                add("clmm_error", planner, *error);
            }
            add("clmm_sigma", "", of.sigma);
            add("clmm_lr", "", of.lr.0);
        }
        if let Ok(of) = &cell.strengths {
            of.iter().skip(1).for_each(|(planner, strength, _)| add("bradley_terry", planner, *strength));
        }
        if let Ok((of, ties)) = &cell.strengths_with_ties {
            of.iter().skip(1).for_each(|(planner, strength)| add("davidson", planner, *strength));
            add("davidson_ties", "", *ties);
        }
    }
    out
}
