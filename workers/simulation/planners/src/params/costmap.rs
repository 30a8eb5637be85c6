//! `local_costmap` and `global_costmap`: a costmap and its layers.

use super::section::{Range, Section};

/// A costmap, with the defaults of Nav2's costmap.
#[derive(Debug, Clone, PartialEq)]
pub struct CostmapServer {
    /// Size along x, m, above 0. Default 5. Counts for a rolling window alone.
    pub width: f64,
    /// Size along y, m, above 0. Default 5.
    pub height: f64,
    /// Side of a cell, m, above 0. Default 0.1.
    pub resolution: f64,
    /// Updates per second, Hz, above 0. Default 5.
    pub update_frequency: f64,
    /// Whether it is a window with the robot in its middle. Default false.
    pub rolling_window: bool,
    /// Whether cells are unknown until seen. Default false.
    pub track_unknown_space: bool,
    /// Radius of a round robot, m, above 0. Default 0.1.
    pub robot_radius: f64,
    /// Corners of the outline of any other robot, m; empty for a round one.
    pub footprint: Vec<[f64; 2]>,
    /// Room added round the outline, m, at least 0. Default 0.01.
    pub footprint_padding: f64,
    /// The layers that are switched on, first written first.
    pub layers: Vec<LayerSpec>,
}

impl Default for CostmapServer {
    fn default() -> Self {
        Self {
            width: 5.0,
            height: 5.0,
            resolution: 0.1,
            update_frequency: 5.0,
            rolling_window: false,
            track_unknown_space: false,
            robot_radius: 0.1,
            footprint: Vec::new(),
            footprint_padding: 0.01,
            layers: Vec::new(),
        }
    }
}

impl CostmapServer {
    /// Distances from the robot's center to its nearest edge and to its farthest corner, m; both the radius of a round one.
    #[must_use]
    pub fn radii(&self) -> (f64, f64) {
        if self.footprint.is_empty() {
            return (self.robot_radius, self.robot_radius);
        }
        let point = |[x, y]: &[f64; 2]| socrates_model::Point::new(*x, *y);
        let origin = socrates_model::Point::origin();
        let next = self.footprint.iter().cycle().skip(1);
        let edges = self
            .footprint
            .iter()
            .zip(next)
            .map(|(from, to)| socrates_model::geometry::nearest_on_segment(&origin, &point(from), &point(to)).0);
        let corners = self.footprint.iter().map(|corner| point(corner).coords.norm());
        (edges.fold(f64::INFINITY, f64::min), corners.fold(0.0, f64::max))
    }

    /// The inflation, if there is one.
    #[must_use]
    pub fn inflation(&self) -> Option<&InflationSpec> {
        self.layers.iter().find_map(|layer| match layer {
            LayerSpec::Inflation(inflation) => Some(inflation),
            LayerSpec::Static(_)
            | LayerSpec::Obstacle(_)
            | LayerSpec::OraclePeople(_)
            | LayerSpec::Proxemic(_)
            | LayerSpec::UpoSocial(_)
            | LayerSpec::Nav2Can(_)
            | LayerSpec::Groups(_) => None,
        })
    }
}

/// One entry of `plugins`.
#[derive(Debug, Clone, PartialEq)]
pub enum LayerSpec {
    /// `nav2_costmap_2d::StaticLayer`.
    Static(StaticSpec),
    /// `nav2_costmap_2d::ObstacleLayer` and `nav2_costmap_2d::VoxelLayer`, which are the same for a flat scan.
    Obstacle(ObstacleSpec),
    /// `nav2_costmap_2d::InflationLayer`.
    Inflation(InflationSpec),
    /// `socrates::OraclePeople`: people in sight as discs; ours.
    OraclePeople(OraclePeopleSpec),
    /// `social_navigation_layers::ProxemicLayer` and `social_navigation_layers::PassingLayer`.
    Proxemic(ProxemicSpec),
    /// `nav2_social_costmap_plugin::SocialLayer`.
    UpoSocial(UpoSocialSpec),
    /// `nav2can::SocialLayer`.
    Nav2Can(Nav2CanSpec),
    /// `nav2can::InteractionLayer`.
    Groups(GroupsSpec),
}

/// Parameters of the static layer.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StaticSpec {
    /// Whether the larger cost is kept. Default false: the map overwrites.
    pub use_maximum: bool,
}

/// How a layer's cost becomes the map's: Nav2's `combination_method`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CombinationMethod {
    /// The layer's cost (0).
    Overwrite,
    /// The larger of both; a cell unknown so far is overwritten (1).
    #[default]
    Max,
    /// The larger of both; a cell unknown so far stays unknown (2).
    MaxWithoutUnknown,
}

