//! Frames as the page gets them: 32 bytes and a record of 16 bytes for each agent. Pure.
//!
//! ```text
//! magic u16 = 0x4353 · version u8 = 1 · record bytes u8 = 16 · tick u64 · number u32 · records u32 · time f64 · flags u32
//! x f32 · y f32 · yaw i16 [π/32768 rad] · speed u16 [mm/s] · agent u16 · flags u16 [gesture 0-3, there 4, sees the robot 5, leaf 8-15]
//! 360 × range u16 [mm, 65535 nothing], where the flags say so
//! ```
//!
//! Every frame is whole, so one that is left out costs nothing. It is encoded once for all viewers.

use std::f64::consts::PI;

use bytes::Bytes;
use socrates_model::AgentState;

/// First two bytes of a frame.
pub const MAGIC: u16 = 0x4353;
/// Version of the frames.
pub const VERSION: u8 = 1;
/// Bytes before the records.
pub const HEAD_BYTES: usize = 32;
/// Bytes of a record.
pub const RECORD_BYTES: usize = 16;
/// Flag of a frame: a scan follows the records.
const HAS_SCAN: u32 = 1;
/// Flag of a record: the agent is there.
const THERE: u16 = 1 << 4;
/// Flag of a record: the agent sees the robot.
const SEES: u16 = 1 << 5;
/// Leaf of an agent whose leaf has no number that fits.
const NO_LEAF: u16 = 255;
/// Range of a beam that meets nothing.
const NOTHING: u16 = u16::MAX;

/// One tick with what viewers see of it besides the states.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sights {
    /// Whether each agent sees the robot, in the order of the states; shorter where nobody looked.
    pub sees: Vec<bool>,
    /// Ranges of the robot's lidar, m, beam 0 straight ahead, then counter-clockwise; empty where there is none.
    pub scan: Vec<f64>,
    /// Longest range of the lidar, m: a beam that reads it met nothing.
    pub range_m: f64,
}

/// A frame that was encoded once for everybody.
#[derive(Debug, Clone)]
pub struct Frame {
    /// Its tick.
    pub tick: u64,
    /// Its number in the stream.
    pub number: u32,
    /// The states, for other encodings.
    pub states: Vec<AgentState>,
    /// What is seen besides them.
    pub sights: Sights,
    /// As the page gets it.
    pub bytes: Bytes,
}

/// A number held to what two bytes hold.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "held to the range before")]
fn word(number: f64) -> u16 {
    if number.is_nan() { 0 } else { number.clamp(0.0, f64::from(u16::MAX)) as u16 }
}

/// A heading as a share of a half turn.
#[expect(clippy::cast_possible_truncation, reason = "wrapped to half a turn before")]
fn heading(yaw: f64) -> i16 {
    if !yaw.is_finite() {
        return 0;
    }
    let share = socrates_model::geometry::wrap_angle(yaw) / PI * 32_768.0;
    share.clamp(-32_768.0, 32_767.0) as i16
}

/// Writes the frame of a tick. `number` counts the frames of a stream; `absent` is the leaf of those who are not there.
#[must_use]
pub fn encode(number: u32, time_s: f64, states: &[AgentState], absent: Option<u16>, sights: &Sights) -> Vec<u8> {
    let scan = &sights.scan;
    let mut bytes = Vec::with_capacity(HEAD_BYTES + states.len() * RECORD_BYTES + scan.len() * 2);
    bytes.extend_from_slice(&MAGIC.to_le_bytes());
    bytes.extend_from_slice(&[VERSION, 16]);
    bytes.extend_from_slice(&states.first().map_or(0, |state| state.tick).to_le_bytes());
    bytes.extend_from_slice(&number.to_le_bytes());
    bytes.extend_from_slice(&u32::try_from(states.len()).unwrap_or(u32::MAX).to_le_bytes());
    bytes.extend_from_slice(&time_s.to_le_bytes());
    bytes.extend_from_slice(&u32::from(!scan.is_empty()).wrapping_mul(HAS_SCAN).to_le_bytes());
    let looked = sights.sees.iter().copied().chain(std::iter::repeat(false));
    for (state, sees) in states.iter().zip(looked) {
        let leaf = u8::try_from(state.leaf()).map_or(NO_LEAF, u16::from);
        let gesture = u16::try_from((state.flags >> 8) & 0xf).unwrap_or(0);
        let there = if state.is_there(absent) { THERE } else { 0 };
        let flags = gesture | there | if sees { SEES } else { 0 } | (leaf << 8);
        #[expect(clippy::cast_possible_truncation, reason = "a picture needs no more than seven digits")]
        let (x, y) = (state.x as f32, state.y as f32);
        bytes.extend_from_slice(&x.to_le_bytes());
        bytes.extend_from_slice(&y.to_le_bytes());
        bytes.extend_from_slice(&heading(state.yaw).to_le_bytes());
        bytes.extend_from_slice(&word(state.speed() * 1_000.0).to_le_bytes());
        bytes.extend_from_slice(&u16::try_from(state.agent).unwrap_or(u16::MAX).to_le_bytes());
        bytes.extend_from_slice(&flags.to_le_bytes());
    }
    for range in scan {
        let told = if *range < sights.range_m { word(range * 1_000.0).min(NOTHING - 1) } else { NOTHING };
        bytes.extend_from_slice(&told.to_le_bytes());
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_has_the_bytes_of_its_description() {
        let state = AgentState {
            tick: 7,
            agent: 2,
            flags: 1 | (4 << 8) | (3 << 16),
            x: 1.5,
            y: -2.0,
            yaw: -PI / 2.0,
            vx: 0.3,
            vy: 0.4,
            omega: 0.0,
        };
        let away = AgentState { agent: 70_000, flags: 1 | (9 << 16), x: f64::NAN, ..state };
        let sights = Sights { sees: vec![true], scan: vec![0.25, 10.0, 66.0], range_m: 10.0 };
        let bytes = encode(5, 0.07, &[state, away], Some(9), &sights);
        assert_eq!(bytes.len(), 32 + 2 * 16 + 3 * 2);
        assert_eq!(&bytes[..4], [0x53, 0x43, 1, 16]);
        assert_eq!(u64::from_le_bytes(bytes[4..12].try_into().unwrap()), 7);
        assert_eq!((bytes[12], bytes[16], bytes[28]), (5, 2, 1));
        assert_eq!(bytes[20..28], 0.07_f64.to_le_bytes());
        assert_eq!(bytes[32..36], 1.5_f32.to_le_bytes());
        assert_eq!(i16::from_le_bytes(bytes[40..42].try_into().unwrap()), -16_384);
        assert_eq!(u16::from_le_bytes(bytes[42..44].try_into().unwrap()), 500);
        assert_eq!(u16::from_le_bytes(bytes[44..46].try_into().unwrap()), 2);
        assert_eq!(u16::from_le_bytes(bytes[46..48].try_into().unwrap()), 4 | THERE | SEES | (3 << 8));
        // Somebody who is not there keeps a record, so that everybody has a place.
        assert_eq!(u16::from_le_bytes(bytes[60..62].try_into().unwrap()), u16::MAX);
        assert_eq!(u16::from_le_bytes(bytes[62..64].try_into().unwrap()) & (THERE | SEES), 0);
        assert_eq!(bytes[64..], [250, 0, 255, 255, 255, 255]);
    }
}
