//! What the text says of the robot.

use socrates_model::{AgentId, PlaceClass, Relation};

use crate::clause::Found;
use crate::deed::{self, Around};
use crate::lexicon::Act;
use crate::order;
use crate::relation;
use crate::story::Story;

/// The robot's own deeds: what they ask of people, of the places, of its script.
pub(crate) fn robot_deed(story: &mut Story, act: Act, found: &Found, object: &[usize], quote: &str) {
    let class = found.places.first().map(|(class, _)| *class);
    let set = |story: &mut Story, relation: Relation| {
        for who in object {
            relation::relate(&mut story.cast, *who, relation, quote);
            let doing = if relation == Relation::Ahead { "walks ahead of the robot" } else { "walks beside the robot" };
            if let Some(person) = story.cast.people.get_mut(*who) {
                person.doings.retain(|known| known != doing && known != "walks");
                person.doings.push(doing.to_owned());
            }
        }
    };
    if matches!(act, Act::Walk | Act::Pass | Act::Toward | Act::Approach | Act::Cross) {
        story.on_its_way.push(act);
    }
    // `…, so that the robot goes first`
    if matches!(act, Act::Walk | Act::GoOn | Act::Pass | Act::Cross)
        && quote.to_lowercase().ends_with(" first")
        && story.cast.people.len() == 1
    {
        order::state(&mut story.order, (AgentId::Robot, order::agent(0)), false, quote);
    }
    match act {
        // Who has the robot behind walks ahead of it.
        Act::Behind => set(story, Relation::Ahead),
        Act::Follow => {
            story.robot_part = Some("robot_following");
            set(story, Relation::Ahead);
        }
        Act::Overtake => {
            story.robot_part = Some("robot_overtaking");
            set(story, Relation::Ahead);
        }
        Act::Lead => {
            story.robot_part = Some("leading");
            for who in object {
                let around = Around { quote: quote.to_owned(), ..Around::default() };
                let _rule = deed::apply(&mut story.cast, *who, Act::Follow, &around);
            }
        }
        Act::Abreast => set(story, Relation::Abreast),
        Act::Gesture => story.robot_says.extend(found.gesture.map(|gesture| (gesture, quote.to_owned()))),
        Act::Enter => {
            // `while she comes out of the room, the robot wants to get in`
            let there = || {
                let left = story.cast.last.iter().find_map(|who| story.cast.people.get(*who)?.start);
                let inside = |class: &PlaceClass| matches!(class, PlaceClass::Room | PlaceClass::Elevator);
                let named = story.place.as_ref().or(story.weak_place.as_ref()).or(story.robot_leaves.as_ref());
                left.or_else(|| named.map(|(class, _)| *class)).filter(inside)
            };
            story.robot_enters = class
                .or_else(|| if story.robot_enters.is_none() { there() } else { None })
                .map(|class| (class, quote.to_owned()))
                .or_else(|| story.robot_enters.take())
        }
        Act::ComeOut => {
            story.robot_leaves = class.map(|class| (class, quote.to_owned())).or_else(|| story.robot_leaves.take())
        }
        Act::RunAway
        | Act::GiveWay
        | Act::Block
        | Act::Look
        | Act::Approach
        | Act::Toward
        | Act::Ahead
        | Act::Cross
        | Act::Stay
        | Act::Talk
        | Act::WalkTogether
        | Act::Stop
        | Act::Stand
        | Act::Ignore
        | Act::Pass
        | Act::GoOn
        | Act::Walk
        | Act::TurnBack
        | Act::SlowDown
        | Act::SpeedUp
        | Act::Aside
        | Act::ComeClose
        | Act::OpenUp => {}
    }
    let its_own = matches!(
        act,
        Act::Stop
            | Act::GoOn
            | Act::GiveWay
            | Act::Stay
            | Act::RunAway
            | Act::Block
            | Act::Ignore
            | Act::Look
            | Act::TurnBack
            | Act::SlowDown
            | Act::SpeedUp
    );
    if its_own {
        story.cast.leave_out(quote, UP_TO_PLANNER);
    }
}

/// What is said of a deed of the robot that nobody can promise.
pub(crate) const UP_TO_PLANNER: &str = "what the robot does is up to its planner; no clause demands it";
