//! `plan.toml`: a small floor plan from which a location folder is made.

use serde::Deserialize;
use socrates_model::{AreaName, Door, Fault, FaultCode, Where};
use toml::Spanned;

use crate::doors_file::{line_at, toml_fault};
use crate::keys::{AREA_NAME, DOOR, Keys};
use crate::map_file::MAX_PIXELS;

/// Name of the file in messages.
pub(crate) const PLAN: &str = "plan.toml";
/// Largest side of a plan, m.
const SIDE_MAX_M: f64 = 500.0;

/// The keys of the file.
pub(crate) const PLAN_KEYS: Keys = Keys {
    needed: &["description", "size_m", "resolution_m", "floors", "nodes", "edges"],
    other: &["wall_thickness_m", "walls", "openings", "blocks", "doors", "names"],
    tables: &[
        ("nodes", &Keys { needed: &["id", "type", "at"], other: &[], tables: &[] }),
        ("edges", &Keys { needed: &["type", "along"], other: &[], tables: &[] }),
        ("doors", &DOOR),
        ("names", &AREA_NAME),
    ],
};

/// Two corners or two ends: `[x0, y0, x1, y1]`, m.
pub(crate) type Quad = Spanned<[f64; 4]>;

/// The plan. Lengths in m, x to the right, y up, (0, 0) the lower left corner of the map.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Plan {
    pub(crate) description: String,
    pub(crate) size_m: Spanned<[f64; 2]>,
    pub(crate) resolution_m: Spanned<f64>,
    #[serde(default = "default_thickness_m")]
    pub(crate) wall_thickness_m: f64,
    pub(crate) floors: Vec<Quad>,
    #[serde(default)]
    pub(crate) walls: Vec<Quad>,
    #[serde(default)]
    pub(crate) openings: Vec<Quad>,
    #[serde(default)]
    pub(crate) blocks: Vec<Quad>,
    pub(crate) nodes: Vec<Spanned<PlanNode>>,
    pub(crate) edges: Vec<Spanned<PlanEdges>>,
    #[serde(default)]
    pub(crate) doors: Vec<Door>,
    #[serde(default)]
    pub(crate) names: Vec<AreaName>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlanNode {
    pub(crate) id: String,
    #[serde(rename = "type")]
    pub(crate) kind: String,
    pub(crate) at: [f64; 2],
}

/// Edges of one type along a row of nodes.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlanEdges {
    #[serde(rename = "type")]
    pub(crate) kind: String,
    pub(crate) along: Vec<String>,
}

fn default_thickness_m() -> f64 {
    0.2
}

impl Plan {
    /// Reads a plan and checks its numbers and names.
    pub(crate) fn read(text: &str) -> Result<Self, Vec<Fault>> {
        let plan: Self = toml::from_str(text).map_err(|why| vec![toml_fault(PLAN, &PLAN_KEYS, text, &why)])?;
        let faults = plan.problems(text);
        if faults.is_empty() { Ok(plan) } else { Err(faults) }
    }

    pub(crate) fn line<T>(text: &str, item: &Spanned<T>) -> Where {
        Where::file(PLAN).line(line_at(text, item.span().start))
    }

    fn problems(&self, text: &str) -> Vec<Fault> {
        let mut faults = Vec::new();
        let size = self.size_m.get_ref();
        if !size.iter().all(|side| (1.0..=SIDE_MAX_M).contains(side)) {
            let message = format!("`size_m` is {size:?}; allowed: 1 to {SIDE_MAX_M} m a side");
            faults.push(Fault::new(FaultCode::MValue, Self::line(text, &self.size_m), message));
        }
        let resolution = *self.resolution_m.get_ref();
        if !(0.02..=0.5).contains(&resolution) {
            let message = format!("`resolution_m` is {resolution}; allowed: 0.02 to 0.5");
            faults.push(Fault::new(FaultCode::MValue, Self::line(text, &self.resolution_m), message));
        }
        #[expect(clippy::cast_precision_loss, reason = "the limit is far below 2^53")]
        let most = MAX_PIXELS as f64;
        let pixels = size.iter().product::<f64>() / (resolution * resolution);
        if faults.is_empty() && pixels > most {
            let message = format!("`size_m` {size:?} at {resolution} m makes {pixels:.0} pixels; allowed: {most}");
            faults.push(Fault::new(FaultCode::MValue, Self::line(text, &self.size_m), message));
        }
        if !(0.02..=2.0).contains(&self.wall_thickness_m) {
            let message = format!("`wall_thickness_m` is {}; allowed: 0.02 to 2", self.wall_thickness_m);
            faults.push(Fault::new(FaultCode::MValue, Where::file(PLAN), message));
        }
        for (key, quads) in
            [("floors", &self.floors), ("walls", &self.walls), ("openings", &self.openings), ("blocks", &self.blocks)]
        {
            for quad in quads {
                let [x0, y0, x1, y1] = quad.get_ref();
                let inside = [(x0, 0), (x1, 0), (y0, 1), (y1, 1)]
                    .iter()
                    .all(|(v, axis)| size.get(*axis).is_some_and(|side| (0.0..=*side).contains(*v)));
                let area = key == "floors" || key == "blocks";
                let ordered = if area { x0 < x1 && y0 < y1 } else { (x0 - x1).abs() + (y0 - y1).abs() > 0.0 };
                if !inside || !ordered {
                    let form =
                        if area { "[left, bottom, right, top]" } else { "[x0, y0, x1, y1] with two different ends" };
                    let message = format!("`{key}` has {:?}; allowed: {form}, m, within {size:?}", quad.get_ref());
                    faults.push(Fault::new(FaultCode::MValue, Self::line(text, quad), message));
                }
            }
        }
        self.name_problems(text, &mut faults);
        faults
    }

    fn name_problems(&self, text: &str, faults: &mut Vec<Fault>) {
        let known = |id: &str| self.nodes.iter().any(|node| node.get_ref().id == id);
        for (index, spanned) in self.nodes.iter().enumerate() {
            let (node, at) = (spanned.get_ref(), Self::line(text, spanned));
            if let Some(first) = self.nodes.iter().take(index).find(|other| other.get_ref().id == node.id) {
                let message = format!("the id `{}` is taken already at {}", node.id, Self::line(text, first));
                faults.push(Fault::new(FaultCode::MId, &at, message));
            }
            let size = self.size_m.get_ref();
            if !node.at.iter().zip(size).all(|(v, side)| (0.0..*side).contains(v)) {
                let message = format!("node `{}` is at {:?}, outside the plan of {size:?} m", node.id, node.at);
                faults.push(Fault::new(FaultCode::MValue, &at, message));
            }
        }
        for spanned in &self.edges {
            let (edges, at) = (spanned.get_ref(), Self::line(text, spanned));
            if edges.along.len() < 2 {
                let message = format!("`along` names {} nodes; at least two are needed", edges.along.len());
                faults.push(Fault::new(FaultCode::MValue, &at, message));
            }
            for id in edges.along.iter().filter(|id| !known(id)) {
                faults.push(Fault::new(
                    FaultCode::MId,
                    &at,
                    format!("`along` names `{id}`, which is no node of the plan"),
                ));
            }
        }
    }
}
