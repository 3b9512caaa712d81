//! Rigid surfaces: patches from CAD files or exact shapes, their place and their side.
use super::super::error::{At, number, text};
use super::super::motion::Motion;
use super::super::surface::{FacetModel, SurfaceSet};
use super::super::{ModelError, PairModel, SurfaceModel};
use super::Builder;
use super::cad_bodies::Bodies;
use super::facets::Source;
use super::sides::{NEAR, both_sides, undecided, vote};
use crate::contact::closest::ClosestPoint;
use crate::scene::{self, InitialOverclosure, Side};
use covact_geometry::project::{ComponentSide, Joining, PatchSetError};
use covact_geometry::{NurbsPatch, PatchSet, Surface, Vec3, io, primitives};

/// Patches of a surface as its source gives them.
struct Patches {
    patches: Vec<NurbsPatch>,
    /// What the user knows them by, in the same order.
    labels: Vec<String>,
    /// How near edges must be to each other to be the same.
    joining: Joining,
}

/// Surfaces that are listed one by one in a message; the rest is counted.
pub(super) const LISTED: usize = 8;

impl Builder<'_> {
    /// The surface, and what its patches are called in messages.
    pub(super) fn surface(
        &mut self,
        name: &str,
        surface: &scene::Surface,
    ) -> Result<(SurfaceModel, Vec<String>), ModelError> {
        let source = match &surface.cad {
            Some(cad) => match self.read_cad(name, cad)? {
                Source::Stl(stl) => {
                    let cut = self.stl(name, surface, cad, &stl)?;
                    let size = cut.set.size();
                    let parts = (cut.set, Some(cut.model), cut.labels);
                    return self.placed(name, surface, parts, size);
                }
                Source::Cad(file) => self.cad_patches(name, cad, &file)?,
            },
            None => self.patches(name, surface)?,
        };
        let (set, labels) = scaled(name, surface, source)?;
        let size = set.size();
        let parts = match &surface.facets {
            None => (SurfaceSet::Nurbs(set), None, labels),
            Some(facets) => {
                let cut = self.facets(name, facets, set, &labels)?;
                (cut.set, Some(cut.model), cut.labels)
            }
        };
        self.placed(name, surface, parts, size)
    }

    /// The patches that facets of a surface would stand for.
    pub(super) fn exact(
        &mut self,
        name: &str,
        surface: &scene::Surface,
    ) -> Result<PatchSet, ModelError> {
        let source = match &surface.cad {
            Some(cad) => match self.read_cad(name, cad)? {
                Source::Stl(_) => {
                    let message = format!("{} is an STL file", cad.file.display());
                    let help =
                        "facets are made of exact surfaces: take a CAD file (STEP, IGES or JSON)";
                    return Err(text(format!("/surfaces/{name}/cad/file"), message).help(help));
                }
                Source::Cad(file) => self.cad_patches(name, cad, &file)?,
            },
            None => self.patches(name, surface)?,
        };
        let (mut set, _) = scaled(name, surface, source)?;
        set.set_side_as_given(false);
        Ok(set)
    }

    /// The surface with its motion and depth; `size` is that of the exact surface.
    fn placed(
        &self,
        name: &str,
        surface: &scene::Surface,
        (set, facets, labels): (SurfaceSet, Option<FacetModel>, Vec<String>),
        size: f64,
    ) -> Result<(SurfaceModel, Vec<String>), ModelError> {
        let motion = Motion::new(&surface.motion, &surface.placement)
            .at(|| format!("/surfaces/{name}/motion"))?;
        let model = SurfaceModel {
            name: name.to_owned(),
            set,
            facets,
            motion,
            driven: None,
            depth: surface.depth.unwrap_or(0.1 * size),
        };
        Ok((model, labels))
    }

    /// Notes a round surface that is turned about the origin, which stands for a centre that is not given, and so goes round it.
    fn note_orbit(&mut self, name: &str, surface: &scene::Surface) {
        let sphere = surface.sphere.as_ref().map(|s| s.center);
        let cylinder = surface.cylinder.as_ref().map(|c| c.center);
        let (Some(own), Some(turn)) = (sphere.or(cylinder), &surface.motion.rotation) else {
            return;
        };
        let (own, axis) = (Vec3::from(own), Vec3::from(turn.axis));
        let radius = own.cross(&axis).norm() / axis.norm();
        if turn.center == [0.0; 3] && radius > 0.0 {
            self.notes.push(format!(
                "surface `{name}`: its axis of rotation passes through the origin, {} away from its own center, so that it goes round \
                 that axis: `rotation.center` says otherwise",
                number(radius)
            ));
        }
    }

    fn patches(&mut self, name: &str, surface: &scene::Surface) -> Result<Patches, ModelError> {
        self.note_orbit(name, surface);
        let field = |f: &str| format!("/surfaces/{name}/{f}");
        let made = |f: &str, r: Result<Vec<NurbsPatch>, primitives::PrimitiveError>| {
            r.map(|patches| Patches {
                labels: vec![format!("the {f}"); patches.len()],
                patches,
                joining: Joining::default(),
            })
            .map_err(|e| text(field(f), e.to_string()))
        };
        if let Some(s) = &surface.sphere {
            let (r, center, axis) = (s.radius, s.center.into(), s.axis.into());
            if surface.facets.is_some() {
                // Without poles no facet is a triangle.
                let six = primitives::sphere_without_poles(r, center, axis);
                return made("sphere", six.map(Vec::from));
            }
            return made(
                "sphere",
                primitives::sphere(r, center, axis).map(|p| vec![p]),
            );
        }
        if let Some(c) = &surface.cylinder {
            let p = primitives::cylinder(c.radius, c.length, c.center.into(), c.axis.into());
            return made("cylinder", p.map(|p| vec![p]));
        }
        if let Some(p) = &surface.plane {
            let p = primitives::plane(p.center.into(), p.normal.into(), p.size);
            return made("plane", p.map(|p| vec![p]));
        }
        if let Some(patches) = &surface.patches {
            if patches.is_empty() {
                return Err(text(field("patches"), "there are no patches"));
            }
            return Ok(Patches {
                labels: (1..=patches.len()).map(|i| format!("patch {i}")).collect(),
                patches: patches.to_vec(),
                joining: Joining::default(),
            });
        }
        Err(text(
            format!("/surfaces/{name}"),
            "a surface needs one of `cad`, `sphere`, `cylinder`, `plane`",
        ))
    }

    fn cad_patches(
        &mut self,
        name: &str,
        cad: &scene::CadFile,
        file: &io::CadFile,
    ) -> Result<Patches, ModelError> {
        let field = |f: &str| format!("/surfaces/{name}/cad/{f}");
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
        let bodies = Bodies::chosen(cad, file)
            .map_err(|(message, help)| text(field("bodies"), message).help(help))?;
        // Bodies that were read as a whole miss nothing.
        let asked = |s: &&io::Skipped| wanted(s.entity) && !bodies.are_complete(file);
        let skipped: Vec<_> = file.skipped.iter().filter(asked).collect();
        let list = || {
            let shown = skipped.iter().take(LISTED).map(|s| {
                format!(
                    "entity {} ({} {}): {}",
                    s.entity, s.type_number, s.name, s.reason
                )
            });
            let more = skipped.len().saturating_sub(LISTED);
            let rest = (more > 0).then(|| format!("and {more} more"));
            shown.chain(rest).collect::<Vec<_>>().join("; ")
        };
        if !skipped.is_empty() {
            if !cad.allow_skipped {
                return Err(text(
                    field("file"),
                    format!(
                        "{shown}: {} of {} surface(s) cannot be used: {}",
                        skipped.len(),
                        skipped.len() + file.patches.iter().filter(|p| wanted(p.entity)).count(),
                        list()
                    ),
                )
                .help(
                    "export them as trimmed NURBS surfaces (144 on 128), name the entities to use in `entities`, \
                     or set `allow_skipped` to go on without them",
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
                let there: Vec<String> =
                    (file.patches.iter().map(|p| p.entity.to_string())).collect();
                let message = format!("{shown} has no surface entity {entity}");
                return Err(text(field("entities"), message).help(format!(
                    "surface entities of this file: {}",
                    there.join(", ")
                )));
            }
        }
        let taken = |p: &&io::CadPatch| wanted(p.entity) && bodies.hold(p);
        let chosen: Vec<_> = file.patches.iter().filter(taken).collect();
        if chosen.is_empty() {
            let why = match skipped.is_empty() {
                true => String::new(),
                false => format!(": {}", list()),
            };
            return Err(text(
                field("file"),
                format!("{shown} holds no surface that can be used{why}"),
            )
            .help("`covact inspect` lists what is in a CAD file"));
        }
        let patches = (chosen.iter())
            .map(|p| p.patch.transformed(&|x| x * factor))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|e| text(field("file"), e.to_string()))?;
        let unit = self.scene.units.length.name();
        let conversion = match factor {
            1.0 => format!("lengths in {unit}"),
            _ => format!(
                "lengths converted from {} to {unit} (times {})",
                file.unit.name,
                number(factor)
            ),
        };
        self.notes.push(format!(
            "surface `{name}`: {} patch(es) from {shown}, {conversion}",
            patches.len(),
        ));
        self.notes
            .extend(file.notes.iter().map(|n| format!("surface `{name}`: {n}")));
        Ok(Patches {
            labels: (chosen.iter())
                .map(|p| format!("entity {}", p.entity))
                .collect(),
            patches,
            joining: Joining {
                tolerance: cad.tolerance,
                resolution: file.resolution.map(|r| r * factor),
            },
        })
    }

    /// Decides the side of every part of a surface.
    pub(super) fn orient(
        &mut self,
        name: &str,
        surface: &scene::Surface,
        (model, labels): (&mut SurfaceModel, &[String]),
        pairs: &[&PairModel],
    ) -> Result<(), ModelError> {
        let pointer = || format!("/surfaces/{name}/side");
        if pairs.is_empty() {
            self.warnings
                .push(format!("surface `{name}` takes part in no contact"));
        }
        let how = match surface.side {
            Side::Auto if pairs.is_empty() => return Ok(()),
            Side::Auto => {
                self.orient_to_slave(name, (model, labels), pairs)?;
                "where the slave starts"
            }
            Side::AsGiven => {
                model.set.set_side_as_given(false);
                "as its source gives it"
            }
            Side::Reversed => {
                model.set.set_side_as_given(true);
                "the reverse of what its source gives"
            }
            Side::Outward | Side::Inward => {
                let inward = surface.side == Side::Inward;
                model.set.set_sides_outward(inward).map_err(|component| {
                    let first = model.set.components()[component][0];
                    let message = format!(
                        "surface `{name}` encloses nothing and curves around nothing at {}, so that it has no outward side there",
                        labels.get(first).map_or("patch 1", String::as_str)
                    );
                    text(pointer(), message)
                        .help("take `as_given`, `reversed` or `{\"point\": [x, y, z]}`")
                })?;
                match inward {
                    true => "towards what it curves around",
                    false => "away from what it curves around",
                }
            }
            Side::Point(p) => {
                let pose = model.motion.pose(0.0).at(pointer)?;
                let local = pose.inverse_transform_point(&Vec3::from(p).into()).coords;
                let found = (model.set.orient_towards(&[local]))
                    .map_err(|e| both_sides(name, labels, &e))?;
                self.undecided(name, (model, labels), &found, "the point");
                "where the given point lies"
            }
        };
        let what = match model.facets {
            Some(_) => "facet(s)",
            None => "patch(es)",
        };
        let reversed = model.set.sides().iter().filter(|s| **s < 0.0).count();
        self.notes.push(format!(
            "surface `{name}`: its outside is {how} (normals of {reversed} of {} {what} turned round); a point \
             deeper than {} below it is not in contact (`depth`)",
            model.set.count(),
            number(model.depth)
        ));
        Ok(())
    }

    /// The slave points start outside.
    fn orient_to_slave(
        &mut self,
        name: &str,
        (model, labels): (&mut SurfaceModel, &[String]),
        pairs: &[&PairModel],
    ) -> Result<(), ModelError> {
        let pose = (model.motion.pose(0.0)).at(|| format!("/surfaces/{name}/motion"))?;
        let local = |x: Vec3| pose.inverse_transform_point(&x.into()).coords;
        // Facets lie on either side of the surface that they stand for, on either side of this contact: points as near as that say
        // nothing.
        let chord = (model.facets.as_ref()).and_then(|f| f.chord).unwrap_or(0.0);
        let mut points = [Vec::new(), Vec::new()];
        for pair in pairs {
            let near = (2.0 * chord).max(NEAR * pair.element_size);
            for p in &pair.points {
                let x = local(self.start(p));
                let clear = model.set.project(&x, None, near).is_none();
                points[usize::from(!clear)].push(x);
            }
        }
        let [clear, near] = points;
        // The elements below the faces tell where the faces themselves do not.
        let centers = self.slave_element_centers(name)?;
        let centers: Vec<Vec3> = centers.into_iter().map(local).collect();
        let near = if chord > 0.0 { Vec::new() } else { near };
        let found = vote(&mut model.set, [&clear, &centers, &near])
            .map_err(|e| both_sides(name, labels, &e))?;
        self.undecided(name, (model, labels), &found, "where the slave starts");
        self.shrunk_on(name, model, &found, &centers);
        Ok(())
    }

    /// Where a contact shrinks onto the surface, its slave starts on the wrong side: parts of the surface that the slave points
    /// put on one side and the elements behind them on the other are as the elements say.
    fn shrunk_on(
        &mut self,
        name: &str,
        model: &mut SurfaceModel,
        found: &[ComponentSide],
        centers: &[Vec3],
    ) {
        let shrinks = self.scene.contacts.values().any(|c| {
            c.master.single() == name
                && matches!(c.initial_overclosure, InitialOverclosure::Shrink { .. })
        });
        if !shrinks {
            return;
        }
        let before = model.set.sides().to_vec();
        if model.set.orient_towards(centers).is_err() {
            return;
        }
        let changed = found.iter().filter(|part| {
            let patch = model.set.components()[part.component][0];
            model.set.sides()[patch] != before[patch]
        });
        let changed = changed.count();
        if changed > 0 {
            self.notes.push(format!(
                "surface `{name}`: the slave points start on one side of {changed} of its {} unconnected part(s), the elements                  behind them on the other; as a contact asks for `shrink`, the points count as overclosed, and the outside is                  where the elements are: say `side` if that is wrong",
                found.len()
            ));
        }
    }

    /// Centres of the elements below the slave faces of all contacts with a surface.
    fn slave_element_centers(&self, surface: &str) -> Result<Vec<Vec3>, ModelError> {
        let mut centers = Vec::new();
        for (name, contact) in &self.scene.contacts {
            if contact.master.single() == surface {
                let (body, faces) =
                    self.side(&contact.slave, &format!("/contacts/{name}/slave"))?;
                let mesh = &self.bodies[body].mesh;
                centers.extend(
                    faces
                        .iter()
                        .map(|f| mesh.element_center(f.element as usize)),
                );
            }
        }
        Ok(centers)
    }

    /// Warns of parts whose side nothing decides.
    fn undecided(
        &mut self,
        name: &str,
        (model, labels): (&SurfaceModel, &[String]),
        found: &[ComponentSide],
        by: &str,
    ) {
        let open: Vec<usize> = (found.iter().filter(|f| undecided(f)))
            .map(|f| model.set.components()[f.component][0])
            .collect();
        if let Some(&first) = open.first() {
            self.warnings.push(format!(
                "surface `{name}`: {by} does not decide the side of {} of its {} unconnected part(s), the first that \
                 of {}; there the side is as the source gives it: say `side` if that is wrong",
                open.len(),
                found.len(),
                labels.get(first).map_or("patch 1", String::as_str)
            ));
        }
    }
}

