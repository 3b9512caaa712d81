//! Contact pairs: slave points, masters, penalties.
mod ends;
mod friction;
mod masters;
mod pressed;
mod sampling;

use super::super::augmentation::AugmentationModel;
use super::super::averaged::SlaveNodes;
use super::super::edges;
use super::super::error::{At, number, text};
use super::super::master::Master;
use super::super::slave::slave_points;
use super::super::{HalfPass, ModelError, PairModel, SurfaceModel, penalty, segments, slave};
use super::Builder;
use super::nurbs_bodies::sheet_size;
use crate::contact::points::SlavePoint;
use crate::machine::memory;
use crate::mesh::Face;
use crate::scene::{Contact, Gap, MasterSurface, Passes, Penalty, Points};
use penalty::{FaceSize, Suitable};
use std::collections::{BTreeMap, BTreeSet};

/// Part of the slave's stiffness below which a master is much softer.
const MUCH_SOFTER: f64 = 0.1;

/// What the slave points of a pair are on.
pub(super) enum Side<'a> {
    /// The slave faces.
    Faces,
    /// Those of them that are at these nodes of the body.
    Nodes(&'a BTreeSet<u32>),
    /// The rims of a rigid surface, with the faces of this body as their master.
    Rim {
        body: usize,
        points: Vec<SlavePoint>,
    },
}

