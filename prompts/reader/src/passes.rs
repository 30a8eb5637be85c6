//! All passes of one text, to be looked at: `socrates read --passes`.

use std::fmt;
use std::ops::Range;

use crate::account::{Fate, Piece, Read, account};
use crate::cast::Cast;
use crate::chunk::{Chunk, chunks};
use crate::clause::{Clause, Predicate};
use crate::clause_says::statements;
use crate::discourse::{Told, told};
use crate::lexicon::Lexicon;
use crate::normalize::{Scene, normalize};
use crate::noun::{Head, Pick};
use crate::sentence::clauses;
use crate::statement::{Named, Says, Statement};
use crate::story::{Story, Telling, story};
use crate::token::Token;

/// What each pass made of a text.
#[derive(Debug, Clone)]
pub struct Passes<'a> {
    lexicon: &'a Lexicon,
    text: String,
    tokens: Vec<Token>,
    scene: Scene,
    chunks: Vec<Chunk>,
    clauses: Vec<Clause>,
    statements: Vec<Statement<Named>>,
    told: Told,
    telling: Telling,
}

impl<'a> Passes<'a> {
    pub(crate) fn by(text: &str, lexicon: &'a Lexicon) -> Self {
        Self::of(text, Cast::default(), lexicon)
    }

    /// The same of a text about people who are known.
    pub(crate) fn of(text: &str, known: Cast, lexicon: &'a Lexicon) -> Self {
        let tokens = crate::lex::lex(text, &lexicon.words);
        let scene = normalize(tokens.clone(), lexicon);
        let chunks = chunks(&scene.tokens, lexicon);
        let clauses = clauses(&chunks, lexicon);
        let statements = statements(&clauses, lexicon);
        let told = told(&statements, known);
        let telling = story(&told);
        Self { lexicon, text: text.to_owned(), tokens, scene, chunks, clauses, statements, told, telling }
    }

    /// Acts of clauses of which no statement says anything: a fault of the reader, and always empty.
    #[must_use]
    pub fn lost(&self) -> Vec<&str> {
        let said = |tokens: &std::ops::Range<usize>| {
            self.told
                .statements
                .iter()
                .any(|statement| statement.tokens.start < tokens.end && tokens.start < statement.tokens.end)
        };
        let acts = self.clauses.iter().flat_map(|clause| &clause.acts).filter(|act| !said(&act.tokens));
        let plain = |act: &&Predicate| {
            self.lexicon.frames.get(act.row).is_some_and(|frame| frame.plain || frame.part.is_some())
        };
        acts.filter(|act| !plain(act))
            .filter_map(|act| self.scene.tokens.get(act.tokens.start))
            .map(|token| token.spelled.as_str())
            .collect()
    }

    /// What became of every piece.
    fn pieces(&self) -> Vec<Piece> {
        let mut pieces = account(&self.text, &self.scene, (&self.chunks, &self.clauses), &self.told, &self.telling);
        let aside = |piece: &&mut Piece| piece.clause.is_none() && matches!(piece.fate, Fate::Background(_));
        for piece in pieces.iter_mut().filter(aside) {
            // What asks for nothing, and has somebody do something all the same, is not read.
            if tells_of_somebody(self.text.get(piece.at.clone()).unwrap_or_default(), self.lexicon) {
                piece.fate = Fate::NotRead;
            }
        }
        pieces
    }

    /// What came of it.
    #[must_use]
    pub fn read(self) -> Read {
        let pieces = self.pieces();
        let bytes = |tokens: Range<usize>| {
            let own = self.scene.tokens.get(tokens)?;
            let start = own.iter().map(|token| token.at.start).min()?;
            Some(start..own.iter().map(|token| token.at.end).max()?)
        };
        let lines = self.telling.lines.into_iter().filter_map(|(line, tokens)| Some((line, bytes(tokens)?))).collect();
        let none = |chunk: &Chunk| {
            chunk.noun().is_some_and(|noun| {
                let none = noun.pick == Pick::None || noun.count == Some(0);
                none && matches!(noun.head, Head::Role(_) | Head::Bare)
            })
        };
        let nobody = self.telling.story.people.is_empty() && self.chunks.iter().any(none);
        Read { story: Story { nobody, ..self.telling.story }, pieces, lines }
    }
}

impl fmt::Display for Passes<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "text       {}", self.text)?;
        writeln!(f, "tokens     {}", spaced(&self.tokens))?;
        for (at, reason) in &self.scene.background {
            writeln!(f, "background {}: {}", reason.name(), self.text.get(at.clone()).unwrap_or_default())?;
        }
        writeln!(f, "chunks     {}", spaced(&self.chunks))?;
        for clause in &self.clauses {
            write_clause(f, clause, self.lexicon, "clause     ")?;
        }
        for statement in &self.statements {
            writeln!(f, "statement  {}", Shown(&statement.says))?;
        }
        write!(f, "{}", self.telling.story)?;
        for piece in self.pieces() {
            if !matches!(piece.fate, Fate::Read) {
                writeln!(f, "{:?}: {}", piece.fate, self.text.get(piece.at).unwrap_or_default())?;
            }
        }
        Ok(())
    }
}

