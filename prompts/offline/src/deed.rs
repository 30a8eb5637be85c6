//! From a deed to what the model knows: rules, relations, groups.

use socrates_model::{Action, Fault, FaultCode, Gesture, HumanId, PlaceClass, Relation, Rule, Trigger};

use crate::cast::{Cast, Person, ReadRule};
use crate::finish::does;
use crate::lasting::{always, whole};
use crate::lexicon::Act;
use crate::relation::{contradiction, relate, relation};
use crate::short;

/// What is known around a deed.
#[derive(Debug, Clone, Default)]
pub(crate) struct Around {
    /// When, as far as the text says.
    pub(crate) trigger: Option<Trigger>,
    /// The trigger names no distance: the one that suits the deed is taken.
    pub(crate) vague: bool,
    pub(crate) distance_m: Option<f64>,
    pub(crate) lasts_s: Option<f64>,
    pub(crate) gesture: Option<Gesture>,
    /// Another human who is followed.
    pub(crate) object: Option<HumanId>,
    pub(crate) place: Option<PlaceClass>,
    /// `startled`, not only `looks`.
    pub(crate) startled: bool,
    /// The deed belongs to the one before it: `stops and gestures`.
    pub(crate) goes_on: bool,
    /// It comes after what was said before: `and then`.
    pub(crate) then: bool,
    /// `stands there`: it was there already.
    pub(crate) stands: bool,
    /// `gives up`, `loses interest`
    pub(crate) gives_up: bool,
    pub(crate) quote: String,
}

/// Who is startled stares for so long, s.
pub(crate) const STARTLED_S: f64 = 8.0;
/// Who follows and then walks on follows for so long, s.
const FOLLOWS_S: f64 = 8.0;
/// Paces of whoever slows down and of whoever speeds up, m/s.
const SLOW_MPS: f64 = 0.6;
const FAST_MPS: f64 = 1.7;
/// Whoever comes very close to the robot comes as near as this, m.
const CLOSE_M: f64 = 0.8;
/// A group that makes room waits so long for the robot to pass, s.
const OPEN_S: f64 = 12.0;
/// Who stops and then looks stands so long before it looks, s.
const HALT_S: f64 = 2.0;

/// The triggers and durations that are taken where the text gives none.
pub(crate) fn manner(act: Act) -> Option<(Action, Trigger, Option<f64>, bool)> {
    Some(match act {
        Act::RunAway => (Action::RunAway, Trigger::RobotVisible(3.0), Some(6.0), true),
        Act::GiveWay => (Action::GiveWay, Trigger::RobotVisible(3.5), Some(6.0), true),
        // The blockade ends by itself, so that the robot can get on.
        Act::Block => (Action::Block, Trigger::RobotVisible(4.0), Some(8.0), true),
        Act::Look => (Action::LookAtRobot, Trigger::RobotVisible(4.0), Some(5.0), true),
        Act::Approach => (Action::Approach, Trigger::RobotVisible(5.0), Some(8.0), true),
        Act::Follow => (Action::FollowRobot, Trigger::RobotVisible(8.0), None, true),
        Act::Stop => (Action::StandStill, Trigger::RobotVisible(3.0), Some(5.0), true),
        Act::TurnBack => (Action::TurnBack, Trigger::RobotVisible(4.0), None, true),
        Act::SlowDown => (Action::ChangePace(SLOW_MPS), Trigger::RobotVisible(5.0), None, true),
        Act::SpeedUp => (Action::ChangePace(FAST_MPS), Trigger::RobotVisible(5.0), None, true),
        Act::ComeClose => (Action::ApproachTo(CLOSE_M), Trigger::RobotVisible(5.0), Some(8.0), true),
        Act::OpenUp => (Action::MakeRoom, Trigger::RobotVisible(3.5), Some(OPEN_S), true),
        Act::Toward
        | Act::Overtake
        | Act::Behind
        | Act::Abreast
        | Act::Ahead
        | Act::Cross
        | Act::ComeOut
        | Act::Stay
        | Act::Enter
        | Act::Talk
        | Act::WalkTogether
        | Act::Stand
        | Act::Ignore
        | Act::Gesture
        | Act::Lead
        | Act::Pass
        | Act::GoOn
        | Act::Walk
        | Act::Aside => return None,
    })
}

