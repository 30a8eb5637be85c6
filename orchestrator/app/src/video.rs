//! `video`: the film of a bundle, by ffmpeg where it is installed, as GIF or animated SVG by ourselves.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use serde_json::json;
use socrates_draw::gif::{Gif, Histogram};
use socrates_draw::{Film, FilmOptions, Seen, Shown};
use socrates_model::{Digest, HumanId, Recording, Run};

use crate::bundle::{self, Bundle, RunEntry};
use crate::config::Config;
use crate::exit::{Code, Diagnostic};
use crate::output::Printer;
use crate::progress::Progress;

/// Names of planners that are not to be known, by place.
const LETTERS: [char; socrates_draw::film::PANELS] = ['A', 'B', 'C', 'D'];

/// Whether names, clock and planner are written into a film.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Labels {
    /// Names, clock, planner and captions.
    On,
    /// The same, with robot A, robot B and so on for the planners, in an order that tells nothing of them.
    Opaque,
    /// None of them: for people who must not know the planner. What somebody says is shown all the same.
    Off,
}

/// Options of `video`.
#[derive(Debug, Clone)]
pub struct VideoOptions {
    /// Bundle folder.
    pub bundle: PathBuf,
    /// File to write: `.mp4` and `.webm` need ffmpeg, `.gif` and `.svg` need nothing. Default: in the bundle, `.mp4`
    /// where ffmpeg is installed, else `.gif`.
    pub out: Option<PathBuf>,
    /// Names, clock, planner, captions, and cards with title and verdict.
    pub labels: Labels,
    /// Runs to show, such as `reference-1`; up to four, separated by commas, stand side by side. Default: the first.
    pub run: Vec<Run>,
    /// Simulated seconds per second, or `auto`: 1, and faster where what happens would not fit into 20 s.
    pub speed: String,
    /// Width and height, px. Default: 1280x720, for a GIF 800x450.
    pub size: Option<String>,
    /// The person whose eyes it is seen with; none from above.
    pub from: Option<HumanId>,
}

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Mp4,
    Webm,
    Gif,
    Svg,
}

impl Kind {
    fn of(path: &Path) -> Result<Self, Diagnostic> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
        match ending.as_str() {
            "mp4" => Ok(Self::Mp4),
            "webm" => Ok(Self::Webm),
            "gif" => Ok(Self::Gif),
            "svg" => Ok(Self::Svg),
            _ => Err(Diagnostic::input(
                format!("`{}` is no film: its ending is `{ending}`", path.display()),
                "name a file that ends in .mp4, .webm (both need ffmpeg), .gif or .svg",
            )),
        }
    }

    const fn needs_ffmpeg(self) -> bool {
        matches!(self, Self::Mp4 | Self::Webm)
    }
}

/// Makes the film, and tells where it is.
pub fn video(talk: &Printer, config: &Config, options: &VideoOptions) -> Result<(), Diagnostic> {
    talk.result(&film(talk, config, options)?);
    Ok(())
}

