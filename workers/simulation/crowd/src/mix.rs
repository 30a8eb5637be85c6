//! People of several models in one run.

use std::fmt;
use std::sync::Arc;

use crate::fast::BadStep;
use crate::model::{CrowdModel, View};
use crate::obstacle::Segment;
use crate::person::Person;
use crate::tracks::Track;
use crate::walker::{Route, Walker};

/// Somebody of a mixed crowd.
#[derive(Clone)]
pub struct Member {
    /// Last known state, and what does not change. Its goal is replaced by that of the route.
    pub person: Person,
    /// Where it goes; recorded people need none.
    pub route: Route,
    /// How it walks.
    pub model: Arc<dyn CrowdModel + Send + Sync>,
    /// Whether it is there at the beginning. A recorded person comes and goes by its track.
    pub present: bool,
}

impl fmt::Debug for Member {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Member")
            .field("person", &self.person)
            .field("route", &self.route)
            .field("model", &self.model.name())
            .field("present", &self.present)
            .finish()
    }
}

impl Member {
    /// Somebody who is there from the beginning and walks by `model`.
    #[must_use]
    pub fn walking(walker: Walker, model: Arc<dyn CrowdModel + Send + Sync>) -> Self {
        Self { person: walker.person, route: walker.route, model, present: true }
    }

    /// Somebody who walks as recorded, in a run that begins at `now_s`. From `person` come id, radius and
    /// group.
    #[must_use]
    pub fn recorded(person: Person, track: Track, now_s: f64) -> Self {
        let present = track.at(now_s, &person);
        Self {
            present: present.is_some(),
            person: present.unwrap_or(person),
            route: Route::default(),
            model: Arc::new(track),
        }
    }
}

/// A crowd in which each walks by its own model. Everybody moves from the same state, in the order given,
/// so the order changes nothing.
#[derive(Debug, Clone)]
pub struct Mix {
    members: Vec<Member>,
    walls: Vec<Segment>,
    now_s: f64,
}

impl Mix {
    /// A crowd among walls at a time, s.
    #[must_use]
    pub fn new(members: Vec<Member>, walls: Vec<Segment>, now_s: f64) -> Self {
        let mut mix = Self { members, walls, now_s };
        for member in &mut mix.members {
            member.person.goal = member.route.goal();
        }
        mix
    }

    /// Time of the present state, s.
    #[must_use]
    pub fn now_s(&self) -> f64 {
        self.now_s
    }

    /// Everybody who is there now, in the order given.
    pub fn people(&self) -> impl Iterator<Item = &Person> {
        self.members.iter().filter(|member| member.present).map(|member| &member.person)
    }

    /// Everybody, there or not, in the order given.
    #[must_use]
    pub fn members(&self) -> &[Member] {
        &self.members
    }

    /// Moves everybody on to a time; to the present time nothing changes.
    ///
    /// # Errors
    /// [`BadStep`] if the time is not finite or is past; nothing changes then.
    pub fn advance_to(&mut self, time_s: f64) -> Result<(), BadStep> {
        let dt_s = time_s - self.now_s;
        if !(dt_s.is_finite() && dt_s >= 0.0) {
            return Err(BadStep { dt: dt_s });
        }
        if dt_s > 0.0 {
            let people: Vec<Person> = self.people().cloned().collect();
            let mut there = 0;
            for member in &mut self.members {
                let place = member.present.then_some(there);
                there += usize::from(member.present);
                let view =
                    View { me: &member.person, place, people: &people, walls: &self.walls, now_s: self.now_s, dt_s };
                let next = member.model.next(&view);
                member.present = next.is_some();
                if let Some(mut person) = next {
                    member.route.follow(&mut person);
                    member.person = person;
                }
            }
            self.now_s = time_s;
        }
        Ok(())
    }
}
