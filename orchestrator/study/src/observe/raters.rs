//! How far each rater agrees with themself and with the others, and all of them together.

use std::collections::{BTreeMap, BTreeSet};

use crate::stats::{Clustered, Level, clustered_bca, krippendorff, weighted_kappa};

/// A rater is kept whose agreement with themself and with the mean of the reference is above these (`SocNav3`, `select_valid_raters`).
const OWN: f64 = 0.1;
const OTHERS: f64 = 0.2;
/// A rater who agrees with themself by more than this is of the reference.
const REFERENCE: f64 = 0.4;
/// Steps of the slider for agreement: 11 levels, 0 to 10.
const STEPS: f64 = 10.0;
/// How intervals are drawn: films are the clusters.
const HOW: Clustered = Clustered { resamples: 2000, confidence: 0.95, seed: 1 };

/// A film rated with a slider.
#[derive(Debug, Clone, PartialEq)]
pub struct Slide {
    /// By whom.
    pub rater: String,
    /// Which film.
    pub film: String,
    /// 1 for the first time, 2 for the repeat.
    pub occasion: u32,
    /// From 0, the worst, to 1.
    pub value: f64,
}

/// Whether a rater's answers are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kept {
    /// Both agreements are above their limits.
    Yes,
    /// One is not.
    No,
    /// One cannot be told, for want of repeats or of a reference: the answers are used, and the report says so.
    Untold,
}

/// What is known of a rater.
#[derive(Debug, Clone, PartialEq)]
pub struct Rater {
    /// Their name.
    pub name: String,
    /// Films rated.
    pub films: usize,
    /// Films rated twice.
    pub repeats: usize,
    /// Quadratic-weighted kappa of first and second answers, over 11 levels.
    pub own: Option<f64>,
    /// The same of the first answers and the means of the reference without this rater.
    pub others: Option<f64>,
    /// Whether the answers are used.
    pub kept: Kept,
}

/// The level of the slider, 0 to 10.
fn level(value: f64) -> f64 {
    libm::round(value.clamp(0.0, 1.0) * STEPS)
}

/// First answers by rater, by film.
fn firsts(slides: &[Slide]) -> BTreeMap<&str, BTreeMap<&str, f64>> {
    let mut found: BTreeMap<&str, BTreeMap<&str, f64>> = BTreeMap::new();
    for slide in slides.iter().filter(|slide| slide.occasion == 1) {
        found.entry(&slide.rater).or_default().insert(&slide.film, slide.value);
    }
    found
}

/// First answers by film.
fn by_film(slides: &[Slide]) -> BTreeMap<&str, Vec<f64>> {
    let mut films: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for slide in slides.iter().filter(|slide| slide.occasion == 1) {
        films.entry(&slide.film).or_default().push(slide.value);
    }
    films
}

/// Kappa of pairs, where all answers of both being one and the same is full agreement.
fn kappa(pairs: &[(f64, f64)]) -> Option<f64> {
    let levels: Vec<(f64, f64)> = pairs.iter().map(|(a, b)| (level(*a), level(*b))).collect();
    weighted_kappa(&levels).ok()
}

/// Every rater, with the rule of `SocNav3`: kept is whose quadratic-weighted kappa with themself is above 0.1 and above 0.2 with the
/// mean of those whose own is above 0.4. A rater who gives the same answer to everything has no kappa; with repeats that is no
/// agreement that could be told from chance, and they are dropped.
#[must_use]
pub fn raters(slides: &[Slide]) -> Vec<Rater> {
    let firsts = firsts(slides);
    let mut seconds: BTreeMap<&str, Vec<(f64, f64)>> = BTreeMap::new();
    for slide in slides.iter().filter(|slide| slide.occasion > 1) {
        if let Some(first) = firsts.get(slide.rater.as_str()).and_then(|films| films.get(slide.film.as_str())) {
            seconds.entry(&slide.rater).or_default().push((*first, slide.value));
        }
    }
    let none = Vec::new();
    let twice = |name: &str| seconds.get(name).unwrap_or(&none);
    let own: BTreeMap<&str, Option<f64>> = firsts.keys().map(|name| (*name, kappa(twice(name)))).collect();
    let reference: BTreeSet<&str> =
        own.iter().filter(|(_, own)| own.is_some_and(|own| own > REFERENCE)).map(|(name, _)| *name).collect();
    let one = |(name, films): (&&str, &BTreeMap<&str, f64>)| {
        let pairs: Vec<(f64, f64)> = films
            .iter()
            .filter_map(|(film, value)| {
                let others: Vec<f64> = reference
                    .iter()
                    .filter(|other| *other != name)
                    .filter_map(|other| firsts.get(other)?.get(film).copied())
                    .collect();
                Some((*value, socrates_stats::mean(&others).ok()?))
            })
            .collect();
        let (own, others) = (own.get(name).copied().flatten(), kappa(&pairs));
        let levels: BTreeSet<u64> = films.values().map(|value| level(*value).to_bits()).collect();
        let says_one_thing = films.len() > 1 && levels.len() == 1;
        let kept = match (own, others) {
            (Some(own), _) if own <= OWN => Kept::No,
            (_, Some(others)) if others <= OTHERS => Kept::No,
            (Some(_), Some(_)) => Kept::Yes,
            (None, _) if says_one_thing && twice(name).len() > 1 => Kept::No,
            (None, _) | (_, None) => Kept::Untold,
        };
        Rater { name: (*name).to_owned(), films: films.len(), repeats: twice(name).len(), own, others, kept }
    };
    firsts.iter().map(one).collect()
}

/// How far raters agree, with 95 % intervals over films.
#[derive(Debug, Clone, PartialEq)]
pub struct Agreement {
    /// Films that two raters or more have rated.
    pub films: usize,
    /// Krippendorff's alpha: nominal and ordinal over 11 levels, interval over the slider itself.
    pub alpha: [Coefficient; 3],
}

