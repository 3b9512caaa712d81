//! What `covact inspect` finds in a CAD file.
use super::extent::{extent, join};
use covact_geometry::io::{
    CadBody, CadFile, CadFormat, EntityCount, FaceBorder, Healing, LengthUnit, SkipKind, Skipped,
    TrimReport, entity_name,
};
use covact_geometry::project::{Border, CurvatureExtreme, CurvatureRange, Gap, Overlap};
use covact_geometry::{NurbsPatch, PatchSet, Vec3};
use serde::Serialize;
use std::collections::BTreeMap;

/// What is in a CAD file. Lengths are in the unit of the file.
#[derive(Debug, Serialize)]
pub(super) struct Findings<'a> {
    pub file: &'a str,
    pub format: CadFormat,
    pub unit: &'a LengthUnit,
    /// Smallest distance between two points that the writer tells apart.
    pub resolution: Option<f64>,
    pub entities: &'a [EntityCount],
    pub summary: Summary,
    /// What became of the boundary curves.
    pub trims: &'a TrimReport,
    /// Solids and sheets, where the file says which patches make one.
    pub bodies: &'a [CadBody],
    pub patches: Vec<Patch<'a>>,
    pub skipped: &'a [Skipped],
    /// Slivers and duplicates that were left out.
    pub healing: &'a Healing,
    pub notes: &'a [String],
    /// None when no patch was read.
    pub surface: Option<Surface>,
}

#[derive(Debug, Serialize)]
pub(super) struct Summary {
    pub patches: usize,
    /// Of these: with a trim.
    pub trimmed: usize,
    /// Of these: with a border that is a rectangle of parameters, to which their domain was narrowed.
    pub rectangles: usize,
    pub skipped: usize,
    pub skipped_by_kind: BTreeMap<SkipKind, usize>,
}

#[derive(Debug, Serialize)]
pub(super) struct Patch<'a> {
    /// Number that scenes select it by.
    pub entity: u32,
    pub type_number: u32,
    /// Name of that type, in IGES.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub type_name: Option<&'static str>,
    /// Number of the surface that carries a face.
    pub base: u32,
    /// Number of the entity that places this copy; 0 where it stands where it is defined.
    pub instance: u32,
    pub name: Option<&'a str>,
    /// Number in the list of bodies, from 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub body: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layer: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub colour: Option<&'a str>,
    pub border: FaceBorder,
    pub trimmed: bool,
    pub degree: [usize; 2],
    pub control_points: [usize; 2],
    pub rational: bool,
    /// Lowest and highest corner of a box around what belongs to the surface.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// Of what belongs to the surface.
    pub area: Option<f64>,
    pub curvature: Option<Curvature>,
    /// Why bounds, area and curvature are not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fault: Option<String>,
}

/// Smallest radii of curvature, sampled; none where nothing curves that way. The sense is that of the normal
/// rho_1 x rho_2 of the (first) patch in the file.
#[derive(Debug, Serialize)]
pub(super) struct Curvature {
    pub smallest_convex_radius: Option<f64>,
    pub smallest_concave_radius: Option<f64>,
    /// Smallest and largest principal curvature (1 / length).
    pub range: [f64; 2],
    /// Points at which the surface has no tangent plane.
    pub singular_points: usize,
}

/// All patches together.
#[derive(Debug, Serialize)]
pub(super) struct Surface {
    pub bounds: [[f64; 3]; 2],
    pub area: f64,
    pub curvature: Curvature,
    /// Distance at which edges are taken for the same edge.
    pub tolerance: f64,
    pub shared_edges: usize,
    pub smooth_edges: usize,
    pub sharp_edges: usize,
    pub partly_shared_edges: usize,
    pub free_edges: usize,
    /// Edges that are one point.
    pub poles: usize,
    /// Edges at which more than two patches meet.
    pub branching_edges: usize,
    pub largest_gap: f64,
    pub largest_gap_at: Option<GapPlace>,
    /// Distance up to which gaps are no gaps.
    pub resolution: f64,
    /// Joints over wider gaps.
    pub bridged: Vec<GapPlace>,
    /// Free edges that come near each other without being joined.
    pub open_gaps: Vec<GapPlace>,
    /// Free edges near each other that were not joined because both patches leave them in the same direction.
    pub stacked: Vec<GapPlace>,
    pub overlaps: Vec<OverlapPlace>,
    pub borders: Vec<Rim>,
    pub parts: Vec<Part>,
    /// Faces that were turned over, because the normals of most of their part point to the other side.
    pub turned: Vec<TurnedFace>,
    /// Area of the largest of them.
    pub largest_turned: f64,
}

