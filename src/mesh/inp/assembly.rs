//! Parts and where their instances are put; from them to one mesh.
use super::build::Builder;
use super::lines::Keyword;
use super::scope::Scope;
use super::{Mode, Reader, spell};
use crate::mesh::MeshError;
use crate::mesh::error::{listed, most_members};
use crate::mesh::field::Field;
use crate::mesh::raw::RawMesh;
use covact_geometry::Vec3;
use nalgebra::{Rotation3, Unit};

/// A part at its place.
pub(super) struct Instance {
    pub name: String,
    /// The part, or nodes and elements of the instance's own.
    pub scope: usize,
    translation: Vec3,
    /// Two points of an axis and an angle in degrees.
    rotation: Option<([Vec3; 2], f64)>,
    /// Data lines read.
    lines: usize,
}

impl Instance {
    /// Where a point of the part goes: moved, then turned.
    pub fn place(&self, x: Vec3) -> Vec3 {
        let moved = x + self.translation;
        let Some(([a, b], angle)) = self.rotation else {
            return moved;
        };
        match Unit::try_new(b - a, 0.0) {
            Some(axis) => a + Rotation3::from_axis_angle(&axis, angle.to_radians()) * (moved - a),
            None => moved,
        }
    }
}

impl Reader<'_> {
    /// Parts, instances and assemblies begin and end.
    pub(super) fn assembly(&mut self, keyword: &Keyword) -> Result<Mode, MeshError> {
        let path = self.path;
        let name = |parameter: &str| match keyword.get(parameter) {
            Some(field) if !field.text.is_empty() => Ok(field),
            _ => {
                let expected = format!("{} with {parameter}=name", keyword.name);
                Err(keyword.at.syntax(path, &expected))
            }
        };
        let known = |scopes: &[Scope], name: &str| {
            (1..scopes.len()).find(|&k| scopes[k].name.eq_ignore_ascii_case(name))
        };
        match keyword.name.as_str() {
            "*PART" => {
                let field = name("NAME")?;
                if known(&self.scopes, field.text).is_some() {
                    return Err(field.syntax(path, "a name of a part used once"));
                }
                self.scopes.push(Scope::new(&spell(path, field)?));
                self.current = self.scopes.len() - 1;
            }
            "*INSTANCE" => {
                let (field, part) = (name("NAME")?, name("PART")?);
                let Some(scope) = known(&self.scopes, part.text) else {
                    let names = self.scopes[1..].iter().map(|s| &s.name);
                    let expected = format!("a part that stands above ({})", listed(names));
                    return Err(part.syntax(path, &expected));
                };
                if (self.instances.iter()).any(|i| i.name.eq_ignore_ascii_case(field.text)) {
                    return Err(field.syntax(path, "a name of an instance used once"));
                }
                self.instances.push(Instance {
                    name: spell(path, field)?,
                    scope,
                    translation: Vec3::zeros(),
                    rotation: None,
                    lines: 0,
                });
                // An instance may have its mesh in place of its part.
                self.scopes.push(Scope::default());
                self.current = self.scopes.len() - 1;
                return Ok(Mode::Instance(self.instances.len() - 1));
            }
            "*ENDINSTANCE" => {
                if let (Some(instance), true) = (self.instances.last_mut(), self.current > 0) {
                    let own = &self.scopes[self.current];
                    if own.is_empty() {
                        self.scopes.pop();
                    } else if self.scopes[instance.scope].is_empty() {
                        instance.scope = self.current;
                    } else {
                        let what = "an instance with nodes beside those of its part".to_string();
                        let help = "mesh either the part or the instance";
                        return Err(keyword.at.unsupported(path, what, help));
                    }
                }
                self.current = 0;
            }
            _ => self.current = 0,
        }
        Ok(Mode::Skip)
    }

    /// A data line of an instance: its translation, then its rotation.
    pub(super) fn place<'l>(
        &mut self,
        which: usize,
        list: impl Iterator<Item = Field<'l>>,
    ) -> Result<(), MeshError> {
        let path = self.path;
        let mut numbers = [0.0; 7];
        for (number, field) in numbers.iter_mut().zip(list) {
            if !field.text.is_empty() {
                *number = field.real(path, "a number of the instance's position")?;
            }
        }
        let [x, y, z, u, v, w, angle] = numbers;
        let instance = &mut self.instances[which];
        match instance.lines {
            0 => instance.translation = Vec3::new(x, y, z),
            1 => instance.rotation = Some(([Vec3::new(x, y, z), Vec3::new(u, v, w)], angle)),
            _ => {}
        }
        instance.lines += 1;
        Ok(())
    }

    /// One mesh of all instances, or of the flat file.
    pub(super) fn finish(mut self) -> Result<RawMesh, MeshError> {
        let parts = self.scopes.len() > 1;
        if parts && self.instances.is_empty() {
            // Parts without an assembly stand where they are.
            for (scope, part) in self.scopes.iter().enumerate().skip(1) {
                self.instances.push(Instance {
                    name: part.name.clone(),
                    scope,
                    translation: Vec3::zeros(),
                    rotation: None,
                    lines: 0,
                });
            }
        }
        let [nodes, elements] = [
            self.scopes.iter().map(|s| s.nodes.len()).sum::<usize>(),
            self.scopes.iter().map(|s| s.elements.len()).sum::<usize>(),
        ];
        let most = most_members(nodes, elements);
        let all = (self.instances.iter())
            .map(|i| {
                (self.scopes[i.scope].nodes.len() + self.scopes[i.scope].elements.len()) as u64
            })
            .sum::<u64>();
        if all > most {
            return Err(MeshError::LongSets {
                path: self.path.to_path_buf(),
                most,
            });
        }
        let raw = RawMesh {
            notes: std::mem::take(&mut self.notes),
            found: self.found.iter().cloned().collect(),
            help: super::ELEMENTS,
            refused: self.refused.take(),
            ..RawMesh::default()
        };
        let mut raw = Builder::new(&self, raw, nodes, elements).all()?;
        if self.longer > 0 {
            raw.notes.push(format!(
                "{} element(s) have more numbers in their lines than their type has nodes; those behind were left out",
                self.longer
            ));
        }
        let axes = ["CAX", "CGAX", "DCAX", "ACAX"];
        let turned = |kind: &&String| axes.iter().any(|a| kind.starts_with(a));
        let turned: Vec<&String> = self.found.iter().filter(turned).collect();
        if !turned.is_empty() {
            raw.notes.push(format!(
                "axisymmetric elements ({}) are taken for a plane surface",
                listed(turned)
            ));
        }
        if !self.types.is_empty() {
            let types = listed(&self.types);
            raw.notes.push(format!("elements left out: {types}"));
        }
        if !self.skipped.is_empty() {
            let skipped = listed(&self.skipped);
            raw.notes.push(format!("keywords left out: {skipped}"));
        }
        Ok(raw)
    }
}
