//! How scenarios ended, drawn: a field for each policy and end, the darker the more.

use socrates_draw::palette;
use socrates_draw::svg::Svg;
use socrates_experiment::heat::{Heat, HeatRow, REALISED, ends};

use super::chart::{STAMP, count};

/// Width of the drawing, px.
const WIDTH: f64 = 960.0;
/// Room for the names of policies, px.
const NAMES: f64 = 130.0;
/// Size of a field, px.
const FIELD: (f64, f64) = (88.0, 26.0);
/// Room above the fields of a table for its title and the ends, and below them, px.
const AROUND: (f64, f64) = (52.0, 22.0);
/// Room for the stamp, px.
const TOP: f64 = 24.0;
/// Opacity from which on the words of a field are white.
const DARK: f64 = 0.65;
/// Letters of a policy's name and of a title at most.
const LETTERS: (usize, usize) = (18, 70);

/// All tables as one drawing.
pub(super) fn svg(heats: &[Heat]) -> String {
    let ends = ends(heats);
    let wide = FIELD.0.mul_add(count(ends.len()), NAMES + 20.0);
    let columns = if heats.len() > 1 && 2.0 * wide <= WIDTH { 2 } else { 1 };
    let mut places = Vec::new();
    let mut top = TOP;
    for pair in heats.chunks(columns) {
        let rows = pair.iter().map(|heat| heat.rows.len()).max().unwrap_or(0);
        places.extend(pair.iter().enumerate().map(|(column, heat)| (heat, (WIDTH / 2.0 * count(column), top))));
        top += FIELD.1.mul_add(count(rows), AROUND.0 + AROUND.1);
    }
    let width = WIDTH.max(wide);
    let mut svg = Svg::new(width, top);
    svg.rect((0.0, 0.0), (width, top), "fill=\"#ffffff\"");
    let stamp = format!("font-size=\"12\" text-anchor=\"end\" fill=\"{}\"", palette::BAD);
    svg.text((width - 14.0, 16.0), STAMP, &stamp);
    for (heat, at) in places {
        table(&mut svg, heat, &ends, at);
    }
    svg.finish()
}

fn table(svg: &mut Svg, heat: &Heat, ends: &[&'static str], at: (f64, f64)) {
    svg.heading((at.0 + 14.0, at.1 + 18.0), &short(&heat.title, LETTERS.1), 13.0, palette::INK);
    let words = |anchor: &str, color: &str| format!("font-size=\"11\" text-anchor=\"{anchor}\" fill=\"{color}\"");
    let left = |column: usize| FIELD.0.mul_add(count(column), at.0 + NAMES);
    for (column, end) in ends.iter().enumerate() {
        svg.text((left(column) + FIELD.0 / 2.0, at.1 + AROUND.0 - 8.0), end, &words("middle", palette::QUIET));
    }
    for (place, row) in heat.rows.iter().enumerate() {
        let y = FIELD.1.mul_add(count(place), at.1 + AROUND.0);
        let middle = y + FIELD.1 / 2.0 + 4.0;
        svg.text((at.0 + NAMES - 8.0, middle), &short(&row.policy, LETTERS.0), &words("end", palette::INK));
        for (column, end) in ends.iter().enumerate() {
            let share = share(row, end);
            let color = if *end == REALISED { palette::GOOD } else { palette::BAD };
            // Little is still to be told from nothing.
            let opacity = if share > 0.0 { share.mul_add(0.9, 0.1) } else { 0.0 };
            let style = format!("fill=\"{color}\" fill-opacity=\"{opacity:.2}\" stroke=\"{}\"", palette::UNKNOWN);
            svg.rect((left(column), y), FIELD, &style);
            let ink = if opacity > DARK { "#ffffff" } else { palette::INK };
            if share > 0.0 {
                svg.text((left(column) + FIELD.0 / 2.0, middle), &percent(share), &words("middle", ink));
            }
        }
    }
}

fn share(row: &HeatRow, end: &str) -> f64 {
    count(row.ends.get(end).copied().unwrap_or(0)) / count(row.of.max(1))
}

/// `12 %`; what is close to nothing or to all is said with a digit more, so that it is neither.
fn percent(share: f64) -> String {
    let of_hundred = 100.0 * share;
    let plain = (1.0..=99.0).contains(&of_hundred) || share >= 1.0;
    if plain { format!("{of_hundred:.0} %") } else { format!("{of_hundred:.1} %") }
}

fn short(text: &str, letters: usize) -> String {
    if text.chars().count() <= letters { text.to_owned() } else { text.chars().take(letters).chain(['…']).collect() }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[test]
    fn a_field_says_its_share_and_nothing_where_there_is_none() {
        let row = |policy: &str, ends: &[(&'static str, usize)]| HeatRow {
            policy: policy.to_owned(),
            of: 200,
            ends: ends.iter().copied().collect::<BTreeMap<_, _>>(),
        };
        let heat = Heat {
            title: "a <b>".to_owned(),
            rows: vec![
                row("none", &[(REALISED, 20), ("overload", 180)]),
                row("jitter", &[(REALISED, 199), ("semantic", 1)]),
            ],
        };
        let drawn = svg(&[heat.clone(), heat]);
        for (part, times) in [
            (">10 %<", 2),
            (">90 %<", 2),
            (">0.5 %<", 2),
            (">99.5 %<", 2),
            (">a &lt;b&gt;<", 2),
            (">overload<", 2),
            (STAMP, 1),
        ] {
            assert_eq!(drawn.matches(part).count(), times, "{part}: {drawn}");
        }
        assert!(!drawn.contains(">0 %<") && !drawn.contains("NaN"), "{drawn}");
    }
}
