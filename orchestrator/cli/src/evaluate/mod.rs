//! `evaluate author`: how often an author's scenarios are right at first, after repair, after being asked again, and realised.
//!
//! ```text
//! requests × repeats × arms, seeds paired over the arms ──► trials ──► report.md, trials.csv, faults.csv
//! ```

mod report;
mod spec;
mod trial;

use std::path::Path;

use serde_json::json;

use crate::config::Config;
use crate::exit::Complaint;
use crate::talk::Talk;

pub(crate) use trial::Trial;

/// Makes every trial of a specification and writes what came of it.
pub(crate) async fn author(talk: &Talk, config: &Config, file: &Path, out: &Path) -> Result<(), Complaint> {
    let plan = spec::read(file, config)?;
    let cannot = |why: std::io::Error| {
        Complaint::input(format!("cannot write into `{}`: {why}", out.display()), "--out chooses another folder")
    };
    std::fs::create_dir_all(out).map_err(cannot)?;
    let keys = crate::authors::keys(config)?;
    let desk = socrates_author::Desk::new(keys);
    let whole = plan.arms.len() * plan.cases.iter().map(|case| case.repeats).sum::<usize>();
    let mut trials: Vec<Trial> = Vec::new();
    for case in &plan.cases {
        for repeat in 0..case.repeats {
            for arm in &plan.arms {
                talk.passing(&format!(
                    "{} of {whole}: {} repeat {} {}",
                    trials.len() + 1,
                    case.name,
                    repeat + 1,
                    arm.name
                ));
                trials.push(trial::run(&desk, &plan, case, repeat, arm).await);
            }
        }
    }
    talk.clear();
    let page = report::page(&plan, &trials);
    for (name, text) in
        [("report.md", page.clone()), ("trials.csv", report::trials(&trials)), ("faults.csv", report::faults(&trials))]
    {
        std::fs::write(out.join(name), text).map_err(cannot)?;
    }
    talk.line(&page);
    talk.line(&format!("wrote      {} (report.md, trials.csv, faults.csv)", out.display()));
    talk.result(
        &json!({"out": out.display().to_string(), "trials": trials.len(), "arms": report::rows(&plan, &trials)}),
    );
    Ok(())
}
