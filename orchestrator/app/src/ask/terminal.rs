//! The person at the terminal: lines, the editor, the picture of the map.

use std::path::{Path, PathBuf};

use base64::prelude::{BASE64_STANDARD, Engine as _};
use socrates_model::AgentId;

use super::conversation::{Look, Person, Tone};
use super::log::{Log, Shelf};
use super::version::Version;
use crate::config::Config;
use crate::exit::Diagnostic;
use crate::output::Printer;

/// Width of a picture in the terminal, columns.
const COLUMNS: u32 = 96;
/// Most base64 letters in one piece of a kitty picture, as its protocol has it.
const PIECE: usize = 4096;
/// Largest text that is read back from an editor, bytes.
const MOST_BYTES: u64 = 4 * 1024 * 1024;

/// How a terminal shows pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pictures {
    /// The graphics protocol of kitty, which `WezTerm` and Ghostty speak too.
    Kitty,
    /// Inline images of iTerm2.
    Iterm,
    /// Not at all: the file is named.
    No,
}

/// A person at this process's terminal, or at the other end of its pipes.
pub(super) struct Terminal {
    talk: Printer,
    shelf: Shelf,
    folder: PathBuf,
    pictures: Pictures,
    color: bool,
    editor: String,
}

impl Terminal {
    /// The terminal, with files in the work folder.
    pub(super) fn new(talk: Printer, config: &Config, work: &Path) -> Self {
        let variable = |name: &str| config.variable(name).unwrap_or_default().to_owned();
        let shown = talk.live && talk.is_typed_to();
        Self {
            talk,
            shelf: Shelf::of(work),
            folder: work.to_path_buf(),
            pictures: if shown { pictures(&variable) } else { Pictures::No },
            color: talk.live && variable("NO_COLOR").is_empty() && variable("TERM") != "dumb",
            editor: ["VISUAL", "EDITOR"].into_iter().find_map(|name| config.variable(name)).unwrap_or("vi").to_owned(),
        }
    }

    /// The log of an earlier visit, or a new one.
    pub(super) fn log(&self) -> Result<Log, Diagnostic> {
        self.shelf.load()
    }
}

/// What the environment says of pictures.
fn pictures(variable: &dyn Fn(&str) -> String) -> Pictures {
    let program = variable("TERM_PROGRAM");
    // Multiplexers pass neither protocol on.
    if !variable("TMUX").is_empty() || !variable("STY").is_empty() {
        Pictures::No
    } else if variable("TERM").contains("kitty")
        || !variable("KITTY_WINDOW_ID").is_empty()
        || program == "WezTerm"
        || program.eq_ignore_ascii_case("ghostty")
    {
        Pictures::Kitty
    } else if program == "iTerm.app" || variable("LC_TERMINAL") == "iTerm2" {
        Pictures::Iterm
    } else {
        Pictures::No
    }
}

/// The escape sequence that shows a PNG.
fn sequence(how: Pictures, png: &[u8]) -> String {
    let text = BASE64_STANDARD.encode(png);
    match how {
        Pictures::No => String::new(),
        Pictures::Iterm => {
            format!("\x1b]1337;File=inline=1;width={COLUMNS};size={};preserveAspectRatio=1:{text}\x07", png.len())
        }
        Pictures::Kitty => {
            let pieces: Vec<&[u8]> = text.as_bytes().chunks(PIECE).collect();
            let last = pieces.len().saturating_sub(1);
            let piece = |(index, piece): (usize, &&[u8])| {
                let keys = if index == 0 { format!("a=T,f=100,q=2,c={COLUMNS},") } else { String::new() };
                let more = u8::from(index < last);
                format!("\x1b_G{keys}m={more};{}\x1b\\", String::from_utf8_lossy(piece))
            };
            pieces.iter().enumerate().map(piece).collect()
        }
    }
}

