//! `covact check`: everything up to the first solve, and nothing of it.
use super::Estimate;
use super::RunError;
use crate::mesh::{Mesh, Range};
use crate::model::error::number;
use crate::model::initial::{initial_gap, point_spacing};
use crate::model::{self, BodyModel, Model, SurfaceModel};
use crate::plan::Plan;
use crate::scene::{Element, LoadedScene, Penalty, Points, Scene, Support};
use crate::shell::distortion::most_distorted;
use serde::Serialize;
use std::collections::BTreeSet;

/// What a scene amounts to. Lengths are in the scene's unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckReport {
    /// Title of the scene.
    pub title: String,
    /// Length unit of the scene.
    pub unit: String,
    /// Nodes of all bodies.
    pub nodes: usize,
    /// Elements of all bodies.
    pub elements: usize,
    /// Unknowns, prescribed ones left out.
    pub dofs: usize,
    /// Slave points of all contacts.
    pub contact_points: usize,
    /// Memory that a run takes at its largest, estimated.
    pub memory: Estimate,
    /// Deformable bodies.
    pub bodies: Vec<BodyReport>,
    /// Rigid surfaces.
    pub surfaces: Vec<SurfaceReport>,
    /// Contact pairs.
    pub pairs: Vec<PairReport>,
    /// Supports.
    pub supports: Vec<SupportReport>,
    /// Loads.
    pub loads: Vec<LoadReport>,
    /// Effects that are on, by name.
    pub effects: Vec<String>,
    /// Details of them that are on, by name.
    pub details: Vec<String>,
    /// Choices the program made, in words.
    pub notes: Vec<String>,
    /// Things the user should look at, in words.
    pub warnings: Vec<String>,
}

/// A body and its mesh.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BodyReport {
    /// Name in the scene.
    pub name: String,
    /// Number of nodes.
    pub nodes: usize,
    /// Number of elements.
    pub elements: usize,
    /// Parts that share no node.
    pub parts: usize,
    /// What supports, loads and contacts may name of it, by name.
    pub sets: Vec<SetReport>,
    /// Formulation of the elements.
    pub element: &'static str,
    /// Law and constants of the material.
    pub material: String,
    /// Lowest and highest coordinates.
    pub bounds: [[f64; 3]; 2],
    /// Shortest and longest edge in the shell's surface.
    pub edge: [f64; 2],
    /// Thinnest and thickest layer.
    pub thickness: [f64; 2],
    /// Smallest scaled Jacobian of an element: 1 where all corners are right angles, 0 where an element has collapsed.
    pub worst_shape: f64,
    /// The most distorted element; none: the body has no elements.
    pub distortion: Option<DistortionReport>,
}

/// A set of a body's mesh, given by it or by the scene. Of a CAD surface that bends, faces are its elements and nodes its control
/// points.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SetReport {
    /// Name of the set, without that of the body.
    pub name: String,
    /// Faces of elements; none in a set of nodes.
    pub faces: usize,
    /// Nodes, those of its faces included.
    pub nodes: usize,
    /// Lowest and highest coordinates; of an empty set those of the origin.
    pub bounds: [[f64; 3]; 2],
}

/// The most distorted element of a body; see [`crate::shell::distortion`].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DistortionReport {
    /// Over the limit: above 1 the error from distortion may pass 0.5 %.
    pub share: f64,
    /// Number of the element, from 0.
    pub element: u32,
    /// Its middle.
    pub place: [f64; 3],
    /// Which distortion it is, in words.
    pub cause: &'static str,
    /// Elements above the limit.
    pub above: usize,
}

