//! What `covact inspect` finds in an STL file.
use super::listing::bounds;
use crate::cli::{InspectArgs, print, print_json};
use covact_geometry::Vec3;
use covact_geometry::io::Stl;
use serde::Serialize;
use std::fmt::Write;

/// Triangles left out that are named one by one.
const NAMED: usize = 12;

/// What is in an STL file, which states no unit of length.
#[derive(Debug, Serialize)]
struct Findings<'a> {
    file: String,
    format: &'static str,
    encoding: &'static str,
    /// In the file.
    triangles: usize,
    /// After merging.
    nodes: usize,
    /// Distance below which vertices are one node.
    tolerance: f64,
    /// Triangles without area (numbers in the file, from 0), which are left out.
    degenerate: &'a [usize],
    /// Edges of one triangle only.
    free_edges: usize,
    /// Edges of more than two triangles.
    branching_edges: usize,
    /// Edges whose two triangles are turned against each other.
    flipped_edges: usize,
    /// Triangles whose stated normal contradicts the order of their vertices.
    normals_against: usize,
    bounds: [[f64; 3]; 2],
    area: f64,
    /// Where every edge has two triangles turned alike.
    volume: Option<f64>,
}

pub(super) fn show(args: &InspectArgs, stl: &Stl) -> u8 {
    let findings = findings(args, stl);
    match args.json {
        true => print_json(&findings),
        false => print(&listing(&findings)),
    }
}

fn findings<'a>(args: &InspectArgs, stl: &'a Stl) -> Findings<'a> {
    let r = &stl.report;
    let corners = || {
        let triangles = stl.triangles.iter();
        triangles.map(|t| t.map(|n| stl.nodes[n as usize]))
    };
    let used = || corners().flatten();
    let start = used().next().unwrap_or_else(Vec3::zeros);
    let low = used().fold(start, |a, b| a.inf(&b));
    let high = used().fold(start, |a, b| a.sup(&b));
    let area = |[a, b, c]: [Vec3; 3]| (b - a).cross(&(c - a)).norm() / 2.0;
    // Tetrahedra with a common corner on the surface, so that little cancels.
    let volume = |[a, b, c]: [Vec3; 3]| (a - start).cross(&(b - start)).dot(&(c - start)) / 6.0;
    let closed = r.free == 0 && r.branching == 0 && r.flipped == 0;
    Findings {
        file: args.file.display().to_string(),
        format: "stl",
        encoding: if r.binary { "binary" } else { "ascii" },
        triangles: r.triangles,
        nodes: stl.nodes.len(),
        tolerance: r.tolerance,
        degenerate: &r.degenerate,
        free_edges: r.free,
        branching_edges: r.branching,
        flipped_edges: r.flipped,
        normals_against: r.normals_against,
        bounds: [low.into(), high.into()],
        area: corners().map(area).sum(),
        volume: closed.then(|| corners().map(volume).sum()),
    }
}

fn listing(f: &Findings) -> String {
    let mut out = String::new();
    // Writing into a string cannot fail.
    let _ = writeln!(
        out,
        "{}: Stl file ({}), states no unit; triangles, no CAD surfaces",
        f.file, f.encoding
    );
    let _ = writeln!(
        out,
        "\n  triangles  {}, {} of them without area and left out",
        f.triangles,
        f.degenerate.len()
    );
    if !f.degenerate.is_empty() {
        let first: Vec<String> = f
            .degenerate
            .iter()
            .take(NAMED)
            .map(usize::to_string)
            .collect();
        let more = if f.degenerate.len() > NAMED {
            ", ..."
        } else {
            ""
        };
        let _ = writeln!(
            out,
            "             left out, counted from 0: {}{more}",
            first.join(", ")
        );
    }
    let _ = writeln!(
        out,
        "  nodes      {} of {} vertices; those within {:.3e} are one",
        f.nodes,
        3 * f.triangles,
        f.tolerance
    );
    let _ = writeln!(
        out,
        "  edges      {} free, {} of more than two triangles, {} with triangles turned against each other",
        f.free_edges, f.branching_edges, f.flipped_edges
    );
    if f.normals_against > 0 {
        let _ = writeln!(
            out,
            "  normals    {} contradict the order of the vertices, which counts",
            f.normals_against
        );
    }
    let _ = writeln!(out, "  bounds     {}", bounds(&f.bounds));
    let _ = writeln!(out, "  area       {:.6}", f.area);
    let _ = match f.volume {
        Some(volume) => writeln!(out, "  closed     volume {volume:.6}"),
        None => writeln!(
            out,
            "  open       not every edge has two triangles turned alike"
        ),
    };
    out
}
