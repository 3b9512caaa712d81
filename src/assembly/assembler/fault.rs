//! Why a state cannot be evaluated.
use crate::contact::rigid::PointFault;
use crate::model::PairModel;
use crate::model::driven::press::PressFault;
use crate::scene::ValueError;
use crate::shell::ElementFault;
use crate::system::PatternError;
use covact_geometry::Vec3;

/// What kept the model from being evaluated at a trial state. The step is cut.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Fault {
    /// An element could not be evaluated.
    #[error("body `{body}`: {fault}")]
    Element {
        /// Name of its body.
        body: String,
        /// The element and what is wrong with it.
        fault: ElementFault,
    },
    /// A slave point could not be evaluated.
    #[error("contact `{pair}`, slave point {point} near ({:.6e}, {:.6e}, {:.6e}): {fault}", at[0], at[1], at[2])]
    Contact {
        /// Name of the contact.
        pair: String,
        /// Number of the slave point in the contact.
        point: usize,
        /// Its position.
        at: [f64; 3],
        /// What is wrong with it.
        fault: PointFault,
    },
    /// A surface driven by force touches no slave point.
    #[error(
        "surface `{surface}`, which forces drive {free}, has lost all contact: nothing holds it. Forces act on the \
         surface: check their sign and size over time, the components that are free, and what supports the bodies under \
         it{friction}"
    )]
    Untouched {
        /// Name of the surface.
        surface: String,
        /// The components of its motion that forces drive, in words.
        free: String,
        /// Empty, or a word on friction that was to hold it.
        friction: String,
    },
    /// A surface driven by force moves in a direction in which nothing resists it.
    #[error(
        "nothing resists the motion of surface `{surface}` {motion}, and its forces drive it on: take the component out \
         of `free`, or give its force another direction"
    )]
    Unresisted {
        /// Name of the surface.
        surface: String,
        /// The motion that nothing resists, in words.
        motion: String,
    },
    /// A surface driven by force could not be placed.
    #[error(transparent)]
    Press(#[from] PressFault),
    /// A tangent was asked for of a model whose displacements are small.
    #[error(
        "displacements are small: the system has an assembly of its own, without a tangent at a state"
    )]
    Small,
    /// A function of time has no value at the time of the step.
    #[error(transparent)]
    Value(#[from] ValueError),
    /// The system has grown too large.
    #[error(transparent)]
    Pattern(#[from] PatternError),
}

impl Fault {
    /// Of slave point `point` of a pair, which is at `x`.
    pub(crate) fn contact(pair: &PairModel, point: usize, x: &Vec3, fault: PointFault) -> Self {
        Fault::Contact {
            pair: pair.name.clone(),
            point,
            at: [x.x, x.y, x.z],
            fault,
        }
    }
}

pub(super) fn element_fault(body: &str, fault: ElementFault) -> Fault {
    Fault::Element {
        body: body.to_owned(),
        fault,
    }
}
