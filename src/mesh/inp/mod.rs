//! Reader of Abaqus' and CalculiX' input files, of the part that describes a mesh: `*NODE`, `*ELEMENT`, `*NSET`, `*ELSET`,
//! `*SURFACE, TYPE=ELEMENT`, in flat files and in parts, instances and assemblies (Abaqus keywords reference; CalculiX
//! manual, ch. 7).
//!
//! Hexahedra are the elements of a solid, quadrilaterals (S4, CPS4, M3D4, ...) are its faces: an element set of them
//! becomes a face set, which is how gmsh writes physical surfaces. Quadrilaterals and triangles are the elements of a
//! surface. Nodes stand above the elements that use them; sets may be used before they are defined.
mod assembly;
mod build;
mod lines;
mod names;
mod resolve;
mod scope;
mod types;

use super::error::{MAX_NODES, MOST_IN_NAME, shorten};
use super::field::Field;
use super::raw::RawMesh;
use super::{Mesh, MeshError, MeshReport};
use assembly::Instance;
use covact_geometry::Vec3;
use lines::{Keyword, fields};
use scope::{Element, Entry, Reference, Scope, Side};
use std::collections::BTreeSet;
use std::path::Path;
use types::Shape;

/// Local faces of the file's faces S1 to S6.
const FACES: [u8; 6] = [4, 5, 2, 1, 3, 0];
const ELEMENTS: &str = "solid elements are C3D8 and its relatives and SC8R, of 8 nodes, C3D20 of 20 and C3D27 of 27; \
                        elements of surfaces are S3, S4, S6, S8, CPS3, CPS4, M3D3, M3D4 and the like";

/// Keywords whose data lines are read.
const OF_MESH: [&str; 5] = ["*NODE", "*ELEMENT", "*NSET", "*ELSET", "*SURFACE"];

/// Set that meshio writes of what it read of a gmsh file: its numbers are of geometry, not of elements.
const NOT_A_SET: &str = "gmsh:bounding_entities";

/// Reads the mesh of hexahedra from the bytes of a file; `path` is for messages, `scale` multiplies every coordinate.
pub fn read_inp(bytes: &[u8], path: &Path, scale: f64) -> Result<(Mesh, MeshReport), MeshError> {
    parse(bytes, path)?.into_mesh(path, scale, false)
}

/// Everything of use in a file.
pub(super) fn parse(bytes: &[u8], path: &Path) -> Result<RawMesh, MeshError> {
    let text = String::from_utf8_lossy(bytes);
    let mut reader = Reader::new(path);
    let mut lines = text.lines().enumerate().map(|(i, line)| (i + 1, line));
    while let Some((number, line)) = lines.next() {
        let start = line.trim_start();
        if start.is_empty() || start.starts_with("**") {
            continue;
        }
        if !start.starts_with('*') {
            reader.data(line, number)?;
            continue;
        }
        let Some(mut keyword) = Keyword::new(line, number) else {
            continue;
        };
        // A comma at the end continues a keyword line.
        let mut open = line.trim_end().ends_with(',');
        while open {
            let Some((number, line)) = lines.next() else {
                break;
            };
            keyword.extend(fields(line, number));
            open = line.trim_end().ends_with(',');
        }
        reader.keyword(&keyword)?;
    }
    reader.complete()?;
    reader.finish()
}

/// What the data lines below a keyword mean.
enum Mode {
    Skip,
    /// Of a node set.
    Node(Option<String>),
    Element {
        shape: Shape,
        set: Option<String>,
    },
    Set {
        kind: SetOf,
        name: String,
        generate: bool,
        instance: Option<String>,
    },
    Surface(String),
    /// Translation, then rotation of an instance.
    Instance(usize),
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum SetOf {
    Nodes,
    Elements,
}

struct Reader<'a> {
    path: &'a Path,
    /// The flat file or the assembly first, then the parts in the order of the file.
    scopes: Vec<Scope>,
    /// Where nodes, elements and sets go.
    current: usize,
    instances: Vec<Instance>,
    mode: Mode,
    /// Nodes of an element that goes on in the next line, after its number; the place of the last.
    pending: Option<(u64, Vec<u32>)>,
    last: (usize, usize),
    /// Element types and keywords that were passed over.
    types: BTreeSet<String>,
    skipped: BTreeSet<String>,
    notes: Vec<String>,
    refused: Option<MeshError>,
    found: BTreeSet<String>,
    /// Elements whose line goes on after their last node.
    longer: usize,
}

