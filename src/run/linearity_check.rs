//! What small displacements neglect, measured on what came out: nothing here changes a result.
//!
//! Elements: the rotation and the strain at their middles. Contact: every slave point is projected once more, where it is
//! now, on the master where that is now: the turn of the normal and the gap are what the start did not know of. At kinks,
//! at the end and wherever the strain energy has doubled also the energy of the large-rotation elements: with displacements `u` of the linear ones it is
//! `W2 + W3 + W4`, and the strains that are quadratic in `u` ask for further displacements `u2`, linear again, which
//! release `R = -Q . u2 / 2`. The next terms of the forces are then about `3 W3 / 2 W2 + 2 (W4 - R) / W2` of what they are (the
//! expansion of W. T. Koiter, "On the stability of elastic equilibrium", Delft 1945, along the path itself): a clamped
//! plate is stiffened where it bends by a third of its thickness, a cantilever escapes by drawing in.
use super::march::March;
use crate::assembly::{Fault, Needed, Quadratic};
use crate::model::error::number;
use crate::model::master::Masters;
use crate::model::state::State;
use crate::model::{BodyModel, Model};
use crate::shell::{ElementBlock, with_block};
use covact_geometry::Vec3;
use nalgebra::Matrix3;
use rayon::prelude::*;

/// Rotations (radians), strains and shares above which the assumption is doubtful.
const DOUBTFUL: f64 = 0.05;
/// Multiple of that above which it is wrong.
const WRONG: f64 = 5.0;

/// Part of the size of an element below which a way is rounding.
const NO_WAY: f64 = 1e-9;

/// A doubt: told once, when it comes up.
pub(super) struct LinearityWarning {
    /// Text that such a warning begins with.
    pub about: String,
    pub text: String,
}

/// What the displacements of elements leave out.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Stretch {
    rotation: f64,
    strain: f64,
}

impl Stretch {
    fn with(self, other: Stretch) -> Stretch {
        Stretch {
            rotation: self.rotation.max(other.rotation),
            strain: self.strain.max(other.strain),
        }
    }
}

/// The doubts about an accepted state; none where displacements may be large.
///
/// # Errors
/// A motion of a surface without a value at `time`.
pub(super) fn doubts(
    model: &Model,
    masters: &mut Masters,
    state: &State,
    time: f64,
) -> Result<Vec<LinearityWarning>, Fault> {
    let mut out = Vec::new();
    if model.small.is_none() {
        return Ok(out);
    }
    let mut tell = |what: &str, of: &str, value: f64, text: String| {
        out.extend(doubt(what, of, value, &text, time));
    };
    for body in &model.bodies {
        let found = with_block!(&body.block, block => stretch(model, body, block, &state.u));
        let of = format!(" of body `{}`", body.name);
        let text = format!("elements turn by up to {:.3} rad", found.rotation);
        tell("rotations", &of, found.rotation, text);
        let text = format!(
            "elements are strained by up to {:.1} %",
            100.0 * found.strain
        );
        tell("strains", &of, found.strain, text);
    }
    for (index, pair) in model.pairs.iter().enumerate() {
        let found = contact(model, masters, state, index, time)?;
        let of = format!(" of contact `{}`", pair.name);
        let text = format!(
            "at points in contact the normal of {} has turned by up to {:.3} rad from that of the start",
            pair.master_words(model),
            found.turn
        );
        tell("normals", &of, found.turn, text);
        let share = found.error / found.way;
        if found.way > NO_WAY * pair.element_size && share.is_finite() {
            let text = format!(
                "points in contact are off by up to {} from where their gaps say, {:.0} % of their way, {}",
                number(found.error),
                100.0 * share,
                number(found.way)
            );
            tell("gaps", &of, share, text);
        }
        if found.beyond > 0 {
            let text = format!(
                "{} point(s) would touch {} that were not in front of it at the start, and are not in contact",
                found.beyond,
                pair.master_words(model)
            );
            tell("feet", &of, 1.0, text);
        }
    }
    Ok(out)
}

/// The doubt that a value above its limit raises.
fn doubt(what: &str, of: &str, value: f64, text: &str, time: f64) -> Option<LinearityWarning> {
    if value <= DOUBTFUL {
        return None;
    }
    let (about, help) = match value > WRONG * DOUBTFUL {
        true => (
            "displacements are not small",
            "take `\"kinematics\": \"large\"`",
        ),
        false => (
            "displacements may not be small enough",
            "compare with `\"kinematics\": \"large\"`",
        ),
    };
    let about = format!("{about}, {what}{of}:");
    Some(LinearityWarning {
        text: format!("{about} {text} (time {}); {help}", number(time)),
        about,
    })
}

/// The doubt about the forces of the linear elements; `next` are the terms that follow, of strain energy `internal`, and
/// `released` what further displacements release.
fn forces(next: &Quadratic, released: f64, internal: f64, time: f64) -> Option<LinearityWarning> {
    let fourth = (next.even - internal - released).max(0.0);
    let share = (1.5 * next.odd.abs() + 2.0 * fourth) / internal;
    let text = format!(
        "strains that are quadratic in the displacements change them by about {}",
        match share < 1.0 {
            true => format!("{:.0} %", 100.0 * share),
            false => format!("{} times as much", number((10.0 * share).round() / 10.0)),
        }
    );
    (internal > 0.0 && !share.is_nan())
        .then(|| doubt("forces", " of the elements", share, &text, time))?
}

