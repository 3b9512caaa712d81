//! Kirchhoff-Love shells on bicubic NURBS patches: an element is a knot span, its nodes are the sixteen control points that
//! act on it, three displacements each. No rotations, no fibres: the mid-surface carries membrane and bending strains.
//!
//! Strains and their variations: J. Kiendl, K.-U. Bletzinger, J. Linhard and R. Wüchner, CMAME 198 (2009), equations 5 to 17.
//! `eps_ij = (a_ij - A_ij) / 2`, `kap_ij = H_ij - h_ij`. With `omega_k = n . drho_k` and the covariant second derivatives
//! `W_ij = drho_ij - Gamma^k_ij drho_k` of a variation, `dkap_ij = -n . W_ij` and `dn = -rho^k omega_k`; the second variation of
//! the curvature is then three products ([`tangent`]), so that the stiffness needs no derivative of a normal.
//!
//! Membrane strains are assumed (option): in the axes of the element they are interpolated biquadratically between nine points,
//! at the knots and half-way, and keep the element's mean. Nine points integrate such an element, sixteen one without.
mod anchors;
mod borders;
mod frame;
mod plane_stress;
mod point;
mod seam;
#[cfg(test)]
mod seam_tests;
mod strain;
mod stress;
mod tangent;
#[cfg(test)]
mod tests;
mod tether;

use super::error::{ElementFault, FaultCause, ShellError};
use super::kinematics::V;
use super::material::Law;
use crate::fem::gauss;
use crate::mesh::NurbsSheet;
use crate::mesh::nurbs::{GROUP, Kept};
pub use anchors::AnchorSpring;
pub use borders::HeldNormal;
use covact_geometry::{PatchShape, Vec3};
pub use frame::{DOFS, NODES};
use num_dual::DualNum;
use plane_stress::Sheet;
use point::{ASSUMED, BorderPoint, GaussPoint, PLAIN, TyingPoint, biquadratic, shapes};
pub use seam::{SEAM_DOFS, SEAM_NODES, SeamSpan};
use std::ops::Range;
use strain::Strains;
pub use stress::SheetResultants;
use tether::Tether;

/// Runs a block of code with `$law` bound to the concrete law of a [`Sheet`].
macro_rules! with_sheet {
    ($enum:expr, $law:ident => $body:expr) => {
        match $enum {
            $crate::shell::nurbs::plane_stress::Sheet::Linear($law) => $body,
            $crate::shell::nurbs::plane_stress::Sheet::Rubber($law) => $body,
        }
    };
}
use with_sheet;

/// Forces and tangent of one element, dofs numbered `3 node + axis`, nodes xi1 fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct NurbsSystem {
    /// Internal forces.
    pub f: [f64; DOFS],
    /// Tangent, full and exactly symmetric, by columns.
    pub k: Box<[f64; DOFS * DOFS]>,
    /// Strain energy.
    pub energy: f64,
    work: Box<tangent::Work>,
}

impl Default for NurbsSystem {
    fn default() -> NurbsSystem {
        NurbsSystem {
            f: [0.0; DOFS],
            k: Box::new([0.0; DOFS * DOFS]),
            energy: 0.0,
            work: Box::new(tangent::Work::new()),
        }
    }
}

/// All elements of a sheet, with one law. They keep no state.
#[derive(Debug, Clone)]
pub struct NurbsBlock {
    law: Law,
    sheet: NurbsSheet,
    plane: Sheet,
    nodes: Vec<[u32; NODES]>,
    /// Undeformed positions of the elements' control points.
    reference: Vec<[V<f64>; NODES]>,
    /// Gauss points of an element that no trim cuts.
    per: usize,
    points: Vec<GaussPoint>,
    /// Groups of points, where a trim cuts something away; empty where every element has one, of its number.
    groups: Vec<Group>,
    /// Where the groups of each element begin, and the end; empty likewise.
    first_group: Vec<u32>,
    /// Nine per element; none where membrane strains are not assumed.
    ties: Vec<TyingPoint>,
    /// The biquadratic functions at the Gauss points of any element.
    functions: [[f64; ASSUMED]; ASSUMED],
    borders: Vec<BorderPoint>,
    /// Where the border points of each element begin, and the end; empty where nothing is held.
    starts: Vec<u32>,
    /// Where patches are joined.
    seams: Vec<SeamSpan>,
    /// Where curves of trims are held.
    anchors: Vec<AnchorSpring>,
    /// Control points that a trim leaves next to nothing of, by elements.
    tethers: Vec<Tether>,
}

/// Points that strains are worked out at together: all of an element, or those in a part of one that a trim cuts, whose membrane
/// strains are taken as they are.
#[derive(Debug, Clone)]
struct Group {
    element: u32,
    points: Range<usize>,
    ties: Range<usize>,
}

impl NurbsBlock {
    /// Bytes of an element here, border points aside.
    pub(super) const BYTES: usize = size_of::<[u32; NODES]>()
        + size_of::<[V<f64>; NODES]>()
        + PLAIN * size_of::<GaussPoint>()
        + ASSUMED * size_of::<TyingPoint>();

