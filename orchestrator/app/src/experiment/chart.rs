//! The plots of an experiment as drawings.

use socrates_draw::palette;
use socrates_draw::svg::{Svg, escape};
use socrates_experiment::plots::{Axis, Join, Line, Panel, Plot, Point};

/// Width of a panel with its margins, and of a panel that stands alone, px.
const PANEL: f64 = 480.0;
const ALONE: f64 = 680.0;
/// Height of a panel with its margins, px.
const HEIGHT: f64 = 310.0;
/// Margins around the axes: left, right, top, bottom, px.
const MARGINS: [f64; 4] = [62.0, 18.0, 34.0, 52.0];
/// Height of a row of the legend, px.
const LEGEND: f64 = 22.0;
/// Width of a letter of the legend, about, px.
const LETTER: f64 = 6.6;
/// Room for the mark before a name of the legend, and after it, px.
const KEY: (f64, f64) = (34.0, 18.0);
/// Marks of neighboring policies stand so far apart, px.
const APART: f64 = 3.0;
/// Room for marks between the frame and the ends of the axis across, px.
const INSET: f64 = 16.0;
/// Half the size of a mark, px.
const MARK: f64 = 3.6;
/// Letters of a panel's title at most.
const TITLE: usize = 58;
/// What every plot says of itself.
pub(super) const STAMP: &str = "injected faults";

/// A plot as a drawing of its own.
pub(super) fn svg(plot: &Plot) -> String {
    let columns = plot.panels.len().clamp(1, 2);
    let width = if columns == 1 { ALONE } else { 2.0 * PANEL };
    let panel = width / count(columns);
    let legend = legend_rows(plot, width - 130.0);
    let top = LEGEND * count(legend.len()) + 8.0;
    let rows = plot.panels.len().div_ceil(columns);
    let mut svg = Svg::new(width, top + HEIGHT * count(rows));
    svg.rect((0.0, 0.0), (width, top + HEIGHT * count(rows)), "fill=\"#ffffff\"");
    for (row, lines) in legend.iter().enumerate() {
        let mut x = 14.0;
        let y = LEGEND * count(row) + 16.0;
        for line in lines {
            key(&mut svg, line, (x, y - 4.0));
            svg.text((x + KEY.0, y), &line.name, &format!("font-size=\"12\" fill=\"{}\"", palette::INK));
            x += wide(&line.name);
        }
    }
    let stamp = format!("font-size=\"12\" text-anchor=\"end\" fill=\"{}\"", palette::BAD);
    svg.text((width - 14.0, 16.0), STAMP, &stamp);
    for (place, one) in plot.panels.iter().enumerate() {
        let at = (panel * count(place % columns), top + HEIGHT * count(place / columns));
        draw(&mut svg, one, at, panel);
    }
    svg.finish()
}

/// Names of the legend, row by row: each line that is drawn once, as the first panel that has it does.
fn legend_rows(plot: &Plot, width: f64) -> Vec<Vec<&Line>> {
    let mut lines: Vec<&Line> = Vec::new();
    for line in plot.panels.iter().flat_map(|panel| &panel.lines) {
        if !line.points.is_empty() && lines.iter().all(|known| known.name != line.name) {
            lines.push(line);
        }
    }
    let (mut rows, mut used): (Vec<Vec<&Line>>, f64) = (vec![Vec::new()], 0.0);
    for line in lines {
        let wide = wide(&line.name);
        if used > 0.0 && used + wide > width {
            rows.push(Vec::new());
            used = 0.0;
        }
        used += wide;
        rows.last_mut().into_iter().for_each(|row| row.push(line));
    }
    rows
}

fn wide(name: &str) -> f64 {
    KEY.0 + KEY.1 + LETTER * count(name.chars().count())
}

/// The color of a line.
fn color(line: &Line) -> &'static str {
    match line.policy {
        Some(number) => palette::agent(u32::try_from(number).unwrap_or(0)),
        None => palette::QUIET,
    }
}

/// How a line is stroked.
fn stroke(line: &Line) -> String {
    let dashes = match line.join {
        Join::Dashed => " stroke-dasharray=\"7 4\"",
        Join::Dotted => " stroke-dasharray=\"2 3\"",
        Join::Straight | Join::Steps => "",
    };
    format!("stroke=\"{}\" stroke-width=\"1.8\"{dashes}", color(line))
}

/// A line and its mark, for the legend.
fn key(svg: &mut Svg, line: &Line, at: (f64, f64)) {
    svg.line(at, (at.0 + KEY.0 - 8.0, at.1), &stroke(line));
    if line.join == Join::Straight {
        mark(svg, line, (at.0 + (KEY.0 - 8.0) / 2.0, at.1));
    }
}