/// Parameters of the obstacle layer and of its first observation source.
#[derive(Debug, Clone, PartialEq)]
pub struct ObstacleSpec {
    /// Hits nearer than this are not marked, m. Default 0.
    pub obstacle_min_range: f64,
    /// Hits farther than this are not marked, m. Default 2.5.
    pub obstacle_max_range: f64,
    /// Cells nearer than this are not cleared, m. Default 0.
    pub raytrace_min_range: f64,
    /// Cells farther than this are not cleared, m. Default 3.
    pub raytrace_max_range: f64,
    /// Whether hits are marked. Default true.
    pub marking: bool,
    /// Whether beams clear what they pass. Default true; Nav2's own default is false, and all of its files set it.
    pub clearing: bool,
    /// Whether a beam that met nothing clears up to the range of the lidar. Default false.
    pub inf_is_valid: bool,
    /// Whether the floor under the robot is free. Default true.
    pub footprint_clearing_enabled: bool,
    /// How its cells become the map's. Default the larger.
    pub combination_method: CombinationMethod,
}

impl Default for ObstacleSpec {
    fn default() -> Self {
        Self {
            obstacle_min_range: 0.0,
            obstacle_max_range: 2.5,
            raytrace_min_range: 0.0,
            raytrace_max_range: 3.0,
            marking: true,
            clearing: true,
            inf_is_valid: false,
            footprint_clearing_enabled: true,
            combination_method: CombinationMethod::Max,
        }
    }
}

/// Parameters of the inflation layer.
#[derive(Debug, Clone, PartialEq)]
pub struct InflationSpec {
    /// Where it ends, m, at least 0. Default 0.55.
    pub inflation_radius: f64,
    /// Loss of cost with distance, 1/m, above 0. Default 10.
    pub cost_scaling_factor: f64,
    /// Whether unknown cells are inflated too. Default false.
    pub inflate_unknown: bool,
}

impl Default for InflationSpec {
    fn default() -> Self {
        Self { inflation_radius: 0.55, cost_scaling_factor: 10.0, inflate_unknown: false }
    }
}

/// Parameters of people as discs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OraclePeopleSpec {
    /// Room round a body that counts as the body, m, at least 0. Default 0.
    pub padding: f64,
}

/// Parameters of the proxemic layer.
#[derive(Debug, Clone, PartialEq)]
pub struct ProxemicSpec {
    /// Costs below this are left out, at least 0. Default 10.
    pub cutoff: f64,
    /// Cost in the middle, at least 0. Default 77.
    pub amplitude: f64,
    /// Variance, m², above 0. Default 0.25.
    pub covariance: f64,
    /// How much longer the front half is, s/m, at least 0. Default 5.
    pub factor: f64,
    /// How long somebody no longer seen is kept, s, at least 0. Default 0.75.
    pub keep_time: f64,
    /// Whether it is the passing layer: one side of a person alone. Default false.
    pub passing: bool,
}

impl Default for ProxemicSpec {
    fn default() -> Self {
        Self { cutoff: 10.0, amplitude: 77.0, covariance: 0.25, factor: 5.0, keep_time: 0.75, passing: false }
    }
}

/// Parameters of the social layer of the UPO group.
#[derive(Debug, Clone, PartialEq)]
pub struct UpoSocialSpec {
    /// Costs below this are left out, at least 0. Default 5.
    pub cutoff: f64,
    /// Cost in the middle, at least 0. Default 252: the plugin's own is 255, which is an unknown cell.
    pub amplitude: f64,
    /// Variance along the walk in front, m², above 0. Default 0.25, as of all that follow.
    pub covariance_front_height: f64,
    /// Variance across the walk in front, m².
    pub covariance_front_width: f64,
    /// Variance along the walk behind, m².
    pub covariance_rear_height: f64,
    /// Variance across the walk behind, m².
    pub covariance_rear_width: f64,
    /// Variance away from the walk on the right-hand side, m².
    pub covariance_right_height: f64,
    /// Variance along the walk on the right-hand side, m².
    pub covariance_right_width: f64,
    /// Variance round somebody who stands, m².
    pub covariance_when_still: f64,
    /// How much longer the front is, s/m, at least 0. Default 5.
    pub speed_factor_multiplier: f64,
    /// Whether the right-hand side has a cost too. Default true.
    pub use_passing: bool,
    /// How long somebody no longer seen is kept, s, at least 0. Default 0.75.
    pub keep_time: f64,
}

