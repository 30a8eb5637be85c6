//! From clauses to one verdict, one score and one sentence.

use std::collections::BTreeMap;

use socrates_model::report::Standing;
use socrates_model::statement::{Became, Statement};
use socrates_model::{Predicate, Verdict};

use crate::evidence::Evidence;
use crate::fidelity::clauses::Judged;
use crate::fidelity::gaps::Gaps;

/// Share of a late clause in the score.
const LATE_SHARE: f64 = 0.8;

/// The ruling.
#[derive(Debug, Clone, PartialEq)]
pub struct Ruling {
    /// Verdict.
    pub verdict: Verdict,
    /// One sentence, with times.
    pub text: String,
    /// Score F, 0 to 1.
    pub score: f64,
}

/// Rules on the clauses, and on what the request asks for beyond them. `reference` is the ruling on the clauses alone of the
/// same scenario with the reference robot, if known.
///
/// A run that shows all its clauses is `invalid` while a wish of the request was not seen: it was not read or is not played and nobody has
/// waived it, or a clause of it cannot be judged. Nothing is realised by leaving a wish out. Verdicts that tell of what was played (`contradicted`, `not_triggered`,
/// `robot_prevented`) take precedence.
#[must_use]
pub fn rule(evidence: &Evidence<'_>, judged: &Judged, gaps: &Gaps, reference: Option<Verdict>) -> Ruling {
    let ruling = ruling_of_played(evidence, judged, gaps, reference);
    let absent = missing(evidence);
    let count = match absent.len() {
        1 => "1 wish is not in this run".to_owned(),
        n => format!("{n} wishes are not in this run"),
    };
    let absent = after(&format!("{count}: "), &absent);
    let is_realised = matches!(ruling.verdict, Verdict::Realised | Verdict::RealisedLate);
    // In a run that shows all its clauses a wish is unseen for lack of a judgment alone.
    let unjudged = if is_realised { unseen(evidence, judged) } else { Vec::new() };
    let count = match unjudged.len() {
        1 => "1 wish cannot be judged".to_owned(),
        n => format!("{n} wishes cannot be judged"),
    };
    let unjudged = after(&format!("{count}: "), &unjudged);
    let gone: Vec<String> = [absent, unjudged].into_iter().filter(|text| !text.is_empty()).collect();
    if is_realised && !gone.is_empty() {
        let text = format!("{} · {}{}", gone.join(" · "), ruling.text, waived(evidence));
        return Ruling { verdict: Verdict::Invalid, text, score: 0.0 };
    }
    let text = [vec![ruling.text], gone].concat().join(" · ") + &waived(evidence);
    Ruling { text, ..ruling }
}