    /// Sets up the knot spans of a sheet.
    ///
    /// # Errors
    /// A law without a form in plane stress; a span where the surface has no normal.
    pub fn new(sheet: &NurbsSheet, law: Law) -> Result<NurbsBlock, ShellError> {
        let plane = Sheet::new(&law, sheet.thickness).ok_or(ShellError::PlaneStress)?;
        let count = sheet.elements();
        let per_side = if sheet.assumed_membrane { 3 } else { 4 };
        let rule = gauss(per_side).expect("a rule of three or four points exists");
        let per = per_side * per_side;
        let positions = sheet.positions();
        let mut block = NurbsBlock {
            law,
            sheet: sheet.clone(),
            plane,
            nodes: Vec::with_capacity(count),
            reference: Vec::with_capacity(count),
            per,
            points: Vec::with_capacity(count * per),
            groups: Vec::new(),
            first_group: Vec::new(),
            ties: Vec::new(),
            functions: [[0.0; ASSUMED]; ASSUMED],
            borders: Vec::new(),
            starts: Vec::new(),
            seams: SeamSpan::all(sheet, &law)?,
            anchors: Vec::new(),
            tethers: Vec::new(),
        };
        block.tethers = Tether::all(sheet, block.bending());
        let places: Vec<(f64, f64)> = (rule.iter())
            .map(|(s, w)| (0.5 * (1.0 + s), 0.5 * w))
            .collect();
        if sheet.assumed_membrane {
            for g in 0..per {
                block.functions[g] = biquadratic(places[g % 3].0, places[g / 3].0);
            }
            block.ties.reserve_exact(count * ASSUMED);
        }
        let mut room = PatchShape::default();
        for e in 0..count {
            let (part, span) = sheet.place(e);
            let patch = &part.patch;
            let [u, v] = [0, 1].map(|dir| patch.basis(dir).span_range(span[dir]));
            let at = |s: f64, t: f64| [u[0] + s * (u[1] - u[0]), v[0] + t * (v[1] - v[0])];
            let size = (u[1] - u[0]) * (v[1] - v[0]);
            let mut centre = shapes(patch, span, at(0.5, 0.5), &mut room);
            for node in &mut centre.nodes {
                *node += part.first_node;
            }
            let x = centre.nodes.map(|a| positions[a as usize].into());
            let first = frame::combine(&centre.second[0], &x);
            block.nodes.push(centre.nodes);
            block.reference.push(x);
            let kept = sheet.kept(e);
            let own = match kept {
                Kept::Whole => {
                    let all = places.iter().flat_map(|(t, wt)| {
                        let of = move |(s, ws): &(f64, f64)| (at(*s, *t), ws * wt * size);
                        places.iter().map(of)
                    });
                    all.collect()
                }
                Kept::Part(points) => points.iter().map(|p| (p.xi, p.weight)).collect(),
                Kept::Nothing => Vec::new(),
            };
            let starts = [block.points.len(), block.ties.len()];
            for (xi, weight) in own {
                let shape = shapes(patch, span, xi, &mut room);
                let point = GaussPoint::new(&shape, &x, &first, weight);
                if !(point.weight > 0.0 && point.weight.is_finite()) {
                    return Err(ShellError::NoNormal { element: e as u32 });
                }
                block.points.push(point);
            }
            if sheet.assumed_membrane && *kept == Kept::Whole {
                for c in 0..ASSUMED {
                    let place = at(0.5 * (c % 3) as f64, 0.5 * (c / 3) as f64);
                    let shape = shapes(patch, span, place, &mut room);
                    let tie = TyingPoint::new(&shape, &x, &first);
                    if !tie.turn.iter().flatten().all(|t| t.is_finite()) {
                        return Err(ShellError::NoNormal { element: e as u32 });
                    }
                    block.ties.push(tie);
                }
            }
            if sheet.is_trimmed() {
                block.group(e, kept, starts);
            }
        }
        Ok(block)
    }

    /// Adds the groups of element `e`, whose points and tying points begin here.
    fn group(&mut self, e: usize, kept: &Kept, [points, ties]: [usize; 2]) {
        if e == 0 {
            self.first_group.push(0);
        }
        let size = match kept {
            Kept::Whole => self.per,
            _ => GROUP,
        };
        for start in (points..self.points.len()).step_by(size) {
            self.groups.push(Group {
                element: e as u32,
                points: start..start + size,
                ties: ties..self.ties.len(),
            });
        }
        self.first_group.push(self.groups.len() as u32);
    }

    /// Groups of points of an element.
    fn groups_of(&self, e: usize) -> Range<usize> {
        match self.first_group.is_empty() {
            true => e..e + 1,
            false => self.first_group[e] as usize..self.first_group[e + 1] as usize,
        }
    }

    /// The surface with its thickness.
    pub fn sheet(&self) -> &NurbsSheet {
        &self.sheet
    }

    /// The law of all elements.
    pub fn law(&self) -> Law {
        self.law
    }

    /// Where patches are joined.
    pub fn seams(&self) -> &[SeamSpan] {
        &self.seams
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.nodes.len()
    }

