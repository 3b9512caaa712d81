//! Scenes: their form, what is checked in them, and files that are none.
mod check;
mod limits;
mod parse;
