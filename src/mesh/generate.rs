//! Structured meshes: a grid of elements r x s x t mapped into space, t being the thickness. Counts and spacing are those
//! of the elements; the nodes in the middle of quadratic ones lie midway along the axis or the angle, so that they are on
//! the exact cylinder or sphere.
use super::error::MAX_NODES;
use super::spacing::positions;
use super::{ElementKind, Face, Mesh, MeshError, size};
use crate::machine::memory;
use crate::scene::{Block, CylinderPanel, Plate, Spacing, SpherePanel};
use covact_geometry::Vec3;
use std::collections::BTreeMap;

/// Angles of the surfaces of revolution are coarser than this per element only by mistake, degrees.
const MAX_ANGLE: f64 = 120.0;

/// Mesh of a flat plate: r along x, s along y, thickness along z.
pub fn plate(plate: &Plate, kind: ElementKind) -> Result<Mesh, MeshError> {
    const WHAT: &str = "plate";
    positive(WHAT, "size[0]", plate.size[0])?;
    positive(WHAT, "size[1]", plate.size[1])?;
    positive(WHAT, "thickness", plate.thickness)?;
    finite(WHAT, "origin", &plate.origin)?;
    let counts = [plate.elements[0], plate.elements[1], plate.layers];
    let grid = Grid::new(
        WHAT,
        kind,
        counts,
        ["elements[0]", "elements[1]", "layers"],
        false,
    )?;
    let x = grid.along(positions(&plate.spacing[0], plate.size[0], counts[0], "x")?);
    let y = grid.along(positions(&plate.spacing[1], plate.size[1], counts[1], "y")?);
    let z = positions(&Spacing::Uniform, plate.thickness, counts[2], "z")?;
    let o = plate.origin;
    let half = 0.5 * plate.thickness;
    let names = ["x_min", "x_max", "y_min", "y_max", "bottom", "top"];
    Ok(grid.mesh(names, |i, j, k| {
        Vec3::new(o[0] + x[i], o[1] + y[j], o[2] + (z[k] - half))
    }))
}

/// Mesh of a cylinder panel: r along phi, s along y, thickness outwards. A full turn shares the nodes of its seam.
pub fn cylinder_panel(panel: &CylinderPanel, kind: ElementKind) -> Result<Mesh, MeshError> {
    const WHAT: &str = "cylinder_panel";
    radii(WHAT, panel.radius, panel.thickness)?;
    finite(WHAT, "origin", &panel.origin)?;
    let (turn, closed) = turn(WHAT, "angles", panel.angles, panel.elements[0])?;
    let length = extent(WHAT, "y", panel.y)?;
    let counts = [panel.elements[0], panel.elements[1], panel.layers];
    let grid = Grid::new(
        WHAT,
        kind,
        counts,
        ["elements[0]", "elements[1]", "layers"],
        closed,
    )?;
    let phi = grid.along(positions(&Spacing::Uniform, turn, counts[0], "phi")?);
    let y = grid.along(positions(&Spacing::Uniform, length, counts[1], "y")?);
    let t = positions(
        &Spacing::Uniform,
        panel.thickness,
        counts[2],
        "the thickness",
    )?;
    let o = panel.origin;
    let inner = panel.radius - 0.5 * panel.thickness;
    let names = ["phi_min", "phi_max", "y_min", "y_max", "inner", "outer"];
    Ok(grid.mesh(names, |i, j, k| {
        let (sin, cos) = sin_cos_degrees(panel.angles[0] + phi[i]);
        let r = inner + t[k];
        Vec3::new(o[0] + r * sin, o[1] + panel.y[0] + y[j], o[2] + r * cos)
    }))
}

/// Mesh of a sphere panel: r along longitude, s along latitude, thickness outwards. The poles are on the y axis and
/// longitude is the angle phi of a cylinder panel: `x = r cos(lat) sin(lon)`, `y = r sin(lat)`,
/// `z = r cos(lat) cos(lon)`. A full turn shares the nodes of its seam and has no longitude sets.
pub fn sphere_panel(panel: &SpherePanel, kind: ElementKind) -> Result<Mesh, MeshError> {
    const WHAT: &str = "sphere_panel";
    radii(WHAT, panel.radius, panel.thickness)?;
    finite(WHAT, "origin", &panel.origin)?;
    let (turn, closed) = turn(WHAT, "longitude", panel.longitude, panel.elements[0])?;
    let rise = extent(WHAT, "latitude", panel.latitude)?;
    for (i, latitude) in panel.latitude.into_iter().enumerate() {
        // Closer to the pole than this, the elements' edges there shrink to round-off.
        if latitude.abs() > 90.0 - 1e-6 {
            return Err(invalid(
                WHAT,
                &format!("latitude[{i}]"),
                latitude,
                "a latitude between the poles (-90 to 90, both excluded): elements collapse at a pole, leave a hole",
            ));
        }
    }
    let counts = [panel.elements[0], panel.elements[1], panel.layers];
    let grid = Grid::new(
        WHAT,
        kind,
        counts,
        ["elements[0]", "elements[1]", "layers"],
        closed,
    )?;
    let lon = grid.along(positions(&Spacing::Uniform, turn, counts[0], "longitude")?);
    let lat = grid.along(positions(&Spacing::Uniform, rise, counts[1], "latitude")?);
    let t = positions(
        &Spacing::Uniform,
        panel.thickness,
        counts[2],
        "the thickness",
    )?;
    let o = panel.origin;
    let inner = panel.radius - 0.5 * panel.thickness;
    let names = [
        "longitude_min",
        "longitude_max",
        "latitude_min",
        "latitude_max",
        "inner",
        "outer",
    ];
    Ok(grid.mesh(names, |i, j, k| {
        let (sin_lon, cos_lon) = sin_cos_degrees(panel.longitude[0] + lon[i]);
        let (sin_lat, cos_lat) = sin_cos_degrees(panel.latitude[0] + lat[j]);
        let r = inner + t[k];
        Vec3::new(
            o[0] + r * cos_lat * sin_lon,
            o[1] + r * sin_lat,
            o[2] + r * cos_lat * cos_lon,
        )
    }))
}

