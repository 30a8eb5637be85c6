//! The words of a scenario as a question lists them: relations, acts, moments, signs, and the robot's moments and deeds.

use serde_json::Value;
use socrates_model::form::{Deed, PlaceWord, RobotDeed, RobotMoment, When};
use socrates_model::{Gesture, PlaceClass};

use crate::vocabulary::{relations, row, short, told_gesture};

/// Everything that a scenario may say: relations, acts, moments, signs, and the robot's moments and deeds.
pub(crate) fn tables() -> String {
    let lines = |rows: &[(Value, String)]| -> String {
        let each =
            rows.iter().map(
                |(form, meaning)| {
                    if meaning.is_empty() { format!("{form}\n") } else { format!("{form} {meaning}\n") }
                },
            );
        each.collect()
    };
    let signs: Vec<String> = Gesture::ALL.iter().map(|gesture| told_gesture(*gesture)).collect();
    format!(
        "## relation\n{}## act\n{}## when, until: one or a list, all of which hold; m between centers, 2 to 6: the robot stops 1.6 m before who stands in its way\n{}## say\n{}\n\
         ## robot.does: when\n{}## robot.does: one of\n{}",
        short(&relations()),
        lines(&deeds()),
        lines(&moments()),
        signs.join(", "),
        lines(&robot_moments()),
        lines(&robot_deeds()),
    )
}

fn deeds() -> Vec<(Value, String)> {
    let nurse = || "human_2".to_owned();
    vec![
        row(&Deed::Navigate, "walks on"),
        row(&Deed::StandStill, ""),
        row(&Deed::LookAtRobot, "stands and turns to it"),
        row(&Deed::LookAt(nurse()), ""),
        row(&Deed::FollowRobot, "at 1 to 2 m"),
        row(&Deed::FollowHuman(nurse()), ""),
        row(&Deed::RunAway, ""),
        row(&Deed::GiveWay, "steps aside"),
        row(&Deed::MakeRoom, "for those who stand: out of the robot's way, and back once it has passed"),
        row(&Deed::Block, "stays in front of it"),
        row(&Deed::Approach, "comes up to it, to 1.2 m; `near_m` 0.7 to 2"),
        row(&Deed::TurnBack, "walks back the way they came, from then on; for those who walk by their relation"),
        row(&Deed::GoTo(PlaceWord::Class(PlaceClass::Corridor)), "leaves the way for such a place, and stays there"),
        row(&Deed::ChangePace, "walks on at the `pace` of the step; for those who walk by their relation"),
    ]
}

fn moments() -> Vec<(Value, String)> {
    let nurse = || "human_2".to_owned();
    vec![
        row(&When::Always, "from the start"),
        row(&When::RobotVisible(5.0), "seen within this distance, m, 0.3 to 15; never by those who walk ahead of it"),
        row(&When::RobotNear(2.0), "through walls too"),
        row(&When::RobotBlocking(2.0), "near, and stands in their way"),
        row(&When::RobotMoving, ""),
        row(&When::RobotStopped, ""),
        row(&When::StoppedFor(3.0), "s"),
        row(&When::RobotPassed, "was near and goes away again"),
        row(&When::RobotSays(Gesture::ExcuseMe), ""),
        row(&When::HumanSays(nurse(), Gesture::Wait), ""),
        row(&When::Did(nurse(), 1), "the first step of their `does` has ended"),
        row(&When::Done(nurse()), "all their steps have ended; without steps: they are past where they meet the robot"),
        row(&When::AtEncounter, "they are where they meet the robot"),
        row(&When::GoalReached, "they are at the end of their way"),
        row(&When::AfterSecs(10.0), "after the start of the run"),
    ]
}

fn robot_moments() -> Vec<(Value, String)> {
    vec![
        row(&RobotMoment::Start, "the first line unless stated; others begin when the line before is over"),
        row(&RobotMoment::Blocked(2.0), "s in which somebody is close ahead"),
        row(&RobotMoment::HumanNear(3.0), "m, whoever comes first"),
        row(&RobotMoment::Near("human_1".to_owned(), 3.0), "this person"),
        row(&RobotMoment::HumanSays(Gesture::Wait), ""),
        row(&RobotMoment::AtEncounter("human_1".to_owned()), ""),
        row(&RobotMoment::AfterSecs(5.0), ""),
    ]
}

fn robot_deeds() -> Vec<(Value, String)> {
    let nurse = || "human_1".to_owned();
    vec![
        row(&RobotDeed::Say(Gesture::ExcuseMe), ""),
        row(&RobotDeed::HoldS(3.0), "stands, s"),
        row(&RobotDeed::HoldUntil(RobotMoment::HumanSays(Gesture::Proceed)), "stands until then"),
        row(&RobotDeed::WaitForLeavers(true), "enters after those who leave"),
        row(&RobotDeed::Follow(nurse()), ""),
        row(&RobotDeed::Beside(nurse()), ""),
        row(&RobotDeed::Overtake(nurse()), "somebody slower"),
        row(&RobotDeed::LeadM(4.0), "leads; waits for followers farther behind, m"),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_of_a_scenario_has_a_row() {
        let tables = tables();
        let (_, definitions) = crate::scenario::schema();
        for name in ["Relation", "Deed", "When", "Gesture", "RobotMoment"] {
            let words = crate::schema::alternatives(&definitions[name]);
            assert!(words.len() > 3, "{name}: {words:?}");
            for word in words {
                let there = [format!("\"{word}\""), format!("\n{word}:"), format!("{word},"), format!("{word} (")];
                assert!(there.iter().any(|form| tables.contains(form)) || tables.contains(&word), "{name} `{word}`");
            }
        }
        for key in RobotDeed::KEYS {
            assert!(tables.contains(&format!("{{\"{key}\":")), "{key}");
        }
    }
}
