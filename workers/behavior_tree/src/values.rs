//! Values of ports: what is wrong with one.

use socrates_model::{FaultCode, Gesture};

use crate::blackboard::read_flag;
use crate::parse::key_in_braces;
use crate::script::Script;
use crate::sheet::PortKind;

/// What is wrong with the value of a port.
pub(crate) fn wrong(kind: PortKind, value: &str) -> Option<(FaultCode, &'static str)> {
    let port = |what| Some((FaultCode::BPort, what));
    let range = |what| Some((FaultCode::BRange, what));
    if value.contains("??") {
        return port("was left open");
    }
    if let Some(key) = key_in_braces(value) {
        return match (kind == PortKind::Own, kind == PortKind::Code) {
            (true, _) if key == "id" => None,
            (true, _) => port("is not this human"),
            (false, true) => port("is not a script"),
            (false, false) if key.is_empty() => port("names no entry"),
            (false, false) => None,
        };
    }
    let number: Option<f64> = value.trim().parse().ok().filter(|number: &f64| number.is_finite());
    match (kind, number) {
        (PortKind::Own, _) => port("is not this human"),
        (PortKind::Text | PortKind::Output, _) => None,
        (PortKind::Agents, _) => {
            let all_ids = value.split(',').all(|id| id.trim().parse::<u32>().is_ok());
            if all_ids { None } else { port("is not a list of ids") }
        }
        (PortKind::Key, _) if value.trim().is_empty() || value.contains(['{', '}']) => port("names no entry"),
        (PortKind::Key, _) => None,
        (PortKind::Code, _) => match Script::read(value, &mut |_| 0) {
            Ok(_) => None,
            Err(_) => port("is not a script"),
        },
        (PortKind::Flag, _) => {
            if read_flag(value).is_some() {
                None
            } else {
                port("is neither true nor false")
            }
        }
        (PortKind::Gesture, None) if value.parse::<Gesture>().is_ok() => {
            Some((FaultCode::BCode, "is a name where a code must stand"))
        }
        (_, None) => port("is not a number"),
        (PortKind::Number, Some(_)) => None,
        (PortKind::Agent, Some(_)) => whole(value, |number| number >= 0),
        (PortKind::Distance | PortKind::Span | PortKind::Speed, Some(number)) => {
            if number >= 0.0 {
                None
            } else {
                range("is out of range")
            }
        }
        (PortKind::Angle, Some(angle)) => {
            if (0.0..=std::f64::consts::TAU).contains(&angle) {
                None
            } else {
                range("is out of range")
            }
        }
        (PortKind::Share, Some(share)) => {
            if (0.0..=1.0).contains(&share) {
                None
            } else {
                range("is out of range")
            }
        }
        (PortKind::Meters, Some(m)) => {
            if (0.3..=15.0).contains(&m) {
                None
            } else {
                range("is out of range")
            }
        }
        (PortKind::Step, Some(s)) => {
            if s > 0.0 && s <= 1.0 {
                None
            } else {
                range("is out of range")
            }
        }
        (PortKind::Seconds, Some(s)) => {
            if s > 0.0 && s <= 3600.0 {
                None
            } else {
                range("is out of range")
            }
        }
        (PortKind::Gesture, Some(_)) => {
            whole(value, |code| u8::try_from(code).is_ok_and(|code| Gesture::from_code(code).is_ok()))
        }
        (PortKind::Human, Some(_)) => whole(value, |number| number >= 1),
        (PortKind::Count(least), Some(_)) => whole(value, |number| number >= least),
    }
}

/// What is wrong with a whole number.
fn whole(value: &str, fits: impl Fn(i64) -> bool) -> Option<(FaultCode, &'static str)> {
    match value.trim().parse::<i64>() {
        Ok(number) if fits(number) => None,
        Ok(_) => Some((FaultCode::BRange, "is out of range")),
        Err(_) => Some((FaultCode::BPort, "is not a whole number")),
    }
}
