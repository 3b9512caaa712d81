//! What has been measured since the start, in a checkpoint.
use super::lasting::Lasting;
use super::{Compliance, Measured, Measures};
use crate::model::Model;
use crate::run::checkpoint::bytes::{Malformed, Reader, Writer};

impl Compliance {
    /// Into a checkpoint.
    pub(in crate::run) fn put(&self, out: &mut Writer) {
        let Compliance {
            largest,
            worst,
            limits,
            gap,
            bearing,
            lasting,
            force,
            displacement,
            path,
            penalties,
            growing,
            sticking,
            // Known from the model.
            poses: _,
        } = self;
        out.f64s(&[*largest, *bearing, *force, *displacement]);
        out.u32(*gap);
        for measured in [worst, &limits[0], &limits[1]] {
            measured.put(out);
        }
        out.f64s(path.as_flattened());
        out.count(penalties.len());
        out.f64s(penalties);
        growing.put(out);
        lasting.put(out);
        sticking.put(out);
    }

    /// [`Self::put`], read back for the same model.
    pub(in crate::run) fn take(
        &mut self,
        model: &Model,
        from: &mut Reader,
    ) -> Result<(), Malformed> {
        let mut sums = [0.0; 4];
        from.f64s(&mut sums)?;
        [self.largest, self.bearing, self.force, self.displacement] = sums;
        self.gap = from.u32()?;
        self.worst = Measured::take(model, from)?;
        self.limits = [Measured::take(model, from)?, Measured::take(model, from)?];
        from.f64s(self.path.as_flattened_mut())?;
        let count = from.count(8)?;
        if count > model.pairs.len() {
            return Err(from.malformed("penalties of more contacts than there are"));
        }
        self.penalties.resize(count, 0.0);
        from.f64s(&mut self.penalties)?;
        self.growing.take(from)?;
        self.lasting = Lasting::take(from)?;
        self.sticking.take(model, from)
    }
}

impl Measured {
    fn put(&self, out: &mut Writer) {
        let Measured {
            measures,
            error,
            energy,
            step,
            time,
            pair,
        } = self;
        let Measures {
            energy: ratio,
            penetration,
            growth,
        } = measures;
        out.f64s(&[*ratio, *penetration, *growth, *error, *energy, *time]);
        out.u32(*step);
        out.u32(*pair);
    }

    fn take(model: &Model, from: &mut Reader) -> Result<Self, Malformed> {
        let mut numbers = [0.0; 6];
        from.f64s(&mut numbers)?;
        let [ratio, penetration, growth, error, energy, time] = numbers;
        let (step, pair) = (from.u32()?, from.u32()?);
        if pair as usize >= model.pairs.len().max(1) {
            return Err(from.malformed("a contact that there is not"));
        }
        Ok(Measured {
            measures: Measures {
                energy: ratio,
                penetration,
                growth,
            },
            error,
            energy,
            step,
            time,
            pair,
        })
    }
}
