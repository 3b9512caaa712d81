//! The parts of a scene as a program makes them: what has no default is an argument, the rest are fields to change.
use super::*;
use crate::scene::value::Value;
use covact_geometry::NurbsPatch;

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Value::Number(number)
    }
}

/// An expression.
impl From<&str> for Value {
    fn from(expression: &str) -> Self {
        Value::Expression(expression.to_owned())
    }
}

/// Rows of a time and a value.
impl From<Vec<[f64; 2]>> for Value {
    fn from(table: Vec<[f64; 2]>) -> Self {
        Value::Table { table }
    }
}

impl Body {
    /// A body of default elements.
    pub fn new(mesh: impl Into<MeshSource>, material: impl Into<String>) -> Self {
        let mesh = mesh.into();
        Body {
            element: Element::by_default(&mesh),
            mesh,
            material: material.into(),
            placement: Placement::default(),
            sets: Default::default(),
            velocity: None,
            spin: None,
        }
    }

    /// With other elements.
    #[must_use]
    pub fn element(self, element: Element) -> Self {
        Body { element, ..self }
    }
}

macro_rules! mesh_from {
    ($($type:ident => $variant:ident),* $(,)?) => {
        $(impl From<$type> for MeshSource {
            fn from(mesh: $type) -> Self {
                MeshSource::$variant(mesh)
            }
        })*
    };
}

mesh_from!(
    Plate => Plate,
    CylinderPanel => CylinderPanel,
    SpherePanel => SpherePanel,
    Block => Block,
    MeshFile => File,
);

impl From<MeshArrays> for MeshSource {
    fn from(mesh: MeshArrays) -> Self {
        MeshSource::Arrays(mesh.into())
    }
}

impl From<MeshCells> for MeshSource {
    fn from(mesh: MeshCells) -> Self {
        MeshSource::Cells(mesh.into())
    }
}

impl From<SphereShape> for Surface {
    fn from(sphere: SphereShape) -> Self {
        Surface {
            sphere: Some(sphere),
            ..Surface::default()
        }
    }
}

impl From<CylinderShape> for Surface {
    fn from(cylinder: CylinderShape) -> Self {
        Surface {
            cylinder: Some(cylinder),
            ..Surface::default()
        }
    }
}

impl From<PlaneShape> for Surface {
    fn from(plane: PlaneShape) -> Self {
        Surface {
            plane: Some(plane),
            ..Surface::default()
        }
    }
}

impl From<CadFile> for Surface {
    fn from(cad: CadFile) -> Self {
        Surface {
            cad: Some(cad),
            ..Surface::default()
        }
    }
}

impl From<Vec<NurbsPatch>> for Surface {
    fn from(patches: Vec<NurbsPatch>) -> Self {
        Surface {
            patches: Some(patches.into()),
            ..Surface::default()
        }
    }
}

impl From<NurbsPatch> for Surface {
    fn from(patch: NurbsPatch) -> Self {
        vec![patch].into()
    }
}

impl Surface {
    /// With a prescribed translation over time.
    #[must_use]
    pub fn moved(mut self, translation: [impl Into<Value>; 3]) -> Self {
        self.motion.translation = translation.map(Into::into);
        self
    }
}

impl Contact {
    /// Frictionless contact of a face set `body.set` with a surface or another face set, under a penalty that the run
    /// chooses.
    pub fn new(slave: impl Into<SetNames>, master: impl Into<SetNames>) -> Self {
        Contact {
            slave: slave.into(),
            master: master.into(),
            master_surface: None,
            depth: None,
            points: Points::default(),
            gap: Gap::default(),
            passes: Passes::default(),
            penalty: Penalty::default(),
            accuracy: None,
            tangent: Tangent::default(),
            initial_overclosure: InitialOverclosure::default(),
            friction: None,
            tangential_penalty: Penalty::default(),
            augmentation: None,
            offset: 0.0,
        }
    }

    /// With Coulomb friction.
    #[must_use]
    pub fn friction(self, mu: impl Into<Value>) -> Self {
        Contact {
            friction: Some(Friction::Coulomb { mu: mu.into() }),
            ..self
        }
    }
}

impl Support {
    /// Holds nothing yet.
    pub(in crate::scene) fn on(on: impl Into<SetNames>) -> Self {
        Support {
            on: on.into(),
            fixed: false,
            clamped: false,
            symmetry: None,
            plane_strain: None,
            displacement: None,
            mid_surface: false,
        }
    }

    /// Holds all displacements of a set `body.set`, or of several.
    pub fn fixed(on: impl Into<SetNames>) -> Self {
        Support {
            fixed: true,
            ..Self::on(on)
        }
    }

    /// A plane of symmetry with this normal.
    pub fn symmetry(on: impl Into<SetNames>, axis: Axis) -> Self {
        Support {
            symmetry: Some(axis),
            ..Self::on(on)
        }
    }

    /// Prescribes displacements; components without a value are free.
    pub fn displacement(on: impl Into<SetNames>, components: [Option<Value>; 3]) -> Self {
        let [x, y, z] = components;
        Support {
            displacement: Some(Components { x, y, z }),
            ..Self::on(on)
        }
    }
}

impl Load {
    /// Nothing yet.
    pub(in crate::scene) fn on(on: impl Into<SetNames>) -> Self {
        Load {
            on: on.into(),
            force: None,
            traction: None,
            pressure: None,
            couple: None,
            gravity: None,
            follower: false,
        }
    }

    /// A force on a set, in all.
    pub fn force(on: impl Into<SetNames>, force: [impl Into<Value>; 3]) -> Self {
        Load {
            force: Some(force.map(Into::into)),
            ..Self::on(on)
        }
    }

    /// A traction (force / undeformed area) on faces.
    pub fn traction(on: impl Into<SetNames>, traction: [impl Into<Value>; 3]) -> Self {
        Load {
            traction: Some(traction.map(Into::into)),
            ..Self::on(on)
        }
    }

    /// A pressure on faces, positive towards the body.
    pub fn pressure(on: impl Into<SetNames>, pressure: impl Into<Value>) -> Self {
        Load {
            pressure: Some(pressure.into()),
            ..Self::on(on)
        }
    }

    /// An acceleration of whole bodies, whose materials have a density.
    pub fn gravity(on: impl Into<SetNames>, gravity: [impl Into<Value>; 3]) -> Self {
        Load {
            gravity: Some(gravity.map(Into::into)),
            ..Self::on(on)
        }
    }
}

impl Probe {
    /// What nodes of a set do: a column `probe.NAME` of the history, or three.
    pub fn new(on: impl Into<SetNames>, quantity: ProbeQuantity) -> Self {
        Probe {
            on: Some(on.into()),
            quantity,
            ..Probe::default()
        }
    }
}

impl Elastic {
    /// Young's modulus and Poisson's ratio.
    pub fn new(e: f64, nu: f64) -> Self {
        Elastic {
            e,
            nu,
            density: None,
        }
    }
}
