//! The survey in Qualtrics' Advanced Format: for where a QSF is refused. It knows neither orders nor gates; a block says what to set by hand.

use super::asks::{Block, blocks, checks};
use super::legend;
use super::media::{Media, video};
use super::orders::orders;
use super::page::escape;
use super::setup::agreed;
use crate::design::Design;
use crate::problem::Problem;

/// The survey as text.
///
/// # Errors
/// An attention check that cannot be answered, a text of consent that does not say how long it takes.
pub fn advanced(design: &Design, media: &Media) -> Result<String, Problem> {
    let all = orders(design);
    let most = all.iter().map(|order| order.films.len()).max().unwrap_or(0);
    let mut out = String::from(
        "[[AdvancedFormat]]\n\n[[Block:Setup notes, DELETE BEFORE DEPLOYING]]\n[[Question:DB]]\n[[ID:setup]]\n",
    );
    let checks = checks(design, most)?;
    let orders: Vec<String> = all
        .iter()
        .map(|order| {
            let mut parts = Vec::new();
            for (place, film) in order.films.iter().enumerate() {
                parts.push(film.clone());
                parts.extend(checks.iter().filter(|check| check.position == place + 1).map(|check| check.name.clone()));
            }
            format!("order {}: {}", order.name, parts.join(", "))
        })
        .collect();
    out.push_str(&format!(
        "In the survey flow: 1. Embedded data PROLIFIC_PID from the address. 2. Block consent. 3. A randomizer that presents 1 element evenly, \
         with a group for each order; in each group embedded data order = its number, FILM_position = 1, 2, … for its films, then the blocks in this order:<br>{}<br>\
         4. An end of survey that leads back. In each film block hide the next button until the film has ended.\n\n",
        orders.join("<br>")
    ));
    let consent = escape(&agreed(design)?.text()).replace("\n\n", "<br><br>").replace('\n', " ");
    out.push_str(&format!(
        "[[Block:consent]]\n[[Question:MC:SingleAnswer:Vertical]]\n[[ID:consent]]\n{consent}\n[[Choices]]\nI agree and take part\n[[PageBreak]]\n\
         [[Question:DB]]\n[[ID:seen]]\n{}\n\n",
        legend::paragraphs(design).iter().map(|part| escape(part)).collect::<Vec<_>>().join("<br><br>")
    ));
    let mut films: Vec<&str> = design.films.iter().map(|film| film.id.as_str()).collect();
    films.sort_unstable();
    for film in films {
        let scenario = design.film(film).map_or("", |film| film.scenario.as_str());
        let source = design.sources.iter().find(|source| source.name == scenario);
        let context = escape(source.map_or("", |source| source.context.as_str())).replace('\n', " ");
        out.push_str(&format!(
            "[[Block:{film}]]\n[[Question:DB]]\n[[ID:{film}_film]]\n<p>{context}</p>{}\n[[PageBreak]]\n",
            video(&media.of(film), film)
        ));
        for block in blocks(design) {
            questions(&mut out, film, block);
        }
        out.push('\n');
    }
    for check in checks {
        let of = blocks(design).into_iter().find(|block| block.of.id == check.instrument);
        out.push_str(&format!(
            "[[Block:{0}]]\n[[Question:MC:SingleAnswer:Horizontal]]\n[[ID:{0}]]\n{1}\n[[AdvancedChoices]]\n",
            check.name,
            escape(&check.text)
        ));
        for point in of.map(Block::points).unwrap_or_default() {
            let words = of.map(|block| block.words(point)).unwrap_or_default();
            out.push_str(&format!("[[Choice:{point}]]\n{}\n", escape(&words)));
        }
        out.push('\n');
    }
    Ok(out)
}

/// One question for each item, so that columns are called `FILM_ITEM`.
fn questions(out: &mut String, film: &str, block: Block<'_>) {
    for item in block.items() {
        let text = format!("{} {}", escape(&block.of.stem), escape(&item.text));
        if block.is_slider() {
            let (low, high) = block.of.points;
            out.push_str(&format!(
                "[[Question:TE:SingleLine]]\n[[ID:{film}_{}]]\n{text} (a number from {low} to {high})\n",
                item.code
            ));
            continue;
        }
        out.push_str(&format!(
            "[[Question:MC:SingleAnswer:Horizontal]]\n[[ID:{film}_{}]]\n{text}\n[[AdvancedChoices]]\n",
            item.code
        ));
        for point in block.points() {
            out.push_str(&format!("[[Choice:{point}]]\n{}\n", escape(&block.words(point))));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kit::tests::design;

    #[test]
    fn columns_are_called_after_film_and_item_and_nothing_names_a_planner() {
        let text = advanced(&design(), &Media::parse("https://films.example.org").unwrap()).unwrap();
        assert!(text.starts_with("[[AdvancedFormat]]\n"));
        let ids: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("[[ID:")).collect();
        let mut sorted = ids.clone();
        sorted.sort_unstable();
        sorted.dedup();
        assert_eq!(sorted.len(), ids.len());
        assert!(ids.contains(&"k7f_RB1]]") && ids.contains(&"check1]]"));
        assert!(!text.contains("mppi") && !text.contains("nav2can"));
        assert!(text.contains("[[Choice:4]]\nsomewhat agree"));
    }
}