impl<'a> Reader<'a> {
    fn new(path: &'a Path) -> Reader<'a> {
        Reader {
            path,
            scopes: vec![Scope::default()],
            current: 0,
            instances: Vec::new(),
            mode: Mode::Skip,
            pending: None,
            last: (1, 1),
            types: BTreeSet::new(),
            skipped: BTreeSet::new(),
            notes: Vec::new(),
            refused: None,
            found: BTreeSet::new(),
            longer: 0,
        }
    }

    fn scope(&mut self) -> &mut Scope {
        &mut self.scopes[self.current]
    }

    fn keyword(&mut self, keyword: &Keyword) -> Result<(), MeshError> {
        self.complete()?;
        let path = self.path;
        let name = |parameter: &str| match keyword.get(parameter) {
            Some(field) if !field.text.is_empty() => spell(path, field),
            _ => {
                let expected = format!("{} with {parameter}=name", keyword.name);
                Err(keyword.at.syntax(path, &expected))
            }
        };
        let optional = |parameter: &str| {
            let field = keyword.get(parameter).filter(|f| !f.text.is_empty());
            field.map(|f| spell(path, f)).transpose()
        };
        if let (Some(file), true) = (keyword.get("INPUT"), OF_MESH.contains(&&*keyword.name)) {
            let keyword = &keyword.name;
            let what = format!("{keyword} with its data in another file (INPUT)");
            let help = "put the data into this file";
            return Err(file.unsupported(path, what, help));
        }
        self.mode = match keyword.name.as_str() {
            "*NODE" => {
                if let Some(system) = keyword.get("SYSTEM").filter(|s| s.text != "R") {
                    let what = format!("the coordinate system {}", shorten(system.text));
                    return Err(system.unsupported(path, what, "give rectangular coordinates"));
                }
                Mode::Node(optional("NSET")?)
            }
            "*ELEMENT" => {
                let Some(kind) = keyword.get("TYPE").filter(|f| !f.text.is_empty()) else {
                    return Err(keyword.at.syntax(path, "*ELEMENT with TYPE=name"));
                };
                self.elements(kind, optional("ELSET")?)
            }
            "*NSET" | "*ELSET" => {
                let (kind, parameter) = match keyword.name.as_str() {
                    "*NSET" => (SetOf::Nodes, "NSET"),
                    _ => (SetOf::Elements, "ELSET"),
                };
                let name = name(parameter)?;
                if name == NOT_A_SET {
                    self.notes
                        .push(format!("`{name}` holds no elements and was left out"));
                    Mode::Skip
                } else {
                    // A set without members is one too.
                    self.set(kind, &name);
                    Mode::Set {
                        kind,
                        name,
                        generate: keyword.get("GENERATE").is_some(),
                        instance: optional("INSTANCE")?,
                    }
                }
            }
            "*SURFACE" => {
                let set = name("NAME")?;
                match keyword.get("TYPE") {
                    Some(t) if !t.text.eq_ignore_ascii_case("ELEMENT") => {
                        self.notes.push(format!(
                            "surface `{set}` of type {} was left out",
                            shorten(t.text)
                        ));
                        Mode::Skip
                    }
                    _ => Mode::Surface(set),
                }
            }
            "*INCLUDE" => {
                let help = "put the included text into this file";
                return Err(keyword.at.unsupported(path, keyword.name.clone(), help));
            }
            "*PART" | "*ENDPART" | "*ASSEMBLY" | "*ENDASSEMBLY" | "*INSTANCE" | "*ENDINSTANCE" => {
                self.assembly(keyword)?
            }
            "*SYSTEM" | "*NGEN" | "*NFILL" | "*NCOPY" | "*ELGEN" | "*ELCOPY" => {
                let help = "write all nodes and elements out, in rectangular coordinates";
                return Err(keyword.at.unsupported(path, keyword.name.clone(), help));
            }
            "*HEADING" => Mode::Skip,
            other => {
                self.skipped.insert(other.to_string());
                Mode::Skip
            }
        };
        Ok(())
    }

    fn elements(&mut self, field: Field, set: Option<String>) -> Mode {
        let kind = field.text.to_uppercase();
        let shape = Shape::of(&kind);
        self.found.insert(kind.clone());
        if let Some(set) = &set {
            self.set(SetOf::Elements, set);
        }
        match shape {
            Shape::OtherSolid => {
                let what = format!("element type {}", shorten(&kind));
                let refused = field.unsupported(self.path, what, ELEMENTS);
                self.refused.get_or_insert(refused);
                self.types.insert(kind);
                Mode::Skip
            }
            Shape::Other => {
                self.types.insert(kind);
                Mode::Skip
            }
            _ => Mode::Element { shape, set },
        }
    }

    fn set(&mut self, kind: SetOf, name: &str) -> &mut scope::Set {
        let scope = self.scope();
        match kind {
            SetOf::Nodes => scope.node_sets.get(name),
            SetOf::Elements => scope.element_sets.get(name),
        }
    }

    /// An element whose line ended too early.
    fn complete(&mut self) -> Result<(), MeshError> {
        let (Mode::Element { shape, .. }, Some((tag, found))) = (&self.mode, self.pending.take())
        else {
            return Ok(());
        };
        let field = Field {
            text: "",
            line: self.last.0,
            column: self.last.1,
        };
        let expected = format!("{} nodes of element {tag}", shape.nodes());
        Err(field.syntax_found(self.path, &expected, &found.len().to_string()))
    }

    fn data(&mut self, line: &str, number: usize) -> Result<(), MeshError> {
        let mode = std::mem::replace(&mut self.mode, Mode::Skip);
        let list = fields(line, number);
        match &mode {
            Mode::Skip => {}
            Mode::Node(set) => self.node(list, set.as_deref())?,
            Mode::Element { shape, set } => {
                let mut list = list;
                while let Some(field) = list.next() {
                    let whole = self.element_number(field, *shape, set.as_deref())?;
                    if whole {
                        // Programs read as many nodes as the type has; the line may have more.
                        self.longer += usize::from(list.any(|f| !f.text.is_empty()));
                        break;
                    }
                }
            }
            Mode::Set {
                kind,
                name,
                generate,
                instance,
            } => self.members(list, *kind, name, *generate, instance.as_deref())?,
            Mode::Surface(set) => self.surface(list, set)?,
            Mode::Instance(k) => self.place(*k, list)?,
        }
        self.mode = mode;
        Ok(())
    }

    /// Members of a set: as they are, or `first, last, step`.
    fn members<'l>(
        &mut self,
        mut list: impl Iterator<Item = Field<'l>>,
        kind: SetOf,
        name: &str,
        generate: bool,
        instance: Option<&str>,
    ) -> Result<(), MeshError> {
        let path = self.path;
        let set = self.set(kind, name);
        let instance = set.instance(instance);
        if !generate {
            for field in list.filter(|f| !f.text.is_empty()) {
                set.entries
                    .push(Entry::new(reference(&field), &field, instance));
            }
            return Ok(());
        }
        let Some(field) = list.next() else {
            return Ok(());
        };
        let first = field.integer(path, "the first number")?;
        let last = match list.next() {
            Some(f) => f.integer(path, "the last number")?,
            None => first,
        };
        let step = match list.next() {
            Some(f) if !f.text.is_empty() => f.integer(path, "the step between numbers")?,
            _ => 1,
        };
        let range = Reference::Range(Box::new([first, last, step]));
        set.entries.push(Entry::new(range, &field, instance));
        Ok(())
    }

