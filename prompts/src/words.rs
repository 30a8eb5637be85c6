//! The words of a scenario as a question lists them: relations, acts, moments, signs, and the robot's moments and deeds.

use serde_json::Value;
use socrates_model::Gesture;
use socrates_model::act::ACTS;
use socrates_model::form::{RobotDeed, RobotMoment};
use socrates_model::rule::{ROBOT_MOMENTS, TRIGGERS};

use crate::vocabulary::{relations, row, short, told_gesture};

/// Everything that a scenario may say: relations, acts, moments, signs, and the robot's moments and deeds.
pub(crate) fn tables() -> String {
    let line = |(form, meaning): (String, &str)| format!("{}\n", format!("{form} {meaning}").trim_end());
    let lines = |rows: &[(Value, String)]| -> String {
        rows.iter().map(|(form, meaning)| line((form.to_string(), meaning))).collect()
    };
    let signs: Vec<String> = Gesture::ALL.iter().map(|gesture| told_gesture(*gesture)).collect();
    format!(
        "## relation\n{}## act\n{}## when, until: one or a list, all of which hold; m between centers, 2 to 6: the robot stops 1.6 m before who stands in its way\n{}## say\n{}\n\
         ## robot.does: when\n{}## robot.does: one of\n{}",
        short(&relations()),
        ACTS.iter().map(|act| line((act.json(), act.meaning))).collect::<String>(),
        TRIGGERS.iter().map(|one| line((one.json(), one.meaning))).collect::<String>(),
        signs.join(", "),
        ROBOT_MOMENTS.iter().map(|one| line((one.json(), one.meaning))).collect::<String>(),
        lines(&robot_deeds()),
    )
}

fn robot_deeds() -> Vec<(Value, String)> {
    let nurse = || "human_1".to_owned();
    vec![
        row(&RobotDeed::Say(Gesture::ExcuseMe), ""),
        row(&RobotDeed::HoldS(3.0), "stands, s"),
        row(&RobotDeed::HoldUntil(RobotMoment::Done(nurse())), "stands until such a moment"),
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
        for name in ["Relation", "Action", "Trigger", "Gesture", "RobotWhen"] {
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
