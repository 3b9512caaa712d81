//! All fields of the bodies at an accepted state.
use super::super::flow_fields::FlowFields;
use super::super::reaction_fields::reactions;
use super::super::resultants::Resultants;
use super::super::sheet_fields::{SheetFields, Spread};
use super::super::shell_stresses::ShellStresses;
use super::super::strain_fields::StrainFields;
use super::super::stresses::{middle_stresses, nodal_stresses};
use super::Fields;
use crate::mesh::Mesh;
use crate::model::state::State;
use crate::model::{BodyModel, Model};
use crate::output::{BodyFields, ContactFields, Field, Place};
use covact_geometry::Vec3;

/// Where the nodes of a body are; with small displacements where they started.
fn positions(model: &Model, mesh: &Mesh, displacement: &[Vec3]) -> Vec<Vec3> {
    match model.small {
        None => (mesh.nodes.iter().zip(displacement))
            .map(|(x, u)| x + u)
            .collect(),
        Some(_) => mesh.nodes.clone(),
    }
}

impl Fields {
    /// All fields of all bodies at an accepted step, for `read`.
    pub fn with_bodies<T>(
        &self,
        model: &Model,
        time: f64,
        state: &State,
        read: impl FnOnce(&[BodyFields]) -> T,
    ) -> T {
        let sheets: Vec<Option<SheetFields>> = (model.bodies.iter())
            .map(|body| SheetFields::new(body, &state.u))
            .collect();
        let displacements: Vec<Vec<Vec3>> = (model.bodies.iter().zip(&sheets))
            .map(|(b, sheet)| match sheet {
                Some(sheet) => sheet.displacement.clone(),
                None => {
                    let first = 3 * b.first_node as usize;
                    (state.u[first..first + 3 * b.mesh.nodes.len()].chunks_exact(3))
                        .map(Vec3::from_column_slice)
                        .collect()
                }
            })
            .collect();
        let mut stresses = nodal_stresses(model, state, |i| sheets[i].is_none());
        for (stress, sheet) in stresses.iter_mut().zip(&sheets) {
            if let Some(sheet) = sheet {
                stress.clone_from(&sheet.stress);
            }
        }
        let meshes: Vec<&Mesh> = (model.bodies.iter().zip(&sheets))
            .map(|(body, sheet)| sheet.as_ref().map_or(&body.mesh, |s| &s.mesh))
            .collect();
        let strains: Vec<StrainFields> = (meshes.iter().enumerate())
            .map(|(i, mesh)| StrainFields::new(mesh, &displacements[i], &stresses[i]))
            .collect();
        let resultants: Vec<Option<Resultants>> = (meshes.iter().enumerate())
            .map(|(i, mesh)| {
                let now = positions(model, mesh, &displacements[i]);
                (strains[i].of_shell()).then(|| Resultants::new(mesh, &now, &stresses[i]))
            })
            .collect();
        let through = self.through_thickness(model, state, (&meshes, &displacements), |i| {
            strains[i].of_shell().then_some(&stresses[i][..])
        });
        let flow = FlowFields::of(model, state);
        let acting = (&self.status[..], self.motion.as_ref());
        let reactions = reactions(model, state, acting, time);
        let spread: Vec<Option<Spread>> = (model.bodies.iter().zip(&sheets).enumerate())
            .map(|(i, (body, sheet))| Some(self.spread(model, i, body, sheet.as_ref()?)))
            .collect();
        let bodies: Vec<BodyFields> = (model.bodies.iter().enumerate())
            .map(|(i, body)| {
                let first = body.first_node as usize;
                let range = first..first + body.mesh.nodes.len();
                let slave = model.pairs.iter().any(|p| p.body == i);
                let worked_out = (strains[i].fields())
                    .chain(flow[i].fields())
                    .chain(resultants[i].iter().flat_map(Resultants::fields))
                    .chain((through.get(i).into_iter().flatten()).flat_map(ShellStresses::fields));
                if let Some(spread) = &spread[i] {
                    return BodyFields {
                        name: &body.name,
                        mesh: meshes[i],
                        displacement: &displacements[i],
                        stress: Some(&stresses[i]),
                        contact: slave.then(|| spread.contact()),
                        fields: spread.fields().chain(worked_out).collect(),
                        precision: self.precision,
                    };
                }
                BodyFields {
                    name: &body.name,
                    mesh: &body.mesh,
                    displacement: &displacements[i],
                    stress: Some(&stresses[i]),
                    contact: slave.then(|| ContactFields {
                        pressure: &self.pressure[range.clone()],
                        gap: &self.gap[range.clone()],
                        status: &self.status[range.clone()],
                    }),
                    fields: (self.friction.of(model, i, body).into_iter())
                        .chain(self.traction.of(model, i, body))
                        .chain(worked_out)
                        .chain(self.motion.as_ref().map(|m| m.field(&range)))
                        .chain(reactions.as_ref().map(|all| Field {
                            name: "reaction",
                            components: 3,
                            component_names: &[],
                            data: &all[3 * range.start..3 * range.end],
                            place: Place::Point,
                        }))
                        .collect(),
                    precision: self.precision,
                }
            })
            .collect();
        read(&bodies)
    }

    /// Stresses at the bottom, in the middle and at the top of the bodies that `of` has nodal stresses of; empty where they are not
    /// asked for.
    fn through_thickness<'a>(
        &self,
        model: &Model,
        state: &State,
        (meshes, displacements): (&[&Mesh], &[Vec<Vec3>]),
        of: impl Fn(usize) -> Option<&'a [[f64; 6]]>,
    ) -> Vec<Option<ShellStresses>> {
        if !self.shell_stresses {
            return Vec::new();
        }
        let middle = middle_stresses(model, state);
        (meshes.iter().enumerate())
            .map(|(i, mesh)| {
                let now = positions(model, mesh, &displacements[i]);
                let middle = middle[i].as_deref();
                of(i).map(|stress| ShellStresses::new(mesh, &now, stress, middle))
            })
            .collect()
    }

    /// Contact fields of a sheet on the mesh of its output.
    fn spread(&self, model: &Model, index: usize, body: &BodyModel, sheet: &SheetFields) -> Spread {
        let first = body.first_node as usize;
        let range = first..first + body.mesh.nodes.len();
        let fields = self.friction.of(model, index, body).into_iter();
        Spread {
            pressure: sheet.spread(&self.pressure[range.clone()], 1),
            gap: sheet.spread(&self.gap[range.clone()], 1),
            status: sheet.status(&self.status[range]),
            fields: (fields.chain(self.traction.of(model, index, body)))
                .map(|f| {
                    (
                        f.name.to_owned(),
                        f.components,
                        sheet.spread(f.data, f.components),
                    )
                })
                .collect(),
        }
    }
}
