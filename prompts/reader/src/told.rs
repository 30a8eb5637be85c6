//! A story as text, one fact a line: `human_1: give_way when says EXCUSE_ME`.

use std::fmt;

use socrates_model::Relation;

use crate::cast::People;
use crate::rows::Act;
use crate::statement::Reason;
use crate::story::{Step, Story, name};

impl fmt::Display for Story {
    /// One fact a line: `human_1: give_way when says EXCUSE_ME`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = self.place {
            writeln!(f, "place: {place}")?;
        }
        for (what, class) in [("start", self.robot_start), ("goal", self.robot_goal)] {
            if let Some(class) = class {
                writeln!(f, "robot: {what} {class}")?;
            }
        }
        for class in &self.robot_via {
            writeln!(f, "robot: via {class}")?;
        }
        for gesture in &self.robot_says {
            writeln!(f, "robot: says {gesture}")?;
        }
        for person in &self.robot_first {
            writeln!(f, "robot: before {}", name(*person))?;
        }
        for (first, then) in &self.order {
            writeln!(f, "{}: after {}", name(*then), name(*first))?;
        }
        for (number, person) in self.people.iter().enumerate() {
            let name = name(number);
            writeln!(f, "{name}: {}", person.role)?;
            if let Some(relation) = person.relation {
                let side = person.side.map_or_else(String::new, |side| format!(" {}", side.name()));
                writeln!(f, "{name}: {}{side}", relation.name())?;
            }
            if person.crosses {
                writeln!(f, "{name}: {}", Relation::Crossing.name())?;
            }
            if let Some(group) = person.group {
                writeln!(f, "{name}: group {group}")?;
            }
            if person.twice.is_some() {
                writeln!(f, "{name}: meets it twice")?;
            }
            if person.queues {
                writeln!(f, "{name}: queue")?;
            }
            if let Some(mps) = person.pace_mps {
                writeln!(f, "{name}: pace {mps}")?;
            }
            for step in &person.steps {
                writeln!(f, "{name}: {step}")?;
            }
        }
        Ok(())
    }
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.whom.filter(|_| self.act == Act::Follow) {
            Some(whom) => write!(f, "follow {}", name(whom))?,
            None => f.write_str(self.act.name())?,
        }
        if let Some(gesture) = self.says {
            write!(f, " {gesture}")?;
        }
        for (word, reasons) in [("when", &self.when), ("until", &self.until)] {
            for reason in reasons {
                write!(f, " {word} {reason}")?;
            }
        }
        self.for_s.map_or(Ok(()), |secs| write!(f, " for {secs}"))
    }
}

impl fmt::Display for Reason<People> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", format!("{:?}", self.cue).to_lowercase())?;
        if let Some(who) = self.who.as_ref().and_then(|who| who.first()) {
            write!(f, " {}", name(*who))?;
        }
        if let Some(sign) = self.sign {
            write!(f, " {sign}")?;
        }
        self.amount.map_or(Ok(()), |amount| write!(f, " {amount}"))
    }
}
