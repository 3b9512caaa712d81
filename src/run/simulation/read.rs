//! Results of a simulation, read in memory.
use super::Simulation;
use crate::model::state::State;
use crate::output::{BodyFields, ContactFields, STRESS_COMPONENTS, Table, von_mises};
use crate::scene::nearest;
use covact_geometry::Vec3;

const AXES: [&str; 3] = ["x", "y", "z"];

/// Why a result cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ReadError {
    /// Nothing has this name.
    #[error("there is no {what} `{name}`{}", nearest.as_ref().map_or(String::new(), |n| format!(": did you mean `{n}`?")))]
    Unknown {
        /// What was looked for, e.g. "body".
        what: &'static str,
        /// The name that was asked for.
        name: String,
        /// The most similar name.
        nearest: Option<String>,
    },
    /// Forces and histories are those of accepted steps, and there is none yet.
    #[error("no step has been accepted yet")]
    NoStep,
}

fn unknown<'n>(
    what: &'static str,
    name: &str,
    names: impl Iterator<Item = &'n str> + Clone,
) -> ReadError {
    ReadError::Unknown {
        what,
        name: name.to_owned(),
        nearest: nearest(name, names).map(str::to_owned),
    }
}

/// A force and its moment about the origin.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Force {
    /// The force.
    pub force: Vec3,
    /// Its moment about the origin.
    pub moment: Vec3,
}

/// A field at the nodes of a body, in the order of its mesh, or of its elements.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct NodalField {
    /// Name, as in the `.vtu` files: `displacement`, `cauchy_stress`, `contact_pressure`, ...
    pub name: String,
    /// Numbers per node.
    pub components: usize,
    /// Names of the components; empty where they have none.
    pub component_names: Vec<String>,
    /// The numbers, node after node.
    pub data: Vec<f64>,
}

impl NodalField {
    /// Component `component` of node `node`.
    pub fn at(&self, node: usize, component: usize) -> f64 {
        self.data[node * self.components + component]
    }
}

