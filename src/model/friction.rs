//! Friction of a contact pair: its law over time, and its penalty.
use super::{EffectKind, penalty};
use crate::contact::friction::law::Coulomb;
use crate::contact::friction::orthotropic::Orthotropic;
use crate::contact::friction::shear_limited::ShearLimited;
use crate::contact::kind::FrictionKind;
use crate::scene::{Friction, Material, TIME, TimeFunction, ValueError};
use nalgebra::{Unit, Vector3};

/// Friction of a pair.
#[derive(Debug, Clone)]
pub struct FrictionModel {
    pub law: LawModel,
    /// Tangential penalty as a multiple of the normal one, whatever that is at the time; what it starts with where it is ruled.
    pub ratio: f64,
    /// The run may lower it to what leaves a tolerable elastic slip.
    pub ruled: bool,
    /// The tangential penalty where its value is given (force / length^3), whatever the normal one is.
    pub given: Option<f64>,
}

/// A law of friction whose coefficients may vary in time.
#[derive(Debug, Clone)]
pub enum LawModel {
    Coulomb {
        mu: TimeFunction,
    },
    Orthotropic {
        mu: [TimeFunction; 2],
        direction: Unit<Vector3<f64>>,
    },
    ShearLimited {
        mu: TimeFunction,
        limit: TimeFunction,
    },
}

/// A law of friction at a time; `with_law` compiles what runs over points for each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LawNow {
    Coulomb(Coulomb),
    Orthotropic(Orthotropic),
    ShearLimited(ShearLimited),
}

impl FrictionKind {
    /// The effect of a law.
    pub fn effect(self) -> Option<EffectKind> {
        match self {
            FrictionKind::None => None,
            FrictionKind::Coulomb => Some(EffectKind::Coulomb),
            FrictionKind::Orthotropic => Some(EffectKind::Orthotropic),
            FrictionKind::ShearLimited => Some(EffectKind::ShearLimited),
        }
    }
}

impl LawNow {
    /// Which law it is; `with_law` compiles loops for each.
    pub fn kind(&self) -> FrictionKind {
        match self {
            LawNow::Coulomb(_) => FrictionKind::Coulomb,
            LawNow::Orthotropic(_) => FrictionKind::Orthotropic,
            LawNow::ShearLimited(_) => FrictionKind::ShearLimited,
        }
    }
}

/// Evaluates an expression with the law of a `LawNow`, compiled once for each kind.
macro_rules! with_law {
    ($now:expr, $law:ident => $then:expr) => {
        match $now {
            $crate::model::friction::LawNow::Coulomb($law) => $then,
            $crate::model::friction::LawNow::Orthotropic($law) => $then,
            $crate::model::friction::LawNow::ShearLimited($law) => $then,
        }
    };
}
pub(crate) use with_law;

impl LawModel {
    /// The law of a scene.
    ///
    /// # Errors
    /// Coefficients that are no functions of time.
    pub fn new(friction: &Friction) -> Result<Self, ValueError> {
        match friction {
            Friction::Coulomb { mu } => Ok(LawModel::Coulomb {
                mu: mu.compile(&TIME)?,
            }),
            Friction::Orthotropic {
                mu: [along, across],
                direction,
            } => Ok(LawModel::Orthotropic {
                mu: [along.compile(&TIME)?, across.compile(&TIME)?],
                direction: Unit::try_new((*direction).into(), 0.0).ok_or(ValueError::NoLength {
                    what: "the direction",
                })?,
            }),
            Friction::ShearLimited { mu, limit } => Ok(LawModel::ShearLimited {
                mu: mu.compile(&TIME)?,
                limit: limit.compile(&TIME)?,
            }),
        }
    }

    /// Which law it is.
    pub fn kind(&self) -> FrictionKind {
        match self {
            LawModel::Coulomb { .. } => FrictionKind::Coulomb,
            LawModel::Orthotropic { .. } => FrictionKind::Orthotropic,
            LawModel::ShearLimited { .. } => FrictionKind::ShearLimited,
        }
    }

