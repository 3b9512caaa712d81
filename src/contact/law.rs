//! Laws of normal contact: gap in, traction and stiffness out. Chosen outside every loop.
use super::kernel::Normal;

/// A law between the normal coordinate `xi3` (negative = penetration) and the normal traction.
pub trait NormalLaw: Sync {
    /// Traction at a point in contact.
    fn normal(&self, xi3: f64) -> Normal;

    /// The gap that the law sees at a normal coordinate (length).
    #[inline]
    fn gap(&self, xi3: f64) -> f64 {
        xi3
    }

    /// Whether a point at this normal coordinate is in contact.
    #[inline]
    fn closes(&self, xi3: f64) -> bool {
        xi3 < 0.0
    }
}

/// What the gaps of slave points are measured from: chosen outside the loop over points, nothing where there is none.
pub trait GapOffset: Sync {
    /// The law of a single point.
    type Law<L: NormalLaw>: NormalLaw;
    /// The law of point `index` of a pair.
    fn law<L: NormalLaw + Copy>(&self, index: usize, law: &L) -> Self::Law<L>;
}

/// Gaps are normal coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoOffset;

impl GapOffset for NoOffset {
    type Law<L: NormalLaw> = L;
    #[inline]
    fn law<L: NormalLaw + Copy>(&self, _index: usize, law: &L) -> L {
        *law
    }
}

/// The gap of point `i` is `xi3 - factor z0[i]` with `z0 <= 0`, an overclosure that is not to be resolved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Offsets<'a> {
    /// Per point of the pair, zero or negative (length).
    pub z0: &'a [f64],
    pub factor: f64,
}

impl Offsets<'_> {
    /// What the gap of a point is measured from (length).
    #[inline]
    pub fn at(&self, index: usize) -> f64 {
        self.factor * self.z0[index]
    }
}

impl GapOffset for Offsets<'_> {
    type Law<L: NormalLaw> = Shifted<L>;
    #[inline]
    fn law<L: NormalLaw + Copy>(&self, index: usize, law: &L) -> Shifted<L> {
        Shifted {
            law: *law,
            z0: self.at(index),
        }
    }
}

/// A law of the gap `xi3 - z0`; the geometry keeps the true `xi3`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shifted<L> {
    pub law: L,
    /// Zero or negative (length).
    pub z0: f64,
}

impl<L: NormalLaw> NormalLaw for Shifted<L> {
    #[inline]
    fn normal(&self, xi3: f64) -> Normal {
        self.law.normal(xi3 - self.z0)
    }
    #[inline]
    fn gap(&self, xi3: f64) -> f64 {
        xi3 - self.z0
    }
    #[inline]
    fn closes(&self, xi3: f64) -> bool {
        xi3 < self.z0
    }
}

/// Penalty: `N = eps_n xi3`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Penalty {
    /// Pressure per penetration (force / length^3).
    pub eps_n: f64,
}

impl NormalLaw for Penalty {
    #[inline]
    fn normal(&self, xi3: f64) -> Normal {
        Normal {
            n: self.eps_n * xi3,
            dn: self.eps_n,
        }
    }
}

/// The penalty law of a point with history: `N = lambda_n + eps_n (xi3 - z0)`, open where that would pull.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Augmented {
    /// Pressure per penetration (force / length^3).
    pub eps_n: f64,
    /// What the gap is measured from (length).
    pub z0: f64,
    /// Multiplier of the normal traction, `<= 0`; zero without augmentation (force / length^2).
    pub lambda_n: f64,
}

impl NormalLaw for Augmented {
    #[inline]
    fn normal(&self, xi3: f64) -> Normal {
        Normal {
            n: self.lambda_n + self.eps_n * (xi3 - self.z0),
            dn: self.eps_n,
        }
    }
    #[inline]
    fn gap(&self, xi3: f64) -> f64 {
        xi3 - self.z0
    }
    #[inline]
    fn closes(&self, xi3: f64) -> bool {
        self.lambda_n + self.eps_n * (xi3 - self.z0) < 0.0
    }
}
