//! Bodies and rigid surfaces read back from their files of results.
use super::appended::inlined;
use super::body::vtk_cell;
use super::mid_surface::SHEET;
use super::vtu::escaped;
use crate::mesh::{ElementKind, Mesh};
use crate::scene::nearest;
use covact_geometry::Vec3;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use vtkio::model::{
    Attribute, Attributes, CellType, DataSet, Piece, UnstructuredGridPiece, VertexNumbers, Vtk,
};

/// A body on the disk.
pub(crate) struct BodyFile {
    pub mesh: Mesh,
    pub fields: Vec<Array>,
}

/// An array of numbers on points or cells.
pub(crate) struct Array {
    pub name: String,
    pub components: usize,
    pub by_cell: bool,
    pub data: Vec<f64>,
}

/// A rigid surface on the disk.
pub(crate) struct SurfaceFile {
    pub points: Vec<Vec3>,
    /// Flat quadrilaterals; empty where some cells are curved.
    pub quads: Vec<[u32; 4]>,
    pub fields: Vec<Array>,
}

/// A file that a collection lists.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Listed {
    pub time: f64,
    pub part: u32,
    /// Name of the body or surface, escaped as it stands in the file.
    pub name: String,
    pub file: String,
}

/// Files that a collection lists, in its order.
///
/// # Errors
/// In words.
pub(crate) fn collection(path: &Path) -> Result<Vec<Listed>, String> {
    let text = std::fs::read_to_string(path)
        .map_err(|e| format!("cannot read `{}`: {e}", path.display()))?;
    let entry = |tag: &str| {
        let wrong = || format!("`{}` has an entry that is not one: {tag}", path.display());
        let read = || {
            Some(Listed {
                time: attribute(tag, "timestep")?.parse().ok()?,
                part: attribute(tag, "part")?.parse().ok()?,
                name: attribute(tag, "name")?.to_owned(),
                file: attribute(tag, "file")?.to_owned(),
            })
        };
        read().ok_or_else(wrong)
    };
    tags(&text, "<DataSet ").map(entry).collect()
}

/// Time and file of the last results of a body, as the collection in the folder lists them.
///
/// # Errors
/// In words.
pub(crate) fn last(folder: &Path, body: &str) -> Result<(f64, PathBuf), String> {
    let listed = collection(&folder.join("results.pvd"))?;
    let mut names = Vec::new();
    let mut best: Option<&Listed> = None;
    for entry in &listed {
        if entry.name != escaped(body) {
            names.push(entry.name.as_str());
            continue;
        }
        // A surface may share the body's name; bodies come first.
        let later =
            |b: &&Listed| entry.time > b.time || (entry.time == b.time && entry.part < b.part);
        if best.as_ref().is_none_or(later) {
            best = Some(entry);
        }
    }
    match best {
        Some(found) => Ok((found.time, folder.join(&found.file))),
        None => Err(match nearest(body, names.iter().copied()) {
            Some(near) => format!("no results of a body `{body}`; did you mean `{near}`?"),
            None if names.is_empty() => {
                format!("no results of body `{body}`: the scene writes none (`output`, `every`)")
            }
            None => format!("no results of a body `{body}`"),
        }),
    }
}

/// What a file of results holds.
pub(crate) enum Part {
    Body(BodyFile),
    Surface(SurfaceFile),
    /// Slave points, or the mid-surface of a body, which is written as bricks as well.
    Cloud,
}

/// Reads a body, a rigid surface, or slave points.
///
/// # Errors
/// In words.
pub(crate) fn part(path: &Path) -> Result<Part, String> {
    let grid = grid(path)?;
    let all = |cell: CellType| grid.types.iter().all(|t| *t == cell);
    let is_sheet = grid.fields.iter().any(|f| f.name == SHEET);
    if all(CellType::Vertex) || is_sheet {
        return Ok(Part::Cloud);
    }
    let of_surface = |t: &CellType| matches!(t, CellType::Quad | CellType::BezierQuadrilateral);
    if !grid.types.iter().all(of_surface) {
        return body_of(grid).map(Part::Body).map_err(|e| bad(path, &e));
    }
    if grid.names_missing_points() {
        return Err(bad(path, "has cells with points that it has not"));
    }
    let corners = match all(CellType::Quad) {
        true => &grid.connectivity[..],
        false => &[],
    };
    // Below the number of points in memory, which are numbered by 32 bits.
    let quad = |c: &[u64]| [c[0], c[1], c[2], c[3]].map(|node| node as u32);
    Ok(Part::Surface(SurfaceFile {
        quads: corners.chunks_exact(4).map(quad).collect(),
        points: grid.points,
        fields: grid.fields,
    }))
}

/// Reads a body.
///
/// # Errors
/// In words.
pub(crate) fn body(path: &Path) -> Result<BodyFile, String> {
    body_of(grid(path)?).map_err(|what| bad(path, &what))
}

fn body_of(grid: GridFile) -> Result<BodyFile, String> {
    let (kind, connectivity) = elements(&grid)?;
    Ok(BodyFile {
        mesh: Mesh {
            kind,
            nodes: grid.points,
            connectivity,
            node_sets: BTreeMap::new(),
            face_sets: BTreeMap::new(),
        },
        fields: grid.fields,
    })
}

/// A grid as it stands in a file.
struct GridFile {
    points: Vec<Vec3>,
    connectivity: Vec<u64>,
    offsets: Vec<u64>,
    types: Vec<CellType>,
    fields: Vec<Array>,
}

impl GridFile {
    fn names_missing_points(&self) -> bool {
        let points = self.points.len() as u64;
        self.connectivity.iter().any(|node| *node >= points)
    }
}

