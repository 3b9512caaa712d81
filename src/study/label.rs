//! What runs are called: a label for every value of every choice.
use super::file::{
    Choice, Fineness, MasterChoice, PointsChoice, StlSource, TangentChoice, Variant,
};
use super::record::Label;
use crate::scene::{Penalty, Points};
use serde_json::Value as Json;

impl Choice {
    /// Its key in a study file.
    pub fn key(&self) -> &'static str {
        match self {
            Choice::Master { .. } => "master",
            Choice::Shell { .. } => "shell",
            Choice::Points { .. } => "points",
            Choice::Tangent { .. } => "tangent",
            Choice::Penalty { .. } => "penalty",
            Choice::Augmentation { .. } => "augmentation",
            Choice::Step { .. } => "step",
            Choice::Tolerance { .. } => "tolerance",
            Choice::Key { .. } => "key",
            Choice::Variants { .. } => "variants",
        }
    }

    /// What records call it: the user's name for it, or its key.
    pub fn name(&self) -> &str {
        match self {
            Choice::Key { name, .. } | Choice::Variants { name, .. } => name,
            other => other.key(),
        }
    }

    /// The part of the scene that it names.
    pub fn target(&self) -> Option<&str> {
        match self {
            Choice::Master { surface, .. } => surface.as_deref(),
            Choice::Shell { body, .. } => body.as_deref(),
            Choice::Points { contact, .. }
            | Choice::Tangent { contact, .. }
            | Choice::Penalty { contact, .. }
            | Choice::Augmentation { contact, .. } => contact.as_deref(),
            _ => None,
        }
    }

    /// Number of its values.
    pub fn count(&self) -> usize {
        match self {
            Choice::Master { values, .. } => values.len(),
            Choice::Shell { values, .. } => values.len(),
            Choice::Points { values, .. } => values.len(),
            Choice::Tangent { values, .. } => values.len(),
            Choice::Penalty { values, .. } => values.len(),
            Choice::Augmentation { values, .. } => values.len(),
            Choice::Step { values } | Choice::Tolerance { values } => values.len(),
            Choice::Key { values, .. } => values.len(),
            Choice::Variants { values, .. } => values.len(),
        }
    }

    /// The label of a value; `None` beyond the last one.
    pub fn label(&self, k: usize) -> Option<Label> {
        Some(match self {
            Choice::Master { values, .. } => {
                let choice = values.get(k)?;
                let kind = std::mem::discriminant(choice);
                let like = values.iter().filter(|v| std::mem::discriminant(*v) == kind);
                master(choice, &like.filter_map(facet_counts).collect::<Vec<_>>())
            }
            Choice::Shell { values, .. } => {
                let (element, counts) = values.get(k)?.first_key_value()?;
                let like: Vec<&[u32]> = (values.iter())
                    .filter_map(|v| v.get(element).map(Vec::as_slice))
                    .collect();
                shell(element, counts, &like)
            }
            Choice::Points { values, .. } => points(values.get(k)?),
            Choice::Tangent { values, .. } => alone(tangent(*values.get(k)?)),
            Choice::Penalty { values, .. } => penalty(values.get(k)?),
            Choice::Augmentation { values, .. } => alone(&augmentation(values.get(k)?)),
            Choice::Step { values } => fine("step", *values.get(k)?),
            Choice::Tolerance { values } => fine("tolerance", *values.get(k)?),
            Choice::Key { name, values, .. } => alone(&format!("{name} {}", value(values.get(k)?))),
            Choice::Variants { values, .. } => variant(values.get(k)?),
        })
    }
}

/// A label of a series of its own.
fn alone(text: &str) -> Label {
    Label {
        text: text.to_owned(),
        series: text.to_owned(),
        size: None,
    }
}

fn fine(series: &str, size: f64) -> Label {
    Label {
        text: format!("{series} {}", number(size)),
        series: series.to_owned(),
        size: Some(size),
    }
}

fn variant(variant: &Variant) -> Label {
    let series = variant.series.as_ref().unwrap_or(&variant.label);
    Label {
        text: variant.label.clone(),
        series: series.clone(),
        size: variant.size,
    }
}

/// Numbers of facets, where they are given.
fn facet_counts(choice: &MasterChoice) -> Option<&[u32]> {
    match choice {
        MasterChoice::Bilinear(Fineness::Count(n))
        | MasterChoice::Biquadratic(Fineness::Count(n))
        | MasterChoice::Smooth(Fineness::Count(n))
        | MasterChoice::Stl(StlSource::Count(n)) => Some(n),
        _ => None,
    }
}

fn master(choice: &MasterChoice, like: &[&[u32]]) -> Label {
    match choice {
        MasterChoice::Exact => alone("NURBS"),
        MasterChoice::Bilinear(f) => facets("bilinear", *f, like),
        MasterChoice::Biquadratic(f) => facets("biquadratic", *f, like),
        MasterChoice::Smooth(f) => facets("smooth", *f, like),
        MasterChoice::Stl(StlSource::File(path)) => {
            let name = path.file_name().unwrap_or(path.as_os_str());
            alone(&name.to_string_lossy())
        }
        MasterChoice::Stl(StlSource::Chord(c)) => facets("STL", Fineness::Chord(*c), like),
        MasterChoice::Stl(StlSource::Size(s)) => facets("STL", Fineness::Size(*s), like),
        MasterChoice::Stl(StlSource::Count(n)) => facets("STL", Fineness::Count(*n), like),
    }
}