impl Default for UpoSocialSpec {
    fn default() -> Self {
        Self {
            cutoff: 5.0,
            amplitude: 252.0,
            covariance_front_height: 0.25,
            covariance_front_width: 0.25,
            covariance_rear_height: 0.25,
            covariance_rear_width: 0.25,
            covariance_right_height: 0.25,
            covariance_right_width: 0.25,
            covariance_when_still: 0.25,
            speed_factor_multiplier: 5.0,
            use_passing: true,
            keep_time: 0.75,
        }
    }
}

/// Parameters of Nav2CAN's social map.
#[derive(Debug, Clone, PartialEq)]
pub struct Nav2CanSpec {
    /// Cost of the innermost zone. Default 252.
    pub maxcost: u8,
    /// Spread ahead of a person, m, above 0. Default 2.
    pub sigma_front: f64,
    /// Spread to their sides, m, above 0. Default 4/3.
    pub sigma_side: f64,
    /// Spread behind them, m, above 0. Default 1.
    pub sigma_back: f64,
    /// Half the side of the social map, m, above 0. Default 7.5.
    pub half_size: f64,
}

impl Default for Nav2CanSpec {
    fn default() -> Self {
        Self { maxcost: 252, sigma_front: 2.0, sigma_side: 4.0 / 3.0, sigma_back: 1.0, half_size: 7.5 }
    }
}

/// How groups are known; ours, since the network of Nav2CAN is not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum GroupsSource {
    /// By where people stand and look, or how they walk.
    #[default]
    FFormation,
    /// As the simulation knows them.
    Oracle,
}

/// Parameters of Nav2CAN's interaction layer.
#[derive(Debug, Clone, PartialEq)]
pub struct GroupsSpec {
    /// How groups are known; key `groups`. Default `fformation`.
    pub source: GroupsSource,
    /// Cost inside the ellipse. Default 253.
    pub interaction_cost: u8,
    /// How long a group no longer seen is kept, s, at least 0. Default 2.
    pub keeptime: f64,
    /// Room round the box of the members, m, at least 0. Default 0.25.
    pub margin: f64,
    /// Half width of the ellipse of two, m, above 0. Default 0.4.
    pub pair_half_width: f64,
}

impl Default for GroupsSpec {
    fn default() -> Self {
        Self {
            source: GroupsSource::FFormation,
            interaction_cost: 253,
            keeptime: 2.0,
            margin: 0.25,
            pair_half_width: 0.4,
        }
    }
}

/// Plugins by name, and what is read of them.
const PLUGINS: [(&str, Plugin); 11] = [
    ("nav2_costmap_2d::StaticLayer", Plugin::Static),
    ("nav2_costmap_2d::ObstacleLayer", Plugin::Obstacle),
    ("nav2_costmap_2d::VoxelLayer", Plugin::Obstacle),
    ("nav2_costmap_2d::InflationLayer", Plugin::Inflation),
    ("socrates::OraclePeople", Plugin::OraclePeople),
    ("social_navigation_layers::ProxemicLayer", Plugin::Proxemic { passing: false }),
    ("social_navigation_layers::PassingLayer", Plugin::Proxemic { passing: true }),
    ("nav2_social_costmap_plugin::SocialLayer", Plugin::UpoSocial),
    ("nav2can::SocialLayer", Plugin::Nav2Can),
    ("nav2can::InteractionLayer", Plugin::Groups),
    ("nav2_costmap_2d::DenoiseLayer", Plugin::Nothing),
];
/// Layers of a costmap that names none.
const DEFAULT_PLUGINS: [(&str, Plugin); 3] =
    [("static_layer", Plugin::Static), ("obstacle_layer", Plugin::Obstacle), ("inflation_layer", Plugin::Inflation)];

#[derive(Debug, Clone, Copy)]
enum Plugin {
    Static,
    Obstacle,
    Inflation,
    OraclePeople,
    Proxemic {
        passing: bool,
    },
    UpoSocial,
    Nav2Can,
    Groups,
    /// Changes nothing that this simulation has: specks of a noisy lidar.
    Nothing,
}

/// Reads one costmap; Nav2 has its parameters two sections down.
pub(super) fn read(root: &mut Section<'_>, name: &str) -> CostmapServer {
    root.section(name, |outer| {
        outer.section(name, |node| node.section("ros__parameters", |parameters| server(parameters)))
    })
}

