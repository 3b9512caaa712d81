//! Reader of Nastran's bulk data, of the part that describes a mesh: GRID, CQUAD4, CTRIA3 and their quadratic relatives,
//! CHEXA (MSC Nastran quick reference guide, "Bulk data entries"). The elements of property `n` are the set `property_n`.
mod cards;

use super::MeshError;
use super::error::{MAX_NODES, listed, shorten};
use super::field::Field;
use super::quadratic::PLACES;
use super::raw::{NONE, RawMesh};
use cards::{Card, cards, real};
use covact_geometry::Vec3;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::path::Path;

/// Nodes are numbered around the faces; tensor node `a` is file node `TENSOR[a]`.
const TENSOR: [usize; 8] = [0, 1, 3, 2, 4, 5, 7, 6];
const ELEMENTS: &str =
    "elements of surfaces are CQUAD4, CTRIA3, CQUAD8 and CTRIA6, solid elements are CHEXA";

/// Everything of use in a file.
pub(super) fn parse(bytes: &[u8], path: &Path) -> Result<RawMesh, MeshError> {
    let text = String::from_utf8_lossy(bytes);
    let cards = cards(&text);
    let mut reader = Reader {
        path,
        raw: RawMesh {
            help: ELEMENTS,
            ..RawMesh::default()
        },
        nodes: HashMap::new(),
        elements: HashSet::new(),
        types: BTreeMap::new(),
        skipped: BTreeSet::new(),
    };
    // Cards stand in any order: nodes first.
    for card in cards.iter().filter(|c| c.name == "GRID") {
        reader.grid(card)?;
    }
    for card in &cards {
        reader.card(card)?;
    }
    let Reader {
        mut raw,
        types,
        skipped,
        ..
    } = reader;
    raw.found = types
        .iter()
        .map(|(name, n)| format!("{n} {name}"))
        .collect();
    if !skipped.is_empty() {
        raw.notes
            .push(format!("cards left out: {}", listed(&skipped)));
    }
    Ok(raw)
}

struct Reader<'a> {
    path: &'a Path,
    raw: RawMesh,
    nodes: HashMap<u64, u32>,
    /// Numbers of the elements.
    elements: HashSet<u64>,
    /// Elements of the file by type.
    types: BTreeMap<String, usize>,
    skipped: BTreeSet<String>,
}

