//! What some contact pairs need and others do not: nothing is held for the others.

/// Values of some pairs, by their numbers in the model.
#[derive(Debug)]
pub(super) struct PerPair<T> {
    /// Ascending.
    of: Vec<(usize, T)>,
}

impl<T> Default for PerPair<T> {
    fn default() -> Self {
        PerPair { of: Vec::new() }
    }
}

impl<T> PerPair<T> {
    /// The values that there are, one for each pair of the model in order.
    pub fn new(all: impl Iterator<Item = Option<T>>) -> Self {
        let all = all.enumerate();
        let mut of: Vec<_> = all.filter_map(|(pair, of)| Some((pair, of?))).collect();
        of.shrink_to_fit();
        PerPair { of }
    }

    /// Values with the numbers of their pairs, ascending.
    pub fn from(mut of: Vec<(usize, T)>) -> Self {
        of.shrink_to_fit();
        PerPair { of }
    }

    pub fn is_empty(&self) -> bool {
        self.of.is_empty()
    }

    fn place(&self, pair: usize) -> Option<usize> {
        self.of.binary_search_by_key(&pair, |(pair, _)| *pair).ok()
    }

    #[inline]
    pub fn get(&self, pair: usize) -> Option<&T> {
        self.place(pair).map(|at| &self.of[at].1)
    }

    #[inline]
    pub fn get_mut(&mut self, pair: usize) -> Option<&mut T> {
        let at = self.place(pair)?;
        Some(&mut self.of[at].1)
    }

    /// Bytes of heap that are held, `inner` being those of a value beside itself.
    pub fn bytes(&self, inner: impl Fn(&T) -> usize) -> usize {
        let values: usize = self.of.iter().map(|(_, of)| inner(of)).sum();
        self.of.capacity() * size_of::<(usize, T)>() + values
    }

    /// Sum of what values hold.
    pub fn inner(&self, of: impl Fn(&T) -> usize) -> usize {
        self.of.iter().map(|(_, value)| of(value)).sum()
    }

    /// Bytes of heap that a value takes beside what it holds itself.
    pub const HEAD: usize = size_of::<(usize, T)>();
}
