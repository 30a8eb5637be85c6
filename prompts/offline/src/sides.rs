//! Sides of the robot's way, as facts and in words.

use socrates_model::{Action, FactKind, Fault, HumanId, HumanProposal, Reading, Relation, Side};

use crate::story::{Person, ReadRule};
use crate::told::unplayed;

/// The fact of somebody's side, if they can be on one.
pub(crate) fn fact(
    human: HumanId,
    relation: Option<Relation>,
    person: &Person,
    problems: &mut Vec<Fault>,
) -> Option<(String, FactKind)> {
    let (side, quote) = person.side.as_ref()?;
    let follows = |read: &ReadRule| matches!(read.rule.act, Action::FollowRobot | Action::FollowHuman(_));
    if relation == Some(Relation::Staying) || person.rules.iter().any(follows) {
        unplayed(problems, quote, "on which side of the robot's way somebody is who follows or stays inside");
        return None;
    }
    Some((quote.clone(), FactKind::Side { human, side: *side }))
}

/// A side for the reading line: `crosses, from the left`.
pub(crate) fn words(relation: Option<Relation>, side: Side) -> String {
    let comes = matches!(relation, Some(Relation::Crossing | Relation::Leaving));
    format!("{} the {}", if comes { "from" } else { "on" }, side.name())
}

/// The people of a proposal with the sides that the reading states.
pub(crate) fn stated(mut humans: Vec<HumanProposal>, reading: &Reading) -> Vec<HumanProposal> {
    for fact in &reading.facts {
        let FactKind::Side { human, side } = fact.kind else { continue };
        let Some(found) = humans.iter_mut().find(|other| other.id == human) else { continue };
        found.side = Some(side);
        let doing = match found.relation {
            Relation::Crossing => "come from",
            Relation::Leaving => "come out on",
            Relation::Static | Relation::Aside => "stand on",
            Relation::Frontal | Relation::Behind | Relation::Ahead | Relation::Abreast => "walk on",
            Relation::Staying => continue,
        };
        found.behavior.push_str(&format!(" They {doing} the {} of the robot's way.", side.name()));
    }
    humans
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{map, request};

    /// The sides of a text, by human, and whether anything of it is said not to be played.
    fn read(text: &str) -> (Vec<(u32, Side)>, Reading) {
        let reading = crate::read(&request("Deliver mail to the meeting room", Some(text)), &map("office"));
        let side = |kind: &FactKind| {
            if let FactKind::Side { human, side } = kind { Some((human.number(), *side)) } else { None }
        };
        (reading.facts.iter().filter_map(|fact| side(&fact.kind)).collect(), reading)
    }

    #[test]
    fn a_side_of_the_robots_way_is_read() {
        use Side::{Left, Right};
        for (text, wanted) in [
            ("A visitor crosses the intersection from the left.", &[(1, Left)][..]),
            ("A visitor crosses from right to left.", &[(1, Right)]),
            ("An employee stands on the right side of the corridor.", &[(1, Right)]),
            ("An employee stands to the robot's left.", &[(1, Left)]),
            ("A courier overtakes the robot on its left.", &[(1, Left)]),
            ("A woman comes out of a room on the right-hand side.", &[(1, Right)]),
            ("A visitor crosses from the left and an employee crosses from the right.", &[(1, Left), (2, Right)]),
            ("Two visitors cross from the robot's right.", &[(1, Right), (2, Right)]),
        ] {
            let (found, reading) = read(text);
            assert_eq!(found, wanted, "{text}");
            let loose = crate::tests::loose(&reading);
            assert!(!loose.iter().any(|word| word == "left" || word == "right"), "{text}: {loose:?}");
        }
    }

    #[test]
    fn what_is_no_side_of_the_robots_way_is_not_read_as_one() {
        for text in [
            "A visitor left the meeting room.",
            "A visitor walks towards the robot and turns to the left.",
            "A visitor comes towards the robot right in front of it.",
        ] {
            assert_eq!(read(text).0, [], "{text}");
        }
    }

    #[test]
    fn a_side_that_is_ruled_out_is_no_side_and_is_said() {
        for text in ["A visitor crosses, but not from the left.", "A visitor does not cross from the left."] {
            let (found, reading) = read(text);
            assert_eq!(found, [], "{text}");
            let said = reading.problems.iter().any(|fault| fault.message.to_string().contains("left"))
                || reading.notes.iter().any(|note| note.contains("left"))
                || crate::tests::loose(&reading).iter().any(|word| word == "left");
            assert!(said, "{text}: {:?} {:?}", reading.problems, reading.notes);
        }
    }
}
