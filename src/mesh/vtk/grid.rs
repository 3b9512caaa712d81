//! Cells of VTK as elements.
use crate::mesh::error::shorten;
use crate::mesh::quadratic::{PLACES, tensor_27};
use crate::mesh::raw::{NONE, RawMesh};
use crate::mesh::{MeshError, Position};
use crate::scene::MeshCells;
use covact_geometry::Vec3;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Nodes are numbered around the faces; tensor node `a` is file node `TENSOR[a]`.
const TENSOR: [usize; 8] = [0, 1, 3, 2, 4, 5, 7, 6];

/// An array with more different values gives no sets: it numbers its cells or points.
const MOST_SETS: usize = 1000;

const CELLS: &str =
    "elements of surfaces are triangles and quadrilaterals, solid elements are hexahedra";

/// Cells and points of a file, with the arrays that may be sets.
#[derive(Debug, Default)]
pub(super) struct Grid {
    pub points: Vec<Vec3>,
    /// Points of all cells, where each cell ends, and what it is.
    pub connectivity: Vec<i64>,
    pub ends: Vec<i64>,
    pub types: Vec<i64>,
    pub point_arrays: Vec<(String, Vec<i64>)>,
    pub cell_arrays: Vec<(String, Vec<i64>)>,
    /// Cells of named sets.
    pub cell_sets: Vec<(String, Vec<u32>)>,
}

/// The mesh of points and cells that a program gives.
pub(in crate::mesh) fn from_cells(mesh: &MeshCells) -> Result<RawMesh, MeshError> {
    let path = &mesh.file.path;
    let at = Position::Memory;
    let within = |set: &str, kind: &'static str, members: &[u32], count: usize| {
        let wrong = members.iter().find(|&&n| n as usize >= count);
        wrong.map_or(Ok(()), |&number| {
            Err(MeshError::OutOfRange {
                what: format!("the set `{}`", shorten(set)),
                kind,
                number: number.into(),
                count,
            })
        })
    };
    for (name, set) in &mesh.cell_sets {
        within(name, "cell", set, mesh.types.len())?;
    }
    for (name, set) in &mesh.point_sets {
        within(name, "point", set, mesh.points.len())?;
    }
    let grid = Grid {
        points: mesh.points.iter().map(|x| Vec3::from(*x)).collect(),
        connectivity: mesh.connectivity.clone(),
        ends: mesh.ends.clone(),
        types: mesh.types.clone(),
        cell_sets: (mesh.cell_sets.iter())
            .map(|(name, set)| (name.clone(), set.clone()))
            .collect(),
        ..Grid::default()
    };
    let mut raw = grid.into_raw(path, at)?;
    for (name, set) in &mesh.point_sets {
        (raw.node_sets.entry(name.clone()).or_default()).extend_from_slice(set);
    }
    Ok(raw)
}

/// What became of a cell.
#[derive(Clone, Copy)]
enum Cell {
    Solid(u32),
    Facet(u32),
    Line([u32; 2]),
    Nothing,
}

/// Names of cell types, for messages.
fn type_name(number: i64) -> Option<&'static str> {
    Some(match number {
        0 => "empty cells",
        1 | 2 => "vertices",
        3 | 4 | 21 => "lines",
        5 => "triangles",
        6 => "triangle strips",
        7 => "polygons",
        8 => "pixels",
        9 => "quadrilaterals",
        10 => "tetrahedra",
        11 => "voxels",
        12 => "hexahedra",
        13 => "wedges",
        14 => "pyramids",
        22 => "quadratic triangles",
        23 => "quadratic quadrilaterals (8 nodes)",
        24 => "quadratic tetrahedra",
        25 => "quadratic hexahedra (20 nodes)",
        26 => "quadratic wedges",
        27 => "quadratic pyramids",
        28 => "quadratic quadrilaterals (9 nodes)",
        29 => "quadratic hexahedra (27 nodes)",
        _ => return None,
    })
}

