//! One tick of motion: paces, wishes, forces, contacts.

use socrates_model::time::STEP_SECS;
use socrates_model::{Action, AgentId, DoorOpens, GroupId, HumanId, Point, Relation, SimTime};

use crate::block::take_places;
use crate::contacts::{self, Body};
use crate::human::{DoorOnWay, Human};
use crate::make_room::is_held_up;
use crate::motion::{self, Scene, Want};
use crate::near::{Near, Other};
use crate::recorder::Recorder;
use crate::rendezvous::{self, Moment};
use crate::robot::Robot;
use crate::run::Engine;
use crate::walk::{self, Pairs, Steps, Walker};

/// People whose forces are computed at once: enough to fill the lanes, few enough for the nearest cache.
const AT_ONCE: usize = 32;

/// People line up at the end of their way over so much of it, m; whose ends are nearer to each other than this share it, m.
const LINE_M: f64 = 4.0;
const SAME_END_M: f64 = 1.0;
/// A person who stands in that line moves slower than this, m/s, and has another this near ahead of them, m.
const LINED_UP_MPS: f64 = 0.12;
const NEXT_M: f64 = 1.15;
/// Between people of a group who go one behind the other, m.
const IN_LINE_M: f64 = 0.8;

/// People nearer than this before the robot are before it together, m.
const BEFORE_M: f64 = 8.0;

/// Lists that every tick fills again; kept, so that no tick makes any.
#[derive(Debug, Default)]
pub(crate) struct Desk {
    walker: Walker,
    around: Vec<Other>,
    pairs: Vec<Pairs>,
    wants: Vec<Want>,
    bodies: Vec<Body>,
}

impl Engine {
    /// Moves everybody by one tick.
    pub(crate) fn advance(&mut self, now: SimTime, doors_moved: bool, recorder: &mut Recorder) {
        let now_s = now.secs();
        if let Some(robot) = &self.robot {
            take_places(&mut self.humans, robot);
        }
        self.line_up();
        let Self { humans, robot, near, .. } = &mut *self;
        let people = humans.iter().filter(|human| human.present()).map(Other::from);
        let anew = near.fill(people.chain(robot.iter().map(Other::from))) | doors_moved;
        let led: Vec<HumanId> = self.humans.iter().filter_map(watched).collect();
        let trails = self
            .humans
            .iter()
            .filter(|human| led.contains(&human.id))
            .map(|human| (human.id, (human.at, human.velocity, human.trail.clone())))
            .collect();
        let paces = self.doors_and_paces(now_s);
        let mut wants = std::mem::take(&mut self.desk.wants);
        let mut bodies = std::mem::take(&mut self.desk.bodies);
        wants.clear();
        bodies.clear();
        let count = self.humans.len();
        for (number, (humans, paces)) in self.humans.chunks_mut(AT_ONCE).zip(paces.chunks(AT_ONCE)).enumerate() {
            let Desk { walker, around, pairs, .. } = &mut self.desk;
            walker.begin(count);
            pairs.clear();
            for (place, (human, pace)) in (number * AT_ONCE..).zip(humans.iter_mut().zip(paces)) {
                if human.is_recorded() {
                    human.replay(now_s + STEP_SECS);
                    wants.push(Want::STAND);
                    pairs.push(Pairs::default());
                    continue;
                }
                let looks = anew || human.notice.stale || Near::is_turn(now.tick(), place);
                if looks {
                    self.near.look(human, &self.floor);
                }
                // Somebody who gets on goes by what it made of the others at its last look.
                let gets_on = human.gets_on() && now_s >= human.yields_until_s && !is_held_up(human);
                around.clear();
                if looks || !gets_on {
                    self.near.noticed(&human.notice, around);
                }
                let scene = Scene {
                    location: &self.setup.location,
                    floor: &self.floor,
                    now_s,
                    looks,
                    robot: self.robot.as_ref(),
                    others: around,
                    trails: &trails,
                };
                let want = motion::want(human, &scene, *pace);
                pairs.push(walker.feel(human, &want, &self.near));
                wants.push(want);
            }
            walker.reckon(&self.params);
            let steps = Steps { params: &self.params, floor: &self.floor, near: &self.near };
            for ((human, pairs), want) in humans.iter_mut().zip(pairs).zip(wants.iter().skip(number * AT_ONCE)) {
                if human.is_recorded() {
                    if human.present() {
                        bodies.push(Body { yields: 0.0, ..body(human, human.at) });
                    }
                    continue;
                }
                walker.steer(human, want, pairs, &steps);
                human.started |= human.gets_on() && want.target.is_some();
                let yields = if want.target.is_some() { 1.0 } else { 0.02 };
                bodies.push(Body { yields, ..body(human, human.at + human.velocity * STEP_SECS) });
            }
        }
        if let Some(robot) = &mut self.robot {
            robot.step();
            let yields = if robot.velocity.norm() > 0.02 { 0.5 } else { 0.02 };
            bodies.push(Body {
                agent: AgentId::Robot,
                at: robot.at(),
                velocity: robot.velocity,
                radius_m: robot.model.radius_m,
                yields,
                clear: false,
            });
        }
        for touch in contacts::resolve(&mut bodies, &self.floor) {
            recorder.touch(touch);
        }
        let there = self.humans.iter_mut().zip(&wants).filter(|(human, _)| human.present());
        for ((human, want), body) in there.zip(&bodies).filter(|((human, _), _)| !human.is_recorded()) {
            walk::settle(human, want, body.at, body.velocity);
            if human.gets_on() {
                walk::progress(human);
            }
        }
        if let (Some(robot), Some(body)) = (&mut self.robot, bodies.last()) {
            robot.settle(body.at, body.velocity, self.floor.field());
        }
        (self.desk.wants, self.desk.bodies) = (wants, bodies);
    }

