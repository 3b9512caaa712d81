//! Patches of spheres, whose distance is known without a search.
use super::super::round::Sphere;
use super::Search;
use crate::surface::{Surface, Vec3};

/// The sphere that a patch lies on, and the query.
#[derive(Clone, Copy)]
pub(super) struct Beyond {
    patch: u32,
    distance: f64,
    near_centre: bool,
}

impl<S: Surface> Search<'_, S> {
    /// Whether the best point is as near as the sphere that a patch lies on, up to rounding, and stationary: next to a pole
    /// only the slope tells the nearest point from others. A sphere that the best point is not one of must be farther away.
    #[inline]
    pub fn behind_sphere(&self, patch: u32) -> bool {
        let set = self.set;
        let (Some(sphere), Some((_, best))) = (&set.spheres[patch as usize], &self.best) else {
            return false;
        };
        let known = self.sphere.get().filter(|b| b.patch == patch);
        let beyond = known.unwrap_or_else(|| self.beyond(patch, sphere));
        let bound = beyond.distance;
        let flat = || {
            let flat = self.flat.get().unwrap_or_else(|| set.flat(best));
            self.flat.set(Some(flat));
            flat
        };
        // At the centre all points are as near, and which of them is taken means nothing.
        let nothing_nearer = beyond.near_centre && bound >= self.cut
            || bound + 1e-14 * (set.size + self.distance) >= self.distance && flat();
        let own = |other: &Sphere| other.number == sphere.number;
        nothing_nearer
            && (bound >= self.wide
                || set.spheres[best.region.patch as usize]
                    .as_ref()
                    .is_some_and(own))
    }

    pub(super) fn beyond(&self, patch: u32, sphere: &Sphere) -> Beyond {
        let beyond = Beyond {
            patch,
            distance: sphere.distance(&self.q),
            near_centre: sphere.has_near_centre(&self.q),
        };
        self.sphere.set(Some(beyond));
        beyond
    }

    /// Whether the sphere that a patch lies on is nowhere nearer than the best point.
    pub fn is_on_nearest_sphere(&self, patch: u32) -> bool {
        let sphere = self.set.spheres[patch as usize];
        sphere.is_some_and(|sphere| sphere.distance(&self.q) >= self.cut)
    }

    /// Next to the centre of a sphere distances differ by less than bounds over pieces tell: starts at the point nearest to
    /// `target`, the point of the sphere in the direction of the query, which is the nearest to the query too.
    #[cold]
    #[inline(never)]
    pub(super) fn start_from_centre(&mut self, target: Vec3) {
        self.centred = true;
        let mut other = Search::new(self.set, target, f64::INFINITY);
        other.centred = true;
        other.run();
        if let Some((_, local)) = other.best {
            self.start(local.region.patch, local.span, local.xi);
        }
    }
}
