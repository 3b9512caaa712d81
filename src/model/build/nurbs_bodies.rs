//! Bodies of kind `nurbs`: a face of a CAD file that bends.
use super::super::edge_couple::CoupleSpan;
use super::super::error::{At, number, text};
use super::super::motion::pose;
use super::super::penalty::FaceSize;
use super::super::sheet_pressure::FollowingSpan;
use super::{Builder, FEWER, ModelError, elements_key, extent};
use crate::contact::lever::Lever;
use crate::contact::points::SlavePoint;
use crate::fem::quadrature::QuadratureError;
use crate::fem::{gauss, lobatto};
use crate::machine::memory;
use crate::mesh::nurbs::{Fineness, side};
use crate::mesh::{Edge, Face, Mesh, NurbsError, NurbsSheet};
use crate::scene::{self, Contact, Gap, NurbsSurface, Passes, Points, SetNames, Tangent};
use crate::shell::{Block, Law, Memory, NurbsBlock, bytes_per_element};
use covact_geometry::{NurbsPatch, Vec3, io};

/// Points along each direction of a face where the scene asks for none: as many as its polynomials have numbers.
pub const SHEET_POINTS: usize = 4;

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
        let faces = self.nurbs_faces(name, nurbs)?;
        let fineness = match (nurbs.size, nurbs.elements) {
            (Some(size), _) => Fineness::Size(size),
            (None, Some(counts)) => Fineness::Elements(counts),
            (None, None) => {
                let message = "the size of elements is not given";
                return Err(text(at("size"), message).help("give `size` or `elements`"));
            }
        };
        let placement = &body.placement;
        let placed = faces.into_iter().map(|(face, patch)| {
            let placed = patch.moved(&pose(placement), placement.scale);
            placed.map(|patch| (face, patch))
        });
        let faces: Vec<(u32, NurbsPatch)> = placed.collect::<Result<_, _>>().at(|| at("file"))?;
        let mut sheet =
            NurbsSheet::joined(&faces, nurbs.thickness, fineness, nurbs.assumed_membrane).map_err(
                |(k, e)| {
                    refused(
                        &at("file"),
                        &at("elements"),
                        &format!("face {}", faces[k].0),
                        e,
                    )
                },
            )?;
        let elements = sheet.elements() as u64;
        let each: usize = bytes_per_element(body.element, Memory::NONE).iter().sum();
        memory::ask(memory::times(elements, each as u64)).map_err(|shortage| {
            let message = format!("body `{name}` with its {elements} elements: {shortage}");
            text(elements_key(name, &body.mesh), message).help(FEWER)
        })?;
        let mut mesh = sheet.mesh();
        for (set, selection) in &body.sets {
            sheet
                .add_set(&mut mesh, set, selection)
                .at(|| format!("/bodies/{name}/sets/{set}"))
                .map_err(|e| e.help(extent(name, &mesh)))?;
        }
        // Supports hold curves of trims by nodes on them.
        let supports = self.scene.supports.values();
        let held = supports.flat_map(|s| s.on.places(""));
        let sets = held.filter_map(|(_, reference)| {
            let (body, set) = reference.split_once('.')?;
            (body == name).then_some(set)
        });
        sheet.anchor(&mut mesh, sets);
        let block = NurbsBlock::new(&sheet, law).at(|| at("file"))?;
        self.tell_sheet(name, nurbs, &sheet);
        Ok((mesh, Block::Nurbs(Box::new(block))))
    }

    /// What was made of the faces of a file.
    fn tell_sheet(&mut self, name: &str, nurbs: &NurbsSurface, sheet: &NurbsSheet) {
        let (what, elements) = match &sheet.patches[..] {
            [one] => {
                let [u, v] = one.spans();
                (format!("face {}", one.face), format!("{u} x {v}"))
            }
            all => (format!("{} faces", all.len()), sheet.elements().to_string()),
        };
        self.notes.push(format!(
            "body `{name}`: {what} of {} as a shell of thickness {}, {elements} bicubic elements{}; its surface did not move",
            nurbs.file.display(),
            number(nurbs.thickness),
            match nurbs.assumed_membrane {
                true => ", with assumed membrane strains",
                false => "",
            }
        ));
        let cut = sheet.patches.iter().filter_map(|p| p.cut.as_ref());
        if sheet.is_trimmed() {
            let [_, parts, gone] = cut.fold([0; 3], |sum, cut| {
                let own = cut.counts();
                [0, 1, 2].map(|k| sum[k] + own[k])
            });
            self.notes.push(format!(
                "body `{name}`: trims cut {parts} of the elements, which are integrated along them, and leave nothing of {gone}"
            ));
        }
        if sheet.patches.len() == 1 {
            return;
        }
        let joints = &sheet.joints;
        let gap = joints.seams.iter().map(|s| s.gap).fold(0.0, f64::max);
        let parts = match sheet.parts() {
            1 => String::new(),
            n => format!("; {n} parts are not joined to each other"),
        };
        self.notes.push(format!(
            "body `{name}`: joined along {} edge(s), with gaps of up to {}{parts}",
            joints.seams.len(),
            number(gap)
        ));
        let turned: Vec<String> = (sheet.patches.iter().filter(|p| p.reversed))
            .map(|p| p.face.to_string())
            .collect();
        if !turned.is_empty() {
            self.notes.push(format!(
                "body `{name}`: the normal of face(s) {} is turned over, so that `top` is on the side of face {}",
                turned.join(", "),
                sheet.patches[0].face
            ));
        }
        for edge in &joints.partial {
            self.notes.push(format!(
                "body `{name}`: `{}` is joined along a part of its length",
                sheet.border_name(*edge)
            ));
        }
        for (edge, patch) in &joints.inside {
            self.warnings.push(format!(
                "body `{name}`: the free edge `{}` lies on the inside of face {}, and is not joined to it: only edges are",
                sheet.border_name(*edge),
                sheet.patches[*patch].face
            ));
        }
        for near in &joints.near {
            let [a, b] = near.edges.map(|e| sheet.border_name(e));
            self.warnings.push(format!(
                "body `{name}`: the free edge `{a}` runs within {} of `{b}`, less than the thickness, but is not joined to it: the gap \
                 is larger than CAD files leave",
                number(near.distance)
            ));
        }
    }

    /// The faces of the file that the scene takes, with their numbers, in the units of the scene.
    fn nurbs_faces(
        &mut self,
        name: &str,
        nurbs: &NurbsSurface,
    ) -> Result<Vec<(u32, NurbsPatch)>, ModelError> {
        let at = |field: &str| format!("/bodies/{name}/nurbs/{field}");
        let shown = nurbs.file.display();
        let options = io::ReadOptions {
            hidden: nurbs.hidden,
        };
        let file =
            io::read_path_with(&self.loaded.dir.join(&nurbs.file), &options).at(|| at("file"))?;
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
        if chosen.is_empty() {
            let message = format!("{shown} holds no face that can be used");
            let help = "`covact inspect` lists what is in a CAD file";
            return Err(text(at("file"), message).help(help));
        }
        if nurbs.faces.is_empty() && !file.skipped.is_empty() {
            let skipped = file.skipped.iter();
            let all: Vec<String> = skipped
                .map(|s| format!("{} ({})", s.entity, s.reason))
                .collect();
            let message = format!("{shown}: faces cannot be read: {}", all.join(", "));
            let help = "name the faces that are the shell in `faces`";
            return Err(text(at("file"), message).help(help));
        }
        let own = io::LengthUnit::from_name(self.scene.units.length.name());
        let factor = own.as_ref().and_then(|own| file.unit.factor_to(own));
        if factor.is_none() {
            self.notes.push(format!(
                "body `{name}`: {shown} states no length unit; its numbers are taken as {}",
                self.scene.units.length.name()
            ));
        }
        let factor = factor.unwrap_or(1.0);
        (chosen.into_iter())
            .map(|p| {
                let scaled = p.patch.transformed(&|x| x * factor);
                scaled.map(|patch| (p.entity, patch))
            })
            .collect::<Result<_, _>>()
            .at(|| at("file"))
    }

    /// What a contact asks for that a face of a sheet cannot do, or that nothing was tried of.
    pub(super) fn sheet_contact(
        &self,
        name: &str,
        contact: &Contact,
        rigid: Option<usize>,
    ) -> Result<(), ModelError> {
        let at = |field: &str| format!("/contacts/{name}/{field}");
        let of = |side: &SetNames| {
            let index = self.body_index.get(side.body());
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
        let described = contact.surface(&self.scene.surfaces);
        if described.is_some_and(|s| s.motion.free.is_some()) {
            return refuse(
                "master",
                "surfaces driven by force",
                "prescribe the motion of the surface",
            );
        }
        if let (None, Tangent::Published { .. }) = (rigid, contact.tangent) {
            return refuse("tangent", "published tangents", "take `exact`");
        }
        if matches!(contact.points, Points::Segments(_)) {
            return refuse("points", "integration segments", "take `{\"gauss\": 4}`");
        }
        if contact.gap == Gap::Averaged {
            return refuse("gap", "averaged gaps", "leave `gap` out");
        }
        if matches!(contact.passes, Passes::TwoHalf | Passes::Edges) {
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
                let help = "a couple acts along edges: `edge.1` to `edge.4`, a curve of a trim (`trim.1`), or a set of nodes that holds a whole one";
                return Err(text(pointer, message).help(help));
            };
            for edge in edges {
                let own = CoupleSpan::all(sheet, *edge, body.first_node);
                spans.extend(own.into_iter().map(FollowingSpan::Couple));
            }
        }
        Ok(spans)
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
            Points::Auto | Points::Nodes | Points::Segments(_) => gauss(SHEET_POINTS)?,
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
    // The border of a trimmed sheet is more than its edges.
    if sheet.is_trimmed() {
        return None;
    }
    let elements = sheet.elements();
    let of = |side: u8| faces.iter().filter(|f| f.face == side).count();
    let whole = [4, 5].iter().all(|side| [0, elements].contains(&of(*side)));
    let shifted = |edge| sheet.row(edge, 0).iter().map(|n| n + first_node).collect();
    // Both sides of a seam: their displacements are not the same numbers.
    let all = (0..sheet.patches.len()).flat_map(Edge::of);
    whole.then(|| all.map(shifted).collect())
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
        NurbsError::Degree { .. } => Some("export it with degree 3 at most, or mesh it (`mesh`)"),
        NurbsError::Crease { .. } | NurbsError::Closed { .. } => {
            Some("cut the face there in the CAD program, and take one of its parts")
        }
        NurbsError::Twice { .. } => Some("name the faces that are the shell in `faces`"),
        NurbsError::OneSided { .. } => Some("make two bodies of it"),
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
