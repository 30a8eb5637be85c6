//! Optimal one-to-one matching of points.

use socrates_model::Point;

/// The pairs of a matching of as many points as possible that lie at most so far apart, with the least sum of distances.
///
/// Hungarian method with potentials (Kuhn 1955, Munkres 1957), cubic in the number of points.
pub(super) fn matched(ones: &[Point], others: &[Point], within_m: f64) -> Vec<(usize, usize)> {
    // The method wants at most as many rows as columns.
    if ones.len() > others.len() {
        return matched(others, ones, within_m).into_iter().map(|(a, b)| (b, a)).collect();
    }
    // Any number of near pairs is better than a far one.
    let far = 1e6 * within_m.max(1.0);
    let cost = |row: usize, column: usize| match (ones.get(row), others.get(column)) {
        (Some(a), Some(b)) if (a - b).norm() <= within_m => (a - b).norm(),
        _ => far,
    };
    let columns = others.len();
    let mut row_of: Vec<Option<usize>> = vec![None; columns];
    let (mut rise_of_row, mut rise_of_column) = (vec![0.0; ones.len()], vec![0.0; columns]);
    for first in 0..ones.len() {
        let mut least = vec![f64::INFINITY; columns];
        let mut from: Vec<Option<usize>> = vec![None; columns];
        let mut used = vec![false; columns];
        let (mut row, mut last): (usize, Option<usize>) = (first, None);
        let end = loop {
            let mut next: Option<(f64, usize)> = None;
            for column in 0..columns {
                if used.get(column) != Some(&false) {
                    continue;
                }
                let rises =
                    rise_of_row.get(row).copied().unwrap_or(0.0) + rise_of_column.get(column).copied().unwrap_or(0.0);
                let reduced = cost(row, column) - rises;
                if let (Some(known), Some(back)) = (least.get_mut(column), from.get_mut(column)) {
                    if reduced < *known {
                        (*known, *back) = (reduced, last);
                    }
                    if next.is_none_or(|(best, _)| *known < best) {
                        next = Some((*known, column));
                    }
                }
            }
            let Some((step, column)) = next else { break None };
            // The rows that were looked at, and the first one, rise; their columns fall.
            let mut rises: Vec<usize> = vec![first];
            for place in 0..columns {
                if used.get(place) == Some(&true) {
                    rises.extend(row_of.get(place).copied().flatten());
                    if let Some(fall) = rise_of_column.get_mut(place) {
                        *fall -= step;
                    }
                } else if let Some(known) = least.get_mut(place) {
                    *known -= step;
                }
            }
            for place in rises {
                if let Some(rise) = rise_of_row.get_mut(place) {
                    *rise += step;
                }
            }
            if let Some(flag) = used.get_mut(column) {
                *flag = true;
            }
            last = Some(column);
            match row_of.get(column).copied().flatten() {
                Some(taken) => row = taken,
                None => break Some(column),
            }
        };
        // The pairs along the way are exchanged.
        let mut column = end;
        while let Some(place) = column {
            let back = from.get(place).copied().flatten();
            let row = back.map_or(Some(first), |back| row_of.get(back).copied().flatten());
            if let Some(slot) = row_of.get_mut(place) {
                *slot = row;
            }
            column = back;
        }
    }
    let pairs = row_of.iter().enumerate().filter_map(|(column, row)| row.map(|row| (row, column)));
    let mut pairs: Vec<(usize, usize)> = pairs.filter(|(row, column)| cost(*row, *column) < far).collect();
    pairs.sort_unstable();
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_pairs_as_possible_then_the_nearest() {
        let line = |xs: &[f64]| xs.iter().map(|x| Point::new(*x, 0.0)).collect::<Vec<_>>();
        // The nearest first would leave one alone.
        assert_eq!(matched(&line(&[0.0, 1.0]), &line(&[0.9, 1.9]), 1.0), [(0, 0), (1, 1)]);
        assert_eq!(matched(&line(&[0.0]), &line(&[0.6, 0.2, 5.0]), 1.0), [(0, 1)]);
        assert_eq!(matched(&line(&[0.6, 0.2, 5.0]), &line(&[0.0]), 1.0), [(1, 0)]);
        assert_eq!(matched(&line(&[3.0, 0.0]), &line(&[0.1, 7.0]), 1.0), [(1, 0)]);
        assert!(matched(&[], &line(&[1.0]), 1.0).is_empty());
    }

    #[test]
    fn it_is_as_good_as_every_other_matching_of_small_sets() {
        let mut seed = 7_u32;
        let mut next = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(seed >> 20) / 1000.0
        };
        for _ in 0..60 {
            let a: Vec<Point> = (0..4).map(|_| Point::new(next(), next())).collect();
            let b: Vec<Point> = (0..5).map(|_| Point::new(next(), next())).collect();
            let pairs = matched(&a, &b, 1.5);
            let value = |pairs: &[(usize, usize)]| {
                (pairs.len(), pairs.iter().map(|(one, other)| (a[*one] - b[*other]).norm()).sum::<f64>())
            };
            let mut best = (0, 0.0);
            // Every row takes a free column or none.
            let mut open: Vec<Vec<(usize, usize)>> = vec![vec![]];
            for (row, from) in a.iter().enumerate() {
                let mut more = open.clone();
                for taken in &open {
                    for column in (0..5).filter(|c| taken.iter().all(|(_, used)| used != c)) {
                        if (from - b[column]).norm() <= 1.5 {
                            more.push(taken.iter().copied().chain([(row, column)]).collect());
                        }
                    }
                }
                open = more;
            }
            for taken in &open {
                let (count, sum) = value(taken);
                if count > best.0 || count == best.0 && sum < best.1 {
                    best = (count, sum);
                }
            }
            let (count, sum) = value(&pairs);
            assert!(count == best.0 && (sum - best.1).abs() < 1e-9, "{pairs:?}: {count} {sum} but {best:?}");
        }
    }
}
