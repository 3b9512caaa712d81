//! Representations, how they hang together, and where their items stand: products, occurrences in assemblies, mapped items.

use super::entity::{Entity, Told};
use super::exchange::Exchange;
use super::place::{Placement, frame, transformation};
use super::schema::is_a;
use super::units::Units;
use std::collections::{HashMap, HashSet};
use std::rc::Rc;

/// A representation with what its numbers mean.
pub struct Representation {
    /// Its number.
    pub index: u32,
    pub items: Vec<u32>,
    /// Those that are no placements and no copies of other representations.
    pub bodies: Vec<u32>,
    /// Index of its units among those of the file.
    pub units: usize,
}

/// A copy of the items of one representation in another.
pub struct Link {
    pub parent: usize,
    pub child: usize,
    pub map: Placement,
    /// The occurrence or mapped item.
    pub instance: u32,
}

/// All shape representations of a file.
pub struct Assembly {
    pub representations: Vec<Representation>,
    pub units: Vec<Units>,
    /// The units that lengths of the file are given in.
    pub main: usize,
    /// The set of representations that each belongs to: those of one product.
    pub group: Vec<usize>,
    /// Names of the products.
    pub names: Vec<Option<Rc<str>>>,
    pub links: Vec<Link>,
}

impl Assembly {
    pub fn read(exchange: &Exchange, notes: &mut Vec<String>) -> Self {
        let mut assembly = Self {
            representations: Vec::new(),
            units: vec![Units::default()],
            main: 0,
            group: Vec::new(),
            names: Vec::new(),
            links: Vec::new(),
        };
        let mut tell = |error: String| {
            if !notes.contains(&error) {
                notes.push(error);
            }
        };
        let mut relations = Vec::new();
        let mut definitions = Vec::new();
        let mut occurrences = Vec::new();
        let mut numbers = HashMap::new();
        let mut contexts = HashMap::new();
        for index in 0..exchange.len() as u32 {
            let keywords = exchange.keywords(index);
            let is = |kind: &str| keywords.iter().any(|k| is_a(k, kind));
            // Curves in parameter planes stand in representations of their own.
            if is("REPRESENTATION") && !is("DEFINITIONAL_REPRESENTATION") {
                match assembly.representation(exchange, index, &mut contexts) {
                    Ok(()) => {
                        numbers.insert(index, assembly.representations.len() - 1);
                    }
                    Err(error) => tell(error),
                }
            }
            if is("REPRESENTATION_RELATIONSHIP") {
                relations.push(index);
            }
            if is("SHAPE_DEFINITION_REPRESENTATION") {
                definitions.push(index);
            }
            if is("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION") {
                occurrences.push(index);
            }
        }
        assembly.group = (0..assembly.representations.len()).collect();
        assembly.names = vec![None; assembly.representations.len()];
        assembly.choose_units();
        assembly.join(exchange, &relations, &numbers, &mut tell);
        let products = assembly.products(exchange, &definitions, &numbers);
        let mut placed = HashSet::new();
        for occurrence in occurrences {
            match assembly.occurrence(exchange, occurrence, &numbers, &products) {
                Ok(relation) => {
                    placed.insert(relation);
                }
                Err(error) => tell(error),
            }
        }
        for relation in relations {
            if !placed.contains(&relation)
                && let Err(error) = assembly.relation(exchange, relation, &numbers)
            {
                tell(error);
            }
        }
        assembly.mapped(exchange, &numbers, &mut tell);
        assembly
    }

    fn representation(
        &mut self,
        exchange: &Exchange,
        index: u32,
        contexts: &mut HashMap<u32, usize>,
    ) -> Told<()> {
        let entity = Entity::read(exchange, index)?;
        let kind = "REPRESENTATION";
        let items = entity.targets(kind, 1, "an item of a representation")?;
        let context = entity.reference(kind, 2, "the context of a representation")?;
        let units = match contexts.get(&context) {
            Some(&units) => units,
            None => {
                let units = Units::of(exchange, context)?;
                let at = match self.units.iter().position(|u| *u == units) {
                    Some(at) => at,
                    None => {
                        self.units.push(units);
                        self.units.len() - 1
                    }
                };
                contexts.insert(context, at);
                at
            }
        };
        let mut bodies = items.clone();
        bodies.retain(|&item| {
            let keywords = exchange.keywords(item);
            let is = |kind: &str| keywords.iter().any(|k| is_a(k, kind));
            !(is("PLACEMENT") || is("MAPPED_ITEM"))
        });
        self.representations.push(Representation {
            index,
            items,
            bodies,
            units,
        });
        Ok(())
    }