    /// A person who stands behind others who have come to the same end has come to it too: there is no room nearer to it.
    fn line_up(&mut self) {
        for place in 0..self.humans.len() {
            let (before, rest) = self.humans.split_at_mut(place);
            let Some((human, after)) = rest.split_first_mut() else { return };
            let left_m = human.route.length_m() - human.s;
            let waits = human.started && human.gets_on() && human.velocity.norm() < LINED_UP_MPS;
            if !waits || left_m > LINE_M || human.at_goal() || !human.is_through() {
                continue;
            }
            let ahead = human.route.direction(human.s);
            let there = |other: &&Human| {
                let way = other.at - human.at;
                let same = other.route.end().zip(human.route.end()).is_some_and(|(a, b)| (a - b).norm() < SAME_END_M);
                same && way.norm() < NEXT_M && way.dot(&ahead) > 0.0 && other.at_goal()
            };
            human.lined_up = before.iter().chain(&*after).any(|other| there(&other));
        }
    }

    /// Speed of each human on its way: rendezvous, closed doors ahead, and the pace of walking groups.
    fn doors_and_paces(&mut self, now_s: f64) -> Vec<f64> {
        let mut paces = Vec::with_capacity(self.humans.len());
        // A person without a meeting waits for no robot.
        let meets = self.humans.iter().any(|human| !human.meetings.is_empty());
        let nearest = self.robot.as_ref().filter(|_| meets).and_then(|robot| before(robot, &self.humans));
        let coming_out: Vec<usize> = self
            .humans
            .iter()
            .filter(|human| human.inside_still())
            .filter_map(|human| human.doors.first().map(|on_way| on_way.door))
            .collect();
        let holders = rendezvous::holders(&self.humans, self.robot.as_ref());
        for (human, timing) in self.humans.iter().zip(&mut self.timings) {
            if human.is_driven() {
                // Nobody but their driver tells them; others of their group keep up with what they do.
                paces.push(human.velocity.norm());
                continue;
            }
            let door = human.doors.iter().find(|on_way| on_way.s > human.s - 0.1);
            let let_out = door.is_none_or(|on_way| !coming_out.contains(&on_way.door));
            let live = |on_way: &DoorOnWay| self.doors.doors.get(on_way.door);
            let stands_open = door.and_then(live).is_some_and(|live| live.door.opens == DoorOpens::Always);
            let door = door.and_then(|on_way| Some((on_way.s - human.s, live(on_way)?.open)));
            // Sight matters to the controller only while a meeting lies ahead.
            let asked = !human.meetings.is_empty() || human.relation == Relation::Leaving;
            let sight = asked
                && human.notice.robot_seen.unwrap_or_else(|| {
                    self.robot.as_ref().is_some_and(|robot| self.floor.sees(&human.at, &robot.at()))
                });
            let first =
                asked && nearest.is_some_and(|(id, group)| id == human.id || group.is_some() && group == human.group);
            let held_up = rendezvous::is_held_up(&holders, human, timing);
            let moment = Moment { now_s, dt: STEP_SECS, sight, first, door, stands_open, let_out, held_up };
            // Other actions have their own speed; the rendezvous waits meanwhile.
            let mut pace = if human.gets_on() && !human.diverted {
                rendezvous::pace(human, timing, self.robot.as_ref(), &moment).speed_mps.min(human.fastest_mps)
            } else {
                human.speed_mps
            };
            if let Some(mps) = human.pace_mps.filter(|_| pace > 0.0) {
                pace = mps;
            }
            if door.is_some_and(|(left, open)| !open && left < 0.75 && human.started) {
                pace = 0.0;
            }
            paces.push(pace);
        }
        self.keep_groups_together(&mut paces);
        paces
    }

