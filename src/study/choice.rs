//! What the values of choices change in a scene.
use super::change::{Fault, Variant};
use super::file::{Choice, Fineness, MasterChoice, PointsChoice, StlSource, TangentChoice};
use super::triangles::Maker;
use crate::scene::{Points, nearest, pointer, shorten, suggestion};
use serde::Serialize;
use serde_json::{Value as Json, json};
use std::path::Path;

/// Makes the changes of value `k` of a choice, which stands at `at` in the study file. `dir` is the folder of that file.
pub(super) fn apply(
    choice: &Choice,
    k: usize,
    at: &str,
    variant: &mut Variant,
    (maker, dir): (&mut Maker, &Path),
) -> Result<(), Fault> {
    let own = format!("{at}/{}", choice.key());
    let from = format!("{own}/values/{k}");
    let part = |section: &str, variant: &Variant| part(section, choice.target(), &own, variant);
    match choice {
        Choice::Master { values, .. } => {
            let surface = part("surfaces", variant)?;
            match values.get(k) {
                Some(value) => master(value, &surface, &from, variant, (maker, dir)),
                None => Ok(()),
            }
        }
        Choice::Shell { values, .. } => {
            let body = part("bodies", variant)?;
            match values.get(k) {
                Some(value) => match Vec::from_iter(value)[..] {
                    [(element, counts)] => shell(&body, element, counts, &from, variant),
                    _ => Err(Fault::new(from, "a shell is one element and its numbers")
                        .help("write `{\"h8\": [10, 10]}`")),
                },
                None => Ok(()),
            }
        }
        Choice::Points { values, .. } => {
            let contact = part("contacts", variant)?;
            let (points, gap) = match values.get(k) {
                None => return Ok(()),
                Some(PointsChoice::Nodes) => (Points::Nodes, None),
                Some(PointsChoice::Gauss(n)) => (Points::Gauss(*n), None),
                Some(PointsChoice::Lobatto(n)) => (Points::Lobatto(*n), None),
                Some(PointsChoice::Segments(n)) => (Points::Segments(*n), None),
                Some(PointsChoice::Averaged(points)) => (*points, Some(json!("averaged"))),
            };
            let here = |key: &str| pointer(&["contacts", &contact, key]);
            variant.set(&here("points"), &written(&points), &from)?;
            match gap {
                Some(gap) => variant.set(&here("gap"), &gap, &from),
                None => {
                    variant.clear(&here("gap"), &from);
                    Ok(())
                }
            }
        }
        Choice::Tangent { values, .. } => {
            let contact = part("contacts", variant)?;
            let published = |rotational: bool, curvature: bool| json!({ "published": { "rotational": rotational, "curvature": curvature } });
            let tangent = match values.get(k) {
                None => return Ok(()),
                Some(TangentChoice::Exact) => json!("exact"),
                Some(TangentChoice::Published) => published(true, true),
                Some(TangentChoice::WithoutRotational) => published(false, true),
                Some(TangentChoice::WithoutCurvature) => published(true, false),
                Some(TangentChoice::Main) => published(false, false),
            };
            variant.set(
                &pointer(&["contacts", &contact, "tangent"]),
                &tangent,
                &from,
            )
        }
        Choice::Penalty { values, .. } => {
            let contact = part("contacts", variant)?;
            let value = values.get(k).map_or(Json::Null, written);
            variant.set(&pointer(&["contacts", &contact, "penalty"]), &value, &from)
        }
        Choice::Augmentation { values, .. } => {
            let contact = part("contacts", variant)?;
            let here = pointer(&["contacts", &contact, "augmentation"]);
            match values.get(k) {
                Some(Json::Object(_)) => variant.set(&here, &values[k], &from),
                Some(Json::String(none)) if none == "none" => {
                    variant.clear(&here, &from);
                    Ok(())
                }
                Some(other) => Err(Fault::new(
                    &from,
                    format!(
                        "expected \"none\" or an object, found {}",
                        shorten(&other.to_string())
                    ),
                )
                .help("write `{\"gap\": 1e-4}` or, with all defaults, `{}`")),
                None => Ok(()),
            }
        }
        Choice::Step { values } => {
            let Some(step) = values.get(k) else {
                return Ok(());
            };
            let here = |key: &str| format!("/solution/step/{key}");
            variant.set(&here("initial"), &json!(step), &from)?;
            variant.set(&here("max"), &json!(step), &from)?;
            variant.set(&here("adaptive"), &json!(false), &from)
        }
        Choice::Tolerance { values } => {
            let value = values.get(k).map_or(Json::Null, |t| json!(t));
            variant.set("/solution/newton/tolerance", &value, &from)
        }
        Choice::Key { at, values, .. } => {
            let value = values.get(k).unwrap_or(&Json::Null);
            at.iter().try_for_each(|at| variant.set(at, value, &from))
        }
        Choice::Variants { values, .. } => {
            let changes = values.get(k).into_iter().flat_map(|v| &v.set);
            for (at, value) in changes {
                let from = format!("{from}{}", pointer(&["set", at]));
                variant.set(at, value, &from)?;
            }
            Ok(())
        }
    }
}

