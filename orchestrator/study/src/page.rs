//! The report as one page without anything from outside.

use crate::analyze::{Declared, Results};
use crate::cell::{Cell, Figure, PlannerScore};
use crate::design::Design;
use crate::exclude;
use crate::rating::Origin;
use crate::words;

const STYLE: &str = include_str!("page.css");
/// Colors of answers from the lowest to the highest, told apart with any color vision (Crameri's `vik`, thinned).
const COLORS: [&str; 9] =
    ["#6b1d1a", "#a8502f", "#cf8a63", "#e5bfa4", "#e8e8e8", "#a9c6da", "#6a9fc4", "#2f6f9f", "#0f3d66"];
/// Width of the bars and of the drawing, px.
const BARS: f64 = 520.0;
const WIDE: f64 = 1000.0;
const LEFT: f64 = 150.0;

/// Writes at the end of a text.
macro_rules! put {
    ($out:expr, $($text:tt)*) => { $out.push_str(&format!($($text)*)) };
}

fn html(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

fn p_of(p: f64) -> String {
    if p < 0.001 { "&lt; .001".to_owned() } else { format!("{p:.3}").replacen("0.", ".", 1) }
}

fn or_why<T>(of: &Figure<T>, show: impl Fn(&T) -> String) -> String {
    of.as_ref().map_or_else(|why| format!("<span class=why>none: {}</span>", html(why)), show)
}

/// The page.
#[must_use]
pub fn page(results: &Results, design: &Design) -> String {
    let mut out = format!(
        "<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content=\"width=device-width,initial-scale=1\"><title>{0}{3}</title><style>{STYLE}</style><main>{4}<h1>{0}</h1><p class=soft>Study file {1}… · {2}</p>",
        html(&results.title),
        results.digest.get(..16).unwrap_or_default(),
        html(words::standing(results.declared)),
        if results.origin.is_simulated() { " (simulated answers)" } else { "" },
        mark(results.origin)
    );
    summary(&mut out, results);
    excluded(&mut out, results, design);
    for scenario in &design.scenarios {
        put!(out, "<h2>Scenario {}</h2>", html(scenario));
        for of in results.cells.iter().filter(|cell| &cell.scenario == scenario) {
            section(&mut out, of, results.declared);
        }
    }
    put!(out, "<h2>Methods</h2><section><pre>{}</pre></section>", html(&words::methods(results, design)));
    instruments(&mut out, design);
    out.push_str("</main></html>\n");
    out
}

/// The mark of simulated answers, which stays in sight; nothing where people gave them.
fn mark(origin: Origin) -> String {
    if origin.is_simulated() { format!("<p class=mark role=note>{}</p>", html(Origin::MARK)) } else { String::new() }
}

fn summary(out: &mut String, results: &Results) {
    let kept = results.people - results.excluded.len();
    let (given, missing) = results.ratings;
    put!(
        out,
        "<section><h3>What the tests say</h3><p>{} answered, {kept} stay after exclusions; {given} ratings, {missing} missing.</p>",
        words::people(results.people, results.origin)
    );
    if results.findings.is_empty() {
        out.push_str(
            "<p>No pair of planners differs after Holm's adjustment. That is no proof that they are alike.</p>",
        );
    } else {
        out.push_str("<ul>");
        for one in &results.findings {
            let kind = if one.declared { "declared" } else { "exploratory" };
            put!(
                out,
                "<li><b>{}</b> was rated higher than <b>{}</b> on {} in {}: {:.2} points, p<sub>Holm</sub> {} <span class=tag>{kind}</span></li>",
                html(&one.higher),
                html(&one.lower),
                html(&one.dimension),
                html(&one.scenario),
                one.points,
                p_of(one.p)
            );
        }
        out.push_str("</ul>");
    }
    out.push_str("</section>");
}

fn excluded(out: &mut String, results: &Results, design: &Design) {
    out.push_str("<section><h3>People left out</h3><div class=scroll><table><tr><th>rule<th>people who<th>people</tr>");
    for (rule, words) in exclude::declared(design) {
        let count = results.excluded.values().filter(|broken| broken.contains(&rule)).count();
        put!(out, "<tr><td>{rule}<td>{}<td class=n>{count}</tr>", html(&words));
    }
    out.push_str("</table></div>");
    if results.excluded.is_empty() {
        out.push_str("<p>Nobody.</p>");
    } else {
        out.push_str("<ul>");
        for (person, rules) in &results.excluded {
            put!(out, "<li><code>{}</code> <span class=soft>{}</span></li>", html(person), rules.join(", "));
        }
        out.push_str("</ul>");
    }
    out.push_str("</section>");
}

fn section(out: &mut String, cell: &Cell, standing: Declared) {
    let mut tags = String::new();
    if cell.declared {
        tags.push_str("<span class=\"tag good\">declared</span>");
    } else {
        put!(
            tags,
            "<span class=tag>{}</span>",
            if standing == Declared::Before { "exploratory: no hypothesis names it" } else { "exploratory" }
        );
    }
    if cell.single {
        tags.push_str("<span class=\"tag warn\">single item or fewer than three: no scale</span>");
    }
    if !cell.validated {
        tags.push_str("<span class=\"tag warn\">not validated</span>");
    }
    if cell.alpha.as_ref().is_ok_and(|alpha| alpha.0 < 0.6) && !cell.single {
        tags.push_str("<span class=\"tag warn\">alpha below .6: its items do not measure one thing</span>");
    }
    put!(
        out,
        "<section><h3>{}{tags}</h3><p class=soft>{} people rated every planner.</p>",
        html(&cell.dimension),
        cell.complete
    );
    bars(out, cell);
    figures(out, cell);
    pairs(out, cell);
    effects(out, cell);
    out.push_str("</section>");
}

/// Number as a share of others.
fn share(part: usize, all: usize) -> f64 {
    crate::stats::float(part) / crate::stats::float(all.max(1))
}

/// Stacked answers of each planner, and beside them mean and interval.
fn bars(out: &mut String, cell: &Cell) {
    let (low, high) = cell.points;
    let step = if high - low > 20.0 { (high - low) / 10.0 } else { 1.0 };
    let color = |points: f64| {
        let at = libm::round((points - low) / (high - low) * 8.0).clamp(0.0, 8.0);
        COLORS
            .iter()
            .zip(0..9)
            .find(|(_, place)| libm::fabs(f64::from(*place) - at) < 0.5)
            .map_or("#888", |(color, _)| *color)
    };
    let rows = crate::stats::float(cell.planners.len());
    let height = rows * 34.0 + 30.0;
    put!(
        out,
        "<div class=scroll><svg viewBox=\"0 0 {WIDE} {height}\" style=\"min-width:640px\" role=img aria-label=\"answers by planner\" font-size=13 font-family=\"system-ui,sans-serif\">"
    );
    let (from, wide) = (LEFT + BARS + 40.0, WIDE - LEFT - BARS - 70.0);
    let x = |points: f64| from + (points - low) / (high - low) * wide;
    #[expect(clippy::cast_possible_truncation, reason = "at most 20 steps")]
    let ticks = if high - low > 20.0 { 5 } else { 1 + libm::round(high - low) as i32 };
    for tick in 0..ticks {
        let points = low + (high - low) * f64::from(tick) / f64::from(ticks - 1);
        let at = x(points);
        put!(
            out,
            "<line x1={at:.1} x2={at:.1} y1=4 y2={:.1} stroke=\"#e6eaef\"/><text x={at:.1} y={:.1} text-anchor=middle fill=\"#5b6876\" font-size=12>{points}</text>",
            height - 24.0,
            height - 8.0
        );
    }
    for (row, of) in cell.planners.iter().enumerate() {
        let y = crate::stats::float(row) * 34.0 + 8.0;
        put!(out, "<text x=0 y={:.1} fill=\"#1d2733\">{}</text>", y + 17.0, html(&of.planner));
        stack(out, of, y, &color);
        let at = x(of.mean);
        if let Some((a, b)) = of.mean_interval {
            put!(
                out,
                "<line x1={:.1} x2={:.1} y1={2:.1} y2={2:.1} stroke=\"#1f5fa8\" stroke-width=2.5 />",
                x(a),
                x(b),
                y + 12.0
            );
        }
        if at.is_finite() {
            put!(
                out,
                "<circle cx={at:.1} cy={:.1} r=5 fill=\"#1f5fa8\"><title>mean {:.2}</title></circle>",
                y + 12.0,
                of.mean
            );
        }
    }
    out.push_str("</svg></div><p class=key>");
    let mut points = low;
    while points <= high + 1e-9 {
        let shown = if step > 1.0 { format!("from {points}") } else { points.to_string() };
        if step <= 1.0 || points < high {
            put!(out, "<span><i style=\"background:{}\"></i>{shown}</span>", color(points));
        }
        points += step;
    }
    out.push_str(
        "<span>answers in the direction of the scale · right: mean of the scores with its 95 % interval</span></p>",
    );
}

fn stack(out: &mut String, of: &PlannerScore, y: f64, color: &dyn Fn(f64) -> &'static str) {
    let all: usize = of.answers.iter().map(|(_, count)| count).sum();
    let mut at = LEFT;
    for (points, count) in &of.answers {
        let width = share(*count, all) * BARS;
        let fill = color(*points);
        put!(
            out,
            "<rect x={at:.1} y={y:.1} width={width:.1} height=24 fill=\"{fill}\"><title>{points}: {count} of {all}</title></rect>"
        );
        if width > 26.0 {
            let ink = if matches!(fill, "#e8e8e8" | "#e5bfa4" | "#a9c6da") { "#1d2733" } else { "#fff" };
            let percent = libm::round(share(*count, all) * 100.0);
            put!(
                out,
                "<text x={:.1} y={:.1} text-anchor=middle font-size=11 fill=\"{ink}\">{percent}%</text>",
                at + width / 2.0,
                y + 16.0
            );
        }
        at += width;
    }
}

fn figures(out: &mut String, cell: &Cell) {
    out.push_str("<dl>");
    let mut add = |name: &str, value: String| {
        put!(out, "<div><dt>{name}<dd>{value}</div>");
    };
    let friedman = or_why(&cell.friedman, |of| {
        let exact = of.p_exact.map_or_else(String::new, |p| format!(", exact {}", p_of(p)));
        format!("χ²({}) = {:.2}, p {}{exact}, W = {:.2}", of.df, of.chi2, p_of(of.p), of.w)
    });
    add("Friedman", friedman);
    add("Friedman, nobody left out", or_why(&cell.friedman_all, |p| format!("p {}", p_of(*p))));
    add(
        "ordinal mixed model",
        or_why(&cell.ordinal, |of| format!("LR = {:.2}, p {}, σ = {:.2}", of.lr.0, p_of(of.lr.1), of.sigma)),
    );
    add(
        "linear mixed model",
        or_why(&cell.linear, |of| format!("F({}, {}) = {:.2}, p {}", of.1, of.2, of.0, p_of(of.3))),
    );
    add("one place later", or_why(&cell.order, |of| format!("log odds {:.2}, p {}", of.0, p_of(of.2))));
    if !cell.single {
        add("alpha [95 %]", or_why(&cell.alpha, |of| format!("{:.2} [{:.2}, {:.2}]", of.0, of.1, of.2)));
        add("alpha within people", or_why(&cell.alpha_within, |of| format!("{of:.2}")));
        add("omega", or_why(&cell.omega, |of| format!("{of:.2}")));
    }
    add("ICC of a film, one person", or_why(&cell.icc, |of| format!("{:.2}", of.0)));
    add("ICC of a film, mean of all", or_why(&cell.icc, |of| format!("{:.2} (k = {})", of.1, of.2)));
    add("Krippendorff's α, ordinal", or_why(&cell.krippendorff, |of| format!("{of:.2}")));
    let missing: usize = cell.planners.iter().map(|of| of.missing).sum();
    add("missing answers", missing.to_string());
    out.push_str("</dl>");
}

fn pairs(out: &mut String, cell: &Cell) {
    out.push_str("<div class=scroll><table><tr><th>pair<th>shift [95 %]<th>z<th>p<th>p<sub>Holm</sub><th>p<sub>Conover</sub><th>p<sub>Nemenyi</sub><th>r<th>rank-biserial<th>no difference<th>equivalence</tr>");
    for pair in &cell.pairs {
        let name = format!("{} − {}", html(&pair.first), html(&pair.against));
        let same = pair.equivalence.as_ref().map_or_else(
            || "<span class=why>no margin declared</span>".to_owned(),
            |same| or_why(same, |of| format!("p {}", p_of(of.3))),
        );
        let (conover, nemenyi) = pair.posthoc.as_ref().map_or((None, None), |of| (of.0, Some(of.1)));
        let [conover, nemenyi] = [conover, nemenyi].map(|p| p.map_or_else(|| "–".to_owned(), p_of));
        match &pair.test {
            Ok(of) => {
                let (shift, low, high) = of.shift;
                put!(
                    out,
                    "<tr><td>{name}<td class=n>{shift:.2} [{low:.2}, {high:.2}]<td class=n>{:.2}<td class=n>{}<td class=n>{}<td class=n>{conover}<td class=n>{nemenyi}<td class=n>{:.2}<td class=n>{:.2}<td class=n>{} of {}<td class=n>{same}</tr>",
                    of.z,
                    p_of(of.p),
                    p_of(of.p_holm),
                    of.r,
                    of.rank_biserial,
                    of.zeros,
                    of.n
                );
            }
            Err(why) => {
                put!(out, "<tr><td>{name}<td colspan=9 class=why>none: {}<td>{same}</tr>", html(why));
            }
        }
    }
    out.push_str("</table></div>");
}

fn effects(out: &mut String, cell: &Cell) {
    out.push_str("<div class=scroll><table><tr><th>planner<th>people<th>median<th>mean [95 %]<th>odds ratio [95 %]<th>p<th>strength (Bradley–Terry)</tr>");
    for (row, of) in cell.planners.iter().enumerate() {
        let mean = of
            .mean_interval
            .map_or_else(|| format!("{:.2}", of.mean), |(a, b)| format!("{:.2} [{a:.2}, {b:.2}]", of.mean));
        let model = cell.ordinal.as_ref().ok().and_then(|model| model.effects.iter().find(|one| one.0 == of.planner));
        let odds = model.map_or_else(
            || if row == 0 && cell.ordinal.is_ok() { "1 (reference)".to_owned() } else { "–".to_owned() },
            |(_, effect, error, _)| {
                let end = |by: f64| libm::exp(effect + by * 1.959_964 * error);
                format!("{:.2} [{:.2}, {:.2}]", libm::exp(*effect), end(-1.0), end(1.0))
            },
        );
        let p = model.map_or_else(|| "–".to_owned(), |(_, _, _, p)| p_of(*p));
        let strength = cell.strengths.as_ref().ok().and_then(|all| all.iter().find(|one| one.0 == of.planner));
        let strength =
            strength.map_or_else(|| "–".to_owned(), |(_, strength, error)| format!("{strength:.2} ({error:.2})"));
        put!(
            out,
            "<tr><td>{}<td class=n>{}<td class=n>{:.2}<td class=n>{mean}<td class=n>{odds}<td class=n>{p}<td class=n>{strength}</tr>",
            html(&of.planner),
            of.people,
            of.median
        );
    }
    out.push_str("</table></div>");
}

fn instruments(out: &mut String, design: &Design) {
    out.push_str("<h2>Instruments</h2>");
    for of in &design.instruments {
        let valid = if of.validated { "" } else { "<span class=\"tag warn\">not validated</span>" };
        put!(
            out,
            "<section><h3>{}{valid}</h3><p class=soft>{}. {}</p><p>{}</p>",
            html(&of.title),
            html(&of.source),
            html(&of.notice),
            html(&of.stem)
        );
        for scale in &of.scales {
            let items: Vec<String> = scale
                .items
                .iter()
                .map(|item| {
                    format!(
                        "<li>{} <span class=soft>{}{}</span></li>",
                        html(&item.text),
                        item.code,
                        if item.reversed { ", reversed" } else { "" }
                    )
                })
                .collect();
            put!(out, "<p><b>{}</b></p><ul>{}</ul>", html(&scale.id), items.concat());
        }
        out.push_str("</section>");
    }
}