fn server(from: &mut Section<'_>) -> CostmapServer {
    from.skip(&[
        "publish_frequency",
        "global_frame",
        "robot_base_frame",
        "always_send_full_costmap",
        "introspection_mode",
        "transform_tolerance",
        "use_sim_time",
        "lethal_cost_threshold",
        "trinary_costmap",
        "unknown_cost_value",
        "map_topic",
        "origin_x",
        "origin_y",
        "initial_transform_timeout",
        "map_vis_z",
        "footprint_topic",
    ]);
    let mut found = CostmapServer::default();
    from.number("width", &mut found.width, Range::Above0);
    from.number("height", &mut found.height, Range::Above0);
    from.number("resolution", &mut found.resolution, Range::Above0);
    from.number("update_frequency", &mut found.update_frequency, Range::Above0);
    from.flag("rolling_window", &mut found.rolling_window);
    from.flag("track_unknown_space", &mut found.track_unknown_space);
    from.number("robot_radius", &mut found.robot_radius, Range::Above0);
    from.number("footprint_padding", &mut found.footprint_padding, Range::AtLeast0);
    found.footprint = from.outline("footprint").unwrap_or_default();
    for filter in from.texts("filters").unwrap_or_default() {
        from.skip(&[&filter]);
    }
    let names = from.texts("plugins");
    let names = names.unwrap_or_else(|| DEFAULT_PLUGINS.iter().map(|(name, _)| (*name).to_owned()).collect());
    found.layers = names.iter().filter_map(|name| from.section(name, |layer| read_layer(layer, name))).collect();
    // Nav2's own file has a section for the static layer in a costmap that does not use it.
    from.skip(&DEFAULT_PLUGINS.map(|(name, _)| name));
    found
}

/// A layer, if it is switched on.
fn read_layer(from: &mut Section<'_>, name: &str) -> Option<LayerSpec> {
    let mut enabled = true;
    from.flag("enabled", &mut enabled);
    let mut plugin = DEFAULT_PLUGINS.iter().find(|(default, _)| *default == name).map(|(_, plugin)| *plugin);
    match from.text("plugin") {
        Some(found) => {
            plugin = PLUGINS.iter().find(|(known, _)| *known == found).map(|(_, plugin)| *plugin);
            if plugin.is_none() {
                from.refuse("plugin", found, PLUGINS.map(|(name, _)| format!("`{name}`")).join(", "));
            }
        }
        None if plugin.is_none() => {
            from.refuse("plugin", "(nothing)", PLUGINS.map(|(name, _)| format!("`{name}`")).join(", "));
        }
        None => (),
    }
    let layer = match plugin? {
        Plugin::Static => LayerSpec::Static(static_layer(from)),
        Plugin::Obstacle => LayerSpec::Obstacle(obstacle_layer(from)),
        Plugin::Inflation => LayerSpec::Inflation(inflation_layer(from)),
        Plugin::OraclePeople => {
            let mut found = OraclePeopleSpec::default();
            from.number("padding", &mut found.padding, Range::AtLeast0);
            LayerSpec::OraclePeople(found)
        }
        Plugin::Proxemic { passing } => LayerSpec::Proxemic(proxemic_layer(from, passing)),
        Plugin::UpoSocial => LayerSpec::UpoSocial(upo_layer(from)),
        Plugin::Nav2Can => LayerSpec::Nav2Can(nav2can_layer(from)),
        Plugin::Groups => LayerSpec::Groups(group_layer(from)),
        Plugin::Nothing => {
            from.skip(&["minimal_group_size", "group_connectivity_type"]);
            return None;
        }
    };
    enabled.then_some(layer)
}

fn static_layer(from: &mut Section<'_>) -> StaticSpec {
    from.skip(&[
        "map_subscribe_transient_local",
        "subscribe_to_updates",
        "transform_tolerance",
        "map_topic",
        "footprint_clearing_enabled",
        "restore_cleared_footprint",
    ]);
    let mut found = StaticSpec::default();
    from.flag("use_maximum", &mut found.use_maximum);
    found
}

