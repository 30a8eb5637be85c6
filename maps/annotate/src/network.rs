//! The skeleton as a network: junctions, tips and the branches between them, cleared of what the walls' roughness makes.

use std::collections::BTreeMap;

use socrates_maps::Layer;
use socrates_model::Vector;

use crate::cells::{Cell, ROUND, height, step};
use crate::floor::{Floor, Spot};

/// A tip reaches at least so far beyond the disc of free floor round its junction, m, and this share of the disc's radius more.
const SALIENT_M: f64 = 0.8;
/// See [`SALIENT_M`].
const SALIENT_SHARE: f64 = 0.4;
/// A way off open floor that ends is at least so long, m.
const POCKET_M: f64 = 2.5;
/// Junctions nearer to each other than this are one, m, or than this share of their clearance.
const ONE_JUNCTION_M: f64 = 0.9;
/// See [`ONE_JUNCTION_M`].
const ONE_JUNCTION_SHARE: f64 = 1.0;
/// Rise of the clearance along a way from which on it comes out of a corner: that of a right angle is 0.7.
const SLOPE: f64 = 0.4;
/// The rise is measured over so far, m.
const SLOPE_M: f64 = 0.35;
/// A way is looked at in so many places.
const BEHIND_PARTS: usize = 12;
/// A way behind furniture has walls within so many steps of 0.1 m on both sides.
const BEHIND_STEPS: u32 = 7;
/// What is led to a way over open floor ends at a place of it this near along it, m.
const ONE_PLACE_M: f64 = 1.6;
/// Passes of clearing at most: each shortens what is left.
const PASSES: usize = 60;

/// A place where branches end.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Knot {
    pub(crate) at: Spot,
    pub(crate) held: Option<Held>,
}

/// Why a knot stays where it is, whatever its branches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Held {
    /// It is a door: the number of its passage.
    Door(usize),
    /// It lies at the rim of open floor.
    Rim,
    /// It is a place on open floor.
    Open,
}

/// A way between two knots.
#[derive(Debug, Clone)]
pub(crate) struct Branch {
    pub(crate) ends: [usize; 2],
    /// From the first knot to the second, both included.
    pub(crate) path: Vec<Spot>,
}

impl Branch {
    pub(crate) fn length_m(&self) -> f64 {
        length_m(&self.path)
    }

    /// The same way walked from its second knot.
    fn reversed(mut self) -> Self {
        self.path.reverse();
        Self { ends: [self.ends[1], self.ends[0]], path: self.path }
    }
}

/// Length of a way, m.
pub(crate) fn length_m(path: &[Spot]) -> f64 {
    path.windows(2).map(|pair| if let [a, b] = pair { (b - a).norm() } else { 0.0 }).sum()
}

/// Knots and branches.
#[derive(Debug, Default)]
pub(crate) struct Network {
    pub(crate) knots: Vec<Knot>,
    pub(crate) branches: Vec<Branch>,
}

impl Network {
    /// The network of the cells of a skeleton.
    pub(crate) fn traced(floor: &Floor, on: &Layer<bool>) -> Self {
        let passed = Layer::filled(on.width, height(on), false);
        Tracer { floor, on, passed, knot_of: BTreeMap::new(), made: Self::default() }.trace()
    }

    /// How many ends of branches lie at each knot.
    fn degrees(&self) -> Vec<usize> {
        let mut degrees = vec![0; self.knots.len()];
        for end in self.branches.iter().flat_map(|branch| branch.ends) {
            if let Some(degree) = degrees.get_mut(end) {
                *degree += 1;
            }
        }
        degrees
    }

    fn at(&self, knot: usize) -> Spot {
        self.knots.get(knot).map_or_else(Spot::origin, |knot| knot.at)
    }

    fn is_held(&self, knot: usize) -> bool {
        self.knots.get(knot).is_some_and(|knot| knot.held.is_some())
    }

