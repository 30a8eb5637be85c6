//! The occupancy grid: what a ROS map image says about each cell.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::geometry::{Point, Pose};

/// What is known of one cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Cell {
    /// Free floor.
    Free,
    /// A wall or object.
    Occupied,
    /// Never seen; nobody walks there.
    Unknown,
}

/// An occupancy grid with its place in the world.
///
/// Cells are stored row by row from the **top** image row, as the image has them. World y grows
/// upward, so row 0 has the largest y (for an origin without yaw).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Grid {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Edge length of a cell, m.
    pub resolution_m: f64,
    /// World pose of the lower left corner of the lower left cell.
    pub origin: Pose,
    /// Cells row by row from the top.
    #[serde(with = "runs")]
    #[schemars(with = "String")]
    pub cells: Vec<Cell>,
}

impl Grid {
    /// The cell at a column and row (row 0 on top); outside is [`Cell::Unknown`].
    #[must_use]
    pub fn at(&self, column: usize, row: usize) -> Cell {
        if column >= self.width {
            return Cell::Unknown;
        }
        self.cells.get(row.saturating_mul(self.width).saturating_add(column)).copied().unwrap_or(Cell::Unknown)
    }

    /// World point of a pixel position (continuous; pixel (0, 0) is the top left corner of the image).
    ///
    /// `y = oy + (H - py) * res`, turned by the origin's yaw: right for maps that are not centered too.
    #[must_use]
    pub fn world_from_pixel(&self, px: f64, py: f64) -> Point {
        #[expect(clippy::cast_precision_loss, reason = "a map has fewer than 2^53 rows")]
        let height = self.height as f64;
        let (along, up) = (px * self.resolution_m, (height - py) * self.resolution_m);
        let turn = nalgebra::Rotation2::new(self.origin.yaw);
        self.origin.point() + turn * nalgebra::Vector2::new(along, up)
    }

    /// Pixel position of a world point; the inverse of [`Grid::world_from_pixel`].
    #[must_use]
    pub fn pixel_from_world(&self, point: &Point) -> (f64, f64) {
        #[expect(clippy::cast_precision_loss, reason = "a map has fewer than 2^53 rows")]
        let height = self.height as f64;
        let turned = nalgebra::Rotation2::new(-self.origin.yaw) * (point - self.origin.point());
        (turned.x / self.resolution_m, height - turned.y / self.resolution_m)
    }

    /// Column and row of the cell under a world point, if the map covers it.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked against the map's size first")]
    pub fn cell_of(&self, point: &Point) -> Option<(usize, usize)> {
        let (px, py) = self.pixel_from_world(point);
        #[expect(clippy::cast_precision_loss, reason = "a map has fewer than 2^53 cells a side")]
        let inside = px >= 0.0 && py >= 0.0 && px < self.width as f64 && py < self.height as f64;
        inside.then(|| (px.floor() as usize, py.floor() as usize))
    }

    /// World point of the middle of a cell.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "a map has fewer than 2^53 cells a side")]
    pub fn center_of(&self, column: usize, row: usize) -> Point {
        self.world_from_pixel(column as f64 + 0.5, row as f64 + 0.5)
    }

    /// Whether the cell under the point is free floor.
    #[must_use]
    pub fn is_free(&self, point: &Point) -> bool {
        self.cell_of(point).is_some_and(|(column, row)| self.at(column, row) == Cell::Free)
    }
}

/// Cells as run lengths (`120f3o…`), so that an artifact of a large map stays small.
mod runs {
    use super::Cell;
    use serde::{Deserialize as _, Deserializer, Serializer, de::Error as _};

    /// A map larger than this is refused before memory is taken for it.
    const MAX_CELLS: usize = 100_000_000;

