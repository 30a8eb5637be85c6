//! The survey as LimeSurvey imports it: a table with tabs. Orders are random there, not balanced; `read` takes its answers back by code.

use super::asks::{Block, blocks, checks};
use super::legend;
use super::media::{GATE, Media, video};
use super::orders::orders;
use super::page::{escape, paragraphs};
use super::setup::agreed;
use crate::design::Design;
use crate::problem::Problem;

/// Columns of the table.
const COLUMNS: [&str; 16] = [
    "class",
    "type/scale",
    "name",
    "relevance",
    "text",
    "help",
    "language",
    "validation",
    "mandatory",
    "other",
    "default",
    "same_default",
    "hidden",
    "slider_min",
    "slider_max",
    "slider_layout",
];

/// The code of the question that holds who comes.
pub const PERSON: &str = "PROLIFICPID";

/// The code of the text that says what films show.
pub(crate) const SEEN: &str = "seen";

/// A name as a code of LimeSurvey: letters and digits.
#[must_use]
pub fn code(name: &str) -> String {
    name.chars().filter(char::is_ascii_alphanumeric).collect()
}

/// Rows of the table.
struct Rows(Vec<[String; 16]>);

impl Rows {
    fn add(&mut self, class: &str, kind: &str, name: &str, text: &str, more: &[(&str, String)]) {
        let mut row: [String; 16] = std::array::from_fn(|_| String::new());
        // A tab or a line end would begin another cell.
        let plain = |text: &str| text.replace(['\t', '\n', '\r'], " ");
        let given = [("class", class), ("type/scale", kind), ("name", name), ("text", text), ("language", "en")];
        let given = given.into_iter().map(|(key, value)| (key, value.to_owned()));
        for (key, value) in given.chain(more.iter().map(|(key, value)| (*key, value.clone()))) {
            if let Some(cell) = COLUMNS.iter().position(|known| *known == key).and_then(|at| row.get_mut(at)) {
                *cell = plain(&value);
            }
        }
        self.0.push(row);
    }

    fn question(&mut self, kind: &str, name: &str, text: &str, more: &[(&str, String)]) {
        let mut all = vec![("relevance", "1".to_owned()), ("mandatory", "N".to_owned())];
        all.extend(more.iter().cloned());
        self.add("Q", kind, name, text, &all);
    }
}

/// The survey as text with tabs.
///
/// # Errors
/// An attention check that cannot be answered, a text of consent that does not say how long it takes.
pub fn limesurvey(design: &Design, media: &Media) -> Result<String, Problem> {
    let all = orders(design);
    let most = all.iter().map(|order| order.films.len()).max().unwrap_or(0);
    let mut rows = Rows(Vec::new());
    for (name, value) in [
        ("language", "en"),
        ("format", "G"),
        ("anonymized", "Y"),
        ("ipaddr", "N"),
        ("refurl", "N"),
        ("savetimings", "Y"),
        ("allowprev", "N"),
    ] {
        rows.add("S", "", name, value, &[]);
    }
    rows.add("SL", "", "surveyls_title", &design.title, &[]);
    if let Some(url) = &design.survey.completion_url {
        rows.add("SL", "", "surveyls_url", url, &[]);
    }
    rows.add("G", "", "consent", "", &[("relevance", "1".to_owned())]);
    let consent = escape(&agreed(design)?.text()).replace("\n\n", "<br><br>");
    rows.question(
        "L",
        "consent",
        &format!("{consent}<br>If you do not agree, please close this page."),
        &[("mandatory", "Y".to_owned())],
    );
    rows.add("A", "0", "1", "I agree and take part", &[]);
    // Filled from the address: `?PROLIFICPID=…`.
    rows.question("S", PERSON, "The id under which you were invited", &[("mandatory", "Y".to_owned())]);
    let scenarios = design.scenarios.len();
    let one = !design.all_scenarios && scenarios > 1;
    if one {
        let draw = format!("{{if(is_empty(scenario.NAOK),rand(1,{scenarios}),scenario.NAOK)}}");
        rows.question("*", "scenario", &draw, &[("hidden", "1".to_owned())]);
    }
    rows.add("G", "", "seen", "", &[("relevance", "1".to_owned())]);
    rows.question("X", SEEN, &paragraphs(&legend::paragraphs(design)), &[]);
    let mut films: Vec<&crate::rating::Film> = design.films.iter().collect();
    films.sort_by(|a, b| a.id.cmp(&b.id));
    for film in films {
        let place = design.scenarios.iter().position(|name| *name == film.scenario).unwrap_or(0) + 1;
        let relevance = if one { format!("scenario.NAOK=={place}") } else { "1".to_owned() };
        // Groups of one random group come in a random order.
        rows.add("G", "films", &film.id, "", &[("relevance", relevance)]);
        let source = design.sources.iter().find(|source| source.name == film.scenario);
        let context = escape(source.map_or("", |source| source.context.as_str()));
        let id = code(&film.id);
        let text = format!(
            "<p>{context}</p><p>Please watch the film to its end before you answer.</p>{}{}",
            video(&media.of(&film.id), &id),
            script(&id)
        );
        rows.question("X", &format!("{id}film"), &text, &[]);
        for hidden in ["position", "watched"] {
            rows.question("S", &format!("{id}{hidden}"), hidden, &[]);
        }
        for block in blocks(design) {
            items(&mut rows, &id, block);
        }
    }
    for check in checks(design, most)? {
        let of = blocks(design).into_iter().find(|block| block.of.id == check.instrument);
        rows.add("G", "films", &check.name, "", &[("relevance", "1".to_owned())]);
        rows.question("L", &code(&check.name), &escape(&check.text), &[]);
        answers(&mut rows, of);
    }
    let mut out = format!("\u{feff}{}\n", COLUMNS.join("\t"));
    for row in rows.0 {
        out.push_str(&row.join("\t"));
        out.push('\n');
    }
    Ok(out)
}

