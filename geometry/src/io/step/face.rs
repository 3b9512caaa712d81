//! Faces as trimmed patches.

use super::bounds::{self, Bound};
use super::entity::{Entity, Told};
use super::place::Frame;
use super::scope::Scope;
use super::surface::{Shape, Surface};
use super::surface_read;
use crate::io::brep::{
    BasePatch, Boundary, Face, GAP, Grant, Host, Tally, add, approximation, bounds_outside, grown,
    loops, widest_gap,
};
use crate::io::report::{FaceBorder, SkipKind, TrimReport};
use crate::trim::Trimmed;
use crate::{NurbsPatch, Vec3};
use std::f64::consts::{PI, TAU};

/// Gaps between edges that follow each other are closed up to this share of the size of their surface.
const BRIDGE: f64 = 1e-3;

/// A face that was read.
pub struct FacePatch {
    /// Its normal is that of the face.
    pub patch: NurbsPatch,
    pub border: FaceBorder,
    /// The surface that carries it.
    pub base: u32,
}

/// A reason to skip a face.
pub type Refusal = (SkipKind, String);

/// What reading faces adds to.
pub struct Account<'n> {
    pub grant: &'n Grant,
    pub trims: &'n mut TrimReport,
    pub notes: &'n mut Vec<String>,
}

impl Account<'_> {
    fn note(&mut self, entity: &Entity, text: &str) {
        self.notes.push(format!("{}: {text}", entity.describe()));
    }

    /// Says where a patch is not what the surface entity defines, once for each surface.
    fn approximated(&mut self, carrier: &Entity, base: &BasePatch) {
        if let Some(text) = approximation(std::slice::from_ref(base)) {
            let note = format!("{}: {text}", carrier.describe());
            if !self.notes.contains(&note) {
                self.notes.push(note);
            }
        }
    }
}

fn surface_fault(reason: String) -> Refusal {
    (SkipKind::Surface, reason)
}

fn boundary_fault(reason: String) -> Refusal {
    (SkipKind::Boundary, reason)
}

/// Reads a FACE: of a surface with bounds, or of a plane through the corners of its loops.
pub fn face(scope: &Scope, entity: &Entity, account: &mut Account) -> Result<FacePatch, Refusal> {
    account.grant.open().map_err(surface_fault)?;
    let list = entity
        .targets("FACE", 0, "a bound of a face")
        .map_err(boundary_fault)?;
    if !entity.is("FACE_SURFACE") {
        let surface = plane_of(scope, &list).map_err(surface_fault)?;
        let bounds = list.iter().map(|&b| bounds::bound(scope, b, None, false));
        let bounds = bounds.collect::<Told<Vec<_>>>().map_err(boundary_fault)?;
        return bounded(
            scope,
            entity,
            entity.index,
            (surface, bounds, true, true),
            account,
        );
    }
    let base = entity
        .reference("FACE_SURFACE", 0, "the surface of a face")
        .map_err(surface_fault)?;
    let same = entity
        .flag("FACE_SURFACE", 1, "the sense of a face")
        .map_err(surface_fault)?;
    let carrier = Entity::read(scope.exchange, base).map_err(surface_fault)?;
    if carrier.is("CURVE_BOUNDED_SURFACE") {
        let text = format!(
            "lies on {}, which has bounds of its own",
            carrier.describe()
        );
        return Err((SkipKind::Unsupported, text));
    }
    let surface = surface_read::read(scope, base).map_err(surface_fault)?;
    let read = list
        .iter()
        .map(|&b| bounds::bound(scope, b, Some((base, &surface)), !same));
    let read = read.collect::<Told<Vec<_>>>().map_err(boundary_fault)?;
    bounded(scope, entity, base, (surface, read, true, same), account)
}