/// An edge of a patch: 0 to 3 are the sides of its domain (xi1 = start, end, xi2 = start, end), 4 + k trim curve k.
#[derive(Debug, Serialize)]
pub(super) struct EdgeName {
    pub entity: u32,
    /// Number in the list of patches, from 0.
    pub patch: u32,
    pub edge: u32,
}

#[derive(Debug, Serialize)]
pub(super) struct GapPlace {
    pub gap: f64,
    pub at: [f64; 3],
    pub edges: [EdgeName; 2],
}

/// A free edge that runs inside of another patch.
#[derive(Debug, Serialize)]
pub(super) struct OverlapPlace {
    pub edge: EdgeName,
    pub entity: u32,
    pub patch: u32,
    /// Share of the edge that lies in the patch.
    pub share: f64,
    /// Largest distance from the border of the patch.
    pub depth: f64,
    pub at: [f64; 3],
}

/// Free edges that follow each other: a closed one is the rim of the sheet or of a hole.
#[derive(Debug, Serialize)]
pub(super) struct Rim {
    pub length: f64,
    pub closed: bool,
    pub edges: Vec<EdgeName>,
}

/// Patches that hang together.
#[derive(Debug, Serialize)]
pub(super) struct Part {
    pub closed: bool,
    /// Whether it has one side only, so that distances from it carry no sign.
    pub one_sided: bool,
    /// What a closed part encloses.
    pub volume: Option<f64>,
    pub area: f64,
    /// Numbers in the list of patches, from 0.
    pub patches: Vec<usize>,
}

/// A face whose normal in the file does not agree with those of its neighbours.
#[derive(Debug, Serialize)]
pub(super) struct TurnedFace {
    pub entity: u32,
    /// Number in the list of patches, from 0.
    pub patch: usize,
    pub area: f64,
}

impl<'a> Findings<'a> {
    /// The set is that of all patches of the file, none where they make no set.
    /// If `brief`, nothing is measured that needs a search.
    pub fn new(file: &'a CadFile, set: Option<&PatchSet>, brief: bool) -> Self {
        let summary = file.summary();
        let patches = patches(file, brief);
        Findings {
            file: &file.path,
            format: file.format,
            unit: &file.unit,
            resolution: file.resolution,
            entities: &file.entities,
            summary: Summary {
                patches: summary.patches,
                trimmed: summary.trimmed,
                rectangles: summary.rectangles,
                skipped: summary.skipped,
                skipped_by_kind: summary.reasons.into_iter().collect(),
            },
            trims: &file.trims,
            bodies: &file.bodies,
            surface: set.map(|set| Surface::new(set, &patches)),
            patches,
            skipped: &file.skipped,
            healing: &file.healing,
            notes: &file.notes,
        }
    }
}

fn patches(file: &CadFile, brief: bool) -> Vec<Patch<'_>> {
    let one = |patch: &NurbsPatch| PatchSet::new(vec![patch.clone()], None);
    let patches = file.patches.iter().map(|p| {
        let (set, fault) = match brief {
            true => (None, None),
            false => match one(&p.patch) {
                Ok(set) => (Some(set), None),
                Err(e) => (None, Some(e.to_string())),
            },
        };
        Patch {
            entity: p.entity,
            type_number: p.type_number,
            type_name: (p.type_number > 0).then(|| entity_name(p.type_number, 0)),
            base: p.base,
            instance: p.instance,
            name: p.name.as_deref(),
            body: p.tags.body,
            layer: p.tags.layer.as_deref(),
            colour: p.tags.colour.as_deref(),
            border: p.border,
            trimmed: p.trimmed(),
            degree: p.patch.degree(),
            control_points: p.patch.counts(),
            rational: p.patch.is_rational(),
            bounds: set.as_ref().map(extent),
            area: set.as_ref().map(|s| s.areas().iter().sum()),
            curvature: set.as_ref().map(|s| Curvature::new(&s.curvature_range())),
            fault,
        }
    });
    patches.collect()
}

