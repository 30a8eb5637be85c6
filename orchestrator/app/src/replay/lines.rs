//! What looks wrong about the lines of a table of tracks before they are brought to an even step: reading puts lines in
//! order, takes the first of two at one time and fills holes with straight lines, and would not tell.

use std::collections::BTreeMap;

use socrates_stream::csv::Table;

use crate::exit::Diagnostic;

/// A hole between two lines of one agent longer than this is told, s.
const HOLE_SECS: f64 = 1.0;
/// Lines farther apart than this in the middle of all are of another unit, s.
const SPARSE_SECS: f64 = 5.0;
/// Headings beyond this are of another unit, rad: twice round.
const ROUND_RAD: f64 = 4.0 * std::f64::consts::PI;
/// Nobody goes farther between two lines than this, m, at more than this, m/s: a jump.
const LEAP_M: f64 = 2.0;
const LEAP_MPS: f64 = 20.0;
/// Two places nearer to each other than this are one, m.
const SAME_M: f64 = 1e-6;

/// By what a line is found again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FoundBy {
    /// Its number in the file.
    Number,
    /// Its time: the table was made of messages.
    Time,
}

impl FoundBy {
    fn place(self, fix: &Fix) -> String {
        match self {
            Self::Number => format!("line {}", fix.line),
            Self::Time => format!("{:.2} s", fix.t),
        }
    }

    /// Where a line puts somebody.
    fn placed(self, fix: &Fix) -> String {
        match self {
            Self::Number => format!("({}, {}) in line {}", fix.x, fix.y, fix.line),
            Self::Time => format!("({}, {})", fix.x, fix.y),
        }
    }

    /// What somebody has at a time.
    const fn word(self) -> &'static str {
        match self {
            Self::Number => "line",
            Self::Time => "message",
        }
    }
}

/// One line: its number, time, place.
#[derive(Debug, Clone, Copy)]
struct Fix {
    line: usize,
    t: f64,
    x: f64,
    y: f64,
}

/// What to report about the lines; nothing for a table without the columns of tracks.
///
/// # Errors
/// Somebody who is at two places at one time: no reading of that is right.
pub(super) fn doubts(table: &Table, by: FoundBy) -> Result<Vec<String>, Diagnostic> {
    let Some((agents, widest)) = read(table) else { return Ok(Vec::new()) };
    let mut found = Vec::new();
    for (id, fixes) in &agents {
        if let Some((a, b)) = fixes.iter().zip(fixes.iter().skip(1)).find(|(a, b)| b.t < a.t) {
            found.push(format!(
                "{}: the times of `{id}` go back from {} s to {} s: its lines are put in order",
                by.place(b),
                a.t,
                b.t
            ));
        }
        let mut order = fixes.clone();
        order.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.line.cmp(&b.line)));
        let pairs = || order.iter().zip(order.iter().skip(1));
        let twice: Vec<(&Fix, &Fix)> = pairs().filter(|(a, b)| b.t <= a.t).collect();
        if let Some((a, b)) = twice.iter().find(|(a, b)| (a.x - b.x).hypot(a.y - b.y) > SAME_M) {
            return Err(Diagnostic::input(
                format!("`{id}` is at two places at {} s: {} and {}", a.t, by.placed(a), by.placed(b)),
                "each person needs an id of its own: `human_1`, `human_2`, …; the robot is `robot` or 0",
            ));
        }
        if let Some((_, b)) = twice.first() {
            let more = if twice.len() > 1 { format!(", and {} more are", twice.len() - 1) } else { String::new() };
            found.push(format!("{}: `{id}` at {} s is there twice{more}: the first one counts", by.place(b), b.t));
        }
        let far = |(a, b): &(&Fix, &Fix)| (b.x - a.x).hypot(b.y - a.y);
        let leaps = |pair: &(&Fix, &Fix)| far(pair) > LEAP_M && far(pair) > LEAP_MPS * (pair.1.t - pair.0.t);
        let mut leaping = pairs().filter(|(a, b)| b.t > a.t).filter(leaps);
        if let Some((a, b)) = leaping.next() {
            let more = leaping.count();
            let more = if more > 0 { format!(", and {more} times more") } else { String::new() };
            found.push(format!(
                "{}: `{id}` jumps {:.0} m within {:.2} s from {} on{more}: is it the same one?",
                by.place(b),
                far(&(a, b)),
                b.t - a.t,
                by.place(a)
            ));
        }
        let mut steps: Vec<f64> = pairs().map(|(a, b)| b.t - a.t).filter(|step| *step > 0.0).collect();
        steps.sort_by(f64::total_cmp);
        if let Some(step) = steps.get(steps.len() / 2).filter(|step| **step > SPARSE_SECS) {
            found.push(format!(
                "`{id}` has a {} every {step} s: are times in milliseconds or frames? Seconds are expected",
                by.word()
            ));
            continue;
        }
        let hole = pairs().map(|(a, b)| (b.t - a.t, a)).filter(|(length, _)| *length > HOLE_SECS);
        if let Some((length, from)) = hole.max_by(|a, b| a.0.total_cmp(&b.0)) {
            let line = match by {
                FoundBy::Number => format!(" (line {})", from.line),
                FoundBy::Time => String::new(),
            };
            found.push(format!(
                "`{id}` has no {} for {length:.1} s from {} s on{line}: taken as a straight line",
                by.word(),
                from.t
            ));
        }
    }
    if let Some((line, yaw)) = widest.filter(|(_, yaw)| yaw.abs() > ROUND_RAD) {
        found.push(format!("line {line}: the heading `{yaw}` is more than twice round: degrees? Radians are expected"));
    }
    Ok(found)
}

