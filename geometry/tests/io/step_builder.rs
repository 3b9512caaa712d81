//! STEP files from a few lines.

use covact_geometry::io::{CadFile, read_step};
use covact_geometry::{NurbsPatch, PatchSet, Vec3};

/// A data section; every instance is added behind those that it refers to.
#[derive(Default)]
pub struct Step {
    lines: Vec<String>,
}

impl Step {
    /// Adds an instance and gives its name, "#12".
    pub fn add(&mut self, text: impl AsRef<str>) -> String {
        let name = format!("#{}", self.lines.len() + 1);
        self.lines.push(format!("{name}={};", text.as_ref()));
        name
    }

    pub fn point(&mut self, x: [f64; 3]) -> String {
        self.add(format!(
            "CARTESIAN_POINT('',({:?},{:?},{:?}))",
            x[0], x[1], x[2]
        ))
    }

    pub fn direction(&mut self, x: [f64; 3]) -> String {
        self.add(format!("DIRECTION('',({:?},{:?},{:?}))", x[0], x[1], x[2]))
    }

    /// A placement with its third and its first axis.
    pub fn placement(&mut self, at: [f64; 3], z: [f64; 3], x: [f64; 3]) -> String {
        let (at, z, x) = (self.point(at), self.direction(z), self.direction(x));
        self.add(format!("AXIS2_PLACEMENT_3D('',{at},{z},{x})"))
    }

    /// A surface or conic at a placement: `CYLINDRICAL_SURFACE('',place,2.)` from its type and its numbers.
    pub fn placed(&mut self, kind: &str, place: &str, numbers: &str) -> String {
        let comma = if numbers.is_empty() { "" } else { "," };
        self.add(format!("{kind}('',{place}{comma}{numbers})"))
    }

    pub fn vertex(&mut self, x: [f64; 3]) -> String {
        let at = self.point(x);
        self.add(format!("VERTEX_POINT('',{at})"))
    }

    /// A straight edge between two vertices at the points given.
    pub fn line(&mut self, ends: [&str; 2], [a, b]: [[f64; 3]; 2]) -> String {
        let at = self.point(a);
        let along = self.direction([0, 1, 2].map(|k| b[k] - a[k]));
        let along = self.add(format!("VECTOR('',{along},1.)"));
        let line = self.add(format!("LINE('',{at},{along})"));
        self.edge(ends, &line)
    }

    pub fn edge(&mut self, [a, b]: [&str; 2], curve: &str) -> String {
        self.add(format!("EDGE_CURVE('',{a},{b},{curve},.T.)"))
    }

    /// A loop of edges, those with a minus sign in front run through backwards, as a bound.
    pub fn bound(&mut self, edges: &[&str]) -> String {
        let uses: Vec<String> = edges
            .iter()
            .map(|edge| {
                let (flag, edge) = match edge.strip_prefix('-') {
                    Some(edge) => (".F.", edge),
                    None => (".T.", *edge),
                };
                self.add(format!("ORIENTED_EDGE('',*,*,{edge},{flag})"))
            })
            .collect();
        let a_loop = self.add(format!("EDGE_LOOP('',({}))", uses.join(",")));
        self.add(format!("FACE_BOUND('',{a_loop},.T.)"))
    }

    pub fn face(&mut self, bounds: &[&str], surface: &str, same: bool) -> String {
        let flag = if same { ".T." } else { ".F." };
        self.add(format!(
            "ADVANCED_FACE('',({}),{surface},{flag})",
            bounds.join(",")
        ))
    }

    pub fn solid(&mut self, faces: &[&str]) -> String {
        let shell = self.add(format!("CLOSED_SHELL('',({}))", faces.join(",")));
        self.add(format!("MANIFOLD_SOLID_BREP('',{shell})"))
    }

    pub fn sheet(&mut self, faces: &[&str]) -> String {
        let shell = self.add(format!("OPEN_SHELL('',({}))", faces.join(",")));
        self.add(format!("SHELL_BASED_SURFACE_MODEL('',({shell}))"))
    }

    /// A context of millimetres and radians.
    pub fn millimetres(&mut self) -> String {
        let length = self.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
        let angle = self.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
        self.context(&length, &angle)
    }

    pub fn context(&mut self, length: &str, angle: &str) -> String {
        let accuracy = self.add(format!(
            "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-7),{length},'distance_accuracy_value','')"
        ));
        self.add(format!(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({accuracy}))\
             GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle}))REPRESENTATION_CONTEXT('',''))"
        ))
    }

    pub fn shape(&mut self, items: &[&str], context: &str) -> String {
        let items = items.join(",");
        self.add(format!(
            "ADVANCED_BREP_SHAPE_REPRESENTATION('',({items}),{context})"
        ))
    }

    pub fn text(&self) -> String {
        let data = self.lines.join("\n");
        format!(
            "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n\
             FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n{data}\nENDSEC;\nEND-ISO-10303-21;\n"
        )
    }

    pub fn read(&self) -> CadFile {
        read_step(self.text().as_bytes(), "part.step").unwrap()
    }

    /// The file with these items in millimetres, of which every face must be read.
    pub fn whole(mut self, items: &[&str]) -> CadFile {
        let context = self.millimetres();
        self.shape(items, &context);
        let file = self.read();
        assert!(file.skipped.is_empty(), "{:?}", file.skipped);
        file
    }
}