    /// The file's unit is that of the first representation that has one of lengths and more than one item, or any.
    fn choose_units(&mut self) {
        let stated = |r: &&Representation| self.units[r.units].length.to_metre.is_some();
        let found = self.representations.iter().filter(stated);
        let longest = found.reduce(|a, b| {
            if b.items.len() > 1 && a.items.len() <= 1 {
                b
            } else {
                a
            }
        });
        self.main = longest.map_or(0, |r| r.units);
    }

    /// Factor from lengths of a representation to those of the file.
    pub fn factor(&self, representation: usize) -> f64 {
        let own = &self.units[self.representations[representation].units].length;
        own.factor_to(&self.units[self.main].length).unwrap_or(1.0)
    }

    /// Unites representations that a relationship without a transformation says to be of one shape.
    fn join(
        &mut self,
        exchange: &Exchange,
        relations: &[u32],
        numbers: &HashMap<u32, usize>,
        tell: &mut impl FnMut(String),
    ) {
        for &index in relations {
            let read = || -> Told<Option<[u32; 2]>> {
                let entity = Entity::read(exchange, index)?;
                let transformed = entity.is("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION");
                if transformed || !entity.is("SHAPE_REPRESENTATION_RELATIONSHIP") {
                    return Ok(None);
                }
                related(&entity).map(Some)
            };
            match read() {
                Ok(Some(pair)) => {
                    if let [Some(&a), Some(&b)] = pair.map(|r| numbers.get(&r)) {
                        let (a, b) = (self.root(a), self.root(b));
                        self.group[a.max(b)] = a.min(b);
                    }
                }
                Ok(None) => {}
                Err(error) => tell(error),
            }
        }
        for k in 0..self.group.len() {
            self.group[k] = self.root(k);
        }
    }

    fn root(&self, mut k: usize) -> usize {
        while self.group[k] != k {
            k = self.group[k];
        }
        k
    }

    /// The groups of representations of each product definition; names the groups.
    fn products(
        &mut self,
        exchange: &Exchange,
        definitions: &[u32],
        numbers: &HashMap<u32, usize>,
    ) -> HashMap<u32, Vec<usize>> {
        let mut products: HashMap<u32, Vec<usize>> = HashMap::new();
        for &index in definitions {
            let read = || -> Told<(u32, u32)> {
                let entity = Entity::read(exchange, index)?;
                let kind = "PROPERTY_DEFINITION_REPRESENTATION";
                let shape = entity.member(kind, 0, "PROPERTY_DEFINITION", "a shape")?;
                let product = shape.reference("PROPERTY_DEFINITION", 2, "a product definition")?;
                Ok((product, entity.reference(kind, 1, "a representation")?))
            };
            // Shapes of parts of products are no concern here.
            let Ok((product, representation)) = read() else {
                continue;
            };
            let Some(&number) = numbers.get(&representation) else {
                continue;
            };
            let group = self.group[number];
            products.entry(product).or_default().push(group);
            if let Ok(name) = product_name(exchange, product) {
                self.names[group] = self.names[group].take().or(name.map(Rc::from));
            }
        }
        products
    }

    /// A CONTEXT_DEPENDENT_SHAPE_REPRESENTATION: an occurrence of a product in another; returns its relationship.
    fn occurrence(
        &mut self,
        exchange: &Exchange,
        index: u32,
        numbers: &HashMap<u32, usize>,
        products: &HashMap<u32, Vec<usize>>,
    ) -> Told<u32> {
        let entity = Entity::read(exchange, index)?;
        let kind = "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION";
        let wanted = "REPRESENTATION_RELATIONSHIP";
        let relation = entity.member(kind, 0, wanted, "a relationship of representations")?;
        let shape = entity.member(kind, 1, "PROPERTY_DEFINITION", "an occurrence")?;
        let usage = shape.reference("PROPERTY_DEFINITION", 2, "an occurrence of a product")?;
        let usage = Entity::read(exchange, usage)?;
        let child = usage.reference("PRODUCT_DEFINITION_RELATIONSHIP", 4, "a component")?;
        let pair = self.pair(&relation, numbers)?;
        let own = |k: usize| {
            products
                .get(&child)
                .is_some_and(|g| g.contains(&self.group[pair[k]]))
        };
        // The component comes first, but for writers that turn both round.
        let swapped = !own(0) && own(1);
        let map = self.relative(exchange, &relation, pair, swapped)?;
        let [child, parent] = if swapped { [pair[1], pair[0]] } else { pair };
        let (parent, child) = (self.group[parent], self.group[child]);
        self.links.push(Link {
            parent,
            child,
            map,
            instance: usage.index,
        });
        Ok(relation.index)
    }