    fn node<'l>(
        &mut self,
        mut list: impl Iterator<Item = Field<'l>>,
        set: Option<&str>,
    ) -> Result<(), MeshError> {
        let path = self.path;
        let Some(field) = list.next() else {
            return Ok(());
        };
        let tag = field.integer(path, "a node number")?;
        let mut x = [0.0; 3];
        for (value, field) in x.iter_mut().zip(list) {
            // An empty entry is zero.
            if !field.text.is_empty() {
                *value = field.real(path, "a coordinate")?;
            }
        }
        let scope = self.scope();
        let index = scope.nodes.len() as u32;
        if u64::from(index) >= MAX_NODES {
            return Err(MeshError::TooManyNodes {
                what: "input file",
                nodes: u128::from(index) + 1,
            });
        }
        if scope.node_index.insert(tag, index).is_some() {
            return Err(field.syntax(path, "a node number used once"));
        }
        scope.nodes.push(Vec3::from(x));
        scope.node_tags.push(tag);
        if let Some(set) = set {
            let set = scope.node_sets.get(set);
            set.entries
                .push(Entry::new(Reference::Number(tag), &field, super::raw::NONE));
        }
        Ok(())
    }

    /// The next number of an element: its own, or that of a node. Whether the element has all its nodes then.
    fn element_number(
        &mut self,
        field: Field,
        shape: Shape,
        set: Option<&str>,
    ) -> Result<bool, MeshError> {
        self.last = (field.line, field.column);
        let path = self.path;
        let scope = &mut self.scopes[self.current];
        let Some((tag, nodes)) = &mut self.pending else {
            let tag = field.integer(path, "an element number")?;
            if scope.element_index.contains_key(&tag) {
                return Err(field.syntax(path, "an element number used once"));
            }
            self.pending = Some((tag, Vec::with_capacity(shape.nodes())));
            return Ok(false);
        };
        let node = field.integer(path, "a node number")?;
        let Some(&index) = scope.node_index.get(&node) else {
            let expected = "the number of a node that stands above";
            return Err(field.syntax_found(path, expected, &format!("node {node}")));
        };
        nodes.push(index);
        if nodes.len() < shape.nodes() {
            return Ok(false);
        }
        let element = Element {
            tag: *tag,
            shape,
            first: scope.connectivity.len(),
            at: (field.line as u32, field.column as u32),
        };
        scope.connectivity.append(nodes);
        let tag = *tag;
        scope.element_index.insert(tag, scope.elements.len() as u32);
        scope.elements.push(element);
        if let Some(set) = set {
            let set = scope.element_sets.get(set);
            set.entries
                .push(Entry::new(Reference::Number(tag), &field, super::raw::NONE));
        }
        self.pending = None;
        Ok(true)
    }

    /// `element or element set, S1 to S6`.
    fn surface<'l>(
        &mut self,
        mut list: impl Iterator<Item = Field<'l>>,
        name: &str,
    ) -> Result<(), MeshError> {
        let Some(field) = list.next() else {
            return Ok(());
        };
        let side = list.next();
        let parsed = side.and_then(|s| match s.text.to_uppercase().as_str() {
            "SNEG" => Some(Side::Face(FACES[0])),
            "SPOS" => Some(Side::Face(FACES[1])),
            other => {
                let number = |letter| {
                    other
                        .strip_prefix(letter)?
                        .parse::<usize>()
                        .ok()?
                        .checked_sub(1)
                };
                match (number('S'), number('E')) {
                    (Some(k), _) => FACES.get(k).map(|face| Side::Face(*face)),
                    (_, Some(k)) if k < 4 => Some(Side::Edge(k as u8)),
                    _ => None,
                }
            }
        });
        let mut entry = Entry::new(reference(&field), &field, super::raw::NONE);
        // Surfaces of shells may leave it out; solids are told where they miss it.
        entry.side = parsed.unwrap_or(Side::None);
        if let (Some(side), Side::None) = (side, entry.side) {
            entry.line = side.line as u32;
            entry.column = side.column as u32;
            if !side.text.is_empty() {
                return Err(side.syntax(self.path, "a face from S1 to S6"));
            }
        }
        self.scope().surfaces.get(name).entries.push(entry);
        Ok(())
    }
}

/// A number, or a name.
fn reference(field: &Field) -> Reference {
    match field.text.parse() {
        Ok(number) => Reference::Number(number),
        Err(_) => Reference::Name(field.text.trim_matches('"').into()),
    }
}

/// The name of a set.
fn spell(path: &Path, field: Field) -> Result<String, MeshError> {
    // Every line of the set looks it up.
    if field.text.len() > MOST_IN_NAME {
        let expected = format!("a name of at most {MOST_IN_NAME} bytes");
        return Err(field.syntax(path, &expected));
    }
    Ok(field.text.to_string())
}
