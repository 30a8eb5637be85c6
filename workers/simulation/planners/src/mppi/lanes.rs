//! Numbers side by side: what the hot loops are written in, once for all sets of instructions.
//!
//! Every operation is an IEEE 754 addition, multiplication, division, square root, comparison or choice of each lane alone, and
//! nothing is fused. Wider registers do the same operations on more lanes at a time, so the processor changes the time a cycle takes
//! and no byte of its result. Sums over the batch run in [`LANES`] parts whatever the width.

use std::ops::{Add, Div, Mul, Neg, Sub};

use pulp::Simd;

/// Lanes of the widest registers: rows are padded to a multiple of it, and sums over a row run in so many parts.
pub(crate) const LANES: usize = 16;

/// The bit of an f32 that is its sign.
const SIGN: u32 = 1 << 31;

/// Instructions of the processor. They change the time a cycle takes and no byte of its result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Instructions {
    /// The widest vectors that the processor has, found out at run time.
    #[default]
    Detected,
    /// Vectors of 256 bits where an x86-64 processor has them (AVX2), else as [`Instructions::Baseline`].
    Avx2,
    /// One number at a time.
    Baseline,
    /// Sixteen at a time, as AVX-512 does, in whatever instructions there are: for processors that have none so wide.
    #[cfg(test)]
    Sixteen,
}

impl Instructions {
    pub(crate) fn arch(self) -> Arch {
        match self {
            Self::Detected => Arch::Native(pulp::Arch::new()),
            Self::Avx2 => Arch::Native(avx2()),
            Self::Baseline => Arch::Native(pulp::Arch::Scalar),
            #[cfg(test)]
            Self::Sixteen => Arch::Sixteen,
        }
    }
}

/// What runs the hot loops.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Arch {
    /// A set of instructions of this processor.
    Native(pulp::Arch),
    /// See [`Instructions::Sixteen`].
    #[cfg(test)]
    Sixteen,
}

impl Arch {
    /// Runs a loop.
    pub(crate) fn dispatch<P: pulp::WithSimd>(self, pass: P) -> P::Output {
        match self {
            Self::Native(arch) => arch.dispatch(pass),
            #[cfg(test)]
            Self::Sixteen => pass.with_simd(pulp::Scalar512b),
        }
    }
}

#[cfg(target_arch = "x86_64")]
fn avx2() -> pulp::Arch {
    pulp::x86::V3::try_new().map_or(pulp::Arch::Scalar, pulp::Arch::V3)
}

#[cfg(not(target_arch = "x86_64"))]
fn avx2() -> pulp::Arch {
    pulp::Arch::Scalar
}

/// Numbers side by side, as many as the instructions take at a time.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<S: Simd> {
    simd: S,
    /// The numbers themselves.
    pub(crate) raw: S::f32s,
}

/// A yes or no for each lane.
#[derive(Clone, Copy)]
pub(crate) struct Mask<S: Simd> {
    simd: S,
    /// The answers themselves.
    pub(crate) raw: S::m32s,
}

impl<S: Simd> Mask<S> {
    #[inline(always)]
    pub(crate) fn of(simd: S, raw: S::m32s) -> Self {
        Self { simd, raw }
    }

    #[inline(always)]
    pub(crate) fn and(self, other: Self) -> Self {
        Self { raw: self.simd.and_m32s(self.raw, other.raw), ..self }
    }

