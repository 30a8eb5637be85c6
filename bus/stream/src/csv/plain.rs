//! Other people's spellings of a table of tracks made plain: what can be read without doubt is read, and told.
//!
//! | found | made of it |
//! |---|---|
//! | `;` or tabs between the cells, with them decimal commas | commas, decimal points |
//! | times since 1970, in s, ms, µs or ns | seconds from the first line on |
//! | a line with an empty or NaN number, or one that is cut | a gap: the line is left out |
//! | an empty `yaw` | the heading is not known: it is taken from the motion |
//! | columns `planner` and `seed` with several runs | the lines of one of them |

use super::{Row, Table, bad};
use crate::error::StreamError;

/// Times from here on are counted from 1970 and not from the beginning of a run: 1973 in s.
const EPOCH: f64 = 1e8;
/// Smallest times since 1970 in a unit, and how many of it are a second.
const UNITS: [(f64, f64, &str); 4] =
    [(1e17, 1e9, "nanoseconds"), (1e14, 1e6, "microseconds"), (1e11, 1e3, "milliseconds"), (EPOCH, 1.0, "seconds")];
/// Share of lines that may be gaps: with more of them the table is not what it is taken for.
const GAPS: f64 = 0.5;
/// So many gaps are told line by line.
const TOLD: usize = 3;

/// Which run of a table of several is meant; what is not said is as in the table's first line.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RunChoice {
    /// Its planner.
    pub planner: Option<String>,
    /// Its seed.
    pub seed: Option<u64>,
}

/// Makes a table plain; gives what was made of what, in sentences. What cannot be read at all is left as it is, for
/// [`super::read_table`] to name.
///
/// # Errors
/// [`StreamError::Csv`] where most lines have no numbers, or the run that is meant is not in the table.
pub fn plain(table: &mut Table, choice: &RunChoice) -> Result<Vec<String>, StreamError> {
    let mut notes = Vec::new();
    let numbers: Vec<usize> = ["t", "x", "y", "yaw"].into_iter().filter_map(|name| table.column(name)).collect();
    if table.separator != ',' {
        let name = if table.separator == ';' { "`;`" } else { "tabs" };
        notes.push(format!("the columns are separated by {name}: read so, with decimal commas where there are any"));
        for row in &mut table.rows {
            for at in &numbers {
                row.cells.get_mut(*at).into_iter().for_each(|cell| *cell = cell.replace(',', "."));
            }
        }
    }
    notes.extend(one_run(table, choice)?);
    notes.extend(gaps(table, &numbers)?);
    if let Some(time) = table.column("t") {
        notes.extend(since_begin(&mut table.rows, time));
    }
    Ok(notes)
}

/// Leaves out the lines in which a number is missing.
fn gaps(table: &mut Table, numbers: &[usize]) -> Result<Vec<String>, StreamError> {
    let (lines, last) = (table.rows.len(), table.last_line());
    let yaw = table.column("yaw");
    let mut found: Vec<(usize, String)> = Vec::new();
    table.rows.retain(|row| {
        let ends = row.line == last;
        let why = numbers.iter().find_map(|at| match row.cell(*at).map(|cell| (cell, cell.parse::<f64>())) {
            None if ends => Some("is cut off".to_owned()),
            None => Some("has too few cells".to_owned()),
            // A heading that is not known is taken from the motion.
            Some(("", _)) if Some(*at) == yaw => None,
            Some(("", _)) => Some("has an empty number".to_owned()),
            Some((cell, Ok(value))) if !value.is_finite() => Some(format!("has `{cell}` for a number")),
            Some((cell, Err(_))) if ends => Some(format!("is cut off at `{cell}`")),
            // Words where numbers are due are an error of another kind, which the reader names.
            Some((_, Ok(_) | Err(_))) => None,
        });
        found.extend(why.map(|why| (row.line, why)));
        found.last().is_none_or(|(line, _)| *line != row.line)
    });
    #[expect(clippy::cast_precision_loss, reason = "lines of a file")]
    if let Some((line, why)) = found.first()
        && found.len() as f64 > GAPS * lines as f64
    {
        return Err(bad(*line, &format!("the line {why}, and so do {} of {lines} lines in all", found.len())));
    }
    let mut notes: Vec<String> =
        found.iter().take(TOLD).map(|(line, why)| format!("line {line} {why}: taken as a gap")).collect();
    if found.len() > TOLD {
        notes.push(format!("{} more lines are taken as gaps", found.len() - TOLD));
    }
    Ok(notes)
}

