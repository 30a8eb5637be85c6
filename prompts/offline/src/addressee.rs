//! To whom a sign is made: `tells the visitor to wait`, `waves at the guard`.

use socrates_model::{Action, AgentId, Gesture, HumanId};

use crate::cast::Cast;

/// The sign that the speakers have just made is made to one other person: they stand and face them. Who leads somebody walks on.
pub(crate) fn settle(cast: &mut Cast, speakers: &[usize], object: &[usize]) {
    let [to] = object else { return };
    let Some(id) = u32::try_from(to + 1).ok().map(HumanId::new).filter(|_| !speakers.contains(to)) else { return };
    for who in speakers {
        let Some(read) = cast.people.get_mut(*who).and_then(|person| person.rules.last_mut()) else { continue };
        let rule = &mut read.rule;
        let led = matches!(rule.gesture, None | Some(Gesture::FollowMe));
        if led || !matches!(rule.act, Action::Navigate | Action::StandStill | Action::LookAtRobot) {
            continue;
        }
        (rule.to, rule.act) = (Some(AgentId::Human(id)), Action::LookAt(id));
    }
}

#[cfg(test)]
mod tests {
    use socrates_model::{Action, AgentId, FactKind, Gesture, HumanId};

    use crate::tests::told;

    #[test]
    fn a_sign_to_one_person_of_the_cast_is_made_to_them() {
        let reading = told(
            "A guard stands in the corridor. A visitor walks towards the robot. The guard tells the visitor to wait.",
            "office",
        );
        let to = HumanId::new(2);
        let rule = &reading.humans[0].rules[0];
        assert_eq!(
            (rule.to, &rule.act, rule.gesture),
            (Some(AgentId::Human(to)), &Action::LookAt(to), Some(Gesture::Wait))
        );
        let wanted = FactKind::GesturesTo { human: HumanId::new(1), gesture: Gesture::Wait, to: AgentId::Human(to) };
        assert!(reading.facts.iter().any(|fact| fact.kind == wanted), "{:#?}", reading.facts);
        let reading = told(
            "A guard stands in the corridor. A visitor walks towards the robot. The guard tells the robot to wait.",
            "office",
        );
        assert!(reading.humans.iter().all(|human| human.rules.iter().all(|rule| rule.to.is_none())));
    }
}
