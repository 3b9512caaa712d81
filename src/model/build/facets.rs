//! Facets in place of exact surfaces, and the triangles of STL files.
use super::super::ModelError;
use super::super::error::{At, cause, number, text};
use super::super::surface::{FacetModel, SurfaceSet, facet_bytes};
use super::Builder;
use super::surfaces::joined;
use crate::machine::memory;
use crate::scene::{self, FacetKind};
use covact_geometry::PatchSet;
use covact_geometry::facet::{
    FacetError, Faceted, Refinement, bilinear_facets, biquadratic_facets, distance_from,
    smooth_patches,
};
use covact_geometry::io::{CadError, CadFile, ReadOptions, Stl, read_path_with, read_stl_path};

/// What the file of a surface holds.
pub(super) enum Source {
    Cad(CadFile),
    Stl(Stl),
}

/// Facets ready to be used, and what each is called in messages.
pub(super) struct Cut {
    pub set: SurfaceSet,
    pub model: FacetModel,
    pub labels: Vec<String>,
}

impl Builder<'_> {
    /// Facets in place of exact patches, which `labels` names.
    pub(super) fn facets(
        &mut self,
        name: &str,
        wanted: &scene::Facets,
        mut exact: PatchSet,
        labels: &[String],
    ) -> Result<Cut, ModelError> {
        let here = || format!("/surfaces/{name}/facets");
        let refinement = refinement(wanted)
            .ok_or_else(|| text(here(), "facets need one of `chord`, `size`, `count`"))?;
        // The facets follow the parametrisation of the patches, so that `side` means the same for both.
        exact.set_side_as_given(false);
        let range = exact.curvature_range();
        let told = |e| facet_error(name, wanted, labels, e);
        let room = |count: usize| {
            let bytes = facet_bytes(Some(wanted.kind));
            memory::ask(memory::times(count as u64, bytes)).map_err(|shortage| {
                let message = format!("surface `{name}` as {count} facets: {shortage}");
                let at = format!("/surfaces/{name}/facets/{}", fineness(wanted));
                text(at, message).help("ask for coarser facets")
            })
        };
        let (set, made) = match wanted.kind {
            FacetKind::Bilinear => {
                let made = bilinear_facets(&exact, refinement).map_err(told)?;
                room(made.mesh.facets.len())?;
                let facets = made.mesh.surfaces().map_err(told)?;
                let set = joined(facets).at(here)?;
                (SurfaceSet::Bilinear(set), Made::of(&made))
            }
            FacetKind::Biquadratic => {
                let made = biquadratic_facets(&exact, refinement).map_err(told)?;
                room(made.mesh.facets.len())?;
                let facets = made.mesh.surfaces().map_err(told)?;
                let set = joined(facets).at(here)?;
                (SurfaceSet::Biquadratic(set), Made::of(&made))
            }
            FacetKind::Smooth => {
                let mut made = bilinear_facets(&exact, refinement).map_err(told)?;
                room(made.mesh.facets.len())?;
                let patches = smooth_patches(&made.mesh).map_err(told)?;
                made.deviation = distance_from(&exact, &patches);
                let set = joined(patches).at(here)?;
                (SurfaceSet::Nurbs(set), Made::of(&made))
            }
        };
        let kind = wanted.kind.name();
        self.notes.push(format!(
            "surface `{name}`: {} {kind} facet(s) in place of {} patch(es), at most {} away from them",
            set.count(),
            exact.patches().len(),
            number(made.chord),
        ));
        if made.dropped > 0 {
            self.notes.push(format!(
                "surface `{name}`: {} facet(s) without an area left out",
                made.dropped
            ));
        }
        if made.cracks > 0 {
            self.warnings.push(format!(
                "surface `{name}`: the facets on both sides of {} joint(s) do not share their nodes: there may be gaps \
                 as wide as the facets are away from the surface",
                made.cracks
            ));
        }
        let named = |(i, &patch): (usize, &u32)| {
            let of = labels
                .get(patch as usize)
                .map_or("the surface", String::as_str);
            format!("facet {i} of {of}")
        };
        Ok(Cut {
            labels: made.origin.iter().enumerate().map(named).collect(),
            model: FacetModel {
                kind: wanted.kind,
                count: set.count(),
                chord: Some(made.chord),
                radii: [range.convex, range.concave].map(|c| c.map(|c| c.radius())),
                origin: made.origin,
            },
            set,
        })
    }

    /// The file that a surface names.
    pub(super) fn read_cad(&self, name: &str, cad: &scene::CadFile) -> Result<Source, ModelError> {
        let field = || format!("/surfaces/{name}/cad/file");
        let path = self.loaded.dir.join(&cad.file);
        let options = ReadOptions { hidden: cad.hidden };
        let error = match read_path_with(&path, &options) {
            Ok(file) => return Ok(Source::Cad(file)),
            Err(error) => error,
        };
        if let CadError::Format { found, .. } = &error {
            let said = found.contains("STL");
            match read_stl_path(&path, cad.tolerance) {
                Ok(stl) => return Ok(Source::Stl(stl)),
                Err(e) if said => return Err(cause(field(), e)),
                // Binary data of any kind may be taken for a damaged STL file; what it is not is surer.
                Err(_) => {}
            }
        }
        let damaged = matches!(error, CadError::Content { .. });
        let mut error = cause(field(), error);
        error.help = damaged.then(|| {
            "line and column are those of the CAD file: it is damaged or cut off, export it again".to_owned()
        });
        Err(error)
    }

    /// The triangles of an STL file as facets.
    pub(super) fn stl(
        &mut self,
        name: &str,
        surface: &scene::Surface,
        cad: &scene::CadFile,
        stl: &Stl,
    ) -> Result<Cut, ModelError> {
        let field = |f: &str| format!("/surfaces/{name}/{f}");
        let shown = cad.file.display();
        if let Some(facets) = &surface.facets {
            let message = match facets.kind {
                FacetKind::Smooth => format!(
                    "{shown} is an STL file: a smooth surface needs quadrilaterals, and of triangles with unknown \
                     origin it is not clear which edges are meant to be sharp"
                ),
                _ => format!("{shown} is an STL file, whose triangles are facets already"),
            };
            let help = "leave out `facets`, or take the CAD file (STEP, IGES or JSON) that the triangles were made from";
            return Err(text(field("facets"), message).help(help));
        }
        if !cad.entities.is_empty() {
            let message = format!("{shown} is an STL file, which has no entities to choose from");
            return Err(text(field("cad/entities"), message).help("leave out `entities`"));
        }
        self.stl_account(name, stl, &shown.to_string());
        let bytes = facet_bytes(Some(FacetKind::Bilinear));
        memory::ask(memory::times(3 * stl.triangles.len() as u64, bytes)).map_err(|shortage| {
            let count = stl.triangles.len();
            let message = format!("{shown} with {count} triangles: {shortage}");
            text(field("cad/file"), message).help("export a coarser STL file")
        })?;
        let mut mesh = stl.facets();
        for node in &mut mesh.nodes {
            *node *= surface.placement.scale;
        }
        let facets = mesh
            .surfaces()
            .map_err(|e| text(field("cad/file"), e.to_string()))?;
        let set = joined(facets).at(|| field("cad/file"))?;
        let origin: Vec<u32> = (stl.numbers.iter()).flat_map(|&n| [n; 3]).collect();
        Ok(Cut {
            labels: origin
                .iter()
                .map(|n| format!("triangle {}", n + 1))
                .collect(),
            model: FacetModel {
                kind: FacetKind::Bilinear,
                count: set.patches().len(),
                chord: None,
                radii: [None; 2],
                origin,
            },
            set: SurfaceSet::Bilinear(set),
        })
    }

    /// What there is to say about an STL file.
    fn stl_account(&mut self, name: &str, stl: &Stl, shown: &str) {
        let report = &stl.report;
        self.notes.push(format!(
            "surface `{name}`: {} triangle(s) from {shown}, each as three plane facets; STL states no length unit, its \
             numbers are taken as {}",
            stl.triangles.len(),
            self.scene.units.length.name()
        ));
        if let Some(first) = report.degenerate.first() {
            self.warnings.push(format!(
                "surface `{name}`: {} of {} triangle(s) of {shown} have no area and are left out, the first is number \
                 {}",
                report.degenerate.len(),
                report.triangles,
                first + 1
            ));
        }
        for (count, what) in [
            (
                report.flipped,
                "whose triangles are turned against each other",
            ),
            (report.branching, "of more than two triangles"),
        ] {
            if count > 0 {
                self.warnings.push(format!(
                    "surface `{name}`: {shown} has {count} edge(s) {what}: the outside may be wrong there"
                ));
            }
        }
        if report.free > 0 {
            self.notes.push(format!(
                "surface `{name}`: {} edge(s) of {shown} are free: the surface ends there",
                report.free
            ));
        }
    }
}