/// Leaves out the lines of all runs but one, where columns tell several apart.
fn one_run(table: &mut Table, choice: &RunChoice) -> Result<Option<String>, StreamError> {
    let head = table.head.line;
    let asked = [("planner", choice.planner.clone()), ("seed", choice.seed.map(|seed| seed.to_string()))];
    let said = asked.iter().all(|(_, wanted)| wanted.is_some());
    let mut columns: Vec<(usize, &str, Option<String>)> = Vec::new();
    for (name, wanted) in asked {
        match (table.column(name), wanted) {
            (Some(at), wanted) => columns.push((at, name, wanted)),
            (None, Some(wanted)) => {
                let why = format!("the {name} `{wanted}` is meant, and the head has no column `{name}`");
                return Err(bad(head, &why));
            }
            (None, None) => {}
        }
    }
    // A line that is cut belongs to no run; it is told as a gap.
    let run = |row: &Row| -> Option<Vec<String>> {
        columns.iter().map(|(at, ..)| row.cells.get(*at).filter(|cell| !cell.is_empty()).cloned()).collect()
    };
    let named = |run: &[String]| -> String {
        let cells = run.iter().zip(&columns).map(|(cell, (_, name, _))| match *name {
            "seed" => format!("seed {cell}"),
            _ => cell.clone(),
        });
        cells.collect::<Vec<_>>().join(" ")
    };
    // In order of appearance.
    let mut runs: Vec<Vec<String>> = Vec::new();
    for row in &table.rows {
        if let Some(found) = run(row)
            && !runs.contains(&found)
        {
            runs.push(found);
        }
    }
    let fits = |found: &&Vec<String>| {
        found.iter().zip(&columns).all(|(cell, (_, _, wanted))| wanted.as_ref().is_none_or(|wanted| wanted == cell))
    };
    if columns.is_empty() || runs.is_empty() {
        return Ok(None);
    }
    let Some(chosen) = runs.iter().find(fits) else {
        let have: Vec<String> = runs.iter().take(TOLD).map(|run| named(run)).collect();
        let more = if runs.len() > TOLD { format!(" and {} more", runs.len() - TOLD) } else { String::new() };
        let wanted = columns.iter().filter_map(|(_, name, wanted)| Some(format!("{name} {}", wanted.as_ref()?)));
        let wanted = wanted.collect::<Vec<_>>().join(" and ");
        return Err(bad(head, &format!("there is no run of {wanted}; the table has {}{more}", have.join(", "))));
    };
    if runs.len() < 2 {
        return Ok(None);
    }
    table.rows.retain(|row| run(row).is_none_or(|found| found == *chosen));
    let others = if said { "" } else { "; --planner and --seed choose another" };
    Ok(Some(format!("the table holds {} runs: that of {} is read{others}", runs.len(), named(chosen))))
}