/// Whether somebody does something in words that were put aside.
fn tells_of_somebody(text: &str, lexicon: &Lexicon) -> bool {
    let tokens = crate::lex::lex(text, &lexicon.words);
    let acts = |act: &Predicate| {
        let frame = lexicon.frames.get(act.row);
        !act.not && frame.is_some_and(|frame| !frame.plain && (frame.act.is_some() || frame.relate.is_some()))
    };
    let people = |clause: &Clause| clause.own && clause.subject.iter().any(|noun| !noun.may_be_robot());
    let clauses = clauses(&chunks(&tokens, lexicon), lexicon);
    clauses.iter().any(|clause| people(clause) && clause.acts.iter().any(acts))
}

fn write_clause(f: &mut fmt::Formatter<'_>, clause: &Clause, lexicon: &Lexicon, name: &str) -> fmt::Result {
    write!(f, "{name}{:?}", clause.join)?;
    for noun in &clause.subject {
        write!(f, " [{noun}]")?;
    }
    for act in &clause.acts {
        let id = lexicon.frames.get(act.row).map_or("?", |frame| frame.id.as_str());
        let not = if act.not { "not " } else { "" };
        let passive = if act.passive { " passive" } else { "" };
        write!(f, " ({not}{id}{passive}")?;
        if let Some(object) = &act.object {
            write!(f, " [{object}]")?;
        }
        if let Some(sign) = act.sign {
            write!(f, " {sign}")?;
        }
        f.write_str(")")?;
    }
    for (what, amount) in [("for", clause.lasts_s), ("after", clause.after_s), ("within", clause.within_m)] {
        if let Some(amount) = amount {
            write!(f, " {what} {}", amount.value)?;
        }
    }
    for at in &clause.places {
        write!(f, " at {}", at.class.map_or("nowhere", |class| class.name()))?;
    }
    writeln!(f)?;
    for condition in &clause.conditions {
        write_clause(f, &condition.clause, lexicon, &format!("  {:?} ", condition.tie))?;
    }
    Ok(())
}

/// A statement in a line, with people as the text names them.
struct Shown<'a>(&'a Says<Named>);

impl fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Says::Introduce(who) => write!(f, "introduce {}", spaced(who)),
            Says::Walks(who) => write!(f, "walks {}", spaced(who)),
            Says::Noted(who) => write!(f, "noted {}", spaced(who)),
            Says::Relate(who, relation, side) => write!(f, "relate {}: {relation:?} {side:?}", spaced(who)),
            Says::Group(who) => write!(f, "group {}", spaced(who)),
            Says::Pace(who, mps) => write!(f, "pace {}: {mps} m/s", spaced(who)),
            Says::Do(deed) => {
                let not = if deed.not { "not " } else { "" };
                write!(f, "do {}: {not}{}", spaced(&deed.who), deed.act.name())?;
                for (word, reasons) in [("when", &deed.when), ("until", &deed.until)] {
                    for reason in reasons {
                        write!(f, " {word} {:?}", reason.cue)?;
                    }
                }
                deed.for_s.map_or(Ok(()), |secs| write!(f, " for {secs} s"))
            }
            Says::RobotSays(sign, _) => write!(f, "robot says {sign:?}"),
            Says::Then(reason, _) => write!(f, "then {:?}", reason.cue),
            Says::From(who, class) => write!(f, "from {class}: {}", spaced(who)),
            Says::RobotFirst(_) => f.write_str("robot is first"),
            Says::Twice(who, _) => write!(f, "meets it twice {}", spaced(who)),
            Says::Queue(who) => write!(f, "queue {}", spaced(who)),
            Says::After(..) => f.write_str("comes after those before"),
            Says::Happens(class, rank) => write!(f, "happens {class} ({rank})"),
            Says::There => f.write_str("happens there"),
            Says::GoalThere => f.write_str("robot goes there"),
            Says::RobotVia(class) => write!(f, "robot goes via {class}"),
            Says::RobotStart(class) => write!(f, "robot starts {class}"),
            Says::RobotGoal(class) => write!(f, "robot goes {class}"),
            Says::Background(reason) => write!(f, "background {}", reason.name()),
            Says::NotPlayed(why) => write!(f, "not played: {why}"),
            Says::Goes => f.write_str("goes with the rest"),
            Says::NotRead => f.write_str("not read"),
        }
    }
}

fn spaced<T: fmt::Display>(all: &[T]) -> String {
    all.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
}
