//! Meshes, selections and rigid surfaces.
use super::checker::{Checker, path};
use crate::scene::types::*;
use crate::scene::value::{TIME, Value};

/// Extensions of mesh files.
const MESH_FILES: &[&str] = &["msh", "inp", "bdf", "nas", "vtk", "vtu", "stl"];

/// Extensions of CAD files.
const SURFACE_FILES: &[&str] = &["step", "stp", "iges", "igs", "json"];

/// More elements than this are taken for a mistake.
const MAX_ELEMENTS: f64 = 5e7;

pub(super) fn check_mesh(c: &mut Checker, at: &str, mesh: &MeshSource) {
    match mesh {
        MeshSource::Plate(p) => {
            let at = format!("{at}/plate");
            for (i, size) in p.size.into_iter().enumerate() {
                c.positive(&format!("{at}/size/{i}"), "a length of the plate", size);
            }
            c.positive(&format!("{at}/thickness"), "the thickness", p.thickness);
            c.finite(&format!("{at}/origin"), &p.origin);
            check_counts(c, &at, &[p.elements[0], p.elements[1]], p.layers);
            for i in 0..2 {
                check_spacing(
                    c,
                    &format!("{at}/spacing/{i}"),
                    &p.spacing[i],
                    p.size[i],
                    p.elements[i],
                );
            }
        }
        MeshSource::CylinderPanel(p) => {
            let at = format!("{at}/cylinder_panel");
            check_radius(c, &at, p.radius, p.thickness);
            check_turn(c, &format!("{at}/angles"), "the angles", p.angles);
            c.ordered(&format!("{at}/y"), "the bounds along y", p.y);
            c.finite(&format!("{at}/origin"), &p.origin);
            check_counts(c, &at, &p.elements, p.layers);
        }
        MeshSource::SpherePanel(p) => {
            let at = format!("{at}/sphere_panel");
            check_radius(c, &at, p.radius, p.thickness);
            check_turn(c, &format!("{at}/longitude"), "the longitudes", p.longitude);
            c.ordered(&format!("{at}/latitude"), "the latitudes", p.latitude);
            for (i, latitude) in p.latitude.into_iter().enumerate() {
                if latitude.abs() >= 90.0 {
                    let help = "between -90 and 90, both excluded: elements collapse at a pole";
                    let message = format!("a latitude of {latitude} degrees");
                    c.add(&format!("{at}/latitude/{i}"), message, Some(help.into()));
                }
            }
            c.finite(&format!("{at}/origin"), &p.origin);
            check_counts(c, &at, &p.elements, p.layers);
        }
        MeshSource::Block(b) => {
            let at = format!("{at}/block");
            for i in 0..3 {
                let axis = ["x", "y", "z"][i];
                let bounds = format!("the bounds along {axis}");
                c.ordered(&format!("{at}/max/{i}"), &bounds, [b.min[i], b.max[i]]);
                let length = b.max[i] - b.min[i];
                check_spacing(
                    c,
                    &format!("{at}/spacing/{i}"),
                    &b.spacing[i],
                    length,
                    b.elements[i],
                );
            }
            check_counts(c, &at, &b.elements, 1);
        }
        // Their numbers are checked where the mesh is made.
        MeshSource::Arrays(_) => {}
        MeshSource::Nurbs(nurbs) => check_nurbs(c, at, nurbs),
        MeshSource::Cells(mesh) => check_mesh_file(c, &format!("{at}/cells"), &mesh.file),
        MeshSource::File(f) => {
            let at = format!("{at}/file");
            c.file(&format!("{at}/path"), &f.path, MESH_FILES);
            check_mesh_file(c, &at, f);
        }
    }
}

/// A CAD surface that bends; `at` is the place of `mesh`, beside which it stands.
fn check_nurbs(c: &mut Checker, at: &str, nurbs: &NurbsSurface) {
    let at = at.replace("/mesh", "/nurbs");
    c.file(&format!("{at}/file"), &nurbs.file, SURFACE_FILES);
    c.positive(&format!("{at}/thickness"), "the thickness", nurbs.thickness);
    c.exactly_one(
        &at,
        "size of elements",
        &[
            ("size", nurbs.size.is_some()),
            ("elements", nurbs.elements.is_some()),
        ],
    );
    if let Some(size) = nurbs.size {
        c.positive(&format!("{at}/size"), "the size of elements", size);
    }
    for (i, n) in nurbs.elements.into_iter().flatten().enumerate() {
        c.whole(&format!("{at}/elements/{i}"), n, 1, 2000);
    }
}

