//! `drive check`: plays the simulation's part to a driver, message by message, and says what it does with each.

use std::sync::Arc;
use std::time::{Duration, Instant};

use serde_json::json;
use socrates_link::rules::Role;
use socrates_model::driver::{EndMessage, MissionAnswer, MissionDoor, MissionMap, MissionMessage, MissionPerson};
use socrates_model::lockstep::{self, HEAD_BYTES, PERSON_BYTES, StepHead, read_command, step_bytes};
use socrates_model::robot::RobotFile;
use socrates_model::{
    Cues, Digest, HumanId, Observation, PlannerName, Point, Pose, Relation, RobotModel, RunId, SeenDoor, SeenPerson,
    SeenRobot, SimTime, Vector,
};
use socrates_simulation::driving::{Line, body_of, told};

use crate::config::Config;
use crate::driver_process::DriverCommand;
use crate::exit::{Code, Diagnostic};
use crate::output::Printer;
use crate::process::client;
use crate::router::Router;
use crate::supervise::endpoint;

/// Longest wait for the driver to come, and for one answer.
const PATIENCE: Duration = Duration::from_secs(10);
/// Steps whose answers are timed.
const TIMED: u32 = 200;
/// Cells of a side of the map that is told.
const SIDE: usize = 300;

/// Which driver, and where it is.
#[derive(Debug, Clone)]
pub struct CheckOptions {
    /// Its name, without `external:`.
    pub driver: String,
    /// Folder or endpoint where it is connected already.
    pub place: Option<String>,
    /// Command that starts it.
    pub command: Option<String>,
}

/// One thing that a driver has to do, and whether it did.
struct Finding {
    what: &'static str,
    outcome: Result<String, String>,
}

/// Tries every message, and prints what came of each.
pub async fn check(talk: &Printer, config: &Config, options: &CheckOptions) -> Result<(), Diagnostic> {
    let folder = tempfile::tempdir().map_err(|why| Diagnostic::resumes(why.to_string()))?;
    let (bus, _router, _child) = match &options.place {
        Some(place) => {
            let (endpoint, namespace) = endpoint(place).ok_or_else(|| {
                Diagnostic::input(
                    format!("nothing is served in `{place}`"),
                    "start `socrates serve`, or let --driver start the driver here",
                )
            })?;
            (client(config, Role::Worker, &endpoint, &namespace, "check").await?, None, None)
        }
        None => {
            let router = Router::open(folder.path(), config, "run").await?;
            let child = options
                .command
                .as_deref()
                .map(|line| DriverCommand::read(line, &router.endpoint, "run")?.start())
                .transpose()?;
            (Arc::clone(&router.bus), Some(router), child)
        }
    };
    let name = PlannerName::new(format!("external:{}", options.driver));
    let name = name.map_err(|bad| Diagnostic::input(bad.to_string(), "a driver is named without `external:`"))?;
    let findings = Exam { line: Line::new(bus, &options.driver, PATIENCE), name }.all().await;
    let failed = findings.iter().filter(|finding| finding.outcome.is_err()).count();
    for Finding { what, outcome } in &findings {
        match outcome {
            Ok(told) => talk.line(&format!("ok         {what:<44}{told}")),
            Err(why) => talk.line(&format!("FAILED     {what:<44}{why}")),
        }
    }
    let rows = findings.iter().map(|finding| {
        let (ok, told) = finding.outcome.as_ref().map_or_else(|why| (false, why), |told| (true, told));
        json!({ "what": finding.what, "ok": ok, "told": told })
    });
    talk.result(&json!({ "driver": options.driver, "checks": rows.collect::<Vec<_>>(), "failed": failed }));
    if failed == 0 {
        return Ok(());
    }
    let what = format!("the driver `{}` fails {failed} of {} checks", options.driver, findings.len());
    Err(Diagnostic::input(what, "docs/wire.md has every message").with_code(Code::Input))
}

/// The driver under examination.
struct Exam {
    line: Line,
    name: PlannerName,
}

