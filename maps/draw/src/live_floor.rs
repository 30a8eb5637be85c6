//! The floor of a place as a picture of its own, on which a page draws who is where.

use socrates_model::{Location, Point};

use crate::map_layer::{draw_floor, draw_graph};
use crate::svg::Svg;
use crate::{palette, play};

/// A floor and how world and drawing units belong together: `px = (x - origin.x) px_per_m`, `py = (origin.y - y) px_per_m`.
#[derive(Debug, Clone, PartialEq)]
pub struct LiveFloor {
    /// Left, top, width and height of the drawing, in its units.
    pub area: [f64; 4],
    /// Drawing units of a meter.
    pub px_per_m: f64,
    /// Upper left corner along the axes of the map, which are turned by `yaw` against those of the world, m.
    pub origin: [f64; 2],
    /// Direction of the map's first axis in the world, rad.
    pub yaw: f64,
    /// The drawing, without what nobody has asked for.
    svg: String,
}

impl LiveFloor {
    /// The floor, walls and ways of a place.
    #[must_use]
    pub fn of(location: &Location) -> Self {
        let frame = play::frame(location);
        let (width, height) = frame.size();
        let mut svg = Svg::new(width, height);
        draw_floor(&mut svg, location, &frame);
        draw_graph(&mut svg, location, &frame, palette::UNKNOWN, 1.5);
        let px_per_m = frame.len(location, 1.0);
        let (left, top) = frame.px(location, &Point::origin());
        Self {
            area: [0.0, 0.0, width.round(), height.round()],
            px_per_m,
            origin: [-left / px_per_m, top / px_per_m],
            yaw: location.grid.origin.yaw,
            svg: svg.finish(),
        }
    }

    /// The drawing as an SVG document.
    #[must_use]
    pub fn svg(&self) -> &str {
        &self.svg
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::hall;

    #[test]
    fn world_points_are_where_the_drawing_has_them() {
        for yaw in [0.0, 0.5, -2.1] {
            let mut location = hall("hall");
            location.grid.origin.yaw = yaw;
            let floor = LiveFloor::of(&location);
            let frame = play::frame(&location);
            let (sin, cos) = floor.yaw.sin_cos();
            for point in [Point::new(0.0, 0.0), Point::new(3.5, 1.25)] {
                let (x, y) = frame.px(&location, &point);
                let (along, across) = (cos * point.x + sin * point.y, cos * point.y - sin * point.x);
                assert!(((along - floor.origin[0]) * floor.px_per_m - x).abs() < 1e-6, "yaw {yaw}: {x}");
                assert!(((floor.origin[1] - across) * floor.px_per_m - y).abs() < 1e-6, "yaw {yaw}: {y}");
            }
        }
        let floor = LiveFloor::of(&hall("hall"));
        assert!(floor.svg().starts_with("<svg") && floor.svg().contains("</svg>"));
    }
}
