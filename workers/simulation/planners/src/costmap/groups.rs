//! The group layer: the space of a group as a filled ellipse.
//!
//! Nav2CAN finds groups with a neural net that looks at its social map. Here they are given by ids, or found by where people stand
//! and look (F-formations).

use std::f64::consts::PI;

use socrates_model::geometry::{nearest_on_segment, wrap_angle};
use socrates_model::{HumanId, Point, SeenPerson, Vector};

use super::grid::{Bounds, Costmap, INSCRIBED};
use super::layered::{Layer, Sensed};
use super::people::raise;

/// Thresholds of F-formations; values are ours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FFormationParams {
    /// Somebody slower than this stands, m/s; default 0.2.
    pub standing_speed: f64,
    /// The middle of a group that somebody looks at is so far ahead of them, m; default 0.7.
    pub o_space_distance: f64,
    /// Two who stand belong together where the middles they look at are nearer than this, m; default 0.6.
    pub o_space_apart: f64,
    /// And they themselves are nearer than this, m; default 2.5.
    pub members_apart: f64,
    /// Two who walk belong together when nearer than this, m; default 1.5.
    pub walkers_apart: f64,
    /// And with headings that differ by less than this, rad; default 25 degrees.
    pub heading_apart: f64,
    /// And with speeds that differ by less than this, m/s; default 0.3.
    pub speed_apart: f64,
}

impl Default for FFormationParams {
    fn default() -> Self {
        Self {
            standing_speed: 0.2,
            o_space_distance: 0.7,
            o_space_apart: 0.6,
            members_apart: 2.5,
            walkers_apart: 1.5,
            heading_apart: 25.0 * PI / 180.0,
            speed_apart: 0.3,
        }
    }
}

/// How groups are known.
#[derive(Debug, Clone, PartialEq)]
pub enum GroupSource {
    /// The group that each human belongs to.
    Given(Vec<(HumanId, u32)>),
    /// By where people stand and look, or how they walk.
    FFormation(FFormationParams),
}

/// Parameters of the group layer.
#[derive(Debug, Clone, PartialEq)]
pub struct GroupsParams {
    /// How groups are known; default F-formations.
    pub source: GroupSource,
    /// Cost inside the ellipse; default 253: no way leads through. Nav2CAN's code says 150, its shipped files 253.
    pub interaction_cost: u8,
    /// So long a group no longer seen is kept, s; default 2. Nav2CAN's shipped files have 5 in the global map.
    pub keeptime: f64,
    /// Room round the box of the members, m; default 0.25.
    pub margin: f64,
    /// Half width of the ellipse of two, across the line between them, m; default 0.4.
    pub pair_half_width: f64,
}

impl Default for GroupsParams {
    fn default() -> Self {
        let source = GroupSource::FFormation(FFormationParams::default());
        Self { source, interaction_cost: INSCRIBED, keeptime: 2.0, margin: 0.25, pair_half_width: 0.4 }
    }
}

impl FFormationParams {
    fn stands(&self, person: &SeenPerson) -> bool {
        person.velocity.norm() < self.standing_speed
    }

    /// The middle of the group that somebody who stands looks at.
    fn o_space(&self, person: &SeenPerson) -> Point {
        person.at + Vector::new(libm::cos(person.yaw), libm::sin(person.yaw)) * self.o_space_distance
    }

    /// Whether two people belong together.
    #[must_use]
    pub fn linked(&self, a: &SeenPerson, b: &SeenPerson, people: &[SeenPerson]) -> bool {
        let apart_m = (a.at - b.at).norm();
        match (self.stands(a), self.stands(b)) {
            (true, true) => {
                let (seen_by_a, seen_by_b) = (self.o_space(a), self.o_space(b));
                let middle = middle_of(&seen_by_a, &seen_by_b);
                let between = |member: &SeenPerson, other: &SeenPerson| {
                    other.id != a.id
                        && other.id != b.id
                        && nearest_on_segment(&other.at, &member.at, &middle).0 < other.radius_m
                };
                apart_m < self.members_apart
                    && (seen_by_a - seen_by_b).norm() < self.o_space_apart
                    && !people.iter().any(|other| between(a, other) || between(b, other))
            }
            (false, false) => {
                let heading = |person: &SeenPerson| libm::atan2(person.velocity.y, person.velocity.x);
                apart_m < self.walkers_apart
                    && wrap_angle(heading(a) - heading(b)).abs() < self.heading_apart
                    && (a.velocity.norm() - b.velocity.norm()).abs() < self.speed_apart
            }
            (true, false) | (false, true) => false,
        }
    }
}

fn middle_of(a: &Point, b: &Point) -> Point {
    a + (b - a) * 0.5
}

/// The space of one group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipse {
    /// Middle, m.
    pub center: Point,
    /// Unit vector of the first half axis.
    pub axis: Vector,
    /// Half axes along and across `axis`, m.
    pub half_m: (f64, f64),
}

impl Ellipse {
    /// Whether an offset from the middle, m, is inside.
    #[must_use]
    pub fn covers(&self, offset: &Vector) -> bool {
        let (x, y) = (offset.dot(&self.axis) / self.half_m.0, self.axis.perp(offset) / self.half_m.1);
        x * x + y * y <= 1.0
    }