/// Chord errors, sizes and counts are not of one scale, so that each has a series.
fn facets(kind: &str, fineness: Fineness, like: &[&[u32]]) -> Label {
    let (text, series, size) = match fineness {
        Fineness::Chord(c) => (format!("{kind}, chord {}", number(c)), kind.to_owned(), c),
        Fineness::Size(s) => {
            let text = format!("{kind}, size {}", number(s));
            (text, format!("{kind} by size"), s)
        }
        Fineness::Count(n) => {
            let text = format!("{kind}, {} x {}", n[0], n[1]);
            (text, format!("{kind} by count"), mean_size(&n, like))
        }
    };
    Label {
        text,
        series,
        size: Some(size),
    }
}

/// Size of an element relative to the body: the inverse of the geometric mean of their numbers along the axes in which the
/// series is refined, `like` being the numbers of all its members; along all axes where there is only one.
fn mean_size(counts: &[u32], like: &[&[u32]]) -> f64 {
    let refined = |d: &usize| like.iter().any(|other| other.get(*d) != like[0].get(*d));
    let mut numbers: Vec<f64> = (0..counts.len())
        .filter(refined)
        .map(|d| f64::from(counts[d]))
        .collect();
    if numbers.is_empty() {
        numbers.extend(counts.iter().map(|n| f64::from(*n)));
    }
    (numbers.iter().product::<f64>()).powf(-1.0 / numbers.len().max(1) as f64)
}

fn shell(element: &str, counts: &[u32], like: &[&[u32]]) -> Label {
    let mut words = element.split('_');
    let mut series = words.next().unwrap_or_default().to_uppercase();
    words.for_each(|word| series += &format!(" {word}"));
    let shown: Vec<String> = counts.iter().map(u32::to_string).collect();
    Label {
        text: format!("{series} {}", shown.join(" x ")),
        series,
        size: Some(mean_size(counts, like)),
    }
}

fn points(choice: &PointsChoice) -> Label {
    let (points, averaged) = match *choice {
        PointsChoice::Nodes => (Points::Nodes, false),
        PointsChoice::Gauss(n) => (Points::Gauss(n), false),
        PointsChoice::Lobatto(n) => (Points::Lobatto(n), false),
        PointsChoice::Segments(n) => (Points::Segments(n), false),
        PointsChoice::Averaged(points) => (points, true),
    };
    let (kind, count) = match points {
        Points::Auto | Points::Nodes => ("nodes", None),
        Points::Gauss(n) => ("Gauss", Some(n)),
        Points::Lobatto(n) => ("Lobatto", Some(n)),
        Points::Segments(n) => ("segments", Some(n)),
    };
    let ending = if averaged { ", averaged" } else { "" };
    let shown = count.map_or(String::new(), |n| format!(" {n}"));
    Label {
        text: format!("{kind}{shown}{ending}"),
        series: format!("{kind}{ending}"),
        size: count.map(|n| 1.0 / f64::from(n)),
    }
}

/// The gap that a penalty leaves vanishes with its inverse.
fn penalty(choice: &Penalty) -> Label {
    let (text, series, size) = match *choice {
        Penalty::Auto => ("automatic penalty".to_owned(), "automatic penalty", 1.0),
        Penalty::Value(p) => (format!("penalty {}", number(p)), "penalty", p.recip()),
        Penalty::Scaled(f) => {
            let text = format!("{} x automatic penalty", number(f));
            (text, "automatic penalty", f.recip())
        }
    };
    Label {
        text,
        series: series.to_owned(),
        size: Some(size),
    }
}

fn tangent(choice: TangentChoice) -> &'static str {
    match choice {
        TangentChoice::Exact => "exact tangent",
        TangentChoice::Published => "published tangent",
        TangentChoice::WithoutRotational => "tangent without rotational part",
        TangentChoice::WithoutCurvature => "tangent without curvature part",
        TangentChoice::Main => "main part of the tangent",
    }
}

fn augmentation(choice: &Json) -> String {
    let Json::Object(members) = choice else {
        return "not augmented".to_owned();
    };
    let settings = members
        .iter()
        .map(|(key, v)| format!(", {key} {}", value(v)));
    "augmented".to_owned() + &settings.collect::<String>()
}

/// A value in a few characters.
fn value(value: &Json) -> String {
    match value {
        Json::Null => "none".to_owned(),
        Json::Bool(true) => "on".to_owned(),
        Json::Bool(false) => "off".to_owned(),
        Json::Number(n) => n.as_f64().map_or_else(|| n.to_string(), number),
        Json::String(text) => text.clone(),
        Json::Array(items) => {
            let all: Vec<String> = items.iter().map(self::value).collect();
            all.join(" x ")
        }
        Json::Object(members) => {
            let one = |(key, v): (&String, &Json)| format!("{key} {}", self::value(v));
            let all: Vec<String> = members.iter().map(one).collect();
            all.join(", ")
        }
    }
}

/// The shortest text that reads back as the same number.
fn number(x: f64) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        a if (1e-3..1e6).contains(&a) => x.to_string(),
        _ => format!("{x:e}"),
    }
}
