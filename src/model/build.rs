//! Scene to model.
mod cad_bodies;
mod contact_faces;
mod contacts;
mod facets;
mod fibres;
pub(crate) mod master_faces;
mod meshes;
mod nurbs_bodies;
mod nurbs_masters;
mod probes;
mod rims;
mod seams;
mod sets;
mod sheet_supports;
mod sides;
mod supports;
mod surfaces;
mod values;

pub(crate) use meshes::elements_key;
use meshes::{extent, mesh_error, place, room};

use super::driven::Driven;
use super::error::{At, number, text};
use super::loads::{DeadLoad, FollowerPressure, LoadPoint, load_points, sheet_load_points};
use super::rims::RimNodes;
use super::sheet_pressure::{FollowingSpan, PressedSpan};
use super::stages::{self, StageStart};
use super::stretched::Stretched;
use super::symmetry::Unsymmetric;
use super::{BodyModel, Metal, Model, ModelError, SurfaceModel};
use crate::contact::lever::Lever;
use crate::machine::memory;
use crate::mesh::{self, Border, Face, Mesh};
use crate::scene::{
    self, LoadedScene, Material, MeshSource, POSITION_AND_TIME, Scene, Stabilization, TIME, Value,
};
use crate::shell::{Block, HeldNormal, Law, Memory, bytes_per_element};
use covact_geometry::{PatchSet, Vec3};
use nalgebra::Point3;
pub use nurbs_bodies::SHEET_POINTS;
use nurbs_bodies::sheet_rims;
use std::collections::BTreeMap;

/// What to do where memory is short.
pub(crate) const FEWER: &str = "take fewer elements, or a coarser mesh away from the contact (`spacing`), or a machine with more memory";

/// What is being collected while the model is built.
struct Builder<'s> {
    scene: &'s Scene,
    loaded: &'s LoadedScene,
    /// The stage whose supports are resolved.
    stage: usize,
    nodes: Vec<Vec3>,
    bodies: Vec<BodyModel>,
    body_index: BTreeMap<&'s str, usize>,
    notes: Vec<String>,
    warnings: Vec<String>,
    /// Slave nodes with averaged gaps so far.
    averaged: usize,
    /// Of slave points at a height above a mid-surface so far.
    levers: Vec<Lever>,
    /// Fibres that supports stretch, so far.
    stretched: Vec<Stretched>,
    /// On rims of rigid surfaces so far.
    rims: Vec<RimNodes>,
}

/// Reads every mesh and CAD file of the scene and resolves all names.
///
/// # Errors
/// [`ModelError`] with the field of the scene at fault.
pub fn build(loaded: &LoadedScene) -> Result<Model, ModelError> {
    build_stage(loaded, StageStart::default(), None)
}

/// The model of one stage of a scene, or of all of it where it has none. Where displacements `u` are given, supports are found for
/// where they put the bodies.
///
/// # Errors
/// As [`build`].
pub fn build_stage(
    loaded: &LoadedScene,
    start: StageStart,
    u: Option<&[f64]>,
) -> Result<Model, ModelError> {
    let lowered = stages::lowered(&loaded.scene);
    let scene = lowered.as_ref().unwrap_or(&loaded.scene);
    let mut builder = Builder::new(scene, loaded);
    builder.stage = start.index;
    let bodies = builder.bodies();
    let sets = match bodies {
        Ok(()) => builder.references(),
        Err(_) => Vec::new(),
    };
    let (surfaces, wrong) = builder.surfaces();
    ModelError::all(bodies.err().into_iter().chain(sets).chain(wrong))?;
    let (mut pairs, mut surfaces) = builder.contacts(surfaces)?;
    super::histories::number(&mut pairs);
    let mut held = builder.drive(&mut surfaces)?;
    held.extend(builder.rims.iter().flat_map(RimNodes::dofs));
    // Those of later stages, so that a contradiction is told before anything is solved.
    for later in (0..scene.stages.len()).filter(|stage| *stage > start.index) {
        builder.stage = later;
        builder.supports(&held)?;
    }
    builder.stage = start.index;
    let supports = builder.supports(&held)?;
    builder.hold_normals(&supports)?;
    builder.held_fibres()?;
    let (dead_loads, follower_loads) = builder.loads()?;
    let probes = builder.probes()?;
    let mut model = Model {
        title: scene.title.clone(),
        nodes: builder.nodes,
        bodies: builder.bodies,
        surfaces,
        pairs,
        rims: builder.rims,
        supports: supports.names,
        prescribed: supports.prescribed,
        means: supports.means,
        tied: supports.tied,
        dead_loads,
        follower_loads,
        dofs: supports.dofs,
        probes,
        levers: builder.levers,
        stretched: builder.stretched,
        stage: None,
        stabilization: None,
        dynamics: None,
        small: None,
        symmetric: true,
        unsymmetric: Vec::new(),
        notes: builder.notes,
        warnings: builder.warnings,
        kinks: Vec::new(),
        largest_steps: Vec::new(),
    };
    let first = start.index == 0;
    stages::enter(scene, &mut model, start, u)?;
    super::both_faces::tell(&mut model);
    model.small = super::small::linearise(scene, &mut model)?;
    model.unsymmetric = symmetry(scene, &mut model)?;
    values::times(loaded, &mut model);
    values::check(scene, &model)?;
    model.dynamics = super::dynamics::dynamics(scene, &model)?;
    stabilize(scene, &mut model)?;
    stages::stabilized(&mut model)?;
    super::initial::check(&mut model, scene)?;
    match first {
        true => super::driven::start::approach(&mut model, loaded)?,
        false => super::driven::start::resisted(&mut model, loaded),
    }
    Ok(model)
}