    /// Control points of element `e`.
    pub fn nodes_of(&self, e: usize) -> [u32; NODES] {
        self.nodes[e]
    }

    /// Undeformed volume of element `e`.
    pub fn volume(&self, e: usize) -> f64 {
        let all = self.groups_of(e).flat_map(|group| self.gauss(group));
        self.sheet.thickness * all.map(|p| p.weight).sum::<f64>()
    }

    /// Bytes of heap that the points on borders and seams take.
    pub fn border_bytes(&self) -> usize {
        let groups = size_of_val(&self.groups[..]) + size_of_val(&self.first_group[..]);
        let seams = groups
            + size_of_val(&self.seams[..])
            + self.seams.iter().map(SeamSpan::bytes).sum::<usize>();
        let springs: usize = self.anchors.iter().map(AnchorSpring::bytes).sum();
        let anchors = size_of_val(&self.anchors[..]) + springs + size_of_val(&self.tethers[..]);
        size_of_val(&self.borders[..]) + size_of_val(&self.starts[..]) + seams + anchors
    }

    /// Gauss points of a group.
    fn gauss(&self, group: usize) -> &[GaussPoint] {
        match self.groups.is_empty() {
            true => &self.points[self.per * group..self.per * (group + 1)],
            false => &self.points[self.groups[group].points.clone()],
        }
    }

    /// Tying points of a group; none where membrane strains are not assumed.
    fn tying(&self, group: usize) -> &[TyingPoint] {
        match (self.ties.is_empty(), self.groups.is_empty()) {
            (true, _) => &[],
            (false, true) => &self.ties[ASSUMED * group..ASSUMED * (group + 1)],
            (false, false) => &self.ties[self.groups[group].ties.clone()],
        }
    }

    /// The element of a group.
    fn element_of(&self, group: usize) -> usize {
        match self.groups.is_empty() {
            true => group,
            false => self.groups[group].element as usize,
        }
    }

    /// Points of the borders of an element, with the first of its groups.
    fn held_in(&self, group: usize) -> &[BorderPoint] {
        let e = self.element_of(group);
        match self.groups_of(e).start == group {
            true => self.held(e),
            false => &[],
        }
    }

    /// Points of an element's borders where the normal is held.
    fn held(&self, e: usize) -> &[BorderPoint] {
        match self.starts.is_empty() {
            true => &[],
            false => &self.borders[self.starts[e] as usize..self.starts[e + 1] as usize],
        }
    }

    /// Energy and forces at displacements `u`, for any scalar.
    ///
    /// # Errors
    /// [`ElementFault`] where the strain is one that no deformation has.
    pub fn forces<D: DualNum<f64> + Copy>(
        &self,
        e: usize,
        u: &[V<D>; NODES],
    ) -> Result<(D, [V<D>; NODES]), ElementFault> {
        let (mut energy, mut forces) = (D::zero(), [[D::zero(); 3]; NODES]);
        for group in self.groups_of(e) {
            let strains = Strains::new(self, group, u);
            let (w, f) = with_sheet!(&self.plane, law => strains.forces(self, group, law))
                .map_err(|cause| fault(e, cause))?;
            energy += w;
            for (sum, f) in forces.iter_mut().zip(f) {
                (0..3).for_each(|c| sum[c] += f[c]);
            }
        }
        Ok((energy, forces))
    }

    /// Forces, tangent and energy at displacements `u`; with mixed integration points where there is a `correction` that led there.
    ///
    /// # Errors
    /// As [`Self::forces`].
    pub fn evaluate(
        &self,
        e: usize,
        u: &[Vec3; NODES],
        correction: Option<&[Vec3; NODES]>,
        out: &mut NurbsSystem,
    ) -> Result<(), ElementFault> {
        let u: [V<f64>; NODES] = u.map(Into::into);
        let correction: Option<[V<f64>; NODES]> = correction.map(|du| du.map(Into::into));
        out.f.fill(0.0);
        out.k.fill(0.0);
        out.energy = 0.0;
        for group in self.groups_of(e) {
            let strains = Strains::new(self, group, &u);
            let bent = correction
                .as_ref()
                .map(|du| strain::quadratic(self, group, du));
            with_sheet!(&self.plane, law => tangent::linearize(&strains, self, group, law, bent.as_ref(), out))
                .map_err(|cause| fault(e, cause))?;
        }
        Ok(())
    }

    /// Forces at displacements `u`; returns the energy.
    ///
    /// # Errors
    /// As [`Self::forces`].
    pub fn residual(
        &self,
        e: usize,
        u: &[Vec3; NODES],
        f: &mut [f64; DOFS],
    ) -> Result<f64, ElementFault> {
        let u: [V<f64>; NODES] = u.map(Into::into);
        let (energy, forces) = self.forces(e, &u)?;
        for (f, force) in f.iter_mut().zip(forces.as_flattened()) {
            *f = *force;
        }
        Ok(energy)
    }
}

fn fault(e: usize, cause: FaultCause) -> ElementFault {
    ElementFault {
        element: e as u32,
        cause,
    }
}