/// A coefficient of agreement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficient {
    /// What distances between answers mean.
    pub level: Level,
    /// The value; none of fewer than two films or of answers that are all alike.
    pub value: Option<f64>,
    /// Its interval; none below five films.
    pub interval: Option<(f64, f64)>,
}

/// Agreement of the first answers of these raters.
#[must_use]
pub fn agreement(slides: &[Slide]) -> Agreement {
    let units: Vec<Vec<f64>> = by_film(slides).into_values().filter(|values| values.len() > 1).collect();
    let alpha = [Level::Nominal, Level::Ordinal, Level::Interval].map(|by| {
        let units: Vec<Vec<f64>> = match by {
            Level::Interval => units.clone(),
            Level::Nominal | Level::Ordinal => {
                units.iter().map(|unit| unit.iter().map(|value| level(*value)).collect()).collect()
            }
        };
        let of = |drawn: &[usize]| {
            let drawn: Vec<Vec<f64>> = drawn.iter().filter_map(|unit| units.get(*unit).cloned()).collect();
            krippendorff(&drawn, by).ok()
        };
        let interval = clustered_bca(units.len(), HOW, of);
        Coefficient { level: by, value: krippendorff(&units, by).ok(), interval }
    });
    Agreement { films: units.len(), alpha }
}

/// What a film was rated.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmMean {
    /// Which.
    pub film: String,
    /// Raters.
    pub raters: usize,
    /// Mean of their first answers, 0 to 1.
    pub mean: f64,
    /// Standard deviation; none of one rater.
    pub sd: Option<f64>,
}

/// The mean of each film over first answers, in the order of their names.
#[must_use]
pub fn means(slides: &[Slide]) -> Vec<FilmMean> {
    let mean = |(film, values): (&str, Vec<f64>)| {
        let mean = socrates_stats::mean(&values).ok()?;
        let sd = socrates_stats::sample_sd(&values).ok();
        Some(FilmMean { film: film.to_owned(), raters: values.len(), mean, sd })
    };
    by_film(slides).into_iter().filter_map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slide(rater: &str, film: usize, occasion: u32, value: f64) -> Slide {
        Slide { rater: rater.into(), film: format!("r{film:02}"), occasion, value }
    }

    /// Ten films of which the quality rises; four of them twice. Three careful raters, one who answers at random, one who moves
    /// nothing, one who turns the slider round, and one without repeats.
    fn panel() -> Vec<Slide> {
        let random = [0.7, 0.1, 0.9, 0.2, 0.8, 0.3, 0.0, 0.6, 0.5, 0.4];
        let again = [0.1, 0.8, 0.2, 0.9];
        let mut all = Vec::new();
        for (film, other) in random.into_iter().enumerate() {
            let quality = film as f64 / 9.0;
            all.push(slide("careful", film, 1, quality));
            all.push(slide("close", film, 1, (quality + 0.1).min(1.0)));
            all.push(slide("near", film, 1, (quality * 0.9).min(1.0)));
            all.push(slide("random", film, 1, other));
            all.push(slide("still", film, 1, 0.5));
            all.push(slide("turned", film, 1, 1.0 - quality));
            all.push(slide("once", film, 1, quality));
        }
        for (film, other) in again.into_iter().enumerate() {
            let film = film * 2;
            let quality = film as f64 / 9.0;
            all.push(slide("careful", film, 2, quality));
            all.push(slide("close", film, 2, quality + 0.05));
            all.push(slide("near", film, 2, quality));
            all.push(slide("random", film, 2, other));
            all.push(slide("still", film, 2, 0.5));
            all.push(slide("turned", film, 2, 1.0 - quality));
        }
        all
    }

    #[test]
    fn who_contradicts_themself_or_the_others_is_dropped_and_who_cannot_be_told_is_said() {
        let found = raters(&panel());
        let of = |name: &str| found.iter().find(|rater| rater.name == name).unwrap();
        assert_eq!((of("careful").kept, of("careful").repeats, of("careful").films), (Kept::Yes, 4, 10));
        assert_eq!(of("close").kept, Kept::Yes);
        assert_eq!(of("random").kept, Kept::No, "{:?}", of("random"));
        assert_eq!((of("still").kept, of("still").own), (Kept::No, None));
        // Agrees with themself and with nobody else.
        let turned = of("turned");
        assert!(turned.own.unwrap() > 0.99 && turned.others.unwrap() < 0.0 && turned.kept == Kept::No, "{turned:?}");
        assert_eq!((of("once").kept, of("once").own), (Kept::Untold, None));
    }

    #[test]
    fn agreement_of_the_kept_is_that_of_krippendorff_with_an_interval_about_it() {
        let kept: Vec<Slide> =
            panel().into_iter().filter(|one| ["careful", "close"].contains(&one.rater.as_str())).collect();
        let found = agreement(&kept);
        assert_eq!(found.films, 10);
        let Coefficient { level: by, value: alpha, interval } = found.alpha[2];
        let (low, high) = interval.unwrap();
        assert!(by == Level::Interval && low <= alpha.unwrap() && alpha.unwrap() <= high && low > 0.8, "{found:?}");
        // Two raters who are a level apart, always: equal answers are fewer than by chance, the order is nearly one.
        assert!(found.alpha[0].value.unwrap() < 0.2 && found.alpha[1].value.unwrap() > 0.9, "{found:?}");
        assert_eq!(agreement(&[]).alpha[0].value, None);
        let first = &means(&kept)[0];
        assert!((first.mean - 0.05).abs() < 1e-12 && first.raters == 2 && first.film == "r00");
    }
}