impl Exam {
    async fn all(&self) -> Vec<Finding> {
        let mut findings = Vec::new();
        let mut note = |what, outcome: Result<String, String>| {
            let went = outcome.is_ok();
            findings.push(Finding { what, outcome });
            went
        };
        let claims = match self.line.claims().await {
            Ok(claims) => claims,
            Err(why) => {
                note("declares its claim", Err(why));
                return findings;
            }
        };
        let answer = self.mission(1, None).await;
        note("declares its claim", claims.alone().await);
        let told = answer.as_ref().map(|answer| format!("{} steps a second", answer.rate_hz)).map_err(Clone::clone);
        if !note("answers its mission", told) {
            return findings;
        }
        if answer.as_ref().is_ok_and(|answer| answer.map) {
            note("takes the map in parts", self.map(1).await);
        }
        let scan = vec![f64::INFINITY; if answer.is_ok_and(|answer| answer.lidar) { 360 } else { 0 }];
        let step = |session, call, people, longer| self.step((session, call), people, (longer, false), &scan);
        note("answers a step without people", step(1, 0, 0, false).await);
        note("answers a step with 1 person", step(1, 1, 1, false).await);
        note("answers a step with 50 people", step(1, 2, 50, false).await);
        note("skips what a later version adds", step(1, 3, 2, true).await);
        let second = self.mission(2, None).await.map(|_| String::new());
        if note("takes a second run beside the first", second) {
            let both = async {
                step(2, 0, 1, false).await?;
                step(1, 4, 1, false).await?;
                step(2, 1, 1, false).await
            };
            note("keeps two runs apart", both.await);
            note("takes note of the end of one", self.end(2).await);
        }
        note("takes the mission of a person", self.drives_a_person(&scan).await);
        note("stays alive after bytes that are no step", self.garbage().await);
        note("answers as before after them", step(1, 5, 1, false).await);
        note("answers 200 steps", self.timed(&scan).await);
        note("takes note of the end", self.end(1).await);
        findings
    }

    async fn mission(&self, session: u64, person: Option<MissionPerson>) -> Result<MissionAnswer, String> {
        let cells = vec![0_u8; SIDE * SIDE];
        let message = MissionMessage {
            socrates: "mission".to_owned(),
            version: lockstep::VERSION,
            session,
            run: RunId::new(format!("check.{}-{session}", self.name.in_runs())).map_err(|bad| bad.to_string())?,
            planner: self.name.clone(),
            seed: session,
            mode: "step".to_owned(),
            robot: RobotFile::from(&person.as_ref().map_or_else(RobotModel::default, |one| body_of(one.id, 0.28))),
            person,
            goal: [12.0, 7.5],
            waypoints: vec![[2.0, 7.5], [7.0, 7.5], [12.0, 7.5]],
            plan: vec![[2.0, 7.5], [12.0, 7.5]],
            doors: vec![MissionDoor { id: "door".to_owned(), from: [9.0, 7.0], to: [9.0, 8.0] }],
            people: (1..=50).map(HumanId::new).collect(),
            map: MissionMap {
                width: SIDE,
                height: SIDE,
                resolution_m: 0.05,
                origin: [0.0, 0.0],
                yaw: 0.0,
                digest: Digest::of(&cells),
            },
        };
        self.line.mission(&message).await
    }

    async fn map(&self, session: u64) -> Result<String, String> {
        self.line.map(session, &[0; SIDE * SIDE]).await.map(|()| format!("{} cells", SIDE * SIDE))
    }

    /// A session in which the driver is a person among two others, with a robot before them.
    async fn drives_a_person(&self, scan: &[f64]) -> Result<String, String> {
        let person = MissionPerson {
            id: HumanId::new(3),
            role: "visitor".to_owned(),
            relation: Relation::Frontal,
            behavior: "Comes toward the robot.".to_owned(),
            pace_mps: 1.2,
            meets: vec![[7.0, 7.5]],
            group: Vec::new(),
        };
        self.mission(3, Some(person)).await?;
        let told = self.step((3, 0), 2, (false, true), scan).await?;
        self.end(3).await?;
        Ok(told)
    }

    async fn step(
        &self,
        (session, call): (u64, u32),
        people: u32,
        (longer, robot): (bool, bool),
        scan: &[f64],
    ) -> Result<String, String> {
        let bytes = observed((session, call), people, robot, scan);
        let bytes = if longer { lengthened(&bytes) } else { bytes };
        let answer = self.line.step(bytes, PATIENCE).await.map_err(|why| told(&why))?;
        let command = read_command(&answer, session, call).map_err(|bad| bad.to_string())?;
        Ok(format!("{:.2} m/s, {:.2} rad/s", command.v, command.omega))
    }