    /// Takes back tips that run into a corner of the floor: their clearance falls as fast as they go on, so they lead nowhere.
    pub(crate) fn trim(&mut self, floor: &Floor) {
        let degrees = self.degrees();
        for branch in &mut self.branches {
            for end in [0, 1] {
                let [first, last] = branch.ends;
                let tip = if end == 0 { first } else { last };
                let held = self.knots.get(tip).is_some_and(|knot| knot.held.is_some());
                if degrees.get(tip) != Some(&1) || held {
                    continue;
                }
                if end == 1 {
                    branch.path.reverse();
                }
                branch.path.drain(..into_corner(floor, &branch.path));
                if let (Some(knot), Some(at)) = (self.knots.get_mut(tip), branch.path.first()) {
                    knot.at = *at;
                }
                if end == 1 {
                    branch.path.reverse();
                }
            }
        }
    }

    /// Takes away tips that say nothing, joins junctions that are one, and branches that go on into each other.
    pub(crate) fn clear(&mut self, floor: &Floor) {
        for _ in 0..PASSES {
            let before = (self.branches.len(), self.knots.len());
            self.prune(floor);
            self.join_through();
            self.contract(floor);
            self.join_through();
            self.drop_loose();
            if before == (self.branches.len(), self.knots.len()) {
                return;
            }
        }
    }

    /// Takes away narrow ways between furniture and a wall: nobody walks there who does not have to.
    pub(crate) fn drop_behind_furniture(&mut self, floor: &Floor) {
        let mut at = 0;
        while let Some(branch) = self.branches.get(at) {
            if is_behind_furniture(floor, &branch.path) && self.is_joined_without(at) {
                self.branches.remove(at);
            } else {
                at += 1;
            }
        }
    }

    /// Whether the ends of a branch hang together without it.
    fn is_joined_without(&self, branch: usize) -> bool {
        let Some([from, to]) = self.branches.get(branch).map(|branch| branch.ends) else { return false };
        let mut seen = vec![false; self.knots.len()];
        let mut open = vec![from];
        while let Some(knot) = open.pop() {
            match seen.get_mut(knot) {
                Some(flag) if !*flag => *flag = true,
                Some(_) | None => continue,
            }
            let others =
                self.branches.iter().enumerate().filter(|(at, other)| *at != branch && other.ends.contains(&knot));
            open.extend(others.flat_map(|(_, other)| other.ends));
        }
        from == to || seen.get(to) == Some(&true)
    }

    /// Takes away the tips of one pass, the least telling of each junction first.
    fn prune(&mut self, floor: &Floor) {
        let mut degrees = self.degrees();
        let mut weak: Vec<(f64, usize)> = Vec::new();
        for (at, branch) in self.branches.iter().enumerate() {
            if let Some(salience) = self.salience(floor, branch, &degrees) {
                weak.extend((salience < 0.0).then_some((salience, at)));
            }
        }
        weak.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut gone = vec![false; self.branches.len()];
        for (_, at) in weak {
            let Some(branch) = self.branches.get(at) else { continue };
            // A junction keeps two ways: what goes on through it may be a way of its own.
            let keeps = branch.ends.iter().all(|end| degrees.get(*end).is_some_and(|degree| *degree != 2));
            if keeps && let Some(slot) = gone.get_mut(at) {
                *slot = true;
                for end in branch.ends {
                    if let Some(degree) = degrees.get_mut(end) {
                        *degree -= 1;
                    }
                }
            }
        }
        let mut gone = gone.into_iter();
        self.branches.retain(|_| gone.next() != Some(true));
    }

    /// How far a tip reaches beyond what it has to, m; none where both ends of a branch lead on, or a door is at its tip.
    fn salience(&self, floor: &Floor, branch: &Branch, degrees: &[usize]) -> Option<f64> {
        let tip = |end: usize| degrees.get(end) == Some(&1) && !self.is_held(end);
        let [a, b] = branch.ends;
        let (junction, tip) = match (tip(a), tip(b)) {
            (true, false) => (b, a),
            (false, true) => (a, b),
            (true, true) | (false, false) => return None,
        };
        match self.knots.get(junction).and_then(|knot| knot.held) {
            Some(Held::Rim) => return Some(branch.length_m() - POCKET_M),
            Some(Held::Door(_) | Held::Open) => return None,
            None => {}
        }
        let (wide, narrow) = (floor.clean_m(&self.at(junction)), floor.clean_m(&self.at(tip)));
        Some(branch.length_m() + narrow - wide - SALIENT_M - SALIENT_SHARE * wide)
    }