impl Builder<'_> {
    /// All rigid surfaces with the names of their patches, as far as they can be read, and what is wrong with the others.
    pub(super) fn surfaces(&mut self) -> (Vec<(SurfaceModel, Vec<String>)>, Vec<ModelError>) {
        let scene = self.scene;
        let (mut surfaces, mut errors) = (Vec::new(), Vec::new());
        for (name, surface) in &scene.surfaces {
            match self.surface(name, surface) {
                Ok(model) => surfaces.push(model),
                Err(error) => errors.push(error),
            }
        }
        (surfaces, errors)
    }

    /// All contact pairs, those of rims last, and all rigid surfaces with their sides.
    pub(super) fn contacts(
        &mut self,
        surfaces: Vec<(SurfaceModel, Vec<String>)>,
    ) -> Result<(Vec<PairModel>, Vec<SurfaceModel>), ModelError> {
        let (mut surfaces, labels): (Vec<_>, Vec<_>) = surfaces.into_iter().unzip();
        let names = self.scene.surfaces.keys().enumerate();
        let surface_index: BTreeMap<&str, usize> = names.map(|(i, n)| (n.as_str(), i)).collect();
        let mut pairs = Vec::new();
        for (name, contact) in &self.scene.contacts {
            let rigid = surface_index.get(contact.master.single()).copied();
            let first = pairs.len();
            pairs.push(self.pair(name, contact, rigid, Side::Faces)?);
            if contact.passes == Passes::Edges && rigid.is_none() {
                pairs.extend(self.edge_pass(name, contact, first)?);
            }
            if contact.passes == Passes::TwoHalf {
                if contact.master_surface == Some(MasterSurface::Smooth) {
                    self.warnings.push(format!(
                        "contact `{name}`: with `two_half` each pass meets the smooth surface of one side and the faces of \
                         the other, which differ by the sagitta of an element: the forces of both sides (`imbalance`) \
                         agree only as far as meshes are fine for their curvature"
                    ));
                }
                let mut back = contact.clone();
                std::mem::swap(&mut back.slave, &mut back.master);
                pairs.push(self.pair(name, &back, None, Side::Faces)?);
                for (index, pair) in pairs[first..].iter_mut().enumerate() {
                    pair.half = Some(HalfPass {
                        other: first + 1 - index,
                        back: index == 1,
                    });
                }
            }
        }
        for (index, (name, surface)) in self.scene.surfaces.iter().enumerate() {
            let own: Vec<&PairModel> = (pairs.iter())
                .filter(|p| p.rigid_master() == Some(index))
                .collect();
            self.seams(name, &surfaces[index], &labels[index]);
            let model = (&mut surfaces[index], labels[index].as_slice());
            self.orient(name, surface, model, &own)?;
        }
        let on_rims = self.rims(&pairs, &surfaces)?;
        for pair in &on_rims {
            // What comes past a border meets the nodes on that.
            let of = pair.edges_of.map(|of| &mut pairs[of].points);
            of.into_iter().flatten().for_each(|p| p.rounding = 0.0);
        }
        pairs.extend(on_rims);
        Ok((pairs, surfaces))
    }

    /// The sharp edges of the master of pair `of` as slaves; nothing where it has none, which is told.
    fn edge_pass(
        &mut self,
        name: &str,
        contact: &Contact,
        of: usize,
    ) -> Result<Option<PairModel>, ModelError> {
        let pointer = |field: &str| format!("/contacts/{name}/{field}");
        self.sheet_contact(name, contact, None)?;
        let (slave, slave_faces) = self.contact_faces(name, &contact.slave, &pointer("slave"))?;
        let (master, faces) = self.contact_faces(name, &contact.master, &pointer("master"))?;
        if slave == master {
            let message = "self contact has no edges of another side".to_owned();
            return Err(text(pointer("passes"), message).help("leave `passes` out"));
        }
        let facets = (self.moving_facets(slave, &slave_faces, false)).at(|| pointer("slave"))?;
        let (size, _) = self.stiffness(slave, &slave_faces);
        let model = &self.bodies[master];
        let position = |node: u32| self.nodes[(node + model.first_node) as usize];
        let nodes = edges::sharp_nodes(&model.mesh, &faces, position, &facets, size.edge);
        self.notes.push(match nodes.len() {
            0 => format!(
                "contact `{name}`: `{}` has no sharp edges but those at the border of `{}`: none are slaves",
                contact.master, contact.slave
            ),
            n => format!(
                "contact `{name}`: {n} nodes on sharp edges of `{}` are slaves on `{}` as well",
                contact.master, contact.slave
            ),
        });
        if nodes.is_empty() {
            return Ok(None);
        }
        let back = Contact {
            slave: contact.master.clone(),
            master: contact.slave.clone(),
            points: Points::Nodes,
            gap: Gap::Pointwise,
            master_surface: None,
            depth: None,
            ..contact.clone()
        };
        let pair = self.pair(name, &back, None, Side::Nodes(&nodes))?;
        Ok(Some(PairModel {
            edges_of: Some(of),
            ..pair
        }))
    }

    /// The slave faces of a contact with its slave points: the body, the faces and the points.
    fn slave_side(
        &mut self,
        name: &str,
        contact: &Contact,
        rigid: Option<usize>,
    ) -> Result<(usize, Vec<Face>, Vec<SlavePoint>, Points), ModelError> {
        let pointer = |field: &str| format!("/contacts/{name}/{field}");
        let (body, faces) = self.contact_faces(name, &contact.slave, &pointer("slave"))?;
        self.sheet_contact(name, contact, rigid)?;
        let sampled = self.sampling(name, contact, (body, &faces), rigid.is_some())?;
        let model = &self.bodies[body];
        let first_node = model.first_node;
        let per_face = match sampled {
            Points::Auto | Points::Nodes => 1,
            Points::Gauss(n) | Points::Lobatto(n) => u64::from(n) * u64::from(n),
            Points::Segments(n) => u64::from(n / 2 + 1).pow(2),
        };
        let bytes = slave::bytes(memory::times(faces.len() as u64, per_face));
        memory::ask(bytes).map_err(|shortage| {
            let message = format!(
                "contact `{name}`: {per_face} slave points on each of {} faces: {shortage}",
                faces.len()
            );
            text(pointer("points"), message).help("take fewer points per face, or fewer elements")
        })?;
        let of_sheet = model.block.sheet().is_some();
        let points = match of_sheet {
            true => self.sheet_points(body, &faces, sampled),
            false => slave_points(&model.mesh, &faces, sampled, first_node),
        }
        .at(|| pointer("points"))?;
        Ok((body, faces, points, sampled))
    }

    /// A contact pair.
    pub(super) fn pair(
        &mut self,
        name: &str,
        contact: &Contact,
        rigid: Option<usize>,
        side: Side,
    ) -> Result<PairModel, ModelError> {
        let pointer = |field: &str| format!("/contacts/{name}/{field}");
        let (body, faces, mut points, sampled) = match side {
            Side::Rim { body, points } => (body, Vec::new(), points, Points::Nodes),
            Side::Faces => self.slave_side(name, contact, rigid)?,
            Side::Nodes(only) => {
                let (body, faces, mut points, sampled) = self.slave_side(name, contact, rigid)?;
                let first_node = self.bodies[body].first_node;
                points.retain(|p| only.contains(&(p.nodes[0] - first_node)));
                (body, faces, points, sampled)
            }
        };
        // A rim has no elements of its own: it is as stiff as what it meets.
        let rim = faces.is_empty();
        let first_node = self.bodies[body].first_node;
        let of = match rim {
            false => faces.clone(),
            true => {
                self.contact_faces(name, &contact.master, &pointer("master"))?
                    .1
            }
        };
        let (size, mut suits) = self.stiffness(body, &of);
        let mut softer = match rim {
            false => "the slave's",
            true => "the master's",
        };
        let master = match rigid {
            Some(surface) => Master::Rigid(surface),
            None => {
                let (mut master, of_master) = self.body_master(name, contact)?;
                if master.body == body && !rim {
                    self.own_body(name, contact, &faces, &mut points, &mut master)?;
                }
                if let Points::Segments(degree) = sampled {
                    let mesh = &self.bodies[body].mesh;
                    let nodes: Vec<_> = (faces.iter())
                        .map(|&f| mesh.face_nodes(f).shifted(first_node))
                        .collect();
                    let position = |n: u32| self.nodes[n as usize];
                    let reach = segments::reach(master.depth, size.edge) + contact.offset;
                    let facets = &master.facets;
                    points = segments::segments(&nodes, facets, position, position, degree, reach);
                }
                if of_master.automatic < suits.automatic && !rim {
                    softer = "the master's, which are softer than the slave's,";
                }
                let much = of_master.automatic < MUCH_SOFTER * suits.automatic;
                if much && self.scene.contacts.get(name) == Some(contact) {
                    self.notes.push(format!(
                        "contact `{name}`: `{}` is much softer than `{}`: as the master it bulges out between slave points, unseen; \
                         with the softer side as the slave runs end more surely",
                        contact.master, contact.slave
                    ));
                }
                if !rim {
                    suits = suits.both(&of_master);
                }
                Master::Body(Box::new(master))
            }
        };
        let height = match &master {
            Master::Body(body) => body.height,
            Master::Rigid(_) => 0.0,
        };
        let automatic = suits.automatic;
        let mut by_pressure = false;
        let (eps_n, ruled) = match (contact.penalty, &contact.augmentation) {
            (Penalty::Auto, None) if self.scene.solution.dynamics.is_some() => {
                (suits.impact(), None)
            }
            (Penalty::Auto, None) => {
                let releases = self.scene.releases(name);
                let ruled = penalty::Ruled {
                    accuracy: contact.accuracy.unwrap_or(penalty::ACCURACY),
                    stiffest: suits.stiffest,
                    deepest: suits.deepest,
                    half: suits.half_of_layer(),
                    released: releases.then_some(suits.thickness),
                };
                let deepest = suits.first_depth(releases);
                let master = match &master {
                    Master::Body(master) => Some(master.body),
                    Master::Rigid(_) => None,
                };
                let area = points.iter().map(|p| p.area).sum();
                let pressed = self.pressed([Some(body), master], area) / deepest;
                by_pressure = pressed > suits.start;
                let start = suits.start.max(pressed);
                (start.min(suits.stiffest), Some(ruled))
            }
            (Penalty::Auto, Some(_)) => (automatic, None),
            (Penalty::Value(v), _) => (v, None),
            (Penalty::Scaled(f), _) => (f * automatic, None),
        };
        let (value, auto) = (number(eps_n), number(automatic));
        let how = match contact.penalty {
            Penalty::Auto if by_pressure => {
                "a start from the pressure of the first step, ruled by its error from then on"
                    .to_owned()
            }
            Penalty::Auto if ruled.is_some() => {
                format!(
                    "a start from the stiffness of {softer} elements, ruled by its error from then on"
                )
            }
            Penalty::Auto => format!("chosen from the stiffness of {softer} elements"),
            Penalty::Value(_) => format!(
                "as given ({} of the automatic {auto})",
                number(eps_n / automatic)
            ),
            Penalty::Scaled(f) => format!("{} of the automatic {auto}", number(f)),
        };
        if contact.penalty != Penalty::Auto {
            self.limit(name, contact, "penalty", eps_n, (automatic, size.bounded()))?;
        }
        // The back pass of two has the penalty of the first.
        let told = format!("contact `{name}`: penalty {value} (pressure per penetration), {how}");
        if self.scene.contacts.get(name) == Some(contact) {
            self.notes.push(told);
        }
        let averaged = match contact.gap {
            Gap::Pointwise => None,
            Gap::Averaged => {
                let first = self.averaged;
                let nodes = SlaveNodes::new(&points, first).map_err(|node| {
                    let x = self.nodes[node as usize];
                    let message = format!(
                        "the averaged gap has no weight at the node near ({}, {}, {}): the integral of its shape function \
                         is not positive",
                        number(x.x),
                        number(x.y),
                        number(x.z)
                    );
                    let help = "take more points, at least {\"gauss\": 2}, or less distorted faces";
                    text(pointer("gap"), message).help(help)
                })?;
                self.averaged += nodes.len();
                Some(nodes)
            }
        };
        let friction = self.friction(name, contact, (body, &size), eps_n, automatic)?;
        let augmentation = (contact.augmentation.as_ref())
            .map(|asked| AugmentationModel::new(asked, size.edge, automatic));
        if let (Some(_), Some(_), Some(_)) = (&averaged, &friction, &augmentation) {
            let message = "multipliers of averaged gaps are those of nodes, and do not go with friction, which is that of points";
            return Err(text(pointer("augmentation"), message).help("leave one of them out"));
        }
        if self.scene.contacts.get(name) == Some(contact) {
            self.tell_extent(name, contact, augmentation.as_ref(), rigid.is_none());
        }
        Ok(PairModel {
            name: name.to_owned(),
            slave: contact.slave.to_string(),
            body,
            faces,
            master,
            points,
            sampled,
            half: None,
            edges_of: None,
            starts_in_front: false,
            eps_n,
            ruled,
            tangent: contact.tangent,
            element_size: size.edge,
            overclosure: None,
            bow: Vec::new(),
            below: None,
            offset: contact.offset + height,
            augmentation,
            averaged,
            friction,
            first_history: None,
        })
    }

    /// Notes where contact begins and how far its gaps are closed.
    fn tell_extent(
        &mut self,
        name: &str,
        contact: &Contact,
        augmentation: Option<&AugmentationModel>,
        moving: bool,
    ) {
        if contact.offset > 0.0 {
            self.notes.push(format!(
                "contact `{name}`: contact begins {} in front of `{}` (`offset`){}",
                number(contact.offset),
                contact.master,
                if moving {
                    ", which ends at the border of its faces"
                } else {
                    ""
                }
            ));
        }
        if let Some(augmentation) = augmentation {
            self.notes.push(format!(
                "contact `{name}`: tractions are augmented until gaps are below {}{}, with penalties up to {}",
                number(augmentation.gap),
                match contact.friction {
                    Some(_) => format!(" and elastic slip below {}", number(augmentation.slip)),
                    None => String::new(),
                },
                number(augmentation.stiffest)
            ));
        }
    }

    /// Size of the elements under some faces of a body, and the penalties that suit them.
    fn stiffness(&self, body: usize, faces: &[Face]) -> (FaceSize, Suitable) {
        let model = &self.bodies[body];
        let size = match model.block.sheet() {
            Some(sheet) => sheet_size(sheet),
            None => penalty::face_size(&model.mesh, faces),
        };
        (size, Suitable::new(&model.material, &size))
    }
}