/// Makes the film, and hands back what is told of it to programs.
pub(crate) fn film(talk: &Printer, config: &Config, options: &VideoOptions) -> Result<serde_json::Value, Diagnostic> {
    let ffmpeg = config.installed("ffmpeg");
    let bundle = bundle::read(&options.bundle)?;
    let mut runs = shown_runs(&bundle, &options.run)?;
    if options.labels == Labels::Opaque {
        runs.sort_by_key(|run| crate::opaque::rank(&bundle.manifest.scenario, run));
    }
    let names: Vec<String> = runs.iter().map(Run::to_string).collect();
    let out = options.out.clone().unwrap_or_else(|| {
        let ending = if ffmpeg.is_some() { "mp4" } else { "gif" };
        let name = format!("{}.{ending}", names.join("+"));
        // Into the folder, or beside the file of a packed one.
        match bundle::archive(&options.bundle) {
            Some(archive) => archive.with_file_name(format!("{}.{name}", bundle.manifest.scenario)),
            None => options.bundle.join(name),
        }
    });
    let kind = Kind::of(&out)?;
    if kind.needs_ffmpeg() && ffmpeg.is_none() {
        return Err(Diagnostic::input(
            format!("`{}` needs ffmpeg, which is not in PATH", out.display()),
            "install it (Debian: apt-get install ffmpeg), or name a .gif or .svg file, which need nothing",
        ));
    }
    if let Some(who) = options.from.filter(|_| kind == Kind::Svg) {
        return Err(Diagnostic::input(
            format!("`{}` cannot show what {who} sees: an animated SVG only moves shapes", out.display()),
            "name a .gif file, or with ffmpeg an .mp4 or .webm file",
        ));
    }
    let all: Vec<&Recording> = bundle.runs.iter().map(|(recording, _)| recording).collect();
    let shown: Vec<Shown<'_>> = runs
        .iter()
        .zip(LETTERS)
        .filter_map(|(run, letter)| Some((bundle.run(run)?, letter)))
        .map(|((recording, report), letter)| {
            let name = (options.labels == Labels::Opaque).then(|| format!("robot {letter}"));
            Shown { recording, report: Some(report), name }
        })
        .collect();
    let film_options = FilmOptions {
        size: size(options.size.as_deref(), kind)?,
        fps: if kind == Kind::Gif { 10 } else { 30 },
        labels: options.labels != Labels::Off,
        speed: speed(&options.speed)?,
        seen: options.from.map_or(Seen::Above, Seen::By),
        ..FilmOptions::USUAL
    };
    let film = Film::new(&bundle.location, &bundle.proposal.title, &all, &shown, film_options).map_err(wrong)?;
    let count = film.times.pictures();
    let shown_so_far = std::cell::RefCell::new(Progress::new(*talk, "filming", count));
    let progress = |index: usize| shown_so_far.borrow_mut().at(index, "");
    match (kind, ffmpeg) {
        (Kind::Mp4 | Kind::Webm, Some(program)) => by_ffmpeg(&program, &film, film_options, kind, &out, &progress)?,
        (Kind::Svg, _) => crate::files::write(&out, film.animated_svg().as_bytes())?,
        (Kind::Gif | Kind::Mp4 | Kind::Webm, _) => crate::files::write(&out, &gif(&film, film_options, &progress)?)?,
    }
    drop(shown_so_far);
    let times = film.times;
    let part = format!("{:.1} s to {:.1} s at {}×", times.from_s, times.to_s, round(times.speed));
    talk.line(&format!("wrote      {} · {:.1} s · {part}", out.display(), times.length_s()));
    let from = options.from.map_or_else(|| "from above".to_owned(), |who| format!("by {who}"));
    let alt =
        format!("Seen {from}: {}. {}", socrates_offline::summary(&bundle.reading), bundle.proposal.description.trim());
    Ok(json!({
        "video": out.display().to_string(), "runs": names, "seconds": round(times.length_s()), "from_s": round(times.from_s),
        "to_s": round(times.to_s), "speed": round(times.speed), "pictures": count, "fps": times.fps, "alt": alt,
        "digest": std::fs::read(&out).ok().map(|bytes| Digest::of(&bytes)),
    }))
}

/// Why there is no film.
pub(crate) fn wrong(why: socrates_draw::FilmError) -> Diagnostic {
    let hint = match &why {
        socrates_draw::FilmError::Absent { .. } => "name somebody who is there all the time, or leave the person out",
        socrates_draw::FilmError::Empty
        | socrates_draw::FilmError::Crowded { .. }
        | socrates_draw::FilmError::Speed { .. }
        | socrates_draw::FilmError::Size { .. }
        | socrates_draw::FilmError::Part { .. }
        | socrates_draw::FilmError::Picture(_) => "`socrates video --help` names what is allowed",
    };
    let cause = std::error::Error::source(&why).map(ToString::to_string);
    let mut diagnostic = Diagnostic::input(why.to_string(), hint);
    diagnostic.causes.extend(cause);
    diagnostic
}

/// The runs that are shown; each must be in the bundle.
pub(crate) fn shown_runs(bundle: &Bundle, asked: &[Run]) -> Result<Vec<Run>, Diagnostic> {
    let known: Vec<Run> = bundle.manifest.runs.iter().map(RunEntry::run).collect();
    if asked.is_empty() {
        return Ok(known.into_iter().take(1).collect());
    }
    for run in asked {
        if !known.contains(run) {
            let names: Vec<String> = known.iter().map(Run::to_string).collect();
            return Err(Diagnostic::input(
                format!("the bundle has no run `{run}`"),
                format!("its runs are: {}", names.join(", ")),
            ));
        }
    }
    Ok(asked.to_vec())
}

