//! Changes of a scene by JSON pointers (RFC 6901).
use crate::scene::{pointer, shorten, suggestion};
use serde_json::{Map, Value as Json};

/// Sections of a scene whose keys are names that the user gives.
const NAMED: [&str; 7] = [
    "materials",
    "bodies",
    "surfaces",
    "contacts",
    "supports",
    "loads",
    "probes",
];

/// Something wrong with a study, at a JSON pointer into its file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Fault {
    pub at: String,
    pub message: String,
    pub help: Option<String>,
}

impl Fault {
    pub fn new(at: impl Into<String>, message: impl Into<String>) -> Self {
        Fault {
            at: at.into(),
            message: message.into(),
            help: None,
        }
    }

    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

/// A scene that is being changed.
#[derive(Debug, Clone)]
pub(super) struct Variant {
    pub scene: Json,
    /// Pointers into the scene that were set, and what in the study file set them; later ones last.
    touched: Vec<(String, String)>,
}

impl Variant {
    pub fn new(scene: Json) -> Self {
        Variant {
            scene,
            touched: Vec::new(),
        }
    }

    /// Sets the value at a pointer, as `from` in the study file asks; null removes a key. Objects on the way are made, but
    /// not bodies, surfaces and other things that have names.
    pub fn set(&mut self, at: &str, value: &Json, from: &str) -> Result<(), Fault> {
        let tokens = tokens(at).ok_or_else(|| {
            Fault::new(
                from,
                format!("`{}` is no JSON pointer into the scene", shorten(at)),
            )
            .help("write `/` and keys, as in `/solution/step/initial`")
        })?;
        if fields(&tokens, value) {
            return Err(Fault::new(
                from,
                "`/output/every` cannot be chosen: a study sets it for every run",
            )
            .help("fields are written at the end, where a quantity is a `field`"));
        }
        let lost = |depth: usize, node: &Json| lost(&tokens, depth, node, from);
        let Some((last, way)) = tokens.split_last() else {
            return Err(Fault::new(from, "the whole scene cannot be replaced")
                .help("write `/` and keys, as in `/solution/step/initial`"));
        };
        let mut node = &mut self.scene;
        for (depth, token) in way.iter().enumerate() {
            let named = depth == 1 && NAMED.contains(&tokens[0].as_str());
            let there = match &*node {
                Json::Object(members) => members.contains_key(token),
                Json::Array(items) => index(token, items.len()).is_some(),
                _ => false,
            };
            if !there && (named || value.is_null() || !node.is_object()) {
                return Err(lost(depth, node));
            }
            node = match node {
                Json::Object(members) => {
                    (members.entry(token.as_str())).or_insert_with(|| Json::Object(Map::new()))
                }
                Json::Array(items) => match index(token, items.len()) {
                    Some(i) => &mut items[i],
                    None => return Ok(()),
                },
                _ => return Ok(()),
            };
        }
        let depth = way.len();
        match node {
            Json::Object(members) if value.is_null() => {
                if members.remove(last).is_none() {
                    return Err(lost(depth, node));
                }
            }
            Json::Object(members) => {
                members.insert(last.clone(), tidy(value));
            }
            Json::Array(items) => match (index(last, items.len()), value) {
                (Some(i), Json::Null) => {
                    items.remove(i);
                }
                (Some(i), value) => items[i] = tidy(value),
                (None, value) if last == "-" && !value.is_null() => items.push(tidy(value)),
                (None, _) => return Err(lost(depth, node)),
            },
            _ => return Err(lost(depth, node)),
        }
        self.touch(at, from);
        Ok(())
    }

    /// Removes what is at a pointer, where there is something.
    pub fn clear(&mut self, at: &str, from: &str) {
        if self.scene.pointer(at).is_some() {
            // What is there can be removed.
            let _ = self.set(at, &Json::Null, from);
        }
        self.touch(at, from);
    }

    fn touch(&mut self, at: &str, from: &str) {
        self.touched.push((at.to_owned(), from.to_owned()));
    }

