//! Monitors of whoever is beside the robot's line: gives way, makes room and closes up again, or stands aside all the time.

use socrates_model::{Action, HumanId};

use crate::fidelity::acts::ASIDE_M;
use crate::fidelity::finding::Finding;
use crate::fidelity::meeting::absent;
use crate::fidelity::signals::{Moment, Signals};
use crate::fidelity::since::{Since, since_act};

/// Somebody who gives way goes so far by themselves, and so much farther off the robot's line, m.
const GOES_M: f64 = 0.2;
const OFF_LINE_M: f64 = 0.15;
/// The robot passes somebody within this distance, m.
const PASSES_M: f64 = 3.0;
/// Somebody has closed up again this near to where they stood, m, so long after the robot has passed at most, s.
const BACK_M: f64 = 0.7;
const BACK_SECS: f64 = 10.0;
/// A bystander goes this far at most, m; the robot comes within `SEEN_M` of them and never within `CLEAR_M`, m.
const STIRS_M: f64 = 0.5;
const SEEN_M: f64 = 8.0;
const CLEAR_M: f64 = 0.9;

/// How far a human goes by themselves until the robot passes, and how much farther from its line they are then than when they
/// were nearest to it, m: from the line on which it passes, or from its intended way. A robot that swerves adds nothing to it.
fn went_aside(moments: &[Moment], passing: &Moment) -> (f64, f64) {
    let before = || moments.iter().take_while(|moment| moment.t <= passing.t);
    let Some(begin) = moments.first() else { return (0.0, 0.0) };
    let own_m = before().map(|moment| (moment.human.at - begin.human.at).norm()).fold(0.0, f64::max);
    let least = |of: &dyn Fn(&Moment) -> f64| before().map(of).fold(f64::INFINITY, f64::min);
    let line = |moment: &Moment| passing.robot.facing().perp(&(moment.human.at - passing.robot.at)).abs();
    let way = |moment: &Moment| moment.way.map_or(0.0, |(_, off)| off);
    let off_m = [line(passing) - least(&line), way(passing) - least(&way)];
    (own_m, off_m.into_iter().fold(0.0, f64::max))
}

/// How somebody is beside the robot's line as it passes.
struct Passed {
    at_s: f64,
    /// How far beside the line on which it passes, or beside its intended way, m.
    aside_m: f64,
    /// How far they went for it, and how much farther off the line that led them, m.
    own_m: f64,
    off_m: f64,
}

impl Passed {
    /// How clearly they went for it.
    fn moved(&self) -> f64 {
        (self.own_m - GOES_M).min(self.off_m - OFF_LINE_M)
    }

    fn told(&self, human: HumanId) -> String {
        format!(
            "{human} {:.2} m beside the robot's line as it passes at {:.1} s ({ASIDE_M} m asked), having gone {:.2} m and {:.2} m off \
             it ({GOES_M} m and {OFF_LINE_M} m asked)",
            self.aside_m, self.at_s, self.own_m, self.off_m
        )
    }
}

/// How the robot passes somebody who makes way for it by an act, from the reason for it on.
fn passed(signals: &Signals<'_>, human: HumanId, act: &Action) -> Result<(Since, Passed), Finding> {
    if let Some(found) = absent(signals, human) {
        return Err(found);
    }
    let since = since_act(signals, human, act)?;
    let moments = since.moments(signals.of(human));
    let passing = moments
        .iter()
        .zip(moments.iter().skip(1))
        .filter(|(a, b)| a.ahead_m > 0.0 && b.ahead_m <= 0.0 && b.distance_m <= PASSES_M)
        .map(|(_, b)| b)
        .min_by(|a, b| a.distance_m.total_cmp(&b.distance_m));
    let Some(moment) = passing else {
        let nearest = moments.iter().min_by(|a, b| a.distance_m.total_cmp(&b.distance_m));
        let text = nearest.map_or_else(String::new, |at| format!(", closest {:.1} m at {:.1} s", at.distance_m, at.t));
        return Err(Finding::never(-ASIDE_M, vec![], format!("the robot never passed {human}{text}")));
    };
    // What they did before their tree had them give way is none of it.
    let by_tree = signals.leaves_of(human).iter().filter(|span| act.is_leaf(&span.name));
    let begins_s = by_tree.map(|span| span.from_s).find(|t| *t <= moment.t && since.counts(*t));
    let begins = moments.partition_point(|other| begins_s.is_some_and(|t| other.t < t));
    let (own_m, off_m) = went_aside(moments.get(begins..).unwrap_or_default(), moment);
    // A robot that swerves towards somebody who has made way takes nothing from it either.
    let aside_m = moment.way.map_or(0.0, |(_, off)| off).max(moment.left_m.abs());
    Ok((since, Passed { at_s: moment.t, aside_m, own_m, off_m }))
}