fn check_mesh_file(c: &mut Checker, at: &str, file: &MeshFile) {
    c.positive(&format!("{at}/scale"), "the scale", file.scale);
    match &file.thickness {
        Some(Thickness::Uniform(t)) => c.positive(&format!("{at}/thickness"), "the thickness", *t),
        Some(Thickness::BySet(sets)) => {
            if sets.is_empty() {
                let help = "a number, or `{\"set\": number, ...}` with element sets of the file";
                let message = "the thickness names no set";
                c.add(&format!("{at}/thickness"), message, Some(help.into()));
            }
            for (set, t) in sets {
                let at = format!("{at}{}", path(&["thickness", set]));
                c.positive(&at, "the thickness", *t);
            }
        }
        Some(Thickness::Field(text)) => {
            let value = Value::Expression(text.clone());
            c.value(&format!("{at}/thickness"), &value, &Thickness::VARIABLES);
        }
        None => {
            for (field, given) in [
                ("offset", file.offset.is_some()),
                ("layers", file.layers.is_some()),
            ] {
                if given {
                    let message = format!("`{field}` is for surfaces with a `thickness`");
                    let help = "give the surface its `thickness` too; hexahedra have their own";
                    c.add(&format!("{at}/{field}"), message, Some(help.into()));
                }
            }
        }
    }
    if let Some(layers) = file.layers {
        c.whole(&format!("{at}/layers"), layers, 1, 1000);
    }
}

fn check_counts(c: &mut Checker, at: &str, elements: &[u32], layers: u32) {
    for (i, n) in elements.iter().enumerate() {
        c.whole(&format!("{at}/elements/{i}"), *n, 1, MAX_ELEMENTS as u32);
    }
    c.whole(&format!("{at}/layers"), layers, 1, 1000);
    let all = elements.iter().map(|n| f64::from(*n)).product::<f64>() * f64::from(layers);
    if all > MAX_ELEMENTS {
        let message = format!("{all:.3e} elements in all");
        c.add(
            &format!("{at}/elements"),
            message,
            Some(format!("at most {MAX_ELEMENTS:.0e}")),
        );
    }
}

fn check_radius(c: &mut Checker, at: &str, radius: f64, thickness: f64) {
    c.positive(&format!("{at}/radius"), "the radius", radius);
    c.positive(&format!("{at}/thickness"), "the thickness", thickness);
    if radius > 0.0 && thickness >= 2.0 * radius {
        let message =
            format!("the thickness {thickness} is not less than twice the radius {radius}");
        c.add(
            &format!("{at}/thickness"),
            message,
            Some("the radius is that of the mid-surface".into()),
        );
    }
}

fn check_turn(c: &mut Checker, at: &str, what: &str, range: [f64; 2]) {
    c.ordered(at, what, range);
    let turn = range[1] - range[0];
    if turn > 360.0 + 1e-9 {
        let message = format!("{what} span {turn} degrees");
        c.add(
            at,
            message,
            Some("at most one full turn of 360 degrees".into()),
        );
    }
}

fn check_spacing(c: &mut Checker, at: &str, spacing: &Spacing, length: f64, elements: u32) {
    match *spacing {
        Spacing::Uniform => {}
        Spacing::Geometric { ratio } => {
            c.positive(&format!("{at}/geometric/ratio"), "the ratio", ratio)
        }
        Spacing::FromMiddle { ratio } => {
            c.positive(&format!("{at}/from_middle/ratio"), "the ratio", ratio)
        }
        Spacing::Fine {
            length: part,
            fine,
            from_end,
            from_middle,
        } => {
            let at = format!("{at}/fine");
            if from_end && from_middle {
                let message = "`from_end` and `from_middle` are both asked for";
                c.add(
                    &at,
                    message,
                    Some("the fine part lies at one place: leave one out".into()),
                );
            }
            if from_middle && fine < elements && (elements - fine) % 2 == 1 {
                let message = format!(
                    "the {} elements beside the fine part cannot be shared between both of its sides",
                    elements - fine
                );
                c.add(
                    &format!("{at}/fine"),
                    message,
                    Some("give one more or one less".into()),
                );
            }
            c.positive(&format!("{at}/length"), "the length of the fine part", part);
            if part >= length && length > 0.0 {
                let message = format!("the fine part {part} is not shorter than the axis {length}");
                c.add(&format!("{at}/length"), message, None);
            }
            if fine == 0 || fine >= elements {
                let message = format!("{fine} of {elements} elements are fine");
                let help =
                    "at least one is fine, and at least one is left for the rest of the axis";
                c.add(&format!("{at}/fine"), message, Some(help.into()));
            }
        }
    }
}