impl Reader<'_> {
    /// A field of a card, empty where the card ends before it.
    fn field<'c>(card: &Card<'c>, k: usize) -> Field<'c> {
        let missing = Field {
            text: "",
            ..card.at
        };
        card.fields.get(k).copied().unwrap_or(missing)
    }

    fn grid(&mut self, card: &Card) -> Result<(), MeshError> {
        let field = |k| Reader::field(card, k);
        let tag = field(0).integer(self.path, "the number of a node")?;
        self.system(card)?;
        let mut x = Vec3::zeros();
        for (k, value) in x.iter_mut().enumerate() {
            let field = field(2 + k);
            // An empty field is zero.
            if !field.text.is_empty() {
                let number = real(field.text);
                *value = number.ok_or_else(|| field.syntax(self.path, "a coordinate"))?;
            }
        }
        let index = self.raw.nodes.len() as u32;
        if u64::from(index) >= MAX_NODES {
            return Err(MeshError::TooManyNodes {
                what: "bulk data file",
                nodes: u128::from(index) + 1,
            });
        }
        if self.nodes.insert(tag, index).is_some() {
            return Err(field(0).syntax(self.path, "a node number used once"));
        }
        self.raw.nodes.push(x);
        self.raw.node_tags.push(tag);
        Ok(())
    }

    /// Nodes lie in the basic coordinate system.
    fn system(&self, card: &Card) -> Result<(), MeshError> {
        let system = Reader::field(card, 1);
        if matches!(system.text, "" | "0") {
            return Ok(());
        }
        let what = format!("a node in the coordinate system {}", shorten(system.text));
        let help = "write all nodes in the basic system";
        Err(system.unsupported(self.path, what, help))
    }

    fn card(&mut self, card: &Card) -> Result<(), MeshError> {
        let (corners, most) = match card.name.as_str() {
            "GRID" => return Ok(()),
            "GRDSET" => return self.system(card),
            "CQUAD4" | "CQUADR" => (4, 4),
            "CTRIA3" | "CTRIAR" => (3, 3),
            "CQUAD8" => (4, 8),
            "CQUAD" => (4, 9),
            "CTRIA6" => (3, 6),
            "CHEXA" => (8, 20),
            "CTETRA" | "CPENTA" | "CPYRAM" | "CPYRA" => {
                let refused = card.at.unsupported(self.path, card.name.clone(), ELEMENTS);
                self.raw.refused.get_or_insert(refused);
                self.count(card);
                return Ok(());
            }
            "INCLUDE" => {
                let help = "put the included text into this file";
                return Err(card.at.unsupported(self.path, "INCLUDE".to_string(), help));
            }
            name => {
                // Other cards that begin with C and hold nodes are elements too, but of no use here.
                self.skipped.insert(shorten(name));
                return Ok(());
            }
        };
        self.count(card);
        let tag = Reader::field(card, 0).integer(self.path, "the number of an element")?;
        if !self.elements.insert(tag) {
            let field = Reader::field(card, 0);
            return Err(field.syntax(self.path, "an element number used once"));
        }
        let property = Reader::field(card, 1);
        let property = match property.text.is_empty() {
            // It is then the element's own number, which gives no set.
            true => None,
            false => Some(property.integer(self.path, "the number of a property")?),
        };
        let mut nodes = Vec::with_capacity(most);
        for k in 0..most {
            let field = Reader::field(card, 2 + k);
            if field.text.is_empty() && k >= corners {
                // Nodes in the middle of edges may be left out.
                nodes.push(NONE);
                continue;
            }
            let expected = format!("{corners} nodes of element {tag}");
            let node = field.integer(self.path, &expected)?;
            let Some(&index) = self.nodes.get(&node) else {
                let found = format!("node {node} in element {tag}");
                let expected = "the number of a node of this file";
                return Err(field.syntax_found(self.path, expected, &found));
            };
            nodes.push(index);
        }
        while nodes.last() == Some(&NONE) {
            nodes.pop();
        }
        self.element(card, tag, property, &nodes, corners)
    }

    fn element(
        &mut self,
        card: &Card,
        tag: u64,
        property: Option<u64>,
        nodes: &[u32],
        corners: usize,
    ) -> Result<(), MeshError> {
        let raw = &mut self.raw;
        let set = property.map(|p| format!("property_{p}"));
        if corners < 8 {
            // Where only some of the middle nodes are there, the corners are used.
            let whole = !nodes.contains(&NONE) && matches!(nodes.len(), 3 | 4 | 6 | 8 | 9);
            let nodes = if whole { nodes } else { &nodes[..corners] };
            let facet = raw.facets.push(nodes, tag);
            if let Some(set) = set {
                raw.facets.sets.entry(set).or_default().push(facet);
            }
            return Ok(());
        }
        let quadratic = nodes.len() == 20 && !nodes.contains(&NONE);
        let other = raw.quadratic.len() != raw.hexahedra.len() * usize::from(quadratic);
        if other || !(quadratic || nodes.len() == 8) {
            let what = format!("element {tag} with {} nodes beside others", nodes.len());
            let help = "give all CHEXA 8 nodes, or all 20";
            let refused = card.at.unsupported(self.path, what, help);
            raw.refused.get_or_insert(refused);
            return Ok(());
        }
        if quadratic {
            let mut tensor = [NONE; 27];
            // The edges through the thickness stand before those of the top.
            let order = (0..12).chain(16..20).chain(12..16);
            order.zip(nodes).for_each(|(k, &n)| tensor[PLACES[k]] = n);
            raw.quadratic.push(tensor);
        }
        raw.hexahedra.push(TENSOR.map(|a| nodes[a]));
        raw.element_tags.push(tag);
        if let Some(set) = set {
            let element = raw.hexahedra.len() as u32 - 1;
            raw.solid_sets.entry(set).or_default().push(element);
        }
        Ok(())
    }

    fn count(&mut self, card: &Card) {
        *self.types.entry(card.name.clone()).or_default() += 1;
    }
}
