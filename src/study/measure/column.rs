//! What is taken of a column of a history.
use super::super::file::Take;
use super::curve;
use super::sample::{Note, Sample, Sampled};
use crate::output::Table;
use crate::scene::nearest;

/// Times this close, relative to their size, are the same.
const SAME: f64 = 1e-9;

/// Takes a number or a curve of the column `name` over `over` (default: time), of the rows whose time lies within `between`.
/// Rows without a number are left out and told of.
///
/// # Errors
/// In words: a column that is not there, no rows, a time outside of the rows, a swing about a mean of zero.
pub(super) fn take(
    table: &Table,
    name: &str,
    take: Take,
    between: Option<[f64; 2]>,
    over: Option<&str>,
) -> Result<Sampled, String> {
    let y = column(table, name)?;
    let over = over.unwrap_or("time");
    let x = column(table, over)?;
    let mut rows: Vec<[f64; 2]> = x.into_iter().zip(y).map(|(x, y)| [x, y]).collect();
    if let Some([from, to]) = between {
        let slack = SAME * from.abs().max(to.abs());
        let times = column(table, "time")?;
        let inside = |t: f64| t >= from - slack && t <= to + slack;
        let mut times = times.into_iter();
        rows.retain(|_| times.next().is_some_and(inside));
        if rows.is_empty() {
            return Err(format!("no row has a time between {from} and {to}"));
        }
    }
    let all = rows.len();
    if all == 0 {
        return Err("the history has no rows".into());
    }
    let last = rows[all - 1][1];
    if take == Take::End && !last.is_finite() {
        return Err(format!("the last value of `{name}` is no number"));
    }
    rows.retain(|[x, y]| x.is_finite() && y.is_finite());
    let mut notes = Vec::new();
    if rows.is_empty() {
        return Err(format!("no row holds a number for `{name}`"));
    }
    if rows.len() < all && take != Take::End {
        notes.push(Note {
            text: format!("rows without a number for `{name}` are left out"),
            detail: Some(format!("{} of {all}", all - rows.len())),
        });
    }
    let values = || rows.iter().map(|[_, y]| *y);
    let value = match take {
        Take::End => last,
        Take::Max => values().fold(f64::NEG_INFINITY, f64::max),
        Take::Min => values().fold(f64::INFINITY, f64::min),
        Take::Mean => mean(&rows, over)?,
        Take::At(at) => value_at(&rows, at, over)?,
        Take::Swing => swing(&rows, name)?,
        Take::Curve => {
            let sample = Sample::Curve(rows);
            return Ok(Sampled { sample, notes });
        }
    };
    let sample = Sample::Value(value);
    Ok(Sampled { sample, notes })
}

/// A column, or which one may have been meant.
pub(super) fn column(table: &Table, name: &str) -> Result<Vec<f64>, String> {
    table.column(name).ok_or_else(|| {
        let columns = table.columns.iter().map(String::as_str);
        match nearest(name, columns) {
            Some(near) => format!("there is no column `{name}`; did you mean `{near}`?"),
            None => format!("there is no column `{name}`"),
        }
    })
}

/// Mean by the trapezoidal rule; of a single row its value.
fn mean(rows: &[[f64; 2]], over: &str) -> Result<f64, String> {
    let rows = curve::ascending(rows).ok_or_else(|| turns(over))?;
    let span = rows[rows.len() - 1][0] - rows[0][0];
    if span <= 0.0 {
        return match &rows[..] {
            [[_, y]] => Ok(*y),
            _ => Err(format!(
                "`{over}` does not change, so there is no mean over it"
            )),
        };
    }
    let area: f64 = (rows.windows(2))
        .map(|w| 0.5 * (w[1][0] - w[0][0]) * (w[0][1] + w[1][1]))
        .sum();
    Ok(area / span)
}

/// Linear between rows; of several rows at the same place the last.
fn value_at(rows: &[[f64; 2]], at: f64, over: &str) -> Result<f64, String> {
    let rows = curve::ascending(rows).ok_or_else(|| turns(over))?;
    let (first, last) = (rows[0], rows[rows.len() - 1]);
    let slack = SAME * at.abs().max(last[0] - first[0]);
    if at < first[0] - slack || at > last[0] + slack {
        return Err(format!(
            "{at} is outside of the rows, whose `{over}` goes from {} to {}",
            first[0], last[0]
        ));
    }
    let next = rows.partition_point(|[x, _]| *x <= at);
    if next == 0 {
        return Ok(first[1]);
    }
    if next == rows.len() {
        return Ok(last[1]);
    }
    let ([x0, y0], [x1, y1]) = (rows[next - 1], rows[next]);
    Ok(y0 + (y1 - y0) * ((at - x0) / (x1 - x0)))
}

fn turns(over: &str) -> String {
    format!("`{over}` goes back and forth, so nothing is a function of it")
}

/// Peak to peak of what remains when the line of least squares is taken off, relative to the mean of the rows.
fn swing(rows: &[[f64; 2]], name: &str) -> Result<f64, String> {
    let n = rows.len() as f64;
    if rows.len() < 3 {
        return Err(format!(
            "a swing needs three rows, and there are {}",
            rows.len()
        ));
    }
    let centre = |k: usize| rows.iter().map(|r| r[k]).sum::<f64>() / n;
    let (x0, y0) = (centre(0), centre(1));
    let (mut xx, mut xy) = (0.0, 0.0);
    for [x, y] in rows {
        xx += (x - x0) * (x - x0);
        xy += (x - x0) * (y - y0);
    }
    let slope = if xx > 0.0 { xy / xx } else { 0.0 };
    let rest = rows.iter().map(|[x, y]| y - y0 - slope * (x - x0));
    let (low, high) = rest.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), r| {
        (low.min(r), high.max(r))
    });
    if y0 == 0.0 {
        return Err(format!(
            "the mean of `{name}` is zero, so there is no swing relative to it"
        ));
    }
    Ok((high - low) / y0.abs())
}
