//! People of several models in one run.

use std::fmt;
use std::sync::Arc;

use crate::fast::{BadStep, WallIndex};
use crate::model::{CrowdModel, Index, Room, View};
use crate::near::Near;
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
    now_s: f64,
    /// Everybody who is there at the start of a step.
    people: Vec<Person>,
    index: Index,
    room: Room,
}

/// Walls within this distance are found by looking at a cell, m; whoever asks farther looks at all walls.
const WALLS_M: f64 = 3.0;

impl Mix {
    /// A crowd among walls at a time, s.
    #[must_use]
    pub fn new(members: Vec<Member>, walls: Vec<Segment>, now_s: f64) -> Self {
        let index = Index { near: Near::default(), walls: WallIndex::new(&walls, WALLS_M) };
        let mut mix = Self { members, now_s, people: Vec::new(), index, room: Room::default() };
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
            self.people.clear();
            let present = self.members.iter().filter(|member| member.present);
            self.people.extend(present.map(|member| member.person.clone()));
            self.index.near.fill(self.people.iter().map(|person| (person.position, person.velocity)));
            let (people, walls) = (&self.people, self.index.walls.segments());
            let mut there = 0;
            for member in &mut self.members {
                let place = member.present.then_some(there);
                there += usize::from(member.present);
                let (me, index) = (&member.person, Some(&self.index));
                let view = View { me, place, people, walls, now_s: self.now_s, dt_s, index };
                let next = member.model.next(&view, &mut self.room);
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