    /// Something has to come back, be it that the driver gives up.
    async fn garbage(&self) -> Result<String, String> {
        let answer = self.line.step(b"SOCOx".to_vec(), PATIENCE).await.map_err(|why| told(&why))?;
        let told = read_command(&answer, 0, 0).map_or_else(|bad| bad.to_string(), |_| "a command".to_owned());
        Ok(told.chars().take(60).collect())
    }

    async fn timed(&self, scan: &[f64]) -> Result<String, String> {
        let mut times = Vec::new();
        for call in 6..6 + TIMED {
            let begun = Instant::now();
            self.step((1, call), 3, (false, false), scan).await?;
            times.push(begun.elapsed());
        }
        times.sort();
        let at = |share: usize| times.get(times.len() * share / 100).map_or(0.0, |time| time.as_secs_f64() * 1e3);
        Ok(format!("half within {:.2} ms, 95 of 100 within {:.2} ms", at(50), at(95)))
    }

    async fn end(&self, session: u64) -> Result<String, String> {
        let message =
            EndMessage { socrates: "end".to_owned(), session, reason: "done".to_owned(), time_s: 1.0, arrived: true };
        self.line.end(&message, PATIENCE).await.map(|()| String::new())
    }
}

/// A step with so many people in rows ahead, and with the robot, where a person is driven.
fn observed((session, call): (u64, u32), people: u32, robot: bool, scan: &[f64]) -> Vec<u8> {
    let person = |number: u32| {
        let (row, column) = (f64::from(number / 7), f64::from(number % 7));
        let away = Vector::new(1.0 + row, column - 3.0);
        SeenPerson {
            id: HumanId::new(number),
            at: Point::new(3.0, 7.5) + away,
            velocity: -away * 0.1,
            yaw: 0.1 * f64::from(number),
            radius_m: 0.28,
            gesture: None,
        }
    };
    let people: Vec<SeenPerson> = (1..=people).map(person).collect();
    let door = SeenDoor {
        id: "door".to_owned(),
        from: Point::new(9.0, 7.0),
        to: Point::new(9.0, 8.0),
        open: call.is_multiple_of(2),
    };
    let before = SeenRobot {
        at: Point::new(5.0, 7.5),
        velocity: Vector::new(-0.3, 0.0),
        yaw: std::f64::consts::PI,
        radius_m: 0.25,
        gesture: None,
        in_sight: true,
    };
    let head = StepHead { session, call, goal: Point::new(12.0, 7.5), ahead: Point::new(3.8, 7.5) };
    let seen = Observation {
        time: SimTime::at_tick(u64::from(call) * 10),
        pose: Pose { x: 3.0, y: 7.5, yaw: 0.1 },
        v: 0.3,
        vy: 0.0,
        omega: 0.0,
        people: &people,
        robot: robot.then_some(before),
        everybody: &Vec::new,
        doors: &[door],
        lidar: &Vec::new,
        cues: Cues::default(),
    };
    step_bytes(&head, &seen, &[], scan)
}

/// The same with 8 bytes more in the head and in each person, as a later version may write it.
fn lengthened(bytes: &[u8]) -> Vec<u8> {
    let (head, rest) = bytes.split_at_checked(HEAD_BYTES).unwrap_or((bytes, &[]));
    let mut head = head.to_vec();
    let counted = |value: usize| u16::try_from(value).unwrap_or(u16::MAX).to_le_bytes();
    let people = head.get(20..22).and_then(|two| two.try_into().ok()).map_or(0, u16::from_le_bytes);
    for (at, value) in [(6, HEAD_BYTES + 8), (22, PERSON_BYTES + 8)] {
        head.iter_mut().skip(at).zip(counted(value)).for_each(|(slot, byte)| *slot = byte);
    }
    head.extend([0; 8]);
    let (persons, rest) = rest.split_at_checked(usize::from(people) * PERSON_BYTES).unwrap_or((rest, &[]));
    for person in persons.chunks(PERSON_BYTES) {
        head.extend_from_slice(person);
        head.extend([0; 8]);
    }
    head.extend_from_slice(rest);
    head
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_longer_step_is_read_like_the_short_one() {
        let short = observed((7, 2), 3, true, &[1.0; 4]);
        let long = lengthened(&short);
        assert_eq!(long.len(), short.len() + 8 * 5);
        assert_eq!(lockstep::read_step(&long).unwrap(), lockstep::read_step(&short).unwrap());
    }
}