/// Words for the reading line.
pub(crate) fn words(act: Act, around: &Around) -> String {
    let place = |class: Option<PlaceClass>, other: &str| {
        class.map_or_else(|| other.to_owned(), |class| class.name().replace('_', " "))
    };
    match act {
        Act::RunAway => "runs away".into(),
        Act::GiveWay => "gives way".into(),
        Act::Block => "blocks the robot".into(),
        Act::Look if around.startled => "startled".into(),
        Act::Look if around.object.is_some() => around.object.map_or_else(String::new, |id| format!("looks at {id}")),
        Act::Look => "looks at the robot".into(),
        Act::Approach => "comes up to the robot".into(),
        Act::Toward => "comes towards the robot".into(),
        Act::Overtake => "overtakes the robot".into(),
        Act::Behind => "comes from behind".into(),
        Act::Abreast => "walks beside the robot".into(),
        Act::Ahead => "walks ahead of the robot".into(),
        Act::Follow => around.object.map_or_else(|| "follows the robot".into(), |id| format!("follows {id}")),
        Act::Cross => "crosses".into(),
        Act::ComeOut if around.place == Some(PlaceClass::Elevator) => "leaves the elevator".into(),
        Act::ComeOut => format!("comes out of the {}", place(around.place, "room")),
        Act::Stay => "stays".into(),
        Act::Talk => "talks".into(),
        Act::WalkTogether => "walks in a group".into(),
        Act::Stop => "stops".into(),
        Act::Stand => "stands".into(),
        Act::Ignore => "ignores the robot".into(),
        Act::Gesture => around.gesture.map_or_else(String::new, |gesture| format!("gestures {gesture}")),
        Act::Enter => format!("goes into the {}", place(around.place, "room")),
        Act::Lead => "leads".into(),
        Act::GoOn => "walks on".into(),
        Act::Pass | Act::Walk => "walks".into(),
        Act::TurnBack => "turns back".into(),
        Act::SlowDown => "slows down".into(),
        Act::SpeedUp => "speeds up".into(),
        Act::Aside => "stands beside the robot's way".into(),
        Act::ComeClose => "comes very close to the robot".into(),
        Act::OpenUp => "makes room and closes up again".into(),
    }
}

/// `He blocks it. After ten seconds he steps aside.`: so long after that began, not after the start of the run.
fn since_last(cast: &mut Cast, who: usize, act: Act, around: &Around) -> Option<(Act, Around)> {
    let Some(Trigger::AfterSecs(secs)) = around.trigger else { return None };
    let person = cast.people.get_mut(who)?;
    let stands = matches!(person.relation, Some((Relation::Static, _)));
    let last = person.rules.last_mut()?;
    let [when] = last.rule.when.as_slice() else { return None };
    let waits = !matches!(when, Trigger::Always | Trigger::AfterSecs(_))
        && (last.rule.act != Action::Navigate || last.rule.gesture.is_some())
        && (!last.lasts || last.rule.for_s == Some(secs))
        // `is waiting at a doorway; after ten seconds he walks on`: it waits from the start of the run on.
        && !(last.rule.act == Action::StandStill && !last.stated && stands);
    // `after 15 s she stops and stands still`: both then.
    let again = last.quote == around.quote || manner(act).is_some_and(|(action, ..)| action == last.rule.act);
    if !waits && !again || around.gives_up {
        return None;
    }
    let walks = matches!(act, Act::Walk | Act::Pass | Act::GoOn);
    let trigger = (!walks).then(|| when.clone());
    if !again {
        (last.rule.for_s, last.lasts) = (Some(secs), true);
        // Who signals twice stays there in between.
        if act == Act::Gesture && last.rule.act == Action::Navigate {
            last.rule.act = Action::StandStill;
        }
    }
    let act = if walks { Act::GoOn } else { act };
    Some((act, Around { trigger, vague: false, then: !again, goes_on: again, ..around.clone() }))
}

