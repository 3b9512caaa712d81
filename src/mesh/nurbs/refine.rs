//! A patch as a file gives it made bicubic and fine, without a change of shape.
use super::{Border, Cut, DEGREE, Joints, NurbsError, NurbsSheet, Seam, SheetPatch};
use covact_geometry::{NurbsPatch, Vec3};
use std::collections::BTreeMap;

/// Largest motion of the surface under refinement, as a part of its size.
const MOVED: f64 = 1e-12;

/// Points along either direction at which it is measured.
const SAMPLES: usize = 15;

/// Most knot spans.
const MOST: u64 = 4_000_000;

/// How fine the elements are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fineness {
    /// Longest side of an element (length).
    Size(f64),
    /// About so many elements along xi1 and xi2; one for each knot span of the file at least.
    Elements([u32; 2]),
}

impl NurbsSheet {
    /// A patch as a shell. Its shape is checked not to have moved.
    ///
    /// # Errors
    /// [`NurbsError`] for what cannot be a sheet of bicubic elements.
    pub fn new(
        patch: &NurbsPatch,
        thickness: f64,
        fineness: Fineness,
        assumed_membrane: bool,
    ) -> Result<NurbsSheet, NurbsError> {
        Self::joined(&[(1, patch.clone())], thickness, fineness, assumed_membrane)
            .map_err(|(_, error)| error)
    }

    /// Patches, each with the number of its face, as one shell, joined along their common edges. Patches are turned over so
    /// that the top of each is on the side of the first one's.
    ///
    /// # Errors
    /// [`NurbsError`] for what cannot be a sheet of bicubic elements, with the place of the patch.
    pub fn joined(
        faces: &[(u32, NurbsPatch)],
        thickness: f64,
        fineness: Fineness,
        assumed_membrane: bool,
    ) -> Result<NurbsSheet, (usize, NurbsError)> {
        let mut elements = 0;
        let mut fine = Vec::with_capacity(faces.len());
        for (k, (_, patch)) in faces.iter().enumerate() {
            let trim = patch.trim().cloned();
            let patch = refined(patch, fineness, &mut elements).map_err(|e| (k, e))?;
            fine.push(patch.with_trim(trim));
        }
        let all: Vec<&NurbsPatch> = fine.iter().collect();
        let mut joints = Joints::new(&all, thickness);
        if let Some(pair) = twice(&all, &joints, thickness) {
            let faces = pair.map(|k| faces[k].0);
            return Err((pair[1], NurbsError::Twice { faces }));
        }
        let turned = joints.turned(fine.len()).map_err(|pair| {
            let faces = pair.map(|k| faces[k].0);
            (pair[1], NurbsError::OneSided { faces })
        })?;
        if turned.contains(&true) {
            for (k, patch) in fine.iter_mut().enumerate().filter(|(k, _)| turned[*k]) {
                *patch = patch.reversed(0).map_err(|e| (k, e.into()))?;
            }
            let all: Vec<&NurbsPatch> = fine.iter().collect();
            joints = Joints::new(&all, thickness);
        }
        let (mut first_node, mut first_element) = (0, 0);
        let mut patches = Vec::with_capacity(fine.len());
        for ((patch, reversed), (face, _)) in fine.into_iter().zip(turned).zip(faces) {
            let cut = patch.trim().and_then(|trim| Cut::new(&patch, trim));
            if cut.as_ref().is_some_and(Cut::is_empty) {
                return Err((patches.len(), NurbsError::Empty));
            }
            let part = SheetPatch {
                patch: patch.with_trim(None),
                face: *face,
                reversed,
                first_node,
                first_element,
                cut,
            };
            first_node += part.nodes() as u32;
            first_element += part.elements() as u32;
            patches.push(part);
        }
        Ok(NurbsSheet {
            patches,
            joints,
            thickness,
            assumed_membrane,
            edge_sets: BTreeMap::new(),
            anchors: Vec::new(),
        })
    }
}

/// Two patches that are joined along all of their edges and are near each other in their middle.
fn twice(patches: &[&NurbsPatch], joints: &Joints, thickness: f64) -> Option<[usize; 2]> {
    let middle = |k: usize| patches[k].point(patches[k].domain().map(|[a, b]| 0.5 * (a + b)));
    let whole = |seam: &&Seam| seam.edges.iter().all(|e| matches!(e, Border::Edge(_)));
    let pairs = (joints.seams.iter().filter(whole)).map(|seam| seam.edges.map(Border::patch));
    pairs.clone().find(|pair| {
        pairs.clone().filter(|other| other == pair).count() >= 4
            && (middle(pair[0]) - middle(pair[1])).norm() < thickness
    })
}