/// The mark of a policy: shape and color both tell it.
fn mark(svg: &mut Svg, line: &Line, (x, y): (f64, f64)) {
    let (fill, r) = (format!("fill=\"{}\"", color(line)), MARK);
    let polygon = |points: &[(f64, f64)]| {
        let list: Vec<String> = points.iter().map(|(dx, dy)| format!("{:.1},{:.1}", x + dx, y + dy)).collect();
        format!("<polygon points=\"{}\" {fill}/>", list.join(" "))
    };
    match line.policy.unwrap_or(0) % 4 {
        0 => svg.circle((x, y), r, &fill),
        1 => svg.rect((x - r, y - r), (2.0 * r, 2.0 * r), &fill),
        2 => svg.raw(&polygon(&[(0.0, -1.3 * r), (1.2 * r, r), (-1.2 * r, r)])),
        _ => svg.raw(&polygon(&[(0.0, -1.4 * r), (1.4 * r, 0.0), (0.0, 1.4 * r), (-1.4 * r, 0.0)])),
    }
}

/// Where the values of a panel stand on the page.
struct Frame<'a> {
    panel: &'a Panel,
    left: f64,
    top: f64,
    width: f64,
    height: f64,
    /// Room at both ends of the axis across.
    inset: f64,
}

impl Frame<'_> {
    fn x(&self, value: f64) -> f64 {
        self.left + self.inset + (self.width - 2.0 * self.inset) * part(&self.panel.x, value)
    }

    fn y(&self, value: f64) -> f64 {
        self.top + self.height * (1.0 - part(&self.panel.y, value))
    }
}

/// How far along an axis a value stands, 0 to 1.
fn part(axis: &Axis, value: f64) -> f64 {
    let on = |value: f64| if axis.log { value.max(1e-9).log10() } else { value };
    let (from, to) = (on(axis.from), on(axis.to));
    ((on(value) - from) / (to - from).max(1e-12)).clamp(0.0, 1.0)
}

fn draw(svg: &mut Svg, panel: &Panel, at: (f64, f64), width: f64) {
    let [left, right, top, bottom] = MARGINS;
    let marked = panel.lines.iter().any(|line| line.join == Join::Straight);
    let frame = Frame {
        panel,
        left: at.0 + left,
        top: at.1 + top,
        width: width - left - right,
        height: HEIGHT - top - bottom,
        inset: if marked { INSET } else { 0.0 },
    };
    let title: String = panel.title.chars().take(TITLE).collect();
    let title = if title == panel.title { title } else { format!("{title}…") };
    svg.heading((frame.left, frame.top - 12.0), &title, 13.0, palette::INK);
    axes(svg, &frame);
    let policies = panel.lines.iter().filter(|line| line.policy.is_some()).count();
    // What theory says lies below what was found.
    let (found, theory): (Vec<&Line>, Vec<&Line>) = panel.lines.iter().partition(|line| line.policy.is_some());
    for line in theory.into_iter().chain(found) {
        match line.join {
            Join::Steps => steps(svg, &frame, line),
            Join::Straight => points(svg, &frame, line, policies),
            Join::Dashed | Join::Dotted => {
                let points: Vec<(f64, f64)> = line.points.iter().map(|(x, y, _)| (frame.x(*x), frame.y(*y))).collect();
                svg.polyline(&points, &stroke(line));
            }
        }
    }
}

fn axes(svg: &mut Svg, frame: &Frame<'_>) {
    let (right, bottom) = (frame.left + frame.width, frame.top + frame.height);
    let rule = format!("stroke=\"{}\" stroke-width=\"1\"", palette::UNKNOWN);
    let words = |anchor: &str| format!("font-size=\"11\" text-anchor=\"{anchor}\" fill=\"{}\"", palette::QUIET);
    for (value, label) in ticks(&frame.panel.x, 8) {
        let x = frame.x(value);
        svg.line((x, frame.top), (x, bottom), &rule);
        svg.text((x, bottom + 16.0), &label, &words("middle"));
    }
    for (value, label) in ticks(&frame.panel.y, 6) {
        let y = frame.y(value);
        svg.line((frame.left, y), (right, y), &rule);
        svg.text((frame.left - 7.0, y + 4.0), &label, &words("end"));
    }
    let ink = format!("stroke=\"{}\" stroke-width=\"1\"", palette::QUIET);
    svg.line((frame.left, bottom), (right, bottom), &ink);
    svg.line((frame.left, frame.top), (frame.left, bottom), &ink);
    let name = format!("font-size=\"12\" text-anchor=\"middle\" fill=\"{}\"", palette::INK);
    svg.text((frame.left + frame.width / 2.0, bottom + 36.0), &frame.panel.x.name, &name);
    let (x, y) = (frame.left - 46.0, frame.top + frame.height / 2.0);
    svg.raw(&format!(
        "<text transform=\"translate({x:.1} {y:.1}) rotate(-90)\" {name}>{}</text>",
        escape(&frame.panel.y.name)
    ));
}