impl Grid {
    /// The elements; `at` is the place in the file that is told where cells are wrong.
    pub fn into_raw(self, path: &Path, at: Position) -> Result<RawMesh, MeshError> {
        let syntax = |expected: String, found: String| MeshError::Syntax {
            path: path.to_path_buf(),
            at,
            expected,
            found,
        };
        let mut raw = RawMesh {
            node_tags: (0..self.points.len() as u64).collect(),
            help: CELLS,
            ..RawMesh::default()
        };
        raw.nodes = self.points;
        if self.types.len() != self.ends.len() {
            let expected = format!("{} cell types, one for each cell", self.ends.len());
            return Err(syntax(expected, self.types.len().to_string()));
        }
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        let mut cells = Vec::with_capacity(self.types.len());
        let mut start = 0;
        for (cell, (&kind, &end)) in self.types.iter().zip(&self.ends).enumerate() {
            let range = usize::try_from(end).ok().filter(|&end| end >= start);
            let points = range.and_then(|end| self.connectivity.get(start..end));
            let Some(points) = points else {
                let expected = format!(
                    "the end of cell {cell} from {start} to {}",
                    self.connectivity.len()
                );
                return Err(syntax(expected, end.to_string()));
            };
            start += points.len();
            let mut nodes = Vec::with_capacity(points.len());
            for &p in points {
                let node = usize::try_from(p).ok().filter(|&p| p < raw.nodes.len());
                let Some(node) = node else {
                    let expected = format!(
                        "points of cell {cell} from 0 to {}",
                        raw.nodes.len().max(1) - 1
                    );
                    return Err(syntax(expected, p.to_string()));
                };
                nodes.push(node as u32);
            }
            let Some(name) = type_name(kind) else {
                let unsupported = || unsupported(path, at, format!("cell type {kind}"));
                raw.refused.get_or_insert_with(unsupported);
                raw.refused_facets.get_or_insert_with(unsupported);
                cells.push(Cell::Nothing);
                continue;
            };
            *counts.entry(name).or_default() += 1;
            let Some(cell) = raw.cell(kind, &nodes, cell as u64, path, at) else {
                let expected = format!("the points of cell {cell}, one of {name}");
                return Err(syntax(expected, nodes.len().to_string()));
            };
            cells.push(cell);
        }
        raw.found = counts
            .iter()
            .map(|(name, n)| format!("{n} {name}"))
            .collect();
        raw.sets_of_cells(&self.cell_arrays, &cells);
        for (name, members) in self.cell_sets {
            raw.set_of_cells(&name, members, &cells);
        }
        for (name, values) in &self.point_arrays {
            for (value, points) in groups(values).into_iter().flatten() {
                raw.node_sets.insert(format!("{name}_{value}"), points);
            }
        }
        Ok(raw)
    }
}

fn unsupported(path: &Path, at: Position, what: String) -> MeshError {
    MeshError::Unsupported {
        path: path.to_path_buf(),
        at,
        what,
        help: CELLS.to_string(),
    }
}