impl Simulation<'_> {
    /// Time at the end of the last accepted step; 0 before the first.
    pub fn time(&self) -> f64 {
        self.run_state().progress.time
    }

    /// Number of accepted steps.
    pub fn steps(&self) -> u32 {
        self.run_state().progress.steps
    }

    /// What the user should know, so far.
    pub fn warnings(&self) -> &[String] {
        &self.run_state().progress.warnings
    }

    /// The last accepted state: displacements of all nodes, states of elements and slave points.
    pub fn state(&self) -> &State {
        &self.run_state().course.committed
    }

    /// The history: a row for every accepted step, with the columns of `history.csv`.
    pub fn history(&self) -> &Table {
        &self.history
    }

    /// The value of a column of the history at the last accepted step, e.g. `pressure.max` or `probe.centre.z`.
    ///
    /// # Errors
    /// [`ReadError`]
    pub fn value(&self, column: &str) -> Result<f64, ReadError> {
        let names = self.history.columns.iter();
        let index = names.clone().position(|name| name == column);
        let index = index.ok_or_else(|| unknown("column", column, names.map(String::as_str)))?;
        let row = self.history.rows.last().ok_or(ReadError::NoStep)?;
        Ok(row[index])
    }

    /// What a rigid surface or a support exerts on the bodies at the last accepted step.
    ///
    /// # Errors
    /// [`ReadError`]
    pub fn force(&self, name: &str) -> Result<Force, ReadError> {
        let model = self.model();
        let surfaces = model.surfaces.iter().map(|s| s.name.as_str());
        let names = surfaces.chain(model.supports.iter().map(String::as_str));
        if !names.clone().any(|n| n == name) {
            return Err(unknown("surface or support", name, names));
        }
        self.acting("", name)
    }

    /// What a contact between two bodies exerts on its slave and on its master at the last accepted step.
    ///
    /// # Errors
    /// [`ReadError`]; contact with a rigid surface has its [`force`](Self::force).
    pub fn contact_force(&self, contact: &str) -> Result<[Force; 2], ReadError> {
        let pairs = self.model().pairs.iter();
        let between = pairs.filter(|p| self.model().between_bodies(p));
        let names = between.map(|p| p.name.as_str());
        if !names.clone().any(|n| n == contact) {
            return Err(unknown("contact between bodies", contact, names));
        }
        Ok([
            self.acting("slave.", contact)?,
            self.acting("master.", contact)?,
        ])
    }

    fn acting(&self, side: &str, name: &str) -> Result<Force, ReadError> {
        let vector = |quantity: &str| -> Result<Vec3, ReadError> {
            let of = |axis: &str| self.value(&format!("{side}{quantity}.{name}.{axis}"));
            let [x, y, z] = AXES.map(of);
            Ok(Vec3::new(x?, y?, z?))
        };
        Ok(Force {
            force: vector("force")?,
            moment: vector("moment")?,
        })
    }

    /// Linear momentum of all bodies and angular momentum about the origin at the last accepted step; nothing without inertia.
    pub fn momentum(&self) -> Option<[Vec3; 2]> {
        let inertia = self.run_state().assembler.effects.inertia.as_ref()?;
        Some(inertia.momentum(self.model(), &self.state().u))
    }

    /// Number of a body.
    fn body(&self, name: &str) -> Result<usize, ReadError> {
        let names = self.model().bodies.iter().map(|b| b.name.as_str());
        let found = names.clone().position(|n| n == name);
        found.ok_or_else(|| unknown("body", name, names))
    }

    /// Displacements of a body's nodes at the last accepted step.
    ///
    /// # Errors
    /// [`ReadError::Unknown`]
    pub fn displacements(&self, body: &str) -> Result<Vec<Vec3>, ReadError> {
        let body = &self.model().bodies[self.body(body)?];
        let first = 3 * body.first_node as usize;
        let u = &self.state().u[first..first + 3 * body.mesh.nodes.len()];
        Ok(u.chunks_exact(3).map(Vec3::from_column_slice).collect())
    }

    /// All fields of a body at the last accepted step: those of its `.vtu` file, in double precision.
    ///
    /// # Errors
    /// [`ReadError::Unknown`]
    pub fn fields(&self, body: &str) -> Result<Vec<NodalField>, ReadError> {
        let index = self.body(body)?;
        let run = self.run_state();
        let fields = &run.course.outputs.fields;
        let (model, time, state) = (self.model(), self.time(), self.state());
        let read = |bodies: &[BodyFields]| listed(&bodies[index]);
        Ok((self.pool).install(|| fields.with_bodies(model, time, state, read)))
    }

    /// One of the [`fields`](Self::fields) of a body.
    ///
    /// # Errors
    /// [`ReadError::Unknown`]
    pub fn field(&self, body: &str, name: &str) -> Result<NodalField, ReadError> {
        let mut fields = self.fields(body)?;
        match fields.iter().position(|f| f.name == name) {
            Some(index) => Ok(fields.swap_remove(index)),
            None => Err(unknown(
                "field",
                name,
                fields.iter().map(|f| f.name.as_str()),
            )),
        }
    }
}

/// The fields of a body as they are written, with names of their own.
fn listed(body: &BodyFields) -> Vec<NodalField> {
    let field = |name: &str, components: usize, data: Vec<f64>| NodalField {
        name: name.to_owned(),
        components,
        component_names: Vec::new(),
        data,
    };
    let u = body.displacement.iter();
    let mut out = vec![field("displacement", 3, u.flatten().copied().collect())];
    if let Some(stress) = body.stress {
        out.push(NodalField {
            component_names: STRESS_COMPONENTS.map(String::from).to_vec(),
            ..field("cauchy_stress", 6, stress.as_flattened().to_vec())
        });
        out.push(field(
            "von_mises",
            1,
            stress.iter().map(von_mises).collect(),
        ));
    }
    if let Some(ContactFields {
        pressure,
        gap,
        status,
    }) = body.contact
    {
        out.push(field("contact_pressure", 1, pressure.to_vec()));
        out.push(field("contact_gap", 1, gap.to_vec()));
        let status = status.iter().map(|s| f64::from(*s)).collect();
        out.push(field("contact_status", 1, status));
    }
    out.extend(body.fields.iter().map(|f| NodalField {
        component_names: f.component_names.iter().map(|n| (*n).to_owned()).collect(),
        ..field(f.name, f.components, f.data.to_vec())
    }));
    out
}
