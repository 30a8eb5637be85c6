//! What is asked for while something lasts: who is to stand while the robot moves stands for most of that time, and not
//! only at its beginning.

use socrates_model::report::Standing;
use socrates_model::{Action, FactKind, HumanId, Trigger};

use crate::fidelity::finding::Finding;
use crate::fidelity::reactions::{has_onset, holds};
use crate::fidelity::signals::{MOMENT_SECS, Moment, Signals};
use crate::tracks::MOVING_MPS;

/// Share of the time for which a state must be kept.
const SHARE: f64 = 0.7;
/// It takes so long to come to a stand, s: that time does not count.
const HALT_SECS: f64 = 1.0;
/// Of less time than this nothing can be said, s.
const LEAST_SECS: f64 = 2.0;
/// Words of a request that tell how long somebody stands: then it is asked for so long, and not for as long as it lasts.
const LENGTHS: [&str; 4] = ["second", "minute", "moment", "brief"];

/// Whether a reaction is a state that has to last as long as its trigger.
fn lasts(signals: &Signals<'_>, human: HumanId, when: &[Trigger], act: &Action) -> bool {
    let timed = |quote: &str| {
        let quote = quote.to_lowercase();
        quote.contains(|c: char| c.is_ascii_digit()) || LENGTHS.iter().any(|word| quote.contains(word))
    };
    let facts = signals.evidence.reading.map_or(&[][..], |reading| &reading.facts);
    *act == Action::StandStill
        && when.contains(&Trigger::RobotMoving)
        && !facts.iter().any(|fact| {
            let of =
                matches!(&fact.kind, FactKind::Reacts { human: who, rule } if *who == human && rule.act == Action::StandStill);
            of && timed(&fact.quote)
        })
}

/// The finding of a reaction, and of how long it was kept where it has to last.
pub(super) fn kept(signals: &Signals<'_>, human: HumanId, when: &[Trigger], act: &Action, found: Finding) -> Finding {
    if !matches!(found.standing, Standing::Holds | Standing::Late) || !lasts(signals, human, when, act) {
        return found;
    }
    let rules = signals.evidence.proposal.and_then(|proposal| proposal.human(human)).map_or(&[][..], |one| &one.rules);
    // Earlier rules win: while they run nobody can keep this one. Who just walks does so by no rule.
    let busy = |moment: &Moment| {
        let mut spans = signals.leaves_of(human).iter().filter(|span| moment.t >= span.from_s && moment.t <= span.to_s);
        spans.any(|span| {
            let mut earlier =
                rules.iter().take_while(|rule| rule.act != *act).filter(|rule| rule.act.is_leaf(&span.name));
            earlier.any(|rule| has_onset(&rule.act) || holds(signals, human, &rule.when, moment))
        })
    };
    let (mut since, mut asked_s, mut kept_s) = (None, 0.0, 0.0);
    let mut worst_s = None;
    for moment in signals.of(human) {
        if !holds(signals, human, when, moment) || !moment.sight.unwrap_or(true) || busy(moment) {
            since = None;
            continue;
        }
        if moment.t - *since.get_or_insert(moment.t) < HALT_SECS {
            continue;
        }
        asked_s += MOMENT_SECS;
        if moment.human.speed() < MOVING_MPS {
            kept_s += MOMENT_SECS;
        } else {
            worst_s = worst_s.or(Some(moment.t));
        }
    }
    if asked_s < LEAST_SECS {
        return found;
    }
    let margin = kept_s / asked_s - SHARE;
    let text = format!(
        "{}, for {kept_s:.1} s of the {asked_s:.1} s in which the robot moves in its sight (at least {:.0} % asked)",
        found.evidence,
        SHARE * 100.0
    );
    if margin >= 0.0 {
        return Finding { evidence: text, ..found };
    }
    Finding::fails(margin, worst_s.into_iter().chain(found.times_s).collect(), text)
}
