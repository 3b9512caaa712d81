//! The part of a surface that a face needs: files cut surfaces, or even end them, a little short of the boundaries on them.

use super::base::BasePatch;
use super::curves::{BEYOND, NOISE, bounds, bounds_of};
use super::face::Face;
use super::grant::Grant;
use super::host::Host;
use crate::NurbsPatch;
use crate::basis::Basis;

/// A surface on a larger domain, and by how much of its extent it was continued beyond its knots.
pub struct Grown {
    pub patch: NurbsPatch,
    pub continued: f64,
}

/// The surface on a slightly larger domain, where boundaries leave it by up to a share of 1e-3. Beyond its knots the
/// polynomials of the last spans go on: boundaries are where the neighbours' are, and without this the face would end short
/// of them.
pub fn grown(base: &BasePatch, face: &Face, resolution: f64, grant: &Grant) -> Option<Grown> {
    if !base.parameters.is_identity() {
        return None;
    }
    let host = Host::new(&base.patch, &base.parameters, resolution, grant);
    let domain = host.domain;
    let mut wanted = domain;
    for stretch in face.boundaries.iter().flat_map(|b| &b.stretches) {
        let bounds = match stretch.parameter.is_empty() {
            false => bounds(&stretch.parameter),
            // On a plane, space curves have parameters beyond the border as well.
            true => {
                let curves = stretch.space.iter();
                let curves: Vec<_> = curves
                    .map_while(|p| host.exact_projection(&p.curve))
                    .collect();
                bounds_of(curves.iter())
            }
        };
        for d in (0..2).filter(|&d| !host.closed[d]) {
            let [noise, slack] = [NOISE, BEYOND].map(|s| s * host.extent(d));
            let [low, high] = [domain[d][0] - bounds[d][0], bounds[d][1] - domain[d][1]];
            if low > noise && low <= slack {
                wanted[d][0] = wanted[d][0].min(bounds[d][0]);
            }
            if high > noise && high <= slack {
                wanted[d][1] = wanted[d][1].max(bounds[d][1]);
            }
        }
    }
    if wanted == domain {
        return None;
    }
    let mut patch = base.patch.clone();
    let mut continued = 0.0f64;
    for (d, ends) in wanted.into_iter().enumerate() {
        let own = patch.basis(d).own_domain();
        for (end, to) in ends.into_iter().enumerate() {
            let beyond = if end == 0 { own[0] - to } else { to - own[1] };
            if beyond > 0.0 {
                patch = longer(&patch, d, end, to)?;
                continued = continued.max(beyond / host.extent(d));
            }
        }
    }
    let patch = patch.with_domain(wanted).ok()?;
    Some(Grown { patch, continued })
}

/// The surface with its knots' range in direction `dir` extended to `to` at its start (`end` 0) or end (1), where the
/// polynomial of the outermost span goes on.
fn longer(patch: &NurbsPatch, dir: usize, end: usize, to: f64) -> Option<NurbsPatch> {
    let patch = patch.clamped(dir).ok()?;
    let basis = patch.basis(dir);
    let (p, n, knots) = (basis.degree(), basis.count(), basis.knots());
    let moved = basis.own_domain()[end];
    let new: Vec<f64> = knots
        .iter()
        .map(|&t| if t == moved { to } else { t })
        .collect();
    // The span whose polynomial goes on, and the points that the moved knots shape.
    let (span, changed) = match end {
        0 => (p, 0..p),
        _ => (n - 1, n - p..n),
    };
    let counts = patch.counts();
    let place = |i: usize, line: usize| match dir {
        0 => i + counts[0] * line,
        _ => line + counts[0] * i,
    };
    let old = patch.homogeneous();
    let mut points = old.to_vec();
    for line in 0..counts[1 - dir] {
        for i in changed.clone() {
            let mut segment: Vec<_> = (span - p..=span).map(|j| old[place(j, line)]).collect();
            points[place(i, line)] = blossom(&mut segment, knots, span, &new[i + 1..=i + p]);
        }
    }
    let own = Basis::new(p, new, n).ok()?;
    let mut bases = [patch.basis(0).clone(), patch.basis(1).clone()];
    bases[dir] = own;
    NurbsPatch::from_homogeneous(bases, points).ok()
}

/// Value of the blossom of the polynomial on span `k`, whose points are `segment`, at `arguments` (C. de Boor's algorithm
/// with another parameter in each step).
fn blossom(segment: &mut [[f64; 4]], knots: &[f64], k: usize, arguments: &[f64]) -> [f64; 4] {
    let p = arguments.len();
    for (r, u) in (1..=p).zip(arguments) {
        for j in (r..=p).rev() {
            let i = k - p + j;
            let share = (u - knots[i]) / (knots[i + p + 1 - r] - knots[i]);
            let before = segment[j - 1];
            for (x, from) in segment[j].iter_mut().zip(before) {
                *x = (1.0 - share) * from + share * *x;
            }
        }
    }
    segment[p]
}
