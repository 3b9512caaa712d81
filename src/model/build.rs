//! Scene to model.
use super::error::{At, text};
use super::loads::{DeadLoad, FollowerPressure, load_points};
use super::motion::Motion;
use super::slave::slave_points;
use super::supports::Supports;
use super::{BodyModel, Model, ModelError, PairModel, SurfaceModel, penalty};
use crate::mesh::{self, Face, Mesh};
use crate::scene::{
    self, LoadedScene, POSITION_AND_TIME, Penalty, Scene, Side, TIME, TimeFunction, Value,
};
use crate::shell::{H8Block, Law};
use covact_geometry::{NurbsPatch, PatchSet, Vec3, io, primitives};
use std::collections::BTreeMap;
use std::path::Path;

/// What is being collected while the model is built.
pub(super) struct Builder<'s> {
    pub(super) scene: &'s Scene,
    dir: &'s Path,
    pub(super) nodes: Vec<Vec3>,
    pub(super) bodies: Vec<BodyModel>,
    body_index: BTreeMap<&'s str, usize>,
    notes: Vec<String>,
    warnings: Vec<String>,
}

/// Reads every mesh and CAD file of the scene and resolves all names.
///
/// # Errors
/// [`ModelError`] with the field of the scene at fault.
pub fn build(loaded: &LoadedScene) -> Result<Model, ModelError> {
    let scene = &loaded.scene;
    let mut builder = Builder {
        scene,
        dir: &loaded.dir,
        nodes: Vec::new(),
        bodies: Vec::new(),
        body_index: BTreeMap::new(),
        notes: Vec::new(),
        warnings: Vec::new(),
    };
    builder.bodies()?;
    let (pairs, surfaces) = builder.contacts()?;
    let Supports {
        names: supports,
        prescribed,
        means,
        dofs,
    } = builder.supports()?;
    let (dead_loads, follower_loads) = builder.loads()?;
    let mut model = Model {
        title: scene.title.clone(),
        nodes: builder.nodes,
        bodies: builder.bodies,
        surfaces,
        pairs,
        supports,
        prescribed,
        means,
        dead_loads,
        follower_loads,
        dofs,
        effects: Vec::new(),
        notes: builder.notes,
        warnings: builder.warnings,
        kinks: Vec::new(),
    };
    model.effects = super::effects::effects(scene, &model);
    model.kinks = kinks(&model, scene.solution.end_time);
    if let Some(free) = super::free_motion::free_motions(&model).first() {
        return Err(text(
            "/supports",
            format!(
                "body `{}` can move freely {} ({} rigid motion(s) that no support hinders): \
                 add a support that holds it",
                free.body, free.motion, free.count
            ),
        ));
    }
    super::initial::check(&mut model)?;
    Ok(model)
}