/// Applies a deed to one human. Returns the index of the rule it made.
pub(crate) fn apply(cast: &mut Cast, who: usize, act: Act, around: &Around) -> Option<usize> {
    let later = since_last(cast, who, act, around);
    let (act, around) = later.as_ref().map_or((act, around), |(act, around)| (*act, around));
    let doing = words(act, around);
    if let Some(person) = cast.people.get_mut(who)
        && !person.doings.contains(&doing)
        && !doing.is_empty()
    {
        person.doings.push(doing);
    }
    let inside = matches!(around.place, Some(PlaceClass::Room | PlaceClass::Elevator));
    let left_inside = inside || cast.people.iter().any(leaves);
    // `comes out, freezes and stays like that`
    let halted = cast.people.get(who).is_some_and(|person| {
        leaves(person)
            && person.rules.last().is_some_and(|last| matches!(last.rule.act, Action::StandStill | Action::LookAtRobot))
    });
    let act = if act == Act::Stay && (!left_inside || halted) {
        // `stays where she is` without anybody leaving is standing still.
        if cast.people.get(who).is_some_and(|p| p.relation.is_none()) {
            relate(cast, who, Relation::Static, &around.quote);
        }
        if let Some(person) = cast.people.get_mut(who).filter(|_| !halted) {
            person.stays = Some(around.quote.clone());
        }
        Act::Stop
    } else {
        act
    };
    if act == Act::Stop
        && around.stands
        && cast.people.get(who).is_some_and(|p| p.relation.is_none() && p.rules.is_empty())
    {
        relate(cast, who, Relation::Static, &around.quote);
    }
    // `walks behind the robot, in its direction`
    let same_way = act == Act::Ahead
        && around.quote.contains("direction")
        && !["ahead", "front"].iter().any(|word| around.quote.contains(word))
        && cast.people.get(who).is_some_and(|person| person.relation.is_some() || does(person, &Action::FollowRobot));
    if same_way {
        return None;
    }
    // Who walks along talks on the way.
    let walks =
        |person: &Person| person.relation.is_some() || person.doings.iter().any(|doing| doing.starts_with("walks"));
    let person = cast.people.get(who);
    // `when 4 m away they form a line`: they came from where they came.
    let then = matches!(relation(act), Some(Relation::Static | Relation::Ahead))
        && around.trigger.is_some()
        && person
            .is_some_and(|person| person.relation.is_some() || act == Act::Ahead && does(person, &Action::FollowRobot));
    let on_the_way = act == Act::Talk && person.is_some_and(walks) || then;
    // `waits in the elevator`, `stand in the lift and talk`
    let in_elevator = matches!(act, Act::Stand | Act::Talk | Act::Stop)
        && around.place == Some(PlaceClass::Elevator)
        && crate::whereabouts::in_car(&around.quote)
        && cast.people.get(who).is_some_and(|person| person.relation.is_none());
    if in_elevator {
        relate(cast, who, Relation::Staying, &around.quote);
    } else if let Some(relation) = relation(act).filter(|_| !on_the_way) {
        relate(cast, who, relation, &around.quote);
    }
    let person = cast.people.get_mut(who)?;
    if in_elevator {
        person.start = around.place;
    }
    if matches!(act, Act::ComeOut | Act::Stay) && around.place.is_some() {
        person.start = around.place;
    }
    if act == Act::Enter {
        person.goal = around.place.filter(|class| matches!(class, PlaceClass::Room | PlaceClass::Elevator));
    }
    if matches!(act, Act::Walk | Act::Pass | Act::GoOn) || relation(act).is_some() && goes(act) {
        let answers = |trigger: &Trigger| {
            matches!(
                trigger,
                Trigger::RobotSays(_) | Trigger::HumanSays(..) | Trigger::RobotStopped | Trigger::AfterSecs(_)
            ) || act == Act::GoOn && *trigger == Trigger::RobotMoving
                || matches!(act, Act::GoOn | Act::Walk) && *trigger == Trigger::RobotPassed
        };
        if let Some(trigger) = around.trigger.clone().filter(answers) {
            walk_on(cast, who, trigger, &around.quote);
        } else if act == Act::GoOn {
            goes_on(cast, who, around);
        }
    }
    // `tags along behind it until it says wait`
    if act == Act::Follow && around.object.is_none() && around.trigger.is_none() && around.quote.contains("behind") {
        let open = cast.people.get(who).is_some_and(|person| person.relation.is_none());
        if open {
            relate(cast, who, Relation::Behind, &around.quote);
        }
    }
    // Who follows stays behind; who overtakes does so no longer.
    if act == Act::Overtake && around.trigger.is_none() {
        let behind = |read: &ReadRule| follows_on(read) && read.rule.act == Action::FollowRobot && !read.stated;
        let rules = &mut cast.people.get_mut(who)?.rules;
        if rules.iter().any(behind) {
            rules.retain(|read| !behind(read));
            cast.notes.push(format!(
                "`{}`: human_{} comes from behind and passes the robot, so it does not follow it all the time",
                around.quote,
                who + 1
            ));
        }
    }
    // `overtakes it, comes back and follows it`: who has overtaken is no longer behind.
    let overtook =
        cast.people.get(who).is_some_and(|person| person.doings.iter().any(|doing| doing == "overtakes the robot"));
    if act == Act::Follow && overtook && around.object.is_none() {
        let what = format!("human_{} overtakes the robot; that it follows it afterwards", who + 1);
        short::unplayed(&mut cast.problems, &around.quote, &what);
        cast.people.get_mut(who)?.doings.retain(|doing| doing != "follows the robot");
        return None;
    }
    // `follows it until it stops, then overtakes it`
    let trails = cast.people.get(who).is_some_and(|person| does(person, &Action::FollowRobot));
    if act == Act::Overtake && around.trigger.is_some() && trails {
        let what = format!("human_{} walks on then; that it gets past the robot", who + 1);
        short::unplayed(&mut cast.problems, &around.quote, &what);
    }
    let excepting = cast.excepting;
    // `A nurse asks a patient to follow her. He follows her.`
    let called = around.object.filter(|id| {
        let asker = usize::try_from(id.number()).ok().and_then(|n| cast.people.get(n.checked_sub(1)?));
        asker.is_some_and(|asker| asker.rules.iter().any(|read| read.rule.gesture == Some(Gesture::FollowMe)))
    });
    let person = cast.people.get_mut(who)?;
    // `stands there for the whole run`, and moves all the same
    let still = person.still.clone().filter(|_| {
        let moves = matches!(
            act,
            Act::Follow | Act::GoOn | Act::Walk | Act::Approach | Act::GiveWay | Act::RunAway | Act::Overtake
        );
        !excepting && (goes(act) || moves)
    });
    let never_walks = person.never.iter().find(|(never, quote)| {
        matches!(never, Act::Walk | Act::GoOn)
            && matches!(act, Act::Walk | Act::GoOn | Act::GiveWay | Act::RunAway | Act::Approach | Act::Follow)
            && !excepting
            && always(quote)
    });
    if let Some(first) = still.or_else(|| never_walks.map(|(_, quote)| quote.clone())) {
        cast.problems.push(contradiction(who, &first, &around.quote));
        return None;
    }
    if act == Act::Ignore && always(&around.quote) {
        person.never.push((Act::Look, around.quote.clone()));
    }
    if matches!(act, Act::Stop | Act::Stand) && whole(&around.quote) {
        let walks = person.relation.as_ref().filter(|(relation, _)| {
            matches!(
                relation,
                Relation::Frontal | Relation::Crossing | Relation::Behind | Relation::Ahead | Relation::Abreast
            )
        });
        if let Some((_, first)) = walks.filter(|(_, first)| !excepting && *first != around.quote) {
            let first = first.clone();
            cast.problems.push(contradiction(who, &first, &around.quote));
            return None;
        }
        person.still = Some(around.quote.clone());
    }
    let moves = !matches!(act, Act::Talk | Act::Stand | Act::Pass | Act::Walk | Act::GoOn | Act::WalkTogether);
    person.bound |= moves;
    // `gives up after 10 seconds of following`
    if let (true, Some(Trigger::AfterSecs(secs))) = (around.gives_up, &around.trigger)
        && let Some(last) =
            person.rules.last_mut().filter(|last| matches!(last.rule.act, Action::FollowRobot | Action::FollowHuman(_)))
    {
        (last.rule.for_s, last.lasts) = (Some(*secs), true);
        return None;
    }
    if act == Act::Gesture {
        return gesture(person, around);
    }
    let (action, usual, lasts, latched) = manner(act)?;
    // `only when it asks does he move` is no contradiction to `he does not move`; to `he never moves` it is.
    let never = person
        .never
        .iter()
        .find(|(other, quote)| *other == act && (around.trigger.is_none() || !excepting && always(quote)));
    if let Some((_, never)) = never {
        let never = never.clone();
        cast.problems.push(contradiction(who, &never, &around.quote));
        return None;
    }
    // `stands in its way and does not move for ten seconds`
    if act == Act::Stop
        && around.trigger.is_none()
        && let Some(last) = person.rules.last_mut().filter(|last| around.goes_on && last.rule.act == Action::Block)
    {
        if around.lasts_s.is_some() {
            (last.rule.for_s, last.lasts) = (around.lasts_s, true);
        }
        return None;
    }
    if let (Some(gesture), Some(last)) = (around.gesture, person.rules.last_mut())
        && around.goes_on
        && last.rule.act == action
    {
        last.rule.gesture = Some(gesture);
        return None;
    }
    let action = match (action, around.object) {
        (Action::FollowRobot, Some(id)) => Action::FollowHuman(id),
        (Action::LookAtRobot, Some(id)) => Action::LookAt(id),
        (other, _) => other,
    };
    let when = match (&around.trigger, &usual) {
        (Some(Trigger::RobotVisible(_)), Trigger::RobotVisible(_)) if around.vague => usual,
        (Some(said), _) => said.clone(),
        (None, _) if matches!(action, Action::FollowHuman(_)) => {
            called.map_or(Trigger::Always, |id| Trigger::HumanSays(id, Gesture::FollowMe))
        }
        // `follows at 2 m` says how far behind, not when.
        (None, _) if act == Act::Follow => usual,
        (None, _) => match around.distance_m {
            Some(m) => usual.at_distance(m),
            None => usual,
        },
    };
    let lasts = around.lasts_s.or(if around.startled { Some(STARTLED_S) } else { lasts });
    let rule = Rule { when: vec![when], act: action, gesture: None, for_s: lasts, latched, ..Rule::default() };
    let stated = around.trigger.is_some() || around.distance_m.is_some();
    let exact = around.distance_m.is_some() || around.trigger.is_some() && !around.vague;
    let read = ReadRule {
        rule,
        quote: around.quote.clone(),
        stated,
        exact,
        then: around.then,
        lasts: around.lasts_s.is_some(),
    };
    // `stops and looks`: the look begins when the stop ends, so it waits for the same.
    let stopped =
        person.rules.last().filter(|last| act == Act::Look && around.goes_on && last.rule.act == Action::StandStill);
    if let Some(kept) = stopped.map(|last| last.rule.when.clone()).filter(|_| !stated) {
        let mut read = read;
        read.rule.when = kept;
        if let Some(last) = person.rules.last_mut().filter(|last| !last.lasts) {
            last.rule.for_s = Some(HALT_S);
        }
        person.rules.push(read);
        return Some(person.rules.len() - 1);
    }
    Some(once(person, read))
}

