//! Integrals of the difference of two fields.
use super::super::sample::{Difference, Note};
use super::cell::{Kind, Shape};
use super::tree::Tree;
use super::{Field, MOST};
use crate::fem::gauss;

/// Times this close, relative to their size, are the same.
const SAME_TIME: f64 = 1e-9;
/// Distances of points from the other mesh that are told, relative to the size of its cells.
const TOLD: f64 = 1e-6;
/// Distances at which the meshes are of different bodies.
const APART: f64 = 0.25;
/// Difference of volumes that is told, relative.
const VOLUMES: f64 = 0.01;

/// Roots of the mean squares of the difference and of the reference over the reference's mesh, without the cells where either
/// is NaN.
pub(super) fn difference(field: &Field, reference: &Field) -> Result<Difference, String> {
    alike(field, reference)?;
    let tree = Tree::new(&field.cells, &field.points);
    let mut rules = Rules::default();
    let components = reference.components;
    let (mut apart, mut size, mut volume, mut left_out) = (0.0, 0.0, 0.0, 0.0);
    let (mut farthest, mut largest) = (0.0_f64, 0.0_f64);
    let mut hint = 0;
    for (number, cell) in reference.cells.iter().enumerate() {
        let placed = cell.placed(&reference.points);
        for (weight, shape) in rules.of(cell.kind)? {
            let dv = weight * placed.measure(shape);
            let there = value(reference, number, shape);
            if there[..components].iter().any(|v| v.is_nan()) {
                left_out += dv;
                continue;
            }
            let found = tree.nearest(&placed.position(shape), hint);
            hint = found.cell;
            farthest = farthest.max(found.distance / found.size);
            largest = largest.max(found.distance);
            let here = value(field, hint, &field.cells[hint].kind.at(found.xi));
            if here[..components].iter().any(|v| v.is_nan()) {
                left_out += dv;
                continue;
            }
            volume += dv;
            for (a, b) in here[..components].iter().zip(&there) {
                apart += dv * (a - b) * (a - b);
                size += dv * b * b;
            }
        }
    }
    if farthest > APART {
        return Err(format!(
            "the meshes fill different regions: a point of the reference is {largest:.1e} away from the other mesh"
        ));
    }
    let whole = volume + left_out;
    if !(whole > 0.0 && whole.is_finite()) {
        return Err("the cells of the reference mesh have no volume".into());
    }
    if volume <= 0.0 {
        return Err("one of the fields is NaN everywhere".into());
    }
    let mut notes = Vec::new();
    let mut note = |text: &str, detail: String| {
        notes.push(Note {
            text: text.to_string(),
            detail: Some(detail),
        });
    };
    if left_out > 0.0 {
        let text = "where a field is NaN, it is left out of the norm";
        note(
            text,
            format!("{:.3} % of the region", 100.0 * left_out / whole),
        );
    }
    if farthest > TOLD {
        let text = "points outside of the other mesh take the value of its nearest place";
        note(text, format!("up to {largest:.1e} away"));
    }
    let other = measure(field, &mut rules)?;
    if (other / whole - 1.0).abs() > VOLUMES {
        let text = "the region that the mesh fills has not the size of the reference's";
        note(text, format!("{:.3} of it", other / whole));
    }
    Ok(Difference {
        distance: (apart / volume).sqrt(),
        size: (size / volume).sqrt(),
        notes,
    })
}

/// Fields that can be subtracted.
fn alike(field: &Field, reference: &Field) -> Result<(), String> {
    let (t, at) = (field.time, reference.time);
    if (t - at).abs() > SAME_TIME * t.abs().max(at.abs()) {
        return Err(format!(
            "its last results are those of time {t}, those of the reference of time {at}"
        ));
    }
    if field.components != reference.components {
        return Err(format!(
            "the field has {} components, that of the reference {}",
            field.components, reference.components
        ));
    }
    Ok(())
}

/// Value of a field in one of its cells; NaN where that of a node is.
fn value(field: &Field, cell: usize, shape: &Shape) -> [f64; MOST] {
    let mut sum = [0.0; MOST];
    if field.by_cell {
        sum[..field.components].copy_from_slice(field.value(cell, 0));
        return sum;
    }
    for node in 0..field.cells[cell].kind.nodes() {
        for (sum, v) in sum.iter_mut().zip(field.value(cell, node)) {
            *sum += shape.n[node] * v;
        }
    }
    sum
}

/// Volume or area of all cells.
fn measure(field: &Field, rules: &mut Rules) -> Result<f64, String> {
    let mut sum = 0.0;
    for cell in &field.cells {
        let placed = cell.placed(&field.points);
        for (weight, shape) in rules.of(cell.kind)? {
            sum += weight * placed.measure(shape);
        }
    }
    Ok(sum)
}

/// Shape functions at the points of integration, for every kind of cell once.
#[derive(Default)]
struct Rules {
    known: Vec<(Kind, Vec<(f64, Shape)>)>,
}

impl Rules {
    /// One Gauss point more than nodes in every direction: squares of the field are integrated exactly where cells are
    /// parallelepipeds.
    fn of(&mut self, kind: Kind) -> Result<&[(f64, Shape)], String> {
        let place = match self.known.iter().position(|(known, _)| *known == kind) {
            Some(place) => place,
            None => {
                self.known.push((kind, rule(kind)?));
                self.known.len() - 1
            }
        };
        Ok(&self.known[place].1)
    }
}

fn rule(kind: Kind) -> Result<Vec<(f64, Shape)>, String> {
    let line = |nodes: u8| gauss(nodes as usize + 1).map_err(|e| e.to_string());
    let (along_r, along_s) = (line(kind.plane[0])?, line(kind.plane[1])?);
    let along_t: Vec<(f64, f64)> = match kind.layers {
        1 => vec![(0.0, 1.0)],
        layers => line(layers)?.iter().collect(),
    };
    let mut points = Vec::new();
    for &(t, wt) in &along_t {
        for (s, ws) in along_s.iter() {
            for (r, wr) in along_r.iter() {
                points.push((wr * ws * wt, kind.at([r, s, t])));
            }
        }
    }
    Ok(points)
}