/// Mesh of a box: r, s, t along x, y, z. `bottom` and `top` are further names of `z_min` and `z_max`.
pub fn block(block: &Block, kind: ElementKind) -> Result<Mesh, MeshError> {
    const WHAT: &str = "block";
    let fields = ["elements[0]", "elements[1]", "elements[2]"];
    let mut size = [0.0; 3];
    for (a, axis) in ["x", "y", "z"].into_iter().enumerate() {
        size[a] = extent(
            WHAT,
            &format!("min/max along {axis}"),
            [block.min[a], block.max[a]],
        )?;
    }
    let grid = Grid::new(WHAT, kind, block.elements, fields, false)?;
    let x = grid.along(positions(
        &block.spacing[0],
        size[0],
        block.elements[0],
        "x",
    )?);
    let y = grid.along(positions(
        &block.spacing[1],
        size[1],
        block.elements[1],
        "y",
    )?);
    let z = positions(&block.spacing[2], size[2], block.elements[2], "z")?;
    let names = ["x_min", "x_max", "y_min", "y_max", "z_min", "z_max"];
    // The far side is taken from `max`, not from min + size, so that it is exact.
    let at = |a: usize, s: &[f64], i: usize| {
        if i + 1 == s.len() {
            block.max[a]
        } else {
            block.min[a] + s[i]
        }
    };
    let mut mesh = grid.mesh(names, |i, j, k| {
        Vec3::new(at(0, &x, i), at(1, &y, j), at(2, &z, k))
    });
    for (name, other) in [("bottom", "z_min"), ("top", "z_max")] {
        let (faces, nodes) = (mesh.face_sets[other].clone(), mesh.node_sets[other].clone());
        mesh.face_sets.insert(name.to_string(), faces);
        mesh.node_sets.insert(name.to_string(), nodes);
    }
    Ok(mesh)
}

/// Counts of elements along r, s, t, with their product known to be in range.
struct Grid {
    kind: ElementKind,
    counts: [usize; 3],
    /// The last nodes along r are the first ones.
    closed: bool,
}

impl Grid {
    fn new(
        what: &'static str,
        kind: ElementKind,
        counts: [u32; 3],
        fields: [&str; 3],
        closed: bool,
    ) -> Result<Grid, MeshError> {
        for (count, field) in counts.into_iter().zip(fields) {
            if count == 0 {
                return Err(invalid(what, field, count, "at least 1 element"));
            }
        }
        let nodes = (counts.iter().zip(order(kind)))
            .map(|(&n, order)| u128::from(n) * order as u128 + 1)
            .product::<u128>();
        if nodes > u128::from(MAX_NODES) {
            return Err(MeshError::TooManyNodes { what, nodes });
        }
        let elements: u64 = counts.into_iter().map(u64::from).product();
        memory::ask(size::bytes(nodes as u64, elements, kind)).map_err(|shortage| {
            MeshError::Memory {
                what,
                nodes: nodes as u64,
                shortage,
            }
        })?;
        Ok(Grid {
            kind,
            counts: counts.map(|n| n as usize),
            closed,
        })
    }

    /// Positions of all nodes along r or s from those of the corners.
    fn along(&self, corners: Vec<f64>) -> Vec<f64> {
        if order(self.kind)[0] == 1 {
            return corners;
        }
        let mut all = Vec::with_capacity(2 * corners.len());
        for pair in corners.windows(2) {
            all.extend([pair[0], 0.5 * (pair[0] + pair[1])]);
        }
        all.extend(corners.last());
        all
    }

