//! What loads press the faces of a contact together with, as far as it is known before the first step.
use super::super::Builder;
use super::super::supports::components;
use crate::scene::{Load, SetNames, TIME, Value};
use covact_geometry::Vec3;
use std::collections::{BTreeMap, BTreeSet};

impl Builder<'_> {
    /// The pressure of a contact at the end of the first step, as if it carried all that presses it together (force / length^2): the
    /// largest pressure or traction on one of its bodies, where it is the same everywhere, and the forces on these over the `area` of
    /// its slave. A penalty under which it sinks in too deep is known to be too soft. Bodies hand on what acts on them where no
    /// support takes it up.
    pub(super) fn pressed(&self, bodies: [Option<usize>; 2], area: f64) -> f64 {
        let first = self.loaded.first_step();
        let at = |value: &Value| value.compile(&TIME).ok()?.eval(first).ok();
        let vector = |v: &[Value; 3]| Some(Vec3::new(at(&v[0])?, at(&v[1])?, at(&v[2])?));
        let (handed_on, taken) = self.above(&bodies);
        let loads = |of: &dyn Fn(&usize) -> bool| -> Vec<&Load> {
            let on = |set: &str| self.body_of(set).is_some_and(|body| of(&body));
            let loads = self.scene.loads.values();
            loads.filter(|load| load.on.iter().any(&on)).collect()
        };
        let own = loads(&|body| bodies.contains(&Some(*body)));
        let pressures = own.iter().filter_map(|load| {
            let pressure = load.pressure.as_ref().and_then(at);
            pressure.or_else(|| Some(vector(load.traction.as_ref()?)?.norm()))
        });
        let all = loads(&|body| handed_on.contains(body));
        let forces = all
            .iter()
            .filter_map(|load| vector(load.force.as_ref()?))
            .sum::<Vec3>();
        let forces = Vec3::from_fn(|c, _| if taken[c] { 0.0 } else { forces[c] });
        let mean = match area > 0.0 {
            true => forces.norm() / area,
            false => 0.0,
        };
        pressures.fold(mean, |most, p| most.max(p.abs()))
    }

    /// The body of a set.
    fn body_of(&self, set: &str) -> Option<usize> {
        let name = set.split('.').next().unwrap_or(set);
        self.body_index.get(name).copied()
    }

    /// These bodies, without those that supports hold along all axes, and all that contacts lead to from them without one of those; and
    /// the axes along which supports hold one of them.
    fn above(&self, bodies: &[Option<usize>; 2]) -> (BTreeSet<usize>, [bool; 3]) {
        let of = |sets: &SetNames| sets.iter().next().and_then(|set| self.body_of(set));
        let mut held: BTreeMap<usize, [bool; 3]> = BTreeMap::new();
        for support in self.scene.supports.values() {
            for body in support.on.iter().filter_map(|set| self.body_of(set)) {
                let axes = held.entry(body).or_default();
                for (component, _) in components(support) {
                    axes[component as usize] = true;
                }
            }
        }
        let contacts = self.scene.contacts.values();
        let pairs: Vec<[Option<usize>; 2]> = contacts
            .map(|contact| [of(&contact.slave), of(&contact.master)])
            .collect();
        let (mut found, mut taken) = (BTreeSet::new(), [false; 3]);
        let mut next: Vec<usize> = bodies.iter().flatten().copied().collect();
        while let Some(body) = next.pop() {
            let axes = held.get(&body).copied().unwrap_or_default();
            if axes == [true; 3] || !found.insert(body) {
                continue;
            }
            taken = [0, 1, 2].map(|c| taken[c] || axes[c]);
            let with = pairs.iter().filter(|pair| pair.contains(&Some(body)));
            next.extend(with.flatten().flatten());
        }
        (found, taken)
    }
}
