//! Friction on rigid surfaces in scenes: closed forms, and constructions whose answer is known.
mod belt;
mod capstan;
mod first_touch;
mod loop_;
mod ring;
mod shear_limited;
mod stick_limit;
mod sticking;
mod turning;
mod wedge;
