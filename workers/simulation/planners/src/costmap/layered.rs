//! Layers one over the other.

use socrates_model::{Grid, Point, Pose, SeenPerson};

use super::grid::{Bounds, Costmap, FREE, UNKNOWN};
use super::{
    GroupLayer, GroupsParams, InflationLayer, InflationParams, Nav2CanLayer, Nav2CanParams, ObstacleLayer,
    ObstacleParams, OraclePeople, OraclePeopleParams, ProxemicLayer, ProxemicParams, StaticLayer, StaticParams,
    UpoSocialLayer, UpoSocialParams,
};

/// One lidar scan.
#[derive(Debug, Clone, PartialEq)]
pub struct Scan {
    /// Pose of the lidar when it was made.
    pub from: Pose,
    /// Ranges, m: beam 0 straight ahead, then counter-clockwise by one degree.
    pub ranges_m: Vec<f64>,
    /// A range so long met nothing, m.
    pub range_max_m: f64,
}

/// What the layers are given at an update.
#[derive(Debug, Clone, Copy)]
pub struct Sensed<'a> {
    /// Time of the run, s.
    pub now_s: f64,
    /// Pose of the robot.
    pub pose: Pose,
    /// Radius of a round robot, and the inscribed radius of any other, m.
    pub radius_m: f64,
    /// Outline of the robot in its own frame, m; empty for a disc.
    pub footprint: &'a [Point],
    /// The latest scan.
    pub scan: Option<&'a Scan>,
    /// People in sight; only layers that are about people look here.
    pub people: &'a [SeenPerson],
}

/// One layer of a costmap.
pub trait Layer: std::fmt::Debug {
    /// Takes in what was sensed, and widens `bounds` by the cells of `map` that this layer may change.
    fn look(&mut self, map: &Costmap, sensed: &Sensed<'_>, bounds: &mut Bounds);

    /// Writes its costs into the box.
    fn write(&mut self, map: &mut Costmap, bounds: &Bounds, sensed: &Sensed<'_>);

    /// The window moved by so many cells.
    fn roll(&mut self, columns: isize, rows: isize);

    /// Forgets what it saw.
    fn clear(&mut self);
}

/// How a layer's cost becomes the map's. Nav2: `combination_method` 0, 1, 2. A cell that the layer does not know changes nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Merge {
    /// The layer's cost.
    Overwrite,
    /// The larger of both; a cell unknown so far is overwritten.
    #[default]
    Max,
    /// The larger of both; a cell unknown so far stays unknown.
    MaxWithoutUnknown,
}

impl Merge {
    /// The cost of a cell after a layer.
    #[must_use]
    pub const fn merged(self, map: u8, layer: u8) -> u8 {
        if layer == UNKNOWN {
            return map;
        }
        match self {
            Self::Overwrite => layer,
            Self::Max => {
                if map == UNKNOWN || map < layer {
                    layer
                } else {
                    map
                }
            }
            Self::MaxWithoutUnknown => {
                if map < layer {
                    layer
                } else {
                    map
                }
            }
        }
    }

