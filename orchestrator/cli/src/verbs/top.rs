//! `top`: stages, workers and failures of an orchestrator on the terminal, drawn anew every second.

mod keys;

use std::io::IsTerminal as _;
use std::time::Duration;

use clap::Args;
use ratatui::buffer::Buffer;
use ratatui::crossterm::event::{self, Event, KeyEvent};
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Modifier, Style};
use ratatui::text::Line;
use ratatui::widgets::{Block, Borders, Paragraph, Row, Table, Widget as _, Wrap};
use socrates_app::config::Config;
use socrates_app::exit::{Code, Diagnostic};
use socrates_app::output::{Format, Printer};
use socrates_app::top::{BATCH_HEADS, BatchRow, FailureRow, STAGE_HEADS, Sight, Viewer, WORKER_HEADS};

use self::keys::{Hand, Mode, On, Wish};
use super::keys::Keys;
use super::{Outcome, done};

/// Pause between two looks.
const PAUSE: Duration = Duration::from_secs(1);
/// Letters of a line where the terminal does not say how many it has.
const COLUMNS: u16 = 120;
/// Batches that are seen at one time, at most; the cursor brings others.
const BATCHES: usize = 6;
/// What is said where nothing failed.
const NO_FAILURES: &str = "none since this start of the orchestrator";

/// Arguments of `top`.
#[derive(Debug, Args)]
pub(crate) struct Top {
    /// Folder of a run that goes on, or a zenoh endpoint such as `tcp/127.0.0.1:7447` or `quic/lab-3:7447@main`.
    what: String,
    /// Print one frame and end; with `--format json`, the data.
    #[arg(long)]
    once: bool,
    #[command(flatten)]
    keys: Keys,
}

impl Top {
    pub(super) async fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        let once = self.once || talk.format == Format::Json;
        let drawn_on = std::io::stdout().is_terminal() && std::io::stdin().is_terminal();
        if !once && !drawn_on {
            return Err(Diagnostic::input(
                "`socrates top` draws on a terminal, and this is none",
                "--once prints one frame",
            ));
        }
        let config = &self.keys.over(config)?;
        let viewer = Viewer::open(config, &self.what).await?;
        let shown = if once { print(talk, &viewer).await } else { follow(&viewer).await };
        viewer.close().await;
        done(shown)
    }
}

/// One frame as text, as tall as it needs to be.
async fn print(talk: &Printer, viewer: &Viewer) -> Result<(), Diagnostic> {
    let sight = viewer.look().await?;
    let columns =
        ratatui::crossterm::terminal::size().ok().filter(|_| talk.live).map_or(COLUMNS, |(columns, _)| columns);
    for line in text(&sight, columns) {
        talk.line(&line);
    }
    talk.result(&sight.object);
    Ok(())
}

/// The lines of a frame of this width. What is a sentence is not cut.
fn text(sight: &Sight, columns: u16) -> Vec<String> {
    let mut lines = sight.head.clone();
    let rows = sight.stages.len() + sight.workers.len() + 4;
    let area = Rect::new(0, 0, columns, u16::try_from(rows).unwrap_or(u16::MAX));
    lines.extend(drawn(area, |buffer| {
        let [stages, workers] = Layout::vertical([
            Constraint::Length(tall(sight.stages.len())),
            Constraint::Length(tall(sight.workers.len())),
        ])
        .areas(area);
        draw_stages(stages, buffer, sight);
        draw_workers(workers, buffer, sight);
    }));
    let area = Rect::new(0, 0, columns, tall(sight.batches.len()));
    lines.extend(drawn(area, |buffer| draw_batches(area, buffer, sight, None)));
    lines.extend(drawn(Rect::new(0, 0, columns, 1), |buffer| titled("failures").render(buffer.area, buffer)));
    lines.extend(sight.failures.iter().map(|failure| failure.line.clone()));
    lines.extend(sight.failures.is_empty().then(|| NO_FAILURES.to_owned()));
    lines
}

