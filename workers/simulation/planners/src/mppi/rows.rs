//! A number of every sample at every step, one row per step.

use super::lanes::LANES;

/// Rows of one length each, the steps of a batch one after the other. A row is padded to a multiple of the widest lanes; what is
/// beyond the batch is never counted.
#[derive(Debug, Clone, Default)]
pub(crate) struct Rows {
    len: usize,
    values: Vec<f32>,
}

/// The length of a row for so many samples.
pub(crate) const fn padded(batch: usize) -> usize {
    batch.next_multiple_of(LANES)
}

impl Rows {
    /// Zeros.
    pub(crate) fn zeros(batch: usize, steps: usize) -> Self {
        let len = padded(batch).max(LANES);
        Self { len, values: vec![0.0; len.saturating_mul(steps)] }
    }

    /// No rows at all.
    pub(crate) fn none() -> Self {
        Self { len: LANES, values: Vec::new() }
    }

    /// The rows in order.
    pub(crate) fn iter(&self) -> std::slice::ChunksExact<'_, f32> {
        self.values.chunks_exact(self.len)
    }

    /// The rows in order, to be written.
    pub(crate) fn iter_mut(&mut self) -> std::slice::ChunksExactMut<'_, f32> {
        self.values.chunks_exact_mut(self.len)
    }

    /// One row; empty where there is none.
    pub(crate) fn row(&self, step: usize) -> &[f32] {
        let from = step.saturating_mul(self.len);
        self.values.get(from..from.saturating_add(self.len)).unwrap_or_default()
    }

    /// One row, to be written; empty where there is none.
    pub(crate) fn row_mut(&mut self, step: usize) -> &mut [f32] {
        let from = step.saturating_mul(self.len);
        self.values.get_mut(from..from.saturating_add(self.len)).unwrap_or_default()
    }

    /// The row before one and that one; both empty where there are no two.
    pub(crate) fn pair_mut(&mut self, step: usize) -> (&[f32], &mut [f32]) {
        let from = step.saturating_mul(self.len);
        let Some((before, rest)) = self.values.split_at_mut_checked(from) else { return (&[], &mut []) };
        let before = from.checked_sub(self.len).and_then(|start| before.get(start..)).unwrap_or_default();
        (before, rest.get_mut(..self.len).unwrap_or_default())
    }

    /// The last row.
    pub(crate) fn last(&self) -> &[f32] {
        self.iter().next_back().unwrap_or_default()
    }

    /// Where the memory is and how much of it there is, so that a test sees that none is taken.
    #[cfg(test)]
    pub(crate) fn memory(&self) -> (usize, usize) {
        (self.values.as_ptr() as usize, self.values.capacity())
    }
}