/// Rules on the clauses alone, whatever of the request has none.
pub(crate) fn ruling_of_played(
    evidence: &Evidence<'_>,
    judged: &Judged,
    gaps: &Gaps,
    reference: Option<Verdict>,
) -> Ruling {
    let total = judged.deciding().count();
    let has_robot = evidence.recording.header.agents.iter().any(|info| info.agent == socrates_model::AgentId::Robot);
    let tally = tally(evidence, judged);
    let invalid = |why: String| Ruling { verdict: Verdict::Invalid, text: why, score: 0.0 };
    if evidence.proposal.is_none() && evidence.paths.is_none() {
        return invalid("nothing to verify: there is neither a proposal nor paths".to_owned());
    }
    if !has_robot {
        return invalid("nothing to verify: there is no robot in the recording".to_owned());
    }
    if total == 0 {
        return invalid("nothing to verify: no setup clause could be judged".to_owned());
    }
    if let Some(flaw) = judged.flaws.first() {
        let more = if judged.flaws.len() > 1 { format!(" and {} more", judged.flaws.len() - 1) } else { String::new() };
        return invalid(format!("the recording proves nothing: {}{more} · {tally}", flaw.text));
    }
    if let Some(first) = judged.uncovered.first() {
        let more = if judged.uncovered.len() > 1 {
            format!(" and {} more", judged.uncovered.len() - 1)
        } else {
            String::new()
        };
        return invalid(format!("unverifiable: {first}{more}"));
    }
    let standing = |wanted: Standing| judged.deciding().find(move |(_, finding)| finding.standing == wanted);
    // Where robot and human never met, whatever follows from it is no contradiction.
    let never_met = judged.deciding().any(|(clause, finding)| {
        matches!(clause.predicate, Predicate::Meets { .. }) && finding.standing == Standing::NotTriggered
    });
    let (never, fails) = (standing(Standing::NotTriggered), standing(Standing::Fails));
    let (own, culprit) = match (never, fails) {
        (Some(clause), _) if never_met => (Verdict::NotTriggered, Some(clause)),
        (_, Some(clause)) => (Verdict::Contradicted, Some(clause)),
        (Some(clause), None) => (Verdict::NotTriggered, Some(clause)),
        (None, None) if standing(Standing::Late).is_some() => (Verdict::RealisedLate, standing(Standing::Late)),
        (None, None) => (Verdict::Realised, None),
    };
    let lost = matches!(own, Verdict::NotTriggered | Verdict::Contradicted);
    let by_reference = matches!(reference, Some(Verdict::Realised | Verdict::RealisedLate));
    let prevented = lost && by_reference && !evidence.recording.header.planner.is_reference();
    let mut text = tally;
    // Whoever stands there all the time is met at no time of its own.
    let timed = gaps.iter().filter(|((human, _), _)| !evidence.stands(*human)).map(|(_, gap)| gap.abs());
    if let Some(gap) = timed.max_by(f64::total_cmp) {
        text.push_str(&format!(" · encounter gap {gap:.1} s"));
    }
    if let Some((clause, finding)) = culprit {
        text.push_str(&format!(" · {}: {}", clause.id, finding.evidence));
        if prevented {
            text.push_str(" · realised with the reference robot");
        }
    } else if let (Some(from), Some(to)) = times(judged) {
        text.push_str(&format!(" · seen from {from:.1} s to {to:.1} s"));
    }
    Ruling { verdict: if prevented { Verdict::RobotPrevented } else { own }, text, score: score(judged) }
}

/// Most quotes of a request beside a verdict; the rest is counted, and all of them stand in the reading.
const MOST_QUOTES: usize = 3;

/// The wishes that are not in the run, in the words of the request.
fn missing(evidence: &Evidence<'_>) -> Vec<String> {
    evidence.reading.map_or_else(Vec::new, socrates_model::Reading::missing)
}

/// The wishes that were given up: said beside every verdict, so that none is taken for more than it is.
fn waived(evidence: &Evidence<'_>) -> String {
    after(" · waived: ", &evidence.reading.map_or_else(Vec::new, socrates_model::Reading::waived))
}

/// The first quotes after an introduction; nothing where there are none.
fn after(introduction: &str, quotes: &[String]) -> String {
    if quotes.is_empty() { String::new() } else { format!("{introduction}{}", named(quotes)) }
}

/// The first quotes, and how many more there are.
fn named(quotes: &[String]) -> String {
    let first: Vec<String> = quotes.iter().take(MOST_QUOTES).map(|quote| format!("`{quote}`")).collect();
    let rest = quotes.len() - first.len();
    let more = if rest > 0 { format!(" and {rest} more") } else { String::new() };
    format!("{}{more}", first.join(", "))
}

/// How many wishes were seen, by how many setup clauses, how many of those late, and which could not be judged: none of those
/// counts as seen.
fn tally(evidence: &Evidence<'_>, judged: &Judged) -> String {
    let count = |wanted: Standing| judged.deciding().filter(|(_, finding)| finding.standing == wanted).count();
    let (late, unjudged) = (count(Standing::Late), judged.unjudged().count());
    let seen = count(Standing::Holds) + late;
    let mut text = format!("{seen} of {} setup clauses", judged.deciding().count() + unjudged);
    let wishes = wishes(evidence, judged);
    if !wishes.is_empty() {
        let shown = wishes.values().filter(|seen| **seen).count();
        text = format!("{shown} of {} wishes seen, by {text}", wishes.len());
    }
    if late > 0 {
        text.push_str(&format!(", {late} of them late"));
    }
    if let Some((clause, finding)) = judged.unjudged().next() {
        text.push_str(&format!(", {unjudged} not applicable: {}: {}", clause.id, finding.evidence));
    }
    text
}