    /// Adds a knot.
    pub(crate) fn add(&mut self, at: Spot, held: Option<Held>) -> usize {
        self.knots.push(Knot { at, held });
        self.knots.len() - 1
    }

    /// A knot at a place of a branch: one that is near along it, or a new one that parts it.
    pub(crate) fn parted(&mut self, branch: usize, place: usize) -> Option<usize> {
        let known = self.branches.get(branch)?;
        let (before, after) = (known.path.get(..=place)?, known.path.get(place..)?);
        let [first, last] = known.ends;
        let near = |knot: usize, piece: &[Spot]| {
            let most_m = match self.knots.get(knot)?.held {
                Some(Held::Door(_)) => return None,
                Some(Held::Open) => ONE_PLACE_M,
                Some(Held::Rim) | None => ONE_JUNCTION_M,
            };
            (length_m(piece) <= most_m).then_some(knot)
        };
        let (to_first, to_last) = (near(first, before), near(last, after));
        if let Some(knot) =
            if length_m(before) <= length_m(after) { to_first.or(to_last) } else { to_last.or(to_first) }
        {
            return Some(knot);
        }
        let (before, after) = (before.to_vec(), after.to_vec());
        let at = *after.first()?;
        let knot = self.add(at, None);
        *self.branches.get_mut(branch)? = Branch { ends: [first, knot], path: before };
        self.branches.push(Branch { ends: [knot, last], path: after });
        Some(knot)
    }

    /// Joins the two branches at knots that have no other.
    pub(crate) fn join_through(&mut self) {
        let degrees = self.degrees();
        let mut at_knot: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (at, branch) in self.branches.iter().enumerate() {
            for end in branch.ends {
                at_knot.entry(end).or_default().push(at);
            }
        }
        let mut slots: Vec<Option<Branch>> = self.branches.drain(..).map(Some).collect();
        // Where a branch went that was joined to another.
        let mut moved: Vec<usize> = (0..slots.len()).collect();
        for (knot, degree) in degrees.iter().enumerate() {
            if *degree != 2 || self.knots.get(knot).is_some_and(|knot| knot.held.is_some()) {
                continue;
            }
            let mut both = at_knot.get(&knot).into_iter().flatten().map(|at| found(&moved, *at));
            let (Some(first), Some(second)) = (both.next(), both.next()) else { continue };
            if first == second {
                continue;
            }
            let take = |slots: &mut Vec<Option<Branch>>, at: usize| slots.get_mut(at).and_then(Option::take);
            let (Some(mut one), Some(mut other)) = (take(&mut slots, first), take(&mut slots, second)) else {
                continue;
            };
            if one.ends[1] != knot {
                one = one.reversed();
            }
            if other.ends[0] != knot {
                other = other.reversed();
            }
            one.path.extend(other.path.into_iter().skip(1));
            one.ends = [one.ends[0], other.ends[1]];
            if let Some(slot) = slots.get_mut(first) {
                *slot = Some(one);
            }
            if let Some(slot) = moved.get_mut(second) {
                *slot = first;
            }
        }
        self.branches = slots.into_iter().flatten().collect();
    }

