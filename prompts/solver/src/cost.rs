//! What solutions are compared by: named weights in one currency, points; a solution with more points is better.
//!
//! Hard constraints are not here: whoever cannot be led as their relation demands has no way at all, and an edge that is too
//! narrow for the robot is no edge.

/// The weights, each with its reason.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Weights {
    /// A way that begins or ends where the task says by name, each: it outweighs everything else, so that no meeting, however
    /// well it lies, sends the robot elsewhere.
    pub(crate) named_end: f64,
    /// Per meter that an end is away from the place by name, where it cannot be there.
    pub(crate) off_end_per_m: f64,
    /// Per meter that a meeting is farther than `near_end_m` from the one end by name: the task stays where it is.
    pub(crate) astray_per_m: f64,
    /// See `astray_per_m`, m.
    pub(crate) near_end_m: f64,
    /// Per meter that a meeting lies off the shortest way between two ends by name: people come to the robot's way.
    pub(crate) off_way_per_m: f64,
    /// A way that is more than [`FARTHEST`] times the shortest: taken only where the task's own ends leave nothing else, so half
    /// of a named end, which leaves as much for the length.
    pub(crate) detour: f64,
    /// Per what a way is longer than the shortest, as a share of that: a tenth is worth 3 m of wished length.
    pub(crate) longer: f64,
    /// A way past the class of place that the task names: it is part of the task.
    pub(crate) via: f64,
    /// Each place of a meeting elsewhere that the way does not lead over: less than an end by name, more than a detour.
    pub(crate) elsewhere: f64,
    /// An end at a place of the class that is asked for.
    pub(crate) end_class: f64,
    /// Per meter that a way is shorter or longer than is wished.
    pub(crate) length_per_m: f64,
    /// Per meter that is missing before the meeting (of 5 m, to be seen) and after it (of 3 m, to get away).
    pub(crate) room_per_m: f64,
    /// A way straight over the meeting, as the cosine of the turn there.
    pub(crate) straight: f64,
    /// A turn back on the spot where they meet.
    pub(crate) turn_back: f64,
    /// A sharp turn elsewhere on the way.
    pub(crate) sharp_turn: f64,
    /// Each room on the way that the robot drives through.
    pub(crate) through_room: f64,
    /// Each node of the wished class of place on the way, beside the meeting.
    pub(crate) of_place: f64,
    /// An end in a room that nobody asked for.
    pub(crate) end_inside: f64,
    /// An end in a doorway, where others have to get through.
    pub(crate) end_doorway: f64,
}

/// The longest way of the robot that is natural, in lengths of the shortest.
pub(crate) const FARTHEST: f64 = 1.2;

/// The weights that are used.
pub(crate) const WEIGHTS: Weights = Weights {
    named_end: 60.0,
    off_end_per_m: 0.6,
    astray_per_m: 0.3,
    near_end_m: 12.0,
    off_way_per_m: 1.0,
    detour: 30.0,
    longer: 10.0,
    via: 6.0,
    elsewhere: 40.0,
    end_class: 4.0,
    length_per_m: 0.3,
    room_per_m: 2.0,
    straight: 3.0,
    turn_back: 6.0,
    sharp_turn: 4.0,
    through_room: 5.0,
    of_place: 0.3,
    end_inside: 4.0,
    end_doorway: 12.0,
};

impl Weights {
    /// What it costs that a way is so many times as long as the shortest.
    pub(crate) fn detours(&self, times: f64) -> f64 {
        let more = (times - 1.0).clamp(0.0, FARTHEST - 1.0);
        self.longer * more + if times > FARTHEST + 1e-9 { self.detour } else { 0.0 }
    }
}