/// What is drawn on an area, as text.
fn drawn(area: Rect, draw: impl FnOnce(&mut Buffer)) -> Vec<String> {
    let mut buffer = Buffer::empty(area);
    draw(&mut buffer);
    let line = |y: u16| -> String {
        let cells = (0..area.width).filter_map(|x| buffer.cell((x, y)));
        cells.map(|cell| cell.symbol()).collect::<String>().trim_end().to_owned()
    };
    (0..area.height).map(line).collect()
}

/// Draws until a person has seen enough. One that does not answer is asked again; what was seen last stays.
async fn follow(viewer: &Viewer) -> Result<(), Diagnostic> {
    let mut sight = viewer.look().await?;
    let mut terminal = ratatui::try_init().map_err(broken)?;
    let followed = async {
        let mut hand = Hand::default();
        loop {
            let drawn = terminal.draw(|frame| draw(frame.area(), frame.buffer_mut(), &sight, &hand));
            drawn.map(drop).map_err(broken)?;
            let key = tokio::task::spawn_blocking(|| pressed(PAUSE)).await;
            let key = key.map_err(broken)?.map_err(broken)?;
            let told = match key.map_or(Wish::Nothing, |key| hand.press(key, &sight)) {
                Wish::Leave => return Ok(()),
                // A key is shown at once; how things stand is asked for when none was pressed.
                Wish::Nothing if key.is_some() => continue,
                Wish::Nothing => Ok(String::new()),
                Wish::Act(deed) => viewer.act(&deed).await,
                Wish::Explain(job) => viewer.explain(&job).await.map(|lines| {
                    hand.mode = Mode::Reading(lines, 0);
                    String::new()
                }),
            };
            match told {
                Ok(words) if words.is_empty() => {}
                Ok(words) => hand.note = words,
                Err(why) => hand.note = why.short(),
            }
            match viewer.look().await {
                Ok(newer) => sight = newer,
                Err(why) => hand.note = why.short(),
            }
        }
    };
    let followed = followed.await;
    ratatui::restore();
    followed
}

fn broken(why: impl std::fmt::Display) -> Diagnostic {
    Diagnostic::input(format!("the terminal cannot be drawn on: {why}"), "--once prints one frame")
        .with_code(Code::Ours)
}

/// The key that was pressed within a pause; a window of another size is drawn at once.
fn pressed(pause: Duration) -> std::io::Result<Option<KeyEvent>> {
    if !event::poll(pause)? {
        return Ok(None);
    }
    let Event::Key(key) = event::read()? else { return Ok(None) };
    Ok(Some(key))
}

/// Rows that a part takes with its head and its line above.
fn tall(rows: usize) -> u16 {
    u16::try_from(rows + 2).unwrap_or(u16::MAX)
}

/// One frame: head, stages, workers, batches, failures and the keys, one below the other; or the page that is read.
fn draw(area: Rect, buffer: &mut Buffer, sight: &Sight, hand: &Hand) {
    let [above, bottom] = Layout::vertical([Constraint::Min(0), Constraint::Length(1)]).areas(area);
    Paragraph::new(Line::styled(hand.bottom(), Style::new().add_modifier(Modifier::DIM))).render(bottom, buffer);
    if let Mode::Reading(lines, from) = &hand.mode {
        let told: Vec<Line<'_>> = lines.iter().skip(*from).map(|line| Line::from(line.as_str())).collect();
        return Paragraph::new(told).wrap(Wrap { trim: false }).render(above, buffer);
    }
    let on = hand.on(sight);
    let [head, stages, workers, batches, failures] = Layout::vertical([
        Constraint::Length(u16::try_from(sight.head.len() + 1).unwrap_or(u16::MAX)),
        Constraint::Length(tall(sight.stages.len())),
        Constraint::Max(tall(sight.workers.len())),
        Constraint::Max(tall(sight.batches.len().min(BATCHES))),
        Constraint::Min(2),
    ])
    .areas(above);
    let mut lines: Vec<Line<'_>> = sight.head.iter().map(|line| Line::from(line.as_str())).collect();
    if !hand.note.is_empty() {
        lines.push(Line::styled(hand.note.as_str(), chosen()));
    }
    Paragraph::new(lines).render(head, buffer);
    draw_stages(stages, buffer, sight);
    draw_workers(workers, buffer, sight);
    draw_batches(batches, buffer, sight, if let Some(On::Batch(at)) = on { Some(at) } else { None });
    let cursor = if let Some(On::Failure(at)) = on { Some(at) } else { None };
    let line = |(at, failure): (usize, &'_ FailureRow)| {
        let style = if cursor == Some(at) { chosen() } else { Style::new() };
        Line::styled(failure.line.clone(), style)
    };
    let seen = usize::from(failures.height.saturating_sub(1));
    let mut told: Vec<Line<'_>> = sight.failures.iter().enumerate().skip(first_seen(cursor, seen)).map(line).collect();
    told.extend(sight.failures.is_empty().then(|| Line::from(NO_FAILURES)));
    Paragraph::new(told).block(titled("failures")).render(failures, buffer);
}

