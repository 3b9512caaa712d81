//! The history of a run, as a page has it.
use crate::output::Table;
use std::fmt::Write;

/// Most steps in a page: of a longer history every second, third and so on, and the last.
const ROWS: usize = 2000;

/// The table as JSON: `columns`, and `rows` of numbers in seven digits.
pub(super) fn text(table: &Table) -> String {
    let every = table.rows.len().div_ceil(ROWS).max(1);
    let columns = serde_json::to_string(&table.columns).unwrap_or_else(|_| "[]".into());
    let mut out = format!("{{\"columns\":{columns},\"rows\":[");
    let last = table.rows.len().saturating_sub(1);
    let kept = (table.rows.iter().enumerate()).filter(|(i, _)| i % every == 0 || *i == last);
    for (k, (_, row)) in kept.enumerate() {
        out.push_str(if k > 0 { ",[" } else { "[" });
        for (i, v) in row.iter().enumerate() {
            if i > 0 {
                out.push(',');
            }
            // Writing to a String does not fail.
            let _ = match (v.is_finite(), v.fract() == 0.0 && v.abs() < 1e7) {
                (false, _) => write!(out, "null"),
                (true, true) => write!(out, "{v}"),
                (true, false) => write!(out, "{v:.6e}"),
            };
        }
        out.push(']');
    }
    out.push_str("]}");
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_histories_keep_their_last_row_and_gaps_become_null() {
        let rows = (0..4001).map(|i| vec![f64::from(i), 0.1 * f64::from(i), f64::NAN]);
        let table = Table {
            columns: vec!["step".into(), "a\"b".into(), "c".into()],
            rows: rows.collect(),
        };
        let read: serde_json::Value = serde_json::from_str(&text(&table)).unwrap();
        assert_eq!(read["columns"][1], "a\"b");
        let rows = read["rows"].as_array().unwrap();
        assert!(rows.len() <= ROWS + 1);
        assert_eq!(rows.last().unwrap()[0], 4000);
        assert_eq!(rows[1][1].as_f64().unwrap(), 0.3);
        assert!(rows[0][2].is_null());
    }
}
