//! Bodies of kind `nurbs`: a face of a CAD file that bends.
use super::super::edge_couple::CoupleSpan;
use super::super::error::{At, text};
use super::super::motion::pose;
use super::super::penalty::FaceSize;
use super::super::sheet_pressure::FollowingSpan;
use super::{Builder, FEWER, ModelError, extent};
use crate::contact::lever::Lever;
use crate::contact::points::SlavePoint;
use crate::fem::quadrature::QuadratureError;
use crate::fem::{gauss, lobatto};
use crate::machine::memory;
use crate::mesh::nurbs::{Fineness, side};
use crate::mesh::{Edge, Face, Mesh, NurbsError, NurbsSheet};
use crate::scene::{self, Contact, Gap, NurbsSurface, Passes, Points, SetNames, Tangent};
use crate::shell::{Block, Law, NurbsBlock, bytes_per_element};
use covact_geometry::{MovingError, MovingFacets, NurbsPatch, Vec3, io};

/// Points along each direction of a face where the scene asks for none: as many as its polynomials have numbers.
const POINTS: usize = 4;

impl Builder<'_> {
    /// The sheet of a body, its mesh and its elements.
    pub(super) fn sheet(
        &mut self,
        name: &str,
        nurbs: &NurbsSurface,
        body: &scene::Body,
        law: Law,
    ) -> Result<(Mesh, Block), ModelError> {
        let at = |field: &str| format!("/bodies/{name}/nurbs/{field}");
        let (patch, label) = self.face(name, nurbs)?;
        let fineness = match (nurbs.size, nurbs.elements) {
            (Some(size), _) => Fineness::Size(size),
            (None, Some(counts)) => Fineness::Elements(counts),
            (None, None) => {
                let message = "the size of elements is not given";
                return Err(text(at("size"), message).help("give `size` or `elements`"));
            }
        };
        let placement = &body.placement;
        let patch = patch
            .moved(&pose(placement), placement.scale)
            .at(|| at("file"))?;
        let mut sheet = NurbsSheet::new(&patch, nurbs.thickness, fineness, nurbs.assumed_membrane)
            .map_err(|e| refused(&at("file"), &at("elements"), &label, e))?;
        let spans = sheet.spans();
        let elements = (spans[0] * spans[1]) as u64;
        let each: usize = bytes_per_element(body.element, false).iter().sum();
        memory::ask(memory::times(elements, each as u64)).map_err(|shortage| {
            let message = format!("body `{name}` with its {elements} elements: {shortage}");
            text(super::elements_key(name, &body.mesh), message).help(FEWER)
        })?;
        let mut mesh = sheet.mesh();
        for (set, selection) in &body.sets {
            sheet
                .add_set(&mut mesh, set, selection)
                .at(|| format!("/bodies/{name}/sets/{set}"))
                .map_err(|e| e.help(extent(name, &mesh)))?;
        }
        let block = NurbsBlock::new(&sheet, law).at(|| at("file"))?;
        self.notes.push(format!(
            "body `{name}`: {label} of {} as a shell of thickness {}, {} x {} bicubic elements{}; its surface did not move",
            nurbs.file.display(),
            crate::model::error::number(nurbs.thickness),
            spans[0],
            spans[1],
            match nurbs.assumed_membrane {
                true => ", with assumed membrane strains",
                false => "",
            }
        ));
        Ok((mesh, Block::Nurbs(Box::new(block))))
    }

    /// The one face of the file that the scene takes, in the units of the scene, and what it is called.
    fn face(
        &mut self,
        name: &str,
        nurbs: &NurbsSurface,
    ) -> Result<(NurbsPatch, String), ModelError> {
        let at = |field: &str| format!("/bodies/{name}/nurbs/{field}");
        let shown = nurbs.file.display();
        let options = io::ReadOptions {
            hidden: nurbs.hidden,
        };
        let file = io::read_path_with(&self.dir.join(&nurbs.file), &options).at(|| at("file"))?;
        let wanted = |entity: u32| nurbs.faces.is_empty() || nurbs.faces.contains(&entity);
        let listed = || -> String {
            let all: Vec<String> = file.patches.iter().map(|p| p.entity.to_string()).collect();
            format!("faces of this file: {}", all.join(", "))
        };
        for (i, face) in nurbs.faces.iter().enumerate() {
            if let Some(skipped) = file.skipped.iter().find(|s| s.entity == *face) {
                let message = format!("{shown}: face {face} cannot be read: {}", skipped.reason);
                return Err(text(at(&format!("faces/{i}")), message));
            }
            if !file.patches.iter().any(|p| p.entity == *face) {
                let message = format!("{shown} has no face {face}");
                return Err(text(at(&format!("faces/{i}")), message).help(listed()));
            }
        }
        let chosen: Vec<_> = file.patches.iter().filter(|p| wanted(p.entity)).collect();
        let [patch] = chosen[..] else {
            let (field, message) = match chosen.len() {
                0 => ("file", format!("{shown} holds no face that can be used")),
                n => (
                    "faces",
                    format!(
                        "{n} faces of {shown} are chosen, and only one can be a shell: faces are not joined yet"
                    ),
                ),
            };
            let help = match chosen.len() {
                0 => "`covact inspect` lists what is in a CAD file".to_owned(),
                _ => format!("name one in `faces`; {}", listed()),
            };
            return Err(text(at(field), message).help(help));
        };
        let own = io::LengthUnit::from_name(self.scene.units.length.name());
        let factor = own.as_ref().and_then(|own| file.unit.factor_to(own));
        if factor.is_none() {
            self.notes.push(format!(
                "body `{name}`: {shown} states no length unit; its numbers are taken as {}",
                self.scene.units.length.name()
            ));
        }
        let factor = factor.unwrap_or(1.0);
        let scaled = (patch.patch)
            .transformed(&|x| x * factor)
            .at(|| at("file"))?;
        Ok((scaled, format!("face {}", patch.entity)))
    }

    /// What a contact asks for that a face of a sheet cannot do, or that nothing was tried of.
    pub(super) fn sheet_contact(
        &self,
        name: &str,
        contact: &Contact,
        rigid: Option<usize>,
    ) -> Result<(), ModelError> {
        let at = |field: &str| format!("/contacts/{name}/{field}");
        let of = |set: &str| {
            let (body, _) = set.split_once('.').unwrap_or((set, ""));
            let index = self.body_index.get(body);
            index.is_some_and(|i| self.bodies[*i].block.sheet().is_some())
        };
        if rigid.is_none() && of(&contact.master) {
            self.sheet_master(contact, &at)?;
        }
        if !of(&contact.slave) {
            return Ok(());
        }
        let refuse = |field: &str, what: &str, help: &str| {
            let message = format!(
                "{what} do not go with the slave `{}`, a face of a body of kind `nurbs`, yet",
                contact.slave
            );
            Err(text(at(field), message).help(help.to_owned()))
        };
        if rigid.is_none() {
            return refuse(
                "master",
                "masters that are bodies",
                "take a rigid surface as master",
            );
        }
        let described = self.scene.surfaces.get(&contact.master);
        if described.is_some_and(|s| s.motion.free.is_some()) {
            return refuse(
                "master",
                "surfaces driven by force",
                "prescribe the motion of the surface",
            );
        }
        if matches!(contact.points, Points::Segments(_)) {
            return refuse("points", "integration segments", "take `{\"gauss\": 4}`");
        }
        if contact.gap == Gap::Averaged {
            return refuse("gap", "averaged gaps", "leave `gap` out");
        }
        if contact.passes != Passes::One {
            return refuse("passes", "two passes", "leave `passes` out");
        }
        Ok(())
    }

    /// Where a slave point is at the start.
    pub(super) fn start(&self, p: &SlavePoint) -> Vec3 {
        match p.lever_number() {
            Some(number) => self.levers[number].position(|n| self.nodes[n as usize]),
            None => (p.terms()).fold(Vec3::zeros(), |x, (n, w)| x + self.nodes[n] * w),
        }
    }

    /// The elements along edges of sheets under a couple.
    pub(super) fn couples(
        &self,
        on: &SetNames,
        at: &str,
    ) -> Result<Vec<FollowingSpan>, ModelError> {
        let mut spans = Vec::new();
        for (pointer, reference) in on.places(at) {
            let (name, set) = reference.split_once('.').unwrap_or((reference, ""));
            let body = self.body_index.get(name).map(|i| &self.bodies[*i]);
            let sheet = body.and_then(|b| Some((b, b.block.sheet()?)));
            let edges = sheet.and_then(|(b, s)| Some((b, s, s.edge_sets.get(set)?)));
            let Some((body, sheet, edges)) = edges else {
                let message = format!("`{reference}` is no edge of a body of kind `nurbs`");
                let help = "a couple acts along edges: `edge.1` to `edge.4`, or a set of nodes that holds a whole edge";
                return Err(text(pointer, message).help(help));
            };
            for edge in edges {
                let own = CoupleSpan::all(sheet, *edge, body.first_node);
                spans.extend(own.into_iter().map(FollowingSpan::Couple));
            }
        }
        Ok(spans)
    }

    /// What a contact asks for that a face of a sheet as a master cannot do, or that nothing was tried of.
    fn sheet_master(
        &self,
        contact: &Contact,
        at: &impl Fn(&str) -> String,
    ) -> Result<(), ModelError> {
        let refuse = |field: &str, what: &str, help: &str| {
            let message = format!(
                "{what} do not go with the master `{}`, a face of a body of kind `nurbs`, yet",
                contact.master
            );
            Err(text(at(field), message).help(help.to_owned()))
        };
        if contact.passes != Passes::One {
            return refuse("passes", "two passes", "leave `passes` out");
        }
        if matches!(contact.points, Points::Segments(_)) {
            return refuse("points", "integration segments", "take `{\"gauss\": 3}`");
        }
        if contact.gap == Gap::Averaged {
            return refuse("gap", "averaged gaps", "leave `gap` out");
        }
        if contact.master_surface.is_some() {
            return refuse(
                "master_surface",
                "kinds of surfaces",
                "leave it out: the face is the exact surface",
            );
        }
        if let Tangent::Published { .. } = contact.tangent {
            return refuse("tangent", "published tangents", "take `exact`");
        }
        let (name, _) = contact
            .master
            .split_once('.')
            .unwrap_or((&contact.master, ""));
        let body = self.body_index.get(name).map(|i| &self.bodies[*i]);
        let rational = body
            .and_then(|b| b.block.sheet())
            .is_some_and(|s| s.patch.is_rational());
        if rational {
            let message = format!(
                "`{}` is a face of a rational surface (a cylinder, a sphere, an arc), which cannot be a master yet",
                contact.master
            );
            let help = "exchange slave and master, or take a face without weights";
            return Err(text(at("master"), message).help(help));
        }
        Ok(())
    }

    /// Faces of a sheet as a master: its mid-surface, from which contact begins half of the thickness away. The faces are of one
    /// side.
    pub(super) fn sheet_facets(
        &self,
        body: usize,
        faces: &[Face],
    ) -> Option<Result<(MovingFacets, f64), MovingError>> {
        let model = &self.bodies[body];
        let sheet = model.block.sheet()?;
        let spans: Vec<usize> = faces.iter().map(|f| f.element as usize).collect();
        let bottom = faces.first().and_then(|f| side(*f)) == Some(-1.0);
        let number = |n: u32| n + model.first_node;
        let facets = MovingFacets::of_patch(&sheet.patch, &spans, bottom, number);
        Some(facets.map(|mut facets| {
            facets.update(|n| self.nodes[n as usize]);
            (facets, 0.5 * sheet.thickness)
        }))
    }

    /// Slave points on faces of a sheet: at its Gauss points, half of the thickness from the mid-surface.
    pub(super) fn sheet_points(
        &mut self,
        body: usize,
        faces: &[Face],
        points: Points,
    ) -> Result<Vec<SlavePoint>, QuadratureError> {
        let model = &self.bodies[body];
        let Some(sheet) = model.block.sheet() else {
            return Ok(Vec::new());
        };
        let rule = match points {
            Points::Nodes | Points::Segments(_) => gauss(POINTS)?,
            Points::Gauss(n) => gauss(n as usize)?,
            Points::Lobatto(n) => lobatto(n as usize)?,
        };
        let mut out = Vec::new();
        for face in faces {
            let height = 0.5 * sheet.thickness * side(*face).unwrap_or(1.0);
            for p in sheet.sampled(std::iter::once(face.element as usize), &rule) {
                out.push(SlavePoint::lever(self.levers.len() as u32, p.area));
                self.levers.push(Lever {
                    nodes: p.nodes.map(|n| n + model.first_node),
                    n: p.n,
                    n_i: p.n_i,
                    height,
                });
            }
        }
        Ok(out)
    }
}

