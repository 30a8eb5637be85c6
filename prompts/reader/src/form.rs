//! The story as a form.

use std::collections::BTreeSet;

use socrates_model::Gesture;
use socrates_model::Relation;
use socrates_model::form::{Deed as FormDeed, Form, FormGroup, FormHuman, Pace, PlaceWord, Step as FormStep, When};

use crate::cast::People;
use crate::rows::{Act, Cue};
use crate::statement::Reason;
use crate::story::{Person, Step, Story, name};

/// Whoever is startled looks at the robot for so long, s.
const STARTLED_S: f64 = 8.0;

impl Story {
    /// The story as a form. How somebody stands to the robot's way, where the text leaves it open, is `frontal`, or `static` for
    /// somebody who blocks; places are classes.
    #[must_use]
    pub fn form(&self) -> Form {
        let mut form = Form::default();
        for person in &self.people {
            let human = self.human(person);
            match form.humans.last_mut() {
                Some(last) if FormHuman { count: 1, ..last.clone() } == human => last.count += 1,
                Some(_) | None => form.humans.push(human),
            }
        }
        let groups: BTreeSet<String> = form.humans.iter().filter_map(|human| human.group.clone()).collect();
        form.groups = groups.into_iter().map(|id| FormGroup { id, formation: None }).collect();
        form
    }

    fn human(&self, person: &Person) -> FormHuman {
        let blocks = person.steps.iter().any(|step| step.act == Act::Block);
        let open = if blocks { Relation::Static } else { Relation::Frontal };
        let (standing, steps): (Vec<&Step>, Vec<&Step>) = person
            .steps
            .iter()
            .partition(|step| step.when.is_empty() && step.act == Act::Follow && step.for_s.is_none());
        FormHuman {
            id: None,
            count: 1,
            role: Some(person.role.clone()).filter(|role| role != "person"),
            relation: person.relation.unwrap_or(open),
            side: person.side,
            facing: None,
            place: self.place.map(PlaceWord::Class),
            start: person.start.map(PlaceWord::Class),
            goal: None,
            pace: person.pace_mps.map(Pace::Mps),
            group: person.group.map(|group| format!("group_{group}")),
            does: steps.into_iter().map(form_step).collect(),
            reacts: standing.into_iter().map(|step| FormStep { when: vec![When::Always], ..form_step(step) }).collect(),
        }
    }
}

fn form_step(step: &Step) -> FormStep {
    let act = match (step.act, step.whom) {
        (Act::GiveWay, _) => Some(FormDeed::GiveWay),
        (Act::Block, _) => Some(FormDeed::Block),
        (Act::Look | Act::Startle, _) => Some(FormDeed::LookAtRobot),
        (Act::StandStill, _) => Some(FormDeed::StandStill),
        (Act::RunAway, _) => Some(FormDeed::RunAway),
        (Act::Approach, _) => Some(FormDeed::Approach),
        (Act::Follow, Some(whom)) => Some(FormDeed::FollowHuman(name(whom))),
        (Act::Follow, None) => Some(FormDeed::FollowRobot),
        (Act::Navigate, _) => Some(FormDeed::Navigate),
        (Act::TurnBack, _) => Some(FormDeed::TurnBack),
        (Act::Sign, _) => None,
    };
    FormStep {
        when: step.when.iter().map(form_when).collect(),
        act,
        for_s: step.for_s.or_else(|| (step.act == Act::Startle).then_some(STARTLED_S)),
        until: step.until.iter().map(form_when).collect(),
        say: step.says,
        ..FormStep::default()
    }
}

fn form_when(reason: &Reason<People>) -> When {
    let amount = reason.usual_amount();
    let speaker = reason.who.as_ref().and_then(|who| who.first().copied());
    match (reason.cue, reason.sign, speaker) {
        (Cue::Visible, ..) => When::RobotVisible(amount),
        (Cue::Near, ..) => When::RobotNear(amount),
        (Cue::Blocking, ..) => When::RobotBlocking(amount),
        (Cue::Moving, ..) => When::RobotMoving,
        (Cue::Stopped, ..) => When::RobotStopped,
        (Cue::Passed, ..) => When::RobotPassed,
        (Cue::Says, sign, Some(who)) => When::HumanSays(name(who), sign.unwrap_or(Gesture::ExcuseMe)),
        (Cue::Says, sign, None) => When::RobotSays(sign.unwrap_or(Gesture::ExcuseMe)),
        (Cue::Encounter, ..) => When::AtEncounter,
        (Cue::Goal, ..) => When::GoalReached,
        (Cue::After, ..) => When::AfterSecs(amount),
    }
}
