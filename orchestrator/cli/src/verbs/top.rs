//! `top`: stages, workers and failures of an orchestrator on the terminal, drawn anew every second.

use std::io::IsTerminal as _;
use std::time::Duration;

use clap::Args;
use ratatui::buffer::Buffer;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEventKind, KeyModifiers};
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Modifier, Style};
use ratatui::text::Line;
use ratatui::widgets::{Block, Borders, Paragraph, Row, Table, Widget as _};
use socrates_app::config::Config;
use socrates_app::exit::{Code, Complaint};
use socrates_app::output::{Format, Printer};
use socrates_app::top::{STAGE_HEADS, Sight, Viewer, WORKER_HEADS};

use super::keys::Keys;
use super::{Outcome, done};

/// Pause between two looks.
const PAUSE: Duration = Duration::from_secs(1);
/// Letters of a line where the terminal does not say how many it has.
const COLUMNS: u16 = 120;
/// Lines of the frame of `--once` for failures, at most.
const FAILURES: usize = 16;

/// Arguments of `top`.
#[derive(Debug, Args)]
pub(crate) struct Top {
    /// Folder of a run that goes on, or a zenoh endpoint such as `tcp/127.0.0.1:7447` or `tls/lab-3:7447@main`.
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
            return Err(Complaint::input(
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
async fn print(talk: &Printer, viewer: &Viewer) -> Result<(), Complaint> {
    let sight = viewer.look().await?;
    let columns =
        ratatui::crossterm::terminal::size().ok().filter(|_| talk.live).map_or(COLUMNS, |(columns, _)| columns);
    for line in text(&sight, columns) {
        talk.line(&line);
    }
    talk.result(&sight.object);
    Ok(())
}

/// The lines of a frame of this width.
fn text(sight: &Sight, columns: u16) -> Vec<String> {
    let rows =
        sight.head.len() + sight.stages.len() + sight.workers.len() + sight.failures.len().clamp(1, FAILURES) + 7;
    let area = Rect::new(0, 0, columns, u16::try_from(rows).unwrap_or(u16::MAX));
    let mut buffer = Buffer::empty(area);
    draw(area, &mut buffer, sight, "");
    let line = |y: u16| -> String {
        let cells = (0..columns).filter_map(|x| buffer.cell((x, y)));
        cells.map(|cell| cell.symbol()).collect::<String>().trim_end().to_owned()
    };
    (0..area.height).map(line).collect()
}

/// Draws until a person has seen enough. One that does not answer is asked again; what was seen last stays.
async fn follow(viewer: &Viewer) -> Result<(), Complaint> {
    let mut sight = viewer.look().await?;
    let mut terminal = ratatui::try_init().map_err(broken)?;
    let followed = async {
        let mut note = String::new();
        loop {
            let drawn = terminal.draw(|frame| draw(frame.area(), frame.buffer_mut(), &sight, &note));
            drawn.map(drop).map_err(broken)?;
            let key = tokio::task::spawn_blocking(|| leaves(PAUSE)).await;
            if key.map_err(broken)?.map_err(broken)? {
                return Ok(());
            }
            note.clear();
            match viewer.look().await {
                Ok(newer) => sight = newer,
                Err(why) => note = why.short(),
            }
        }
    };
    let followed = followed.await;
    ratatui::restore();
    followed
}

fn broken(why: impl std::fmt::Display) -> Complaint {
    Complaint::input(format!("the terminal cannot be drawn on: {why}"), "--once prints one frame").with_code(Code::Ours)
}

/// Whether a key was pressed within a pause that ends the drawing; a window of another size is drawn at once.
fn leaves(pause: Duration) -> std::io::Result<bool> {
    if !event::poll(pause)? {
        return Ok(false);
    }
    let Event::Key(key) = event::read()? else { return Ok(false) };
    let broken_off = key.code == KeyCode::Char('c') && key.modifiers.contains(KeyModifiers::CONTROL);
    let enough = matches!(key.code, KeyCode::Char('q') | KeyCode::Esc);
    Ok(key.kind == KeyEventKind::Press && (enough || broken_off))
}

/// Rows that a part takes with its head and its line above.
fn tall(rows: usize) -> u16 {
    u16::try_from(rows + 2).unwrap_or(u16::MAX)
}

/// One frame: head, stages, workers, failures, one below the other.
fn draw(area: Rect, buffer: &mut Buffer, sight: &Sight, note: &str) {
    let [head, stages, workers, failures] = Layout::vertical([
        Constraint::Length(u16::try_from(sight.head.len() + 1).unwrap_or(u16::MAX)),
        Constraint::Length(tall(sight.stages.len())),
        Constraint::Max(tall(sight.workers.len())),
        Constraint::Min(2),
    ])
    .areas(area);
    let mut lines: Vec<Line<'_>> = sight.head.iter().map(|line| Line::from(line.as_str())).collect();
    if !note.is_empty() {
        lines.push(Line::styled(note, Style::new().add_modifier(Modifier::REVERSED)));
    }
    Paragraph::new(lines).render(head, buffer);
    let widths = [Constraint::Min(18)].into_iter().chain((0..9).map(|_column| Constraint::Length(9)));
    table(STAGE_HEADS, &sight.stages, "stages").widths(widths).render(stages, buffer);
    let widths = [
        Constraint::Length(12),
        Constraint::Length(24),
        Constraint::Length(22),
        Constraint::Min(20),
        Constraint::Length(16),
    ];
    table(WORKER_HEADS, &sight.workers, "workers").widths(widths).render(workers, buffer);
    let none = ["none since this start of the orchestrator".to_owned()];
    let told = if sight.failures.is_empty() { &none[..] } else { &sight.failures[..] };
    let told: Vec<Line<'_>> = told.iter().map(|line| Line::from(line.as_str())).collect();
    Paragraph::new(told).block(titled("failures · q ends")).render(failures, buffer);
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
            failures: vec!["12 s ago · s-1/paths/r0 attempt 2 · a wrong answer".to_owned()],
            object: serde_json::Value::Null,
        }
    }

    /// What stands on a terminal of this size.
    fn drawn(columns: u16, rows: u16, note: &str) -> Vec<String> {
        let mut terminal = Terminal::new(TestBackend::new(columns, rows)).unwrap();
        terminal.draw(|frame| draw(frame.area(), frame.buffer_mut(), &sight(), note)).unwrap();
        let buffer = terminal.backend().buffer();
        let line = |y: u16| (0..columns).map(|x| buffer[(x, y)].symbol()).collect::<String>().trim_end().to_owned();
        (0..rows).map(line).collect()
    }

    #[test]
    fn a_frame_shows_head_stages_workers_and_failures() {
        let lines = drawn(120, 14, "");
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
            "failures",
            "a wrong answer",
        ];
        let places: Vec<usize> = order.iter().map(|word| of(word)).collect();
        assert!(places.windows(2).all(|two| two[0] < two[1]), "{places:?} {lines:#?}");
        let row = &lines[of("paths (paused)")];
        assert!((1..10).all(|column| row.contains(&column.to_string())), "{row}");
        assert_eq!(drawn(120, 14, "the orchestrator does not answer")[2], "the orchestrator does not answer");
    }

    #[test]
    fn a_small_terminal_gets_what_fits_and_nothing_breaks() {
        for (columns, rows) in [(1, 1), (20, 5), (80, 3), (300, 60)] {
            assert_eq!(drawn(columns, rows, "x").len(), usize::from(rows));
        }
    }

    #[test]
    fn the_one_frame_is_as_tall_as_its_rows() {
        let lines = text(&sight(), 100);
        assert!(lines.iter().any(|line| line.contains("a wrong answer")), "{lines:#?}");
        assert!(lines.iter().any(|line| line.contains("s-1/paths/r0")) && lines.len() < 16, "{lines:#?}");
    }
}