/// Reads a CURVE_BOUNDED_SURFACE: a surface, its boundaries, and whether its own border is the outer one.
pub fn curve_bounded(
    scope: &Scope,
    entity: &Entity,
    account: &mut Account,
) -> Result<FacePatch, Refusal> {
    account.grant.open().map_err(surface_fault)?;
    let kind = "CURVE_BOUNDED_SURFACE";
    let what = "the base of a bounded surface";
    let base = entity.reference(kind, 0, what).map_err(surface_fault)?;
    let list = entity
        .targets(kind, 1, "a boundary")
        .map_err(boundary_fault)?;
    let natural = entity.flag(
        kind,
        2,
        "whether the border of the surface is the outer one",
    );
    let natural = natural.map_err(boundary_fault)?;
    let surface = surface_read::read(scope, base).map_err(surface_fault)?;
    let read = list
        .iter()
        .map(|&b| bounds::boundary(scope, b, (base, &surface)).map(Bound::Curves));
    let read = read.collect::<Told<Vec<_>>>().map_err(boundary_fault)?;
    bounded(
        scope,
        entity,
        base,
        (surface, read, !natural, true),
        account,
    )
}

/// A surface that stands alone.
pub fn whole(scope: &Scope, entity: &Entity, account: &mut Account) -> Result<FacePatch, Refusal> {
    account.grant.open().map_err(surface_fault)?;
    let surface = surface_read::read(scope, entity.index).map_err(surface_fault)?;
    let reason = |e: String| (SkipKind::Unsupported, format!("{} {e}", entity.describe()));
    let base = surface.whole().map_err(reason)?;
    account.grant.patch(&base.patch).map_err(surface_fault)?;
    account.approximated(entity, &base);
    let patch = base.patch;
    Ok(FacePatch {
        patch,
        border: FaceBorder::Natural,
        base: entity.index,
    })
}

/// The plane of corners, by Newell's sums.
fn plane_of(scope: &Scope, list: &[u32]) -> Told<Surface> {
    let mut normal = Vec3::zeros();
    let mut origin = None;
    for &bound in list {
        let corners = bounds::corners(scope, bound)?;
        let next = corners.iter().skip(1).chain(corners.first());
        let start = *origin.get_or_insert(corners.first().copied().unwrap_or_default());
        for (a, b) in corners.iter().zip(next) {
            normal += (a - start).cross(&(b - start));
        }
    }
    let size = normal.norm();
    match origin {
        Some(origin) if size > 0.0 && size.is_finite() => Ok(Surface {
            shape: Shape::Plane,
            frame: Frame {
                origin,
                axes: super::place::triad(normal / size, None),
            },
            angle: scope.angle,
        }),
        _ => Err("names no surface, and its corners span no plane".to_owned()),
    }
}

/// A surface with loops; the first flag says that one of them is the outer one, the second that the face has the normal of the
/// surface.
fn bounded(
    scope: &Scope,
    entity: &Entity,
    base: u32,
    (surface, bounds, outer, same): (Surface, Vec<Bound>, bool, bool),
    account: &mut Account,
) -> Result<FacePatch, Refusal> {
    let carrier = Entity::read(scope.exchange, base).map_err(surface_fault)?;
    let on = |e: String| match base == entity.index {
        true => e,
        false => format!("{e} on {}", carrier.describe()),
    };
    let mut points = Vec::new();
    let mut boundaries: Vec<Boundary> = Vec::new();
    for bound in bounds {
        match bound {
            Bound::Curves(boundary) => {
                points.extend(control_points(&boundary));
                boundaries.push(boundary);
            }
            Bound::Vertex(x) => points.push(x),
        }
    }
    // One loop alone that goes round a cone has its tip inside.
    if let Some(tip) = surface.tip()
        && boundaries
            .iter()
            .filter(|b| goes_round(b, surface.axis()))
            .count()
            == 1
    {
        points.push(tip);
    }
    let patch = surface.sized(&points).map_err(|e| surface_fault(on(e)))?;
    account.grant.patch(&patch.patch).map_err(surface_fault)?;
    account.approximated(&carrier, &patch);
    let (patch, border) = match boundaries.is_empty() {
        true => (patch.patch, FaceBorder::Natural),
        false => {
            let face = Face {
                base: 0,
                boundaries,
                outer,
                values: 0,
                fault: None,
            };
            let trimmed = trimmed(scope, entity, &patch, &face, account);
            trimmed.map_err(|e| boundary_fault(on(e)))?
        }
    };
    let patch = match same {
        true => patch,
        false => patch
            .reversed(0)
            .map_err(|e| surface_fault(e.to_string()))?,
    };
    Ok(FacePatch {
        patch,
        border,
        base,
    })
}

