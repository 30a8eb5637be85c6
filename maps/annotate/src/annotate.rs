//! The steps of an annotation in order.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;
use socrates_maps::Layer;
use socrates_model::paths::ROBOT_WAY_M;
use socrates_model::{
    Cell as Kind, Door, DoorKind, DoorOpens, Fault, FaultCode, GraphEdge, GraphNode, Grid, NodeId, Point, SceneGraph,
    Where,
};

use crate::cells::height;
use crate::floor::{BODY_M, Floor, Spot};
use crate::kind::{RegionKind, is_bay, kind, may_be_car};
use crate::naming::{Naming, letter};
use crate::open::Open;
use crate::region::{Regions, roomiest};
use crate::remark::{Remark, RemarkKind};
use crate::sketch::{Ground, Sketch, What};
use crate::thin::skeleton;
use crate::throat::{self, Opening, Throat};

/// Cells coarser than this show no doors, m.
const COARSE_M: f64 = 0.25;
/// Least floor that is annotated, m².
const LEAST_M2: f64 = 3.0;
/// A floor of a building has at least so many regions: two rooms and what leads to them.
const FLOOR_REGIONS: usize = 3;
/// Such a floor has at least this share of the floor that is annotated.
const FLOOR_SHARE: f64 = 0.3;
/// Floor that is cut off is named from this on, m².
const NAMED_M2: f64 = 4.0;
/// At most so many places of one kind are named one by one.
const NAMED_MOST: usize = 6;
/// Doors less sure than this are named.
const DOUBTFUL: f64 = 0.68;
/// Points in the map frame must lie this near to floor, m.
const NEAR_M: f64 = 1.0;

/// What a person may say about a map.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// A point on the floor that is annotated, map frame, m; by default the largest floor that hangs together, without that round
    /// the building.
    pub keep: Option<Point>,
    /// Corners of a polygon in the map frame, m; what lies outside of it is not looked at. Empty: the whole map.
    pub within: Vec<Point>,
    /// Points in rooms that are cars of elevators, map frame, m.
    pub elevators: Vec<Point>,
}

/// How much was found.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Doorways.
    pub doors: usize,
    /// Rooms behind doorways.
    pub rooms: usize,
    /// Cars of elevators.
    pub elevators: usize,
    /// Places where three or more ways meet.
    pub intersections: usize,
    /// Corners that hide what comes round them.
    pub corners: usize,
    /// Ends of ways.
    pub ends: usize,
    /// Places on wide floor.
    pub open_areas: usize,
    /// Places in narrow corridors.
    pub narrow: usize,
}

/// What was found on a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Annotation {
    /// Nodes and edges.
    pub graph: SceneGraph,
    /// Doors of rooms and cars; those of rooms always stand open, since nothing says that they have leaves.
    pub doors: Vec<Door>,
    /// A sentence or two about the place.
    pub description: String,
    /// How sure each node's type is, 0 to 1, in the order of the nodes.
    pub confidence: Vec<f64>,
    /// What was left out, doubted, or is asked.
    pub remarks: Vec<Remark>,
    /// How much was found.
    pub counts: Counts,
}