/// A rigid surface at the start.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SurfaceReport {
    /// Name in the scene.
    pub name: String,
    /// CAD file or shape.
    pub source: String,
    /// Facets in place of the exact surface, or triangles of a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub facets: Option<FacetsReport>,
    /// Number of patches or facets.
    pub patches: usize,
    /// Unconnected parts.
    pub parts: usize,
    /// Lowest and highest corner of a box around it, before it is placed.
    pub bounds: [[f64; 3]; 2],
    /// Shared edges across which the surface is smooth.
    pub smooth_edges: usize,
    /// Shared edges at an angle.
    pub sharp_edges: usize,
    /// Edges shared over a part of their length.
    pub partial_edges: usize,
    /// Edges at which more than two patches meet.
    pub branching_edges: usize,
    /// Edges without a neighbour: the surface ends there.
    pub free_edges: usize,
    /// Edges that are one point.
    pub poles: usize,
    /// Largest distance between edges that count as shared.
    pub largest_gap: f64,
    /// Smallest radius of curvature where the surface bulges towards the slave; none: nowhere.
    pub smallest_convex_radius: Option<f64>,
    /// Smallest radius of curvature where it is hollow; none: nowhere.
    pub smallest_concave_radius: Option<f64>,
    /// Patches whose normal was turned round.
    pub reversed: usize,
    /// A point deeper than this below the surface is not in contact.
    pub depth: f64,
}

/// Facets of a rigid surface.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FacetsReport {
    /// `bilinear`, `biquadratic` or `smooth`.
    pub kind: &'static str,
    pub count: usize,
    /// Largest distance from the exact surface at the points measured; none for triangles of a file.
    pub chord: Option<f64>,
}

/// A contact pair before anything moves.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairReport {
    /// Name of the contact.
    pub name: String,
    /// Slave faces, `body.set`.
    pub slave: String,
    /// Name of the rigid surface, or master faces, `body.set`.
    pub master: String,
    /// Number of slave points.
    pub points: usize,
    /// Where the slave points lie, in words.
    pub sampling: String,
    /// Mean distance of neighbouring slave points.
    pub spacing: f64,
    /// Penalty (force / length^3).
    pub penalty: f64,
    /// Whether the program chose the penalty.
    pub automatic: bool,
    /// Smallest and largest initial distance.
    pub gap: [f64; 2],
    /// Points that start in contact.
    pub touching: usize,
}

/// A support.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SupportReport {
    /// Name in the scene.
    pub name: String,
    /// Set, `body.set`.
    pub on: String,
    /// What it does, in words.
    pub kind: String,
    /// Displacement components it prescribes; those that an earlier support prescribes alike are counted there.
    pub components: usize,
}

/// A load.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LoadReport {
    /// Name in the scene.
    pub name: String,
    /// Set, `body.set`.
    pub on: String,
    /// `force`, `traction`, `pressure` or `follower pressure`.
    pub kind: &'static str,
}

/// Reads and checks everything a scene names.
///
/// # Errors
/// [`RunError::Scene`] with the place of what is wrong.
pub fn check(scene: &LoadedScene) -> Result<CheckReport, RunError> {
    let model = model::build::build(scene).map_err(|e| RunError::model(scene, e))?;
    let memory = super::memory::estimate(scene, &model)?;
    let plan = Plan::new(scene, &model);
    let mut pairs = Vec::new();
    for index in 0..model.pairs.len() {
        pairs
            .push(pair_report(&scene.scene, &model, index).map_err(|e| RunError::model(scene, e))?);
    }
    let scene = &scene.scene;
    let bodies: Vec<BodyReport> = model.bodies.iter().map(|b| body_report(scene, b)).collect();
    let mut warnings = model.warnings.clone();
    warnings.extend(bodies.iter().filter_map(distorted));
    Ok(CheckReport {
        title: model.title.clone(),
        unit: scene.units.length.name().to_owned(),
        nodes: model.body_nodes(),
        elements: model.bodies.iter().map(|b| b.block.elements()).sum(),
        dofs: model.unknowns(),
        contact_points: model.contact_points(),
        memory,
        bodies,
        surfaces: (model.surfaces.iter())
            .map(|s| surface_report(scene, s))
            .collect(),
        pairs,
        supports: supports(scene, &model),
        loads: loads(scene),
        effects: plan.names(),
        details: plan.details(),
        notes: model.notes.clone(),
        warnings,
    })
}

