//! Elastic and elastoplastic laws between Green-Lagrange strain and second Piola-Kirchhoff stress.
//!
//! A law is evaluated in any frame: strain in covariant components `E_ij` (Voigt order 11, 22, 33, 12, 23, 13, shears
//! `2 E_ij`), stress in contravariant components `S^ij`, and the metric of the undeformed frame ties them together. In
//! Cartesian axes ([`Metric::CARTESIAN`]) these are the usual components.
//!
//! Source of the formulas: J. Bonet and R. D. Wood, *Nonlinear Continuum Mechanics for Finite Element Analysis*, 2008,
//! chapter 6, here in convected components.
mod dashpot;
mod hardening;
mod hencky;
mod hill;
mod j2;
mod kinematic;
mod logarithm;
mod neo_hooke;
mod st_venant_kirchhoff;
mod tensor;

use super::error::ShellError;
use super::history::{Flow, PlasticWork};
use crate::scene::{Elastic, Material};
pub use dashpot::{Dashpot, DashpotState};
pub use hardening::Hardening;
pub use hencky::Hencky;
pub use hill::{Hill48, Hill48State};
pub use j2::{J2, J2State};
pub use kinematic::{ArmstrongFrederick, ArmstrongFrederickState};
pub use neo_hooke::NeoHooke;
use num_dual::DualNum;
pub use st_venant_kirchhoff::StVenantKirchhoff;
pub(in crate::shell) use tensor::{cauchy_green, invariants, inverse, isotropic, mixed};

/// Part of the yield stress by which it may be exceeded without flow. A step starts where the one before has ended: on the
/// yield surface, but for rounding, wherever the material flowed. Its first tangent is the elastic one there, which holds for
/// unloading; that of flow would let a body that unloads give way without end, and rounding would choose between them.
const AT_YIELD: f64 = 1e-9;
/// Part of the yield stress from which on a point counts as flowing where a step starts.
const YIELDS: f64 = 0.98;

/// What the size of an element in memory depends on, of its law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Memory {
    /// Numbers that a point remembers.
    pub numbers: usize,
    /// Whether the tangent of the law is symmetric.
    pub symmetric: bool,
}

impl Memory {
    /// Of an elastic law.
    pub const NONE: Memory = Memory {
        numbers: 0,
        symmetric: true,
    };

    /// That of a material.
    pub fn of(material: &Material) -> Memory {
        let numbers = match material {
            Material::StVenantKirchhoff(_) | Material::NeoHooke(_) | Material::Hencky(_) => 0,
            Material::J2(_) => J2State::LEN,
            Material::Hill48(_) => Hill48State::LEN,
            Material::ArmstrongFrederick(_) => ArmstrongFrederickState::LEN,
        };
        Memory {
            numbers,
            symmetric: material.is_symmetric(),
        }
    }

    /// Whether the law may flow.
    pub const fn flows(self) -> bool {
        self.numbers > 0
    }
}

/// Metric of the undeformed frame: covariant `G_ij` and contravariant `G^ij`, in Voigt order without factors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Metric {
    /// Covariant components `G_ij`.
    pub lower: [f64; 6],
    /// Contravariant components `G^ij`.
    pub upper: [f64; 6],
}

impl Metric {
    /// Cartesian axes.
    pub const CARTESIAN: Metric = Metric {
        lower: [1.0, 1.0, 1.0, 0.0, 0.0, 0.0],
        upper: [1.0, 1.0, 1.0, 0.0, 0.0, 0.0],
    };

    /// From the covariant metric; it must be positive definite.
    pub fn new(lower: [f64; 6]) -> Metric {
        let (upper, _) = inverse(&lower);
        Metric { lower, upper }
    }
}

/// The strain is one that no deformation has: C = G + 2E is not positive definite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Collapsed {
    /// det C / det G.
    pub ratio: f64,
}

/// Energy density, stress and tangent at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Energy per undeformed volume.
    pub energy: f64,
    /// `S^ij` (force per undeformed area).
    pub stress: [f64; 6],
    /// `dS^ij / dE_kl` against Voigt strains, row by row; symmetric if the law is.
    pub tangent: [[f64; 6]; 6],
}

