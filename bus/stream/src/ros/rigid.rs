//! Where one frame stands in another: a shift and a turn in space. Sensors look along an axis of their own, so that the plane
//! is enough only at the end.

/// Quaternions with a smaller squared length are none: they were never set.
const UNSET: f64 = 1e-6;
/// Cosine of half the turn between two quaternions from which on a straight line between them is as good as an arc.
const NEAR: f64 = 0.9995;

/// A quaternion x, y, z, w of length one.
type Turn = [f64; 4];

/// A frame in another one, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rigid {
    pub(super) shift: [f64; 3],
    turn: Turn,
}

impl Rigid {
    /// The frame itself.
    pub(super) const HERE: Self = Self { shift: [0.0; 3], turn: [0.0, 0.0, 0.0, 1.0] };

    /// A shift without a turn.
    pub(super) const fn shifted(shift: [f64; 3]) -> Self {
        Self { shift, ..Self::HERE }
    }

    /// A shift and a turn; nothing where the quaternion was never set or a number is none.
    pub(super) fn new(shift: [f64; 3], turn: Turn) -> Option<Self> {
        let length2: f64 = turn.iter().map(|part| part * part).sum();
        let finite = shift.iter().chain(&turn).all(|part| part.is_finite()) && length2.is_finite();
        let length = length2.sqrt();
        (finite && length2 > UNSET).then(|| Self { shift, turn: turn.map(|part| part / length) })
    }

    /// The same place, turned about the vertical axis alone, rad.
    pub(super) fn facing(self, yaw: f64) -> Self {
        Self { turn: [0.0, 0.0, libm::sin(yaw / 2.0), libm::cos(yaw / 2.0)], ..self }
    }

    /// What stands at `inner` in this frame, in the frame that this one stands in.
    pub(super) fn then(&self, inner: &Self) -> Self {
        let [x, y, z] = turned(self.turn, inner.shift);
        let [sx, sy, sz] = self.shift;
        Self { shift: [sx + x, sy + y, sz + z], turn: product(self.turn, inner.turn) }
    }

    /// The outer frame in this one.
    pub(super) fn inverse(&self) -> Self {
        let [x, y, z, w] = self.turn;
        let turn = [-x, -y, -z, w];
        let [sx, sy, sz] = self.shift;
        Self { shift: turned(turn, [-sx, -sy, -sz]), turn }
    }

    /// Between this at 0 and another at 1: on a straight line, along the shorter arc.
    pub(super) fn towards(&self, other: &Self, share: f64) -> Self {
        let line = |(a, b): (&f64, &f64)| a + (b - a) * share;
        let [a, b, c] = self.shift;
        let [d, e, f] = other.shift;
        let shift = [line((&a, &d)), line((&b, &e)), line((&c, &f))];
        let cosine: f64 = self.turn.iter().zip(&other.turn).map(|(a, b)| a * b).sum();
        let (sign, cosine) = if cosine < 0.0 { (-1.0, -cosine) } else { (1.0, cosine) };
        let (first, second) = if cosine > NEAR {
            (1.0 - share, share)
        } else {
            let arc = libm::acos(cosine);
            let whole = libm::sin(arc);
            (libm::sin((1.0 - share) * arc) / whole, libm::sin(share * arc) / whole)
        };
        let [ax, ay, az, aw] = self.turn.map(|part| part * first);
        let [bx, by, bz, bw] = other.turn.map(|part| part * second * sign);
        Self::new(shift, [ax + bx, ay + by, az + bz, aw + bw]).unwrap_or(Self { shift, turn: self.turn })
    }

    /// The turn about the vertical axis, rad from -π to π.
    pub(super) fn yaw(&self) -> f64 {
        let [x, y, z, w] = self.turn;
        libm::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    }

    /// Whether there is no turn at all, as in messages that leave it out.
    pub(super) fn is_unturned(&self) -> bool {
        let [x, y, z, _w] = self.turn;
        x * x + y * y + z * z < UNSET * UNSET
    }
}

fn product(a: Turn, b: Turn) -> Turn {
    let ([ax, ay, az, aw], [bx, by, bz, bw]) = (a, b);
    [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]
}

fn turned(turn: Turn, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let [qx, qy, qz, w] = turn;
    // Twice the cross product of axis and vector, and of axis and that.
    let (tx, ty, tz) = (2.0 * (qy * z - qz * y), 2.0 * (qz * x - qx * z), 2.0 * (qx * y - qy * x));
    [x + w * tx + qy * tz - qz * ty, y + w * ty + qz * tx - qx * tz, z + w * tz + qx * ty - qy * tx]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    fn near(a: [f64; 3], b: [f64; 3]) -> bool {
        a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12)
    }

    #[test]
    fn a_frame_in_a_turned_frame_goes_with_it_and_back() {
        let map_from_odom = Rigid::shifted([1.0, 2.0, 0.5]).facing(FRAC_PI_2);
        let placed = map_from_odom.then(&Rigid::shifted([3.0, 0.0, 0.0]).facing(FRAC_PI_4));
        assert!(near(placed.shift, [1.0, 5.0, 0.5]) && (placed.yaw() - 0.75 * std::f64::consts::PI).abs() < 1e-12);
        let back = map_from_odom.inverse().then(&placed);
        assert!(near(back.shift, [3.0, 0.0, 0.0]) && (back.yaw() - FRAC_PI_4).abs() < 1e-12);
    }

    #[test]
    fn what_an_optical_frame_sees_ahead_is_ahead_of_the_camera() {
        // As REP 103 has it: z ahead, x to the right, y down.
        let optical = Rigid::new([0.2, 0.0, 1.0], [-0.5, 0.5, -0.5, 0.5]).unwrap();
        let seen = optical.then(&Rigid::shifted([-1.0, 0.3, 4.0]));
        assert!(near(seen.shift, [4.2, 1.0, 0.7]), "{:?}", seen.shift);
    }

    #[test]
    fn between_two_turns_the_shorter_arc_is_taken() {
        let (a, b) = (Rigid::HERE.facing(3.0), Rigid::shifted([2.0, 0.0, 0.0]).facing(-3.0));
        let half = a.towards(&b, 0.5);
        assert!(near(half.shift, [1.0, 0.0, 0.0]) && (half.yaw().abs() - std::f64::consts::PI).abs() < 1e-12);
        let quarter = Rigid::HERE.towards(&Rigid::HERE.facing(2.0), 0.25);
        assert!((quarter.yaw() - 0.5).abs() < 1e-12);
    }

    #[test]
    fn a_turn_that_was_never_set_is_none() {
        assert_eq!(Rigid::new([0.0; 3], [0.0; 4]), None);
        assert_eq!(Rigid::new([0.0; 3], [0.0, 0.0, f64::NAN, 1.0]), None);
        assert_eq!(Rigid::new([f64::INFINITY, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]), None);
        assert!(Rigid::new([0.0; 3], [0.0, 0.0, 0.0, 2.0]).is_some_and(|turn| turn.is_unturned()));
    }
}
