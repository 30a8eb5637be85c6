//! Messages of the frame key: a head and records. Pure.
//!
//! ```text
//! version u16 = 2 · flags u16 [1 last part, 2 the run is over] · part u32 · tick u64 · records of 64 bytes …
//! ```
//!
//! One message holds several whole ticks, or, where a tick does not fit, one part of it. The one that ends a run holds no
//! record, and its tick is the number of ticks.

use socrates_model::recording::{AGENT_STATE_BYTES, AgentState};

/// Version of the messages: version 1 was one tick's records without a head.
pub(crate) const VERSION: u32 = 2;
/// Bytes of the head.
pub(crate) const HEAD_BYTES: usize = 16;
/// Records of one message, at most: 48 KiB with the head.
pub(crate) const RECORDS: usize = 767;

const LAST: u16 = 1;
const OVER: u16 = 2;

/// A message of the frame key.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Part {
    /// Whole ticks: their records in order.
    Ticks(Vec<AgentState>),
    /// One part of a tick that does not fit into a message.
    Piece {
        /// Which tick.
        tick: u64,
        /// Which part of it, from 0.
        part: u32,
        /// Whether it is the last.
        last: bool,
        /// Its records.
        states: Vec<AgentState>,
    },
    /// The run is over after so many ticks.
    Over(u64),
}

/// The head of a message; records follow.
fn head(flags: u16, part: u32, tick: u64, records: usize) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEAD_BYTES + records * AGENT_STATE_BYTES);
    #[expect(clippy::cast_possible_truncation, reason = "the version is a small number")]
    bytes.extend_from_slice(&(VERSION as u16).to_le_bytes());
    bytes.extend_from_slice(&flags.to_le_bytes());
    bytes.extend_from_slice(&part.to_le_bytes());
    bytes.extend_from_slice(&tick.to_le_bytes());
    bytes
}

/// The message that ends a run.
pub(crate) fn over(ticks: u64) -> Vec<u8> {
    head(LAST | OVER, 0, ticks, 0)
}

/// How many whole ticks of so many agents fit into one message; none where a tick needs several.
pub(crate) const fn ticks_that_fit(agents: usize) -> usize {
    match RECORDS.checked_div(agents) {
        Some(ticks) => ticks,
        None => RECORDS,
    }
}

/// Whole ticks from `tick` on as one message. `records` are the bytes of their states.
pub(crate) fn ticks(tick: u64, records: &[u8]) -> Vec<u8> {
    let mut bytes = head(LAST, 0, tick, records.len() / AGENT_STATE_BYTES);
    bytes.extend_from_slice(records);
    bytes
}

/// One part of a tick whose `records` do not fit into one message; `None` where it has no such part.
pub(crate) fn piece(tick: u64, part: u32, records: &[u8]) -> Option<Vec<u8>> {
    let (at, room) = (part as usize, RECORDS * AGENT_STATE_BYTES);
    let piece = records.chunks(room).nth(at)?;
    let flags = if (at + 1) * room >= records.len() { LAST } else { 0 };
    let mut bytes = head(flags, part, tick, piece.len() / AGENT_STATE_BYTES);
    bytes.extend_from_slice(piece);
    Some(bytes)
}

/// Reads a message; `None` for one that is none of ours.
pub(crate) fn read(bytes: &[u8], agents: usize) -> Option<Part> {
    let (head, records) = bytes.split_at_checked(HEAD_BYTES)?;
    let word = |at: usize| head.get(at..at + 2)?.try_into().ok().map(u16::from_le_bytes);
    if u32::from(word(0)?) != VERSION {
        return None;
    }
    let flags = word(2)?;
    let part = head.get(4..8)?.try_into().ok().map(u32::from_le_bytes)?;
    let tick = head.get(8..16)?.try_into().ok().map(u64::from_le_bytes)?;
    if flags & OVER != 0 {
        return records.is_empty().then_some(Part::Over(tick));
    }
    let states = records_of(records)?;
    if states.is_empty() || agents == 0 {
        return None;
    }
    let last = flags & LAST != 0;
    if part == 0 && last {
        // Whole ticks that follow each other.
        let whole = states.len().is_multiple_of(agents)
            && (tick..).zip(states.chunks(agents)).all(|(tick, states)| states.iter().all(|state| state.tick == tick));
        return whole.then_some(Part::Ticks(states));
    }
    states.iter().all(|state| state.tick == tick).then_some(Part::Piece { tick, part, last, states })
}