    /// One number where it is so, another where not.
    #[inline(always)]
    pub(crate) fn select(self, yes: Lanes<S>, no: Lanes<S>) -> Lanes<S> {
        Lanes { simd: self.simd, raw: self.simd.select_f32s(self.raw, yes.raw, no.raw) }
    }
}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, raw: S::f32s) -> Self {
        Self { simd, raw }
    }

    /// The same number in every lane.
    #[inline(always)]
    pub(crate) fn splat(simd: S, value: f32) -> Self {
        Self { simd, raw: simd.splat_f32s(value) }
    }

    #[inline(always)]
    pub(crate) fn like(self, value: f32) -> Self {
        Self::splat(self.simd, value)
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        // By its bits: pulp's own is not always inlined.
        self.with_bits(self.simd.and_u32s(self.bits(), self.simd.splat_u32s(!SIGN)))
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        Self { raw: self.simd.sqrt_f32s(self.raw), ..self }
    }

    #[inline(always)]
    pub(crate) fn below(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, raw: self.simd.less_than_f32s(self.raw, other.raw) }
    }

    #[inline(always)]
    pub(crate) fn at_most(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, raw: self.simd.less_than_or_equal_f32s(self.raw, other.raw) }
    }

    // Not those of the instruction sets, which differ for zeros of two signs and for what is no number.
    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        other.below(self).select(other, self)
    }

    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        self.below(other).select(other, self)
    }

    #[inline(always)]
    pub(crate) fn clamp(self, least: Self, most: Self) -> Self {
        self.max(least).min(most)
    }

    #[inline(always)]
    pub(crate) fn bits(self) -> S::u32s {
        self.simd.transmute_u32s_f32s(self.raw)
    }

    #[inline(always)]
    pub(crate) fn with_bits(self, bits: S::u32s) -> Self {
        Self { raw: self.simd.transmute_f32s_u32s(bits), ..self }
    }

    #[inline(always)]
    pub(crate) fn simd(self) -> S {
        self.simd
    }

    /// The numbers one by one; as many as there are lanes, then `beyond`.
    #[inline(always)]
    pub(crate) fn each(self, beyond: f32) -> [f32; LANES] {
        let mut each = [beyond; LANES];
        if let Some(first) = groups_mut::<S>(&mut each).next() {
            *first = self.raw;
        }
        each
    }

    /// A small whole power, as a product.
    #[inline(always)]
    pub(crate) fn power(self, power: u32) -> Self {
        (1..power).fold(self, |product, _| product * self)
    }
}

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { raw: self.simd.add_f32s(self.raw, other.raw), ..self }
    }
}

impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { raw: self.simd.sub_f32s(self.raw, other.raw), ..self }
    }
}

impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { raw: self.simd.mul_f32s(self.raw, other.raw), ..self }
    }
}

impl<S: Simd> Div for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self { raw: self.simd.div_f32s(self.raw, other.raw), ..self }
    }
}

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.with_bits(self.simd.xor_u32s(self.bits(), self.simd.splat_u32s(SIGN)))
    }
}

/// A row as groups of lanes; its length is a multiple of [`LANES`].
#[inline(always)]
pub(crate) fn groups<S: Simd>(simd: S, row: &[f32]) -> impl Iterator<Item = Lanes<S>> {
    S::as_simd_f32s(row).0.iter().map(move |raw| Lanes::new(simd, *raw))
}

/// The same, to be written.
#[inline(always)]
pub(crate) fn groups_mut<S: Simd>(row: &mut [f32]) -> std::slice::IterMut<'_, S::f32s> {
    S::as_mut_simd_f32s(row).0.iter_mut()
}

/// Adds numbers in [`LANES`] parts, then the parts in a fixed order.
#[derive(Clone, Copy, Default)]
pub(crate) struct Sum {
    parts: [f32; LANES],
}

impl Sum {
    /// Adds the products of two rows, lane by lane.
    #[inline(always)]
    pub(crate) fn of_products<S: Simd>(simd: S, a: &[f32], b: &[f32]) -> f32 {
        let mut sum = Self::default();
        for (a, b) in a.as_chunks::<LANES>().0.iter().zip(b.as_chunks::<LANES>().0) {
            let parts = groups_mut::<S>(&mut sum.parts);
            for ((part, a), b) in parts.zip(groups(simd, a)).zip(groups(simd, b)) {
                *part = (Lanes::new(simd, *part) + a * b).raw;
            }
        }
        sum.total()
    }

    /// Adds a row.
    #[inline(always)]
    pub(crate) fn of<S: Simd>(simd: S, row: &[f32]) -> f32 {
        let mut sum = Self::default();
        for chunk in row.as_chunks::<LANES>().0 {
            for (part, value) in groups_mut::<S>(&mut sum.parts).zip(groups(simd, chunk)) {
                *part = (Lanes::new(simd, *part) + value).raw;
            }
        }
        sum.total()
    }

    fn total(&self) -> f32 {
        self.parts.iter().sum()
    }
}