    /// Merges a layer's grid of the same size into a box of the map.
    pub(super) fn merge(self, map: &mut Costmap, layer: &Costmap, bounds: &Bounds) {
        for (row, new) in map.rows_mut(bounds).zip(layer.rows(bounds)) {
            row.iter_mut().zip(new).for_each(|(cell, new)| *cell = self.merged(*cell, *new));
        }
    }
}

/// One entry of Nav2's `plugins`, with its parameters.
#[derive(Debug, Clone, PartialEq)]
pub enum LayerParams {
    /// Walls of the map.
    Static(StaticParams),
    /// What the lidar sees.
    Obstacle(ObstacleParams),
    /// Room beside obstacles.
    Inflation(InflationParams),
    /// People as discs, not by lidar.
    OraclePeople(OraclePeopleParams),
    /// Proxemic or passing layer of Lu et al.
    Proxemic(ProxemicParams),
    /// Social layer of the UPO group.
    UpoSocial(UpoSocialParams),
    /// Social map of Nav2CAN.
    Nav2Can(Nav2CanParams),
    /// Ellipses over groups.
    Groups(GroupsParams),
}

/// A costmap's parameters, with Nav2's names.
#[derive(Debug, Clone, PartialEq)]
pub struct CostmapParams {
    /// Size, m; Nav2's default 5 x 5. Only a rolling window has a size of its own, any other is as large as the location's map.
    pub width_m: f64,
    /// See `width_m`.
    pub height_m: f64,
    /// Side of a cell, m; default 0.1. A map that does not roll takes the cells of the location's map.
    pub resolution_m: f64,
    /// Updates per simulated second; default 5.
    pub update_frequency_hz: f64,
    /// Whether the map is a window with the robot in its middle; default false.
    pub rolling_window: bool,
    /// Whether cells are unknown until seen; default false: they are free.
    pub track_unknown_space: bool,
    /// The layers, first written first. Inflation comes after those whose obstacles it is to widen.
    pub layers: Vec<LayerParams>,
}

impl Default for CostmapParams {
    fn default() -> Self {
        Self {
            width_m: 5.0,
            height_m: 5.0,
            resolution_m: 0.1,
            update_frequency_hz: 5.0,
            rolling_window: false,
            track_unknown_space: false,
            layers: Vec::new(),
        }
    }
}

/// A costmap and the layers that write it.
#[derive(Debug)]
pub struct LayeredCostmap {
    map: Costmap,
    rolling: bool,
    default: u8,
    layers: Vec<Box<dyn Layer>>,
    /// The next update writes every cell.
    all: bool,
    changed: Bounds,
}

impl LayeredCostmap {
    /// A map over a location. `robot_radius_m` is the inscribed radius. A rolling window stands at `origin` until the first update.
    #[must_use]
    pub fn new(params: &CostmapParams, walls: &Grid, robot_radius_m: f64) -> Self {
        let default = if params.track_unknown_space { UNKNOWN } else { FREE };
        let fixed = StaticLayer::frame(walls, default);
        let map = if params.rolling_window {
            let cells = |size_m: f64| cells_of(size_m / params.resolution_m);
            let (width, height) = (cells(params.width_m), cells(params.height_m));
            Costmap::new(width, height, params.resolution_m, fixed.origin(), default)
        } else {
            fixed
        };
        let layer = |layer: &LayerParams| -> Box<dyn Layer> {
            match layer {
                LayerParams::Static(own) => Box::new(StaticLayer::new(own, walls, params, default)),
                LayerParams::Obstacle(own) => Box::new(ObstacleLayer::new(own, &map, default)),
                LayerParams::Inflation(own) => Box::new(InflationLayer::new(own, &map, robot_radius_m)),
                LayerParams::OraclePeople(own) => Box::new(OraclePeople::new(own)),
                LayerParams::Proxemic(own) => Box::new(ProxemicLayer::new(own)),
                LayerParams::UpoSocial(own) => Box::new(UpoSocialLayer::new(own)),
                LayerParams::Nav2Can(own) => Box::new(Nav2CanLayer::new(own)),
                LayerParams::Groups(own) => Box::new(GroupLayer::new(own)),
            }
        };
        let layers = params.layers.iter().map(layer).collect();
        Self { map, rolling: params.rolling_window, default, layers, all: true, changed: Bounds::EMPTY }
    }

    /// The costs.
    #[must_use]
    pub const fn map(&self) -> &Costmap {
        &self.map
    }

    /// The cells that the last update wrote.
    #[must_use]
    pub const fn changed(&self) -> &Bounds {
        &self.changed
    }

    /// Takes in what was sensed.
    pub fn update(&mut self, sensed: &Sensed<'_>) {
        if self.rolling {
            self.follow(&sensed.pose);
        }
        let mut bounds = if self.all { self.map.whole() } else { Bounds::EMPTY };
        self.all = false;
        for layer in &mut self.layers {
            layer.look(&self.map, sensed, &mut bounds);
        }
        self.changed = bounds;
        if bounds.is_empty() {
            return;
        }
        let default = self.default;
        self.map.rows_mut(&bounds).for_each(|row| row.fill(default));
        for layer in &mut self.layers {
            layer.write(&mut self.map, &bounds, sensed);
        }
    }

    /// Forgets everything seen; walls of the map come back at the next update.
    pub fn clear(&mut self) {
        self.layers.iter_mut().for_each(|layer| layer.clear());
        self.map.costs_mut().fill(self.default);
        self.all = true;
    }

    /// Moves a rolling window by whole cells so that the robot is in its middle.
    #[expect(clippy::cast_possible_truncation, reason = "a window moves by fewer than 2^52 cells")]
    pub(super) fn follow(&mut self, pose: &Pose) {
        let cell_m = self.map.resolution_m();
        let middle = |size: usize| size as f64 * cell_m / 2.0;
        let columns = ((pose.x - middle(self.map.width()) - self.map.origin().x) / cell_m).trunc() as isize;
        let rows = ((pose.y - middle(self.map.height()) - self.map.origin().y) / cell_m).trunc() as isize;
        if columns == 0 && rows == 0 {
            return;
        }
        self.map.roll(columns, rows, self.default);
        self.layers.iter_mut().for_each(|layer| layer.roll(columns, rows));
        // What comes into the window has to be written, and inflated over both sides of its edge.
        self.all = true;
    }
}

/// Whole cells in so many, at least 1 and at most 10 000.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
fn cells_of(cells: f64) -> usize {
    /// Largest side of a window, cells: 500 m at 5 cm, so that a typo does not take all memory.
    const MOST_CELLS: f64 = 10_000.0;
    cells.round().clamp(1.0, MOST_CELLS) as usize
}