fn obstacle_layer(from: &mut Section<'_>) -> ObstacleSpec {
    // What a voxel has more than a cell, and heights, mean nothing to a flat scan.
    from.skip(&[
        "publish_voxel_map",
        "origin_z",
        "z_resolution",
        "z_voxels",
        "unknown_threshold",
        "mark_threshold",
        "min_obstacle_height",
        "max_obstacle_height",
        "tf_filter_tolerance",
    ]);
    let mut found = ObstacleSpec::default();
    from.flag("footprint_clearing_enabled", &mut found.footprint_clearing_enabled);
    let methods = [
        ("0", CombinationMethod::Overwrite),
        ("1", CombinationMethod::Max),
        ("2", CombinationMethod::MaxWithoutUnknown),
    ];
    from.choice("combination_method", &mut found.combination_method, &methods);
    let sources = from.text("observation_sources").unwrap_or_default();
    if let Some(source) = sources.split_whitespace().next() {
        from.section(source, |scan| {
            scan.skip(&[
                "topic",
                "data_type",
                "max_obstacle_height",
                "min_obstacle_height",
                "sensor_frame",
                "observation_persistence",
                "expected_update_rate",
                "transport_type",
            ]);
            scan.number("obstacle_min_range", &mut found.obstacle_min_range, Range::AtLeast0);
            scan.number("obstacle_max_range", &mut found.obstacle_max_range, Range::AtLeast0);
            scan.number("raytrace_min_range", &mut found.raytrace_min_range, Range::AtLeast0);
            scan.number("raytrace_max_range", &mut found.raytrace_max_range, Range::AtLeast0);
            scan.flag("marking", &mut found.marking);
            scan.flag("clearing", &mut found.clearing);
            scan.flag("inf_is_valid", &mut found.inf_is_valid);
        });
    }
    found
}

fn inflation_layer(from: &mut Section<'_>) -> InflationSpec {
    from.skip(&["inflate_around_unknown"]);
    let mut found = InflationSpec::default();
    from.number("inflation_radius", &mut found.inflation_radius, Range::AtLeast0);
    from.number("cost_scaling_factor", &mut found.cost_scaling_factor, Range::Above0);
    from.flag("inflate_unknown", &mut found.inflate_unknown);
    found
}

fn proxemic_layer(from: &mut Section<'_>, passing: bool) -> ProxemicSpec {
    from.skip(&["people_topic"]);
    let mut found = ProxemicSpec { passing, ..ProxemicSpec::default() };
    from.number("cutoff", &mut found.cutoff, Range::AtLeast0);
    from.number("amplitude", &mut found.amplitude, Range::AtLeast0);
    from.number("covariance", &mut found.covariance, Range::Above0);
    from.number("factor", &mut found.factor, Range::AtLeast0);
    from.number("keep_time", &mut found.keep_time, Range::AtLeast0);
    found
}

fn upo_layer(from: &mut Section<'_>) -> UpoSocialSpec {
    from.skip(&["people_topic", "publish_occgrid"]);
    let mut found = UpoSocialSpec::default();
    from.number("cutoff", &mut found.cutoff, Range::AtLeast0);
    from.number("amplitude", &mut found.amplitude, Range::AtLeast0);
    from.number("covariance_front_height", &mut found.covariance_front_height, Range::Above0);
    from.number("covariance_front_width", &mut found.covariance_front_width, Range::Above0);
    from.number("covariance_rear_height", &mut found.covariance_rear_height, Range::Above0);
    from.number("covariance_rear_width", &mut found.covariance_rear_width, Range::Above0);
    from.number("covariance_right_height", &mut found.covariance_right_height, Range::Above0);
    from.number("covariance_right_width", &mut found.covariance_right_width, Range::Above0);
    from.number("covariance_when_still", &mut found.covariance_when_still, Range::Above0);
    from.number("speed_factor_multiplier", &mut found.speed_factor_multiplier, Range::AtLeast0);
    from.flag("use_passing", &mut found.use_passing);
    from.number("keep_time", &mut found.keep_time, Range::AtLeast0);
    found
}

fn nav2can_layer(from: &mut Section<'_>) -> Nav2CanSpec {
    let mut found = Nav2CanSpec::default();
    from.cost("maxcost", &mut found.maxcost);
    from.number("sigma_front", &mut found.sigma_front, Range::Above0);
    from.number("sigma_side", &mut found.sigma_side, Range::Above0);
    from.number("sigma_back", &mut found.sigma_back, Range::Above0);
    from.number("half_size", &mut found.half_size, Range::Above0);
    found
}

fn group_layer(from: &mut Section<'_>) -> GroupsSpec {
    let mut found = GroupsSpec::default();
    let sources = [("fformation", GroupsSource::FFormation), ("oracle", GroupsSource::Oracle)];
    from.choice("groups", &mut found.source, &sources);
    from.cost("interaction_cost", &mut found.interaction_cost);
    from.number("keeptime", &mut found.keeptime, Range::AtLeast0);
    from.number("margin", &mut found.margin, Range::AtLeast0);
    from.number("pair_half_width", &mut found.pair_half_width, Range::Above0);
    found
}
