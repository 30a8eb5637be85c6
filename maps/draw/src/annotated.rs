//! The annotated map: ids and types on the map, for a vision model and for people.

use std::collections::BTreeMap;

use socrates_model::{Location, PlaceClass, Point};

use crate::label::{Area, Labels, text_width, wrapped};
use crate::map_layer::{Frame, draw_doors, draw_floor, draw_graph, draw_scale, wall_areas};
use crate::palette;
use crate::svg::Svg;

/// Colors of node classes, for the dots and the legend.
fn class_color(class: PlaceClass) -> &'static str {
    match class {
        PlaceClass::Intersection => "#D55E00",
        PlaceClass::BlindCorner => "#CC79A7",
        PlaceClass::Doorway => "#a8641c",
        PlaceClass::Elevator | PlaceClass::ElevatorLobby => "#6a51a3",
        PlaceClass::Room => "#009E73",
        PlaceClass::OpenArea => "#56B4E9",
        PlaceClass::Exit => "#4d9221",
        PlaceClass::NarrowPassage => "#E69F00",
        PlaceClass::Corridor => "#0072B2",
        PlaceClass::Plain => "#7d8590",
    }
}

/// Most lines of a remark.
const NOTE_LINES: usize = 5;

/// A remark on a picture: where it belongs, map frame, m, and what it says.
#[derive(Debug, Clone, PartialEq)]
pub struct MapNote {
    /// Where; `None` where it is about the whole map.
    pub at: Option<Point>,
    /// In words.
    pub text: String,
}

/// The map with its scene graph, node ids and a legend of the map's own type names, as SVG.
#[must_use]
pub fn annotated_map(location: &Location) -> String {
    annotated_map_with(location, &[])
}

/// The same with remarks: numbers at their places, and their texts in a list below.
#[must_use]
pub fn annotated_map_with(location: &Location, notes: &[MapNote]) -> String {
    const SIZE: f64 = 1180.0;
    let frame = Frame::around(location, SIZE, 860.0, (20.0, 46.0));
    let (w, h) = frame.size();
    let mut types: BTreeMap<&str, (PlaceClass, usize)> = BTreeMap::new();
    for node in location.graph.nodes() {
        types.entry(node.kind.as_str()).or_insert_with(|| (PlaceClass::of_type(&node.kind), 0)).1 += 1;
    }
    #[expect(clippy::cast_precision_loss, reason = "a legend has few rows")]
    let rows = types.len().div_ceil(4) as f64;
    let width = (w + 40.0).max(620.0);
    let listed: Vec<String> =
        notes.iter().enumerate().flat_map(|(at, note)| note_lines(at + 1, note, width - 60.0)).collect();
    #[expect(clippy::cast_precision_loss, reason = "a list has few rows")]
    let below = if listed.is_empty() { 0.0 } else { listed.len() as f64 * 18.0 + 14.0 };
    let height = h + 46.0 + 40.0 + rows * 20.0 + 16.0 + below;
    let mut svg = Svg::new(width, height);
    svg.rect((0.0, 0.0), (width, height), "fill=\"#ffffff\"");
    let ink = palette::INK;
    svg.heading((20.0, 30.0), &location.name, 20.0, ink);
    svg.text(
        (30.0 + text_width(&location.name, 20.0), 30.0),
        &format!("{} nodes, {} ways", location.graph.nodes().len(), location.graph.edges().len()),
        &format!("font-size=\"15\" fill=\"{}\"", palette::QUIET),
    );
    draw_floor(&mut svg, location, &frame);
    draw_graph(&mut svg, location, &frame, "#9fb4cc", 2.2);
    draw_doors(&mut svg, location, &frame);
    let mut labels = Labels::within(Area { x: 4.0, y: 34.0, w: width - 8.0, h: h + 24.0 });
    labels.avoid(wall_areas(location, &frame));
    for edge in location.graph.edges() {
        if let Some(points) = location.graph.edge_points(&edge.from, &edge.to) {
            labels.avoid_line(&points.iter().map(|p| frame.px(location, p)).collect::<Vec<_>>());
        }
    }
    for door in &location.doors {
        labels.avoid_line(&[frame.px(location, &door.from), frame.px(location, &door.to)]);
    }
    for node in location.graph.nodes() {
        let (x, y) = frame.px(location, &node.at);
        labels.block(Area { x: x - 6.0, y: y - 6.0, w: 12.0, h: 12.0 });
    }
    for node in location.graph.nodes() {
        let at = frame.px(location, &node.at);
        let color = class_color(PlaceClass::of_type(&node.kind));
        svg.circle(at, 5.5, &format!("fill=\"{color}\" stroke=\"#ffffff\" stroke-width=\"1.5\""));
        let text = node.id.as_str();
        let area = labels.place_within(at, (text_width(text, 14.0) + 4.0, 15.0), 8.0, 3);
        svg.label((area.x + area.w / 2.0, area.y + 12.0), text, 14.0, ink);
    }
    for (number, note) in notes.iter().enumerate() {
        let Some(at) = note.at.map(|at| frame.px(location, &at)) else { continue };
        svg.circle(
            at,
            9.0,
            &format!("fill=\"#ffffff\" fill-opacity=\"0.85\" stroke=\"{}\" stroke-width=\"1.8\"", palette::DOOR),
        );
        svg.text(
            (at.0, at.1 + 4.5),
            &(number + 1).to_string(),
            &format!("font-size=\"12\" text-anchor=\"middle\" fill=\"{}\"", palette::DOOR),
        );
    }
    draw_scale(&mut svg, location, &frame, 18.0);
    for (row, line) in listed.iter().enumerate() {
        #[expect(clippy::cast_precision_loss, reason = "a list has few rows")]
        let y = h + 46.0 + 40.0 + rows * 20.0 + 22.0 + row as f64 * 18.0;
        svg.text((26.0, y), line, &format!("font-size=\"13\" fill=\"{}\"", palette::QUIET));
    }
    for (index, (name, (class, count))) in types.into_iter().enumerate() {
        #[expect(clippy::cast_precision_loss, reason = "a legend has few rows")]
        let (x, y) = (26.0 + (index % 4) as f64 * (width - 40.0) / 4.0, h + 46.0 + 44.0 + (index / 4) as f64 * 20.0);
        svg.circle((x, y - 4.0), 5.0, &format!("fill=\"{}\"", class_color(class)));
        svg.text((x + 12.0, y), &format!("{name} ({count})"), &format!("font-size=\"13\" fill=\"{ink}\""));
    }
    svg.finish()
}

/// A remark in lines of at most so many pixels.
fn note_lines(number: usize, note: &MapNote, most: f64) -> Vec<String> {
    let place = note.at.map_or_else(String::new, |at| format!("({:.1}, {:.1}) m: ", at.x, at.y));
    wrapped(&format!("{number} {place}{}", note.text), most, 13.0, NOTE_LINES)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remarks_are_numbered_at_their_places_and_listed_below() {
        let location = crate::fixture::hall("hall");
        let bare = annotated_map(&location);
        let note = |at, text: &str| MapNote { at, text: text.to_owned() };
        let notes = [note(Some(Point::new(1.0, 1.0)), "a gap of 0.5 m"), note(None, &"long ".repeat(90))];
        let svg = annotated_map_with(&location, &notes);
        assert!(svg.contains("1 (1.0, 1.0) m: a gap of 0.5 m"), "{svg}");
        assert_eq!(svg.matches("<circle").count(), bare.matches("<circle").count() + 1);
        assert!(note_lines(2, &notes[1], 400.0).len() > 2);
    }
}