/// Finds places, ways, rooms and doors on a map.
///
/// Needs about 3 bytes of memory per byte of the map's distance field, and 0.2 µs a cell.
///
/// # Errors
/// `M-VALUE` where a point or polygon of the options is not on the map's floor or the grid measures nothing, `M-IMAGE` where the map
/// has no floor on which a robot of 0.3 m radius could stand.
pub fn annotate(grid: &Grid, options: &Options) -> Result<Annotation, Vec<Fault>> {
    let grid = &within(grid, &options.within)?;
    let mut remarks = Vec::new();
    if grid.resolution_m > COARSE_M {
        let text =
            format!("cells of {} m are too coarse for doorways; a map of 0.05 to 0.1 m shows them", grid.resolution_m);
        remarks.push(Remark::new(RemarkKind::Coarse, None, text));
    }
    let mut floor = Floor::of(grid, &mut remarks);
    let inside = fitting(&floor);
    let thin = skeleton(&inside, &floor.clear_m, floor.cell_m);
    let mut throats = throat::openings(&floor, &spots(&floor, &thin, throat::is_narrow));
    let wide = spots(&floor, &thin, throat::is_in_mouth);
    throats.extend(mouths(&mut floor, &throats, &wide));
    floor.close(&lines(&throats));
    let floor = floor;
    let inside = fitting(&floor);
    let mut regions = Regions::cut(&floor, &inside, &throats);
    let kept = kept(grid, &floor, &mut regions, options)?;
    left_out(&floor, &regions, &kept, &mut remarks);
    let elevators = elevators(grid, &floor, &regions, &kept, options)?;
    let cars: BTreeSet<usize> = elevators.keys().copied().collect();
    let kinds: BTreeMap<usize, RegionKind> = kept
        .iter()
        .map(|region| (*region, if cars.contains(region) { RegionKind::Room } else { kind(&floor, &regions, *region) }))
        .collect();
    let mut ways = inside;
    for (slot, number) in ways.values.iter_mut().zip(&regions.of_cell.values) {
        let region = (*number as usize).checked_sub(1);
        *slot = region.and_then(|region| kinds.get(&region)) == Some(&RegionKind::Ways);
    }
    let skeleton = skeleton(&ways, &floor.clear_m, floor.cell_m);
    for region in kinds.keys().filter(|region| !cars.contains(region) && may_be_car(&floor, &regions, **region)) {
        let at = regions.all.get(*region).map(|region| roomiest(&floor, region));
        let text = "a small room with one door: is it an elevator? `--elevator X,Y` says so".to_owned();
        remarks.push(Remark::new(RemarkKind::Elevator, at, text));
    }
    let open = Open::of(&floor, &ways);
    let ground =
        Ground { floor: &floor, regions: &regions, kinds: &kinds, cars: &cars, skeleton: &skeleton, open: &open };
    let mut sketch = Sketch::of(&ground);
    one_piece(&mut sketch, &mut remarks);
    let mut made = written(grid, &Naming::new(&floor, &regions, &sketch, &elevators));
    doubts(&floor, &regions, &made, &mut remarks);
    // Remarks were made on the picture; people look at the map.
    for remark in &mut remarks {
        remark.at = remark.at.map(|spot| world(grid, &floor, &spot));
    }
    made.remarks = remarks;
    Ok(made)
}

/// The cells on which the robot fits.
fn fitting(floor: &Floor) -> Layer<bool> {
    #[expect(clippy::cast_possible_truncation, reason = "a length of less than a meter")]
    let least = floor.body_of_cell_m() as f32;
    Layer { width: floor.clear_m.width, values: floor.clear_m.values.iter().map(|m| *m >= least).collect() }
}

/// The spots of a skeleton whose clearance is wanted.
fn spots(floor: &Floor, skeleton: &Layer<bool>, wanted: impl Fn(f64) -> bool) -> Vec<Spot> {
    (0..height(skeleton))
        .flat_map(|row| (0..skeleton.width).map(move |column| (column, row)))
        .filter(|(column, row)| skeleton.get(*column, *row) == Some(true))
        .filter(|cell| wanted(floor.clear_of(*cell)))
        .map(|cell| floor.spot(cell))
        .collect()
}

fn lines(throats: &[Throat]) -> Vec<(Spot, Spot)> {
    throats.iter().map(|throat| (throat.from, throat.to)).collect()
}