/// What a material point remembers of the accepted steps, and of the axes of its material: plain numbers, zero where the law does
/// not say otherwise ([`MaterialLaw::start`]).
pub trait LawState: Copy + Send + Sync {
    /// How many numbers.
    const LEN: usize;
    /// That of a point which nothing has happened to.
    const UNUSED: Self;
    /// From [`LawState::LEN`] numbers.
    fn read(from: &[f64]) -> Self;
    /// Into [`LawState::LEN`] numbers.
    fn write(&self, to: &mut [f64]);
}

/// Elastic laws remember nothing.
impl LawState for () {
    const LEN: usize = 0;
    const UNUSED: () = ();
    #[inline(always)]
    fn read(_: &[f64]) {}
    #[inline(always)]
    fn write(&self, _: &mut [f64]) {}
}

/// The state of point `point` among the states of an element's points.
#[inline(always)]
pub(super) fn state_of<L: MaterialLaw>(states: &[f64], point: usize) -> L::State {
    L::State::read(&states[point * L::State::LEN..][..L::State::LEN])
}

/// A law whose stress is the gradient of an energy at constant `old`, the state at the end of the last accepted step, unless its
/// tangent is not symmetric. Energy and stress are generic over the scalar, so that dual numbers can check derivatives.
pub trait MaterialLaw: Copy + Send + Sync {
    /// What a point remembers between steps.
    type State: LawState;

    /// The state of a point that nothing has happened to, whose undeformed frame has these vectors in space, the first two along
    /// the sheet.
    fn start(&self, _frame: &[[f64; 3]; 3]) -> Self::State {
        Self::State::UNUSED
    }

    /// Whether its tangents are symmetric.
    #[inline(always)]
    fn symmetric(&self) -> bool {
        true
    }

    /// Energy per undeformed volume.
    ///
    /// # Errors
    /// [`Collapsed`] where C is not positive definite.
    fn energy<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
        old: &Self::State,
    ) -> Result<D, Collapsed>;

    /// Energy density and stress.
    ///
    /// # Errors
    /// [`Collapsed`] where C is not positive definite.
    fn stress<D: DualNum<f64> + Copy>(
        &self,
        metric: &Metric,
        strain: &[D; 6],
        old: &Self::State,
    ) -> Result<(D, [D; 6]), Collapsed>;

    /// Energy density, stress and tangent.
    ///
    /// # Errors
    /// [`Collapsed`] where C is not positive definite.
    fn response(
        &self,
        metric: &Metric,
        strain: &[f64; 6],
        old: &Self::State,
    ) -> Result<Response, Collapsed>;

    /// The state at the end of a step that is accepted at this strain.
    ///
    /// # Errors
    /// [`Collapsed`] where C is not positive definite.
    fn advance(
        &self,
        _metric: &Metric,
        _strain: &[f64; 6],
        old: &Self::State,
    ) -> Result<Self::State, Collapsed> {
        Ok(*old)
    }

    /// How a point flowed from one state to the next, per undeformed volume.
    fn flow(&self, _metric: &Metric, _old: &Self::State, _new: &Self::State) -> Flow {
        Flow::default()
    }

    /// Equivalent plastic strain, and equivalent stress over yield stress, of a point.
    fn flow_measures(&self, _metric: &Metric, _state: &Self::State) -> [f64; 2] {
        [0.0; 2]
    }

    /// What flow has taken of the work on a point, per undeformed volume.
    fn plastic_work(&self, _state: &Self::State) -> PlasticWork {
        PlasticWork::default()
    }
}

/// A law chosen at run time; elements branch on it once and run monomorphised loops.
#[derive(Debug, Clone, Copy, PartialEq)]
// Few of them, and plain values: a box would make them lose `Copy`.
#[allow(clippy::large_enum_variant)]
pub enum Law {
    /// Linear between Green-Lagrange strain and second Piola-Kirchhoff stress.
    StVenantKirchhoff(StVenantKirchhoff),
    /// Rubber at finite strains.
    NeoHooke(NeoHooke),
    /// Linear in the logarithmic strain.
    Hencky(Hencky),
    /// Metal that flows by von Mises' criterion.
    J2(J2),
    /// Rolled sheet that flows by Hill's criterion of 1948.
    Hill48(Hill48),
    /// Metal whose yield surface moves with the flow.
    ArmstrongFrederick(ArmstrongFrederick),
    /// Dashpots beside an elastic material; no material of a scene.
    Dashpot(Dashpot),
}