/// The wishes that were not seen, in the words of the request.
fn unseen(evidence: &Evidence<'_>, judged: &Judged) -> Vec<String> {
    wishes(evidence, judged).into_iter().filter(|(_, seen)| !seen).map(|(wish, _)| wish.to_owned()).collect()
}

/// The wishes of the request that clauses tell of, and whether each was seen: facts that one piece of a text became are one wish, and so
/// are those of one line of a form. A wish is seen where every clause that has to hold for it was judged and holds.
fn wishes<'e>(evidence: &Evidence<'e>, judged: &Judged) -> BTreeMap<&'e str, bool> {
    let Some(reading) = evidence.reading else { return BTreeMap::new() };
    let told = |fact: &str| {
        let became = |statement: &&Statement| matches!(&statement.became, Became::Read { facts, .. } if facts.iter().any(|id| id == fact));
        reading.statements.iter().find(became).map(|statement| &*statement.quote)
    };
    let mut found: BTreeMap<&str, bool> = BTreeMap::new();
    for (clause, finding) in judged.deciding().chain(judged.unjudged()) {
        let Some(fact) = reading.facts.iter().find(|fact| fact.id == clause.source) else { continue };
        let seen = matches!(finding.standing, Standing::Holds | Standing::Late);
        let wish = told(&fact.id).unwrap_or(if fact.quote.is_empty() { &*fact.id } else { &*fact.quote });
        *found.entry(wish).or_insert(true) &= seen;
    }
    found
}

/// First and last time of the evidence of deciding clauses.
fn times(judged: &Judged) -> (Option<f64>, Option<f64>) {
    let all: Vec<f64> =
        judged.deciding().flat_map(|(_, finding)| finding.times_s.iter().copied()).filter(|t| *t > 0.0).collect();
    (all.iter().copied().min_by(f64::total_cmp), all.iter().copied().max_by(f64::total_cmp))
}

/// Score F: the product over must-clauses, times the mean of the others.
///
/// A must-clause that holds counts 1, a late one [`LATE_SHARE`], a missed one `2 / (1 + e^(-margin / scale))` with its
/// negative margin: below 1 and smaller the clearer it was missed. Others count `1 / (1 + e^(-margin / scale))`, taken
/// to 1 at a clear margin.
fn score(judged: &Judged) -> f64 {
    let logistic = |finding: &crate::fidelity::Finding| {
        let x = (finding.margin / finding.scale.max(1e-6)).clamp(-30.0, 30.0);
        1.0 / (1.0 + libm::exp(-4.0 * x))
    };
    let must: f64 = judged
        .deciding()
        .map(|(_, finding)| match finding.standing {
            Standing::Holds | Standing::NotApplicable => 1.0,
            Standing::Late => LATE_SHARE,
            Standing::NotTriggered | Standing::Fails => (2.0 * logistic(finding)).min(0.9),
        })
        .product();
    let others: Vec<f64> = judged
        .clauses
        .iter()
        .filter(|(clause, finding)| {
            clause.role == socrates_model::ClauseRole::Setup
                && !clause.must
                && finding.standing != Standing::NotApplicable
        })
        .map(|(_, finding)| logistic(finding))
        .collect();
    #[expect(clippy::cast_precision_loss, reason = "a proposal has few clauses")]
    let should = if others.is_empty() { 1.0 } else { others.iter().sum::<f64>() / others.len() as f64 };
    ((must * should).clamp(0.0, 1.0) * 1e4).round() / 1e4
}
