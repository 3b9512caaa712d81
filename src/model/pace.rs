//! How fast what is prescribed changes: what a step is compared with that moves much faster than the one before.
use super::Model;
use crate::scene::TimeFunction;
use covact_geometry::Vec3;

impl Model {
    /// Everything that is prescribed over time (motions, supports, loads, driving forces, coefficients of friction), and a
    /// position at which it is asked for.
    pub fn functions(&self) -> impl Iterator<Item = (&TimeFunction, Vec3)> {
        let somewhere = self.nodes.first().copied().unwrap_or_else(Vec3::zeros);
        let at = move |f| (f, somewhere);
        let node = |dof: u32| self.nodes[dof as usize / 3];
        let friction = self.pairs.iter().filter_map(|p| p.friction.as_ref());
        (self.surfaces.iter().flat_map(|s| s.motion.functions()))
            .chain(self.dead_loads.iter().flat_map(|(_, l)| l.functions()))
            .chain(self.follower_loads.iter().map(|(_, l)| &l.value))
            .chain(friction.flat_map(|f| f.functions()))
            .chain(self.driven().flat_map(|(_, _, d)| d.loads.iter().flatten()))
            .map(at)
            .chain(
                (self.prescribed.iter())
                    .filter_map(move |p| Some((p.value.as_ref()?, node(p.dof)))),
            )
            .chain((self.means.iter()).filter_map(move |m| Some((m.mean.as_ref()?, node(m.free)))))
    }

    /// How many times as fast as in the span `before` anything prescribed changes in the span `now`: of all functions the
    /// largest ratio, infinite for one that stood still, zero where nothing changes.
    pub fn quickened(&self, before: [f64; 2], now: [f64; 2]) -> f64 {
        let rate = |f: &TimeFunction, x: &Vec3, [from, to]: [f64; 2]| {
            let change = f.eval_at(x, to).ok()? - f.eval_at(x, from).ok()?;
            Some(change.abs() / (to - from))
        };
        let shrunk = self.pairs.iter().filter_map(|p| {
            let over = p.overclosure.as_ref()?;
            let rate =
                |[from, to]: [f64; 2]| (over.factor(to) - over.factor(from)).abs() / (to - from);
            Some((rate(before), rate(now)))
        });
        (self.functions())
            .filter_map(|(f, x)| Some((rate(f, &x, before)?, rate(f, &x, now)?)))
            .chain(shrunk)
            .filter(|(_, now)| *now > 0.0)
            .fold(0.0, |most, (before, now)| f64::max(most, now / before))
    }
}
