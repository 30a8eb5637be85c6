//! What real buildings have at least, and which of it a building does not.

use serde::Serialize;
use socrates_model::{BuildingBrief, BuildingKind, Location, PlaceClass, Point};

use crate::ground::Ground;

/// A measure below what such buildings have.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Remark {
    /// What is narrow.
    pub what: String,
    /// The smallest one found, m.
    pub found_m: f64,
    /// What such buildings have at least, m.
    pub least_m: f64,
    /// Where that number comes from.
    pub source: &'static str,
}

/// A row: what is measured, in which kind (any where none), least width in m, source.
type Row = (Measure, Option<BuildingKind>, f64, &'static str);

/// What is measured across.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Measure {
    Doorway,
    Corridor,
    ElevatorDoor,
}

impl Measure {
    const fn words(self) -> &'static str {
        match self {
            Self::Doorway => "doorways",
            Self::Corridor => "corridors",
            Self::ElevatorDoor => "elevator doors",
        }
    }
}

/// The table of real widths.
const ROWS: [Row; 7] = [
    (Measure::Doorway, None, 0.815, "ADA 2010, 404.2.3: 32 in clear"),
    (Measure::Doorway, Some(BuildingKind::Hospital), 1.05, "doors of patient rooms, NFPA 101: 41.5 in"),
    (Measure::Corridor, None, 0.915, "ADA 2010, 403.5: 36 in"),
    (Measure::Corridor, Some(BuildingKind::Office), 1.2, "ISO 21542: 1.2 m"),
    (Measure::Corridor, Some(BuildingKind::Hospital), 2.44, "beds in corridors, NFPA 101: 8 ft"),
    (Measure::ElevatorDoor, None, 0.8, "ISO 21542: 0.8 m"),
    (Measure::Doorway, None, 0.8, "a robot of 0.3 m radius with 0.1 m on each side"),
];

/// Farthest that is measured, m.
const FAR_M: f64 = 30.0;
/// A measure on a map of 0.1 m cells may be this much below, m.
const SLACK_M: f64 = 0.06;

/// Measures a building on its map and names what is below the table.
pub(super) fn remarks(brief: &BuildingBrief, location: &Location) -> Vec<Remark> {
    let ground = Ground::of(&location.grid);
    let sight = ground.sight();
    let across = |at: &Point| {
        let width = |angle: f64| sight.ray(at, angle, FAR_M) + sight.ray(at, angle + std::f64::consts::PI, FAR_M);
        width(0.0).min(width(std::f64::consts::FRAC_PI_2))
    };
    let graph = &location.graph;
    let of_class = |class: PlaceClass| {
        let nodes = graph.nodes().iter().filter(move |node| PlaceClass::of_type(&node.kind) == class);
        nodes.map(|node| across(&node.at)).collect::<Vec<f64>>()
    };
    // Between the nodes of a corridor, since doors lead off at its nodes.
    let corridors = || {
        let ways = graph
            .edges()
            .iter()
            .filter(|edge| matches!(PlaceClass::of_type(&edge.kind), PlaceClass::Corridor | PlaceClass::NarrowPassage));
        let ends = ways.filter_map(|edge| Some((graph.node(&edge.from)?.at, graph.node(&edge.to)?.at)));
        let shares = [0.3, 0.4, 0.5, 0.6, 0.7];
        ends.flat_map(|(a, b)| shares.map(|share| across(&(a + (b - a) * share)))).collect::<Vec<f64>>()
    };
    let lifts = location.doors.iter().filter(|door| door.kind == socrates_model::DoorKind::Elevator);
    let found = |measure: Measure| match measure {
        Measure::Doorway => of_class(PlaceClass::Doorway),
        Measure::Corridor => corridors(),
        Measure::ElevatorDoor => lifts.clone().map(|door| (door.to - door.from).norm()).collect(),
    };
    let rows = ROWS.iter().filter(|(_, kind, ..)| kind.is_none_or(|kind| kind == brief.kind));
    rows.filter_map(|(measure, _, least_m, source)| {
        let least = found(*measure).into_iter().fold(f64::INFINITY, f64::min);
        let found_m = (least * 100.0).round() / 100.0;
        (least < least_m - SLACK_M).then(|| Remark {
            what: measure.words().to_owned(),
            found_m,
            least_m: *least_m,
            source,
        })
    })
    .collect()
}