    pub(super) fn serialize<S: Serializer>(cells: &[Cell], out: S) -> Result<S::Ok, S::Error> {
        let mut text = String::new();
        let mut rest = cells;
        while let Some(first) = rest.first() {
            let letter = match first {
                Cell::Free => 'f',
                Cell::Occupied => 'o',
                Cell::Unknown => 'u',
            };
            let run = run_length(rest, *first);
            text.push_str(&run.to_string());
            text.push(letter);
            rest = rest.get(run..).unwrap_or_default();
        }
        out.serialize_str(&text)
    }

    /// How many cells from the first on are of this kind: whole blocks at a time, which the compiler compares at once.
    fn run_length(cells: &[Cell], kind: Cell) -> usize {
        const BLOCK: usize = 64;
        let alike = |block: &[Cell]| block.iter().fold(true, |all, cell| all & (*cell == kind));
        let whole = cells.chunks_exact(BLOCK).take_while(|block| alike(block)).count() * BLOCK;
        let rest = cells.get(whole..).unwrap_or_default();
        whole + rest.iter().take_while(|cell| **cell == kind).count()
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(input: D) -> Result<Vec<Cell>, D::Error> {
        let text = String::deserialize(input)?;
        let mut cells = Vec::new();
        let mut count = 0_usize;
        for letter in text.chars() {
            if let Some(digit) = letter.to_digit(10) {
                count = count.saturating_mul(10).saturating_add(digit as usize);
                continue;
            }
            let cell = match letter {
                'f' => Cell::Free,
                'o' => Cell::Occupied,
                'u' => Cell::Unknown,
                other => return Err(D::Error::custom(format!("`{other}` is no cell; allowed: f, o, u"))),
            };
            if cells.len().saturating_add(count) > MAX_CELLS {
                return Err(D::Error::custom(format!("more than {MAX_CELLS} cells")));
            }
            cells.resize(cells.len() + count, cell);
            count = 0;
        }
        Ok(cells)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(yaw: f64) -> Grid {
        let cells = vec![Cell::Free; 12];
        Grid { width: 4, height: 3, resolution_m: 0.5, origin: Pose::new(-1.0, 2.0, yaw), cells }
    }

    #[test]
    fn the_lower_left_corner_of_the_image_is_the_origin() {
        let corner = grid(0.7).world_from_pixel(0.0, 3.0);
        assert!((corner - Point::new(-1.0, 2.0)).norm() < 1e-12);
    }

    #[test]
    fn pixels_and_points_round_trip_on_a_turned_map() {
        let grid = grid(0.3);
        let (px, py) = grid.pixel_from_world(&grid.world_from_pixel(1.25, 2.5));
        assert!((px - 1.25).abs() < 1e-12 && (py - 2.5).abs() < 1e-12);
    }

    #[test]
    fn runs_of_any_length_are_written_as_they_are() {
        let letters = [('f', Cell::Free), ('o', Cell::Occupied), ('u', Cell::Unknown)];
        let lengths = [1, 63, 64, 65, 1, 2, 127, 128, 129, 640, 1, 5];
        let (mut cells, mut wanted) = (Vec::new(), String::new());
        for (place, length) in lengths.into_iter().enumerate() {
            let (letter, cell) = letters[place % 3];
            cells.extend(std::iter::repeat_n(cell, length));
            wanted.push_str(&format!("{length}{letter}"));
        }
        let grid = Grid { width: cells.len(), height: 1, cells, ..grid(0.0) };
        let text = serde_json::to_string(&grid).unwrap();
        assert!(text.contains(&format!("\"{wanted}\"")), "{text}");
        assert_eq!(serde_json::from_str::<Grid>(&text).unwrap(), grid);
    }

    #[test]
    fn cells_survive_the_run_length_text() {
        let mut grid = grid(0.0);
        grid.cells[5] = Cell::Occupied;
        let text = serde_json::to_string(&grid).unwrap();
        assert!(text.contains("5f1o6f"));
        assert_eq!(serde_json::from_str::<Grid>(&text).unwrap(), grid);
    }
}