    /// The ellipse of people: along the line between two, else in the box of their places along the axes of the map. `None` of
    /// fewer than two.
    #[must_use]
    pub fn of<'a>(params: &GroupsParams, members: impl Iterator<Item = &'a Point> + Clone) -> Option<Self> {
        let mut places = members.clone();
        let (first, second) = (places.next()?, places.next()?);
        if places.next().is_none() {
            let way = second - first;
            let apart_m = way.norm();
            let axis = if apart_m > 0.0 { way / apart_m } else { Vector::new(1.0, 0.0) };
            let half_m = (apart_m / 2.0 + params.margin, params.pair_half_width);
            return Some(Self { center: middle_of(first, second), axis, half_m });
        }
        let (least, most) = members.fold((*first, *first), |(least, most), at| {
            (Point::new(least.x.min(at.x), least.y.min(at.y)), Point::new(most.x.max(at.x), most.y.max(at.y)))
        });
        let half = (most - least) * 0.5;
        let half_m = (half.x + params.margin, half.y + params.margin);
        Some(Self { center: middle_of(&least, &most), axis: Vector::new(1.0, 0.0), half_m })
    }
}

/// The group layer.
#[derive(Debug)]
pub struct GroupLayer {
    params: GroupsParams,
    /// Group of each person seen now: the given number, or the place of its first member in the list of people.
    group_of: Vec<Option<u32>>,
    /// Number of each group, its ellipse, and when it was seen, s.
    groups: Vec<(u32, Ellipse, f64)>,
    places: Vec<Point>,
    last: Bounds,
}

impl GroupLayer {
    /// The layer.
    #[must_use]
    pub fn new(params: &GroupsParams) -> Self {
        let (group_of, groups, places) = (Vec::new(), Vec::new(), Vec::new());
        Self { params: params.clone(), group_of, groups, places, last: Bounds::EMPTY }
    }

    /// The ellipses in the map.
    pub fn ellipses(&self) -> impl Iterator<Item = &Ellipse> {
        self.groups.iter().map(|(_, ellipse, _)| ellipse)
    }

    /// Says who belongs to which group.
    fn part(&mut self, people: &[SeenPerson]) {
        self.group_of.clear();
        match &self.params.source {
            GroupSource::Given(given) => {
                let group = |id: HumanId| given.iter().find(|(member, _)| *member == id).map(|(_, group)| *group);
                self.group_of.extend(people.iter().map(|person| group(person.id)));
            }
            GroupSource::FFormation(rules) => {
                // A group is named by its smallest id; ids of linked people sink until nothing changes.
                self.group_of.extend(people.iter().map(|person| Some(person.id.number())));
                for _ in people {
                    let mut sank = false;
                    for (place, a) in people.iter().enumerate() {
                        for (other, b) in people.iter().enumerate().skip(place + 1) {
                            if !rules.linked(a, b, people) {
                                continue;
                            }
                            let groups = [place, other].map(|member| self.group_of.get(member).copied().flatten());
                            let [Some(first), Some(second)] = groups else { continue };
                            let least = first.min(second);
                            sank |= first != second;
                            for member in [place, other] {
                                if let Some(group) = self.group_of.get_mut(member) {
                                    *group = Some(least);
                                }
                            }
                        }
                    }
                    if !sank {
                        break;
                    }
                }
            }
        }
    }
}

impl Layer for GroupLayer {
    fn look(&mut self, map: &Costmap, sensed: &Sensed<'_>, bounds: &mut Bounds) {
        self.part(sensed.people);
        let keeptime = self.params.keeptime;
        self.groups.retain(|(_, _, seen_s)| sensed.now_s - seen_s <= keeptime);
        for (place, group) in self.group_of.iter().enumerate() {
            let Some(group) = *group else { continue };
            if self.group_of.iter().take(place).any(|earlier| *earlier == Some(group)) {
                continue;
            }
            let members = sensed.people.iter().zip(&self.group_of).filter(|(_, of)| **of == Some(group));
            self.places.clear();
            self.places.extend(members.map(|(person, _)| person.at));
            let Some(ellipse) = Ellipse::of(&self.params, self.places.iter()) else { continue };
            // A group seen again is drawn where it is now, and not where it was.
            self.groups.retain(|(known, _, _)| *known != group);
            self.groups.push((group, ellipse, sensed.now_s));
        }
        let mut now = Bounds::EMPTY;
        for ellipse in self.ellipses() {
            now.join(&map.square(&ellipse.center, ellipse.half_m.0.max(ellipse.half_m.1)));
        }
        bounds.join(&self.last);
        bounds.join(&now);
        self.last = now;
    }

    fn write(&mut self, map: &mut Costmap, bounds: &Bounds, _sensed: &Sensed<'_>) {
        let cost = self.params.interaction_cost;
        for ellipse in self.ellipses() {
            let reach_m = ellipse.half_m.0.max(ellipse.half_m.1);
            let here = map.square(&ellipse.center, reach_m).meet(bounds);
            raise(map, &here, &ellipse.center, |offset| ellipse.covers(offset).then_some(cost));
        }
    }

    fn roll(&mut self, _columns: isize, _rows: isize) {
        self.last = Bounds::EMPTY;
    }

    fn clear(&mut self) {
        self.groups.clear();
        self.last = Bounds::EMPTY;
    }
}