/// The patches of a file, or of one of its bodies, as a set with the sides that the file gives them. Curved patches get
/// knots at every eighth of their spans, which changes nothing but the pieces that integrals are computed on.
pub fn set(file: &CadFile, body: Option<usize>) -> PatchSet {
    let own = |p: &&covact_geometry::io::CadPatch| body.is_none() || p.tags.body == body;
    let patches = file.patches.iter().filter(own).map(|p| fine(&p.patch));
    PatchSet::new(patches.collect(), None).unwrap()
}

fn fine(patch: &NurbsPatch) -> NurbsPatch {
    let mut out = patch.clone();
    let directions = match patch.degree() {
        [1, 1] => 0..0,
        _ => 0..2,
    };
    for dir in directions {
        let spans = patch.spans(dir).into_iter();
        let knots = spans.flat_map(|[a, b]| (1..8).map(move |k| a + (b - a) * f64::from(k) / 8.0));
        out = out.insert_knots(dir, &knots.collect::<Vec<_>>()).unwrap();
    }
    out
}

/// Area of the patches of a set.
pub fn area(set: &PatchSet) -> f64 {
    set.areas().iter().sum()
}

/// What the closed parts of a set enclose, negative where the file's normals point inwards (voids).
pub fn volume(set: &PatchSet) -> f64 {
    let parts = set.components().iter().zip(set.volumes());
    parts
        .map(|(part, volume)| set.sides()[part[0]] * volume.expect("a closed part"))
        .sum()
}

#[track_caller]
pub fn near(found: f64, expected: f64, tolerance: f64) {
    let error = (found / expected - 1.0).abs();
    assert!(
        error < tolerance,
        "{found} instead of {expected}: off by {error:.2e} of it"
    );
}

/// Corners of a box.
fn corners([a, b]: [[f64; 3]; 2]) -> [[f64; 3]; 8] {
    std::array::from_fn(|k| [0, 1, 2].map(|d| if k >> d & 1 == 0 { a[d] } else { b[d] }))
}

/// A cube of side 2 without a context: the file, its solid, its faces.
pub fn cube() -> (Step, String, Vec<String>) {
    let mut step = Step::default();
    let faces = box_faces(&mut step, [[0.; 3], [2.; 3]], [None, None]);
    let refs: Vec<&str> = faces.iter().map(String::as_str).collect();
    let solid = step.solid(&refs);
    (step, solid, faces)
}

/// [`cube`] as the shape of a product in millimetres.
pub fn cube_in_millimetres() -> (Step, String, Vec<String>) {
    let (mut step, solid, faces) = cube();
    let context = step.millimetres();
    step.shape(&[&solid], &context);
    (step, solid, faces)
}

/// The six faces of a box, of planes with normals that point out of it; `holes` adds a bound to the lower (z) and the upper
/// face.
pub fn box_faces(step: &mut Step, extent: [[f64; 3]; 2], holes: [Option<&str>; 2]) -> Vec<String> {
    let x = corners(extent);
    let vertices = x.map(|x| step.vertex(x));
    let mut edges = std::collections::BTreeMap::new();
    for a in 0..8usize {
        for d in [1, 2, 4] {
            if a & d == 0 {
                let b = a | d;
                let edge = step.line([&vertices[a], &vertices[b]], [x[a], x[b]]);
                edges.insert((a, b), edge.clone());
                edges.insert((b, a), format!("-{edge}"));
            }
        }
    }
    // Corners counterclockwise, seen from outside.
    let sides: [([usize; 4], [f64; 3], [f64; 3]); 6] = [
        ([0, 2, 3, 1], [0., 0., -1.], [1., 0., 0.]),
        ([4, 5, 7, 6], [0., 0., 1.], [1., 0., 0.]),
        ([0, 1, 5, 4], [0., -1., 0.], [1., 0., 0.]),
        ([2, 6, 7, 3], [0., 1., 0.], [1., 0., 0.]),
        ([0, 4, 6, 2], [-1., 0., 0.], [0., 1., 0.]),
        ([1, 3, 7, 5], [1., 0., 0.], [0., 1., 0.]),
    ];
    let mut faces = Vec::new();
    for (k, (ring, normal, across)) in sides.into_iter().enumerate() {
        let round: Vec<&str> = (0..4)
            .map(|i| edges[&(ring[i], ring[(i + 1) % 4])].as_str())
            .collect();
        let mut bounds = vec![step.bound(&round)];
        bounds.extend(holes.get(k).copied().flatten().map(str::to_owned));
        let place = step.placement(x[ring[0]], normal, across);
        let plane = step.placed("PLANE", &place, "");
        let bounds: Vec<&str> = bounds.iter().map(String::as_str).collect();
        faces.push(step.face(&bounds, &plane, true));
    }
    faces
}

/// Lowest and highest coordinates of points of all patches, at 33 x 33 points each that belong to the surface.
pub fn extent(file: &CadFile) -> [Vec3; 2] {
    let mut low = Vec3::from_element(f64::INFINITY);
    let mut high = -low;
    for p in &file.patches {
        let [[a, b], [c, d]] = p.patch.domain();
        for k in 0..33 * 33 {
            let s = [f64::from(k % 33) / 32.0, f64::from(k / 33) / 32.0];
            let xi = [a + (b - a) * s[0], c + (d - c) * s[1]];
            if p.patch
                .trim()
                .is_none_or(|t| t.contains(xi) || t.on_border(xi, 1e-9))
            {
                let x = p.patch.point(xi);
                low = low.inf(&x);
                high = high.sup(&x);
            }
        }
    }
    [low, high]
}
