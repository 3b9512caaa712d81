//! Overclosures at the start that are not resolved by strain at once.
use super::error::{number, text};
use super::{Model, ModelError, PairModel};
use crate::contact::law::Offsets;
use crate::scene::InitialOverclosure;
use covact_geometry::Vec3;

/// Offsets of the gaps of a pair's points: an overclosure at the start that counts as no gap.
#[derive(Debug, Clone, PartialEq)]
pub struct Overclosure {
    /// Gap at the start per slave point, zero where the point started open (length, `<= 0`).
    pub z0: Vec<f64>,
    /// Time at which the offsets have shrunk to zero; `None`: they stay.
    pub until: Option<f64>,
}

impl Overclosure {
    /// Part of the offsets that is left at time `t`.
    pub fn factor(&self, t: f64) -> f64 {
        self.until.map_or(1.0, |end| (1.0 - t / end).max(0.0))
    }
}

impl PairModel {
    /// Whether the first step resolves an overclosure at the start. (Segments are cut anew with every step: their points are
    /// others then.)
    pub fn strains(&self) -> bool {
        self.overclosure.is_none() && self.segments().is_none()
    }

    /// Overclosures of the points that are being resolved: those that shrink over time, or those of the start in `start`, where
    /// the pair's begin at `first`; none where nothing is resolved.
    pub fn resolved<'a>(&'a self, start: &'a [f64], first: usize) -> Option<&'a [f64]> {
        match &self.overclosure {
            Some(over) => over.until.map(|_| &over.z0[..]),
            None if start.is_empty() || self.segments().is_some() => None,
            None => start.get(first..first + self.points.len()),
        }
    }

    /// What the gaps of the points are measured from at time `t`; none where they are normal coordinates.
    pub fn offsets(&self, t: f64) -> Option<Offsets<'_>> {
        if !self.shifts() {
            return None;
        }
        let over = self.overclosure.as_ref();
        Some(Offsets {
            base: self.offset,
            z0: over.map_or(&[], |o| &o.z0),
            factor: over.map_or(0.0, |o| o.factor(t)),
            bow: &self.bow,
        })
    }
}

/// A slave point's overclosure at the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Deepest {
    pub gap: f64,
    pub at: Vec3,
}

/// What becomes of the overclosures `z0` of pair `index`, in words.
///
/// # Errors
/// [`ModelError`] where the scene refuses them.
pub(super) fn treat(
    model: &mut Model,
    index: usize,
    choice: InitialOverclosure,
    z0: Vec<f64>,
    deepest: Deepest,
) -> Result<String, ModelError> {
    let pair = &mut model.pairs[index];
    let points = z0.iter().filter(|z| **z < 0.0).count();
    let told = format!(
        "contact `{}` starts with an overclosure of {} at {points} point(s), most near ({}, {}, {})",
        pair.name,
        number(-deepest.gap),
        number(deepest.at.x),
        number(deepest.at.y),
        number(deepest.at.z)
    );
    match choice {
        InitialOverclosure::Strain => Ok(format!("{told}; the first step resolves it with strain")),
        InitialOverclosure::StressFree => {
            pair.overclosure = Some(Overclosure { z0, until: None });
            Ok(format!("{told}, which counts as touching (`stress_free`)"))
        }
        InitialOverclosure::Shrink { until } => {
            pair.overclosure = Some(Overclosure {
                z0,
                until: Some(until),
            });
            Ok(format!(
                "{told}, which is resolved step by step until t = {}",
                number(until)
            ))
        }
        InitialOverclosure::Refuse => Err(text(
            format!("/contacts/{}/initial_overclosure", pair.name),
            told,
        )
        .help(
            "move the surface with `placement`, or choose `strain`, `stress_free` or `{\"shrink\": {\"until\": t}}`",
        )),
    }
}
