//! How far the finest of a sequence of refined runs is from its limit.

/// With a lower observed order the differences hardly fall, or grow: nothing tells where they lead.
const LEAST: f64 = 0.3;
/// Observed orders above this are no sign of convergence as it should be.
const MOST: f64 = 6.0;
/// A declared order is doubted where the observed one differs by more.
const DOUBTFUL: f64 = 0.5;

/// Error of the finest run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Estimate {
    /// In the unit of the differences.
    pub error: f64,
    pub order: Option<f64>,
    /// From three runs, not assumed.
    pub observed: bool,
    /// What is wrong with it, in words.
    pub doubt: Option<String>,
}

/// Richardson's estimate: with errors `c h^p` and mesh sizes that shrink by `ratio`, the finest run is off by
/// `|d| / (ratio^p - 1)`, `d` being the difference of the last two; that of the two before is `ratio^p d`, which gives
/// p (P. J. Roache, J. Fluids Eng. 116 (1994) 405).
///
/// `last` is that difference, `before` the earlier one where there are three runs; with a sign where they are differences
/// of numbers, norms where they are not. `order` is p where it is declared.
///
/// # Errors
/// In words, where nothing can be estimated: above all where the refinement does not converge, whatever order is declared.
pub(super) fn estimate(
    before: Option<f64>,
    last: f64,
    ratio: f64,
    order: Option<f64>,
) -> Result<Estimate, String> {
    if !(ratio > 1.0 && ratio.is_finite()) {
        return Err(format!(
            "the ratio of mesh sizes is {ratio}, and has to be above 1"
        ));
    }
    let declared = match order {
        Some(p) if p > 0.0 && p.is_finite() => Some(p),
        Some(p) => return Err(format!("the declared order is {p}, and has to be above 0")),
        None => None,
    };
    if last == 0.0 {
        return Err("the two finest runs do not differ".into());
    }
    let size = last.abs();
    let observed = match before.map(|before| observe(before, last, ratio)) {
        Some(Seen::Diverging(why)) => return Err(why),
        Some(Seen::Order(p)) => Some(Ok(p)),
        Some(Seen::Odd(why)) => Some(Err(why)),
        None => None,
    };
    let of_order = |p: f64, observed: bool, doubt: Option<String>| Estimate {
        error: size / (ratio.powf(p) - 1.0),
        order: Some(p),
        observed,
        doubt,
    };
    match (declared, observed) {
        (Some(p), None) => Ok(of_order(p, false, None)),
        (Some(p), Some(Ok(seen))) if (seen - p).abs() <= DOUBTFUL => Ok(of_order(p, false, None)),
        (Some(p), Some(Ok(seen))) => {
            let doubt = format!("order {p} is declared, but {seen:.2} is observed");
            Ok(of_order(p, false, Some(doubt)))
        }
        (Some(p), Some(Err(why))) => {
            let doubt = format!("order {p} is declared, but {why}");
            Ok(of_order(p, false, Some(doubt)))
        }
        (None, Some(Ok(p))) => Ok(of_order(p, true, None)),
        (None, Some(Err(why))) => Ok(Estimate {
            error: size,
            order: None,
            observed: false,
            doubt: Some(format!(
                "{why}: no clean estimate of the reference's own error; the difference of the two finest runs is taken for it"
            )),
        }),
        (None, None) => Err(
            "two runs tell nothing about their error unless the order of convergence is declared"
                .into(),
        ),
    }
}

/// What three runs tell about their order.
enum Seen {
    Order(f64),
    /// They come closer, but not as an order of convergence says; in words.
    Odd(String),
    /// They do not come closer, or hardly; in words.
    Diverging(String),
}

/// The order that three runs converge with.
fn observe(before: f64, last: f64, ratio: f64) -> Seen {
    if before == 0.0 {
        return Seen::Odd("the two coarsest runs of the refinement do not differ".into());
    }
    let p = (before.abs() / last.abs()).ln() / ratio.ln();
    if p < LEAST {
        return Seen::Diverging(format!(
            "the refinement does not converge (observed order {p:.2})"
        ));
    }
    if before * last < 0.0 {
        return Seen::Odd("the refinement's differences change sign".into());
    }
    if p <= MOST {
        return Seen::Order(p);
    }
    Seen::Odd(format!(
        "the refinement converges with an observed order of {p:.2}"
    ))
}