/// Whether the curves in space of a boundary go round an axis: the angles that their control points turn by, in sum.
fn goes_round(boundary: &Boundary, [foot, axis]: [Vec3; 2]) -> bool {
    let [e1, e2, _] = super::place::triad(axis, None);
    let mut angles = control_points(boundary).map(|x| {
        let d = x - foot;
        d.dot(&e2).atan2(d.dot(&e1))
    });
    let Some(first) = angles.next() else {
        return false;
    };
    let (mut last, mut sum) = (first, 0.0);
    for angle in angles.chain([first]) {
        let step = angle - last;
        sum += step - TAU * (step / TAU).round();
        last = angle;
    }
    sum.abs() > PI
}

/// Control points of the curves in space.
fn control_points(boundary: &Boundary) -> impl Iterator<Item = Vec3> + '_ {
    let curves = boundary
        .stretches
        .iter()
        .flat_map(|s| &s.space)
        .map(|p| &p.curve);
    curves
        .flat_map(|c| c.homogeneous())
        .map(|p| Vec3::new(p[0], p[1], p[2]) / p[3])
}

/// A patch trimmed by the boundaries of a face.
fn trimmed(
    scope: &Scope,
    entity: &Entity,
    base: &BasePatch,
    face: &Face,
    account: &mut Account,
) -> Result<(NurbsPatch, FaceBorder), String> {
    let grown = grown(base, face, scope.near, account.grant);
    let patch = grown.as_ref().map_or(&base.patch, |g| &g.patch);
    let host = Host::new(patch, &base.parameters, scope.near, account.grant);
    let [curves, points] = face.extent();
    account.grant.boundary(curves, points)?;
    let (mut said, mut tally) = (Vec::new(), Tally::default());
    let mut trimmed = by_loops(&host, face, &mut tally, &mut said);
    let mut bridged = None;
    if trimmed.is_err() {
        // Edges of a loop share their vertices: what is between their ends is a gap of the file's making, if it is small.
        let wide = Host::new(patch, &base.parameters, scope.near, account.grant);
        let wide = wide.bridging(BRIDGE * host.size);
        let (mut again, mut closed) = (Vec::new(), Tally::default());
        if let Ok(made) = by_loops(&wide, face, &mut closed, &mut again)
            && closed.bridged > 0
        {
            bridged = Some((closed.bridged, closed.largest_bridge));
            (trimmed, tally, said) = (Ok(made), closed, again);
        }
    }
    for text in said {
        account.note(entity, &text);
    }
    let trimmed = trimmed?;
    if let Some((n, widest)) = bridged {
        let text =
            format!("{n} gap(s) of up to {widest:.1e} between its boundary curves were closed");
        account.note(entity, &text);
    }
    if let Some(grown) = grown.filter(|g| g.continued > 0.0) {
        let share = grown.continued;
        let text = format!(
            "its boundary leaves the surface, which was continued by {share:.1e} of its range"
        );
        account.note(entity, &text);
    }
    add(account.trims, &tally);
    let border = match trimmed.patch.trim() {
        Some(_) => FaceBorder::Trimmed,
        None => FaceBorder::Rectangle,
    };
    Ok((trimmed.patch, border))
}

/// The surface of a host trimmed by the loops of a face.
fn by_loops(
    host: &Host,
    face: &Face,
    tally: &mut Tally,
    said: &mut Vec<String>,
) -> Result<Trimmed, String> {
    tally.tolerance = host.agree;
    let loops = loops(host, &face.boundaries, true, tally, said)?;
    // A loop on a closed surface bounds the part to its left, be it the larger one.
    let outer = face.outer && !bounds_outside(host, &loops);
    let gap = match tally.bridged {
        0 => GAP,
        _ => GAP.max(1.001 * widest_gap(host, &loops)),
    };
    let trimmed = host.patch.trimmed_by(loops, outer, gap);
    trimmed.map_err(|e| e.to_string())
}