/// Writes place and seen seconds of a film into its two hidden questions, and lets nobody on before its end.
fn script(id: &str) -> String {
    // A cell of the table is one line.
    let gate = GATE.replace('\n', " ");
    format!(
        "<script>$(function(){{ {gate} var f=document.getElementById('film-{id}');\
         var field=function(end){{return $('.question-container').filter(function(){{return $(this).text().trim().indexOf(end)===0;}}).hide().find('input[type=text]');}};\
         var n=Number(sessionStorage.getItem('films')||0)+1;sessionStorage.setItem('films',n);field('position').val(n);var w=field('watched');\
         $('#ls-button-submit').prop('disabled',true);\
         gate(f,function(seconds){{w.val(seconds);$('#ls-button-submit').prop('disabled',false);}});}});</script>"
    )
}

fn items(rows: &mut Rows, film: &str, block: Block<'_>) {
    let name = format!("{film}{}", code(&block.of.id));
    let stem = escape(&block.of.stem);
    if block.is_slider() {
        let (low, high) = block.of.points;
        let more =
            [("slider_layout", "1".to_owned()), ("slider_min", low.to_string()), ("slider_max", high.to_string())];
        rows.question("K", &name, &stem, &more);
    } else {
        rows.question("F", &name, &stem, &[]);
    }
    for item in block.items() {
        rows.add("SQ", "0", &item.code, &escape(&item.text), &[("relevance", "1".to_owned())]);
    }
    answers(rows, Some(block).filter(|block| !block.is_slider()));
}

fn answers(rows: &mut Rows, block: Option<Block<'_>>) {
    let Some(block) = block else { return };
    for point in block.points() {
        rows.add("A", "0", &point.to_string(), &escape(&block.words(point)), &[]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kit::tests::design;

    #[test]
    fn every_row_has_all_columns_and_codes_are_letters_and_digits() {
        let text = limesurvey(&design(), &Media::parse("https://films.example.org").unwrap()).unwrap();
        assert!(text.starts_with("\u{feff}class\ttype/scale\t"));
        let rows: Vec<Vec<&str>> = text.lines().skip(1).map(|line| line.split('\t').collect()).collect();
        assert!(rows.iter().all(|row| row.len() == COLUMNS.len()));
        let codes: Vec<&str> = rows.iter().filter(|row| row[0] == "Q").map(|row| row[2]).collect();
        let mut sorted = codes.clone();
        sorted.sort_unstable();
        sorted.dedup();
        assert_eq!(sorted.len(), codes.len(), "no code twice");
        assert!(codes.iter().all(|code| code.chars().all(|c| c.is_ascii_alphanumeric())));
        assert!(codes.contains(&"k7fpsi") && codes.contains(&PERSON) && codes.contains(&"check1"));
        assert!(!text.contains("mppi") && !text.contains("nav2can"));
    }
}