/// Times since 1970 become seconds from the first on.
fn since_begin(rows: &mut [Row], time: usize) -> Option<String> {
    let value = |row: &Row| row.cell(time)?.parse::<f64>().ok();
    let first = rows.iter().filter_map(value).reduce(f64::min)?;
    let (_, per_second, name) = UNITS.into_iter().find(|(from, ..)| first >= *from)?;
    for row in rows {
        if let Some(t) = value(row)
            && let Some(cell) = row.cells.get_mut(time)
        {
            *cell = format!("{:.6}", (t - first) / per_second);
        }
    }
    Some(format!("times are {name} since 1970: taken as seconds from the first line on"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::csv::{read_table, read_tracks};

    const TABLE: &str = "t,id,x,y\n0.0,robot,0.0,0.5\n0.1,robot,0.1,0.5\n0.2,robot,0.2,0.5\n0.3,robot,0.3,0.5\n";

    fn made(text: &str, choice: &RunChoice) -> Result<(Table, Vec<String>), StreamError> {
        let mut table = Table::read(text)?;
        let notes = plain(&mut table, choice)?;
        Ok((table, notes))
    }

    fn same_as_the_table(text: &str, note: &str) {
        let (table, notes) = made(text, &RunChoice::default()).unwrap();
        assert!(notes.iter().any(|found| found.contains(note)), "{notes:?}");
        let (found, wanted) = (read_table(&table).unwrap(), read_tracks(TABLE).unwrap());
        assert_eq!(found.ticks(), wanted.ticks());
        for (a, b) in found.frames.iter().zip(&wanted.frames) {
            assert!((a.x - b.x).abs() < 1e-5 && (a.y - b.y).abs() < 1e-9, "{text}");
        }
    }

    #[test]
    fn a_plain_table_stays_as_it_is() {
        assert_eq!(made(TABLE, &RunChoice::default()).unwrap(), (Table::read(TABLE).unwrap(), vec![]));
    }

    #[test]
    fn semicolons_tabs_and_decimal_commas_are_read() {
        same_as_the_table(&TABLE.replace(',', ";"), "separated by `;`");
        same_as_the_table(&TABLE.replace(',', "\t"), "separated by tabs");
        same_as_the_table(&TABLE.replace(',', ";").replace('.', ","), "separated by `;`");
    }

    #[test]
    fn times_since_1970_begin_at_zero_whatever_their_unit() {
        for (unit, name) in [(1.0, "are seconds"), (1e3, "milliseconds"), (1e6, "microseconds"), (1e9, "nanoseconds")] {
            let mut text = String::from("t,id,x,y\n");
            for k in 0..4 {
                text.push_str(&format!("{},robot,0.{k},0.5\n", (1_700_000_000.0 + 0.1 * f64::from(k)) * unit));
            }
            same_as_the_table(&text, name);
        }
    }

    #[test]
    fn a_missing_number_and_a_cut_line_are_gaps_with_their_line() {
        same_as_the_table(&TABLE.replace("0.1,robot,0.1,0.5", "0.1,robot,nan,0.5"), "line 3 has `nan` for a number");
        same_as_the_table(&TABLE.replace("0.1,robot,0.1,0.5", "0.1,robot,,0.5"), "line 3 has an empty number");
        same_as_the_table(&format!("{TABLE}0.4,rob"), "line 6 is cut off: taken as a gap");
        let most = made("t,id,x,y\n0,1,nan,0\n1,1,nan,0\n2,1,0,0\n", &RunChoice::default()).unwrap_err().to_string();
        assert!(most.contains("line 2") && most.contains("2 of 3 lines"), "{most}");
        let blind = TABLE.replace("\n", ",\n").replacen("y,\n", "y,yaw\n", 1);
        let (table, notes) = made(&blind, &RunChoice::default()).unwrap();
        assert_eq!((notes.len(), read_table(&table).unwrap()), (0, read_tracks(TABLE).unwrap()));
        // A word is not a gap.
        let (table, _) = made("t,id,x,y\n0,1,one,2\n1,1,1,2\n", &RunChoice::default()).unwrap();
        assert!(read_table(&table).is_err());
    }

    #[test]
    fn one_run_of_a_table_of_several_is_read_and_it_is_said_which() {
        let text = "planner,seed,t,id,x,y\nreference,1,0,robot,0,0\nreference,1,1,robot,1,0\nreference,2,0,robot,5,0\n\
                    reference,2,1,robot,6,0\nmine,1,0,robot,8,0\nmine,1,1,robot,9,0\n";
        let first_x = |choice: &RunChoice| {
            let (table, notes) = made(text, choice).unwrap();
            (read_table(&table).unwrap().tick(0)[0].x, notes.join(" "))
        };
        let (x, note) = first_x(&RunChoice::default());
        assert!(
            x.abs() < 1e-9 && note.contains("3 runs: that of reference seed 1") && note.contains("--seed"),
            "{note}"
        );
        let of = |planner: Option<&str>, seed: Option<u64>| RunChoice { planner: planner.map(str::to_owned), seed };
        assert!((first_x(&of(None, Some(2))).0 - 5.0).abs() < 1e-9);
        let (x, note) = first_x(&of(Some("mine"), Some(1)));
        assert!((x - 8.0).abs() < 1e-9 && !note.contains("--seed"), "{note}");
        let why = made(text, &of(Some("mine"), Some(7))).unwrap_err().to_string();
        assert!(
            why.contains(
                "no run of planner mine and seed 7; the table has reference seed 1, reference seed 2, mine seed 1"
            ),
            "{why}"
        );
        let why = made(TABLE, &of(None, Some(1))).unwrap_err().to_string();
        assert!(why.contains("no column `seed`"), "{why}");
    }
}