fn bad(path: &Path, what: &str) -> String {
    format!("`{}` {what}", path.display())
}

/// Reads a grid. What the file says it holds is compared with what was read, since vtkio leaves out arrays that it cannot
/// decode.
fn grid(path: &Path) -> Result<GridFile, String> {
    let bytes =
        std::fs::read(path).map_err(|e| format!("cannot read `{}`: {e}", path.display()))?;
    let bad = |what: &str| bad(path, what);
    let bytes = inlined(&bytes).ok_or_else(|| bad("cannot be read: its arrays are cut off"))?;
    let text = String::from_utf8_lossy(&bytes);
    let piece = tags(&text, "<Piece ").next();
    let piece = piece.ok_or_else(|| bad("is no grid"))?;
    let count = |name: &str| {
        let number = attribute(piece, name).and_then(|n| n.parse::<usize>().ok());
        number.ok_or_else(|| bad(&format!("does not state its {name}")))
    };
    let (points, cells) = (count("NumberOfPoints")?, count("NumberOfCells")?);
    let vtk = Vtk::parse_xml(&bytes[..]).map_err(|e| bad(&format!("cannot be read: {e}")))?;
    let DataSet::UnstructuredGrid { pieces, .. } = vtk.data else {
        return Err(bad("is no unstructured grid"));
    };
    let Some(Piece::Inline(grid)) = pieces.into_iter().next() else {
        return Err(bad("holds no grid"));
    };
    let UnstructuredGridPiece {
        points: at,
        cells: topology,
        data,
    } = *grid;
    let at: Vec<f64> = (at.cast_into()).ok_or_else(|| bad("has points that are no numbers"))?;
    if at.len() != 3 * points || at.iter().any(|x| !x.is_finite()) {
        return Err(bad("has not the points that it states"));
    }
    let VertexNumbers::XML {
        connectivity,
        offsets,
    } = topology.cell_verts
    else {
        return Err(bad("has cells of the older format"));
    };
    if topology.types.len() != cells || offsets.len() != cells || cells == 0 {
        return Err(bad("has not the cells that it states"));
    }
    let fields = arrays(data, [points, cells]).map_err(|what| bad(&what))?;
    let stated = (tags(&text, "<DataArray ")).filter_map(|tag| attribute(tag, "Name"));
    let structure = ["Points", "connectivity", "offsets", "types"];
    for name in stated.filter(|name| !structure.contains(name)) {
        if !fields
            .iter()
            .any(|f| escaped(&f.name) == name || f.name == name)
        {
            return Err(bad(&format!(
                "has an array `{name}` that cannot be decoded"
            )));
        }
    }
    Ok(GridFile {
        points: (at.chunks_exact(3))
            .map(|x| Vec3::new(x[0], x[1], x[2]))
            .collect(),
        connectivity,
        offsets,
        types: topology.types,
        fields,
    })
}

/// Element shape, and node numbers in the order of a mesh.
fn elements(grid: &GridFile) -> Result<(ElementKind, Vec<u32>), String> {
    let GridFile {
        connectivity,
        offsets,
        types,
        ..
    } = grid;
    let fits = |kind: ElementKind| {
        let (order, cell) = vtk_cell(kind);
        let n = order.len();
        let mut ends = offsets.iter().enumerate();
        types.iter().all(|t| *t == cell)
            && connectivity.len() == types.len() * n
            && ends.all(|(e, end)| *end == ((e + 1) * n) as u64)
    };
    let kind = [ElementKind::H8, ElementKind::Q18]
        .into_iter()
        .find(|kind| fits(*kind))
        .ok_or("is no body: its cells are not elements of 8 or of 18 nodes")?;
    if grid.names_missing_points() {
        return Err("has cells with points that it has not".into());
    }
    let (order, _) = vtk_cell(kind);
    let mut out = vec![0; connectivity.len()];
    for (element, from) in
        (out.chunks_exact_mut(order.len())).zip(connectivity.chunks_exact(order.len()))
    {
        for (&place, &node) in order.iter().zip(from) {
            // Below the number of points of a mesh in memory, whose nodes are numbered by 32 bits.
            element[place] = node as u32;
        }
    }
    Ok((kind, out))
}

fn arrays(data: Attributes, [points, cells]: [usize; 2]) -> Result<Vec<Array>, String> {
    let mut out = Vec::new();
    let on_points = data.point.into_iter().map(|a| (false, points, a));
    let on_cells = data.cell.into_iter().map(|a| (true, cells, a));
    for (by_cell, count, attribute) in on_points.chain(on_cells) {
        let Attribute::DataArray(array) = attribute else {
            continue;
        };
        let name = array.name;
        let components = array.elem.num_comp() as usize;
        let data: Option<Vec<f64>> = array.data.cast_into();
        let data = data.ok_or_else(|| format!("has an array `{name}` that is no numbers"))?;
        if data.len() != components * count {
            return Err(format!(
                "has {} numbers in `{name}` where {} are needed",
                data.len(),
                components * count
            ));
        }
        out.push(Array {
            name,
            components,
            by_cell,
            data,
        });
    }
    Ok(out)
}

/// Tags that begin with `start`. Between tags there are no brackets.
fn tags<'a>(text: &'a str, start: &'a str) -> impl Iterator<Item = &'a str> {
    text.match_indices(start).map(|(at, _)| {
        let end = text[at..].find('>').map_or(text.len(), |n| at + n);
        &text[at..end]
    })
}

/// The value of an attribute, as it stands in the tag.
fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    let start = format!(" {name}=\"");
    let at = tag.find(&start)? + start.len();
    let end = tag[at..].find('"')? + at;
    Some(&tag[at..end])
}