impl RawMesh {
    /// Adds a cell; `None` where it has another number of points than its type.
    fn cell(
        &mut self,
        kind: i64,
        nodes: &[u32],
        tag: u64,
        path: &Path,
        at: Position,
    ) -> Option<Cell> {
        let pick = |order: &[usize]| -> Option<Vec<u32>> {
            (nodes.len() == order.len()).then(|| order.iter().map(|&k| nodes[k]).collect())
        };
        let count = match kind {
            5 => 3,
            9 => 4,
            22 => 6,
            23 => 8,
            28 => 9,
            _ => 0,
        };
        Some(match kind {
            5 | 9 | 22 | 23 | 28 => {
                (nodes.len() == count).then_some(())?;
                Cell::Facet(self.facets.push(nodes, tag))
            }
            7 if matches!(nodes.len(), 3 | 4) => Cell::Facet(self.facets.push(nodes, tag)),
            8 => Cell::Facet(self.facets.push(&pick(&[0, 1, 3, 2])?, tag)),
            3 | 21 => {
                (nodes.len() == if kind == 3 { 2 } else { 3 }).then_some(())?;
                Cell::Line([nodes[0], nodes[1]])
            }
            11 => self.hexahedron(&pick(&[0, 1, 3, 2, 4, 5, 7, 6])?, None, tag, path, at),
            12 => self.hexahedron(&pick(&[0, 1, 2, 3, 4, 5, 6, 7])?, None, tag, path, at),
            25 => {
                (nodes.len() == 20).then_some(())?;
                let mut tensor = [NONE; 27];
                PLACES.iter().zip(nodes).for_each(|(&p, &n)| tensor[p] = n);
                self.hexahedron(nodes, Some(tensor), tag, path, at)
            }
            29 => {
                let tensor = tensor_27(nodes.try_into().ok()?, &self.nodes)?;
                self.hexahedron(nodes, Some(tensor), tag, path, at)
            }
            0 | 1 | 2 | 4 => Cell::Nothing,
            6 | 7 => {
                let what = match kind {
                    6 => "a mesh of triangle strips".to_string(),
                    _ => format!("a polygon of {} points", nodes.len()),
                };
                (self.refused_facets).get_or_insert_with(|| unsupported(path, at, what));
                Cell::Nothing
            }
            _ => {
                let name = type_name(kind).unwrap_or_default();
                let refused = unsupported(path, at, format!("a mesh of {name}"));
                self.refused.get_or_insert(refused);
                Cell::Nothing
            }
        })
    }

    fn hexahedron(
        &mut self,
        nodes: &[u32],
        tensor: Option<[u32; 27]>,
        tag: u64,
        path: &Path,
        at: Position,
    ) -> Cell {
        if self.quadratic.len() != self.hexahedra.len() * usize::from(tensor.is_some()) {
            let what = "a mesh of both linear and quadratic hexahedra".to_string();
            self.refused.get_or_insert(unsupported(path, at, what));
            return Cell::Nothing;
        }
        self.quadratic.extend(tensor);
        self.hexahedra.push(TENSOR.map(|a| nodes[a]));
        self.element_tags.push(tag);
        Cell::Solid(self.hexahedra.len() as u32 - 1)
    }

    fn sets_of_cells(&mut self, arrays: &[(String, Vec<i64>)], cells: &[Cell]) {
        for (name, values) in arrays {
            let Some(groups) = groups(values) else {
                self.notes.push(format!(
                    "the array `{}` numbers its cells and gives no sets",
                    shorten(name)
                ));
                continue;
            };
            for (value, members) in groups {
                let set = format!("{name}_{value}");
                self.set_of_cells(&set, members, cells);
            }
        }
    }

    fn set_of_cells(&mut self, set: &str, members: Vec<u32>, cells: &[Cell]) {
        for member in members {
            match cells.get(member as usize) {
                Some(Cell::Solid(e)) => {
                    self.solid_sets.entry(set.to_owned()).or_default().push(*e);
                }
                Some(Cell::Facet(f)) => {
                    self.facets.sets.entry(set.to_owned()).or_default().push(*f);
                }
                Some(Cell::Line(line)) => {
                    (self.node_sets.entry(set.to_owned()).or_default()).extend(line);
                    self.lines.entry(set.to_owned()).or_default().push(*line);
                }
                _ => {}
            }
        }
    }
}

/// Members by value, negative ones left out: they stand for none. `None` where there are too many values.
fn groups(values: &[i64]) -> Option<BTreeMap<i64, Vec<u32>>> {
    let different: BTreeSet<i64> = values.iter().copied().take(10 * MOST_SETS).collect();
    if different.len() > MOST_SETS {
        return None;
    }
    let mut groups: BTreeMap<i64, Vec<u32>> = BTreeMap::new();
    for (k, &value) in values.iter().enumerate().filter(|(_, v)| **v >= 0) {
        groups.entry(value).or_default().push(k as u32);
        if groups.len() > MOST_SETS {
            return None;
        }
    }
    Some(groups)
}