pub(super) fn check_selection(c: &mut Checker, at: &str, selection: &Selection) {
    let check_box = |c: &mut Checker, at: String, min: &[f64; 3], max: &[f64; 3]| {
        for i in 0..3 {
            let in_order = min[i] <= max[i];
            if !in_order {
                let axis = ["x", "y", "z"][i];
                let message = format!("the box goes from {} to {} along {axis}", min[i], max[i]);
                c.add(
                    &format!("{at}/max/{i}"),
                    message,
                    Some("`min` must not be larger than `max`".into()),
                );
            }
        }
    };
    let check_tolerance = |c: &mut Checker, at: String, tolerance: f64| {
        let valid = tolerance >= 0.0 && tolerance.is_finite();
        if !valid {
            c.add(
                &at,
                format!("the tolerance is {tolerance}"),
                Some("0 or more".into()),
            );
        }
    };
    match selection {
        Selection::NodesInBox(Corners { min, max }) => {
            check_box(c, format!("{at}/nodes_in_box"), min, max)
        }
        Selection::FacesInBox(Corners { min, max }) => {
            check_box(c, format!("{at}/faces_in_box"), min, max)
        }
        Selection::NodesNearPlane {
            normal, tolerance, ..
        } => {
            c.direction(
                &format!("{at}/nodes_near_plane/normal"),
                "the normal",
                *normal,
            );
            check_tolerance(c, format!("{at}/nodes_near_plane/tolerance"), *tolerance);
        }
        Selection::NodesNearPoint { tolerance, .. } => {
            check_tolerance(c, format!("{at}/nodes_near_point/tolerance"), *tolerance);
        }
        Selection::FacesFacing { normal, angle } => {
            c.direction(&format!("{at}/faces_facing/normal"), "the normal", *normal);
            if !(*angle >= 0.0 && *angle <= 180.0) {
                let at = format!("{at}/faces_facing/angle");
                c.add(
                    &at,
                    format!("the angle is {angle} degrees"),
                    Some("from 0 to 180".into()),
                );
            }
        }
    }
}

pub(super) fn check_placement(c: &mut Checker, at: &str, placement: &Placement) {
    c.positive(&format!("{at}/scale"), "the scale", placement.scale);
    let turned = match c.has(&format!("{at}/rotation")) {
        true => format!("{at}/rotation"),
        false => at.to_owned(),
    };
    c.direction(
        &format!("{turned}/axis"),
        "the rotation axis",
        placement.axis,
    );
    c.finite(&format!("{turned}/angle"), &[placement.angle]);
    c.finite(&format!("{turned}/center"), &placement.center);
    c.finite(&format!("{at}/translation"), &placement.translation);
}