impl March<'_, '_> {
    /// Measures what the linear elements leave out of their forces, and tells where it is not small.
    pub(super) fn beyond_linear(&mut self, state: &State, internal: f64) {
        let time = self.progress.time;
        self.progress.measured = self.progress.measured.max(internal);
        let next = self.assembler.small_quadratic(&state.u);
        let Ok(next) = next else {
            self.warn(
                "displacements are not small: the large-rotation elements could not follow them at all; take \
                 `\"kinematics\": \"large\"`"
                    .to_owned(),
            );
            return;
        };
        let mut released = 0.0;
        if self.assembler.small_needs(&state.points) == Needed::Nothing {
            let mut further = next.forces.clone();
            self.model.dofs.fold(&mut further);
            // Where it cannot be solved for, nothing is released: the doubt is the larger.
            let matrix = self.assembler.matrix();
            if self.solver.solve_with(matrix, &mut further).is_ok() {
                self.model.dofs.expand(&mut further, None);
                released = (further.iter().zip(&next.forces))
                    .map(|(u, f)| 0.5 * u * f)
                    .sum();
            }
        }
        if let Some(doubt) = forces(&next, released, internal, time) {
            self.doubt(doubt);
        }
    }

    /// Tells a doubt, once.
    pub(super) fn doubt(&mut self, doubt: LinearityWarning) {
        let told = |w: &String| w.starts_with(&doubt.about);
        if !self.progress.warnings.iter().any(told) {
            self.warn(doubt.text);
        }
    }
}

fn stretch<const N: usize>(
    model: &Model,
    body: &BodyModel,
    block: &impl ElementBlock<N>,
    u: &[f64],
) -> Stretch {
    let of = |e: usize| {
        let x = body.nodes_of(block, e).map(|n| model.nodes[n as usize]);
        let [big, du] = [&x, &body.displacements(block, e, u)].map(middle);
        let Some(dual) = big.try_inverse() else {
            return Stretch::default();
        };
        let h = du * dual;
        let (turn, strain) = ((h - h.transpose()) * 0.5, (h + h.transpose()) * 0.5);
        Stretch {
            rotation: turn.norm() / f64::sqrt(2.0),
            strain: strain.norm(),
        }
    };
    (0..block.elements())
        .into_par_iter()
        .with_min_len(256)
        .map(of)
        .reduce(Stretch::default, Stretch::with)
}

/// Derivatives of a field along the three directions of an element at its middle, by columns.
fn middle<const N: usize>(z: &[Vec3; N]) -> Matrix3<f64> {
    let mean = |a: &[usize], b: &[usize]| {
        let sum = |i: &[usize]| i.iter().fold(Vec3::zeros(), |s, &n| s + z[n]);
        (sum(b) - sum(a)) / (2.0 * a.len() as f64)
    };
    match N {
        8 => Matrix3::from_columns(&[
            mean(&[0, 2, 4, 6], &[1, 3, 5, 7]),
            mean(&[0, 1, 4, 5], &[2, 3, 6, 7]),
            mean(&[0, 1, 2, 3], &[4, 5, 6, 7]),
        ]),
        _ => Matrix3::from_columns(&[
            mean(&[3, 12], &[5, 14]),
            mean(&[1, 10], &[7, 16]),
            mean(&[4], &[13]),
        ]),
    }
}

/// What a contact is off by.
#[derive(Debug, Clone, Copy, Default)]
struct Off {
    turn: f64,
    error: f64,
    /// Largest displacement of a point in contact relative to its master.
    way: f64,
    /// Points in contact that have no foot.
    beyond: usize,
}

fn contact(
    model: &Model,
    masters: &mut Masters,
    state: &State,
    index: usize,
    time: f64,
) -> Result<Off, Fault> {
    let mut off = Off::default();
    let Some(small) = &model.small else {
        return Ok(off);
    };
    masters.update(model, &state.u);
    let (pair, own) = (&model.pairs[index], &small.pairs[index]);
    let first: usize = model.pairs[..index].iter().map(|p| p.points.len()).sum();
    let master = masters.at(model, index, &state.u, time)?;
    let motion = model.small_motion(pair, time)?;
    let offsets = pair.offsets(time);
    let seen: Vec<_> = (pair.points.par_iter().zip(&own.points).enumerate())
        .with_min_len(64)
        .map(|(i, (p, at))| {
            let x = model.point_position(p, &state.u);
            master.see(i, &x, at.map(|at| at.hint))
        })
        .collect();
    for (i, (p, seen)) in pair.points.iter().zip(&seen).enumerate() {
        let Some(seen) = seen else { continue };
        let z0 = offsets.map_or(0.0, |o| o.at(i));
        let Some(at) = &own.points[i] else {
            off.beyond += usize::from(seen.closed(z0));
            continue;
        };
        let closed = state.points[first + i].closed;
        if !closed && !seen.closed(z0) {
            continue;
        }
        let (way, along) = own.way(i, at, p, motion.as_ref(), &state.u);
        off.way = off.way.max(way);
        off.error = off.error.max((at.gap + along - seen.signed_distance).abs());
        if closed && !at.line {
            let cosine = at.normal.dot(&seen.normal).clamp(-1.0, 1.0);
            let sine = at.normal.cross(&seen.normal).norm();
            off.turn = off.turn.max(sine.atan2(cosine));
        }
    }
    Ok(off)
}