/// How the row under the cursor is shown.
fn chosen() -> Style {
    Style::new().add_modifier(Modifier::REVERSED)
}

/// The first row that is shown where so many have room, so that the one of the cursor is among them.
fn first_seen(cursor: Option<usize>, room: usize) -> usize {
    cursor.map_or(0, |at| (at + 1).saturating_sub(room.max(1)))
}

fn draw_stages(area: Rect, buffer: &mut Buffer, sight: &Sight) {
    let widths = [Constraint::Min(18)].into_iter().chain((0..9).map(|_column| Constraint::Length(9)));
    table(STAGE_HEADS, &sight.stages, "stages").widths(widths).render(area, buffer);
}

fn draw_workers(area: Rect, buffer: &mut Buffer, sight: &Sight) {
    let widths = [
        Constraint::Length(12),
        Constraint::Length(24),
        Constraint::Length(22),
        Constraint::Min(20),
        Constraint::Length(16),
    ];
    table(WORKER_HEADS, &sight.workers, "workers").widths(widths).render(area, buffer);
}

fn draw_batches(area: Rect, buffer: &mut Buffer, sight: &Sight, cursor: Option<usize>) {
    let seen = usize::from(area.height.saturating_sub(2));
    let row = |(at, batch): (usize, &BatchRow)| {
        let row = Row::new(batch.cells.clone());
        if cursor == Some(at) { row.style(chosen()) } else { row }
    };
    let rows: Vec<Row<'_>> = sight.batches.iter().enumerate().skip(first_seen(cursor, seen)).map(row).collect();
    let widths = [Constraint::Min(24)].into_iter().chain([12, 16, 9, 9, 20].map(Constraint::Length));
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let batches = Table::default().rows(rows).header(Row::new(BATCH_HEADS).style(bold)).block(titled("batches"));
    batches.widths(widths).render(area, buffer);
}

fn titled(title: &str) -> Block<'_> {
    Block::new().borders(Borders::TOP).title(title)
}

fn table<'a, const N: usize>(heads: [&'a str; N], rows: &'a [[String; N]], title: &'a str) -> Table<'a> {
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let rows: Vec<Row<'a>> = rows.iter().map(|row| Row::new(row.iter().map(String::as_str))).collect();
    Table::default().rows(rows).header(Row::new(heads).style(bold)).block(titled(title))
}

#[cfg(test)]
mod tests {
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;

    use super::*;

    /// Longer than a terminal is wide.
    const FAILURE: &str = "12 s ago · s-1/paths/r0 attempt 2 · a wrong answer · G-DISC robot: jumps from the dock to the third aisle, and \
         the scene graph has no such edge there";

    fn batch(number: usize) -> BatchRow {
        let name = format!("night-{number}");
        let mut cells: [String; 6] = std::array::from_fn(|column| column.to_string());
        cells[0].clone_from(&name);
        BatchRow { name, paused: false, cells }
    }

