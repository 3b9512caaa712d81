//! Gauss-Legendre and Gauss-Lobatto rules on [-1, 1], computed once on request.
use thiserror::Error;

/// Most points a rule can have.
pub const MAX_POINTS: usize = 10;

/// A quadrature rule on [-1, 1], points ascending. Held in place, without allocation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rule {
    n: usize,
    points: [f64; MAX_POINTS],
    weights: [f64; MAX_POINTS],
}

impl Rule {
    /// Points, ascending.
    pub fn points(&self) -> &[f64] {
        &self.points[..self.n]
    }

    /// Weights; their sum is 2.
    pub fn weights(&self) -> &[f64] {
        &self.weights[..self.n]
    }

    /// Points of a rule that is known when compiled; those past its number are 0.
    pub(crate) const fn all_points(&self) -> &[f64; MAX_POINTS] {
        &self.points
    }

    /// The weights likewise.
    pub(crate) const fn all_weights(&self) -> &[f64; MAX_POINTS] {
        &self.weights
    }

    /// Pairs (point, weight).
    pub fn iter(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.points()
            .iter()
            .copied()
            .zip(self.weights().iter().copied())
    }
}

/// The two-point Gauss rule.
pub(crate) const GAUSS_2: Rule = {
    const X: f64 = 0.577_350_269_189_625_8;
    Rule {
        n: 2,
        points: [-X, X, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        weights: [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    }
};

/// The three-point Gauss rule.
pub(crate) const GAUSS_3: Rule = {
    const X: f64 = 0.774_596_669_241_483_4;
    const W: f64 = 5.0 / 9.0;
    Rule {
        n: 3,
        points: [-X, 0.0, X, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        weights: [W, 8.0 / 9.0, W, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    }
};

/// A rule that does not exist here.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum QuadratureError {
    /// A Gauss rule with this number of points was asked for.
    #[error("a Gauss rule has 1 to 10 points, not {0}")]
    Gauss(usize),
    /// A Lobatto rule with this number of points was asked for.
    #[error("a Lobatto rule has 2 to 10 points, not {0}")]
    Lobatto(usize),
}

/// Legendre polynomials P_(n-1) and P_n at x, for n >= 1.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut p) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (previous, p) = (p, ((2.0 * k - 1.0) * x * p - (k - 1.0) * previous) / k);
    }
    (previous, p)
}

/// Gauss-Legendre rule with `n` points (1 to 10), exact for polynomials of degree 2n - 1.
///
/// # Errors
/// [`QuadratureError::Gauss`] for another number of points.
pub fn gauss(n: usize) -> Result<Rule, QuadratureError> {
    if !(1..=MAX_POINTS).contains(&n) {
        return Err(QuadratureError::Gauss(n));
    }
    let mut rule = Rule {
        n,
        points: [0.0; MAX_POINTS],
        weights: [0.0; MAX_POINTS],
    };
    let nf = n as f64;
    for i in 0..n {
        // Newton from the Chebyshev estimate of the root of P_n; it converges in about five steps.
        let mut x = -(std::f64::consts::PI * (i as f64 + 0.75) / (nf + 0.5)).cos();
        let mut slope = 0.0;
        for _ in 0..20 {
            let (previous, p) = legendre(n, x);
            slope = nf * (previous - x * p) / (1.0 - x * x);
            let step = p / slope;
            x -= step;
            if step.abs() < 1e-16 {
                break;
            }
        }
        rule.points[i] = x;
        rule.weights[i] = 2.0 / ((1.0 - x * x) * slope * slope);
    }
    symmetrise(&mut rule);
    Ok(rule)
}

/// Gauss-Lobatto rule with `n` points (2 to 10), both ends among them, exact for polynomials of degree 2n - 3.
///
/// # Errors
/// [`QuadratureError::Lobatto`] for another number of points.
pub fn lobatto(n: usize) -> Result<Rule, QuadratureError> {
    if !(2..=MAX_POINTS).contains(&n) {
        return Err(QuadratureError::Lobatto(n));
    }
    let mut rule = Rule {
        n,
        points: [0.0; MAX_POINTS],
        weights: [0.0; MAX_POINTS],
    };
    let m = n - 1;
    let mf = m as f64;
    for i in 0..n {
        let mut x = -(std::f64::consts::PI * i as f64 / mf).cos();
        if i == 0 || i == m {
            x = x.signum();
        } else {
            // Newton on P_m' = m (P_(m-1) - x P_m) / (1 - x^2), with P_m'' from Legendre's equation.
            for _ in 0..20 {
                let (previous, p) = legendre(m, x);
                let first = mf * (previous - x * p) / (1.0 - x * x);
                let second = (2.0 * x * first - mf * (mf + 1.0) * p) / (1.0 - x * x);
                let step = first / second;
                x -= step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
        }
        let (_, p) = legendre(m, x);
        rule.points[i] = x;
        rule.weights[i] = 2.0 / (mf * (mf + 1.0) * p * p);
    }
    symmetrise(&mut rule);
    Ok(rule)
}

/// Makes the rule symmetric to the last bit, so that symmetric problems stay symmetric.
fn symmetrise(rule: &mut Rule) {
    for i in 0..rule.n / 2 {
        let j = rule.n - 1 - i;
        let x = 0.5 * (rule.points[j] - rule.points[i]);
        let w = 0.5 * (rule.weights[j] + rule.weights[i]);
        (rule.points[i], rule.points[j]) = (-x, x);
        (rule.weights[i], rule.weights[j]) = (w, w);
    }
    if rule.n % 2 == 1 {
        rule.points[rule.n / 2] = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moment(rule: &Rule, degree: i32) -> f64 {
        rule.iter().map(|(x, w)| w * x.powi(degree)).sum()
    }

    fn exact(degree: i32) -> f64 {
        if degree % 2 == 1 {
            0.0
        } else {
            2.0 / (degree as f64 + 1.0)
        }
    }

    #[test]
    fn rules_are_exact_to_their_degree_and_no_further() {
        for n in 1..=10 {
            let rule = gauss(n).unwrap();
            for degree in 0..2 * n as i32 {
                assert!(
                    (moment(&rule, degree) - exact(degree)).abs() < 1e-14,
                    "{n} {degree}"
                );
            }
            let over = 2 * n as i32;
            assert!((moment(&rule, over) - exact(over)).abs() > 1e-7, "{n}");
        }
        for n in 2..=10 {
            let rule = lobatto(n).unwrap();
            assert_eq!((rule.points()[0], rule.points()[n - 1]), (-1.0, 1.0));
            for degree in 0..2 * n as i32 - 2 {
                assert!(
                    (moment(&rule, degree) - exact(degree)).abs() < 1e-14,
                    "{n} {degree}"
                );
            }
            let over = 2 * n as i32 - 2;
            assert!((moment(&rule, over) - exact(over)).abs() > 1e-7, "{n}");
        }
    }

    #[test]
    fn numbers_of_points_out_of_range_are_refused() {
        assert_eq!(gauss(0), Err(QuadratureError::Gauss(0)));
        assert_eq!(gauss(11), Err(QuadratureError::Gauss(11)));
        assert_eq!(lobatto(1), Err(QuadratureError::Lobatto(1)));
    }
}