/// Deeds by which somebody gets somewhere.
const fn goes(act: Act) -> bool {
    matches!(act, Act::Toward | Act::Overtake | Act::Cross | Act::ComeOut | Act::Ahead | Act::Behind)
}

/// After what it did before it walks on.
fn goes_on(cast: &mut Cast, who: usize, around: &Around) {
    let Some(person) = cast.people.get_mut(who) else { return };
    // The last of all that it does, whatever is said of it yet; who only walks along goes on by itself.
    if !person.rules.is_empty() || around.trigger.is_some() || person.doings.len() > 1 {
        person.goes_on = Some(around.quote.clone());
    }
    // `follows it and then walks on`: it follows no longer then.
    if let Some(last) = person.rules.last_mut().filter(|last| around.then && follows_on(last)) {
        last.rule.for_s = Some(FOLLOWS_S);
    }
}

/// Whether somebody follows without an end.
fn follows_on(read: &ReadRule) -> bool {
    matches!(read.rule.act, Action::FollowRobot | Action::FollowHuman(_)) && read.rule.for_s.is_none()
}

/// The rule by which somebody walks on after everything else, where the text says so.
pub(crate) fn settle_going_on(person: &mut Person) {
    let Some(quote) = person.goes_on.take() else { return };
    if person.rules.iter().any(|read| read.rule.act == Action::Navigate && read.rule.gesture.is_none()) {
        return;
    }
    // Whoever follows walks on by following.
    if person.rules.last().is_some_and(follows_on) {
        return;
    }
    let last = person.rules.last().map(|last| last.rule.when.clone());
    let when = last.unwrap_or_else(|| vec![Trigger::RobotVisible(5.0)]);
    let rule = Rule { when, act: Action::Navigate, gesture: None, for_s: None, latched: true, ..Rule::default() };
    person.rules.push(ReadRule { rule, quote, stated: false, exact: false, then: true, lasts: false });
}

