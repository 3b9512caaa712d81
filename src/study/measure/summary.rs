//! Numbers of a summary.
use crate::scene::nearest;
use serde_json::Value as Json;

/// The number at a dotted path, e.g. `phases.solve`.
///
/// # Errors
/// In words: nothing there, with the nearest name of a number, or something else than a number.
pub(super) fn number(summary: &Json, path: &str) -> Result<f64, String> {
    match at(summary, path) {
        Some(Json::Number(n)) => n
            .as_f64()
            .ok_or_else(|| format!("`{path}` of the summary is no number of double precision")),
        Some(Json::Null) => Err(format!(
            "`{path}` of the summary is empty: the system does not tell"
        )),
        Some(_) => Err(format!("`{path}` of the summary is no number")),
        None => {
            let mut names = Vec::new();
            collect(summary, "", &mut names);
            Err(match nearest(path, names.iter().map(String::as_str)) {
                Some(near) => {
                    format!("the summary has no number `{path}`; did you mean `{near}`?")
                }
                None => format!("the summary has no number `{path}`"),
            })
        }
    }
}

/// Keys may hold dots themselves.
fn at<'a>(value: &'a Json, path: &str) -> Option<&'a Json> {
    let map = value.as_object()?;
    map.get(path).or_else(|| {
        path.match_indices('.')
            .find_map(|(i, _)| at(map.get(&path[..i])?, &path[i + 1..]))
    })
}

fn collect(value: &Json, before: &str, names: &mut Vec<String>) {
    let Some(map) = value.as_object() else { return };
    for (key, value) in map {
        let name = format!("{before}{key}");
        if value.is_number() {
            names.push(name);
        } else {
            collect(value, &format!("{name}."), names);
        }
    }
}