/// What all kinds of facets tell.
struct Made {
    origin: Vec<u32>,
    chord: f64,
    cracks: usize,
    dropped: usize,
}

impl Made {
    fn of<const N: usize>(made: &Faceted<N>) -> Self {
        Made {
            origin: made.origin.iter().map(|o| o.patch).collect(),
            chord: made.deviation,
            cracks: made.cracks.len(),
            dropped: made.dropped,
        }
    }
}

fn refinement(facets: &scene::Facets) -> Option<Refinement> {
    (facets.chord.map(Refinement::Chord))
        .or(facets.size.map(Refinement::Size))
        .or(facets.count.map(Refinement::PerPatch))
}

/// The field that says how fine facets are.
fn fineness(wanted: &scene::Facets) -> &'static str {
    match (wanted.chord, wanted.size) {
        (Some(_), _) => "chord",
        (_, Some(_)) => "size",
        _ => "count",
    }
}

/// Why facets cannot be made, with the place and what to do.
fn facet_error(
    name: &str,
    wanted: &scene::Facets,
    labels: &[String],
    error: FacetError,
) -> ModelError {
    let field = fineness(wanted);
    let at = |f: &str| format!("/surfaces/{name}/facets/{f}");
    match error {
        FacetError::Trimmed(patch) => {
            let label = labels.get(patch).map_or("a patch", String::as_str);
            let message = format!(
                "surface `{name}`: {label} is trimmed, and trimmed patches cannot be cut into facets"
            );
            text(format!("/surfaces/{name}/facets"), message).help(
                "leave out `facets` (trimmed patches are used exactly), name untrimmed entities in `cad.entities`, or \
                 export the surface as an STL file and use that",
            )
        }
        FacetError::Gap { gap, tolerance } => {
            let message = format!(
                "surface `{name}`: its patches are {} apart at a joint, more than half of the chord error {}",
                number(gap),
                number(tolerance)
            );
            text(at(field), message).help(format!(
                "ask for a chord error of more than {}, or give `size` or `count`",
                number(2.0 * gap)
            ))
        }
        FacetError::TooMany { limit, .. } => {
            let message = format!("surface `{name}`: more than {limit} facets would be needed");
            text(at(field), message).help("ask for coarser facets, or for another kind of them")
        }
        other => text(at(field), format!("surface `{name}`: {other}")),
    }
}
