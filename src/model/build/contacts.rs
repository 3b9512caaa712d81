//! Contact pairs: slave points, masters, penalties.
use super::super::augmentation::AugmentationModel;
use super::super::averaged::SlaveNodes;
use super::super::edges;
use super::super::error::{At, number, text};
use super::super::friction::{self, FrictionModel, LawModel};
use super::super::master::{BodyMaster, Master, moving_facets};
use super::super::self_contact::OwnFacets;
use super::super::slave::slave_points;
use super::super::{HalfPass, ModelError, PairModel, SurfaceModel, penalty, segments, slave};
use super::nurbs_bodies::sheet_size;
use super::{Builder, master_faces};
use crate::contact::points::SlavePoint;
use crate::machine::memory;
use crate::mesh::Face;
use crate::scene::{Contact, Gap, MasterSurface, Passes, Penalty, Points};
use covact_geometry::{MovingError, MovingFacets};
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
            let rigid = surface_index.get(contact.master.as_str()).copied();
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
    ) -> Result<(usize, Vec<Face>, Vec<SlavePoint>), ModelError> {
        let pointer = |field: &str| format!("/contacts/{name}/{field}");
        let (body, faces) = self.contact_faces(name, &contact.slave, &pointer("slave"))?;
        self.sheet_contact(name, contact, rigid)?;
        let model = &self.bodies[body];
        let first_node = model.first_node;
        let per_face = match contact.points {
            Points::Nodes => 1,
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
            true => self.sheet_points(body, &faces, contact.points),
            false => slave_points(&model.mesh, &faces, contact.points, first_node),
        }
        .at(|| pointer("points"))?;
        Ok((body, faces, points))
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
        let (body, faces, mut points) = match side {
            Side::Rim { body, points } => (body, Vec::new(), points),
            Side::Faces => self.slave_side(name, contact, rigid)?,
            Side::Nodes(only) => {
                let (body, faces, mut points) = self.slave_side(name, contact, rigid)?;
                let first_node = self.bodies[body].first_node;
                points.retain(|p| only.contains(&(p.nodes[0] - first_node)));
                (body, faces, points)
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
                if let Points::Segments(degree) = contact.points {
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
        let (eps_n, ruled) = match (contact.penalty, &contact.augmentation) {
            (Penalty::Auto, None) if self.scene.solution.dynamics.is_some() => {
                (suits.impact(), None)
            }
            (Penalty::Auto, None) => {
                let (accuracy, rigid) = match contact.accuracy {
                    Some(given) => (given, f64::INFINITY),
                    None if self.scene.releases(name) => (penalty::RELEASED_ACCURACY, suits.rigid),
                    None => (penalty::ACCURACY, f64::INFINITY),
                };
                let ruled = penalty::Ruled {
                    accuracy,
                    rigid,
                    stiffest: suits.stiffest,
                    deepest: suits.deepest,
                };
                (suits.start, Some(ruled))
            }
            (Penalty::Auto, Some(_)) => (automatic, None),
            (Penalty::Value(v), _) => (v, None),
            (Penalty::Scaled(f), _) => (f * automatic, None),
        };
        let (value, auto) = (number(eps_n), number(automatic));
        let how = match contact.penalty {
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
        let first_history = (friction.is_some() || augmentation.is_some()).then(|| {
            let first = self.histories;
            self.histories += points.len();
            first
        });
        if self.scene.contacts.get(name) == Some(contact) {
            self.tell_extent(name, contact, augmentation.as_ref(), rigid.is_none());
        }
        Ok(PairModel {
            name: name.to_owned(),
            slave: contact.slave.clone(),
            body,
            faces,
            master,
            points,
            segments: match contact.points {
                Points::Segments(degree) => Some(degree),
                _ => None,
            },
            half: None,
            edges_of: None,
            eps_n,
            ruled,
            tangent: contact.tangent,
            element_size: size.edge,
            overclosure: None,
            bow: Vec::new(),
            offset: contact.offset + height,
            augmentation,
            averaged,
            friction,
            first_history,
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

    /// Friction of a contact with the normal penalty `eps_n`; none where the scene asks for none, or the coefficient is zero
    /// throughout.
    fn friction(
        &mut self,
        name: &str,
        contact: &Contact,
        (body, size): (usize, &FaceSize),
        eps_n: f64,
        suitable: f64,
    ) -> Result<Option<FrictionModel>, ModelError> {
        let Some(friction) = &contact.friction else {
            return Ok(None);
        };
        let law = LawModel::new(friction).at(|| format!("/contacts/{name}/friction"))?;
        if law.is_none() {
            self.notes.push(format!(
                "contact `{name}`: the coefficient of friction is zero, so that there is no friction"
            ));
            return Ok(None);
        }
        let automatic = friction::automatic_ratio(&self.bodies[body].material);
        let ratio = match contact.tangential_penalty {
            Penalty::Auto => automatic,
            Penalty::Value(v) => v / eps_n,
            Penalty::Scaled(f) => f * automatic,
        };
        if contact.tangential_penalty != Penalty::Auto {
            // Of a ruled normal penalty nothing is known yet but where it starts.
            let normal = match contact.penalty {
                Penalty::Auto => suitable,
                _ => eps_n,
            };
            let given = match contact.tangential_penalty {
                Penalty::Value(v) => v,
                _ => ratio * normal,
            };
            let suitable = automatic * suitable;
            let bounded = size.bounded();
            self.limit(
                name,
                contact,
                "tangential_penalty",
                given,
                (suitable, bounded),
            )?;
        }
        // The back pass of two has the friction of the first.
        if self.scene.contacts.get(name) == Some(contact) {
            self.notes.push(format!(
                "contact `{name}`: tangential penalty {} (traction per elastic slip), {} of the normal one",
                number(ratio * eps_n),
                number(ratio)
            ));
        }
        let ruled = contact.tangential_penalty == Penalty::Auto && contact.augmentation.is_none();
        let given = match contact.tangential_penalty {
            Penalty::Value(v) => Some(v),
            Penalty::Auto | Penalty::Scaled(_) => None,
        };
        Ok(Some(FrictionModel {
            law,
            ratio,
            ruled,
            given,
        }))
    }

    /// Warns of a given penalty that costs too many digits, and refuses one that leaves none. Compared with are the automatic
    /// one and how many times smaller that is for the body being slender.
    fn limit(
        &mut self,
        name: &str,
        contact: &Contact,
        field: &str,
        given: f64,
        (automatic, bounded): (f64, f64),
    ) -> Result<(), ModelError> {
        let what = field.replace('_', " ");
        match penalty::judge(given, automatic * bounded) {
            penalty::Given::Fine => {}
            // The back pass of two has the penalty of the first.
            penalty::Given::Stiff(multiple) => {
                if self.scene.contacts.get(name) == Some(contact) {
                    self.warnings.push(format!(
                        "contact `{name}`: the {what} {} is {multiple:.1e} times the stiffness of the elements: it costs \
                         digits and iterations; with `augmentation` a {what} near the automatic {} gives the same gaps",
                        number(given),
                        number(automatic)
                    ));
                }
            }
            penalty::Given::TooStiff(multiple) => {
                return Err(text(
                    format!("/contacts/{name}/{field}"),
                    format!(
                        "the {what} {} is {multiple:.1e} times the stiffness of the elements: rounding would be all that is \
                         left of the pressures (at most {:.0e} times are possible)",
                        number(given),
                        penalty::REFUSED
                    ),
                )
                .help(format!(
                    "leave it out (the automatic one is {}), and take `augmentation` where gaps are to be smaller",
                    number(automatic)
                )));
            }
        }
        Ok(())
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

    /// [`moving_facets`] of a body of the model, where they start.
    pub(super) fn moving_facets(
        &self,
        body: usize,
        faces: &[Face],
        smooth: bool,
    ) -> Result<MovingFacets, MovingError> {
        let body = &self.bodies[body];
        moving_facets(&body.mesh, body.first_node, faces, smooth, |n| {
            self.nodes[n as usize]
        })
    }

    /// Faces of a body as a master, and the penalties that suit them.
    fn body_master(
        &mut self,
        name: &str,
        contact: &Contact,
    ) -> Result<(BodyMaster, Suitable), ModelError> {
        let pointer = || format!("/contacts/{name}/master");
        let (body, faces) = self.contact_faces(name, &contact.master, &pointer())?;
        let (size, suits) = self.stiffness(body, &faces);
        let smooth = contact.master_surface == Some(MasterSurface::Smooth);
        let (facets, height) = match self.sheet_facets(body, &faces) {
            Some(facets) => facets.at(pointer)?,
            None => {
                master_faces::check(&self.bodies[body].mesh, &faces, &contact.master)
                    .map_err(|(message, help)| text(pointer(), message).help(help))?;
                (self.moving_facets(body, &faces, smooth).at(pointer)?, 0.0)
            }
        };
        let depth = contact.depth.unwrap_or(size.depth);
        self.notes.push(format!(
            "contact `{name}`: a point deeper than {} below `{}` is not in contact (`depth`)",
            number(depth),
            contact.master
        ));
        let master = BodyMaster {
            name: contact.master.clone(),
            body,
            faces,
            facets,
            smooth,
            depth,
            element_size: size.edge,
            own: None,
            height,
        };
        Ok((master, suits))
    }

    /// Slave and master on one body: what is connected is no contact.
    fn own_body(
        &mut self,
        name: &str,
        contact: &Contact,
        slave: &[Face],
        points: &mut [SlavePoint],
        master: &mut BodyMaster,
    ) -> Result<(), ModelError> {
        let body = &self.bodies[master.body];
        let faces = &master.faces;
        let common = slave.iter().filter(|f| faces.contains(f)).count();
        let equal = common == slave.len() && common == faces.len();
        if common > 0 && !equal {
            let message = format!(
                "`{}` and `{}` have {common} face(s) in common, {} and {} in all: these would be in contact with \
                 themselves",
                contact.slave,
                contact.master,
                slave.len(),
                faces.len()
            );
            return Err(text(format!("/contacts/{name}/master"), message).help(
                "for self contact give the same set as slave and as master, else two sets without a common face",
            ));
        }
        if equal && contact.passes == Passes::TwoHalf {
            return Err(text(
                format!("/contacts/{name}/passes"),
                format!(
                    "`{}` is slave and master at once: both sides of self contact are slaves already, with half of their \
                     areas",
                    contact.slave
                ),
            )
            .help("leave `passes` out, or give two sets without a common face"));
        }
        // As far as a point may sink in, through the wall and one more face.
        let distance = 2.0 * master.depth + master.element_size + contact.offset;
        master.own = Some(OwnFacets::new(
            &body.mesh,
            body.first_node,
            points,
            slave,
            faces,
            &master.facets,
            distance,
        ));
        self.notes.push(format!(
            "contact `{name}`: self contact of body `{}`; what is nearer than {} along its undeformed mesh is left out, \
             and faces whose normals do not oppose each other",
            body.name,
            number(distance)
        ));
        if equal {
            // Where two faces meet, the points of both push, half each.
            points.iter_mut().for_each(|p| p.area *= 0.5);
            self.notes.push(format!(
                "contact `{name}`: its faces are slave and master at once, so that of two that meet each carries half of \
                 the pressure with half of its area"
            ));
        }
        Ok(())
    }
}
