//! `reactive`: a simple baseline. It goes the shortest free way through its waypoints, slows down and stops for whoever is
//! ahead, and goes round whoever stands on that way. It knows the map and the people it sees, and neither the script nor the
//! intended way between the waypoints.

use socrates_model::{Command, Observation, Point, Polyline, RobotDriver, RobotModel};

use crate::detour;
use crate::ground::{Ground, Obstacle, STANDING_MPS, is_at_end, waits_at_door};
use crate::mission::Mission;
use crate::pursuit::{pursue, safe_share};

/// Calls per second.
const RATE_HZ: f64 = 20.0;
/// Its place on its way is looked for so far on, m.
const ON_M: f64 = 1.5;
/// Gap to whoever stands that it keeps, surface to surface, m; who walks is given what `safe_share` asks for.
const GAP_M: f64 = 0.06;
/// Whoever stands within this of its way, surface to surface, m, on so much of it, m, is on it.
const BLOCKS_M: f64 = 0.1;
const LOOK_M: f64 = 3.0;
/// A way round leads back at most so far on, m, to a place that is free by so much more, m.
const BACK_M: f64 = 4.4;
const FREE_M: f64 = 0.2;
/// Steps along a way, m.
const STEP_M: f64 = 0.2;
/// It looks so often whether somebody stands on its way, s.
const LOOK_S: f64 = 0.5;

/// The planner.
#[derive(Debug)]
pub(crate) struct Reactive {
    robot: RobotModel,
    ground: Ground,
    route: Polyline,
    /// Whether the way leads to the goal; where no way does it ends at the last waypoint that can be reached.
    complete: bool,
    s: f64,
    /// The way round somebody that is being gone, and how far, m.
    round: Option<(Polyline, f64)>,
    looked_s: f64,
}

impl Reactive {
    pub(crate) fn new(mission: &Mission) -> Self {
        let ground = Ground::new(mission);
        let (route, complete) = ground.through(&mission.waypoints);
        Self { robot: mission.robot, ground, route, complete, s: 0.0, round: None, looked_s: f64::NEG_INFINITY }
    }

    /// Goes on with a way round somebody, leaves it at its end, and plans one where somebody stands on the way.
    fn go_round(&mut self, seen: &Observation<'_>, at: &Point) {
        if let Some((way, s)) = &mut self.round {
            *s = way.project_within(at, *s, *s + ON_M).0;
            if *s > way.length_m() - 2.0 * STEP_M {
                self.round = None;
            }
        }
        let now = seen.time.secs();
        if now - self.looked_s < LOOK_S {
            return;
        }
        self.looked_s = now;
        let people: Vec<Obstacle> = standing(seen);
        let reach = self.robot.radius_m + BLOCKS_M;
        let blocked = |way: &Polyline, s: f64, more_m: f64| {
            people.iter().any(|person| person.gap_m(&way.point(s)) < reach + more_m)
        };
        let (way, s) = self.round.as_ref().map_or((&self.route, self.s), |(way, s)| (way, *s));
        let Some(first) = steps(s, LOOK_M).find(|s| blocked(way, *s, 0.0)) else { return };
        // Back on the way behind whoever stands there first.
        let from = if self.round.is_some() { self.s } else { first };
        let back =
            steps(from, self.s + BACK_M - from).find(|s| *s > self.s + STEP_M && !blocked(&self.route, *s, FREE_M));
        let way = back.and_then(|back| {
            detour::round(&self.ground, &people, &self.route, at, &self.route.point(back.min(self.route.length_m())))
        });
        self.round = way.map(|way| (way, 0.0));
    }
}

/// Lengths along a way, from `from` m on for `reach_m`, a step apart.
fn steps(from: f64, reach_m: f64) -> impl Iterator<Item = f64> {
    (0..64_u32).map(|step| STEP_M * f64::from(step)).take_while(move |far| *far <= reach_m).map(move |far| from + far)
}

/// Those who stand, as obstacles.
fn standing(seen: &Observation<'_>) -> Vec<Obstacle> {
    let stand = seen.people.iter().filter(|person| person.velocity.norm() < STANDING_MPS);
    stand.map(|person| Obstacle { from: person.at, to: person.at, radius_m: person.radius_m, hard: true }).collect()
}

impl RobotDriver for Reactive {
    fn rate_hz(&self) -> f64 {
        RATE_HZ
    }

    fn drive(&mut self, seen: &Observation<'_>) -> Command {
        let at = seen.pose.point();
        self.ground.look(seen);
        self.s = self.s.max(self.route.project_within(&at, self.s, self.s + ON_M).0);
        let stand = Command::default();
        if self.route.end().is_none() {
            return stand;
        }
        if is_at_end(&self.route, &at, self.s) {
            return Command { waiting: self.complete, ..stand };
        }
        if waits_at_door(seen, &self.route, self.s, self.robot.radius_m) {
            return Command { waiting: true, ..stand };
        }
        self.go_round(seen, &at);
        let (way, s) = self.round.as_ref().map_or((&self.route, self.s), |(way, s)| (way, *s));
        let share = safe_share(seen, way, s, &self.robot, GAP_M);
        pursue(seen, &self.ground, (way, s), share * self.robot.v_max_mps, &self.robot)
    }
}