    /// Makes junctions one that lie within each other's free disc.
    fn contract(&mut self, floor: &Floor) {
        let degrees = self.degrees();
        let mut onto: Vec<usize> = (0..self.knots.len()).collect();
        let mut short: Vec<(f64, usize)> = Vec::new();
        for (at, branch) in self.branches.iter().enumerate() {
            let [a, b] = branch.ends;
            let junction = |end: usize| degrees.get(end).is_some_and(|degree| *degree > 2) && !self.is_held(end);
            if a == b || !junction(a) || !junction(b) {
                continue;
            }
            let clear_m = floor.clean_m(&self.at(a)).min(floor.clean_m(&self.at(b)));
            let length = branch.length_m();
            short.extend((length < ONE_JUNCTION_M.max(ONE_JUNCTION_SHARE * clear_m)).then_some((length, at)));
        }
        short.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut gone = vec![false; self.branches.len()];
        for (_, at) in short {
            let Some(branch) = self.branches.get(at) else { continue };
            let [a, b] = branch.ends.map(|end| found(&onto, end));
            // Each junction takes part once a pass, so that a row of them does not run together.
            let fresh = branch.ends == [a, b]
                && !onto.iter().enumerate().any(|(from, to)| from != *to && (*to == a || *to == b));
            if a == b || !fresh {
                continue;
            }
            let middle = branch.path.get(branch.path.len() / 2).copied().unwrap_or_else(|| self.at(a));
            if let Some(knot) = self.knots.get_mut(a) {
                knot.at = middle;
            }
            if let (Some(slot), Some(lost)) = (onto.get_mut(b), gone.get_mut(at)) {
                *slot = a;
                *lost = true;
            }
        }
        let mut gone = gone.into_iter();
        self.branches.retain(|_| gone.next() != Some(true));
        for branch in &mut self.branches {
            let ends = branch.ends.map(|end| found(&onto, end));
            let at = ends.map(|end| self.knots.get(end).map_or_else(Spot::origin, |knot| knot.at));
            if let Some(first) = branch.path.first_mut() {
                *first = at[0];
            }
            if let Some(last) = branch.path.last_mut() {
                *last = at[1];
            }
            branch.ends = ends;
        }
        // A way round nothing: what a junction's own cells left.
        self.branches.retain(|branch| branch.ends[0] != branch.ends[1] || branch.length_m() > 3.0);
    }

    /// Forgets knots without branches.
    fn drop_loose(&mut self) {
        let degrees = self.degrees();
        let mut number = 0;
        let places: Vec<usize> = self
            .knots
            .iter()
            .zip(&degrees)
            .map(|(knot, degree)| {
                let own = number;
                number += usize::from(*degree > 0 || knot.held.is_some());
                own
            })
            .collect();
        let mut degrees = degrees.into_iter();
        self.knots.retain(|knot| degrees.next() != Some(0) || knot.held.is_some());
        for branch in &mut self.branches {
            branch.ends = branch.ends.map(|end| places.get(end).copied().unwrap_or(end));
        }
    }
}

/// Whether a way is narrow and has furniture on one side and a wall on the other, for a third of it.
fn is_behind_furniture(floor: &Floor, path: &[Spot]) -> bool {
    let one_sided = |part: &usize| {
        let place = path.len() * part / BEHIND_PARTS;
        let (Some(spot), Some(next)) = (path.get(place), path.get(place + 1)) else { return false };
        let Some(along) = (next - spot).try_normalize(1e-9) else { return false };
        let aside = Vector::new(-along.y, along.x);
        let side = |way: f64| {
            let hit = (1..=BEHIND_STEPS).map(|step| spot + aside * (way * f64::from(step) * 0.1));
            let hit = hit.into_iter().find(|spot| floor.clean_m(spot) <= 0.0)?;
            // A little farther on: the first place may lie on the border of a free cell.
            Some(floor.things.holds(floor.pixel(&(hit + aside * (way * 1.5 * floor.cell_m)))))
        };
        matches!((side(1.0), side(-1.0)), (Some(one), Some(other)) if one != other)
    };
    path.len() > 2 * BEHIND_PARTS && (1..BEHIND_PARTS).filter(one_sided).count() * 3 >= BEHIND_PARTS
}

/// How many places at the beginning of a way lie where it runs into a corner; at least two stay.
fn into_corner(floor: &Floor, path: &[Spot]) -> usize {
    let slope = |from: usize| {
        let mut to = from + 1;
        let first = path.get(from)?;
        while path.get(to).is_some_and(|spot| (spot - first).norm() < SLOPE_M) {
            to += 1;
        }
        let last = path.get(to)?;
        Some((floor.clean_m(last) - floor.clean_m(first)) / (last - first).norm())
    };
    let steep = (0..path.len()).take_while(|from| slope(*from).is_some_and(|slope| slope >= SLOPE)).count();
    steep.min(path.len().saturating_sub(2))
}

/// Where a number leads in the end.
fn found(onto: &[usize], mut at: usize) -> usize {
    while let Some(next) = onto.get(at).copied().filter(|next| *next != at) {
        at = next;
    }
    at
}