/// A patch raised to degree 3 and cut into elements, whose numbers are added up. Its shape is checked not to have moved.
fn refined(
    patch: &NurbsPatch,
    fineness: Fineness,
    total: &mut u64,
) -> Result<NurbsPatch, NurbsError> {
    let given = patch.clone().with_trim(None).cut_to_domain()?;
    let [low, high] = given.bounds();
    let size = (high - low).norm();
    let poles = given.degenerate_edges(1e-9 * size);
    if let Some(edge) = poles.iter().position(|p| *p) {
        return Err(NurbsError::Pole { edge });
    }
    let mut fine = given.clone();
    for direction in 0..2 {
        let degree = fine.degree()[direction];
        let missing =
            (DEGREE.checked_sub(degree)).ok_or(NurbsError::Degree { direction, degree })?;
        if let Some(&value) = fine.crease_knots(direction).first() {
            return Err(NurbsError::Crease { direction, value });
        }
        fine = fine.elevated(direction, missing)?;
    }
    closed(&given, size)?;
    let mut knots = [Vec::new(), Vec::new()];
    let mut elements = 1;
    for (direction, knots) in knots.iter_mut().enumerate() {
        let lengths = lengths(&fine, direction);
        let whole: f64 = lengths.iter().sum();
        let pieces = |length: f64| match fineness {
            // A hair less than a whole number is that number.
            Fineness::Size(size) => (length / size - 1e-9).ceil().max(1.0),
            Fineness::Elements(counts) => (f64::from(counts[direction]) * length / whole)
                .round()
                .max(1.0),
        };
        let counts: Vec<f64> = lengths.iter().map(|l| pieces(*l)).collect();
        elements = u64::saturating_mul(elements, counts.iter().sum::<f64>() as u64);
        if elements.saturating_add(*total) > MOST {
            return Err(NurbsError::TooMany {
                elements: elements.saturating_add(*total),
                limit: MOST,
            });
        }
        for ([a, b], n) in fine.spans(direction).into_iter().zip(counts) {
            let n = n as usize;
            knots.extend((1..n).map(|k| a + (b - a) * k as f64 / n as f64));
        }
    }
    for (direction, knots) in knots.iter().enumerate() {
        fine = fine.insert_knots(direction, knots)?;
    }
    *total += elements;
    verify(&fine, &given, size)?;
    Ok(fine)
}

/// Compares with the surface that it was made of, at a grid of points.
fn verify(fine: &NurbsPatch, given: &NurbsPatch, size: f64) -> Result<(), NurbsError> {
    let [u, v] = given.domain();
    let at = |[a, b]: [f64; 2], k: usize| a + (b - a) * k as f64 / (SAMPLES - 1) as f64;
    let mut moved = 0.0f64;
    for j in 0..SAMPLES {
        for i in 0..SAMPLES {
            let xi = [at(u, i), at(v, j)];
            let jet = fine.jet(xi);
            moved = moved.max((jet.rho - given.point(xi)).norm() / size);
            if covact_geometry::Frame::new(&jet, 1.0).is_none() {
                return Err(NurbsError::NoNormal { at: jet.rho.into() });
            }
        }
    }
    match moved <= MOVED {
        true => Ok(()),
        false => Err(NurbsError::Moved {
            moved,
            limit: MOVED,
        }),
    }
}

/// Opposite edges that are one curve would have to move together.
fn closed(patch: &NurbsPatch, size: f64) -> Result<(), NurbsError> {
    let domain = patch.domain();
    for direction in 0..2 {
        let [a, b] = domain[1 - direction];
        let apart = |k: usize| {
            let along = a + (b - a) * k as f64 / 8.0;
            let at = |end: usize| {
                let mut xi = [along; 2];
                xi[direction] = domain[direction][end];
                patch.point(xi)
            };
            (at(0) - at(1)).norm()
        };
        if (0..=8).all(|k| apart(k) <= 1e-9 * size) {
            return Err(NurbsError::Closed {
                edges: [2 * direction, 2 * direction + 1],
            });
        }
    }
    Ok(())
}

/// Longest length of every span along a direction: over three lines of the other one, by chords.
pub(super) fn lengths(patch: &NurbsPatch, direction: usize) -> Vec<f64> {
    const CHORDS: usize = 8;
    let [a, b] = patch.domain()[1 - direction];
    let line = |along: f64, [from, to]: [f64; 2]| {
        let at = |k: usize| -> Vec3 {
            let mut xi = [along; 2];
            xi[direction] = from + (to - from) * k as f64 / CHORDS as f64;
            patch.point(xi)
        };
        (0..CHORDS).map(|k| (at(k + 1) - at(k)).norm()).sum::<f64>()
    };
    (patch.spans(direction).into_iter())
        .map(|span| {
            let lines = [a, 0.5 * (a + b), b].map(|along| line(along, span));
            lines.into_iter().fold(0.0, f64::max)
        })
        .collect()
}
