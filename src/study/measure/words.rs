//! What is measured, in words.
use super::super::file::{Measure, Take};
use super::field::Field;

/// E.g. "`force.ball.z` at the end".
pub(super) fn measure(of: &Measure) -> String {
    match of {
        Measure::Column {
            name,
            take,
            between,
            over,
        } => {
            let over = match over {
                Some(over) => format!("`{over}`"),
                None => "time".to_string(),
            };
            let mut text = match take {
                Take::End => format!("`{name}` at the end"),
                Take::Max => format!("largest `{name}`"),
                Take::Min => format!("smallest `{name}`"),
                Take::Mean => format!("mean of `{name}` over {over}"),
                Take::At(at) => format!("`{name}` at {over} {at}"),
                Take::Swing => format!("swing of `{name}` over {over}, relative to its mean"),
                Take::Curve => format!("`{name}` over {over}"),
            };
            if let Some([from, to]) = between {
                text.push_str(&format!(", time from {from} to {to}"));
            }
            text
        }
        Measure::Field { body, name } => {
            let over = match Field::lives_on_slave_faces(name) {
                true => "slave faces",
                false => "volume",
            };
            format!("field `{name}` over the {over} of body `{body}` at the end")
        }
        Measure::Summary { name } => format!("`{name}` of the summary"),
    }
}