    /// What in the study file is answerable for the value at a pointer: what set it, or something in it, last.
    pub fn cause(&self, at: &str) -> Option<&str> {
        let within = |inner: &str, outer: &str| {
            inner
                .strip_prefix(outer)
                .is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
        };
        let of = |is: &dyn Fn(&str) -> bool| {
            (self.touched.iter().rev().find(|(set, _)| is(set))).map(|(_, from)| from.as_str())
        };
        of(&|set| within(at, set)).or_else(|| of(&|set| within(set, at)))
    }
}

/// The keys of a pointer; none where it is none.
fn tokens(at: &str) -> Option<Vec<String>> {
    let rest = match at {
        "" => return Some(Vec::new()),
        at => at.strip_prefix('/')?,
    };
    let plain = |token: &str| token.replace("~1", "/").replace("~0", "~");
    Some(rest.split('/').map(plain).collect())
}

/// A change would say how often fields are written.
fn fields(tokens: &[String], value: &Json) -> bool {
    let names: Vec<&str> = tokens.iter().map(String::as_str).collect();
    match names[..] {
        ["output"] => value.get("every").is_some(),
        ["output", "every"] => true,
        _ => false,
    }
}

fn index(token: &str, length: usize) -> Option<usize> {
    token.parse::<usize>().ok().filter(|i| *i < length)
}

/// A pointer leads nowhere at the token of this depth.
fn lost(tokens: &[String], depth: usize, node: &Json, from: &str) -> Fault {
    let names: Vec<&str> = tokens[..depth].iter().map(String::as_str).collect();
    let place = match names.is_empty() {
        true => "the scene".to_owned(),
        false => format!("`{}` of the scene", shorten(&pointer(&names))),
    };
    let token = tokens.get(depth).map_or("", String::as_str);
    match node {
        Json::Object(members) => {
            Fault::new(from, format!("there is no `{}` in {place}", shorten(token))).help(
                suggestion(token, "keys there", members.keys().map(String::as_str)),
            )
        }
        Json::Array(items) => Fault::new(
            from,
            format!("there is no item `{}` in {place}", shorten(token)),
        )
        .help(format!(
            "it has {} items, counted from 0; `-` stands for one more",
            items.len()
        )),
        other => Fault::new(
            from,
            format!(
                "{place} is {}, with nothing in it",
                shorten(&other.to_string())
            ),
        )
        .help("set it as a whole"),
    }
}

/// Whole numbers as such: what was read from a study is floating.
pub(super) fn tidy(value: &Json) -> Json {
    match value {
        Json::Number(n) => match n.as_f64() {
            Some(x) if x.fract() == 0.0 && x.abs() < 2f64.powi(53) => Json::from(x as i64),
            _ => value.clone(),
        },
        Json::Array(items) => items.iter().map(tidy).collect(),
        Json::Object(members) => {
            let all = members
                .iter()
                .map(|(key, value)| (key.clone(), tidy(value)));
            Json::Object(all.collect())
        }
        other => other.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn scene() -> Variant {
        Variant::new(json!({
            "contacts": { "press": { "master": "a", "points": { "gauss": 2 } } },
            "a/b": [1, 2, { "c": true }]
        }))
    }

    #[test]
    fn values_are_set_added_and_removed() {
        let mut v = scene();
        for (at, value, then) in [
            ("/contacts/press/points/gauss", json!(3.0), json!(3)),
            ("/contacts/press/gap", json!("averaged"), json!("averaged")),
            ("/solution/step/initial", json!(0.5), json!(0.5)),
            ("/a~1b/2/c", json!([1.0, 0.25]), json!([1, 0.25])),
            ("/contacts/other", json!({}), json!({})),
        ] {
            v.set(at, &value, "/set").unwrap();
            assert_eq!(v.scene.pointer(at), Some(&then), "{at}");
        }
        v.set("/a~1b/-", &json!(7), "/set").unwrap();
        v.set("/a~1b/0", &Json::Null, "/set").unwrap();
        v.set("/contacts/press/gap", &Json::Null, "/set").unwrap();
        assert_eq!(v.scene["a/b"], json!([2, { "c": [1, 0.25] }, 7]));
        assert_eq!(v.scene.pointer("/contacts/press/gap"), None);
    }

    #[test]
    fn pointers_that_lead_nowhere() {
        for (at, value, message, help) in [
            (
                "contacts",
                json!(1),
                "`contacts` is no JSON pointer",
                "`/solution/step/initial`",
            ),
            ("", json!(1), "the whole scene cannot be replaced", "as in"),
            (
                "/contacts/pres/points",
                json!(1),
                "there is no `pres` in `/contacts` of the scene",
                "did you mean `press`?",
            ),
            (
                "/contacts/press/master/x",
                json!(1),
                "`/contacts/press/master` of the scene is \"a\", with nothing in it",
                "set it as a whole",
            ),
            (
                "/a~1b/7",
                json!(1),
                "there is no item `7` in `/a~1b` of the scene",
                "it has 3 items",
            ),
            (
                "/contacts/press/point",
                Json::Null,
                "there is no `point` in `/contacts/press` of the scene",
                "did you mean `points`?",
            ),
        ] {
            let fault = scene().set(at, &value, "/from").unwrap_err();
            assert!(fault.message.contains(message), "{fault:?}");
            assert!(fault.help.as_ref().unwrap().contains(help), "{fault:?}");
            assert_eq!(fault.at, "/from");
        }
    }

    #[test]
    fn the_cause_of_a_fault_is_what_set_it_last() {
        let mut v = scene();
        v.set("/contacts/press/points", &json!("nodes"), "/first")
            .unwrap();
        v.set("/contacts/press/points", &json!({ "gauss": 0 }), "/second")
            .unwrap();
        v.clear("/contacts/press/gap", "/third");
        assert_eq!(v.cause("/contacts/press/points/gauss"), Some("/second"));
        assert_eq!(v.cause("/contacts/press/gap"), Some("/third"));
        assert_eq!(v.cause("/contacts/press"), Some("/third"));
        assert_eq!(v.cause("/contacts/press/pointsX"), None);
    }
}