/// As JSON; writing plain data into memory cannot fail.
fn written<T: Serialize>(value: &T) -> Json {
    serde_json::to_value(value).unwrap_or_default()
}

/// The part of a section that a choice is about: the one that it names, or the only one.
fn part(section: &str, named: Option<&str>, at: &str, variant: &Variant) -> Result<String, Fault> {
    let what = match section {
        "surfaces" => "surface",
        "bodies" => "body",
        _ => "contact",
    };
    let members = variant.scene.get(section).and_then(Json::as_object);
    let names: Vec<&str> = members
        .into_iter()
        .flatten()
        .map(|(name, _)| name.as_str())
        .collect();
    match (named, &names[..]) {
        (Some(name), _) if names.contains(&name) => Ok(name.to_owned()),
        (Some(name), _) => Err(Fault::new(
            format!("{at}/{what}"),
            format!("the scene has no {what} `{}`", shorten(name)),
        )
        .help(suggestion(name, section, names.iter().copied()))),
        (None, [only]) => Ok((*only).to_owned()),
        (None, []) => Err(Fault::new(at, format!("the scene has no {section}"))),
        (None, _) => Err(Fault::new(
            at,
            format!("which {what} of the scene is meant? It has {}", names.len()),
        )
        .help(format!("name it: `\"{what}\": \"{}\"`", names[0]))),
    }
}

fn master(
    value: &MasterChoice,
    surface: &str,
    from: &str,
    variant: &mut Variant,
    (maker, dir): (&mut Maker, &Path),
) -> Result<(), Fault> {
    let here = |key: &str| pointer(&["surfaces", surface, key]);
    let (kind, fineness) = match value {
        MasterChoice::Exact => {
            variant.clear(&here("facets"), from);
            return Ok(());
        }
        MasterChoice::Bilinear(f) => ("bilinear", f),
        MasterChoice::Biquadratic(f) => ("biquadratic", f),
        MasterChoice::Smooth(f) => ("smooth", f),
        MasterChoice::Stl(source) => {
            variant.clear(&here("facets"), from);
            let file = match source {
                StlSource::File(path) => dir.join(path),
                made => {
                    let path = maker.make(&variant.scene, surface, made);
                    // The triangles have the size of the surface as placed.
                    let scale = pointer(&["surfaces", surface, "placement", "scale"]);
                    variant.clear(&scale, from);
                    path.map_err(|reason| {
                        let message = format!("no triangles can be made of `{surface}`: {reason}");
                        let help =
                            "give the triangles as a file: `{\"stl\": {\"file\": \"tool.stl\"}}`";
                        Fault::new(from, message).help(help)
                    })?
                }
            };
            for key in ["sphere", "cylinder", "plane"] {
                variant.clear(&here(key), from);
            }
            let Some(file) = file.to_str() else {
                let message = format!("the path `{}` is not Unicode", file.display());
                return Err(Fault::new(from, message));
            };
            return variant.set(&here("cad"), &json!({ "file": file }), from);
        }
    };
    let mut facets = json!({ "kind": kind });
    match *fineness {
        Fineness::Chord(c) => facets["chord"] = json!(c),
        Fineness::Size(s) => facets["size"] = json!(s),
        Fineness::Count(n) => facets["count"] = json!(n),
    }
    variant.set(&here("facets"), &facets, from)
}

/// Element and numbers of elements of a generated mesh.
fn shell(
    body: &str,
    element: &str,
    counts: &[u32],
    from: &str,
    variant: &mut Variant,
) -> Result<(), Fault> {
    let mesh = pointer(&["bodies", body, "mesh"]);
    let kind = variant.scene.pointer(&mesh).and_then(Json::as_object);
    let kind = kind
        .and_then(|m| m.keys().next())
        .map_or("", String::as_str);
    let (kind, axes) = match kind {
        "block" => (kind.to_owned(), 3),
        "file" => {
            let message = format!("the mesh of body `{body}` comes from a file");
            return Err(Fault::new(from, message)
                .help("only generated meshes can be refined; give the files in `variants`"));
        }
        other => (other.to_owned(), 2),
    };
    if counts.len() != axes {
        let message = format!(
            "expected {axes} numbers of elements, found {}",
            counts.len()
        );
        return Err(Fault::new(from, message).help(format!("body `{body}` is a {kind}")));
    }
    let known = crate::scene::Element::OF_MESHES.map(crate::scene::Element::word);
    if serde_json::from_value::<crate::scene::Element>(json!(element)).is_err() {
        let near =
            nearest(element, known).map_or(String::new(), |n| format!("did you mean `{n}`? "));
        let message = format!("unknown element `{}`", shorten(element));
        return Err(Fault::new(from, message).help(format!("{near}elements: {}", known.join(", "))));
    }
    variant.set(
        &format!("{mesh}{}", pointer(&[&kind, "elements"])),
        &json!(counts),
        &format!("{from}{}", pointer(&[element])),
    )?;
    variant.set(
        &pointer(&["bodies", body, "element"]),
        &json!(element),
        from,
    )
}
