//! Laws of normal contact: gap in, traction and stiffness out. Chosen outside every loop.
use super::friction::history::PointHistory;
use super::kernel::Normal;
use super::kind::LawKind;

/// A law between the normal coordinate `xi3` (negative = penetration) and the normal traction.
pub trait NormalLaw: Sync {
    /// Traction of a point in contact at a normal coordinate, and its slope.
    fn response(&self, xi3: f64) -> Normal;

    /// Energy that the traction stores at a normal coordinate: its integral from where it vanishes (force / length).
    fn energy(&self, xi3: f64) -> f64;

    /// The gap that the law sees at a normal coordinate (length).
    #[inline]
    fn gap(&self, xi3: f64) -> f64 {
        xi3
    }

    /// Distance from an edge or a vertex within which the direction of the distance gives way to the pseudo-normal
    /// ([`super::corner::steady`]), at most `small` (length): as far as the traction left at no distance reaches. Zero for
    /// a penalty, whose force is smooth by itself.
    #[inline]
    fn steady_radius(&self, _small: f64) -> f64 {
        0.0
    }

    /// Whether a point at this normal coordinate is in contact.
    #[inline]
    fn closes(&self, xi3: f64) -> bool {
        xi3 < 0.0
    }

    /// Normal coordinate up to which a point may be in contact; zero or less: only below the surface (length).
    #[inline]
    fn reach(&self) -> f64 {
        0.0
    }
}

/// The law of a contact pair, between the gap and the traction: what wrappers shift and add multipliers to.
pub trait PairLaw: NormalLaw + Copy + Send + 'static {
    /// The law of a penalty; a larger penalty is a stiffer law.
    fn of(penalty: f64) -> Self;

    /// The gap at which the traction is `n`, continued to pulling tractions above the surface (length).
    fn gap_under(&self, n: f64) -> f64;
}

/// What the gaps of slave points are measured from: chosen outside the loop over points, nothing where there is none.
pub trait PointLaw: Sync {
    /// What the law is, for a penalty.
    const KIND: LawKind;
    /// The law of a single point.
    type Law<L: PairLaw>: NormalLaw;
    /// What the gap of point `index` is measured from (length).
    fn z0(&self, index: usize) -> f64;
    /// The law of point `index` of a pair.
    fn law<L: PairLaw>(&self, index: usize, law: &L) -> Self::Law<L>;
}

/// Gaps are normal coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoOffset;

impl PointLaw for NoOffset {
    const KIND: LawKind = LawKind::Penalty;
    type Law<L: PairLaw> = L;
    #[inline]
    fn z0(&self, _index: usize) -> f64 {
        0.0
    }
    #[inline]
    fn law<L: PairLaw>(&self, _index: usize, law: &L) -> L {
        *law
    }
}

/// The gap of point `i` is `xi3 - base - factor z0[i] - bow[i]`: the surface is thicker than it is modelled, an overclosure
/// `z0 <= 0` is not to be resolved, or flat facets stand for a curved surface that lies `bow` off them.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Offsets<'a> {
    /// Distance from the surface at which contact begins (length, `>= 0`).
    pub base: f64,
    /// Per point of the pair, zero or negative (length); empty where all are zero.
    pub z0: &'a [f64],
    /// Part of `z0` that gaps are measured from, from 1 (all of it) to 0.
    pub factor: f64,
    /// Per point of the pair (length); empty where all are zero.
    pub bow: &'a [f64],
}

impl Offsets<'_> {
    /// What the gap of a point is measured from (length).
    #[inline]
    pub fn at(&self, index: usize) -> f64 {
        let over = self.z0.get(index).map_or(0.0, |z0| self.factor * z0);
        self.base + over + self.bow.get(index).copied().unwrap_or(0.0)
    }
}

impl PointLaw for Offsets<'_> {
    const KIND: LawKind = LawKind::Offset;
    type Law<L: PairLaw> = Shifted<L>;
    #[inline]
    fn z0(&self, index: usize) -> f64 {
        self.at(index)
    }
    #[inline]
    fn law<L: PairLaw>(&self, index: usize, law: &L) -> Shifted<L> {
        Shifted {
            law: *law,
            z0: self.at(index),
        }
    }
}

/// A law of the gap `xi3 - z0`; the geometry keeps the true `xi3`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shifted<L> {
    /// The law of the shifted gap.
    pub law: L,
    /// Length; positive where contact begins in front of the surface.
    pub z0: f64,
}

