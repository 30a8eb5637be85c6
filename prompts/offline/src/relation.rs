//! How somebody stands to the robot's way, as the words say it.

use socrates_model::{Fault, FaultCode, PlaceClass, Relation};

use crate::cast::Cast;
use crate::lexicon::Act;
use crate::short;

/// How an act sets somebody to the robot's way.
pub(crate) fn relation(act: Act) -> Option<Relation> {
    Some(match act {
        Act::Toward => Relation::Frontal,
        Act::Overtake | Act::Behind => Relation::Behind,
        Act::Abreast => Relation::Abreast,
        Act::Ahead => Relation::Ahead,
        Act::Cross => Relation::Crossing,
        Act::ComeOut => Relation::Leaving,
        Act::Stay => Relation::Staying,
        Act::Talk | Act::Stand => Relation::Static,
        Act::Aside => Relation::Aside,
        Act::RunAway
        | Act::GiveWay
        | Act::Block
        | Act::Look
        | Act::Approach
        | Act::Follow
        | Act::Enter
        | Act::WalkTogether
        | Act::Stop
        | Act::Ignore
        | Act::Gesture
        | Act::Lead
        | Act::Pass
        | Act::GoOn
        | Act::Walk
        | Act::TurnBack
        | Act::SlowDown
        | Act::SpeedUp
        | Act::ComeClose
        | Act::OpenUp => return None,
    })
}

/// Sets the relation. Two that exclude each other are a contradiction, quoted; of one after the other, the first is played,
/// and that the other is not is said.
pub(crate) fn relate(cast: &mut Cast, who: usize, new: Relation, quote: &str) {
    let Some(person) = cast.people.get_mut(who) else { return };
    let Some((old, first)) = person.relation.clone() else {
        person.relation = Some((new, quote.to_owned()));
        return;
    };
    let pair = |a: Relation, b: Relation| old == a && new == b || old == b && new == a;
    let excludes = pair(Relation::Leaving, Relation::Staying)
        || pair(Relation::Frontal, Relation::Behind)
        || pair(Relation::Ahead, Relation::Behind)
        || pair(Relation::Frontal, Relation::Ahead);
    // `walks in the same direction, next to it`; `in conversation, they walk towards it`
    let closer = old == Relation::Ahead && new == Relation::Abreast && first.contains("same")
        || old == Relation::Static
            && matches!(new, Relation::Frontal | Relation::Crossing)
            && person.group.is_some()
            && person.doings.iter().all(|doing| !matches!(doing.as_str(), "stands" | "stops"));
    // `two pickers meet it at the junction: one crosses, the other …`: how they meet is told then.
    let met = old == Relation::Frontal
        && first.contains("meet")
        && !first.contains("toward")
        && !first.contains("head")
        && new != Relation::Static;
    if met {
        person.relation = Some((new, quote.to_owned()));
        person.doings.retain(|doing| doing != "comes towards the robot" || new == Relation::Frontal);
        return;
    }
    let ends = matches!(new, Relation::Leaving | Relation::Staying | Relation::Static)
        && !matches!(old, Relation::Leaving | Relation::Staying);
    // `come out of a room and cross its way`: both are played, and judged.
    let both = pair(Relation::Leaving, Relation::Crossing) && person.start != Some(PlaceClass::Elevator);
    if both {
        let words = if new == Relation::Crossing { quote } else { &first };
        person.crosses = Some(words.to_owned());
        if new == Relation::Leaving {
            person.relation = Some((new, quote.to_owned()));
        }
    } else if excludes && !afterwards(quote) {
        cast.problems.push(contradiction(who, &first, quote));
    } else if closer || ends {
        person.relation = Some((new, quote.to_owned()));
        if !closer {
            lost(cast, who, (old, &first), new);
        }
    } else {
        lost(cast, who, (new, quote), old);
    }
}

/// Two wishes that exclude each other.
pub(crate) fn contradiction(who: usize, first: &str, second: &str) -> Fault {
    Fault::new(
        FaultCode::PContra,
        crate::order::agent(who),
        format!("`{first}` and `{second}` cannot both hold for the same human; correct one of the two"),
    )
    .about([first, second])
}

/// `turns around and walks back towards it`: after what it did before.
fn afterwards(quote: &str) -> bool {
    quote.split(|c: char| !c.is_alphabetic()).any(|word| matches!(word, "back" | "then" | "finally" | "afterwards"))
}

/// Says that of two ways to stand to the robot's way, one after the other, only the other is played.
fn lost(cast: &mut Cast, who: usize, (relation, quote): (Relation, &str), played: Relation) {
    let Some(person) = cast.people.get_mut(who) else { return };
    let doings: &[&str] = match relation {
        Relation::Frontal => &["comes towards the robot"],
        Relation::Behind => &["overtakes the robot", "comes from behind"],
        Relation::Ahead => &["walks ahead of the robot"],
        Relation::Crossing => &["crosses"],
        Relation::Abreast => &["walks beside the robot"],
        // People who come out of, or stay inside, the place where they stood did stand there.
        Relation::Static | Relation::Leaving | Relation::Staying | Relation::Aside => return,
    };
    let same = person.relation.as_ref().is_some_and(|(_, other)| other == quote);
    // `cross from opposite sides` is one way; so is what is only said again, and whoever comes out meets the robot.
    if same || relation == played || quote.contains("meet") {
        return;
    }
    person.doings.retain(|doing| !doings.contains(&doing.as_str()));
    let message = format!(
        "`{quote}` is not played: each human stands to the robot's way in one way, and human_{} does so in another",
        who + 1
    );
    short::once(&mut cast.problems, quote, message);
}