    /// Builds the mesh; `names` are those of the local faces 0 to 5, `at` gives the position of a grid point.
    fn mesh(&self, names: [&str; 6], at: impl Fn(usize, usize, usize) -> Vec3) -> Mesh {
        let [nr, ns, nt] = self.counts;
        let [or, os, ot] = order(self.kind);
        // The last grid point along each direction.
        let [er, es, et] = [nr * or, ns * os, nt * ot];
        let row = if self.closed { er } else { er + 1 };
        let number = |i: usize, j: usize, k: usize| (i % row + row * (j + (es + 1) * k)) as u32;
        let mut nodes = Vec::with_capacity(row * (es + 1) * (et + 1));
        for k in 0..=et {
            for j in 0..=es {
                nodes.extend((0..row).map(|i| at(i, j, k)));
            }
        }
        let per_element = self.kind.nodes();
        let mut connectivity = Vec::with_capacity(per_element * nr * ns * nt);
        let mut faces: [Vec<Face>; 6] = Default::default();
        for k in 0..nt {
            for j in 0..ns {
                for i in 0..nr {
                    let element = (connectivity.len() / per_element) as u32;
                    connectivity.extend((0..per_element).map(|a| {
                        let (a, b, c) = (
                            a % (or + 1),
                            a / (or + 1) % (os + 1),
                            a / ((or + 1) * (os + 1)),
                        );
                        number(i * or + a, j * os + b, k * ot + c)
                    }));
                    let outer = [
                        i == 0 && !self.closed,
                        i + 1 == nr && !self.closed,
                        j == 0,
                        j + 1 == ns,
                        k == 0,
                        k + 1 == nt,
                    ];
                    for (face, set) in faces.iter_mut().enumerate().filter(|(f, _)| outer[*f]) {
                        set.push(Face {
                            element,
                            face: face as u8,
                        });
                    }
                }
            }
        }
        let mut mesh = Mesh {
            kind: self.kind,
            nodes,
            connectivity,
            node_sets: BTreeMap::new(),
            face_sets: BTreeMap::new(),
        };
        for (name, set) in names
            .into_iter()
            .zip(faces)
            .filter(|(_, set)| !set.is_empty())
        {
            mesh.node_sets.insert(name.to_string(), mesh.nodes_of(&set));
            mesh.face_sets.insert(name.to_string(), set);
        }
        mesh
    }
}

/// Degrees of the elements along r, s and t.
const fn order(kind: ElementKind) -> [usize; 3] {
    match kind {
        ElementKind::H8 => [1, 1, 1],
        ElementKind::Q18 | ElementKind::Nurbs => [2, 2, 1],
    }
}

/// Sine and cosine of an angle in degrees, exact at multiples of 90 so that symmetry planes are flat.
fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let turns = degrees.rem_euclid(360.0);
    let quadrant = (turns / 90.0).floor();
    let (s, c) = (turns - 90.0 * quadrant).to_radians().sin_cos();
    match quadrant as u8 {
        1 => (c, -s),
        2 => (-s, -c),
        3 => (-c, s),
        _ => (s, c),
    }
}

fn invalid(
    what: &'static str,
    field: &str,
    value: impl std::fmt::Display,
    expected: &str,
) -> MeshError {
    MeshError::Invalid {
        what,
        field: field.to_string(),
        value: value.to_string(),
        expected: expected.to_string(),
    }
}

fn positive(what: &'static str, field: &str, value: f64) -> Result<(), MeshError> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(invalid(what, field, value, "a positive length"))
    }
}

fn finite(what: &'static str, field: &str, values: &[f64; 3]) -> Result<(), MeshError> {
    match values.iter().position(|v| !v.is_finite()) {
        None => Ok(()),
        Some(i) => Err(invalid(
            what,
            &format!("{field}[{i}]"),
            values[i],
            "a finite number",
        )),
    }
}

/// Length of the range `[a, b]`, which must be positive.
fn extent(what: &'static str, field: &str, [a, b]: [f64; 2]) -> Result<f64, MeshError> {
    let length = b - a;
    if length.is_finite() && length > 0.0 {
        Ok(length)
    } else {
        Err(invalid(
            what,
            field,
            format!("[{a}, {b}]"),
            "finite numbers, the first below the second",
        ))
    }
}

fn radii(what: &'static str, radius: f64, thickness: f64) -> Result<(), MeshError> {
    positive(what, "radius", radius)?;
    positive(what, "thickness", thickness)?;
    if thickness >= 2.0 * radius * (1.0 - 1e-9) {
        let expected = format!(
            "less than twice the radius of the mid-surface ({})",
            2.0 * radius
        );
        return Err(invalid(what, "thickness", thickness, &expected));
    }
    Ok(())
}

/// Angle of a range in degrees and whether it is a full turn.
fn turn(
    what: &'static str,
    field: &str,
    range: [f64; 2],
    elements: u32,
) -> Result<(f64, bool), MeshError> {
    let angle = extent(what, field, range)?;
    let closed = (angle - 360.0).abs() < 1e-9;
    if angle > 360.0 && !closed {
        let value = format!("[{}, {}]", range[0], range[1]);
        return Err(invalid(
            what,
            field,
            value,
            "at most one full turn of 360 degrees",
        ));
    }
    if elements > 0 && angle / f64::from(elements) > MAX_ANGLE + 1e-9 {
        let expected = format!(
            "at least {} for {angle} degrees (one per {MAX_ANGLE})",
            (angle / MAX_ANGLE).ceil()
        );
        return Err(invalid(what, "elements[0]", elements, &expected));
    }
    Ok((if closed { 360.0 } else { angle }, closed))
}