struct Tracer<'a> {
    floor: &'a Floor,
    on: &'a Layer<bool>,
    /// Cells that lie on a branch already.
    passed: Layer<bool>,
    knot_of: BTreeMap<Cell, usize>,
    made: Network,
}

impl Tracer<'_> {
    fn is_on(&self, cell: Cell) -> bool {
        self.on.get(cell.0, cell.1) == Some(true)
    }

    fn is_passed(&self, cell: Cell) -> bool {
        self.passed.get(cell.0, cell.1) == Some(true)
    }

    /// The neighbors of a cell; a diagonal one only where no side leads round to it.
    fn beside(&self, cell: Cell) -> Vec<Cell> {
        let at = |place: usize| ROUND.get(place % 8).map(|way| step(cell, *way)).filter(|next| self.is_on(*next));
        let mut out: Vec<Cell> = [1, 3, 5, 7].into_iter().filter_map(at).collect();
        let alone = |place: usize| at(place + 7).is_none() && at(place + 1).is_none();
        out.extend([0, 2, 4, 6].into_iter().filter(|place| alone(*place)).filter_map(at));
        out
    }

    fn trace(mut self) -> Network {
        let cells: Vec<Cell> = (0..height(self.on))
            .flat_map(|row| (0..self.on.width).map(move |column| (column, row)))
            .filter(|cell| self.is_on(*cell))
            .collect();
        for cell in &cells {
            if self.beside(*cell).len() != 2 && !self.knot_of.contains_key(cell) {
                self.knot(*cell);
            }
        }
        self.branches(&cells);
        // Rings without a junction: any of their cells is a knot.
        for cell in &cells {
            let covered = self.knot_of.contains_key(cell) || self.is_passed(*cell);
            if !covered && self.beside(*cell).len() == 2 {
                self.knot(*cell);
                self.branches(&[*cell]);
            }
        }
        self.made
    }

    /// A knot of a cell and of the junction cells that touch it.
    fn knot(&mut self, first: Cell) {
        let junction = self.beside(first).len() > 2;
        let number = self.made.knots.len();
        let (mut open, mut all) = (vec![first], Vec::new());
        self.knot_of.insert(first, number);
        while let Some(cell) = open.pop() {
            all.push(cell);
            if !junction {
                break;
            }
            for next in self.beside(cell) {
                if self.beside(next).len() > 2 && !self.knot_of.contains_key(&next) {
                    self.knot_of.insert(next, number);
                    open.push(next);
                }
            }
        }
        let roomiest = all
            .iter()
            .copied()
            .max_by(|a, b| self.floor.clear_of(*a).total_cmp(&self.floor.clear_of(*b)).then(b.cmp(a)));
        let at = self.floor.spot(roomiest.unwrap_or(first));
        self.made.knots.push(Knot { at, held: None });
    }

    /// The branches that begin at cells of knots.
    fn branches(&mut self, cells: &[Cell]) {
        for first in cells {
            let Some(start) = self.knot_of.get(first).copied() else { continue };
            for second in self.beside(*first) {
                if self.is_passed(second) {
                    continue;
                }
                if let Some(end) = self.knot_of.get(&second).copied() {
                    // Two knots side by side; each pair once.
                    if end > start {
                        self.push(start, end, &[]);
                    }
                    continue;
                }
                let (mut way, mut before, mut here) = (Vec::new(), *first, second);
                let end = loop {
                    way.push(here);
                    self.passed.set(here.0, here.1, true);
                    let next = self.beside(here).into_iter().find(|next| *next != before && !self.is_passed(*next));
                    let Some(next) = next else { break None };
                    if let Some(end) = self.knot_of.get(&next) {
                        break Some(*end);
                    }
                    (before, here) = (here, next);
                };
                if let Some(end) = end {
                    self.push(start, end, &way);
                } else if way.len() > 3 {
                    // Back at its beginning.
                    self.push(start, start, &way);
                }
            }
        }
    }

    fn push(&mut self, start: usize, end: usize, way: &[Cell]) {
        let spots = way.iter().map(|cell| self.floor.spot(*cell));
        let path = [self.made.at(start)].into_iter().chain(spots).chain([self.made.at(end)]).collect();
        self.made.branches.push(Branch { ends: [start, end], path });
    }
}