/// The mouths of bays beside the openings that are known: those behind which the floor, closed on trial, is compact.
fn mouths(floor: &mut Floor, known: &[Throat], spots: &[Spot]) -> Vec<Throat> {
    let mut found = throat::mouths(floor, spots);
    found.retain(|mouth| known.iter().all(|throat| !throat.meets(mouth)));
    if found.is_empty() {
        return found;
    }
    let all: Vec<Throat> = known.iter().chain(&found).copied().collect();
    floor.close(&lines(&all));
    let regions = Regions::cut(floor, &fitting(floor), &all);
    let bays = regions.passages.iter().filter(|passage| matches!(passage.throat.opening, Opening::Mouth(_)));
    bays.filter(|passage| is_bay(floor, &regions, passage)).map(|passage| passage.throat).collect()
}

fn world(grid: &Grid, floor: &Floor, spot: &Spot) -> Point {
    let (px, py) = floor.pixel(spot);
    grid.world_from_pixel(px, py)
}

fn spot_of(grid: &Grid, point: &Point) -> Spot {
    let (px, py) = grid.pixel_from_world(point);
    Spot::new(px * grid.resolution_m, py * grid.resolution_m)
}

/// The grid with what lies outside of a polygon unknown.
fn within(grid: &Grid, corners: &[Point]) -> Result<Grid, Vec<Fault>> {
    let wrong = |message: String| vec![Fault::new(FaultCode::MValue, Where::key("within"), message)];
    if grid.width.saturating_mul(grid.height) != grid.cells.len() || grid.cells.is_empty() {
        let message = format!("the grid has {} cells for {} by {}", grid.cells.len(), grid.width, grid.height);
        return Err(vec![Fault::new(FaultCode::MImage, "grid", message)]);
    }
    let mut cut = grid.clone();
    if corners.is_empty() {
        return Ok(cut);
    }
    if corners.len() < 3 || corners.iter().any(|corner| !corner.x.is_finite() || !corner.y.is_finite()) {
        return Err(wrong(format!("the polygon has {} usable corners; at least three are needed", corners.len())));
    }
    let pixels: Vec<(f64, f64)> = corners.iter().map(|corner| grid.pixel_from_world(corner)).collect();
    #[expect(clippy::cast_precision_loss, reason = "a map has far fewer than 2^53 cells a side")]
    let is_in = |column: usize, row: usize| {
        let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
        let ends = pixels.iter().zip(pixels.iter().cycle().skip(1));
        // An odd number of sides lies to the right.
        ends.filter(|((ax, ay), (bx, by))| (*ay > y) != (*by > y) && x < (bx - ax) * (y - ay) / (by - ay) + ax).count()
            % 2
            == 1
    };
    for row in 0..grid.height {
        for column in 0..grid.width {
            if !is_in(column, row)
                && let Some(cell) = cut.cells.get_mut(row * grid.width + column)
            {
                *cell = Kind::Unknown;
            }
        }
    }
    if cut.cells.contains(&Kind::Free) {
        Ok(cut)
    } else {
        Err(wrong("the polygon holds no free cell of the map".to_owned()))
    }
}

