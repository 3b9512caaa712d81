//! Reader of Abaqus' and CalculiX' input files, of the part that describes a mesh: `*NODE`, `*ELEMENT` (C3D8 and its
//! relatives, SC8R, C3D27), `*NSET`, `*ELSET`, `*SURFACE, TYPE=ELEMENT` (Abaqus keywords reference; CalculiX manual, ch. 7).
//!
//! Quadrilaterals (S4, CPS4, M3D4, ...) stand for faces: an element set of them becomes a face set, which is how gmsh
//! writes physical surfaces. As in CalculiX, what a line refers to stands above it.
mod lines;
mod quadratic;

use super::error::{MAX_NODES, MOST_IN_NAME, listed, most_members, shorten};
use super::raw::RawMesh;
use super::{Face, Mesh, MeshError, MeshReport};
use covact_geometry::Vec3;
use lines::{Field, Keyword, fields};
use quadratic::tensor_27;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::Path;

/// Nodes are numbered around the faces; tensor node `a` is file node `TENSOR[a]`.
const TENSOR: [usize; 8] = [0, 1, 3, 2, 4, 5, 7, 6];
/// Local faces of the file's faces S1 to S6.
const FACES: [u8; 6] = [4, 5, 2, 1, 3, 0];
const SOLIDS: [&str; 6] = ["C3D8", "C3D8I", "C3D8R", "C3D8H", "C3D8RH", "SC8R"];
const QUADRATIC_SOLIDS: [&str; 4] = ["C3D27", "C3D27H", "C3D27R", "C3D27RH"];
const QUADRILATERALS: [&str; 9] = [
    "S4", "S4R", "CPS4", "CPS4R", "CPE4", "CPE4R", "M3D4", "M3D4R", "SFM3D4",
];
const QUADRATIC_QUADRILATERALS: [&str; 3] = ["S9R5", "M3D9", "M3D9R"];
const ELEMENTS: &str =
    "solid elements are C3D8, C3D8I, C3D8R and SC8R, of 8 nodes, and C3D27 of 27";
const SERENDIPITY: &str = "it has no nodes in the middle of its faces; use C3D27 with all 27 nodes (element `q18`) or C3D8 \
                           (element `h8`)";
const FLAT: &str = "write a flat file: in Abaqus/CAE, Model > Edit Attributes > `Do not use parts and assemblies in \
                    input files`";

/// Reads the mesh from the bytes of a file; `path` is for messages, `scale` multiplies every coordinate.
pub fn read_inp(bytes: &[u8], path: &Path, scale: f64) -> Result<(Mesh, MeshReport), MeshError> {
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
    reader.finish()?.into_mesh(scale)
}

/// An element of the file.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Item {
    /// Index into the hexahedra.
    Solid(u32),
    /// Index into the quadrilaterals.
    Quad(u32),
}

/// What the data lines below a keyword mean.
enum Mode {
    Skip,
    /// Of a node set.
    Node(Option<String>),
    Element {
        nodes: usize,
        given: bool,
        set: Option<String>,
    },
    NodeSet {
        set: String,
        generate: bool,
    },
    ElementSet {
        set: String,
        generate: bool,
    },
    Surface(String),
}

struct Reader<'a> {
    path: &'a Path,
    raw: RawMesh,
    nodes: HashMap<u64, u32>,
    items: HashMap<u64, Item>,
    quads: Vec<[u32; 4]>,
    element_sets: BTreeMap<String, BTreeSet<Item>>,
    /// Spelling of every set by its name in capitals: names do not depend on case.
    spelling: BTreeMap<String, String>,
    mode: Mode,
    /// Numbers of an element that goes on in the next line; the place of the first.
    pending: Vec<u64>,
    last: (usize, usize),
    /// Element types and keywords that were passed over.
    types: BTreeSet<String>,
    skipped: BTreeSet<String>,
    /// Members of sets so far, and numbers looked at to find them.
    members: u64,
}

