//! Meshes and surfaces that a program gives as values. Scene files name files in their place.
use super::mesh_file::MeshFile;
use covact_geometry::NurbsPatch;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hasher};
use std::ops::Deref;
use std::sync::Arc;

/// A mesh as arrays.
///
/// ```
/// use covact::scene::{Body, Elastic, MaterialChoice, MeshArrays, SceneBuilder, Support};
/// // One cube: nodes along x first, then y, then z.
/// let nodes = (0..8).map(|k| [k & 1, k >> 1 & 1, k >> 2].map(f64::from)).collect();
/// let mut cube = MeshArrays { nodes, nodes_per_element: 8, elements: (0..8).collect(), ..MeshArrays::default() };
/// cube.node_sets.insert("ground".into(), vec![0, 1, 2, 3]);
/// let scene = SceneBuilder::new("A cube")
///     .material("steel", MaterialChoice::StVenantKirchhoff(Elastic::new(210e3, 0.3)))
///     .body("cube", Body::new(cube, "steel"))
///     .support("held", Support::fixed("cube.ground"))
///     .build()?;
/// assert_eq!(covact::run::plan(&scene)?.dofs, 12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeshArrays {
    /// Positions of the nodes.
    pub nodes: Vec<[f64; 3]>,
    /// Nodes of an element: 8, or 18 for a body of [`Element::Q18`](super::Element::Q18).
    pub nodes_per_element: usize,
    /// Node numbers of the elements, one after the other. Local node order is tensor-product: along r fastest, then s, then t (the
    /// thickness); H8 node `i + 2 j + 4 k`, Q18 node `i + 3 j + 9 k`.
    pub elements: Vec<u32>,
    /// Numbers of the nodes of named sets.
    pub node_sets: BTreeMap<String, Vec<u32>>,
    /// Element numbers and local faces of named sets. Local faces: 0 is r = -1, 1 is r = +1, 2 is s = -1, 3 is s = +1, 4 is
    /// t = -1 (bottom), 5 is t = +1 (top).
    pub face_sets: BTreeMap<String, Vec<(u32, u8)>>,
}

/// A mesh as points and cells, as mesh files and most mesh libraries have it: hexahedra, or a surface that a thickness makes
/// a body of. It is taken as a file of the same content is.
///
/// ```
/// use covact::scene::{Body, Elastic, MaterialChoice, MeshCells, MeshFile, SceneBuilder, Support, Thickness};
/// // A square sheet of one quadrilateral.
/// let sheet = MeshCells {
///     points: vec![[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]],
///     connectivity: vec![0, 1, 2, 3],
///     ends: vec![4],
///     types: vec![9],
///     cell_sets: Default::default(),
///     point_sets: Default::default(),
///     file: MeshFile { thickness: Some(Thickness::Uniform(0.1)), ..MeshFile::new("sheet") },
/// };
/// let scene = SceneBuilder::new("A sheet")
///     .material("steel", MaterialChoice::StVenantKirchhoff(Elastic::new(210e3, 0.3)))
///     .body("sheet", Body::new(sheet, "steel"))
///     .support("held", Support::fixed("sheet.x_min"))
///     .build()?;
/// assert_eq!(covact::run::plan(&scene)?.dofs, 12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MeshCells {
    /// Positions of the points.
    pub points: Vec<[f64; 3]>,
    /// Points of the cells, one cell after the other, in VTK's order.
    pub connectivity: Vec<i64>,
    /// Where each cell ends in `connectivity`.
    pub ends: Vec<i64>,
    /// VTK's number of the type of each cell: 5 triangle, 9 quadrilateral, 12 hexahedron, 29 hexahedron of 27 nodes, ...
    pub types: Vec<i64>,
    /// Cells of named sets.
    pub cell_sets: BTreeMap<String, Vec<u32>>,
    /// Points of named sets.
    pub point_sets: BTreeMap<String, Vec<u32>>,
    /// Thickness, layers and all else that a scene may say of a mesh file. The path stands for the mesh in messages.
    pub file: MeshFile,
}

/// A value shared by the scenes that hold it. Where a scene is written as text, a checksum stands in its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Given<T>(Arc<T>);

impl<T> From<T> for Given<T> {
    fn from(value: T) -> Self {
        Given(Arc::new(value))
    }
}

impl<T> Deref for Given<T> {
    type Target = T;
    fn deref(&self) -> &T {
        &self.0
    }
}

/// What a checksum is made of.
trait Digest {
    fn add(&self, hasher: &mut DefaultHasher);
}

impl<T: Digest> Serialize for Given<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut hasher = DefaultHasher::new();
        self.0.add(&mut hasher);
        serializer.collect_str(&format_args!(
            "in memory, checksum {:016x}",
            hasher.finish()
        ))
    }
}

fn add_numbers(numbers: &[f64], hasher: &mut DefaultHasher) {
    hasher.write_usize(numbers.len());
    numbers.iter().for_each(|x| hasher.write_u64(x.to_bits()));
}

impl Digest for MeshArrays {
    fn add(&self, hasher: &mut DefaultHasher) {
        let MeshArrays {
            nodes,
            nodes_per_element,
            elements,
            node_sets,
            face_sets,
        } = self;
        add_numbers(nodes.as_flattened(), hasher);
        hasher.write_usize(*nodes_per_element);
        hasher.write_usize(elements.len());
        elements.iter().for_each(|n| hasher.write_u32(*n));
        for (name, set) in node_sets {
            hasher.write(name.as_bytes());
            hasher.write_usize(set.len());
            set.iter().for_each(|n| hasher.write_u32(*n));
        }
        for (name, set) in face_sets {
            hasher.write(name.as_bytes());
            hasher.write_usize(set.len());
            for (element, face) in set {
                hasher.write_u32(*element);
                hasher.write_u8(*face);
            }
        }
    }
}

impl Digest for MeshCells {
    fn add(&self, hasher: &mut DefaultHasher) {
        let MeshCells {
            points,
            connectivity,
            ends,
            types,
            cell_sets,
            point_sets,
            file,
        } = self;
        add_numbers(points.as_flattened(), hasher);
        for numbers in [connectivity, ends, types] {
            hasher.write_usize(numbers.len());
            numbers.iter().for_each(|n| hasher.write_i64(*n));
        }
        for sets in [cell_sets, point_sets] {
            hasher.write_usize(sets.len());
            for (name, set) in sets {
                hasher.write(name.as_bytes());
                hasher.write_usize(set.len());
                set.iter().for_each(|n| hasher.write_u32(*n));
            }
        }
        hasher.write(format!("{file:?}").as_bytes());
    }
}

impl Digest for Vec<NurbsPatch> {
    fn add(&self, hasher: &mut DefaultHasher) {
        hasher.write_usize(self.len());
        for patch in self {
            // All of it, trims included.
            hasher.write(format!("{patch:?}").as_bytes());
        }
    }
}