/// A line through marks with their intervals. Marks at the same place are set side by side.
fn points(svg: &mut Svg, frame: &Frame<'_>, line: &Line, policies: usize) {
    let beside = APART * (count(line.policy.unwrap_or(0)) - (count(policies) - 1.0) / 2.0);
    let place = |(x, y, _): &Point| (frame.x(*x) + beside, frame.y(*y));
    svg.polyline(&line.points.iter().map(place).collect::<Vec<_>>(), &format!("{} opacity=\"0.8\"", stroke(line)));
    for point in &line.points {
        let (x, y) = place(point);
        if let Some((low, high)) = point.2 {
            let thin = format!("stroke=\"{}\" stroke-width=\"1.2\"", color(line));
            svg.line((x, frame.y(low)), (x, frame.y(high)), &thin);
        }
        mark(svg, line, (x, y));
    }
}

fn steps(svg: &mut Svg, frame: &Frame<'_>, line: &Line) {
    let mut corners: Vec<(f64, f64)> = Vec::new();
    for (x, y, _) in &line.points {
        let (x, y) = (frame.x(*x), frame.y(*y));
        if let Some((_, before)) = corners.last().copied() {
            corners.push((x, before));
        } else {
            // A distribution rises from the axis.
            corners.push((x, frame.y(if frame.panel.x.log { 0.0 } else { 1.0 })));
        }
        corners.push((x, y));
    }
    svg.polyline(&corners, &format!("{} opacity=\"0.85\"", stroke(line)));
}

/// Round values along an axis, with their labels.
fn ticks(axis: &Axis, about: usize) -> Vec<(f64, String)> {
    if axis.log {
        let decades = (-9..=9).map(|power: i32| 10.0_f64.powi(power));
        let inside = decades.filter(|value| *value >= axis.from * 0.999 && *value <= axis.to * 1.001);
        return inside.map(|value| (value, format!("{value}"))).collect();
    }
    let scale = if axis.percent { 100.0 } else { 1.0 };
    let (from, to) = (axis.from * scale, axis.to * scale);
    let rough = ((to - from) / count(about)).max(1e-9);
    let power = 10.0_f64.powf(rough.log10().floor());
    let step =
        [1.0, 2.0, 5.0, 10.0].into_iter().map(|of| of * power).find(|step| *step >= rough * 0.999).unwrap_or(power);
    let decimals = if step >= 1.0 {
        0
    } else if step >= 0.1 {
        1
    } else {
        2
    };
    let first = (from / step).ceil();
    (0..=2 * about)
        .map(|number| (first + count(number)) * step)
        .take_while(|value| *value <= to + step * 1e-6)
        .map(|value| (value / scale, format!("{value:.decimals$}")))
        .collect()
}

#[expect(clippy::cast_precision_loss, reason = "what a picture shows is few")]
pub(super) const fn count(of: usize) -> f64 {
    of as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(from: f64, to: f64, log: bool, percent: bool) -> Axis {
        Axis { name: "x, s".to_owned(), log, from, to, percent }
    }

    #[test]
    fn ticks_are_round_and_inside() {
        let labels = |axis: Axis| ticks(&axis, 6).into_iter().map(|(_, label)| label).collect::<Vec<_>>();
        assert_eq!(labels(axis(0.0, 1.0, false, true)), ["0", "20", "40", "60", "80", "100"]);
        assert_eq!(labels(axis(1.0, 8.0, false, false)), ["2", "4", "6", "8"]);
        assert_eq!(labels(axis(0.0, 0.3, false, true)), ["0", "5", "10", "15", "20", "25", "30"]);
        assert_eq!(labels(axis(0.01, 120.0, true, false)), ["0.01", "0.1", "1", "10", "100"]);
        assert_eq!(labels(axis(1.0, 1.5, false, false)), ["1.0", "1.1", "1.2", "1.3", "1.4", "1.5"]);
    }

    #[test]
    fn a_plot_is_stamped_and_says_what_its_axes_and_lines_are() {
        let line = |name: &str, policy: Option<usize>, join: Join| Line {
            name: name.to_owned(),
            policy,
            join,
            points: vec![(0.1, 0.2, Some((0.1, 0.3))), (0.9, 0.8, None)],
        };
        let panel = Panel {
            title: "a <b> · c".to_owned(),
            x: axis(0.0, 1.0, false, true),
            y: axis(0.0, 1.0, false, true),
            lines: vec![
                line("first", Some(0), Join::Straight),
                line("second", Some(1), Join::Steps),
                line("law", None, Join::Dashed),
            ],
        };
        let plot = Plot {
            name: "success",
            title: "t".to_owned(),
            caption: "c".to_owned(),
            panels: vec![panel.clone(), panel.clone(), panel],
            left_out: 0,
        };
        let drawn = svg(&plot);
        assert!(drawn.contains(STAMP) && drawn.contains("a &lt;b&gt; · c"));
        assert_eq!((drawn.matches(">first<").count(), drawn.matches(">x, s<").count()), (1, 6));
        assert!(drawn.contains("stroke-dasharray") && drawn.contains("height=\"650\""), "{drawn}");
        assert!(!drawn.contains("NaN"));
    }
}