impl<'a> Reader<'a> {
    /// Counts members of sets.
    fn grow(&mut self, members: usize) -> Result<(), MeshError> {
        self.members += members as u64;
        let most = most_members(self.nodes.len(), self.items.len());
        match self.members > most {
            true => Err(MeshError::LongSets {
                path: self.path.to_path_buf(),
                most,
            }),
            false => Ok(()),
        }
    }

    fn new(path: &'a Path) -> Reader<'a> {
        Reader {
            path,
            raw: RawMesh::default(),
            nodes: HashMap::new(),
            items: HashMap::new(),
            quads: Vec::new(),
            element_sets: BTreeMap::new(),
            spelling: BTreeMap::new(),
            mode: Mode::Skip,
            pending: Vec::new(),
            last: (1, 1),
            types: BTreeSet::new(),
            skipped: BTreeSet::new(),
            members: 0,
        }
    }

    fn keyword(&mut self, keyword: &Keyword) -> Result<(), MeshError> {
        self.complete()?;
        let path = self.path;
        let name = |parameter: &str| match keyword.get(parameter) {
            Some(field) if !field.text.is_empty() => Ok(field),
            _ => {
                let expected = format!("{} with {parameter}=name", keyword.name);
                Err(keyword.at.syntax(path, &expected))
            }
        };
        let generate = keyword.get("GENERATE").is_some();
        if let (Some(file), true) = (keyword.get("INPUT"), keyword.name != "*INCLUDE") {
            let keyword = shorten(&keyword.name);
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
                Mode::Node(keyword.get("NSET").map(|f| self.spell(f)).transpose()?)
            }
            "*ELEMENT" => {
                let field = name("TYPE")?;
                let set = keyword.get("ELSET").map(|f| self.spell(f)).transpose()?;
                self.elements(field, set)?
            }
            "*NSET" => Mode::NodeSet {
                set: self.spell(name("NSET")?)?,
                generate,
            },
            "*ELSET" => Mode::ElementSet {
                set: self.spell(name("ELSET")?)?,
                generate,
            },
            "*SURFACE" => {
                let set = self.spell(name("NAME")?)?;
                match keyword.get("TYPE") {
                    Some(t) if !t.text.eq_ignore_ascii_case("ELEMENT") => {
                        self.raw.notes.push(format!(
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
            "*PART" | "*INSTANCE" | "*ASSEMBLY" => {
                return Err(keyword.at.unsupported(path, keyword.name.clone(), FLAT));
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

    fn elements(&mut self, field: Field, set: Option<String>) -> Result<Mode, MeshError> {
        let kind = field.text.to_uppercase();
        if SOLIDS.contains(&kind.as_str()) {
            return Ok(Mode::Element {
                nodes: 8,
                given: kind == "SC8R",
                set,
            });
        }
        let nodes = if QUADRATIC_SOLIDS.contains(&kind.as_str()) {
            27
        } else if QUADRILATERALS.contains(&kind.as_str()) {
            4
        } else if QUADRATIC_QUADRILATERALS.contains(&kind.as_str()) {
            9
        } else {
            0
        };
        if nodes > 0 {
            return Ok(Mode::Element {
                nodes,
                given: false,
                set,
            });
        }
        if kind.starts_with("C3D20") {
            let what = format!("element type {}", shorten(&kind));
            return Err(field.unsupported(self.path, what, SERENDIPITY));
        }
        if kind.starts_with("C3D") || kind.starts_with("SC") {
            let what = format!("element type {}", shorten(&kind));
            return Err(field.unsupported(self.path, what, ELEMENTS));
        }
        self.types.insert(kind);
        Ok(Mode::Skip)
    }

    /// First spelling of a set's name.
    fn spell(&mut self, field: Field) -> Result<String, MeshError> {
        let name = field.text;
        // Every line of the set looks it up.
        if name.len() > MOST_IN_NAME {
            let expected = format!("a name of at most {MOST_IN_NAME} bytes");
            return Err(field.syntax(self.path, &expected));
        }
        let spelling = self.spelling.entry(name.to_uppercase());
        Ok(spelling.or_insert_with(|| name.to_string()).clone())
    }

    /// Known set that a data line names.
    fn named(&self, text: &str) -> Option<&String> {
        self.spelling.get(&text.trim_matches('"').to_uppercase())
    }

    /// An element whose line ended too early.
    fn complete(&mut self) -> Result<(), MeshError> {
        let Mode::Element { nodes, .. } = self.mode else {
            return Ok(());
        };
        if self.pending.is_empty() {
            return Ok(());
        }
        let field = Field {
            text: "",
            line: self.last.0,
            column: self.last.1,
        };
        let expected = format!("{nodes} nodes of element {}", self.pending[0]);
        let found = format!("{}", self.pending.len() - 1);
        Err(field.syntax_found(self.path, &expected, &found))
    }

    fn data(&mut self, line: &str, number: usize) -> Result<(), MeshError> {
        let mode = std::mem::replace(&mut self.mode, Mode::Skip);
        let list = fields(line, number);
        match &mode {
            Mode::Skip => {}
            Mode::Node(set) => self.node(list, set.as_deref())?,
            Mode::Element { nodes, given, set } => {
                for field in list {
                    self.element_number(field, *nodes, *given, set.as_deref())?;
                }
            }
            Mode::NodeSet { set, generate } => {
                let mut found = self.raw.node_sets.remove(set).unwrap_or_default();
                for (tag, field) in self.numbers(list, *generate)? {
                    let before = found.len();
                    match tag.and_then(|tag| self.nodes.get(&tag)) {
                        Some(&node) => found.push(node),
                        None => match self.named(field.text).map(|s| self.raw.node_sets.get(s)) {
                            Some(Some(other)) => found.extend(other),
                            _ => return Err(self.not_above(field, tag, "node")),
                        },
                    }
                    self.grow(found.len() - before)?;
                }
                self.raw.node_sets.insert(set.clone(), found);
            }
            Mode::ElementSet { set, generate } => {
                let mut found = self.element_sets.remove(set).unwrap_or_default();
                for (tag, field) in self.numbers(list, *generate)? {
                    let mut others = 1;
                    match tag.map(|tag| self.items.get(&tag)) {
                        Some(Some(&item)) => {
                            found.insert(item);
                        }
                        // A number of an element that was passed over.
                        Some(None) if !self.types.is_empty() => {}
                        _ => match self.named(field.text).map(|s| self.element_sets.get(s)) {
                            Some(Some(other)) => {
                                others = other.len();
                                found.extend(other);
                            }
                            _ => return Err(self.not_above(field, tag, "element")),
                        },
                    }
                    self.grow(others)?;
                }
                self.element_sets.insert(set.clone(), found);
            }
            Mode::Surface(set) => self.surface(list, set)?,
        }
        self.mode = mode;
        Ok(())
    }

    fn not_above(&self, field: Field, tag: Option<u64>, kind: &str) -> MeshError {
        let expected = format!("the number or set of {kind}s that stand above");
        let found = tag.map_or(field.text.to_string(), |tag| format!("{kind} {tag}"));
        field.syntax_found(self.path, &expected, &found)
    }

    /// Numbers of a line of a set: as they are, or `first, last, step`. A name has no number.
    fn numbers<'l>(
        &mut self,
        mut list: impl Iterator<Item = Field<'l>>,
        generate: bool,
    ) -> Result<Vec<(Option<u64>, Field<'l>)>, MeshError> {
        if !generate {
            let kept = list.filter(|f| !f.text.is_empty());
            return Ok(kept.map(|f| (f.text.parse().ok(), f)).collect());
        }
        let Some(field) = list.next() else {
            return Ok(Vec::new());
        };
        let first = field.integer(self.path, "the first number")?;
        let last = match list.next() {
            Some(f) => f.integer(self.path, "the last number")?,
            None => first,
        };
        let step = match list.next() {
            Some(f) => f.integer(self.path, "the step between numbers")?,
            None => 1,
        };
        let most = (self.nodes.len() + self.items.len()) as u64;
        if step == 0 || last < first || ((last - first) / step > most && self.types.is_empty()) {
            let expected = "first <= last, a step of at least 1, and numbers that stand above";
            let found = format!("{first}, {last}, {step}");
            return Err(field.syntax_found(self.path, expected, &found));
        }
        // Looking a number up costs less than keeping it.
        self.grow((((last - first) / step).min(most) / 8) as usize)?;
        // Numbers of passed-over elements are not known, so only those that exist are taken.
        let known = |tag: &u64| {
            self.types.is_empty() || self.items.contains_key(tag) || self.nodes.contains_key(tag)
        };
        if (last - first) / step > most {
            let all = self.nodes.keys().chain(self.items.keys()).copied();
            let mut tags: Vec<u64> = all
                .filter(|t| (first..=last).contains(t) && (t - first) % step == 0)
                .collect();
            tags.sort_unstable();
            tags.dedup();
            return Ok(tags.into_iter().map(|tag| (Some(tag), field)).collect());
        }
        let tags = (0..=(last - first) / step).map(|i| first + i * step);
        Ok(tags.filter(known).map(|tag| (Some(tag), field)).collect())
    }

    fn node<'l>(
        &mut self,
        mut list: impl Iterator<Item = Field<'l>>,
        set: Option<&str>,
    ) -> Result<(), MeshError> {
        let Some(field) = list.next() else {
            return Ok(());
        };
        let tag = field.integer(self.path, "a node number")?;
        let mut x = [0.0; 3];
        for (value, field) in x.iter_mut().zip(list) {
            // An empty entry is zero.
            if !field.text.is_empty() {
                *value = field.real(self.path, "a coordinate")?;
            }
        }
        let index = self.raw.nodes.len() as u32;
        if u64::from(index) >= MAX_NODES {
            return Err(MeshError::TooManyNodes {
                what: "input file",
                nodes: u128::from(index) + 1,
            });
        }
        if self.nodes.insert(tag, index).is_some() {
            return Err(field.syntax(self.path, "a node number used once"));
        }
        self.raw.nodes.push(Vec3::from(x));
        self.raw.node_tags.push(tag);
        if let Some(set) = set {
            self.raw
                .node_sets
                .entry(set.to_string())
                .or_default()
                .push(index);
        }
        Ok(())
    }

    fn element_number(
        &mut self,
        field: Field,
        nodes: usize,
        given: bool,
        set: Option<&str>,
    ) -> Result<(), MeshError> {
        self.last = (field.line, field.column);
        if self.pending.is_empty() {
            let tag = field.integer(self.path, "an element number")?;
            if self.items.contains_key(&tag) {
                return Err(field.syntax(self.path, "an element number used once"));
            }
            self.pending.push(tag);
            return Ok(());
        }
        let tag = field.integer(self.path, "a node number")?;
        let Some(&node) = self.nodes.get(&tag) else {
            return Err(self.not_above(field, Some(tag), "node"));
        };
        self.pending.push(u64::from(node));
        if self.pending.len() < nodes + 1 {
            return Ok(());
        }
        let tag = self.pending[0];
        let node = |a: usize| self.pending[a + 1] as u32;
        let item = if nodes == 8 || nodes == 27 {
            let all = self.raw.hexahedra.len() * usize::from(nodes == 27);
            if self.raw.quadratic.len() != all {
                let expected = "elements of 8 or of 27 nodes, not both";
                return Err(field.syntax(self.path, expected));
            }
            if nodes == 27 {
                let all = std::array::from_fn(node);
                let Some(tensor) = tensor_27(&all, &self.raw.nodes) else {
                    let expected =
                        format!("the nodes of element {tag} within its faces and its middle");
                    return Err(field.syntax(self.path, &expected));
                };
                self.raw.quadratic.push(tensor);
            }
            self.raw.hexahedra.push(TENSOR.map(node));
            self.raw.element_tags.push(tag);
            self.raw.thickness_is_given.push(given);
            Item::Solid(self.raw.hexahedra.len() as u32 - 1)
        } else {
            self.quads.push([0, 1, 2, 3].map(node));
            Item::Quad(self.quads.len() as u32 - 1)
        };
        self.pending.clear();
        self.items.insert(tag, item);
        if let Some(set) = set {
            self.element_sets
                .entry(set.to_string())
                .or_default()
                .insert(item);
        }
        Ok(())
    }

    /// `element or element set, S1 to S6`.
    fn surface<'l>(
        &mut self,
        mut list: impl Iterator<Item = Field<'l>>,
        set: &str,
    ) -> Result<(), MeshError> {
        let Some(field) = list.next() else {
            return Ok(());
        };
        let tag = field.text.parse::<u64>().ok();
        let items: Vec<Item> = match tag.and_then(|tag| self.items.get(&tag)) {
            Some(&item) => vec![item],
            None => match self.named(field.text).map(|s| self.element_sets.get(s)) {
                Some(Some(items)) => items.iter().copied().collect(),
                _ => return Err(self.not_above(field, tag, "element")),
            },
        };
        let side = list.next();
        let face = side.and_then(|s| match s.text.to_uppercase().as_str() {
            "SNEG" => Some(FACES[0]),
            "SPOS" => Some(FACES[1]),
            other => {
                let number = other.strip_prefix('S')?.parse::<usize>().ok()?;
                FACES.get(number.checked_sub(1)?).copied()
            }
        });
        self.grow(items.len())?;
        for item in items {
            match (item, face) {
                (Item::Solid(element), Some(face)) => {
                    let faces = self.raw.face_sets.entry(set.to_string()).or_default();
                    faces.push(Face { element, face });
                }
                (Item::Solid(_), None) => {
                    let expected = "a face from S1 to S6";
                    return Err(side.unwrap_or(field).syntax(self.path, expected));
                }
                (Item::Quad(quad), _) => {
                    let quads = self.raw.surfaces.entry(set.to_string()).or_default();
                    quads.push(self.quads[quad as usize]);
                }
            }
        }
        Ok(())
    }

    fn finish(mut self) -> Result<RawMesh, MeshError> {
        if self.raw.hexahedra.is_empty() {
            let mut found = self.types.clone();
            if !self.quads.is_empty() {
                found.insert("quadrilaterals".to_string());
            }
            return Err(MeshError::NoElements {
                path: self.path.to_path_buf(),
                found: if found.is_empty() {
                    "none".to_string()
                } else {
                    listed(&found)
                },
                help: ELEMENTS.to_string(),
            });
        }
        for (name, items) in &self.element_sets {
            if items.is_empty() {
                self.raw.notes.push(format!(
                    "set `{name}` holds no solid or quadrilateral elements"
                ));
                continue;
            }
            let nodes = self.raw.node_sets.entry(name.clone()).or_default();
            for item in items {
                match *item {
                    Item::Solid(e) => match self.raw.quadratic.get(e as usize) {
                        Some(all) => nodes.extend(all),
                        None => nodes.extend(self.raw.hexahedra[e as usize]),
                    },
                    Item::Quad(q) => {
                        let quad = self.quads[q as usize];
                        nodes.extend(quad);
                        self.raw
                            .surfaces
                            .entry(name.clone())
                            .or_default()
                            .push(quad);
                    }
                }
            }
            // Neighbours share nodes; there may be many sets.
            nodes.sort_unstable();
            nodes.dedup();
            nodes.shrink_to_fit();
        }
        if !self.types.is_empty() {
            self.raw
                .notes
                .push(format!("elements left out: {}", listed(&self.types)));
        }
        if !self.skipped.is_empty() {
            self.raw
                .notes
                .push(format!("keywords left out: {}", listed(&self.skipped)));
        }
        Ok(self.raw)
    }
}