/// The patches at the size that the placement asks for, with their labels.
fn scaled(
    name: &str,
    surface: &scene::Surface,
    source: Patches,
) -> Result<(PatchSet, Vec<String>), ModelError> {
    let here = || format!("/surfaces/{name}");
    let scale = surface.placement.scale;
    let patches = if scale == 1.0 {
        source.patches
    } else {
        (source.patches.iter())
            .map(|p| p.transformed(&|x| x * scale))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|e| text(here(), e.to_string()))?
    };
    let joining = Joining {
        tolerance: source.joining.tolerance.map(|t| t * scale),
        resolution: source.joining.resolution.map(|r| r * scale),
    };
    let set = PatchSet::join(patches, joining).at(here)?;
    if let Err(PatchSetError::NotOrientable(a, b, members)) = set.two_sided() {
        let label = |patch: usize| source.labels.get(patch).map_or("?", String::as_str);
        let message = format!(
            "surface `{name}` has one side only, like a Moebius band: {} and {} cannot be given the same outside in a part \
             of {} patch(es), and contact needs an outside",
            label(a),
            label(b),
            members.len()
        );
        return Err(text(here(), message).help(
            "leave out one of the patches with `cad.entities`, or cut the surface open in the CAD system",
        ));
    }
    Ok((set, source.labels))
}

/// Facets joined where their edges coincide.
pub(super) fn joined<S: Surface>(facets: Vec<S>) -> Result<PatchSet<S>, PatchSetError> {
    let set = PatchSet::new(facets, None)?;
    set.two_sided()?;
    Ok(set)
}
