//! From the boundary curves of a JSON file to a trimmed patch, by way of `brep` as in IGES and STEP.

use super::Content;
use crate::curve::NurbsCurve;
use crate::io::brep::{
    BasePatch, Boundary, GAP, Grant, Host, Part, Preference, Stretch, Tally, add, loops,
};
use crate::io::report::FaceBorder;
use crate::trim::TrimNoteKind;
use crate::{NurbsPatch, Vec3};
use nalgebra::Vector2;

/// Gaps between curves as they are listed, as shares of the domain, above which directions that close them are preferred.
const FOLLOW: f64 = 1e-4;

/// A boundary curve and whether its loop runs through it backwards.
pub struct Side {
    pub curve: NurbsCurve<2>,
    /// The same curve in space, in either direction, where the file gives it.
    pub space: Option<NurbsCurve<3>>,
    pub backwards: bool,
    /// Number of the edge that neighbours share.
    pub entity: u32,
}

/// A patch with its loops (the first the outer one, where `has_outer`) and what bounds it. What is noticed goes to the
/// content's notes behind `name`. The message says why there is no such patch.
pub fn trimmed(
    content: &mut Content,
    grant: &Grant,
    name: &str,
    patch: NurbsPatch,
    sides: Vec<Vec<Side>>,
    has_outer: bool,
) -> Result<(NurbsPatch, FaceBorder), String> {
    let mut said = Vec::new();
    let base = BasePatch::exact(patch);
    let resolution = content.resolution.unwrap_or(0.0);
    let host = Host::new(&base.patch, &base.parameters, resolution, grant);
    let mut boundaries = Vec::with_capacity(sides.len());
    let (mut curves, mut points) = (0, 0);
    for (number, sides) in sides.into_iter().enumerate() {
        let of_loop = format!("trim loop {number}");
        let extent = [host.extent(0), host.extent(1)];
        let stated = gap(&sides, extent, |side| side.backwards);
        // Writers disagree about what the direction of a curve refers to.
        let as_drawn = gap(&sides, extent, |_| false);
        let ignore = sides.iter().any(|s| s.backwards) && stated > FOLLOW && as_drawn <= FOLLOW;
        if ignore {
            said.push(format!(
                "{of_loop}: the curves follow each other as they are, not in the directions stated"
            ));
        }
        let mut stretches = Vec::with_capacity(sides.len());
        for side in sides {
            curves += 1;
            points += side.curve.homogeneous().len();
            points += side.space.as_ref().map_or(0, |c| c.homogeneous().len());
            stretches.push(stretch(&base.patch, side, ignore).map_err(|e| e.to_string())?);
        }
        boundaries.push(Boundary {
            name: of_loop,
            stretches,
        });
    }
    grant.boundary(curves, points)?;
    let mut tally = Tally {
        tolerance: host.agree,
        ..Tally::default()
    };
    let made = loops(&host, &boundaries, false, &mut tally, &mut said)?;
    let trimmed = base.patch.trimmed_by(made, has_outer, GAP);
    let trimmed = trimmed.map_err(|e| e.to_string())?;
    let mut rectangle = false;
    for note in &trimmed.notes {
        let text = match note.kind {
            TrimNoteKind::Gap(curve, gap) if gap > 1e-9 => {
                format!("a gap of {gap:.1e} of the domain after curve {curve} was closed")
            }
            TrimNoteKind::ZeroArea => "it has no area and was left out".to_owned(),
            TrimNoteKind::SelfIntersecting => {
                "it crosses itself; inside is where a ray crosses it an odd number of times"
                    .to_owned()
            }
            TrimNoteKind::Outside => "it lies outside of the domain and was left out".to_owned(),
            TrimNoteKind::Rectangle(_) => {
                rectangle = true;
                continue;
            }
            TrimNoteKind::Shifted(_) => "it was moved by a period of the surface".to_owned(),
            TrimNoteKind::Seam(dir, at) => {
                format!(
                    "the seam of the surface in direction {} was moved to {at}",
                    dir + 1
                )
            }
            TrimNoteKind::Gap(..) => continue,
        };
        said.push(format!("trim loop {}: {text}", note.loop_number));
    }
    add(&mut content.trims, &tally);
    let told = said.into_iter().map(|text| format!("{name}: {text}"));
    content.notes.extend(told);
    let border = match (trimmed.patch.trim().is_some(), rectangle || has_outer) {
        (true, _) => FaceBorder::Trimmed,
        (false, true) => FaceBorder::Rectangle,
        (false, false) => FaceBorder::Natural,
    };
    Ok((trimmed.patch, border))
}

/// A curve in the direction of its loop, with the curve in space turned to run alike.
fn stretch(
    patch: &NurbsPatch,
    side: Side,
    ignore: bool,
) -> Result<Stretch, crate::curve::CurveError> {
    let curve = match side.backwards && !ignore {
        true => side.curve.reversed()?,
        false => side.curve,
    };
    let entity = side.entity;
    let ends: [Vec3; 2] = curve.ends().map(|xi: Vector2<f64>| {
        let inside = |d: usize| {
            let [a, b] = patch.domain()[d];
            xi[d].clamp(a, b)
        };
        patch.point([inside(0), inside(1)])
    });
    let space = match side.space {
        None => Vec::new(),
        Some(space) => {
            let [a, b] = space.ends();
            let along = (a - ends[0]).norm() + (b - ends[1]).norm();
            let against = (a - ends[1]).norm() + (b - ends[0]).norm();
            let curve = if against < along {
                space.reversed()?
            } else {
                space
            };
            vec![Part { entity, curve }]
        }
    };
    Ok(Stretch {
        parameter: vec![Part { entity, curve }],
        space,
        preference: Preference::None,
        edge: entity,
    })
}

/// Largest gap between curves that follow each other, as a share of the domain.
fn gap(sides: &[Side], extent: [f64; 2], backwards: impl Fn(&Side) -> bool) -> f64 {
    let ends: Vec<_> = sides
        .iter()
        .map(|side| {
            let [a, b] = side.curve.ends();
            if backwards(side) { [b, a] } else { [a, b] }
        })
        .collect();
    let gaps = (0..ends.len()).map(|k| {
        let d = ends[k][1] - ends[(k + 1) % ends.len()][0];
        (d.x / extent[0]).abs().max((d.y / extent[1]).abs())
    });
    gaps.fold(0.0, f64::max)
}