/// A warning where elements are distorted above the limit.
fn distorted(body: &BodyReport) -> Option<String> {
    let worst = body.distortion.as_ref().filter(|d| d.share > 1.0)?;
    Some(format!(
        "body `{}`: {} element(s) so distorted that the error may pass 0.5 %; the worst is element {} at ({}), {} times \
         the limit ({})",
        body.name,
        worst.above,
        worst.element,
        worst.place.map(number).join(", "),
        number(worst.share),
        worst.cause
    ))
}

fn body_report(scene: &Scene, body: &BodyModel) -> BodyReport {
    let size = body.mesh.element_size();
    let range = |r: Option<Range>| r.map_or([0.0; 2], |r| [r.min, r.max]);
    let described = &scene.bodies[&body.name];
    let element = match described.element {
        Element::H8 => "8-node solid-shell",
        Element::H8Eas3 => "8-node solid-shell, enhanced through its thickness",
        Element::H8Displacement => "8-node brick without enhancement",
        Element::H8MeanDilatation => "8-node brick with one change of volume",
        Element::Q18 => "18-node quadratic solid-shell",
        Element::Nurbs => "bicubic Kirchhoff-Love shell on a NURBS patch",
    };
    let (law, e) = (body.material.title(), body.material.elastic());
    let known = scene
        .materials
        .get(&described.material)
        .and_then(|m| m.name());
    let known = known.map_or(String::new(), |name| format!("{name}: "));
    let material = format!("{known}{law}, E {}, nu {}", number(e.e), e.nu);
    BodyReport {
        name: body.name.clone(),
        nodes: body.mesh.nodes.len(),
        elements: body.block.elements(),
        parts: match body.block.sheet() {
            Some(sheet) => sheet.parts(),
            None => body.mesh.components(),
        },
        sets: sets(&body.mesh),
        element,
        material,
        bounds: body.mesh.bounds().map(Into::into),
        edge: match body.block.sheet() {
            Some(sheet) => sheet.span_lengths(),
            None => range(size.map(|s| s.edge)),
        },
        thickness: match body.block.sheet() {
            Some(sheet) => [sheet.thickness; 2],
            None => range(size.map(|s| s.thickness)),
        },
        worst_shape: size.map_or(0.0, |s| s.shape.min),
        distortion: most_distorted(&body.mesh).map(|d| DistortionReport {
            share: d.share,
            element: d.element,
            place: d.place.into(),
            cause: d.distortion.cause(body.mesh.kind),
            above: d.above,
        }),
    }
}

/// Sets of nodes and of faces under one name are one to whoever names it.
fn sets(mesh: &Mesh) -> Vec<SetReport> {
    let names: BTreeSet<&String> = mesh.node_sets.keys().chain(mesh.face_sets.keys()).collect();
    let report = |name: &String| {
        let faces = mesh.face_sets.get(name).map_or(&[][..], |f| f);
        let mut nodes = mesh.nodes_of(faces);
        nodes.extend(mesh.node_sets.get(name).into_iter().flatten());
        nodes.sort_unstable();
        nodes.dedup();
        let mut places = nodes.iter().map(|n| mesh.nodes[*n as usize]);
        let first = places.next().unwrap_or_default();
        let bounds = places.fold([first; 2], |[low, high], x| [low.inf(&x), high.sup(&x)]);
        SetReport {
            name: name.clone(),
            faces: faces.len(),
            nodes: nodes.len(),
            bounds: bounds.map(Into::into),
        }
    };
    names.into_iter().map(report).collect()
}

