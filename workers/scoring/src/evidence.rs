//! What a report is made from.

use socrates_model::{HumanId, Location, Paths, Point, Proposal, Reading, Recording, Request};

/// Everything known about one run. Only the recording is needed; what is missing is said in the report.
#[derive(Debug, Clone, Copy)]
pub struct Evidence<'a> {
    /// The recording to be judged.
    pub recording: &'a Recording,
    /// Map, scene graph and doors.
    pub location: Option<&'a Location>,
    /// What the user asked for.
    pub request: Option<&'a Request>,
    /// What was understood of it; its facts must be covered by clauses.
    pub reading: Option<&'a Reading>,
    /// The scenario in detail, with the clauses.
    pub proposal: Option<&'a Proposal>,
    /// Node sequences and encounters.
    pub paths: Option<&'a Paths>,
    /// The same scenario and seed with the reference robot, to tell a scenario's fault from a planner's.
    pub reference: Option<&'a Recording>,
    /// The same scenario and seed without a robot, to tell what the robot's presence costs people.
    pub twin: Option<&'a Recording>,
    /// The robot's goal where no paths tell it: of tracks from elsewhere.
    pub goal: Option<Point>,
    /// Who belongs together, where no proposal tells it.
    pub groups: &'a [Vec<HumanId>],
}

impl<'a> Evidence<'a> {
    /// Whether somebody stands where the robot comes by: then there is no time of its own to compare.
    #[must_use]
    pub fn stands(&self, human: HumanId) -> bool {
        let human = self.proposal.and_then(|proposal| proposal.human(human));
        human.is_some_and(|human| human.relation.stands())
    }

    /// Evidence of a recording alone.
    #[must_use]
    pub const fn of(recording: &'a Recording) -> Self {
        Self {
            recording,
            location: None,
            request: None,
            reading: None,
            proposal: None,
            paths: None,
            reference: None,
            twin: None,
            goal: None,
            groups: &[],
        }
    }
}