    /// Whether the coefficients are zero at all times.
    pub fn is_none(&self) -> bool {
        let zero = |f: &TimeFunction| !f.depends_on_time() && f.eval(0.0).is_ok_and(|v| v == 0.0);
        match self {
            // Without a coefficient or without a limit there is none.
            LawModel::ShearLimited { mu, limit } => zero(mu) || zero(limit),
            _ => self.functions().into_iter().all(zero),
        }
    }

    fn functions(&self) -> Vec<&TimeFunction> {
        match self {
            LawModel::Coulomb { mu } => vec![mu],
            LawModel::Orthotropic { mu, .. } => mu.iter().collect(),
            LawModel::ShearLimited { mu, limit } => vec![mu, limit],
        }
    }

    /// The law at time `t`.
    ///
    /// # Errors
    /// A coefficient without a value at that time, or a negative one.
    pub fn at(&self, t: f64) -> Result<LawNow, ValueError> {
        let positive = |f: &TimeFunction, what| {
            let value = f.eval(t)?;
            match value >= 0.0 {
                true => Ok(value),
                false => Err(ValueError::Negative {
                    what,
                    value,
                    time: t,
                }),
            }
        };
        let coefficient = |f| positive(f, "the coefficient of friction");
        match self {
            LawModel::Coulomb { mu } => Ok(LawNow::Coulomb(Coulomb {
                mu: coefficient(mu)?,
            })),
            LawModel::Orthotropic { mu, direction } => {
                let mu = [coefficient(&mu[0])?, coefficient(&mu[1])?];
                Ok(LawNow::Orthotropic(Orthotropic::new(mu, *direction)))
            }
            LawModel::ShearLimited { mu, limit } => Ok(LawNow::ShearLimited(ShearLimited {
                mu: coefficient(mu)?,
                limit: positive(limit, "the largest traction of friction")?,
            })),
        }
    }
}

/// Elastic slip that a ruled tangential penalty leaves at the mean pressure of its contact, as a part of an element.
const SLIP: f64 = 1e-3;

impl FrictionModel {
    /// The tangential penalty over the normal one that suits a mean pressure (force / length^2) under the normal penalty `eps_n`,
    /// on elements of a size: as stiff as elastic bodies would be, but no stiffer than what keeps the elastic slip of a point
    /// about to slide to a part of an element. A stiffer one would only make points that slide one way in an iteration slide
    /// back in the next. Nothing where friction or pressure is none.
    ///
    /// # Errors
    /// A coefficient without a value at this time.
    pub fn suitable(
        &self,
        pressure: f64,
        eps_n: f64,
        element_size: f64,
        time: f64,
    ) -> Result<Option<f64>, ValueError> {
        let eps_t = self.largest(pressure, time)? / (SLIP * element_size);
        Ok((eps_t > 0.0).then(|| (eps_t / eps_n).min(self.ratio)))
    }

    /// The largest traction of friction at a pressure (force / length^2).
    ///
    /// # Errors
    /// A coefficient without a value at this time.
    pub fn largest(&self, pressure: f64, time: f64) -> Result<f64, ValueError> {
        Ok(match self.law.at(time)? {
            LawNow::Coulomb(law) => law.mu * pressure,
            LawNow::Orthotropic(law) => law.mu[0].max(law.mu[1]) * pressure,
            LawNow::ShearLimited(law) => (law.mu * pressure).min(law.limit),
        })
    }

    /// What varies in time.
    pub fn functions(&self) -> impl Iterator<Item = &TimeFunction> {
        self.law.functions().into_iter()
    }
}

/// Tangential penalty as a multiple of the normal one: the ratio of tangential to normal compliance of two elastic bodies
/// in contact, `(1 - nu) / (1 - nu / 2)` (K. L. Johnson, Contact Mechanics, 1985, section 7.3).
pub fn automatic_ratio(material: &Material) -> f64 {
    let nu = penalty::poisson(material);
    (1.0 - nu) / (1.0 - 0.5 * nu)
}