/// From a trigger on it walks on, whatever it did before.
pub(crate) fn walk_on(cast: &mut Cast, who: usize, when: Trigger, quote: &str) {
    let Some(person) = cast.people.get_mut(who) else { return };
    let rule =
        Rule { when: vec![when], act: Action::Navigate, gesture: None, for_s: None, latched: true, ..Rule::default() };
    let read = ReadRule { rule, quote: quote.to_owned(), stated: true, exact: true, then: false, lasts: false };
    // Earlier rules win: what ends the others stands before them.
    if !person.rules.contains(&read) {
        person.rules.insert(0, read);
    }
}

/// Until a rule begins, so many seconds after what it waits for, it goes on as before. Returns the rule's new index.
pub(crate) fn delay(cast: &mut Cast, who: usize, rule: usize, secs: f64) -> Option<usize> {
    let person = cast.people.get_mut(who)?;
    let late = person.rules.get(rule)?.clone();
    let on = Rule { act: Action::Navigate, gesture: None, for_s: Some(secs), latched: true, ..late.rule.clone() };
    person.rules.insert(rule, ReadRule { rule: on, stated: false, then: false, lasts: true, ..late });
    Some(rule + 1)
}

/// Takes back what the clause before said of somebody who is excepted from it.
pub(crate) fn except(cast: &mut Cast, who: usize, rules: &[usize]) {
    let Some(person) = cast.people.get_mut(who) else { return };
    let mut at = 0;
    person.rules.retain(|_| {
        at += 1;
        !rules.contains(&(at - 1))
    });
    person.doings.pop();
    if rules.is_empty() {
        person.relation = None;
    }
    person.bound = true;
}

