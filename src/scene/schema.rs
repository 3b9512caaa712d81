//! The JSON schema of scenes, made from the types and their documentation.
use super::types::Scene;

/// The schema as pretty-printed JSON with a line break at its end.
pub fn schema() -> String {
    let schema = schemars::schema_for!(Scene);
    // Serialising a tree of JSON values into memory cannot fail.
    let mut text = serde_json::to_string_pretty(&schema).unwrap_or_default();
    text.push('\n');
    text
}
