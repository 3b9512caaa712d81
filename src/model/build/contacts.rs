//! Contact pairs: slave points, masters, penalties.
use super::super::error::{At, number};
use super::super::master::{BodyMaster, Master};
use super::super::slave::slave_points;
use super::super::{ModelError, PairModel, SurfaceModel, penalty};
use super::Builder;
use crate::mesh::Face;
use crate::scene::{Contact, MasterSurface, Penalty};
use covact_geometry::MovingFacets;
use penalty::FaceSize;
use std::collections::BTreeMap;

impl Builder<'_> {
    /// All contact pairs and all rigid surfaces.
    pub(super) fn contacts(&mut self) -> Result<(Vec<PairModel>, Vec<SurfaceModel>), ModelError> {
        let mut surfaces = Vec::new();
        let mut labels = Vec::new();
        let mut surface_index = BTreeMap::new();
        for (name, surface) in &self.scene.surfaces {
            surface_index.insert(name.as_str(), surfaces.len());
            let (model, named) = self.surface(name, surface)?;
            surfaces.push(model);
            labels.push(named);
        }
        let mut pairs = Vec::new();
        for (name, contact) in &self.scene.contacts {
            let rigid = surface_index.get(contact.master.as_str()).copied();
            pairs.push(self.pair(name, contact, rigid)?);
        }
        for (index, (name, surface)) in self.scene.surfaces.iter().enumerate() {
            let own: Vec<&PairModel> = (pairs.iter())
                .filter(|p| p.rigid_master() == Some(index))
                .collect();
            let model = (&mut surfaces[index], labels[index].as_slice());
            self.orient(name, surface, model, &own)?;
        }
        Ok((pairs, surfaces))
    }

    fn pair(
        &mut self,
        name: &str,
        contact: &Contact,
        rigid: Option<usize>,
    ) -> Result<PairModel, ModelError> {
        let pointer = |field: &str| format!("/contacts/{name}/{field}");
        let (body, faces) = self.faces(&contact.slave, &pointer("slave"))?;
        let model = &self.bodies[body];
        let points = slave_points(&model.mesh, &faces, contact.points, model.first_node)
            .at(|| pointer("points"))?;
        let (size, mut automatic) = self.stiffness(body, &faces);
        let mut softer = "the slave's";
        let master = match rigid {
            Some(surface) => Master::Rigid(surface),
            None => {
                let (master, stiffness) = self.body_master(name, contact)?;
                if stiffness < automatic {
                    automatic = stiffness;
                    softer = "the master's, which are softer than the slave's,";
                }
                Master::Body(Box::new(master))
            }
        };
        let (eps_n, is_automatic) = match contact.penalty {
            Penalty::Auto => (automatic, true),
            Penalty::Value(v) => (v, false),
            Penalty::Scaled(f) => (f * automatic, false),
        };
        let (value, auto) = (number(eps_n), number(automatic));
        let how = match contact.penalty {
            Penalty::Auto => format!("chosen from the stiffness of {softer} elements"),
            Penalty::Value(_) => format!(
                "as given ({} of the automatic {auto})",
                number(eps_n / automatic)
            ),
            Penalty::Scaled(f) => format!("{} of the automatic {auto}", number(f)),
        };
        self.notes.push(format!(
            "contact `{name}`: penalty {value} (pressure per penetration), {how}"
        ));
        Ok(PairModel {
            name: name.to_owned(),
            body,
            master,
            points,
            eps_n,
            automatic: is_automatic,
            tangent: contact.tangent,
            element_size: size.edge,
            overclosure: None,
        })
    }

    /// Size of the elements under some faces of a body, and the penalty that suits them.
    fn stiffness(&self, body: usize, faces: &[Face]) -> (FaceSize, f64) {
        let model = &self.bodies[body];
        let size = penalty::face_size(&model.mesh, faces);
        let material = &self.scene.bodies[&model.name].material;
        let automatic = penalty::automatic(&self.scene.materials[material], &size);
        (size, automatic)
    }

    /// Faces of a body as a master, and the penalty that suits them.
    fn body_master(
        &mut self,
        name: &str,
        contact: &Contact,
    ) -> Result<(BodyMaster, f64), ModelError> {
        let pointer = || format!("/contacts/{name}/master");
        let (body, faces) = self.faces(&contact.master, &pointer())?;
        let (size, automatic) = self.stiffness(body, &faces);
        let model = &self.bodies[body];
        let nodes: Vec<_> = (faces.iter())
            .map(|&f| model.mesh.face_nodes(f).shifted(model.first_node))
            .collect();
        let facets: Vec<_> = nodes.iter().map(|f| (f.nodes(), f.count)).collect();
        let smooth = contact.master_surface == Some(MasterSurface::Smooth);
        let position = |node: u32| self.nodes[node as usize];
        let mut facets = match smooth {
            false => MovingFacets::new(&facets),
            true => MovingFacets::smooth(&facets, position),
        }
        .at(pointer)?;
        facets.update(position);
        let depth = contact.depth.unwrap_or(size.depth);
        self.notes.push(format!(
            "contact `{name}`: a point deeper than {} below `{}` is not in contact (`depth`)",
            number(depth),
            contact.master
        ));
        let master = BodyMaster {
            name: contact.master.clone(),
            body,
            facets,
            smooth,
            depth,
            element_size: size.edge,
        };
        Ok((master, automatic))
    }
}
