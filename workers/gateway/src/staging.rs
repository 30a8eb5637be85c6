//! What all Foxglove viewers of a live run share: every message is encoded once, at the first viewer's question.

use std::collections::BTreeMap;
use std::sync::Arc;

use socrates_model::{Event, SimTime};

use crate::fox::{Door, Facts, Frame, Message, Stage, Topics};
use crate::frame::{self, Sights};
use crate::scene::Scene;
use crate::words::words;

/// The stage of a scene, before its first frame.
#[must_use]
pub fn stage(scene: &Scene) -> Stage {
    let doors: Vec<Door<'_>> = scene
        .doors
        .iter()
        .map(|told| Door { id: &told.door.id, from: told.door.from, to: told.door.to, open: told.open })
        .collect();
    let way: Vec<[f64; 2]> = scene.way.iter().map(|point| [point.x, point.y]).collect();
    Stage::new(&Facts {
        agents: &scene.header.agents,
        absent: scene.header.absent(),
        grid: Some(&scene.location.grid),
        doors: &doors,
        way: &way,
        goal: scene.goal.map(|goal| [goal.x, goal.y]),
        scans: scene.robot.is_some(),
    })
    .with_records()
}

/// The scan of a frame as messages have it: infinite where nothing is met.
#[must_use]
pub fn ranges(sights: &Sights) -> Option<Vec<f32>> {
    #[expect(clippy::cast_possible_truncation, reason = "a lidar has no more digits")]
    let range = |range: &f64| if *range < sights.range_m { *range as f32 } else { f32::INFINITY };
    (!sights.scan.is_empty()).then(|| sights.scan.iter().map(range).collect())
}

/// The shared part of a live run's viewers.
pub struct Staging {
    stage: Stage,
    newest: Option<u32>,
    messages: Arc<Vec<Message>>,
    events: Vec<Arc<Vec<Message>>>,
    wanted: BTreeMap<u64, Topics>,
    guests: u64,
}

impl Staging {
    /// Nothing was shown yet.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        Self {
            stage: stage(scene),
            newest: None,
            messages: Arc::default(),
            events: Vec::new(),
            wanted: BTreeMap::new(),
            guests: 0,
        }
    }

    /// The stage as it stands.
    #[must_use]
    pub const fn stage(&self) -> &Stage {
        &self.stage
    }

    /// A number for one more viewer.
    pub const fn admit(&mut self) -> u64 {
        self.guests += 1;
        self.guests
    }

    /// What a viewer wants from now on; nothing for one that leaves.
    pub fn wants(&mut self, guest: u64, topics: Topics) {
        if topics.is_empty() {
            self.wanted.remove(&guest);
        } else {
            self.wanted.insert(guest, topics);
        }
    }

    /// What anybody wants.
    fn all_wanted(&self) -> Topics {
        self.wanted.values().flat_map(|topics| topics.iter()).collect()
    }

    /// Takes the events that it has not seen: `from` gives those from a number on. Log lines are encoded whether anybody wants them or
    /// not: they are few.
    pub fn catch_up(&mut self, from: impl FnOnce(usize) -> Vec<Event>) {
        let wanted = self.all_wanted().with(crate::fox::Topic::Events);
        for event in from(self.events.len()) {
            let messages = self.stage.event(&event, &words(&event.kind), wanted);
            self.events.push(Arc::new(messages));
        }
    }

    /// Messages of the events from a number on.
    #[must_use]
    pub fn events(&self, from: usize) -> Vec<Arc<Vec<Message>>> {
        self.events.get(from..).unwrap_or_default().to_vec()
    }

    /// How many events it has seen.
    #[must_use]
    pub const fn seen(&self) -> usize {
        self.events.len()
    }

    /// Messages of a frame, encoded unless that was done.
    pub fn frame(&mut self, frame: &frame::Frame) -> Arc<Vec<Message>> {
        if self.newest != Some(frame.number) {
            self.newest = Some(frame.number);
            let scan = ranges(&frame.sights);
            let shown = Frame { time: SimTime::at_tick(frame.tick), states: &frame.states, scan: scan.as_deref() };
            self.messages = Arc::new(self.stage.frame(&shown, self.all_wanted()));
        }
        Arc::clone(&self.messages)
    }
}