/// The human is beside the robot's line as the robot passes, and has gone there.
pub(super) fn gives_way(signals: &Signals<'_>, human: HumanId) -> Finding {
    match passed(signals, human, &Action::GiveWay) {
        Ok((_, pass)) => {
            let margin = (pass.aside_m - ASIDE_M).min(pass.moved());
            Finding::by_margin(margin, vec![pass.at_s], pass.told(human))
        }
        Err(finding) => finding,
    }
}

/// The human makes way as the robot passes, and closes up again: everybody of a group goes for it.
pub(super) fn makes_room(signals: &Signals<'_>, human: HumanId) -> Finding {
    let (since, pass) = match passed(signals, human, &Action::MakeRoom) {
        Ok(found) => found,
        Err(finding) => return finding,
    };
    let Some(track) = signals.tracks.human(human) else { return Finding::not_applicable("nobody is recorded") };
    let stood = track.at(since.secs().max(0.0)).or_else(|| track.samples.first().copied());
    let Some(stood) = stood else { return Finding::not_applicable("the recording is empty") };
    let after = track.present().filter(|sample| sample.t >= pass.at_s && sample.t <= pass.at_s + BACK_SECS);
    let nearest = after
        .map(|sample| ((sample.at - stood.at).norm(), sample.t))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap_or((f64::INFINITY, pass.at_s));
    let back = BACK_M - nearest.0;
    let text = format!(
        "{}; back within {:.2} m of where they stood at {:.1} s ({BACK_M} m within {BACK_SECS:.0} s asked)",
        pass.told(human),
        nearest.0,
        nearest.1
    );
    Finding::by_margin((pass.aside_m - ASIDE_M).min(pass.moved()).min(back), vec![nearest.1, pass.at_s], text)
}

/// The human stands beside the robot's way all the time.
pub(super) fn stays_aside(signals: &Signals<'_>, human: HumanId) -> Finding {
    if let Some(found) = absent(signals, human) {
        return found;
    }
    let moments = signals.of(human);
    let near =
        |of: &dyn Fn(&&Moment) -> bool| moments.iter().filter(of).min_by(|a, b| a.distance_m.total_cmp(&b.distance_m));
    let (Some(closest), Some(first)) = (near(&|_| true), moments.first()) else {
        return Finding::not_applicable("the recording is empty");
    };
    // Behind a wall nobody is beside the robot's way.
    let Some(nearest) = near(&|moment| moment.sight != Some(false)) else {
        let text = format!(
            "a wall is between {human} and the robot all the time, {:.2} m apart at {:.1} s; who stands aside is seen from its way",
            closest.distance_m, closest.t
        );
        return Finding::never(-1.0, vec![], text);
    };
    let rules = signals.evidence.proposal.and_then(|proposal| proposal.human(human)).map_or(&[][..], |one| &one.rules);
    let led = rules.iter().any(|rule| !rule.act.stands());
    let stirs_m = moments.iter().map(|moment| (moment.human.at - first.human.at).norm()).fold(0.0, f64::max);
    let text = format!(
        "{human} goes {stirs_m:.2} m (at most {STIRS_M} m{}); the robot comes within {:.2} m at {:.1} s ({CLEAR_M} to {SEEN_M} m asked)",
        if led { ", not asked of whom an act leads" } else { "" },
        nearest.distance_m,
        nearest.t
    );
    let still = if led { f64::INFINITY } else { STIRS_M - stirs_m };
    let margin = still.min(nearest.distance_m - CLEAR_M).min(SEEN_M - nearest.distance_m);
    Finding::by_margin(margin, vec![nearest.t], text)
}