/// The patches of a rigid surface that facets in its place would be cut from: at its scale, not yet rotated and moved to its
/// place, with the sides that its source gives.
///
/// # Errors
/// [`ModelError`]: there is no such surface, its file cannot be read, or it holds facets already.
pub fn exact_surface(loaded: &LoadedScene, name: &str) -> Result<PatchSet, ModelError> {
    let here = || format!("/surfaces/{name}");
    let Some(surface) = loaded.scene.surfaces.get(name) else {
        return Err(text(here(), format!("there is no surface `{name}`")));
    };
    let mut surface = surface.clone();
    // The sphere of facets is another than the one that is used exactly.
    surface.facets = Some(scene::Facets {
        kind: scene::FacetKind::Bilinear,
        chord: None,
        size: None,
        count: Some([1, 1]),
    });
    Builder::new(&loaded.scene, loaded).exact(name, &surface)
}

impl<'s> Builder<'s> {
    fn new(scene: &'s Scene, loaded: &'s LoadedScene) -> Self {
        Builder {
            scene,
            loaded,
            stage: 0,
            nodes: Vec::new(),
            bodies: Vec::new(),
            body_index: BTreeMap::new(),
            notes: Vec::new(),
            warnings: Vec::new(),
            averaged: 0,
            levers: Vec::new(),
            stretched: Vec::new(),
            rims: Vec::new(),
        }
    }
}

/// Bodies have to be held by supports, or by contact with the help of a stabilisation, or by their inertia.
fn stabilize(scene: &Scene, model: &mut Model) -> Result<(), ModelError> {
    if model.dynamics.is_some() {
        return Ok(());
    }
    let free = super::free_motion::free_motions(model);
    // At small displacements nothing comes into contact that is not held.
    let small = scene.solution.kinematics == scene::Kinematics::Small;
    let refused = match scene.solution.stabilization {
        Stabilization::None => true,
        Stabilization::Auto => small,
        Stabilization::Viscous { .. } => false,
    };
    if let (true, Some(free)) = (refused, free.first()) {
        let message = format!(
            "body `{}` can move freely {}: no support hinders it",
            free.body, free.motion
        );
        let help = super::stabilization::not_held(small);
        return Err(text(format!("/bodies/{}", free.body), message).help(help));
    }
    if let Some((stabilization, note)) = super::stabilization::stabilization(scene, model, free)? {
        for piece in &stabilization.free {
            model.notes.push(format!(
                "body `{}`: no support hinders it {}; contact has to, and stabilization until it does",
                piece.motion.body, piece.motion.motion
            ));
        }
        model.notes.push(note);
        model.stabilization = Some(stabilization);
    }
    Ok(())
}

/// Decides whether the system is symmetric, and whether the linear solver that was asked for can solve it; returns what
/// makes it unsymmetric.
fn symmetry(scene: &Scene, model: &mut Model) -> Result<Vec<Unsymmetric>, ModelError> {
    let reasons = super::symmetry::unsymmetric_effects(model);
    model.symmetric = reasons.is_empty();
    super::foreign_solver::check(scene, model)?;
    let asked = match scene.solution.linear_solver {
        scene::LinearSolver::Llt => "llt",
        scene::LinearSolver::Ldlt => "ldlt",
        _ => "",
    };
    match reasons.first().map(|r| &r.why) {
        Some(reason) if !asked.is_empty() => {
            let message =
                format!("`{asked}` is for symmetric systems, and this one is not: {reason}");
            let help = "take `auto` or `lu`";
            Err(text("/solution/linear_solver", message).help(help))
        }
        _ => {
            let note = |reason: &Unsymmetric| {
                let why = &reason.why;
                format!("{why}, so that the system is unsymmetric (LU)")
            };
            model.notes.extend(reasons.iter().map(note));
            Ok(reasons)
        }
    }
}