fn round(x: f64) -> f64 {
    (x * 100.0).round() / 100.0
}

fn speed(text: &str) -> Result<Option<f64>, Diagnostic> {
    if text == "auto" {
        return Ok(None);
    }
    text.trim_end_matches(['x', '×']).parse::<f64>().map(Some).map_err(|why| {
        Diagnostic::input(
            format!("`--speed {text}` is no speed: {why}"),
            "`auto`, or simulated seconds per second such as 2",
        )
    })
}

fn size(text: Option<&str>, kind: Kind) -> Result<(u32, u32), Diagnostic> {
    let Some(text) = text else { return Ok(if kind == Kind::Gif { (800, 450) } else { (1280, 720) }) };
    text.split_once('x')
        .and_then(|(width, height)| Some((width.trim().parse().ok()?, height.trim().parse().ok()?)))
        .ok_or_else(|| Diagnostic::input(format!("`--size {text}` is no size"), "for example 1280x720"))
}

/// Hands every picture to ffmpeg as it is drawn.
pub(crate) fn by_ffmpeg(
    program: &Path,
    film: &Film<'_>,
    options: FilmOptions,
    kind: Kind,
    out: &Path,
    progress: &dyn Fn(usize),
) -> Result<(), Diagnostic> {
    if let Some(folder) = out.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(|why| {
            Diagnostic::input(format!("cannot write `{}`: {why}", out.display()), "--out chooses another place")
        })?;
    }
    let codec: &[&str] = if kind == Kind::Mp4 {
        &["-c:v", "libx264", "-profile:v", "high", "-preset", "medium", "-crf", "20", "-movflags", "+faststart"]
    } else {
        &["-c:v", "libvpx-vp9", "-b:v", "0", "-crf", "32", "-row-mt", "1", "-deadline", "good", "-cpu-used", "5"]
    };
    let failed =
        |what: String| Diagnostic::input(what, "name a .gif or .svg file, which need no ffmpeg").with_code(Code::Input);
    let mut child: Child = Command::new(program)
        .args(["-hide_banner", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s"])
        .arg(format!("{}x{}", options.size.0, options.size.1))
        .args(["-r", &options.fps.to_string(), "-i", "-", "-an"])
        .args(codec)
        // Nothing of the machine or the day in the file.
        .args(["-pix_fmt", "yuv420p", "-map_metadata", "-1", "-fflags", "+bitexact", "-flags:v", "+bitexact"])
        .arg(out)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|why| failed(format!("`{}` cannot be started: {why}", program.display())))?;
    let mut ended_early = false;
    if let Some(mut pipe) = child.stdin.take() {
        for index in 0..film.times.pictures() {
            progress(index);
            // Where ffmpeg has closed its end, its own message says why.
            if pipe.write_all(&film.picture(index).map_err(wrong)?).is_err() {
                ended_early = true;
                break;
            }
        }
    }
    let end = child.wait_with_output().map_err(|why| failed(format!("ffmpeg was lost: {why}")))?;
    if end.status.success() && !ended_early {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&end.stderr);
    let mut diagnostic = failed(format!("ffmpeg could not write `{}` ({})", out.display(), end.status));
    diagnostic.causes = said.lines().rev().take(5).map(str::to_owned).collect();
    diagnostic.causes.reverse();
    Err(diagnostic)
}

/// The film as GIF.
fn gif(film: &Film<'_>, options: FilmOptions, progress: &dyn Fn(usize)) -> Result<Vec<u8>, Diagnostic> {
    let count = film.times.pictures();
    let mut histogram = Histogram::default();
    // A dozen pictures show every color there is.
    for index in (0..count).step_by((count / 12).max(1)) {
        histogram.add(&film.picture(index).map_err(wrong)?);
    }
    let ours = |why: socrates_draw::gif::GifError| {
        Diagnostic::input(why.to_string(), "--size chooses another size, such as 800x450")
    };
    let mut gif = Gif::new(options.size.0, options.size.1, histogram.palette()).map_err(ours)?;
    for index in 0..count {
        progress(index);
        gif.add(&film.picture(index).map_err(wrong)?, 100 / options.fps).map_err(ours)?;
    }
    gif.finish().map_err(ours)
}