fn surface_report(scene: &Scene, surface: &SurfaceModel) -> SurfaceReport {
    let described = &scene.surfaces[&surface.name];
    let source = match (&described.cad, &described.sphere, &described.cylinder) {
        (Some(cad), ..) => cad.file.display().to_string(),
        (_, Some(s), _) => format!("sphere of radius {}", s.radius),
        (_, _, Some(c)) => format!("cylinder of radius {} and length {}", c.radius, c.length),
        _ if described.patches.is_some() => "patches".to_owned(),
        _ => "plane".to_owned(),
    };
    let edges = surface.set.edges();
    let [convex, concave] = surface.radii();
    SurfaceReport {
        name: surface.name.clone(),
        source,
        facets: surface.facets.as_ref().map(|f| FacetsReport {
            kind: f.kind.name(),
            count: f.count,
            chord: f.chord,
        }),
        patches: surface.set.count(),
        parts: surface.set.components().len(),
        bounds: surface.set.bounds().map(Into::into),
        smooth_edges: edges.smooth,
        sharp_edges: edges.sharp,
        partial_edges: edges.partial.len(),
        branching_edges: edges.branching.len(),
        free_edges: edges.free.len(),
        poles: edges.poles.len(),
        largest_gap: edges.largest_gap,
        smallest_convex_radius: convex,
        smallest_concave_radius: concave,
        reversed: surface.set.sides().iter().filter(|s| **s < 0.0).count(),
        depth: surface.depth,
    }
}

fn pair_report(
    scene: &Scene,
    model: &Model,
    index: usize,
) -> Result<PairReport, model::ModelError> {
    let pair = &model.pairs[index];
    let contact = &scene.contacts[&pair.name];
    let gap = initial_gap(model, index)?;
    Ok(PairReport {
        name: pair.name.clone(),
        slave: contact.slave.to_string(),
        master: contact.master.to_string(),
        points: pair.points.len(),
        sampling: match pair.sampled {
            Points::Nodes if model.bodies[pair.body].block.sheet().is_some() => {
                "4 x 4 Gauss points a face".to_owned()
            }
            Points::Auto | Points::Nodes => "at the nodes of the faces".to_owned(),
            Points::Gauss(n) => format!("{n} x {n} Gauss points a face"),
            Points::Lobatto(n) => format!("{n} x {n} Lobatto points a face"),
            Points::Segments(n) => format!("segments with rules of degree {n}"),
        },
        spacing: point_spacing(model, index),
        penalty: pair.eps_n,
        automatic: contact.penalty == Penalty::Auto,
        gap: [gap.smallest, gap.largest],
        touching: gap.touching,
    })
}

fn supports(scene: &Scene, model: &Model) -> Vec<SupportReport> {
    let kind = |s: &Support| {
        let mut words = match (s.fixed, s.symmetry, &s.displacement) {
            (true, ..) => "holds x, y and z".to_owned(),
            (_, Some(axis), _) => format!("symmetry: holds {axis:?}").to_lowercase(),
            (_, _, Some(d)) => {
                let named = [("x", &d.x), ("y", &d.y), ("z", &d.z)];
                let given: Vec<&str> =
                    (named.iter().filter(|(_, v)| v.is_some()).map(|(n, _)| *n)).collect();
                format!("prescribes {}", given.join(", "))
            }
            _ => String::new(),
        };
        if s.mid_surface {
            words += " of the mid-surface";
        }
        words
    };
    // Those that stages find are not known before a run.
    (model.supports.iter().enumerate())
        .filter_map(|(i, name)| Some((i, name, scene.supports.get(name)?)))
        .map(|(i, name, support)| {
            let own = |support: u32| support as usize == i;
            SupportReport {
                name: name.clone(),
                on: support.on.to_string(),
                kind: kind(support),
                components: model.prescribed.iter().filter(|p| own(p.support)).count()
                    + model.means.iter().filter(|m| own(m.support)).count(),
            }
        })
        .collect()
}

fn loads(scene: &Scene) -> Vec<LoadReport> {
    (scene.loads.iter())
        .map(|(name, load)| LoadReport {
            name: name.clone(),
            on: load.on.to_string(),
            kind: match (&load.force, &load.traction, load.follower) {
                _ if load.gravity.is_some() => "gravity",
                (Some(_), ..) => "force",
                (_, Some(_), _) => "traction",
                (.., true) => "follower pressure",
                _ => "pressure",
            },
        })
        .collect()
}
