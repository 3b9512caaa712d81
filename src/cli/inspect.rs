//! `covact inspect`.
use super::{InspectArgs, exit, print, print_json, report};
use crate::scene::nearest_file;
use covact_geometry::io::{CadError, CadFile, EntityCount, LengthUnit, Skipped, read_path};
use covact_geometry::project::{CurvatureExtreme, CurvatureRange};
use covact_geometry::{NurbsPatch, PatchSet, Vec3};
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

/// What is in a CAD file. Lengths are in the unit of the file.
#[derive(Debug, Serialize)]
struct Findings<'a> {
    file: &'a str,
    format: covact_geometry::io::CadFormat,
    unit: &'a LengthUnit,
    /// Smallest distance between two points that the writer tells apart.
    resolution: Option<f64>,
    entities: &'a [EntityCount],
    patches: Vec<Patch<'a>>,
    skipped: &'a [Skipped],
    notes: &'a [String],
    /// None when no patch was read.
    surface: Option<Surface>,
}

#[derive(Debug, Serialize)]
struct Patch<'a> {
    /// Number that scenes select it by.
    entity: u32,
    type_number: u32,
    name: Option<&'a str>,
    degree: [usize; 2],
    control_points: [usize; 2],
    rational: bool,
    /// Lowest and highest corner of a box around it.
    bounds: Option<[[f64; 3]; 2]>,
    area: Option<f64>,
    curvature: Option<Curvature>,
    /// Why bounds, area and curvature are not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    fault: Option<String>,
}

/// Smallest radii of curvature, sampled; none where nothing curves that way. The sense is that of the normal
/// rho_1 x rho_2 of the (first) patch in the file.
#[derive(Debug, Serialize)]
struct Curvature {
    smallest_convex_radius: Option<f64>,
    smallest_concave_radius: Option<f64>,
    /// Smallest and largest principal curvature (1 / length).
    range: [f64; 2],
    /// Points at which the surface has no tangent plane.
    singular_points: usize,
}

/// All patches together.
#[derive(Debug, Serialize)]
struct Surface {
    bounds: [[f64; 3]; 2],
    area: f64,
    curvature: Curvature,
    /// Distance at which edges are taken for the same edge.
    tolerance: f64,
    shared_edges: usize,
    smooth_edges: usize,
    sharp_edges: usize,
    partly_shared_edges: usize,
    free_edges: usize,
    /// Edges that are one point.
    poles: usize,
    /// Edges at which more than two patches meet.
    branching_edges: usize,
    largest_gap: f64,
    /// Separate parts.
    components: usize,
}

pub(super) fn inspect(args: &InspectArgs) -> u8 {
    let file = match read_path(&args.file) {
        Ok(file) => file,
        Err(e) => return failed(args, &e),
    };
    let mut fault = None;
    let surface = match file.patches.is_empty() {
        true => None,
        false => {
            match PatchSet::new(file.patches.iter().map(|p| p.patch.clone()).collect(), None) {
                Ok(set) => Some(Surface::new(&set)),
                Err(e) => {
                    fault = Some(e.to_string());
                    None
                }
            }
        }
    };
    let findings = Findings {
        file: &file.path,
        format: file.format,
        unit: &file.unit,
        resolution: file.resolution,
        entities: &file.entities,
        patches: patches(&file),
        skipped: &file.skipped,
        notes: &file.notes,
        surface,
    };
    let code = match args.json {
        true => print_json(&findings),
        false => print(&listing(&findings)),
    };
    if let Some(fault) = fault {
        report::error(&format!("{}: {fault}", file.path));
        return exit::SCENE;
    }
    if !file.skipped.is_empty() {
        let n = file.skipped.len();
        report::warning(&format!(
            "{n} surface{} not read",
            if n == 1 { " was" } else { "s were" }
        ));
    }
    code
}

fn failed(args: &InspectArgs, error: &CadError) -> u8 {
    let (text, code) = fault(&args.file, error);
    report::error(&text);
    code
}

/// What to say when a CAD file cannot be read, and the exit code.
pub(super) fn fault(path: &Path, error: &CadError) -> (String, u8) {
    match error {
        CadError::Read { source, .. } if source.kind() == std::io::ErrorKind::NotFound => {
            let near =
                nearest_file(path).map_or(String::new(), |n| format!("; did you mean `{n}`?"));
            let text = format!("there is no file `{}`{near}", path.display());
            (text, exit::SCENE)
        }
        CadError::Read { .. } => (error.to_string(), exit::IO),
        _ => (error.to_string(), exit::SCENE),
    }
}

fn patches(file: &CadFile) -> Vec<Patch<'_>> {
    let one = |patch: &NurbsPatch| PatchSet::new(vec![patch.clone()], None);
    let patches = file.patches.iter().map(|p| {
        let (set, fault) = match one(&p.patch) {
            Ok(set) => (Some(set), None),
            Err(e) => (None, Some(e.to_string())),
        };
        Patch {
            entity: p.entity,
            type_number: p.type_number,
            name: p.name.as_deref(),
            degree: p.patch.degree(),
            control_points: p.patch.counts(),
            rational: p.patch.is_rational(),
            bounds: set.as_ref().map(|s| s.bounds().map(corner)),
            area: set.as_ref().map(|s| s.areas().iter().sum()),
            curvature: set.as_ref().map(|s| Curvature::new(&s.curvature_range())),
            fault,
        }
    });
    patches.collect()
}

