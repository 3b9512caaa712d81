//! Where contact is sampled on slave faces if the scene leaves it open.
use super::super::Builder;
use crate::mesh::{ElementKind, Face};
use crate::model::{ModelError, edges};
use crate::scene::{Contact, Passes, Points};
use covact_geometry::MovingFacets;
use std::collections::BTreeSet;

/// Distance of the slave's nodes, in terms of the master's, up to which the nodes see enough of the master: between them no node of the
/// master bulges up.
const FINE: f64 = 1.0;
/// Gauss points that come on an edge of the master, and the most that a face has along each direction.
const PER_EDGE: f64 = 2.0;
const MOST: u8 = 10;
/// The same up to which nodes of both sides may meet throughout, as on curved faces.
const ALIKE: f64 = 1.25;
/// Distance of a slave node from one of the master's within which they meet, as a part of the distance of the slave's nodes.
const MEETS: f64 = 1e-6;
/// Part of the slave's nodes over the master that have to meet one for the meshes to match.
const MATCHES: f64 = 0.9;
/// Gauss points along each direction of a face that see how much of it is past a border.
const PAST_BORDERS: u8 = 3;

impl Builder<'_> {
    /// Where a contact is sampled. The nodes are enough for rigid masters, whose shape is known between them, and where the slave is
    /// as fine as its master or their nodes meet. Otherwise nodes of the master lie between those of the slave, which would bear
    /// all of the traction: they press into the master, and what they miss of it sinks into the slave. Nor are they enough where
    /// the slave ends with its master ([`Self::ends_with`]). With multipliers, more points than nodes would
    /// ask more of the faces than these can give.
    ///
    /// # Errors
    /// A master that there is not.
    pub(super) fn sampling(
        &mut self,
        name: &str,
        contact: &Contact,
        (body, faces): (usize, &[Face]),
        rigid: bool,
    ) -> Result<Points, ModelError> {
        if contact.points != Points::Auto {
            return Ok(contact.points);
        }
        let sheet = |b: usize| self.bodies[b].block.sheet().is_some();
        let one = matches!(contact.passes, Passes::Auto | Passes::One | Passes::Edges);
        if rigid || !one || contact.augmentation.is_some() || sheet(body) {
            return Ok(Points::Nodes);
        }
        let at = format!("/contacts/{name}/master");
        let (master, of_master) = self.contact_faces(name, &contact.master, &at)?;
        if master == body {
            return Ok(Points::Nodes);
        }
        let [slave, other] =
            [(body, faces), (master, &of_master[..])].map(|(b, f)| self.stiffness(b, f).0.edge);
        let fine = slave <= FINE * other * (1.0 + MEETS);
        // Every other node of a master that is twice as fine may meet one, too.
        let alike = slave <= ALIKE * other;
        // What is wrong with the faces is told where the master is made of them.
        let Ok(facets) = self.moving_facets(master, &of_master, false) else {
            return Ok(Points::Nodes);
        };
        let meet = || alike && self.nodes_meet((body, faces), &facets, slave);
        if self.ends_with((body, faces), &facets, slave) {
            let meet = meet();
            if meet && self.same_material(body, master) {
                return Ok(Points::Nodes);
            }
            if fine || meet {
                self.notes.push(format!(
                    "contact `{name}`: `{}` ends where `{}` does: {PAST_BORDERS} x {PAST_BORDERS} Gauss points a face are slave points, since \
                     a node that slides past that border loses all of the area that it stands for (`\"points\": \"nodes\"` takes the \
                     nodes)",
                    contact.slave, contact.master
                ));
                return Ok(Points::Gauss(PAST_BORDERS));
            }
        } else if fine || meet() {
            return Ok(Points::Nodes);
        }
        let quadratic = self.bodies[body].mesh.kind == ElementKind::Q18;
        let per_face = PER_EDGE * slave / other * if quadratic { 2.0 } else { 1.0 };
        let least = if quadratic { 3 } else { 2 };
        Ok(Points::Gauss((per_face.ceil() as u8).clamp(least, MOST)))
    }

    /// Whether two bodies are of one material: what is, on nodes that meet, widens alike and stays where it is.
    fn same_material(&self, a: usize, b: usize) -> bool {
        let [a, b] = [a, b].map(|body| {
            let body = self.scene.bodies.get(&self.bodies[body].name);
            body.map(|body| &body.material)
        });
        a == b
    }

    /// Whether the slave's nodes that lie over the master meet nodes of it.
    fn nodes_meet(
        &self,
        (body, faces): (usize, &[Face]),
        master: &MovingFacets,
        size: f64,
    ) -> bool {
        let slave = &self.bodies[body];
        let nodes: BTreeSet<u32> = (faces.iter())
            .flat_map(|f| slave.mesh.face_nodes(*f).nodes().to_vec())
            .collect();
        let [mut over, mut meet] = [0.0, 0.0];
        for node in nodes {
            let x = self.nodes[(node + slave.first_node) as usize];
            let Some(foot) = master.project(&x, None, f64::INFINITY, |_| true) else {
                continue;
            };
            // Beyond a border it lies over nothing.
            let away = x - foot.jet.rho;
            if edges::at_border(&foot) && away.cross(&foot.normal).norm() > MEETS * size {
                continue;
            }
            let corners = master.nodes(foot.facet);
            let near = |n: &u32| (self.nodes[*n as usize] - foot.jet.rho).norm() < MEETS * size;
            over += 1.0;
            meet += f64::from(u8::from(corners.iter().any(near)));
        }
        over > 0.0 && meet >= MATCHES * over
    }
}