impl<'s> Builder<'s> {
    fn bodies(&mut self) -> Result<(), ModelError> {
        let scene = self.scene;
        let bodies = scene.bodies.iter();
        ModelError::all(bodies.filter_map(|(name, body)| self.add_body(name, body).err()))
    }

    /// Reads or makes the mesh of a body and adds the body.
    fn add_body(&mut self, name: &'s str, body: &'s scene::Body) -> Result<(), ModelError> {
        let at = || format!("/bodies/{name}/mesh");
        let (material, metal) = self.material(name, &body.material)?;
        if let MeshSource::Nurbs(nurbs) = &body.mesh {
            let law = Law::new(&material).at(|| format!("/bodies/{name}/material"))?;
            let (mesh, block) = self.sheet(name, nurbs, body, law)?;
            return self.push_body(name, mesh, block, (material, metal));
        }
        room(name, body, Memory::of(&material))?;
        let (mut mesh, report) = mesh::build(&body.mesh, body.element.into(), &self.loaded.dir)
            .map_err(|e| mesh_error(name, &body.mesh, e))?;
        place(&mut mesh, &body.placement);
        for (set, selection) in &body.sets {
            mesh.add_set(set, selection)
                .at(|| format!("/bodies/{name}/sets/{set}"))
                .map_err(|e| e.help(extent(name, &mesh)))?;
        }
        let slits = match &body.mesh {
            MeshSource::File(file) => file.slits,
            MeshSource::Cells(cells) => cells.file.slits,
            _ => false,
        };
        mesh.check_with(slits).at(at)?;
        (self.notes).extend(report.notes.iter().map(|n| format!("body `{name}`: {n}")));
        let law = Law::new(&material).at(|| format!("/bodies/{name}/material"))?;
        let elements = mesh.elements() as u64;
        let each: usize = bytes_per_element(body.element, Memory::of(&material))
            .iter()
            .sum();
        memory::ask(memory::times(elements, each as u64)).map_err(|shortage| {
            let message = format!("body `{name}` with its {elements} elements: {shortage}");
            text(elements_key(name, &body.mesh), message).help(FEWER)
        })?;
        let block = Block::new(&mesh, body.element, law).at(at)?;
        self.push_body(name, mesh, block, (material, metal))
    }

    /// Adds a body with its nodes.
    fn push_body(
        &mut self,
        name: &'s str,
        mesh: Mesh,
        block: Block,
        (material, metal): (Material, Option<Metal>),
    ) -> Result<(), ModelError> {
        let first_node = u32::try_from(self.nodes.len()).map_err(|_| {
            let at = format!("/bodies/{name}/mesh");
            text(at, "too many nodes: more than 2^32")
        })?;
        self.nodes.extend_from_slice(&mesh.nodes);
        self.body_index.insert(name, self.bodies.len());
        self.bodies.push(BodyModel {
            name: name.to_owned(),
            mesh,
            block,
            material,
            metal,
            first_node,
        });
        Ok(())
    }

    /// Holds the normals of sheets along borders, and curves of trims.
    fn hold_normals(&mut self, held: &supports::Supports) -> Result<(), ModelError> {
        for (index, body) in self.bodies.iter_mut().enumerate() {
            let own = (held.held_normals.iter()).filter(|(of, ..)| *of == index);
            let own: Vec<(Border, HeldNormal)> = own.map(|(_, edge, to)| (*edge, *to)).collect();
            let anchors = &held.held_anchors[index];
            if let Block::Nurbs(block) = &mut body.block {
                block.hold_anchors(anchors);
                let at = || format!("/bodies/{}/nurbs/file", body.name);
                block.hold(&own).at(at)?;
            }
        }
        Ok(())
    }

    /// The law of a material; of a metal that is taken by name, that and its yield strength.
    fn material(&self, body: &str, name: &str) -> Result<(Material, Option<Metal>), ModelError> {
        let choice = self.scene.materials.get(name).ok_or_else(|| {
            text(
                format!("/bodies/{body}/material"),
                format!("there is no material `{name}`"),
            )
        })?;
        let units = &self.scene.units;
        let law = choice.law(units).ok_or_else(|| {
            let message = format!("the material `{name}` needs the units of the scene");
            text(format!("/materials/{name}"), message)
        })?;
        Ok((law, choice.name().zip(choice.yield_strength(units))))
    }