/// Times inside the run at which something prescribed has a kink.
fn kinks(model: &Model, end: f64) -> Vec<f64> {
    let mut times: Vec<f64> = (model.surfaces.iter().flat_map(|s| s.motion.functions()))
        .chain(model.dead_loads.iter().flat_map(|(_, l)| l.functions()))
        .chain(model.follower_loads.iter().map(|(_, l)| &l.value))
        .chain(model.prescribed.iter().filter_map(|p| p.value.as_ref()))
        .chain(model.means.iter().filter_map(|p| p.mean.as_ref()))
        .flat_map(TimeFunction::breakpoints)
        .filter(|t| *t > 0.0 && *t < end)
        .collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

/// Body and set of `body.set`.
fn split(reference: &str) -> (&str, &str) {
    reference.split_once('.').unwrap_or((reference, ""))
}

impl<'s> Builder<'s> {
    fn bodies(&mut self) -> Result<(), ModelError> {
        for (name, body) in &self.scene.bodies {
            let at = || format!("/bodies/{name}/mesh");
            let (mut mesh, report) = mesh::build(&body.mesh, self.dir).at(at)?;
            for (set, selection) in &body.sets {
                mesh.add_set(set, selection)
                    .at(|| format!("/bodies/{name}/sets/{set}"))?;
            }
            mesh.check().at(at)?;
            (self.notes).extend(report.notes.iter().map(|n| format!("body `{name}`: {n}")));
            let material = self.material(name, &body.material)?;
            let law = Law::new(&material).at(|| format!("/bodies/{name}/material"))?;
            let block = H8Block::new(&mesh, body.element.into(), law).at(at)?;
            let first_node = u32::try_from(self.nodes.len())
                .map_err(|_| text(at(), "too many nodes: more than 2^32"))?;
            self.nodes.extend_from_slice(&mesh.nodes);
            self.body_index.insert(name, self.bodies.len());
            self.bodies.push(BodyModel {
                name: name.clone(),
                mesh,
                block,
                first_node,
            });
        }
        Ok(())
    }

    fn material(&self, body: &str, name: &str) -> Result<scene::Material, ModelError> {
        self.scene.materials.get(name).copied().ok_or_else(|| {
            text(
                format!("/bodies/{body}/material"),
                format!("there is no material `{name}`"),
            )
        })
    }

    fn body(&self, reference: &str, pointer: &str) -> Result<(usize, &Mesh, u32), ModelError> {
        let (name, _) = split(reference);
        let index = *(self.body_index.get(name))
            .ok_or_else(|| text(pointer, format!("there is no body `{name}`")))?;
        let body = &self.bodies[index];
        Ok((index, &body.mesh, body.first_node))
    }

    fn faces(&self, reference: &str, pointer: &str) -> Result<(usize, Vec<Face>), ModelError> {
        let (index, mesh, _) = self.body(reference, pointer)?;
        let faces = mesh
            .face_set(split(reference).1)
            .at(|| pointer.to_owned())?;
        Ok((index, faces.to_vec()))
    }

    /// Nodes of a node set, or of a face set where there is no node set of that name.
    pub(super) fn set_nodes(
        &self,
        reference: &str,
        pointer: &str,
    ) -> Result<(usize, Vec<u32>), ModelError> {
        let (index, mesh, first) = self.body(reference, pointer)?;
        let set = split(reference).1;
        let local = match mesh.face_sets.get(set) {
            Some(faces) if !mesh.node_sets.contains_key(set) => mesh.nodes_of(faces),
            _ => mesh.node_set(set).at(|| pointer.to_owned())?.to_vec(),
        };
        Ok((index, local.into_iter().map(|n| n + first).collect()))
    }

    fn contacts(&mut self) -> Result<(Vec<PairModel>, Vec<SurfaceModel>), ModelError> {
        let mut surfaces = Vec::new();
        let mut surface_index = BTreeMap::new();
        for (name, surface) in &self.scene.surfaces {
            surface_index.insert(name.as_str(), surfaces.len());
            surfaces.push(self.surface(name, surface)?);
        }
        let mut pairs = Vec::new();
        for (name, contact) in &self.scene.contacts {
            let pointer = |field: &str| format!("/contacts/{name}/{field}");
            let (body, faces) = self.faces(&contact.slave, &pointer("slave"))?;
            let surface = *(surface_index.get(contact.master.as_str())).ok_or_else(|| {
                text(
                    pointer("master"),
                    format!("there is no surface `{}`", contact.master),
                )
            })?;
            let model = &self.bodies[body];
            let points = slave_points(&model.mesh, &faces, contact.points, model.first_node)
                .at(|| pointer("points"))?;
            let size = penalty::slave_size(&model.mesh, &faces);
            let material = &self.scene.bodies[&model.name].material;
            let automatic = penalty::automatic(&self.scene.materials[material], &size);
            let (eps_n, is_automatic) = match contact.penalty {
                Penalty::Auto => (automatic, true),
                Penalty::Value(v) => (v, false),
                Penalty::Scaled(f) => (f * automatic, false),
            };
            self.notes.push(match contact.penalty {
                Penalty::Value(_) => format!(
                    "contact `{name}`: penalty {eps_n:.6e} as given ({:.3} of the automatic value)",
                    eps_n / automatic
                ),
                _ => format!(
                    "contact `{name}`: penalty {eps_n:.6e} (automatic value {automatic:.6e})"
                ),
            });
            pairs.push(PairModel {
                name: name.clone(),
                body,
                surface,
                points,
                eps_n,
                automatic: is_automatic,
                tangent: contact.tangent,
                element_size: size.edge,
            });
        }
        for (index, (name, surface)) in self.scene.surfaces.iter().enumerate() {
            self.orient(name, surface, index, &mut surfaces[index], &pairs)?;
        }
        Ok((pairs, surfaces))
    }

    fn surface(
        &mut self,
        name: &str,
        surface: &scene::Surface,
    ) -> Result<SurfaceModel, ModelError> {
        let here = || format!("/surfaces/{name}");
        let (patches, tolerance) = self.patches(name, surface)?;
        let scale = surface.placement.scale;
        let patches = if scale == 1.0 {
            patches
        } else {
            (patches.iter())
                .map(|p| p.transformed(&|x| x * scale))
                .collect::<Result<Vec<_>, _>>()
                .map_err(|e| text(here(), e.to_string()))?
        };
        let set = PatchSet::new(patches, tolerance.map(|t| t * scale)).at(here)?;
        let motion = Motion::new(&surface.motion, &surface.placement)
            .at(|| format!("/surfaces/{name}/motion"))?;
        let depth = surface.depth.unwrap_or(0.1 * set.size());
        Ok(SurfaceModel {
            name: name.to_owned(),
            set,
            motion,
            depth,
        })
    }

    fn patches(
        &mut self,
        name: &str,
        surface: &scene::Surface,
    ) -> Result<(Vec<NurbsPatch>, Option<f64>), ModelError> {
        let field = |f: &str| format!("/surfaces/{name}/{f}");
        let made = |f: &str, r: Result<Vec<NurbsPatch>, primitives::PrimitiveError>| {
            r.map(|p| (p, None))
                .map_err(|e| text(field(f), e.to_string()))
        };
        if let Some(s) = &surface.sphere {
            let p = primitives::sphere(s.radius, s.center.into(), s.axis.into());
            return made("sphere", p.map(|p| vec![p]));
        }
        if let Some(c) = &surface.cylinder {
            let p = primitives::cylinder(c.radius, c.length, c.center.into(), c.axis.into());
            return made("cylinder", p.map(|p| vec![p]));
        }
        if let Some(p) = &surface.plane {
            let p = primitives::plane(p.center.into(), p.normal.into(), p.size);
            return made("plane", p.map(|p| vec![p]));
        }
        let Some(cad) = &surface.cad else {
            return Err(text(
                format!("/surfaces/{name}"),
                "a surface needs one of `cad`, `sphere`, `cylinder`, `plane`",
            ));
        };
        self.cad_patches(name, cad)
    }

    fn cad_patches(
        &mut self,
        name: &str,
        cad: &scene::CadFile,
    ) -> Result<(Vec<NurbsPatch>, Option<f64>), ModelError> {
        let field = |f: &str| format!("/surfaces/{name}/cad/{f}");
        let path = self.dir.join(&cad.file);
        let file = io::read_path(&path).at(|| field("file"))?;
        let shown = cad.file.display();
        let own = io::LengthUnit::from_name(self.scene.units.length.name());
        let factor = match own.as_ref().and_then(|own| file.unit.factor_to(own)) {
            Some(factor) => factor,
            None => {
                self.notes.push(format!(
                    "surface `{name}`: {shown} states no length unit; its numbers are taken as {}",
                    self.scene.units.length.name()
                ));
                1.0
            }
        };
        let wanted = |entity: u32| cad.entities.is_empty() || cad.entities.contains(&entity);
        let skipped: Vec<_> = file.skipped.iter().filter(|s| wanted(s.entity)).collect();
        let list = || {
            let shown = skipped.iter().take(8).map(|s| {
                format!(
                    "entity {} ({} {}): {}",
                    s.entity, s.type_number, s.name, s.reason
                )
            });
            let more = skipped.len().saturating_sub(8);
            let rest = (more > 0).then(|| format!("and {more} more"));
            shown.chain(rest).collect::<Vec<_>>().join("; ")
        };
        if !skipped.is_empty() {
            if !cad.allow_skipped {
                return Err(text(
                    field("file"),
                    format!(
                        "{shown}: {} surface(s) cannot be used: {}. Name the entities to use in \
                         `entities`, or set `allow_skipped` to go on without them",
                        skipped.len(),
                        list()
                    ),
                ));
            }
            let n = skipped.len();
            self.warnings.push(format!(
                "surface `{name}`: {n} surface(s) of {shown} left out: {}",
                list()
            ));
        }
        for entity in &cad.entities {
            let known = file.patches.iter().any(|p| p.entity == *entity);
            if !known && !skipped.iter().any(|s| s.entity == *entity) {
                let there = file.patches.iter().map(|p| p.entity.to_string());
                return Err(text(
                    field("entities"),
                    format!(
                        "{shown} has no surface entity {entity}; it has {}",
                        there.collect::<Vec<_>>().join(", ")
                    ),
                ));
            }
        }
        let chosen: Vec<_> = file.patches.iter().filter(|p| wanted(p.entity)).collect();
        if chosen.is_empty() {
            return Err(text(
                field("file"),
                format!("{shown} holds no surface that can be used"),
            ));
        }
        let patches = (chosen.iter())
            .map(|p| p.patch.transformed(&|x| x * factor))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|e| text(field("file"), e.to_string()))?;
        let bounds = bounds(&patches);
        self.notes.push(format!(
            "surface `{name}`: {} patch(es) from {shown}, {} -> {} (factor {factor}), \
             x {:.6} to {:.6}, y {:.6} to {:.6}, z {:.6} to {:.6}",
            patches.len(),
            file.unit.name,
            self.scene.units.length.name(),
            bounds[0].x,
            bounds[1].x,
            bounds[0].y,
            bounds[1].y,
            bounds[0].z,
            bounds[1].z,
        ));
        self.notes
            .extend(file.notes.iter().map(|n| format!("surface `{name}`: {n}")));
        Ok((patches, cad.tolerance))
    }

    fn orient(
        &mut self,
        name: &str,
        surface: &scene::Surface,
        index: usize,
        model: &mut SurfaceModel,
        pairs: &[PairModel],
    ) -> Result<(), ModelError> {
        let pointer = || format!("/surfaces/{name}/side");
        match surface.side {
            Side::AsGiven => model.set.set_side_as_given(false),
            Side::Reversed => model.set.set_side_as_given(true),
            Side::Point(p) => {
                let pose = model.motion.pose(0.0).at(pointer)?;
                let local = pose.inverse_transform_point(&Vec3::from(p).into()).coords;
                model.set.orient_towards(&[local]).at(pointer)?;
            }
            Side::Auto => {
                let pose = model.motion.pose(0.0).at(pointer)?;
                let zero = vec![0.0; 3 * self.nodes.len()];
                let starts: Vec<Vec3> = (pairs.iter().filter(|p| p.surface == index))
                    .flat_map(|pair| pair.points.iter())
                    .map(|p| {
                        let x = (p.terms()).fold(Vec3::zeros(), |x, (n, w)| {
                            x + (self.nodes[n]
                                + Vec3::new(zero[3 * n], zero[3 * n + 1], zero[3 * n + 2]))
                                * w
                        });
                        pose.inverse_transform_point(&x.into()).coords
                    })
                    .collect();
                if starts.is_empty() {
                    self.warnings
                        .push(format!("surface `{name}` takes part in no contact"));
                    return Ok(());
                }
                model.set.orient_towards(&starts).at(pointer)?;
            }
        }
        let reversed = model.set.sides().iter().filter(|s| **s < 0.0).count();
        let how = match surface.side {
            Side::Auto => "where the slave starts",
            Side::AsGiven => "as the file gives it",
            Side::Reversed => "the reverse of what the file gives",
            Side::Point(_) => "where the given point lies",
        };
        self.notes.push(format!(
            "surface `{name}`: outside is {how}; normals of {reversed} of {} patch(es) reversed, \
             search depth {:.6e}",
            model.set.patches().len(),
            model.depth
        ));
        Ok(())
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
            let (body, faces) = self.faces(&load.on, &pointer("on"))?;
            let (mesh, first) = (&self.bodies[body].mesh, self.bodies[body].first_node);
            let points = load_points(mesh, &faces, first);
            if let Some(traction) = &load.traction {
                let value = vector(traction, "traction", &POSITION_AND_TIME)?;
                dead.push((name.clone(), DeadLoad::Traction { points, value }));
            } else if let Some(pressure) = &load.pressure {
                if load.follower {
                    let value = pressure.compile(&TIME).at(|| pointer("pressure"))?;
                    let faces = (faces.iter())
                        .map(|&f| mesh.face_nodes(f).map(|n| n + first))
                        .collect();
                    follower.push((name.clone(), FollowerPressure { faces, value }));
                } else {
                    let value = pressure
                        .compile(&POSITION_AND_TIME)
                        .at(|| pointer("pressure"))?;
                    dead.push((name.clone(), DeadLoad::Pressure { points, value }));
                }
            }
        }
        Ok((dead, follower))
    }

    /// Share of each node in a total force: by tributary area on a face set, equal on a node set.
    fn shares(&self, reference: &str, pointer: &str) -> Result<Vec<(u32, f64)>, ModelError> {
        let (_, mesh, first) = self.body(reference, pointer)?;
        let set = split(reference).1;
        if let Some(faces) = mesh.face_sets.get(set) {
            let points =
                slave_points(mesh, faces, scene::Points::Nodes, first).at(|| pointer.to_owned())?;
            let total: f64 = points.iter().map(|p| p.area).sum();
            return Ok(points
                .iter()
                .map(|p| (p.nodes[0], p.area / total))
                .collect());
        }
        let (_, nodes) = self.set_nodes(reference, pointer)?;
        let share = 1.0 / nodes.len().max(1) as f64;
        Ok(nodes.into_iter().map(|n| (n, share)).collect())
    }
}

fn bounds(patches: &[NurbsPatch]) -> [Vec3; 2] {
    (patches.iter().map(NurbsPatch::bounds))
        .reduce(|a, b| [a[0].inf(&b[0]), a[1].sup(&b[1])])
        .unwrap_or_default()
}
