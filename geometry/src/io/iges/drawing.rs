//! What a file holds beside surfaces, or instead of them: drawings, wireframes, references to other files.

use super::curve::is_curve;
use super::directory::Entry;

/// Annotation, symbols, views and drawings.
pub fn is_annotation(type_number: u32) -> bool {
    matches!(type_number, 202..=230 | 312 | 404 | 410)
}

/// What a file without surfaces holds, in words.
pub fn account(entries: &[Entry]) -> String {
    // A 106 is a polyline or, in most of its forms, a part of a drawing (witness lines, hatching, ...).
    let annotation = |e: &&Entry| match e.type_number {
        106 => e.form >= 20 && e.form != 63,
        other => is_annotation(other),
    };
    let drawn = entries.iter().filter(annotation).count();
    let curves = entries.iter().filter(|e| is_curve(e.type_number));
    let curves = curves.filter(|e| !annotation(e)).count();
    match (drawn, curves) {
        (1.., _) => format!(
            "the file is a drawing: {drawn} dimension(s), notes, symbols and views, {curves} curve(s), no surfaces"
        ),
        (0, 1..) => format!("the file is a wireframe: {curves} curve(s), no surfaces"),
        (0, 0) => "the file holds neither surfaces nor curves".to_owned(),
    }
}

/// Says that a file refers to others.
pub fn external(entries: &[Entry]) -> Option<String> {
    let mut elsewhere = entries.iter().filter(|e| e.type_number == 416);
    let first = elsewhere.next()?;
    Some(format!(
        "{} external reference(s) (416), the first of them entity {}: what stands in other files is not read",
        1 + elsewhere.count(),
        first.number
    ))
}
