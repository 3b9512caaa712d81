//! Bodies read back from their files of results.
use crate::mesh::{ElementKind, Mesh};
use crate::output::{escape, vtk_cell};
use crate::scene::nearest;
use covact_geometry::Vec3;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use vtkio::model::{
    Attribute, Attributes, CellType, DataSet, Piece, UnstructuredGridPiece, VertexNumbers, Vtk,
};

/// A body on the disk.
pub(super) struct BodyFile {
    pub mesh: Mesh,
    pub fields: Vec<Array>,
}

/// An array of numbers on points or cells.
pub(super) struct Array {
    pub name: String,
    pub components: usize,
    pub by_cell: bool,
    pub data: Vec<f64>,
}

/// Time and file of the last results of a body, as the collection in the folder lists them.
///
/// # Errors
/// In words.
pub(super) fn last(folder: &Path, body: &str) -> Result<(f64, PathBuf), String> {
    let path = folder.join("results.pvd");
    let text = std::fs::read_to_string(&path)
        .map_err(|e| format!("cannot read `{}`: {e}", path.display()))?;
    let mut names = Vec::new();
    let mut best: Option<(f64, u32, &str)> = None;
    for tag in tags(&text, "<DataSet ") {
        let entry = (|| {
            let time = attribute(tag, "timestep")?.parse::<f64>().ok()?;
            let part = attribute(tag, "part")?.parse::<u32>().ok()?;
            Some((time, part, attribute(tag, "name")?, attribute(tag, "file")?))
        })();
        let Some((time, part, name, file)) = entry else {
            return Err(format!(
                "`{}` has an entry that is not one: {tag}",
                path.display()
            ));
        };
        if name != escape(body) {
            names.push(name);
            continue;
        }
        // A surface may share the body's name; bodies come first.
        let later = best.is_none_or(|(t, p, _)| time > t || (time == t && part < p));
        if later {
            best = Some((time, part, file));
        }
    }
    match best {
        Some((time, _, file)) => Ok((time, folder.join(file))),
        None => Err(match nearest(body, names.iter().copied()) {
            Some(near) => format!("no results of a body `{body}`; did you mean `{near}`?"),
            None if names.is_empty() => {
                format!("no results of body `{body}`: the scene writes none (`output`, `every`)")
            }
            None => format!("no results of a body `{body}`"),
        }),
    }
}

/// Reads a body. What the file says it holds is compared with what was read, since vtkio leaves out arrays that it cannot
/// decode.
///
/// # Errors
/// In words.
pub(super) fn read(path: &Path) -> Result<BodyFile, String> {
    let bytes =
        std::fs::read(path).map_err(|e| format!("cannot read `{}`: {e}", path.display()))?;
    let bad = |what: &str| format!("`{}` {what}", path.display());
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
    let (kind, connectivity) = elements(&topology.cell_verts, &topology.types, [points, cells])
        .map_err(|what| bad(&what))?;
    let fields = arrays(data, [points, cells]).map_err(|what| bad(&what))?;
    let stated = (tags(&text, "<DataArray ")).filter_map(|tag| attribute(tag, "Name"));
    let structure = ["Points", "connectivity", "offsets", "types"];
    for name in stated.filter(|name| !structure.contains(name)) {
        if !fields
            .iter()
            .any(|f| escape(&f.name) == name || f.name == name)
        {
            return Err(bad(&format!(
                "has an array `{name}` that cannot be decoded"
            )));
        }
    }
    Ok(BodyFile {
        mesh: Mesh {
            kind,
            nodes: (at.chunks_exact(3))
                .map(|x| Vec3::new(x[0], x[1], x[2]))
                .collect(),
            connectivity,
            node_sets: BTreeMap::new(),
            face_sets: BTreeMap::new(),
        },
        fields,
    })
}

/// Element shape, and node numbers in the order of a mesh.
fn elements(
    topology: &VertexNumbers,
    types: &[CellType],
    [points, cells]: [usize; 2],
) -> Result<(ElementKind, Vec<u32>), String> {
    let VertexNumbers::XML {
        connectivity,
        offsets,
    } = topology
    else {
        return Err("has cells of the older format".into());
    };
    if types.len() != cells || offsets.len() != cells || cells == 0 {
        return Err("has not the cells that it states".into());
    }
    let fits = |kind: ElementKind| {
        let (order, cell) = vtk_cell(kind);
        let n = order.len();
        let mut ends = offsets.iter().enumerate();
        types.iter().all(|t| *t == cell)
            && connectivity.len() == cells * n
            && ends.all(|(e, end)| *end == ((e + 1) * n) as u64)
    };
    let kind = [ElementKind::H8, ElementKind::Q18]
        .into_iter()
        .find(|kind| fits(*kind))
        .ok_or("is no body: its cells are not elements of 8 or of 18 nodes")?;
    if connectivity.iter().any(|node| *node >= points as u64) {
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