impl Curvature {
    fn new(range: &CurvatureRange) -> Self {
        let radius = |c: &Option<CurvatureExtreme>| c.map(|c| c.radius());
        let kappa = |c: &Option<CurvatureExtreme>| c.map_or(0.0, |c| c.kappa);
        Curvature {
            smallest_convex_radius: radius(&range.convex),
            smallest_concave_radius: radius(&range.concave),
            range: [kappa(&range.convex), kappa(&range.concave)],
            singular_points: range.skipped,
        }
    }
}

impl Surface {
    fn new(set: &PatchSet, patches: &[Patch]) -> Self {
        let edges = set.edges();
        let entity = |patch: u32| patches.get(patch as usize).map_or(0, |p| p.entity);
        let name = |&(patch, edge): &(u32, u32)| EdgeName {
            entity: entity(patch),
            patch,
            edge,
        };
        let corner = |x: &Vec3| [x.x, x.y, x.z];
        let gap = |g: &Gap| GapPlace {
            gap: g.gap,
            at: corner(&g.at),
            edges: [name(&g.edges[0]), name(&g.edges[1])],
        };
        let overlap = |o: &Overlap| OverlapPlace {
            edge: name(&o.edge),
            entity: entity(o.patch),
            patch: o.patch,
            share: o.share,
            depth: o.depth,
            at: corner(&o.at),
        };
        let rim = |b: &Border| Rim {
            length: b.length,
            closed: b.closed,
            edges: b.edges.iter().map(name).collect(),
        };
        let areas = set.areas();
        let part = |(members, volume): (&Vec<usize>, &Option<f64>)| Part {
            closed: volume.is_some(),
            one_sided: members.iter().any(|&p| set.sides()[p] == 0.0),
            volume: volume.map(f64::abs),
            area: members.iter().map(|&p| areas[p]).sum(),
            patches: members.clone(),
        };
        let turned: Vec<TurnedFace> = (set.components().iter())
            .flat_map(|members| turned(set, members, &areas))
            .map(|patch| TurnedFace {
                entity: entity(patch as u32),
                patch,
                area: areas[patch],
            })
            .collect();
        let boxes = patches.iter().filter_map(|p| p.bounds).reduce(join);
        Surface {
            bounds: boxes.unwrap_or_else(|| extent(set)),
            area: areas.iter().sum(),
            curvature: Curvature::new(&set.curvature_range()),
            tolerance: edges.tolerance,
            shared_edges: edges.joints.len(),
            smooth_edges: edges.smooth,
            sharp_edges: edges.sharp,
            partly_shared_edges: edges.partial.len(),
            free_edges: edges.free.len(),
            poles: edges.poles.len(),
            branching_edges: edges.branching.len(),
            largest_gap: edges.largest_gap,
            largest_gap_at: edges.largest_gap_at.as_ref().map(gap),
            resolution: edges.resolution,
            bridged: edges.bridged.iter().map(gap).collect(),
            open_gaps: edges.open_gaps.iter().map(gap).collect(),
            stacked: edges.stacked.iter().map(gap).collect(),
            overlaps: edges.overlaps.iter().map(overlap).collect(),
            borders: edges.borders.iter().map(rim).collect(),
            parts: set
                .components()
                .iter()
                .zip(set.volumes())
                .map(part)
                .collect(),
            largest_turned: turned.iter().map(|t| t.area).fold(0.0, f64::max),
            turned,
        }
    }
}

/// The faces of a part that lie turned over among the others: those on the side of less area.
fn turned(set: &PatchSet, members: &[usize], areas: &[f64]) -> Vec<usize> {
    let on = |side: f64| {
        let own = members.iter().copied();
        own.filter(move |&p| set.sides()[p] == side)
    };
    let area = |side: f64| on(side).map(|p| areas[p]).sum::<f64>();
    let fewer = if area(1.0) < area(-1.0) { 1.0 } else { -1.0 };
    on(fewer).collect()
}
