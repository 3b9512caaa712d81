//! The JSON schema of scenes, made from the types and their documentation.
use super::types::{BY_AXIS, STANDS_FOR, Scene, WITH_DEFAULTS};
use schemars::Schema;
use serde_json::{Map, Value as Json, json};

/// The schema as pretty-printed JSON with a line break at its end.
pub fn schema() -> String {
    printed(schemars::schema_for!(Scene))
}

/// A schema with what types do not say of themselves: short forms, and descriptions that stand at the type.
pub(crate) fn printed(schema: Schema) -> String {
    let mut schema = schema.to_value();
    short_forms(&mut schema);
    other_names(&mut schema);
    let definitions = schema["$defs"].as_object().cloned().unwrap_or_default();
    describe(&mut schema, &definitions);
    // Serialising a tree of JSON values into memory cannot fail.
    let mut text = serde_json::to_string_pretty(&schema).unwrap_or_default();
    text.push('\n');
    text
}

/// Lets numbers and texts stand for objects of one key, as they are read.
fn short_forms(schema: &mut Json) {
    let Some(definitions) = schema.get_mut("$defs").and_then(Json::as_object_mut) else {
        return;
    };
    for (name, definition) in definitions {
        // The only key of a choice need not be written.
        let variants = definition.get_mut("oneOf").and_then(Json::as_array_mut);
        for variant in variants.into_iter().flatten() {
            for content in members(variant) {
                if let Some(only) = content["properties"].as_object().and_then(single) {
                    *content = json!({ "anyOf": [only, content.clone()] });
                }
            }
        }
        let variants = definition.get_mut("oneOf").and_then(Json::as_array_mut);
        variants.into_iter().for_each(names_alone);
        if let Some(form) = STANDS_FOR.iter().find(|f| f.name == name) {
            let short = match form.numbers {
                true => json!({ "type": ["number", "string"] }),
                false => json!({ "type": "string" }),
            };
            let mut short = short;
            short["description"] = json!(format!("Stands for `{{\"{}\": ...}}`.", form.key));
            or_short(definition, short);
        }
        if BY_AXIS.contains(&name.as_str()) {
            let short = json!({
                "description": "The values of `x`, `y` and `z`; `null` leaves one out.",
                "type": "array",
                "items": { "anyOf": definition["properties"]["x"]["anyOf"].clone() },
                "minItems": 3,
                "maxItems": 3,
            });
            or_short(definition, short);
        }
    }
}

/// Allows a short form beside the one that a definition describes.
fn or_short(definition: &mut Json, short: Json) {
    let mut long = definition.take();
    let description = long.as_object_mut().and_then(|l| l.remove("description"));
    *definition = json!({ "description": description, "anyOf": [long, short] });
}

/// Lets the names of choices whose settings have defaults stand alone.
fn names_alone(variants: &mut Vec<Json>) {
    for name in WITH_DEFAULTS {
        let has_settings = |v: &Json| v["properties"][name].is_object();
        if let Some(at) = variants.iter().position(has_settings) {
            let description = format!("Stands for `{{\"{name}\": {{}}}}`.");
            let short = json!({ "const": name, "description": description, "type": "string" });
            variants.insert(at, short);
        }
    }
}

/// What the description of a key says before its other name.
const ALSO: &str = "also written `";

/// Allows the other names of keys, by what their descriptions say: one of the two may be given.
fn other_names(schema: &mut Json) {
    let own = |(key, member): (&String, &Json)| {
        let (_, after) = member["description"].as_str()?.split_once(ALSO)?;
        let other = after.split('`').next()?.to_owned();
        Some((key.clone(), other, member.clone()))
    };
    let properties = schema["properties"].as_object();
    let found: Vec<_> = properties.into_iter().flatten().filter_map(own).collect();
    for (key, other, mut member) in found {
        member["description"] = json!(format!("The same as `{key}`."));
        schema["properties"][&other] = member;
        schema["not"] = json!({ "required": [key, other] });
    }
    match schema {
        Json::Object(members) => members.values_mut().for_each(other_names),
        Json::Array(items) => items.iter_mut().for_each(other_names),
        _ => {}
    }
}

/// The only member of an object.
fn single(members: &Map<String, Json>) -> Option<Json> {
    (members.len() == 1).then(|| members.values().next().cloned())?
}

/// The values of an object schema's properties.
fn members(schema: &mut Json) -> impl Iterator<Item = &mut Json> {
    (schema.get_mut("properties").and_then(Json::as_object_mut))
        .into_iter()
        .flat_map(Map::values_mut)
}

/// Gives every property a description: that of its variant, or that of its type, where it has none of its own.
fn describe(schema: &mut Json, definitions: &Map<String, Json>) {
    let own = schema["description"].clone();
    if schema["properties"]
        .as_object()
        .is_some_and(|p| p.len() == 1)
    {
        for member in members(schema) {
            if member["description"].is_null() && own.is_string() {
                member["description"] = own.clone();
            }
        }
    }
    for member in members(schema) {
        let named = member["$ref"].as_str().map(str::to_owned);
        let definition = named.and_then(|n| definitions.get(n.rsplit('/').next()?).cloned());
        if let (true, Some(of)) = (member["description"].is_null(), definition) {
            member["description"] = of["description"].clone();
        }
    }
    match schema {
        Json::Object(members) => members.values_mut().for_each(|m| describe(m, definitions)),
        Json::Array(items) => items.iter_mut().for_each(|m| describe(m, definitions)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::schema;
    use serde_json::{Value as Json, json};

    #[test]
    fn other_names_of_keys_are_allowed() {
        let schema: Json = serde_json::from_str(&schema()).expect("JSON");
        for (name, key, other) in [
            ("CylinderPanel", "origin", "center"),
            ("SpherePanel", "origin", "center"),
            ("SphereShape", "center", "origin"),
            ("CylinderShape", "center", "origin"),
        ] {
            let of = &schema["$defs"][name];
            let [a, b] = [key, other].map(|k| &of["properties"][k]);
            assert_eq!(a["type"], "array", "{name}");
            assert_eq!(
                (&a["type"], &a["items"]),
                (&b["type"], &b["items"]),
                "{name}"
            );
            assert_eq!(of["not"], json!({ "required": [key, other] }), "{name}");
        }
    }
}