impl<L: NormalLaw> NormalLaw for Shifted<L> {
    #[inline]
    fn response(&self, xi3: f64) -> Normal {
        self.law.response(xi3 - self.z0)
    }
    #[inline]
    fn energy(&self, xi3: f64) -> f64 {
        self.law.energy(xi3 - self.z0)
    }
    #[inline]
    fn gap(&self, xi3: f64) -> f64 {
        xi3 - self.z0
    }
    #[inline]
    fn closes(&self, xi3: f64) -> bool {
        xi3 < self.z0
    }
    #[inline]
    fn reach(&self) -> f64 {
        self.z0
    }
    #[inline]
    fn steady_radius(&self, small: f64) -> f64 {
        self.response(0.0).extent().min(small)
    }
}

/// Points of a pair with normal multipliers, and what their gaps are measured from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Multipliers<'a> {
    /// Per point of the pair.
    pub histories: &'a [PointHistory],
    /// What gaps are measured from; none: from the surface.
    pub offsets: Option<Offsets<'a>>,
}

impl PointLaw for Multipliers<'_> {
    const KIND: LawKind = LawKind::Multipliers;
    type Law<L: PairLaw> = Augmented<L>;
    #[inline]
    fn z0(&self, index: usize) -> f64 {
        self.offsets.map_or(0.0, |o| o.at(index))
    }
    #[inline]
    fn law<L: PairLaw>(&self, index: usize, law: &L) -> Augmented<L> {
        Augmented {
            law: *law,
            z0: self.offsets.map_or(0.0, |o| o.at(index)),
            lambda_n: self.histories[index].lambda_n,
            held: false,
        }
    }
}

/// Points that stay in contact wherever they are, for a first linearisation; what their gaps are measured from is as ever.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Held<'a> {
    /// Per point of the pair.
    pub held: &'a [bool],
    /// Per point of the pair; empty without multipliers.
    pub histories: &'a [PointHistory],
    /// What gaps are measured from; none: from the surface.
    pub offsets: Option<Offsets<'a>>,
}

impl PointLaw for Held<'_> {
    const KIND: LawKind = LawKind::Held;
    type Law<L: PairLaw> = Augmented<L>;
    #[inline]
    fn z0(&self, index: usize) -> f64 {
        self.offsets.map_or(0.0, |o| o.at(index))
    }
    #[inline]
    fn law<L: PairLaw>(&self, index: usize, law: &L) -> Augmented<L> {
        Augmented {
            law: *law,
            z0: self.offsets.map_or(0.0, |o| o.at(index)),
            lambda_n: self.histories.get(index).map_or(0.0, |h| h.lambda_n),
            held: self.held[index],
        }
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
    fn response(&self, xi3: f64) -> Normal {
        Normal {
            n: self.eps_n * xi3,
            dn: self.eps_n,
        }
    }
    #[inline]
    fn energy(&self, xi3: f64) -> f64 {
        0.5 * self.eps_n * xi3 * xi3
    }
}

impl PairLaw for Penalty {
    #[inline]
    fn of(penalty: f64) -> Self {
        Penalty { eps_n: penalty }
    }
    #[inline]
    fn gap_under(&self, n: f64) -> f64 {
        n / self.eps_n
    }
}

impl Normal {
    /// Distance over which the traction would vanish at its slope; nothing where there is no traction (length).
    #[inline]
    fn extent(&self) -> f64 {
        match self.n == 0.0 {
            true => 0.0,
            false => (self.n / self.dn).abs(),
        }
    }
}

/// The law of a point with history: `N = lambda_n + N(xi3 - z0)`, open where that would pull. With a multiplier a point may
/// be in contact slightly above the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Augmented<L = Penalty> {
    /// The law of the penalty, without its multiplier.
    pub law: L,
    /// What the gap is measured from (length).
    pub z0: f64,
    /// Multiplier of the normal traction, `<= 0`; zero without augmentation (force / length^2).
    pub lambda_n: f64,
    /// The point is in contact even where it is pulled: its first linearisation brings it back to the surface.
    pub held: bool,
}

impl<L: PairLaw> NormalLaw for Augmented<L> {
    #[inline]
    fn response(&self, xi3: f64) -> Normal {
        let Normal { n, dn } = self.law.response(xi3 - self.z0);
        Normal {
            n: self.lambda_n + n,
            dn,
        }
    }
    #[inline]
    fn energy(&self, xi3: f64) -> f64 {
        let (gap, free) = (xi3 - self.z0, self.law.gap_under(-self.lambda_n));
        self.lambda_n * (gap - free) + self.law.energy(gap) - self.law.energy(free)
    }
    #[inline]
    fn gap(&self, xi3: f64) -> f64 {
        xi3 - self.z0
    }
    #[inline]
    fn closes(&self, xi3: f64) -> bool {
        self.held || self.response(xi3).n < 0.0
    }
    #[inline]
    fn reach(&self) -> f64 {
        self.z0 + self.law.gap_under(-self.lambda_n)
    }
    #[inline]
    fn steady_radius(&self, small: f64) -> f64 {
        self.response(0.0).extent().min(small)
    }
}
