//! What becomes of every face of a file: patches of bodies, or a reason why not.

use super::assembly::Assembly;
use super::copies::Copy;
use super::entity::Entity;
use super::exchange::Exchange;
use super::face::{self, Account, FacePatch, Refusal};
use super::hidden::Hidden;
use super::labels::Labels;
use super::number_of;
use super::place::Placement;
use super::schema::is_a;
use super::scope::{Budget, Scope};
use super::shells::{self, Found, Member};
use super::units::Units;
use crate::io::brep::Grant;
use crate::io::report::{CadBody, CadPatch, CadTags, SkipKind, Skipped, TrimReport};
use crate::io::{ReadOptions, ReadProgress};
use std::collections::{HashMap, HashSet};
use std::rc::Rc;

/// All bodies of a file.
pub struct Outcome {
    pub units: Units,
    pub patches: Vec<CadPatch>,
    pub bodies: Vec<CadBody>,
    pub skipped: Vec<Skipped>,
    pub trims: TrimReport,
    /// The work and memory that are left.
    pub grant: Rc<Grant>,
}

/// A body where it stands.
struct Placed {
    copy: Copy,
    faces: Vec<Member>,
    solid: bool,
}

/// Reads all bodies, in the order in which the assembly holds them.
pub fn read(
    exchange: &Exchange,
    options: &ReadOptions,
    notes: &mut Vec<String>,
    watch: &mut dyn FnMut(ReadProgress),
) -> Outcome {
    let budget = Budget::of(exchange);
    let assembly = Assembly::read(exchange, notes);
    let mut reader = Reader {
        exchange,
        budget: &budget,
        labels: Labels::read(exchange),
        hidden: match options.hidden {
            true => Hidden::default(),
            false => Hidden::read(exchange),
        },
        faces: HashMap::new(),
        told: HashSet::new(),
        out: Outcome {
            units: assembly.units[assembly.main].clone(),
            patches: Vec::new(),
            bodies: Vec::new(),
            skipped: Vec::new(),
            trims: TrimReport::default(),
            grant: Rc::clone(&budget.grant),
        },
        assembly: &assembly,
        notes,
        progress: ReadProgress { faces: 0, of: 0 },
        watch,
    };
    reader.all();
    reader.out
}

struct Reader<'a, 'r> {
    exchange: &'r Exchange<'a>,
    budget: &'r Budget,
    labels: Labels,
    hidden: Hidden,
    assembly: &'r Assembly,
    /// Faces that were read, where several copies need them.
    faces: HashMap<u32, Result<FacePatch, Refusal>>,
    /// Numbers of what was skipped: the copies of a face differ in place only.
    told: HashSet<(u32, SkipKind)>,
    out: Outcome,
    notes: &'r mut Vec<String>,
    progress: ReadProgress,
    watch: &'r mut dyn FnMut(ReadProgress),
}