/// The region at a point of the options.
fn region_at(grid: &Grid, floor: &Floor, regions: &Regions, point: &Point, key: &str) -> Result<usize, Vec<Fault>> {
    let spot = spot_of(grid, point);
    let mut best: Option<(f64, usize)> = None;
    let steps = i32::try_from(cells(NEAR_M, floor.cell_m)).unwrap_or(20);
    for down in -steps..=steps {
        for right in -steps..=steps {
            let off = socrates_model::Vector::new(f64::from(right), f64::from(down)) * floor.cell_m;
            let Some(region) = regions.of(floor.cell(&(spot + off))) else { continue };
            if best.is_none_or(|(least, _)| off.norm() < least) {
                best = Some((off.norm(), region));
            }
        }
    }
    best.map(|(_, region)| region).ok_or_else(|| {
        let message = format!(
            "({}, {}) m is not within {NEAR_M} m of floor on which a robot of {BODY_M} m radius stands; give a point on the floor, map frame",
            point.x, point.y
        );
        vec![Fault::new(FaultCode::MValue, Where::key(key), message)]
    })
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few cells")]
fn cells(meters: f64, cell_m: f64) -> usize {
    (meters / cell_m).min(1e4) as usize
}

/// The regions that are annotated.
fn kept(grid: &Grid, floor: &Floor, regions: &mut Regions, options: &Options) -> Result<BTreeSet<usize>, Vec<Fault>> {
    let inner: f64 = regions.all.iter().filter(|region| !region.outside).map(|region| region.area_m2).sum();
    if inner < LEAST_M2 {
        // One floor without a building.
        for region in &mut regions.all {
            region.outside = false;
        }
    }
    if let Some(point) = &options.keep {
        let at = region_at(grid, floor, regions, point, "keep")?;
        if let Some(region) = regions.all.get_mut(at) {
            region.outside = false;
        }
        return Ok(regions.reached(at));
    }
    let mut best: Option<(f64, BTreeSet<usize>)> = None;
    let mut seen: BTreeSet<usize> = BTreeSet::new();
    for start in 0..regions.all.len() {
        if seen.contains(&start) || regions.all.get(start).is_some_and(|region| region.outside) {
            continue;
        }
        let part = regions.reached(start);
        seen.extend(&part);
        let area = part.iter().filter_map(|at| regions.all.get(*at)).map(|region| region.area_m2).sum();
        if best.as_ref().is_none_or(|(most, _)| area > *most) {
            best = Some((area, part));
        }
    }
    match best {
        Some((area, part)) if area >= LEAST_M2 => Ok(part),
        Some(_) | None => {
            let free = grid.cells.iter().filter(|cell| **cell == Kind::Free).count();
            let message = format!(
                "the map has {free} free cells of {}, and no {LEAST_M2} m² of them hang together wide enough for a robot of {BODY_M} m radius; \
                 check `resolution`, `negate` and the thresholds",
                grid.cells.len()
            );
            Err(vec![Fault::new(FaultCode::MImage, "grid", message)])
        }
    }
}

/// The rooms that are cars, numbered.
fn elevators(
    grid: &Grid,
    floor: &Floor,
    regions: &Regions,
    kept: &BTreeSet<usize>,
    options: &Options,
) -> Result<BTreeMap<usize, usize>, Vec<Fault>> {
    let mut cars = BTreeMap::new();
    for point in &options.elevators {
        let region = region_at(grid, floor, regions, point, "elevator")?;
        let doors = regions.passages_of(region).count();
        if doors == 0 || !kept.contains(&region) {
            let why =
                if doors == 0 { "its floor has no doorway" } else { "its floor is not the one that is annotated" };
            let message = format!("({}, {}) m is in no elevator: {why}", point.x, point.y);
            return Err(vec![Fault::new(FaultCode::MValue, Where::key("elevator"), message)]);
        }
        let next = cars.len() + 1;
        cars.entry(region).or_insert(next);
    }
    Ok(cars)
}

/// Says where floor lies that is as much a building as what is annotated: several floors in one picture.
fn several_floors(floor: &Floor, regions: &Regions, kept: &BTreeSet<usize>, remarks: &mut Vec<Remark>) {
    let area = |of: &BTreeSet<usize>| {
        of.iter().filter_map(|at| regions.all.get(*at)).map(|region| region.area_m2).sum::<f64>()
    };
    let own = area(kept);
    let mut seen = kept.clone();
    let mut floors: Vec<Spot> = Vec::new();
    for (at, region) in regions.all.iter().enumerate() {
        if region.outside || seen.contains(&at) {
            continue;
        }
        let part = regions.reached(at);
        seen.extend(&part);
        if part.len() >= FLOOR_REGIONS && area(&part) >= FLOOR_SHARE * own {
            floors.push(roomiest(floor, region));
        }
    }
    if let Some(first) = floors.first() {
        let text = format!(
            "the picture holds {} floors that nothing joins; one is annotated: annotate each as a location of its own, with its region \
             `--within X,Y;X,Y;…` or a point on it `--keep X,Y`",
            floors.len() + 1
        );
        remarks.push(Remark::new(RemarkKind::SeveralFloors, Some(*first), text));
    }
}

/// Says what floor has no nodes.
fn left_out(floor: &Floor, regions: &Regions, kept: &BTreeSet<usize>, remarks: &mut Vec<Remark>) {
    several_floors(floor, regions, kept, remarks);
    let mut lost: Vec<(f64, Spot)> = Vec::new();
    for (at, region) in regions.all.iter().enumerate() {
        if kept.contains(&at) || region.area_m2 < NAMED_M2 {
            continue;
        }
        let spot = roomiest(floor, region);
        if region.outside {
            let text = format!(
                "{:.0} m² of free floor round the building have no nodes; `--keep X,Y` with a point there annotates them",
                region.area_m2
            );
            remarks.push(Remark::new(RemarkKind::Outside, Some(spot), text));
        } else {
            lost.push((region.area_m2, spot));
        }
    }
    lost.sort_by(|a, b| b.0.total_cmp(&a.0));
    let rest = lost.split_off(lost.len().min(NAMED_MOST));
    for (area, spot) in lost {
        let text = format!(
            "{area:.0} m² of free floor are cut off: no opening of {} m leads there; open the wall in the picture, or annotate it with `--keep X,Y`",
            2.0 * BODY_M
        );
        remarks.push(Remark::new(RemarkKind::CutOff, Some(spot), text));
    }
    if !rest.is_empty() {
        let sum: f64 = rest.iter().map(|(area, _)| area).sum();
        let text = format!("{} more pieces of free floor, {sum:.0} m² together, are cut off", rest.len());
        remarks.push(Remark::new(RemarkKind::CutOff, None, text));
    }
}

/// Keeps the largest part of the sketch that hangs together.
fn one_piece(sketch: &mut Sketch, remarks: &mut Vec<Remark>) {
    let parts = sketch.parts();
    let largest = Sketch::largest(&parts);
    let stays: Vec<bool> = parts.iter().map(|own| Some(*own) == largest).collect();
    let lost: Vec<Spot> =
        sketch.places.iter().zip(&stays).filter(|(_, stays)| !**stays).map(|(place, _)| place.at).collect();
    if let Some(spot) = lost.first() {
        let text = format!(
            "places that no way of the robot's width joins with the others were given up, here the first ({} of them); their floor is \
             among furniture",
            lost.len()
        );
        remarks.push(Remark::new(RemarkKind::Unreached, Some(*spot), text));
    }
    let mut number = 0;
    let places: Vec<usize> = stays
        .iter()
        .map(|stays| {
            let own = number;
            number += usize::from(*stays);
            own
        })
        .collect();
    let is_kept = |place: usize| stays.get(place) == Some(&true);
    sketch.ways.retain(|way| way.iter().all(|end| is_kept(*end)));
    for way in &mut sketch.ways {
        *way = way.map(|end| places.get(end).copied().unwrap_or(end));
    }
    let mut kept = stays.iter();
    sketch.places.retain(|_| kept.next() == Some(&true));
}

/// Says which doors are doubtful, which gaps are too narrow, and whether the map is one floor.
fn doubts(floor: &Floor, regions: &Regions, made: &Annotation, remarks: &mut Vec<Remark>) {
    let doubtful = regions
        .passages
        .iter()
        .filter(|passage| passage.throat.opening == Opening::Door && passage.throat.confidence() < DOUBTFUL);
    for passage in doubtful.take(NAMED_MOST) {
        let text =
            format!("an opening of {:.2} m is taken for a doorway with little confidence", passage.throat.width_m);
        remarks.push(Remark::new(RemarkKind::Doubtful, Some(passage.throat.middle()), text));
    }
    let tight = regions.passages.iter().filter(|passage| passage.throat.width_m <= 2.0 * BODY_M + floor.cell_m);
    for passage in tight.take(NAMED_MOST) {
        let text = format!(
            "an opening of {:.2} m leaves a robot of {BODY_M} m radius no room: no robot of that size is sent through it",
            passage.throat.width_m
        );
        remarks.push(Remark::new(RemarkKind::Gap, Some(passage.throat.middle()), text));
    }
    for gap in regions.gaps.iter().take(NAMED_MOST) {
        let text = format!(
            "an opening of {:.2} m is too narrow for a robot of {BODY_M} m radius and has no nodes",
            gap.width_m
        );
        remarks.push(Remark::new(RemarkKind::Gap, Some(gap.middle()), text));
    }
    if made.counts.doors == 0 && made.counts.rooms == 0 {
        let largest = regions.all.iter().max_by(|a, b| a.area_m2.total_cmp(&b.area_m2));
        let at = largest.map(|region| roomiest(floor, region));
        let text = "the map is one floor without doorways and rooms: what needs a door, a room or an elevator has no place here".to_owned();
        remarks.push(Remark::new(RemarkKind::OneFloor, at, text));
    }
    let all_m: f64 = made.graph.edges().iter().filter_map(|edge| made.graph.edge_length_m(&edge.from, &edge.to)).sum();
    if all_m < ROBOT_WAY_M {
        let text = format!(
            "all ways together are {all_m:.1} m long; the robot's way alone has at least {ROBOT_WAY_M} m, so nothing can be played here"
        );
        remarks.push(Remark::new(RemarkKind::Small, None, text));
    }
}

/// Nodes, edges and doors in their order, with names.
fn written(grid: &Grid, naming: &Naming<'_>) -> Annotation {
    let sketch = naming.sketch;
    let kinds: Vec<(String, f64)> = (0..sketch.places.len()).map(|place| naming.kind(place)).collect();
    let mut order: Vec<usize> = (0..sketch.places.len()).collect();
    order.sort_by(|a, b| {
        let (a, b) = (sketch.at(*a), sketch.at(*b));
        a.y.total_cmp(&b.y).then(a.x.total_cmp(&b.x))
    });
    let mut counts: BTreeMap<char, usize> = BTreeMap::new();
    let mut ids: BTreeMap<usize, NodeId> = BTreeMap::new();
    let (mut nodes, mut confidence) = (Vec::new(), Vec::new());
    for place in &order {
        let Some((kind, sure)) = kinds.get(*place) else { continue };
        let letter = letter(kind);
        let count = counts.entry(letter).or_insert(0);
        *count += 1;
        let Ok(id) = NodeId::new(format!("{letter}{count}")) else { continue };
        ids.insert(*place, id.clone());
        nodes.push(GraphNode { id, kind: kind.clone(), at: world(grid, naming.floor, &sketch.at(*place)) });
        confidence.push((sure * 100.0).round() / 100.0);
    }
    let ranks: BTreeMap<usize, usize> = order.iter().enumerate().map(|(rank, place)| (*place, rank)).collect();
    let rank = |place: &usize| ranks.get(place).copied();
    let mut ways: Vec<[usize; 2]> =
        sketch.ways.iter().map(|[a, b]| if rank(a) <= rank(b) { [*a, *b] } else { [*b, *a] }).collect();
    ways.sort_by_key(|[a, b]| (rank(a), rank(b)));
    let edge = |way: &[usize; 2]| {
        let (from, to) = ids.get(&way[0]).cloned().zip(ids.get(&way[1]).cloned())?;
        Some(GraphEdge { from, to, kind: naming.way(*way), via: Vec::new() })
    };
    let edges: Vec<GraphEdge> = ways.iter().filter_map(edge).collect();
    let doors = doors(grid, naming, &ids);
    let count = |class: &str| kinds.iter().filter(|(kind, _)| kind == class).count();
    let rooms: BTreeSet<usize> = sketch
        .places
        .iter()
        .filter_map(|place| if let What::Room(region) = place.what { Some(region) } else { None })
        .collect();
    let counts = Counts {
        doors: sketch.places.iter().filter(|place| matches!(place.what, What::Door(_))).count(),
        rooms: rooms.len(),
        elevators: naming.elevators.len(),
        intersections: count("INTERSECTION"),
        corners: count("BLIND CORNER"),
        ends: count("CORRIDOR END") + count("EXIT"),
        open_areas: count("OPEN AREA"),
        narrow: count("NARROW CORRIDOR"),
    };
    let description = description(&counts, &nodes);
    Annotation { graph: SceneGraph::new(nodes, edges), doors, description, confidence, remarks: Vec::new(), counts }
}

/// Lines of the doors of rooms and cars.
fn doors(grid: &Grid, naming: &Naming<'_>, ids: &BTreeMap<usize, NodeId>) -> Vec<Door> {
    let places = &naming.sketch.places;
    let inside = |region: usize| -> Vec<NodeId> {
        let own = |what: What| matches!(what, What::Room(other) | What::Car(other) if other == region);
        places
            .iter()
            .enumerate()
            .filter(|(_, place)| own(place.what))
            .filter_map(|(at, _)| ids.get(&at).cloned())
            .collect()
    };
    let mut doors = Vec::new();
    for (at, place) in places.iter().enumerate() {
        let What::Door(number) = place.what else { continue };
        let Some((passage, id)) = naming.regions.passages.get(number).zip(ids.get(&at)) else { continue };
        // Of two rooms the one with fewer doors is the one that is behind it.
        let mut rooms: Vec<(usize, usize, Vec<NodeId>)> = passage
            .sides
            .iter()
            .map(|side| (naming.regions.passages_of(*side).count(), *side, inside(*side)))
            .filter(|(_, _, nodes)| !nodes.is_empty())
            .collect();
        rooms.sort_by_key(|(doors, side, _)| (!naming.elevators.contains_key(side), *doors, *side));
        let Some((_, region, nodes)) = rooms.into_iter().next() else { continue };
        let (from, to) = (passage.throat.from, passage.throat.to);
        if naming.floor.raw_m(&passage.throat.middle()) <= 0.0 {
            continue;
        }
        let car = naming.elevators.contains_key(&region);
        doors.push(Door {
            id: format!("door_{id}"),
            kind: if car { DoorKind::Elevator } else { DoorKind::Room },
            from: world(grid, naming.floor, &from),
            to: world(grid, naming.floor, &to),
            opens: if car { DoorOpens::RobotNear(3.0) } else { DoorOpens::Always },
            hold_s: if car { 15.0 } else { 12.0 },
            inside: nodes,
        });
    }
    doors.sort_by(|a, b| a.id.len().cmp(&b.id.len()).then(a.id.cmp(&b.id)));
    doors
}

/// What kind of place it is, in words.
fn description(counts: &Counts, nodes: &[GraphNode]) -> String {
    let span = |value: fn(&GraphNode) -> f64| {
        let values = nodes.iter().map(value);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        (high - low).max(0.0)
    };
    let mut parts: Vec<String> = Vec::new();
    let mut say = |count: usize, one: &str, many: &str| {
        if count > 0 {
            parts.push(format!("{count} {}", if count == 1 { one } else { many }));
        }
    };
    say(counts.rooms, "room behind a doorway", "rooms behind doorways");
    say(counts.elevators, "elevator", "elevators");
    say(counts.intersections, "intersection of ways", "intersections of ways");
    say(counts.open_areas, "place on open floor", "places on open floor");
    say(counts.narrow, "place in a narrow corridor", "places in narrow corridors");
    say(counts.ends, "end of a way", "ends of ways");
    let listed = match parts.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        Some((last, _)) => last.clone(),
        None => "ways".to_owned(),
    };
    format!(
        "A floor of {:.0} m by {:.0} m with {listed}, found on the map by the program; nobody named its places.",
        span(|node| node.at.x),
        span(|node| node.at.y)
    )
}
