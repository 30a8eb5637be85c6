//! Questions to one driver over the bus, and what its answers mean.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

use socrates_link::{Bus, LinkError, Presence, keys};
use socrates_model::driver::{EndMessage, MissionAnswer, MissionMessage};
use socrates_model::lockstep::{MAP_PART_CELLS, map_bytes};
use tokio::time::timeout;

/// Where one driver is asked.
#[derive(Clone)]
pub struct Line {
    bus: Arc<dyn Bus>,
    driver: String,
    patience: Duration,
}

impl Line {
    /// To the driver of this name; `patience` is the longest wait for it to come, and for one answer.
    #[must_use]
    pub fn new(bus: Arc<dyn Bus>, driver: &str, patience: Duration) -> Self {
        Self { bus, driver: driver.to_owned(), patience }
    }

    /// Name of the driver.
    #[must_use]
    pub fn driver(&self) -> &str {
        &self.driver
    }

    /// Waits until somebody claims the name.
    ///
    /// # Errors
    /// Nobody did; those who claim other names are told.
    pub async fn claims(&self) -> Result<Claims, String> {
        let presence = self.bus.watch_alive(keys::DRIVERS_ALIVE).await.map_err(|why| told(&why))?;
        let mut claims = Claims { presence, driver: self.driver.clone(), there: Vec::new(), others: BTreeSet::new() };
        let came = async { while claims.there.is_empty() && claims.next().await {} };
        // What counts is whether anybody is there now, not how the wait ended.
        drop(timeout(self.patience, came).await);
        if !claims.there.is_empty() {
            return Ok(claims);
        }
        let (token, seconds) = (keys::drive_claims(&self.driver), self.patience.as_secs());
        let nobody = format!("no driver of this name came within {seconds} s; it declares the token `{token}`");
        let others: Vec<String> = claims.others.iter().map(|name| format!("`{name}`")).collect();
        Err(if others.is_empty() {
            nobody
        } else {
            format!("{nobody}; there are drivers called {}", others.join(", "))
        })
    }

    async fn ask(&self, key: &str, body: Vec<u8>, limit: Duration) -> Result<Vec<u8>, String> {
        self.bus.query(key, body, limit).await.map_err(|why| told(&why))
    }

    /// Tells the mission.
    ///
    /// # Errors
    /// No answer, or one that no mission can have.
    pub async fn mission(&self, mission: &MissionMessage) -> Result<MissionAnswer, String> {
        let body = serde_json::to_vec(mission).map_err(|why| format!("the mission: {why}"))?;
        let answer = self.ask(&keys::drive_mission(&self.driver), body, self.patience).await?;
        MissionAnswer::read(&answer).map_err(|bad| bad.to_string())
    }

    /// Sends the cells of the map, part by part.
    ///
    /// # Errors
    /// A part was not answered.
    pub async fn map(&self, session: u64, cells: &[u8]) -> Result<(), String> {
        let (key, whole) = (keys::drive_mission(&self.driver), cells.len() as u64);
        let mut first = 0;
        for part in cells.chunks(MAP_PART_CELLS) {
            let body = map_bytes(session, first, whole, part);
            self.ask(&key, body, self.patience).await.map_err(|why| format!("the map: {why}"))?;
            first += part.len() as u64;
        }
        Ok(())
    }

    /// Asks for the answer to a step, at most so long.
    ///
    /// # Errors
    /// As [`Bus::query`]; [`told`] says it in words.
    pub async fn step(&self, body: Vec<u8>, limit: Duration) -> Result<Vec<u8>, LinkError> {
        self.bus.query(&keys::drive_step(&self.driver), body, limit).await
    }

    /// Tells the end of a run, and waits at most so long until it is noted.
    ///
    /// # Errors
    /// It was not noted.
    pub async fn end(&self, end: &EndMessage, limit: Duration) -> Result<(), String> {
        let body = serde_json::to_vec(end).map_err(|why| format!("the end: {why}"))?;
        self.ask(&keys::drive_mission(&self.driver), body, limit).await.map(drop)
    }
}

/// Everybody who claims the name of a driver.
pub struct Claims {
    presence: Presence,
    driver: String,
    there: Vec<String>,
    /// Names that others claim.
    others: BTreeSet<String>,
}

impl Claims {
    /// Takes in the next change; false once the bus is closed.
    async fn next(&mut self) -> bool {
        let Some((claim, alive)) = self.presence.next().await else { return false };
        match keys::driver_of(&claim) {
            Some(name) if name == self.driver => {
                self.there.retain(|other| *other != claim);
                if alive {
                    self.there.push(claim);
                }
            }
            Some(name) if alive => drop(self.others.insert(name.to_owned())),
            Some(_) | None => {}
        }
        true
    }

    /// The token of the one process that drives. Asked after an answer came: every token that was there before it has come by then.
    ///
    /// # Errors
    /// There are two.
    pub async fn alone(mut self) -> Result<String, String> {
        while let Ok(true) = timeout(Duration::ZERO, self.next()).await {}
        match self.there.as_slice() {
            [one, other, ..] => Err(format!("two drivers have this name: `{one}` and `{other}`; end one of them")),
            [one] => Ok(one.clone()),
            [] => Err("it is gone".to_owned()),
        }
    }
}

/// What went wrong with a question to a driver.
#[must_use]
pub fn told(why: &LinkError) -> String {
    match why {
        LinkError::NoReply { .. } => "it is gone, or gave no answer".to_owned(),
        LinkError::Timeout { after, .. } => format!("no answer within {:.1} s", after.as_secs_f64()),
        LinkError::TooLarge { .. }
        | LinkError::BadKey { .. }
        | LinkError::Encode { .. }
        | LinkError::Decode { .. }
        | LinkError::Incompatible { .. }
        | LinkError::Refused { .. }
        | LinkError::OtherReign { .. }
        | LinkError::Absent { .. }
        | LinkError::Keys { .. }
        | LinkError::Closed
        | LinkError::Transport { .. } => why.to_string(),
    }
}
