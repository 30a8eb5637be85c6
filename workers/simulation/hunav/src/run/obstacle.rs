//! The one obstacle point that HuNavSim gives to each person.

use socrates_model::Point;

use super::scene::Scene;

/// Objects farther away are not felt, m.
const REACH_M: f64 = 10.0;

/// The bounding box of an object of the world, with sides along the axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Where the object is, m.
    pub center: Point,
    /// Half of its side along x, m.
    pub half_x_m: f64,
    /// Half of its side along y, m.
    pub half_y_m: f64,
}

impl Bounds {
    /// Where the straight line from a point to the center enters the box; `None` for a point inside.
    fn entry(&self, from: &Point) -> Option<Point> {
        let way = from - self.center;
        // The face that is met is the one whose side is the larger share of the way.
        let share = (way.x.abs() / self.half_x_m).max(way.y.abs() / self.half_y_m);
        (share > 1.0 && share.is_finite()).then(|| self.center + way / share)
    }
}

/// The nearest of: the entry into the bounding box of an object; the same for other people, who are meant to be left
/// out and are not; and the nearest wall of the map, which stands for the world's models where only a map is known.
/// At most 10 m away. Objects with a coordinate of exactly 0 are passed over, as upstream does.
pub(crate) fn one_point(scene: &Scene, me: usize) -> Option<Point> {
    let agent = scene.agents.get(me)?;
    let at = agent.at;
    let people = scene
        .agents
        .iter()
        .enumerate()
        .filter(|(place, other)| *place != me && other.present)
        .map(|(_, other)| Bounds { center: other.at, half_x_m: other.radius_m, half_y_m: other.radius_m });
    let objects = scene.boxes.iter().copied().filter(|bounds| bounds.center.x != 0.0 && bounds.center.y != 0.0);
    let entries = objects.chain(people).filter_map(|bounds| bounds.entry(&at));
    let wall = scene.floor.nearest_wall(&at, REACH_M).map(|(_, wall)| wall);
    entries
        .chain(wall)
        .map(|point| ((point - at).norm(), point))
        .filter(|(distance, _)| *distance <= REACH_M)
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, point)| point)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_is_entered_on_the_side_that_faces_the_person() {
        let bounds = Bounds { center: Point::new(5.0, 1.0), half_x_m: 1.0, half_y_m: 0.5 };
        let entry = bounds.entry(&Point::new(1.0, 1.0)).unwrap();
        assert!((entry - Point::new(4.0, 1.0)).norm() < 1e-12);
        let entry = bounds.entry(&Point::new(5.0, 9.0)).unwrap();
        assert!((entry - Point::new(5.0, 1.5)).norm() < 1e-12);
        assert!(bounds.entry(&Point::new(5.2, 1.1)).is_none());
    }
}