pub(super) fn check_surface(c: &mut Checker, at: &str, surface: &Surface) {
    let mut shapes = vec![
        ("cad", surface.cad.is_some()),
        ("sphere", surface.sphere.is_some()),
        ("cylinder", surface.cylinder.is_some()),
        ("plane", surface.plane.is_some()),
    ];
    // Files know nothing of them.
    shapes.extend(surface.patches.as_ref().map(|_| ("patches", true)));
    c.exactly_one(at, "surface", &shapes);
    if let Some(cad) = &surface.cad {
        // The reader tells formats by content, so any extension will do.
        c.file(&format!("{at}/cad/file"), &cad.file, &[]);
        if let Some(tolerance) = cad.tolerance {
            c.positive(&format!("{at}/cad/tolerance"), "the tolerance", tolerance);
        }
    }
    if let Some(facets) = &surface.facets {
        check_facets(c, &format!("{at}/facets"), facets);
    }
    if let Some(s) = &surface.sphere {
        c.positive(&format!("{at}/sphere/radius"), "the radius", s.radius);
        c.direction(&format!("{at}/sphere/axis"), "the axis", s.axis);
    }
    if let Some(s) = &surface.cylinder {
        c.positive(&format!("{at}/cylinder/radius"), "the radius", s.radius);
        c.positive(&format!("{at}/cylinder/length"), "the length", s.length);
        c.direction(&format!("{at}/cylinder/axis"), "the axis", s.axis);
    }
    if let Some(s) = &surface.plane {
        c.direction(&format!("{at}/plane/normal"), "the normal", s.normal);
        for (i, size) in s.size.into_iter().enumerate() {
            c.positive(
                &format!("{at}/plane/size/{i}"),
                "an edge of the plane",
                size,
            );
        }
    }
    check_placement(c, &format!("{at}/placement"), &surface.placement);
    if let Some(depth) = surface.depth {
        c.positive(&format!("{at}/depth"), "the depth", depth);
    }
    for (i, value) in surface.motion.translation.iter().enumerate() {
        c.value(&format!("{at}/motion/translation/{i}"), value, &TIME);
    }
    if let Some(rotation) = &surface.motion.rotation {
        c.direction(
            &format!("{at}/motion/rotation/axis"),
            "the rotation axis",
            rotation.axis,
        );
        c.value(
            &format!("{at}/motion/rotation/angle"),
            &rotation.angle,
            &TIME,
        );
    }
    if let Some(free) = &surface.motion.free {
        check_free(c, &format!("{at}/motion"), &surface.motion, free);
    }
}

/// Components driven by force: at least one, and none that a prescribed motion moves too.
fn check_free(c: &mut Checker, at: &str, motion: &Motion, free: &FreeMotion) {
    let (force, moment) = (free.force.axes(), free.moment.axes());
    if force.iter().chain(&moment).all(|(_, v)| v.is_none()) {
        let help = "name a component of `force` or `moment`, e.g. `\"force\": {\"z\": -5}`, or leave `free` out";
        c.add(
            &format!("{at}/free"),
            "no component of the motion is free",
            Some(help.into()),
        );
    }
    if let Some(center) = free.center {
        c.finite(&format!("{at}/free/center"), &center);
    }
    for (quantity, components) in [("force", force), ("moment", moment)] {
        for (axis, value) in components {
            if let Some(value) = value {
                c.value(&format!("{at}/free/{quantity}/{axis}"), value, &TIME);
            }
        }
    }
    let varies = |v: &Value| v.compile(&TIME).is_ok_and(|f| f.depends_on_time());
    let help = |held: &str| {
        let text = format!(
            "a component either follows {held} or is driven by force; a constant value only says where it starts"
        );
        Some(text)
    };
    for (i, (axis, value)) in force.into_iter().enumerate() {
        if value.is_some() && varies(&motion.translation[i]) {
            c.add(
                &format!("{at}/free/force/{axis}"),
                format!("the translation along {axis} is both prescribed over time and free"),
                help("`translation`"),
            );
        }
    }
    let Some(rotation) = motion.rotation.as_ref().filter(|r| varies(&r.angle)) else {
        return;
    };
    for (i, (axis, value)) in moment.into_iter().enumerate() {
        if value.is_some() && rotation.axis[i] != 0.0 {
            c.add(
                &format!("{at}/free/moment/{axis}"),
                format!("the rotation about {axis} is both prescribed over time and free"),
                help("`rotation`"),
            );
        }
    }
}

fn check_facets(c: &mut Checker, at: &str, facets: &Facets) {
    c.exactly_one(
        at,
        "fineness of the facets",
        &[
            ("chord", facets.chord.is_some()),
            ("size", facets.size.is_some()),
            ("count", facets.count.is_some()),
        ],
    );
    if let Some(chord) = facets.chord {
        c.positive(&format!("{at}/chord"), "the chord error", chord);
    }
    if let Some(size) = facets.size {
        c.positive(&format!("{at}/size"), "the size of the facets", size);
    }
    for (i, count) in facets.count.into_iter().flatten().enumerate() {
        c.whole(&format!("{at}/count/{i}"), count, 1, 100_000);
    }
}