    /// Members of a walking group take the pace of their middle one, a little faster behind and slower in front; where there
    /// is no room to walk abreast they go one behind the other, whoever is ahead first.
    fn keep_groups_together(&self, paces: &mut [f64]) {
        for group in self.setup.proposal.groups.iter().filter(|group| !group.standing) {
            let ids = group.members.iter();
            let mut members: Vec<(usize, &Human)> =
                ids.filter_map(|id| self.humans.iter().enumerate().find(|(_, human)| human.id == *id)).collect();
            let left_m = |human: &Human| human.route.length_m() - human.s;
            members.sort_by(|(_, a), (_, b)| left_m(a).total_cmp(&left_m(b)));
            let middle = members.get(members.len().saturating_sub(1) / 2).and_then(|(place, _)| paces.get(*place));
            let Some(lead) = middle.copied() else { continue };
            let apart_m = if members.iter().any(|(_, human)| human.notice.in_line) { IN_LINE_M } else { 0.0 };
            let lag = |rank: u32, human: &Human| left_m(human) - apart_m * f64::from(rank);
            let lags: Vec<f64> = (0..).zip(&members).map(|(rank, (_, human))| lag(rank, human)).collect();
            #[expect(clippy::cast_precision_loss, reason = "a few people")]
            let mean = lags.iter().sum::<f64>() / lags.len().max(1) as f64;
            for ((place, _), lag) in members.iter().zip(lags) {
                if let Some(pace) = paces.get_mut(*place) {
                    let share = 1.0 + 0.6 * (lag - mean).clamp(-0.8, 0.8);
                    *pace = if lead > 0.0 { (lead * share).min(1.8) } else { 0.0 };
                }
            }
        }
    }
}

/// The human whom somebody follows or looks at.
const fn watched(human: &Human) -> Option<HumanId> {
    if let Action::FollowHuman(id) | Action::LookAt(id) = human.action { Some(id) } else { None }
}

/// Of several people before the robot the nearest, and its group: whoever comes alone is passed, and nobody waits.
fn before(robot: &Robot, humans: &[Human]) -> Option<(HumanId, Option<GroupId>)> {
    let (at, intent) = (robot.at(), robot.intent());
    let ahead = humans.iter().filter(|human| human.present() && (human.at - at).dot(&intent) > 0.0);
    let mut ahead = ahead.map(|human| ((human.at - at).norm(), human)).filter(|(far_m, _)| *far_m < BEFORE_M);
    let (first, second) = (ahead.next()?, ahead.next()?);
    let (_, nearest) =
        [second].into_iter().chain(ahead).fold(first, |one, other| if other.0 < one.0 { other } else { one });
    Some((nearest.id, nearest.group))
}

/// A human as contacts see it, at the place where it would be.
fn body(human: &Human, at: Point) -> Body {
    let clear = human.notice.clear && !human.is_recorded();
    Body { agent: human.agent(), at, velocity: human.velocity, radius_m: human.radius_m, yields: 1.0, clear }
}