/// The edges of a sheet one of whose faces is loaded as a whole, as nodes of the model; none where a part of one is.
pub(super) fn sheet_rims(
    sheet: &NurbsSheet,
    faces: &[Face],
    first_node: u32,
) -> Option<Vec<Vec<u32>>> {
    let elements: usize = sheet.spans().iter().product();
    let of = |side: u8| faces.iter().filter(|f| f.face == side).count();
    let whole = [4, 5].iter().all(|side| [0, elements].contains(&of(*side)));
    let shifted = |edge| sheet.row(edge, 0).iter().map(|n| n + first_node).collect();
    whole.then(|| Edge::ALL.map(shifted).to_vec())
}

/// Sizes of the elements of a sheet, as a contact on its faces sees them.
pub(super) fn sheet_size(sheet: &NurbsSheet) -> FaceSize {
    let [low, high] = sheet.bounds();
    FaceSize {
        edge: sheet.span_length(),
        depth: sheet.thickness,
        thickness: sheet.thickness,
        length: (high - low).norm(),
    }
}

/// A face that cannot be a sheet.
fn refused(file: &str, elements: &str, label: &str, error: NurbsError) -> ModelError {
    let help = match &error {
        NurbsError::Trimmed => Some("give the face without its trim, or mesh it (`mesh`)"),
        NurbsError::Degree { .. } => Some("export it with degree 3 at most, or mesh it (`mesh`)"),
        NurbsError::Crease { .. } | NurbsError::Closed { .. } => {
            Some("cut the face there in the CAD program, and take one of its parts")
        }
        NurbsError::Pole { .. } => Some("cut the pole away, or mesh the face (`mesh`)"),
        _ => None,
    };
    let pointer = match error {
        NurbsError::TooMany { .. } => elements,
        _ => file,
    };
    let refusal = text(pointer, format!("{label}: {error}"));
    match help {
        Some(help) => refusal.help(help),
        None => refusal,
    }
}
