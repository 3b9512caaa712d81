//! Friction of contact pairs, and given penalties that cost digits.
use super::super::Builder;
use crate::model::error::{At, number, text};
use crate::model::friction::{self, FrictionModel, LawModel};
use crate::model::{ModelError, penalty};
use crate::scene::{Contact, Penalty};
use penalty::FaceSize;

impl Builder<'_> {
    /// Friction of a contact with the normal penalty `eps_n`; none where the scene asks for none, or the coefficient is zero
    /// throughout.
    pub(super) fn friction(
        &mut self,
        name: &str,
        contact: &Contact,
        (body, size): (usize, &FaceSize),
        eps_n: f64,
        suitable: f64,
    ) -> Result<Option<FrictionModel>, ModelError> {
        let Some(friction) = &contact.friction else {
            return Ok(None);
        };
        let law = LawModel::new(friction).at(|| format!("/contacts/{name}/friction"))?;
        if law.is_none() {
            self.notes.push(format!(
                "contact `{name}`: the coefficient of friction is zero, so that there is no friction"
            ));
            return Ok(None);
        }
        let automatic = friction::automatic_ratio(&self.bodies[body].material);
        let ratio = match contact.tangential_penalty {
            Penalty::Auto => automatic,
            Penalty::Value(v) => v / eps_n,
            Penalty::Scaled(f) => f * automatic,
        };
        if contact.tangential_penalty != Penalty::Auto {
            // Of a ruled normal penalty nothing is known yet but where it starts.
            let normal = match contact.penalty {
                Penalty::Auto => suitable,
                _ => eps_n,
            };
            let given = match contact.tangential_penalty {
                Penalty::Value(v) => v,
                _ => ratio * normal,
            };
            let suitable = automatic * suitable;
            let bounded = size.bounded();
            self.limit(
                name,
                contact,
                "tangential_penalty",
                given,
                (suitable, bounded),
            )?;
        }
        // The back pass of two has the friction of the first.
        if self.scene.contacts.get(name) == Some(contact) {
            self.notes.push(format!(
                "contact `{name}`: tangential penalty {} (traction per elastic slip), {} of the normal one",
                number(ratio * eps_n),
                number(ratio)
            ));
        }
        let ruled = contact.tangential_penalty == Penalty::Auto && contact.augmentation.is_none();
        let given = match contact.tangential_penalty {
            Penalty::Value(v) => Some(v),
            Penalty::Auto | Penalty::Scaled(_) => None,
        };
        Ok(Some(FrictionModel {
            law,
            ratio,
            ruled,
            given,
        }))
    }

    /// Warns of a given penalty that costs too many digits, and refuses one that leaves none. Compared with are the automatic
    /// one and how many times smaller that is for the body being slender.
    pub(super) fn limit(
        &mut self,
        name: &str,
        contact: &Contact,
        field: &str,
        given: f64,
        (automatic, bounded): (f64, f64),
    ) -> Result<(), ModelError> {
        let what = field.replace('_', " ");
        match penalty::judge(given, automatic * bounded) {
            penalty::Given::Fine => {}
            // The back pass of two has the penalty of the first.
            penalty::Given::Stiff(multiple) => {
                if self.scene.contacts.get(name) == Some(contact) {
                    self.warnings.push(format!(
                        "contact `{name}`: the {what} {} is {multiple:.1e} times the stiffness of the elements: it costs \
                         digits and iterations; with `augmentation` a {what} near the automatic {} gives the same gaps",
                        number(given),
                        number(automatic)
                    ));
                }
            }
            penalty::Given::TooStiff(multiple) => {
                return Err(text(
                    format!("/contacts/{name}/{field}"),
                    format!(
                        "the {what} {} is {multiple:.1e} times the stiffness of the elements: rounding would be all that is \
                         left of the pressures (at most {:.0e} times are possible)",
                        number(given),
                        penalty::REFUSED
                    ),
                )
                .help(format!(
                    "leave it out (the automatic one is {}), and take `augmentation` where gaps are to be smaller",
                    number(automatic)
                )));
            }
        }
        Ok(())
    }
}