    /// A relationship with a transformation that no occurrence refers to.
    fn relation(
        &mut self,
        exchange: &Exchange,
        index: u32,
        numbers: &HashMap<u32, usize>,
    ) -> Told<()> {
        let entity = Entity::read(exchange, index)?;
        if !entity.is("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION") {
            return Ok(());
        }
        let pair = self.pair(&entity, numbers)?;
        let map = self.relative(exchange, &entity, pair, false)?;
        self.links.push(Link {
            parent: self.group[pair[1]],
            child: self.group[pair[0]],
            map,
            instance: index,
        });
        Ok(())
    }

    fn pair(&self, relation: &Entity, numbers: &HashMap<u32, usize>) -> Told<[usize; 2]> {
        let [a, b] = related(relation)?.map(|r| numbers.get(&r).copied());
        match (a, b) {
            (Some(a), Some(b)) => Ok([a, b]),
            _ => Err(format!("{} relates what is no shape", relation.describe())),
        }
    }

    /// The placement of the first representation of a pair in the second, or the other way round.
    fn relative(
        &self,
        exchange: &Exchange,
        relation: &Entity,
        pair: [usize; 2],
        swapped: bool,
    ) -> Told<Placement> {
        let kind = "REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION";
        if !relation.is(kind) {
            return Ok(Placement::identity());
        }
        let operator = relation.reference(kind, 0, "a transformation")?;
        let operator = Entity::read(exchange, operator)?;
        let map = if operator.is("ITEM_DEFINED_TRANSFORMATION") {
            let one = |k: usize| -> Told<Placement> {
                let what = "an item of a transformation";
                let item = operator.reference("ITEM_DEFINED_TRANSFORMATION", 2 + k, what)?;
                let mut map = frame(exchange, item)?.placement();
                map.shift *= self.factor(pair[k]);
                Ok(map)
            };
            let back = one(0)?.inverse().ok_or("a placement is singular")?;
            one(1)?.after(&back)
        } else {
            let mut map = transformation(exchange, operator.index)?;
            map.shift *= self.factor(pair[1]);
            map
        };
        match swapped {
            false => Ok(map),
            true => map
                .inverse()
                .ok_or_else(|| "a placement is singular".to_owned()),
        }
    }

    /// Mapped items: copies of representations as items of others.
    fn mapped(
        &mut self,
        exchange: &Exchange,
        numbers: &HashMap<u32, usize>,
        tell: &mut impl FnMut(String),
    ) {
        let mut links = Vec::new();
        for (number, representation) in self.representations.iter().enumerate() {
            for &item in &representation.items {
                if !exchange
                    .keywords(item)
                    .iter()
                    .any(|k| is_a(k, "MAPPED_ITEM"))
                {
                    continue;
                }
                match self.mapped_item(exchange, number, item, numbers) {
                    Ok(link) => links.push(link),
                    Err(error) => tell(error),
                }
            }
        }
        self.links.extend(links);
    }

    fn mapped_item(
        &self,
        exchange: &Exchange,
        holder: usize,
        item: u32,
        numbers: &HashMap<u32, usize>,
    ) -> Told<Link> {
        let entity = Entity::read(exchange, item)?;
        let what = "the source of a mapped item";
        let source = entity.member("MAPPED_ITEM", 0, "REPRESENTATION_MAP", what)?;
        let origin = source.reference("REPRESENTATION_MAP", 0, "the origin of a mapped item")?;
        let what = "the representation of a mapped item";
        let mapped = source.reference("REPRESENTATION_MAP", 1, what)?;
        let target = entity.reference("MAPPED_ITEM", 1, "the target of a mapped item")?;
        let Some(&child) = numbers.get(&mapped) else {
            return Err(format!("{} maps what is no shape", entity.describe()));
        };
        let mut from = transformation(exchange, origin)?;
        from.shift *= self.factor(child);
        let mut to = transformation(exchange, target)?;
        to.shift *= self.factor(holder);
        let back = from.inverse().ok_or("a placement is singular")?;
        Ok(Link {
            parent: self.group[holder],
            child: self.group[child],
            map: to.after(&back),
            instance: item,
        })
    }
}

fn related(relation: &Entity) -> Told<[u32; 2]> {
    let kind = "REPRESENTATION_RELATIONSHIP";
    Ok([
        relation.reference(kind, 2, "a representation")?,
        relation.reference(kind, 3, "a representation")?,
    ])
}

/// Name of the product of a PRODUCT_DEFINITION: its name, or else its number.
fn product_name(exchange: &Exchange, index: u32) -> Told<Option<String>> {
    let definition = Entity::read(exchange, index)?;
    let what = "the product of a definition";
    let formation = definition.reference("PRODUCT_DEFINITION", 2, what)?;
    let formation = Entity::read(exchange, formation)?;
    let product = formation.reference("PRODUCT_DEFINITION_FORMATION", 2, what)?;
    let product = Entity::read(exchange, product)?;
    Ok(product
        .text("PRODUCT", 1)
        .or_else(|| product.text("PRODUCT", 0)))
}
