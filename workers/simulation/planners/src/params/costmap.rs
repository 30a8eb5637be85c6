//! `local_costmap` and `global_costmap`: a costmap and its layers.

use super::section::{Range, Section};
use crate::costmap::{
    FFormationParams, GroupSource, GroupsParams, InflationParams, LayerParams, Merge, Nav2CanParams, ObstacleParams,
    OraclePeopleParams, ProxemicParams, StaticParams, UpoSocialParams,
};

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
    /// The layers that are switched on, first written first: `nav2_costmap_2d`'s static, obstacle, voxel (the same for a flat scan)
    /// and inflation, those of `social_navigation_layers`, `nav2_social_costmap_plugin` and Nav2CAN, and `socrates::OraclePeople`.
    pub layers: Vec<LayerParams>,
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
    pub fn inflation(&self) -> Option<&InflationParams> {
        self.layers.iter().find_map(|layer| match layer {
            LayerParams::Inflation(inflation) => Some(inflation),
            LayerParams::Static(_)
            | LayerParams::Obstacle(_)
            | LayerParams::OraclePeople(_)
            | LayerParams::Proxemic(_)
            | LayerParams::UpoSocial(_)
            | LayerParams::Nav2Can(_)
            | LayerParams::Groups(_) => None,
        })
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
    from.idle_number("footprint_padding", 0.0, Range::AtLeast0);
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
fn read_layer(from: &mut Section<'_>, name: &str) -> Option<LayerParams> {
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
        Plugin::Static => LayerParams::Static(static_layer(from)),
        Plugin::Obstacle => LayerParams::Obstacle(obstacle_layer(from)),
        Plugin::Inflation => LayerParams::Inflation(inflation_layer(from)),
        Plugin::OraclePeople => {
            let mut found = OraclePeopleParams::default();
            from.number("padding", &mut found.padding, Range::AtLeast0);
            LayerParams::OraclePeople(found)
        }
        Plugin::Proxemic { passing } => LayerParams::Proxemic(proxemic_layer(from, passing)),
        Plugin::UpoSocial => LayerParams::UpoSocial(upo_layer(from)),
        Plugin::Nav2Can => LayerParams::Nav2Can(nav2can_layer(from)),
        Plugin::Groups => LayerParams::Groups(group_layer(from)),
        Plugin::Nothing => {
            from.skip(&["minimal_group_size", "group_connectivity_type"]);
            return None;
        }
    };
    enabled.then_some(layer)
}

fn static_layer(from: &mut Section<'_>) -> StaticParams {
    from.skip(&[
        "map_subscribe_transient_local",
        "subscribe_to_updates",
        "transform_tolerance",
        "map_topic",
        "footprint_clearing_enabled",
        "restore_cleared_footprint",
    ]);
    let mut found = StaticParams::default();
    from.flag("use_maximum", &mut found.use_maximum);
    found
}

fn obstacle_layer(from: &mut Section<'_>) -> ObstacleParams {
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
    let mut found = ObstacleParams::default();
    from.flag("footprint_clearing_enabled", &mut found.footprint_clearing_enabled);
    let methods = [("0", Merge::Overwrite), ("1", Merge::Max), ("2", Merge::MaxWithoutUnknown)];
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

fn inflation_layer(from: &mut Section<'_>) -> InflationParams {
    from.skip(&["inflate_around_unknown"]);
    let mut found = InflationParams::default();
    from.number("inflation_radius", &mut found.inflation_radius, Range::AtLeast0);
    from.number("cost_scaling_factor", &mut found.cost_scaling_factor, Range::Above0);
    from.flag("inflate_unknown", &mut found.inflate_unknown);
    found
}

fn proxemic_layer(from: &mut Section<'_>, passing: bool) -> ProxemicParams {
    from.skip(&["people_topic"]);
    let mut found = ProxemicParams { passing, ..ProxemicParams::default() };
    from.number("cutoff", &mut found.cutoff, Range::AtLeast0);
    from.number("amplitude", &mut found.amplitude, Range::AtLeast0);
    from.number("covariance", &mut found.covariance, Range::Above0);
    from.number("factor", &mut found.factor, Range::AtLeast0);
    from.number("keep_time", &mut found.keep_time, Range::AtLeast0);
    found
}

fn upo_layer(from: &mut Section<'_>) -> UpoSocialParams {
    from.skip(&["people_topic", "publish_occgrid"]);
    let mut found = UpoSocialParams::default();
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

fn nav2can_layer(from: &mut Section<'_>) -> Nav2CanParams {
    let mut found = Nav2CanParams::default();
    from.cost("maxcost", &mut found.maxcost);
    from.number("sigma_front", &mut found.sigma_front, Range::Above0);
    from.number("sigma_side", &mut found.sigma_side, Range::Above0);
    from.number("sigma_back", &mut found.sigma_back, Range::Above0);
    from.number("half_size", &mut found.half_size, Range::Above0);
    found
}

fn group_layer(from: &mut Section<'_>) -> GroupsParams {
    let mut found = GroupsParams::default();
    let sources = [
        ("fformation", GroupSource::FFormation(FFormationParams::default())),
        // The groups that the simulation knows are told with the mission.
        ("oracle", GroupSource::Given(Vec::new())),
    ];
    from.choice("groups", &mut found.source, &sources);
    from.cost("interaction_cost", &mut found.interaction_cost);
    from.number("keeptime", &mut found.keeptime, Range::AtLeast0);
    from.number("margin", &mut found.margin, Range::AtLeast0);
    from.number("pair_half_width", &mut found.pair_half_width, Range::Above0);
    found
}