/// `never follows it`: remembered, and held against what was said before.
pub(crate) fn rule_out(cast: &mut Cast, who: usize, act: Act, quote: &str) {
    let Some(person) = cast.people.get_mut(who) else { return };
    person.never.push((act, quote.to_owned()));
    let meeting =
        ["never meet", "not meet", "stays away", "never comes near"].iter().any(|words| quote.contains(words));
    if meeting {
        cast.problems.push(Fault::new(
            FaultCode::PRead,
            "rough_scenario",
            format!(
                "`{quote}`: a scenario is a meeting of people and the robot; that somebody never meets it is not played"
            ),
        ).about([quote]));
        return;
    }
    if act == Act::ComeOut && person.relation.is_none() {
        // `nobody gets out`
        relate(cast, who, Relation::Staying, quote);
        return;
    }
    let Some((action, ..)) = manner(act) else { return };
    // `tells it to go ahead and does not stop`: it says so as it walks.
    if act == Act::Stop {
        let says =
            |read: &&mut ReadRule| read.rule.act == Action::StandStill && read.rule.gesture == Some(Gesture::Proceed);
        for read in person.rules.iter_mut().filter(says) {
            read.rule.act = Action::Navigate;
        }
    }
    if let Some(read) = person.rules.iter().find(|read| read.rule.act == action) {
        let said = read.quote.clone();
        cast.problems.push(contradiction(who, &said, quote));
    }
}