/// Runs a block of code with `$law` bound to the concrete law of a [`Law`].
macro_rules! with_law {
    ($enum:expr, $law:ident => $body:expr) => {
        match $enum {
            $crate::shell::Law::StVenantKirchhoff($law) => $body,
            $crate::shell::Law::NeoHooke($law) => $body,
            $crate::shell::Law::Hencky($law) => $body,
            $crate::shell::Law::J2($law) => $body,
            $crate::shell::Law::Hill48($law) => $body,
            $crate::shell::Law::ArmstrongFrederick($law) => $body,
            $crate::shell::Law::Dashpot($law) => $body,
        }
    };
}
pub(in crate::shell) use with_law;

impl Law {
    /// From the scene's constants.
    ///
    /// # Errors
    /// [`ShellError::Material`] unless E > 0 and -1 < nu < 0.5.
    pub fn new(material: &Material) -> Result<Law, ShellError> {
        let (lambda, mu) = lame(material.elastic())?;
        Ok(match material {
            Material::StVenantKirchhoff(_) => {
                Law::StVenantKirchhoff(StVenantKirchhoff { lambda, mu })
            }
            Material::NeoHooke(_) => Law::NeoHooke(NeoHooke { lambda, mu }),
            Material::Hencky(_) => Law::Hencky(Hencky { lambda, mu }),
            Material::J2(metal) => Law::J2(J2 {
                lambda,
                mu,
                hardening: Hardening::from(metal.hardening),
            }),
            Material::Hill48(sheet) => {
                let hardening = Hardening::from(sheet.hardening);
                Law::Hill48(Hill48::new((lambda, mu), hardening, sheet.r, sheet.rolling))
            }
            Material::ArmstrongFrederick(metal) => Law::ArmstrongFrederick(ArmstrongFrederick {
                lambda,
                mu,
                hardening: Hardening::from(metal.hardening),
                modulus: metal.back_stress.modulus,
                recovery: metal.back_stress.recovery,
            }),
        })
    }

    /// Poisson's ratio of the linearised law.
    pub fn nu(&self) -> f64 {
        let (lambda, mu) = self.lame();
        0.5 * lambda / (lambda + mu)
    }

    /// Young's modulus of the linearised law.
    pub fn young(&self) -> f64 {
        let (lambda, mu) = self.lame();
        mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu)
    }

    /// Numbers that a point remembers between steps.
    pub fn state_len(&self) -> usize {
        fn len<L: MaterialLaw>(_: &L) -> usize {
            L::State::LEN
        }
        with_law!(self, law => len(law))
    }

    /// Whether material may flow.
    pub fn flows(&self) -> bool {
        match self {
            Law::J2(_) | Law::Hill48(_) | Law::ArmstrongFrederick(_) => true,
            Law::StVenantKirchhoff(_) | Law::NeoHooke(_) | Law::Hencky(_) | Law::Dashpot(_) => {
                false
            }
        }
    }

    /// Dashpots with its moduli at small strain.
    pub fn dashpot(&self) -> Law {
        let (lambda, mu) = self.lame();
        Law::Dashpot(Dashpot { lambda, mu })
    }

    /// Whether tangents are symmetric.
    pub fn symmetric(&self) -> bool {
        with_law!(self, law => law.symmetric())
    }

    fn lame(&self) -> (f64, f64) {
        with_law!(self, law => (law.lambda, law.mu))
    }
}

/// Lamé's constants.
fn lame(elastic: Elastic) -> Result<(f64, f64), ShellError> {
    let Elastic { e, nu, .. } = elastic;
    if !(e > 0.0 && e.is_finite()) {
        return Err(ShellError::Material {
            name: "E",
            value: e,
            range: "positive",
        });
    }
    if !(nu > -1.0 && nu < 0.5) {
        return Err(ShellError::Material {
            name: "nu",
            value: nu,
            range: "between -1 and 0.5",
        });
    }
    Ok((
        e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
        0.5 * e / (1.0 + nu),
    ))
}
