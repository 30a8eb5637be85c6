//! Whether somebody is to be drawn: not while they are nowhere, and not before they have come or after they have gone.

use socrates_model::{AgentState, Recording};

/// Tells of the states of one recording which are there to be drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct There {
    absent: Option<u16>,
}

impl There {
    /// For the states of a recording.
    pub(crate) fn of(recording: &Recording) -> Self {
        Self { absent: recording.header.absent() }
    }

    /// Whether the agent is there, at a place.
    pub(crate) fn is(self, state: &AgentState) -> bool {
        state.is_there(self.absent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{away, hall, human, papers, recording, robot};
    use crate::play;

    /// The robot, and a human who is there in the second half only.
    fn comes() -> Recording {
        let tick = [robot(1.0, 1.0, 0.0, 0.0), human(1, 5.0, 2.0, 0.0, 0.0)];
        away(recording(&[&tick[..]; 40]), 1, 0..20)
    }

    #[test]
    fn who_is_not_there_is_in_no_picture_and_in_no_curve() {
        let run = comes();
        let there = There::of(&run);
        assert_eq!(run.frames.iter().filter(|state| there.is(state)).count(), 60);
        let gone = away(comes(), 1, 0..40);
        let (place, (_, _, _, paths)) = (hall("hall"), papers("a hall"));
        let heading = crate::Heading { title: "a run", asked: "" };
        let picture = |run: &Recording| crate::run_picture(&place, run, Some(&paths), None, heading);
        // The legend and the label are the human's only marks besides its discs.
        assert!(picture(&run).contains(">human_1<") && !picture(&gone).contains(">human_1<"));
        let curves = crate::series::curves(&run, 10);
        assert_eq!(curves.distance_m.iter().map(Option::is_some).collect::<Vec<_>>(), [false, false, true, true]);
        let played = play::run(&place, &[], &run, 10);
        let codes: Vec<i64> = played["agents"][1]["track"]
            .as_array()
            .unwrap()
            .iter()
            .skip(3)
            .step_by(4)
            .filter_map(|c| c.as_i64())
            .collect();
        assert_eq!(codes, [-1, -1, 0, 0]);
        // The camera does not look where nobody was.
        assert_eq!(play::spread(&gone).count(), 40);
    }
}
