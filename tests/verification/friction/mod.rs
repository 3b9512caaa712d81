//! Friction on rigid surfaces in scenes: closed forms, and constructions whose answer is known.
mod capstan;
mod loop_;
mod stick_limit;
mod wedge;