    /// Appends the nodes of surfaces driven by force; returns their degrees of freedom that are not free.
    fn drive(&mut self, surfaces: &mut [SurfaceModel]) -> Result<Vec<u32>, ModelError> {
        let mut held = Vec::new();
        for surface in surfaces {
            let described = &self.scene.surfaces[&surface.name];
            let Some(free) = &described.motion.free else {
                continue;
            };
            let node = u32::try_from(self.nodes.len()).map_err(|_| {
                let pointer = format!("/surfaces/{}", surface.name);
                text(pointer, "too many nodes: more than 2^32")
            })?;
            let bounds = surface.set.bounds().map(Into::into);
            let driven = Driven::new(&surface.name, free, &surface.motion, bounds, node)?;
            let pointer = || format!("/surfaces/{}/motion", surface.name);
            let placed = surface.motion.pose(0.0).at(pointer)?;
            let center = placed * Point3::from(driven.center);
            self.nodes.extend([center.coords, Vec3::zeros()]);
            let free = driven.free();
            held.extend((0..6).filter(|&c| !free[c]).map(|c| driven.dof(c) as u32));
            let words = driven.words();
            let about = match free[3..].contains(&true) {
                true => format!(
                    "; it turns about ({}, {}, {}), to which moments refer",
                    number(center.x),
                    number(center.y),
                    number(center.z)
                ),
                false => String::new(),
            };
            (self.notes).push(format!(
                "surface `{}`: driven by force {words}{about}",
                surface.name
            ));
            surface.driven = Some(driven);
        }
        Ok(held)
    }

    #[allow(clippy::type_complexity)]
    fn loads(
        &mut self,
    ) -> Result<(Vec<(String, DeadLoad)>, Vec<(String, FollowerPressure)>), ModelError> {
        let (mut dead, mut follower) = (Vec::new(), Vec::new());
        for (name, load) in &self.scene.loads {
            let pointer = |field: &str| format!("/loads/{name}/{field}");
            let vector = |v: &[Value; 3], field: &str, vars: &[&str]| {
                let compile = |i: usize| v[i].compile(vars).at(|| pointer(field));
                Ok::<_, ModelError>([compile(0)?, compile(1)?, compile(2)?])
            };
            if let Some(force) = &load.force {
                let shares = self.shares(&load.on, &pointer("on"))?;
                let value = vector(force, "force", &TIME)?;
                dead.push((name.clone(), DeadLoad::Force { shares, value }));
                continue;
            }
            if let Some(couple) = &load.couple {
                let value = couple.compile(&TIME).at(|| pointer("couple"))?;
                let spans = self.couples(&load.on, &pointer("on"))?;
                let load = FollowerPressure {
                    faces: Vec::new(),
                    spans,
                    rims: None,
                    value,
                };
                follower.push((name.clone(), load));
                continue;
            }
            if let Some(gravity) = &load.gravity {
                let shares = self.masses(&load.on, &pointer("on"))?;
                let value = vector(gravity, "gravity", &TIME)?;
                dead.push((name.clone(), DeadLoad::Force { shares, value }));
                continue;
            }
            let parts = self.faces_of(&load.on, &pointer("on"))?;
            let parts: Vec<(&BodyModel, u32, Vec<Face>)> = (parts.into_iter())
                .map(|(body, faces)| {
                    let body = &self.bodies[body];
                    (body, body.first_node, faces)
                })
                .collect();
            let points = || -> Vec<LoadPoint> {
                (parts.iter())
                    .flat_map(|(body, first, faces)| match body.block.sheet() {
                        Some(sheet) => sheet_load_points(sheet, faces, *first),
                        None => load_points(&body.mesh, faces, *first),
                    })
                    .collect()
            };
            if let Some(traction) = &load.traction {
                let value = vector(traction, "traction", &POSITION_AND_TIME)?;
                let points = points();
                dead.push((name.clone(), DeadLoad::Traction { points, value }));
            } else if let Some(pressure) = &load.pressure {
                if load.follower {
                    let value = pressure.compile(&TIME).at(|| pointer("pressure"))?;
                    let spans = (parts.iter())
                        .filter_map(|(body, first, faces)| {
                            Some(PressedSpan::all(body.block.sheet()?, faces, *first))
                        })
                        .flatten()
                        .map(FollowingSpan::Pressure)
                        .collect();
                    let rims = (parts.iter())
                        .filter_map(|(body, first, faces)| {
                            body.block
                                .sheet()
                                .map(|sheet| sheet_rims(sheet, faces, *first))
                        })
                        .collect::<Option<Vec<_>>>()
                        .map(|rims| rims.concat());
                    let faces = (parts.iter())
                        .filter(|(body, ..)| body.block.sheet().is_none())
                        .flat_map(|(body, first, faces)| {
                            let nodes = |f: &Face| body.mesh.face_nodes(*f).shifted(*first);
                            faces.iter().map(nodes)
                        })
                        .collect();
                    let load = FollowerPressure {
                        faces,
                        spans,
                        rims,
                        value,
                    };
                    follower.push((name.clone(), load));
                } else {
                    let value = pressure
                        .compile(&POSITION_AND_TIME)
                        .at(|| pointer("pressure"))?;
                    let points = points();
                    dead.push((name.clone(), DeadLoad::Pressure { points, value }));
                }
            }
        }
        Ok((dead, follower))
    }
}