/// Adds a rule, unless the text only says again what another rule holds already: `is surprised, stops and looks`.
fn once(person: &mut Person, read: ReadRule) -> usize {
    // `until it says EXCUSE_ME, whereupon he gives way`: what is done then is more than walking on.
    let walks = |old: &ReadRule| {
        old.rule.act == Action::Navigate && old.rule.gesture.is_none() && old.rule.when == read.rule.when
    };
    if let Some(at) = person.rules.iter().position(walks).filter(|_| !read.then) {
        if let Some(old) = person.rules.get_mut(at) {
            *old = read;
        }
        return at;
    }
    // `blocks it, holding this position for 15 seconds`
    let longer = person.rules.iter_mut().rev().find(|old| {
        old.rule.act == read.rule.act
            && old.rule.gesture.is_none()
            && !old.lasts
            && read.lasts
            && !read.then
            && (!read.stated || old.rule.when == read.rule.when)
    });
    if let Some(old) = longer {
        (old.rule.for_s, old.lasts) = (read.rule.for_s, true);
    }
    let again = person.rules.iter().position(|old| {
        old.rule.act == read.rule.act
            && old.rule.gesture.is_none()
            && !read.then
            && (old.rule.when == read.rule.when || !read.stated)
    });
    again.unwrap_or_else(|| {
        person.rules.push(read);
        person.rules.len() - 1
    })
}

fn gesture(person: &mut Person, around: &Around) -> Option<usize> {
    let gesture = around.gesture?;
    if let Some(last) = person.rules.last_mut().filter(|last| around.goes_on && last.rule.gesture.is_none()) {
        last.rule.gesture = Some(gesture);
        return None;
    }
    // Whoever lets the robot go first stands still for it; whoever stops it walks on.
    let (act, lasts) = match gesture {
        Gesture::Proceed => (Action::StandStill, 6.0),
        Gesture::Wait | Gesture::ExcuseMe | Gesture::FollowMe => (Action::Navigate, 4.0),
        // Whoever acknowledges the robot looks at it.
        Gesture::Acknowledged => (Action::LookAtRobot, 4.0),
    };
    let when = around.trigger.clone().unwrap_or_else(|| Trigger::RobotVisible(around.distance_m.unwrap_or(5.0)));
    let rule = Rule {
        when: vec![when],
        act,
        gesture: Some(gesture),
        for_s: Some(around.lasts_s.unwrap_or(lasts)),
        latched: true,
        ..Rule::default()
    };
    person.rules.push(ReadRule {
        rule,
        quote: around.quote.clone(),
        stated: around.trigger.is_some(),
        exact: false,
        then: around.then,
        lasts: around.lasts_s.is_some(),
    });
    Some(person.rules.len() - 1)
}

fn leaves(person: &Person) -> bool {
    person.relation.as_ref().is_some_and(|(relation, _)| *relation == Relation::Leaving)
}
