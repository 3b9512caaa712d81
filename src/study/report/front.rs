//! The Pareto front: runs that no other run beats in both cost and error.

/// Places of the points that are not dominated, cheapest first. A point is dominated when another is not worse in either
/// and better in one; of equal points the first one stays. Points that are not finite are left out.
pub fn pareto(points: &[(f64, f64)]) -> Vec<usize> {
    let finite = |&i: &usize| points[i].0.is_finite() && points[i].1.is_finite();
    let mut order: Vec<usize> = (0..points.len()).filter(finite).collect();
    order.sort_by(|&i, &j| {
        let (a, b) = (points[i], points[j]);
        a.0.total_cmp(&b.0)
            .then(a.1.total_cmp(&b.1))
            .then(i.cmp(&j))
    });
    let mut best = f64::INFINITY;
    order.retain(|&i| {
        let better = points[i].1 < best;
        best = best.min(points[i].1);
        better
    });
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn front_of_known_points() {
        let points = [
            (1.0, 0.5),
            (2.0, 0.5),
            (3.0, 0.1),
            (2.5, 0.2),
            (9.0, 0.09),
            (f64::NAN, 0.0),
            (0.5, f64::INFINITY),
            (1.0, 0.5),
            (9.0, 0.3),
        ];
        assert_eq!(pareto(&points), vec![0, 3, 2, 4]);
        assert!(pareto(&[]).is_empty());
    }
}
