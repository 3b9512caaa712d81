//! Runs the shipped scenes, changed where a test needs it, and reads their results.
use covact::output::{Summary, Table, read_csv};
use covact::run::{RunOptions, run};
use covact::scene;
use covact::solve::event::{Event, Observer};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// Results of a run.
pub struct Outcome {
    pub summary: Summary,
    pub history: Table,
    pub events: Vec<Event>,
    /// Holds the results while the test looks at them.
    pub folder: tempfile::TempDir,
}

/// Keeps every event.
#[derive(Default)]
struct Recorder(Vec<Event>);

impl Observer for Recorder {
    fn event(&mut self, event: &Event) {
        if std::env::var_os("COVACT_TRACE").is_some() {
            println!("{event:?}");
        }
        self.0.push(event.clone());
    }
}

fn scenes() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("examples/scenes")
}

/// The JSON of a shipped scene.
pub fn scene_json(name: &str) -> Value {
    let text = std::fs::read_to_string(scenes().join(name)).expect("shipped scene");
    serde_json::from_str(&text).expect("valid JSON")
}

/// Sets the value at a JSON pointer that exists.
pub fn set(scene: &mut Value, pointer: &str, value: impl Into<Value>) {
    *scene.pointer_mut(pointer).expect(pointer) = value.into();
}

/// Runs a scene; paths in it are relative to the shipped scenes.
pub fn solve(scene: &Value) -> Outcome {
    solve_in(scene, &scenes())
}

/// Runs a scene; paths in it are relative to `dir`.
pub fn solve_in(scene: &Value, dir: &Path) -> Outcome {
    let text = serde_json::to_string_pretty(scene).expect("serialisable");
    let mut loaded = match scene::parse(&text, "scene.json") {
        Ok(loaded) => loaded,
        Err(e) => panic!("{e}"),
    };
    loaded.dir = dir.to_path_buf();
    // Fields are read back, and compared with what they are to every digit.
    loaded.scene.output.full_precision = true;
    let folder = tempfile::tempdir().expect("temporary folder");
    let mut recorder = Recorder::default();
    let never = AtomicBool::new(false);
    let options = RunOptions::default();
    let summary = match run(&loaded, folder.path(), &options, &mut recorder, &never) {
        Ok(summary) => summary,
        Err(e) => panic!("{e}"),
    };
    let history = read_csv(&folder.path().join("history.csv")).expect("history");
    Outcome {
        summary,
        history,
        events: recorder.0,
        folder,
    }
}

impl Outcome {
    /// A column of the history.
    pub fn column(&self, name: &str) -> Vec<f64> {
        self.history
            .column(name)
            .unwrap_or_else(|| panic!("no column {name} in {:?}", self.history.columns))
    }

    /// Value of a column at the step that ends at `time`.
    pub fn at(&self, name: &str, time: f64) -> f64 {
        let times = self.column("time");
        let row = (times.iter().position(|t| (t - time).abs() < 1e-9))
            .unwrap_or_else(|| panic!("no step ends at {time}: {times:?}"));
        self.column(name)[row]
    }
}

/// A body read back from its `.vtu` file.
pub struct BodyFile {
    /// Undeformed positions.
    pub points: Vec<[f64; 3]>,
    /// Nodes of the hexahedra in VTK's order.
    cells: Vec<[usize; 8]>,
    fields: Vec<(String, Vec<f64>)>,
}

impl Outcome {
    /// The fields of a body at a step.
    pub fn body(&self, name: &str, step: u32) -> BodyFile {
        use vtkio::model::{Attribute, DataSet, Piece, VertexNumbers, Vtk};
        let path = self.folder.path().join(format!("{name}_{step:04}.vtu"));
        let bytes = std::fs::read(&path).expect("a file");
        let bytes = covact::output::inlined(&bytes).expect("whole arrays");
        let vtk = Vtk::parse_xml(&bytes[..]).expect("readable file");
        let DataSet::UnstructuredGrid { pieces, .. } = vtk.data else {
            panic!("{} is no unstructured grid", path.display());
        };
        let Some(Piece::Inline(piece)) = pieces.into_iter().next() else {
            panic!("{} has no piece", path.display());
        };
        let numbers: Vec<f64> = piece.points.cast_into().expect("numbers");
        let VertexNumbers::XML { connectivity, .. } = piece.cells.cell_verts else {
            panic!("XML expected");
        };
        let fields = (piece.data.point.into_iter())
            .filter_map(|a| match a {
                Attribute::DataArray(d) => Some((d.name, d.data.cast_into().expect("numbers"))),
                Attribute::Field { .. } => None,
            })
            .collect();
        BodyFile {
            points: numbers
                .chunks_exact(3)
                .map(|p| [p[0], p[1], p[2]])
                .collect(),
            cells: (connectivity.chunks_exact(8))
                .map(|c| std::array::from_fn(|i| c[i] as usize))
                .collect(),
            fields,
        }
    }
}

impl BodyFile {
    /// A point field.
    pub fn field(&self, name: &str) -> &[f64] {
        let found = self.fields.iter().find(|f| f.0 == name);
        &found.unwrap_or_else(|| panic!("no field {name}")).1
    }

    /// Nodes with the largest z that satisfy a condition.
    pub fn top_nodes(&self, condition: impl Fn(&[f64; 3]) -> bool) -> Vec<usize> {
        let top = self.points.iter().fold(f64::MIN, |a, p| a.max(p[2]));
        (0..self.points.len())
            .filter(|&n| self.points[n][2] > top - 1e-9 && condition(&self.points[n]))
            .collect()
    }

    /// Faces with the largest z and x, y below `limit`, nodes with x fastest.
    pub fn top_faces(&self, limit: f64) -> Vec<[usize; 4]> {
        let top = self.points.iter().fold(f64::MIN, |a, p| a.max(p[2]));
        (self.cells.iter())
            .map(|c| [c[4], c[5], c[7], c[6]])
            .filter(|f| {
                f.iter().all(|&n| {
                    let p = self.points[n];
                    p[2] > top - 1e-9 && p[0] <= limit && p[1] <= limit
                })
            })
            .collect()
    }
}

/// Triangles of a box from `min` to `max`, as an STL file.
pub fn stl_box(min: [f64; 3], max: [f64; 3]) -> String {
    let corner = |k: usize| [0, 1, 2].map(|c| if k >> c & 1 == 1 { max[c] } else { min[c] });
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let mut text = "solid box\n".to_owned();
    for [a, b, c, d] in faces {
        for triangle in [[a, b, c], [a, c, d]] {
            text += "facet normal 0 0 0\nouter loop\n";
            for [x, y, z] in triangle.map(corner) {
                text += &format!("vertex {x} {y} {z}\n");
            }
            text += "endloop\nendfacet\n";
        }
    }
    text + "endsolid box\n"
}
