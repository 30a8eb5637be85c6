//! What is compared: the reports of every run of some folders of bundles.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use socrates_model::{PlannerName, Report, Run};
use socrates_scoring::compare::Entry;

use crate::bundle;
use crate::exit::Diagnostic;
use crate::{batch, library_index};

/// One scenario with all its runs.
#[derive(Debug)]
pub(super) struct FoundScenario {
    /// Its name: that of its folder.
    pub(super) name: String,
    /// Its folder.
    pub(super) dir: PathBuf,
    request: String,
    location: String,
    reports: Vec<Report>,
    /// Why runs have no result, with which.
    failed: Vec<(String, Run)>,
}

impl FoundScenario {
    fn read(dir: &Path, name: String) -> Result<Self, Diagnostic> {
        let (bundle, reports) = bundle::read_with_reports(dir, |_, _| false)?;
        Ok(Self {
            name,
            dir: dir.to_path_buf(),
            request: bundle.manifest.request_name().to_owned(),
            location: bundle.location.name,
            reports,
            failed: bundle.manifest.failed.into_iter().map(|failed| (failed.told(), failed.run)).collect(),
        })
    }

    /// Every run that was wanted, those without a result last.
    pub(super) fn entries(&self) -> impl Iterator<Item = Entry<'_>> {
        let (scenario, request, location) = (self.name.as_str(), self.request.as_str(), self.location.as_str());
        let entry = move |planner, seed, result| Entry { scenario, request, location, planner, seed, result };
        let have = self.reports.iter().map(move |report| entry(&report.planner, report.seed, Ok(report)));
        have.chain(self.failed.iter().map(move |(why, run)| entry(&run.planner, run.seed, Err(why.as_str()))))
    }

    /// Seeds that all these planners have a result of, in the order of the runs.
    pub(super) fn seeds(&self, planners: &[PlannerName]) -> impl Iterator<Item = u64> {
        let of = |planner: &PlannerName| -> BTreeSet<u64> {
            self.reports.iter().filter(|report| report.planner == *planner).map(|report| report.seed).collect()
        };
        let common = planners.iter().map(of).reduce(|all, own| all.intersection(&own).copied().collect());
        common.unwrap_or_default().into_iter()
    }
}

/// What is compared.
#[derive(Debug)]
pub(super) struct Found {
    /// Scenarios, in order of the folders and, in a library, of its list.
    pub(super) scenarios: Vec<FoundScenario>,
    /// Scenarios that are not compared, and why.
    pub(super) left_out: Vec<(String, String)>,
}

/// Reads bundles and folders of bundles.
pub(super) fn read(roots: &[PathBuf]) -> Result<Found, Diagnostic> {
    let mut found = Found { scenarios: Vec::new(), left_out: Vec::new() };
    for root in roots {
        if bundle::is_bundle(root) {
            let name =
                root.file_name().map_or_else(|| root.display().to_string(), |name| name.to_string_lossy().into_owned());
            found.scenarios.push(FoundScenario::read(root, name)?);
            continue;
        }
        folder(root, &mut found)?;
    }
    let mut names = BTreeSet::new();
    for scenario in &mut found.scenarios {
        // Folders of one name in different places are different scenarios.
        while !names.insert(scenario.name.clone()) {
            scenario.name.push('+');
        }
    }
    if found.scenarios.is_empty() {
        let all: Vec<String> = roots.iter().map(|root| format!("`{}`", root.display())).collect();
        let mut diagnostic = Diagnostic::input(
            format!("there is no scenario to compare in {}", all.join(", ")),
            "name bundles or folders of bundles, or requests to run",
        );
        diagnostic.causes = found.left_out.iter().map(|(name, why)| format!("{name}: {why}")).collect();
        return Err(diagnostic);
    }
    Ok(found)
}

/// The bundles of a folder: those that its library lists first, in their order.
fn folder(root: &Path, found: &mut Found) -> Result<(), Diagnostic> {
    let there = batch::bundles(root)?;
    let mut names: Vec<String> = Vec::new();
    let mut listed = BTreeSet::new();
    for row in library_index::read(root).into_iter().flat_map(|library| library.scenarios) {
        let name = row.scenario.to_string();
        listed.insert(name.clone());
        match row.repeats {
            // What repeats another scenario is no evidence of its own.
            Some(earlier) => found.left_out.push((name, format!("repeats `{earlier}` (P-DUP)"))),
            None if there.contains(&name) => names.push(name),
            None => found.left_out.push((name, row.reason)),
        }
    }
    names.extend(there.into_iter().filter(|name| !listed.contains(name)));
    for name in names {
        match FoundScenario::read(&root.join(&name), name.clone()) {
            Ok(scenario) => found.scenarios.push(scenario),
            Err(why) => found.left_out.push((name, why.what)),
        }
    }
    Ok(())
}