/// Reads records; `None` when they are not whole.
pub(crate) fn records_of(bytes: &[u8]) -> Option<Vec<AgentState>> {
    bytes.chunks(AGENT_STATE_BYTES).map(AgentState::from_bytes).collect()
}

/// Puts the parts of large ticks together.
#[derive(Debug, Default)]
pub(crate) struct Joiner {
    tick: u64,
    parts: u32,
    states: Vec<AgentState>,
}

impl Joiner {
    /// Takes a part; gives the tick whose last part it is, if all before it came.
    pub(crate) fn join(
        &mut self,
        (tick, part, last): (u64, u32, bool),
        states: Vec<AgentState>,
        agents: usize,
    ) -> Option<Vec<AgentState>> {
        if part == 0 {
            *self = Self { tick, parts: 1, states };
        } else if tick == self.tick && part == self.parts {
            self.parts += 1;
            self.states.extend(states);
        } else {
            // One before it was lost: the tick is missing as a whole.
            *self = Self::default();
            return None;
        }
        if self.states.len() > agents {
            *self = Self::default();
            return None;
        }
        let whole = last && self.states.len() == agents;
        whole.then(|| std::mem::take(self).states)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(tick: u64, agent: u32) -> AgentState {
        AgentState { tick, agent, flags: 0, x: 0., y: 0., yaw: 0., vx: 0., vy: 0., omega: 0. }
    }

    fn bytes(states: &[AgentState]) -> Vec<u8> {
        states.iter().flat_map(AgentState::to_bytes).collect()
    }

    #[test]
    fn whole_ticks_come_back_and_what_is_not_whole_is_refused() {
        let states: Vec<AgentState> = (7..10).flat_map(|tick| [state(tick, 0), state(tick, 1)]).collect();
        let message = ticks(7, &bytes(&states));
        assert_eq!(read(&message, 2), Some(Part::Ticks(states)));
        assert_eq!(read(&message, 4), None, "six records are no ticks of four agents");
        for cut in 1..message.len() {
            let part = read(&message[..cut], 2);
            assert!(part.is_none() || (cut - HEAD_BYTES).is_multiple_of(128), "cut at {cut}: {part:?}");
        }
        let mut newer = message.clone();
        newer[0] = 3;
        assert_eq!(read(&newer, 2), None);
        assert_eq!(read(&over(12), 2), Some(Part::Over(12)));
        // Records of version 1 are a whole number of 64 bytes without a head.
        assert_eq!(read(&bytes(&[state(2, 0), state(2, 1)]), 2), None);
    }

    #[test]
    fn a_large_tick_is_put_together_or_missing_as_a_whole() {
        let all: Vec<AgentState> = (0..3_000).map(|agent| state(5, agent)).collect();
        let records = bytes(&all);
        let parts: Vec<Vec<u8>> = (0..).map_while(|part| piece(5, part, &records)).collect();
        assert_eq!(parts.len(), 4);
        let join = |joiner: &mut Joiner, message: &[u8]| match read(message, 3_000) {
            Some(Part::Piece { tick, part, last, states }) => joiner.join((tick, part, last), states, 3_000),
            other => panic!("{other:?}"),
        };
        let mut joiner = Joiner::default();
        let joined: Vec<_> = parts.iter().map(|message| join(&mut joiner, message)).collect();
        assert_eq!(joined, [None, None, None, Some(all)]);
        // One that is lost loses its tick.
        for lost in 0..4 {
            let mut joiner = Joiner::default();
            let came = parts.iter().enumerate().filter(|(place, _)| *place != lost);
            assert!(came.map(|(_, message)| join(&mut joiner, message)).all(|joined| joined.is_none()), "{lost}");
        }
    }
}
