//! The world in which a case is ticked: it answers as the truths of the case say.

use socrates_model::{Action, Gesture, HumanId, SimTime, Trigger};

use crate::check::atoms::Atom;
use crate::leaf::LeafCall;
use crate::status::Status;
use crate::world::World;

/// The world of one case.
pub(super) struct CaseWorld<'a> {
    pub(super) atoms: &'a [Atom],
    pub(super) truth: &'a [bool],
    pub(super) acts: Vec<(Action, u16)>,
    pub(super) gestures: Vec<Option<Gesture>>,
    pub(super) goal_taken: bool,
}

impl CaseWorld<'_> {
    fn holds(&self, asked: &Trigger) -> bool {
        self.atoms.iter().zip(self.truth).any(|(atom, holds)| *holds && *atom == Atom::World(asked.clone()))
    }

    /// The gesture that holds, or none.
    fn gesture_of(&self, trigger: impl Fn(Gesture) -> Trigger) -> Option<Gesture> {
        Gesture::ALL.into_iter().find(|gesture| self.holds(&trigger(*gesture)))
    }

    /// What a leaf answers that nothing is known about.
    fn answer(&self, leaf: u16) -> Status {
        let succeeds = self.atoms.iter().zip(self.truth).any(|(atom, holds)| *holds && *atom == Atom::Answer(leaf));
        Status::of(succeeds)
    }

    fn true_numbers(&self, of: impl Fn(&Trigger) -> Option<f64>) -> impl Iterator<Item = f64> {
        self.atoms.iter().zip(self.truth).filter_map(move |(atom, holds)| match atom {
            Atom::World(trigger) if *holds => of(trigger),
            Atom::World(_) | Atom::Timer(..) | Atom::Memory(_) | Atom::GoalHere | Atom::Answer(_) => None,
        })
    }
}

impl World for CaseWorld<'_> {
    fn robot_distance_m(&self) -> Option<f64> {
        let near = |trigger: &Trigger| if let Trigger::RobotNear(m) = trigger { Some(*m) } else { None };
        Some(self.true_numbers(near).fold(f64::INFINITY, f64::min))
    }
    fn robot_visible(&self, within_m: f64) -> bool {
        self.holds(&Trigger::RobotVisible(within_m))
    }
    fn robot_blocking(&self, within_m: f64) -> bool {
        self.holds(&Trigger::RobotBlocking(within_m))
    }
    fn robot_moving(&self) -> bool {
        self.holds(&Trigger::RobotMoving)
    }
    fn robot_passed(&self) -> bool {
        self.holds(&Trigger::RobotPassed)
    }
    fn robot_passes(&self, _nearest_m: f64) -> bool {
        self.holds(&Trigger::RobotPassed)
    }
    fn robot_stood_s(&self) -> f64 {
        let stood = |trigger: &Trigger| if let Trigger::StoppedFor(secs) = trigger { Some(*secs) } else { None };
        self.true_numbers(stood).fold(0.0, f64::max)
    }
    fn steps_ended(&self, id: HumanId) -> u32 {
        let ended = |atom: &Atom| {
            if let Atom::World(Trigger::Did(who, step)) = atom { (*who == id).then_some(*step) } else { None }
        };
        self.atoms
            .iter()
            .zip(self.truth)
            .filter(|(_, holds)| **holds)
            .filter_map(|(atom, _)| ended(atom))
            .max()
            .unwrap_or(0)
    }
    fn is_done(&self, id: HumanId) -> bool {
        self.holds(&Trigger::Done(id))
    }
    fn robot_gesture(&self) -> Option<Gesture> {
        self.gesture_of(Trigger::RobotSays)
    }
    fn human_gesture(&self, id: HumanId) -> Option<Gesture> {
        self.gesture_of(|gesture| Trigger::HumanSays(id, gesture))
    }
    fn goal_reached(&self) -> bool {
        self.atoms.iter().zip(self.truth).any(|(atom, holds)| *holds && *atom == Atom::GoalHere)
    }
    fn path_done(&self) -> bool {
        self.holds(&Trigger::GoalReached)
    }
    fn next_goal(&mut self) {
        self.goal_taken = true;
    }
    fn at_encounter(&self) -> bool {
        self.holds(&Trigger::AtEncounter)
    }
    /// The latest time asked for that has passed.
    fn now(&self) -> SimTime {
        let after = |trigger: &Trigger| if let Trigger::AfterSecs(secs) = trigger { Some(*secs) } else { None };
        let secs = self.true_numbers(after).fold(0.0, f64::max);
        // Rounded up, so that the time asked for has passed.
        SimTime::from_nanos((secs * 1e9).ceil() as u64)
    }
    fn step_s(&self) -> f64 {
        1e-6
    }
    fn act(&mut self, action: &Action, leaf: u16) {
        self.acts.push((action.clone(), leaf));
    }
    fn gesture(&mut self, gesture: Option<Gesture>) {
        self.gestures.push(gesture);
    }
    fn leaf(&mut self, call: &mut LeafCall<'_>) -> Option<Status> {
        (!call.sheet().is_native()).then(|| self.answer(call.leaf()))
    }
    fn foreign(&mut self, leaf: u16) -> Status {
        self.answer(leaf)
    }
}