fn corner(x: Vec3) -> [f64; 3] {
    [x.x, x.y, x.z]
}

impl Curvature {
    fn new(range: &CurvatureRange) -> Self {
        let radius = |c: &Option<CurvatureExtreme>| c.map(|c| c.radius());
        let kappa = |c: &Option<CurvatureExtreme>| c.map_or(0.0, |c| c.kappa);
        Curvature {
            smallest_convex_radius: radius(&range.convex),
            smallest_concave_radius: radius(&range.concave),
            range: [kappa(&range.convex), kappa(&range.concave)],
            singular_points: range.skipped,
        }
    }
}

impl Surface {
    fn new(set: &PatchSet) -> Self {
        let edges = set.edges();
        Surface {
            bounds: set.bounds().map(corner),
            area: set.areas().iter().sum(),
            curvature: Curvature::new(&set.curvature_range()),
            tolerance: edges.tolerance,
            shared_edges: edges.joints.len(),
            smooth_edges: edges.smooth,
            sharp_edges: edges.sharp,
            partly_shared_edges: edges.partial.len(),
            free_edges: edges.free.len(),
            poles: edges.poles.len(),
            branching_edges: edges.branching.len(),
            largest_gap: edges.largest_gap,
            components: set.components().len(),
        }
    }
}

fn listing(f: &Findings) -> String {
    let mut out = String::new();
    // Writing into a string cannot fail.
    let _ = writeln!(out, "{}: {:?} file, unit {}", f.file, f.format, f.unit.name);
    if let Some(resolution) = f.resolution {
        let _ = writeln!(out, "resolution {resolution:e}");
    }
    let _ = writeln!(out, "\nentities");
    for e in f.entities {
        let number = match e.type_number {
            0 => String::new(),
            n => format!("{n}:{}", e.form),
        };
        let _ = writeln!(out, "{:>7} x {number:<7} {}", e.count, e.name);
    }
    let _ = writeln!(out, "\npatches: {}", f.patches.len());
    if !f.patches.is_empty() {
        let _ = writeln!(
            out,
            "{:>8} {:>6} {:>9} {:>8} {:>12} {:>12} {:>12}  bounds",
            "entity", "degree", "points", "rational", "area", "convex R", "concave R"
        );
    }
    for p in &f.patches {
        let radius = |r: Option<Option<f64>>| match r {
            Some(Some(r)) => format!("{r:.6}"),
            Some(None) => "-".to_string(),
            None => "?".to_string(),
        };
        let convex = radius(p.curvature.as_ref().map(|c| c.smallest_convex_radius));
        let concave = radius(p.curvature.as_ref().map(|c| c.smallest_concave_radius));
        let _ = writeln!(
            out,
            "{:>8} {:>6} {:>9} {:>8} {:>12} {convex:>12} {concave:>12}  {}",
            p.entity,
            format!("{}x{}", p.degree[0], p.degree[1]),
            format!("{}x{}", p.control_points[0], p.control_points[1]),
            if p.rational { "yes" } else { "no" },
            p.area.map_or("?".to_string(), |a| format!("{a:.6}")),
            match (&p.bounds, &p.fault) {
                (Some(b), _) => bounds(b),
                (None, fault) => fault.clone().unwrap_or_default(),
            }
        );
    }
    if let Some(s) = &f.surface {
        let _ = writeln!(out, "\nall patches");
        let _ = writeln!(out, "  bounds     {}", bounds(&s.bounds));
        let _ = writeln!(out, "  area       {:.6}", s.area);
        let [low, high] = s.curvature.range;
        let _ = writeln!(
            out,
            "  curvature  {low:.6} to {high:.6}, smallest radii {}",
            radii(&s.curvature)
        );
        let _ = writeln!(
            out,
            "  edges      {} shared ({} smooth, {} sharp; {} in part only), {} free, {} poles; largest gap {:.3e}, \
             tolerance {:.3e}",
            s.shared_edges,
            s.smooth_edges,
            s.sharp_edges,
            s.partly_shared_edges,
            s.free_edges,
            s.poles,
            s.largest_gap,
            s.tolerance
        );
        if s.branching_edges > 0 {
            let _ = writeln!(
                out,
                "             more than two patches meet at {} edges",
                s.branching_edges
            );
        }
        let _ = writeln!(out, "  parts      {}", s.components);
    }
    let _ = writeln!(out, "\nskipped: {}", f.skipped.len());
    for s in f.skipped {
        let kind = if s.type_number == 0 {
            String::new()
        } else {
            format!(" (type {})", s.type_number)
        };
        let _ = writeln!(out, "  entity {}, {}{kind}: {}", s.entity, s.name, s.reason);
    }
    for note in f.notes {
        let _ = writeln!(out, "note: {note}");
    }
    out
}

fn radii(c: &Curvature) -> String {
    let one = |r: Option<f64>, sense: &str| r.map(|r| format!("{r:.6} {sense}"));
    let both: Vec<String> = [
        one(c.smallest_convex_radius, "convex"),
        one(c.smallest_concave_radius, "concave"),
    ]
    .into_iter()
    .flatten()
    .collect();
    match both.is_empty() {
        true => "none (flat)".to_string(),
        false => both.join(", "),
    }
}

fn bounds([low, high]: &[[f64; 3]; 2]) -> String {
    let axis = |i: usize| format!("[{:.4}, {:.4}]", low[i], high[i]);
    format!("{} {} {}", axis(0), axis(1), axis(2))
}
