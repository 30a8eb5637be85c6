//! `video` and `figure`: pictures of a bundle.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use socrates_app::config::Config;
use socrates_app::figure::{self, FigureOptions};
use socrates_app::output::Printer;
use socrates_app::video::{self, VideoOptions};
use socrates_model::{HumanId, Run};

use super::{Outcome, done};

/// Whether names, clock and planner are written into a film.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Labels {
    /// Names, clock, planner and captions.
    On,
    /// The same, with robot A, robot B and so on for the planners, in an order that tells nothing of them.
    Opaque,
    /// None of them: for people who must not know the planner. What somebody says is shown all the same.
    Off,
}

/// Arguments of `video`.
#[derive(Debug, Clone, Args)]
pub(crate) struct Video {
    /// Bundle folder.
    bundle: PathBuf,
    /// File to write: `.mp4` and `.webm` need ffmpeg, `.gif` and `.svg` need nothing. Default: in the bundle, `.mp4`
    /// where ffmpeg is installed, else `.gif`.
    #[arg(long, short)]
    out: Option<PathBuf>,
    /// Names, clock, planner, captions, and cards with title and verdict.
    #[arg(long, value_enum, default_value_t = Labels::On)]
    labels: Labels,
    /// Runs to show, such as `reference-1`; up to four, separated by commas, stand side by side. Default: the first.
    #[arg(long, value_delimiter = ',')]
    run: Vec<Run>,
    /// Simulated seconds per second, or `auto`: 1, and faster where what happens would not fit into 20 s.
    #[arg(long, default_value = "auto")]
    speed: String,
    /// Width and height, px. Default: 1280x720, for a GIF 800x450.
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    size: Option<String>,
    /// Show what this person sees, such as `human_2`, instead of the view from above; not for .svg.
    #[arg(long, value_name = "PERSON")]
    from: Option<HumanId>,
}

impl Video {
    pub(super) fn act(&self, talk: &Printer, config: &Config) -> Outcome {
        let Self { bundle, out, labels, run, speed, size, from } = self.clone();
        let labels = match labels {
            Labels::On => video::Labels::On,
            Labels::Opaque => video::Labels::Opaque,
            Labels::Off => video::Labels::Off,
        };
        done(video::video(talk, config, &VideoOptions { bundle, out, labels, run, speed, size, from }))
    }
}

/// Arguments of `figure`.
#[derive(Debug, Clone, Args)]
pub(crate) struct Figure {
    /// Bundle folder.
    bundle: PathBuf,
    /// SVG, PDF or PNG file to write; a PDF holds its words as text with their font.
    #[arg(long, short, default_value = "figure.svg")]
    out: PathBuf,
    /// Width on paper, mm: 84 is a column of two, 174 a page.
    #[arg(long, default_value_t = 84.0)]
    width_mm: f64,
    /// Runs to show, such as `reference-1`; of the second to fourth only the robot's way. Default: the first run.
    #[arg(long, value_delimiter = ',')]
    run: Vec<Run>,
    /// Pixels per inch of a PNG.
    #[arg(long, default_value_t = 600, value_parser = clap::value_parser!(u16).range(72..=1200))]
    dpi: u16,
}

impl Figure {
    pub(super) fn act(&self, talk: &Printer) -> Outcome {
        let Self { bundle, out, width_mm, run, dpi } = self.clone();
        done(figure::figure(talk, &FigureOptions { bundle, out, width_mm, run, dpi }))
    }
}