impl<'a> Reader<'a, '_> {
    fn scope(&self, representation: Option<usize>) -> Scope<'_, 'a> {
        let main = self.assembly.main;
        let units = representation.map_or(main, |r| self.assembly.representations[r].units);
        let units = &self.assembly.units[units];
        Scope {
            exchange: self.exchange,
            budget: self.budget,
            angle: units.angle,
            near: units.uncertainty.unwrap_or(0.0),
        }
    }

    fn all(&mut self) {
        let copies = (self.assembly).copies(self.exchange, &self.hidden, self.notes);
        let mut bodies = Vec::new();
        let mut items = HashSet::new();
        // The same item in several representations of one product is one body.
        let mut seen = HashSet::new();
        for copy in copies {
            items.insert(copy.item);
            if seen.insert((copy.item, copy.map.bits(), copy.hidden_by)) {
                self.item(copy, &mut bodies);
            }
        }
        self.strays(&items, &mut bodies);
        // Faces and surfaces that stand alone beside the bodies they belong to are no bodies of their own.
        let held = |p: &&Placed| p.faces.iter().all(|f| f.index != p.copy.item);
        let owned: HashSet<u32> = bodies.iter().filter(held).flat_map(owned_by).collect();
        bodies.retain(|p| !owned.contains(&p.copy.item));
        let mut uses: HashMap<u32, usize> = HashMap::new();
        for member in bodies.iter().flat_map(|p| &p.faces) {
            *uses.entry(member.index).or_insert(0) += 1;
        }
        self.progress.of = bodies.iter().map(|p| p.faces.len()).sum();
        for placed in bodies {
            self.body(&placed, &mut uses);
        }
        self.loose(&owned);
    }

    /// An item of a representation, if it is a body.
    fn item(&mut self, copy: Copy, bodies: &mut Vec<Placed>) {
        let scope = self.scope(Some(copy.representation));
        match shells::faces(&scope, copy.item) {
            Ok(Found::Body(faces, solid)) => bodies.push(Placed { copy, faces, solid }),
            Ok(Found::Nothing) => {}
            Ok(Found::Unread) => {
                let kind = self.kind(copy.item);
                self.skip(
                    copy.item,
                    SkipKind::Unsupported,
                    format!("{kind} is not read"),
                );
            }
            Err(reason) => self.skip(copy.item, SkipKind::Surface, reason),
        }
    }

    /// Bodies that no representation lists.
    fn strays(&mut self, items: &HashSet<u32>, bodies: &mut Vec<Placed>) {
        const BODIES: [&str; 3] = [
            "MANIFOLD_SOLID_BREP",
            "SHELL_BASED_SURFACE_MODEL",
            "FACE_BASED_SURFACE_MODEL",
        ];
        for index in 0..self.exchange.len() as u32 {
            if items.contains(&index) {
                continue;
            }
            let keywords = self.exchange.keywords(index);
            if !BODIES.iter().any(|b| keywords.iter().any(|k| is_a(k, b))) {
                continue;
            }
            let scope = self.scope(None);
            match shells::faces(&scope, index) {
                Ok(Found::Body(faces, solid)) => {
                    let text = "is in no representation; it is read where it is defined";
                    let name = self.exchange.name(index);
                    self.notes
                        .push(format!("#{name} ({}) {text}", self.kind(index)));
                    bodies.push(Placed {
                        copy: Copy {
                            item: index,
                            representation: usize::MAX,
                            map: Placement::identity(),
                            instance: None,
                            path: Default::default(),
                            hidden_by: self.hidden.item(index),
                        },
                        faces,
                        solid,
                    });
                }
                Ok(_) => {}
                Err(reason) => self.skip(index, SkipKind::Surface, reason),
            }
        }
    }

    /// Names faces that belong to no body.
    fn loose(&mut self, owned: &HashSet<u32>) {
        let taken: HashSet<u32> = self.out.patches.iter().map(|p| p.entity).collect();
        let refused: HashSet<u32> = self.out.skipped.iter().map(|s| s.entity).collect();
        for index in 0..self.exchange.len() as u32 {
            let keywords = self.exchange.keywords(index);
            let is_face = |kind: &str| keywords.iter().any(|k| is_a(k, kind));
            let number = number_of(self.exchange, index);
            if (is_face("FACE_SURFACE") || is_face("CURVE_BOUNDED_SURFACE"))
                && !(owned.contains(&index) || taken.contains(&number) || refused.contains(&number))
            {
                let reason = "belongs to no body that a representation holds".to_owned();
                self.skip(index, SkipKind::Dependent, reason);
            }
        }
    }

    fn kind(&self, index: u32) -> String {
        super::entity::kind_of(self.exchange.keywords(index).into_iter())
    }

    fn skip(&mut self, index: u32, kind: SkipKind, reason: String) {
        let entity = number_of(self.exchange, index);
        if !self.told.insert((entity, kind)) {
            return;
        }
        let label = Entity::read(self.exchange, index)
            .ok()
            .and_then(|e| e.label());
        self.out.skipped.push(Skipped {
            entity,
            type_number: 0,
            name: label.unwrap_or_else(|| self.kind(index)),
            kind,
            reason,
        });
    }

    /// Reads the faces of a body and puts them where it stands.
    fn body(&mut self, placed: &Placed, uses: &mut HashMap<u32, usize>) {
        let Placed { copy, faces, solid } = placed;
        let names = copy.path.iter().map(|p| p.len()).sum();
        if faces.is_empty() {
            return;
        }
        if let Err(reason) = self.budget.grant.body(names) {
            return self.skip(copy.item, SkipKind::Surface, reason);
        }
        let instance = copy.instance.map_or(0, |i| number_of(self.exchange, i));
        let entity = Entity::read(self.exchange, copy.item).ok();
        let own = entity.and_then(|e| e.label());
        let path: Vec<String> = copy.path.iter().map(|p| p.to_string()).collect();
        let name = own.or_else(|| path.last().cloned());
        let body = self.out.bodies.len();
        let [mut read, mut skipped] = [0, 0];
        for member in faces {
            self.progress.faces += 1;
            (self.watch)(self.progress);
            let left = uses.entry(member.index).or_insert(1);
            *left = left.saturating_sub(1);
            let last = *left == 0;
            let hidden = [member.index, member.shell];
            let by = hidden.iter().find_map(|&part| self.hidden.item(part));
            if let Some(by) = copy.hidden_by.or(by) {
                skipped += 1;
                let by = self.exchange.name(by);
                let reason = format!("hidden in the file by #{by} (INVISIBILITY)");
                self.skip(member.index, SkipKind::Blanked, reason);
                continue;
            }
            let found = match self.faces.remove(&member.index) {
                Some(found) => found,
                None => self.face(copy, member),
            };
            match &found {
                Ok(face) => match self.placed(face, copy, member) {
                    Ok(patch) => {
                        read += 1;
                        let tags = CadTags {
                            body: Some(body),
                            layer: self.labels.layer(&[member.index, member.shell, copy.item]),
                            colour: self.labels.colour(&[member.index, member.shell, copy.item]),
                        };
                        let face_name = Entity::read(self.exchange, member.index).ok();
                        self.out.patches.push(CadPatch {
                            patch,
                            entity: number_of(self.exchange, member.index),
                            type_number: 0,
                            base: number_of(self.exchange, face.base),
                            instance,
                            border: face.border,
                            name: face_name.and_then(|e| e.label()).or_else(|| name.clone()),
                            tags,
                        });
                    }
                    Err(reason) => {
                        skipped += 1;
                        self.skip(member.index, SkipKind::Surface, reason);
                    }
                },
                Err((kind, reason)) => {
                    skipped += 1;
                    self.skip(member.index, *kind, reason.clone());
                }
            }
            if !last {
                self.faces.insert(member.index, found);
            }
        }
        self.out.bodies.push(CadBody {
            name,
            path,
            entity: number_of(self.exchange, copy.item),
            instance,
            solid: *solid,
            faces: read,
            skipped,
        });
    }

    fn face(&mut self, copy: &Copy, member: &Member) -> Result<FacePatch, Refusal> {
        let representation = (copy.representation != usize::MAX).then_some(copy.representation);
        let main = self.assembly.main;
        let units = representation.map_or(main, |r| self.assembly.representations[r].units);
        let units = &self.assembly.units[units];
        let scope = Scope {
            exchange: self.exchange,
            budget: self.budget,
            angle: units.angle,
            near: units.uncertainty.unwrap_or(0.0),
        };
        let mut account = Account {
            grant: &self.budget.grant,
            trims: &mut self.out.trims,
            notes: self.notes,
        };
        let read = scope
            .entity(member.index, 0)
            .map_err(|e| (SkipKind::Surface, e));
        read.and_then(|entity| {
            if entity.is("FACE") {
                face::face(&scope, &entity, &mut account)
            } else if entity.is("CURVE_BOUNDED_SURFACE") {
                face::curve_bounded(&scope, &entity, &mut account)
            } else {
                face::whole(&scope, &entity, &mut account)
            }
        })
    }

    /// The patch of a face where a copy of its body stands, with the normal that points out of the body.
    fn placed(
        &self,
        face: &FacePatch,
        copy: &Copy,
        member: &Member,
    ) -> Result<crate::NurbsPatch, String> {
        self.budget.grant.patch(&face.patch)?;
        let map = &copy.map;
        let mut patch = match *map == Placement::identity() {
            true => face.patch.clone(),
            false => {
                let moved = face.patch.transformed(&|x| map.apply(x));
                moved.map_err(|e| e.to_string())?
            }
        };
        // A mirror image has its normals turned over.
        if member.turned != map.mirrors() {
            patch = patch.reversed(0).map_err(|e| e.to_string())?;
        }
        Ok(patch)
    }
}

/// What a body consists of: its shells and faces.
fn owned_by(placed: &Placed) -> impl Iterator<Item = u32> + '_ {
    let item = placed.copy.item;
    let parts = placed.faces.iter().flat_map(|f| [f.index, f.shell]);
    parts.filter(move |&part| part != item)
}