    fn sight() -> Sight {
        let row = |name: &str| {
            let mut row: [String; 10] = std::array::from_fn(|column| column.to_string());
            row[0] = name.to_owned();
            row
        };
        Sight {
            head: vec!["tcp/x:1 · going on".to_owned(), "2 of 5 done".to_owned()],
            stages: vec![row("proposal"), row("paths (paused)")],
            workers: vec![["01234567", "lab 7", "paths", "s-1/paths/r0", "1 s ago"].map(str::to_owned)],
            batches: (0..9).map(batch).collect(),
            failures: vec![FailureRow {
                job: "s-1/paths/r0".to_owned(),
                scenario: "s-1".to_owned(),
                line: FAILURE.to_owned(),
            }],
            object: serde_json::Value::Null,
        }
    }

    /// What stands on a terminal of this size.
    fn seen(columns: u16, rows: u16, hand: &Hand) -> Vec<String> {
        let mut terminal = Terminal::new(TestBackend::new(columns, rows)).unwrap();
        terminal.draw(|frame| draw(frame.area(), frame.buffer_mut(), &sight(), hand)).unwrap();
        let buffer = terminal.backend().buffer();
        let line = |y: u16| (0..columns).map(|x| buffer[(x, y)].symbol()).collect::<String>().trim_end().to_owned();
        (0..rows).map(line).collect()
    }

    #[test]
    fn a_frame_shows_head_stages_workers_and_failures() {
        let lines = seen(120, 24, &Hand::default());
        assert_eq!(lines[0], "tcp/x:1 · going on");
        let of = |word: &str| {
            lines.iter().position(|line| line.contains(word)).unwrap_or_else(|| panic!("no `{word}` in {lines:#?}"))
        };
        let order = [
            "going on",
            "stages",
            "p50",
            "proposal",
            "paths (paused)",
            "workers──",
            "01234567",
            "batches──",
            "night-0",
            "night-5",
            "failures",
            "a wrong answer",
            "q quit",
        ];
        let places: Vec<usize> = order.iter().map(|word| of(word)).collect();
        assert!(places.windows(2).all(|two| two[0] < two[1]), "{places:?} {lines:#?}");
        let row = &lines[of("paths (paused)")];
        assert!((1..10).all(|column| row.contains(&column.to_string())), "{row}");
        let hand = Hand { note: "the orchestrator does not answer".to_owned(), ..Hand::default() };
        assert_eq!(seen(120, 24, &hand)[2], hand.note);
    }

    #[test]
    fn the_cursor_brings_the_rows_that_it_is_on_and_a_page_takes_the_place_of_the_tables() {
        let mut hand = Hand::default();
        let shows = |hand: &Hand, word: &str| seen(120, 24, hand).iter().any(|line| line.contains(word));
        assert!(shows(&hand, "night-0") && !shows(&hand, "night-8"));
        for _ in 0..8 {
            let down =
                KeyEvent::new(ratatui::crossterm::event::KeyCode::Down, ratatui::crossterm::event::KeyModifiers::NONE);
            hand.press(down, &sight());
        }
        assert!(!shows(&hand, "night-0") && shows(&hand, "night-8"));
        hand.mode = Mode::Reading(vec!["job        s-1/paths/r0 · dead".to_owned()], 0);
        assert!(shows(&hand, "s-1/paths/r0 · dead") && shows(&hand, "q back") && !shows(&hand, "stages"));
    }

    #[test]
    fn a_small_terminal_gets_what_fits_and_nothing_breaks() {
        for (columns, rows) in [(1, 1), (20, 5), (80, 3), (300, 60)] {
            let hand = Hand { note: "x".to_owned(), ..Hand::default() };
            assert_eq!(seen(columns, rows, &hand).len(), usize::from(rows));
        }
    }

    #[test]
    fn the_one_frame_is_as_tall_as_its_rows() {
        let lines = text(&sight(), 100);
        assert!(lines.iter().any(|line| line == FAILURE), "a failure is told whole: {lines:#?}");
        let of = |word: &str| lines.iter().position(|line| line.contains(word));
        assert!(of("s-1/paths/r0") < of("night-0") && of("night-0") < of("night-8"), "{lines:#?}");
        assert!(of("night-8") < of("failures") && lines.len() < 32, "{lines:#?}");
    }
}