/// The lines by agent, and the line with the largest heading.
type Lines = (BTreeMap<String, Vec<Fix>>, Option<(usize, f64)>);

fn read(table: &Table) -> Option<Lines> {
    let column = |wanted: &str| table.column(wanted);
    let (t, id, x, y) = (column("t")?, column("id")?, column("x")?, column("y")?);
    let yaw = column("yaw");
    let mut agents: BTreeMap<String, Vec<Fix>> = BTreeMap::new();
    let mut widest: Option<(usize, f64)> = None;
    for row in &table.rows {
        let number = |at: usize| row.number(at);
        let (Some(t), Some(x), Some(y), Some(id)) = (number(t), number(x), number(y), row.cell(id)) else { continue };
        agents.entry(id.to_owned()).or_default().push(Fix { line: row.line, t, x, y });
        if let Some(yaw) = yaw.and_then(number)
            && widest.is_none_or(|(_, most)| yaw.abs() > most.abs())
        {
            widest = Some((row.line, yaw));
        }
    }
    Some((agents, widest))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The robot and a person ten times a second for six seconds; `change` may spoil a line.
    fn csv(change: impl Fn(usize, f64) -> Option<String>) -> String {
        let mut text = String::from("t,id,x,y,yaw\n");
        for k in 0..60 {
            let t = k as f64 * 0.1;
            let plain = format!("{t:.1},robot,{:.2},0,0", 0.5 * t);
            text.push_str(&change(k, t).unwrap_or(plain));
            text.push_str(&format!("\n{t:.1},human_1,5,1,3.1\n"));
        }
        text
    }

    fn told(text: &str) -> Vec<String> {
        doubts(&Table::read(text).unwrap(), FoundBy::Number).unwrap()
    }

    #[test]
    fn a_plain_table_is_not_doubted_and_neither_is_one_without_tracks() {
        assert_eq!(told(&csv(|_, _| None)), Vec::<String>::new());
        assert_eq!(told("a,b\n1,2\n"), Vec::<String>::new());
    }

    #[test]
    fn a_hole_is_told_with_its_line() {
        let holed = csv(|k, _| (20..45).contains(&k).then(String::new));
        assert_eq!(told(&holed), ["`robot` has no line for 2.6 s from 1.9 s on (line 40): taken as a straight line"]);
    }

    #[test]
    fn a_jump_is_told_once_with_its_lines() {
        let jump = csv(|k, t| (k == 30).then(|| format!("{t:.1},robot,500,0,0")));
        assert_eq!(
            told(&jump),
            ["line 62: `robot` jumps 499 m within 0.10 s from line 60 on, and 1 times more: is it the same one?"]
        );
    }

    #[test]
    fn times_that_go_back_are_told_and_put_in_order() {
        let back = csv(|k, _| (k == 30).then(|| "0.55,robot,0.27,0,0".to_owned()));
        assert_eq!(
            told(&back),
            ["line 62: the times of `robot` go back from 2.9 s to 0.55 s: its lines are put in order"]
        );
    }

    #[test]
    fn a_line_twice_is_told_and_two_places_at_one_time_are_refused() {
        let twice = csv(|k, _| (k == 10).then(|| "1.0,robot,0.50,0,0\n1.0,robot,0.50,0,0".to_owned()));
        assert_eq!(told(&twice), ["line 23: `robot` at 1 s is there twice: the first one counts"]);
        let two = csv(|k, _| (k == 10).then(|| "1.0,robot,0.50,0,0\n1.0,robot,9,9,0".to_owned()));
        let refused = doubts(&Table::read(&two).unwrap(), FoundBy::Number).unwrap_err().to_string();
        assert!(
            refused.contains("`robot` is at two places at 1 s: (0.5, 0) in line 22 and (9, 9) in line 23"),
            "{refused}"
        );
    }

    #[test]
    fn messages_are_found_by_their_time() {
        let jump = csv(|k, t| (k == 30).then(|| format!("{t:.1},robot,500,0,0")));
        let told = doubts(&Table::read(&jump).unwrap(), FoundBy::Time).unwrap();
        assert!(told[0].starts_with("3.00 s: `robot` jumps 499 m within 0.10 s from 2.90 s on"), "{told:?}");
        let holed = csv(|k, _| (20..45).contains(&k).then(String::new));
        let told = doubts(&Table::read(&holed).unwrap(), FoundBy::Time).unwrap();
        assert_eq!(told, ["`robot` has no message for 2.6 s from 1.9 s on: taken as a straight line"]);
    }

    #[test]
    fn other_units_of_time_and_heading_are_told() {
        let millis = "t,id,x,y\n0,robot,0,0\n100,robot,0.05,0\n200,robot,0.1,0\n";
        assert_eq!(
            told(millis),
            ["`robot` has a line every 100 s: are times in milliseconds or frames? Seconds are expected"]
        );
        let degrees = csv(|k, t| (k == 7).then(|| format!("{t:.1},robot,{:.2},0,178.5", 0.5 * t)));
        assert_eq!(
            told(&degrees),
            ["line 16: the heading `178.5` is more than twice round: degrees? Radians are expected"]
        );
    }
}