impl Person for Terminal {
    fn say(&mut self, tone: Tone, line: &str) {
        let code = match tone {
            Tone::Plain => "",
            Tone::Head => "1",
            Tone::Good => "32",
            Tone::Bad => "31",
            Tone::Quiet => "2",
        };
        if self.color && !code.is_empty() {
            self.talk.line(&format!("\x1b[{code}m{line}\x1b[0m"));
        } else {
            self.talk.line(line);
        }
    }

    fn columns(&self) -> usize {
        self.talk.columns().unwrap_or(usize::MAX)
    }

    fn picture(&mut self, look: &Look, version: &Version) {
        let location = &look.question.location;
        let svg = match &version.paths {
            Some(paths) => {
                let roles: Vec<(AgentId, String)> = version
                    .proposal
                    .humans
                    .iter()
                    .map(|human| (AgentId::Human(human.id), human.role.clone()))
                    .collect();
                socrates_draw::draft_picture(location, paths, &roles, &version.proposal.title)
            }
            None => socrates_draw::annotated_map(location),
        };
        let file = self.folder.join("look.png");
        let drawn = socrates_draw::png_from_svg(&svg, 1.5).map_err(|why| why.to_string());
        let drawn = drawn.and_then(|png| std::fs::write(&file, &png).map(|()| png).map_err(|why| why.to_string()));
        match drawn {
            Ok(png) => {
                if self.pictures != Pictures::No {
                    self.talk.line(&sequence(self.pictures, &png));
                }
                self.say(Tone::Quiet, &format!("{:<11}{}", "map", file.display()));
            }
            Err(why) => self.say(Tone::Bad, &format!("the map cannot be drawn: {why}")),
        }
    }

    fn ask(&mut self, prompt: &str) -> Option<String> {
        match self.talk.ask(prompt) {
            Ok(line) => line,
            Err(why) => {
                self.talk.warn(&format!("the terminal cannot be read: {why}"));
                None
            }
        }
    }

    fn edit(&mut self, name: &str, text: &str) -> Result<String, String> {
        let editor = &self.editor;
        let mut words = editor.split_whitespace();
        let Some(program) = words.next() else { return Err("$EDITOR names no program".to_owned()) };
        let file = self.folder.join(name);
        std::fs::write(&file, text).map_err(|why| format!("cannot write `{}`: {why}", file.display()))?;
        let ran = std::process::Command::new(program).args(words).arg(&file).status();
        let hint = "set EDITOR to your editor, for example EDITOR=nano";
        match ran {
            Ok(status) if status.success() => {}
            Ok(status) => return Err(format!("`{editor}` ended with {status}; nothing was changed; {hint}")),
            Err(why) => return Err(format!("`{editor}` cannot be started: {why}; {hint}")),
        }
        crate::files::text(&file, MOST_BYTES, "nothing was changed").map_err(|why| why.to_string())
    }

    fn keep(&mut self, log: &Log) -> Result<(), Diagnostic> {
        self.shelf.keep(log)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(set: &[(&str, &str)]) -> Pictures {
        pictures(&|name| {
            set.iter().find(|(of, _)| *of == name).map(|(_, value)| (*value).to_owned()).unwrap_or_default()
        })
    }

    #[test]
    fn pictures_are_shown_where_the_terminal_can() {
        assert_eq!(of(&[("TERM", "xterm-kitty")]), Pictures::Kitty);
        assert_eq!(of(&[("TERM_PROGRAM", "iTerm.app")]), Pictures::Iterm);
        assert_eq!(of(&[("TERM", "xterm-256color")]), Pictures::No);
        assert_eq!(of(&[("TERM", "xterm-kitty"), ("TMUX", "/tmp/tmux-0/default,1,0")]), Pictures::No);
    }

    #[test]
    fn a_kitty_picture_comes_in_pieces_of_which_only_the_last_ends_it() {
        let text = sequence(Pictures::Kitty, &[7; 10_000]);
        assert_eq!(text.matches("\x1b_G").count(), 4);
        assert_eq!(text.matches("m=1;").count(), 3);
        assert_eq!(text.matches("m=0;").count(), 1);
        assert_eq!(text.matches("a=T").count(), 1);
    }
}
